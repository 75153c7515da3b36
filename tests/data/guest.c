/* A host that watches what an FMU does to its process. Says what it found on standard output; exits with 1 where
   the FMU did something that a guest does not do.

   guest LIBRARY GUID RESOURCES SLIP STRIPES OUTPUTS what [argument]
   SLIP, STRIPES: value references; OUTPUTS: value references, separated by commas */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <fenv.h>
#include <malloc.h>
#include <math.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <xmmintrin.h>

typedef void *Component;
typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

static struct {
    void *handle;
    Component (*Instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);
    void (*FreeInstance)(Component);
    int (*SetupExperiment)(Component, int, double, double, int, double);
    int (*EnterInitializationMode)(Component);
    int (*ExitInitializationMode)(Component);
    int (*Reset)(Component);
    int (*SetReal)(Component, const unsigned *, size_t, const double *);
    int (*SetInteger)(Component, const unsigned *, size_t, const int *);
    int (*GetReal)(Component, const unsigned *, size_t, double *);
    int (*DoStep)(Component, double, double, int);
    int (*GetFMUstate)(Component, void **);
    int (*SetFMUstate)(Component, void *);
    int (*FreeFMUstate)(Component, void **);
    int (*SerializedFMUstateSize)(Component, void *, size_t *);
    int (*SerializeFMUstate)(Component, void *, char *, size_t);
    int (*DeSerializeFMUstate)(Component, const char *, size_t, void **);
} fmi;

static const char *library, *guid, *resources;
static unsigned slip, stripes, outputs[64];
static size_t n_outputs;

static _Thread_local int messages;
static _Thread_local unsigned mxcsr_in_logger;

static void logger(void *environment, const char *name, int status, const char *category, const char *format, ...) {
    (void)environment, (void)name, (void)status, (void)category, (void)format;
    messages++;
    mxcsr_in_logger = _mm_getcsr();
}

static const Callbacks callbacks = {logger, calloc, free, NULL, NULL};

#define CHECK(condition)                                                                   \
    do {                                                                                   \
        if (!(condition)) {                                                                \
            printf("line %d: %s\n", __LINE__, #condition);                                 \
            exit(1);                                                                       \
        }                                                                                  \
    } while (0)

static void load(void) {
    fmi.handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    CHECK(fmi.handle);
#define FIND(name) CHECK(*(void **)&fmi.name = dlsym(fmi.handle, "fmi2" #name))
    FIND(Instantiate);
    FIND(FreeInstance);
    FIND(SetupExperiment);
    FIND(EnterInitializationMode);
    FIND(ExitInitializationMode);
    FIND(Reset);
    FIND(SetReal);
    FIND(SetInteger);
    FIND(GetReal);
    FIND(DoStep);
    FIND(GetFMUstate);
    FIND(SetFMUstate);
    FIND(FreeFMUstate);
    FIND(SerializedFMUstateSize);
    FIND(SerializeFMUstate);
    FIND(DeSerializeFMUstate);
}

static void unload(void) {
    CHECK(dlclose(fmi.handle) == 0);
    CHECK(dlopen(library, RTLD_NOW | RTLD_NOLOAD) == NULL);
}

static Component make(void) {
    Component c = fmi.Instantiate("guest", 1, guid, resources, &callbacks, 0, 0);
    CHECK(c);
    return c;
}

/* Up to the first step; with fewer stripes the start is quicker to find. */
static void begin(Component c, double value, int count) {
    CHECK(fmi.SetupExperiment(c, 0, 0, 0, 0, 0) == 0);
    if (count) CHECK(fmi.SetInteger(c, &stripes, 1, &count) == 0);
    CHECK(fmi.EnterInitializationMode(c) == 0);
    CHECK(fmi.SetReal(c, &slip, 1, &value) == 0);
    CHECK(fmi.ExitInitializationMode(c) == 0);
}

/* Steps of 1 ms with a slip that moves; the same calls give the same bits. */
static void steps(Component c, int from, int to) {
    for (int k = from; k < to; k++) {
        double value = 0.03 + 0.001 * (k % 40);
        CHECK(fmi.SetReal(c, &slip, 1, &value) == 0);
        CHECK(fmi.DoStep(c, k * 1e-3, 1e-3, 0) == 0);
    }
}

static void read_outputs(Component c, double *values) {
    CHECK(fmi.GetReal(c, outputs, n_outputs, values) == 0);
}

static void print_outputs(Component c) {
    double values[64];
    read_outputs(c, values);
    for (size_t i = 0; i < n_outputs; i++) printf("%a\n", values[i]);
}

static long resident_kilobytes(void) {
    long total, resident;
    FILE *file = fopen("/proc/self/statm", "r");
    CHECK(file && fscanf(file, "%ld %ld", &total, &resident) == 2);
    fclose(file);
    return resident * (sysconf(_SC_PAGESIZE) / 1024);
}

static void cycle(int whole) {
    Component c = make();
    if (whole) {
        begin(c, 0.03, 1);
        steps(c, 0, 1);
        void *state = NULL;
        CHECK(fmi.GetFMUstate(c, &state) == 0 && fmi.SetFMUstate(c, state) == 0 && fmi.FreeFMUstate(c, &state) == 0);
        /* an error and the way out of it */
        CHECK(fmi.DoStep(c, NAN, 1e-3, 0) == 3);
        CHECK(fmi.Reset(c) == 0);
    }
    fmi.FreeInstance(c);
}

/* No growth: the second half of the cycles leaves not one byte allocated that the first did not, and the process stays
   as large as it was, but for what the system does with its pages. */
static void growth(int whole, long count) {
    load();
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    for (long i = 0; i < count / 2; i++) cycle(whole);
    long before = resident_kilobytes();
    size_t allocated = mallinfo2().uordblks;
    for (long i = 0; i < count / 2; i++) cycle(whole);
    long after = resident_kilobytes();
    size_t allocated_after = mallinfo2().uordblks;
    clock_gettime(CLOCK_MONOTONIC, &end);
    printf("%ld cycles, %.1f s, %ld kB and %zu bytes allocated, then %ld kB and %zu bytes\n", count,
        (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec), before, allocated, after, allocated_after);
    CHECK(allocated_after == allocated);
    CHECK(after - before <= 512);
    unload();
}

static double alone[64];

static void *one_of_many(void *argument) {
    (void)argument;
    double values[64];
    for (int round = 0; round < 2; round++) {
        Component c = make();
        begin(c, 0.03, 0);
        steps(c, 0, 50);
        read_outputs(c, values);
        CHECK(memcmp(values, alone, n_outputs * sizeof *values) == 0);
        CHECK(fmi.DoStep(c, -1, 1e-3, 0) == 3 && messages == round + 1);
        fmi.FreeInstance(c);
    }
    return NULL;
}

static void threads(int count) {
    load();
    Component c = make();
    begin(c, 0.03, 0);
    steps(c, 0, 50);
    read_outputs(c, alone);
    fmi.FreeInstance(c);
    pthread_t threads[256];
    for (int i = 0; i < count; i++) CHECK(pthread_create(&threads[i], NULL, one_of_many, NULL) == 0);
    for (int i = 0; i < count; i++) CHECK(pthread_join(threads[i], NULL) == 0);
    /* whatever the threads left behind does not keep it loaded */
    unload();
    /* and it can come back */
    load();
    cycle(1);
    unload();
}

/* What a host may have set, and the numbers that come out all the same. */
static void floats(void) {
    load();
    double usual[64], values[64];
    unsigned at_rest = _mm_getcsr();
    Component c = make();
    begin(c, 0.03, 0);
    steps(c, 0, 100);
    read_outputs(c, usual);
    CHECK((_mm_getcsr() & 0xffc0u) == (at_rest & 0xffc0u));
    fmi.FreeInstance(c);

    const unsigned modes[] = {
        0x1f80 | 0x6000,         /* rounds to zero */
        0x1f80 | 0x4000,         /* rounds up */
        0x1f80 | 0x2000,         /* rounds down */
        0x1f80 | 0x8000 | 0x40,  /* no subnormal numbers: FTZ and DAZ */
        0x1f80 & ~0x1e80u,       /* signals for every exception but inexact and denormal operands */
        0x1f80 | 0x3f,           /* all flags raised */
    };
    for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
        unsigned mode = modes[i];
        fenv_t x87_before, x87_after;
        fegetenv(&x87_before);
#define KEEPS(call)                                   \
    do {                                              \
        _mm_setcsr(mode);                             \
        call;                                         \
        unsigned after = _mm_getcsr();                \
        _mm_setcsr(at_rest);                          \
        if (((after ^ mode) & 0xffc0u) != 0) {        \
            printf("%s: %x became %x\n", #call, mode, after); \
            exit(1);                                  \
        }                                             \
    } while (0)
        double one = 0.03;
        KEEPS(c = make());
        KEEPS(fmi.SetupExperiment(c, 0, 0, 0, 0, 0));
        KEEPS(fmi.EnterInitializationMode(c));
        KEEPS(fmi.SetReal(c, &slip, 1, &one));
        KEEPS(fmi.ExitInitializationMode(c));
        for (int k = 0; k < 100; k++) {
            double value = 0.03 + 0.001 * (k % 40), time = k * 1e-3;
            KEEPS(fmi.SetReal(c, &slip, 1, &value));
            KEEPS(fmi.DoStep(c, time, 1e-3, 0));
        }
        KEEPS(fmi.GetReal(c, outputs, n_outputs, values));
        fegetenv(&x87_after);
        CHECK(x87_before.__control_word == x87_after.__control_word);
        if (memcmp(values, usual, n_outputs * sizeof *values) != 0) {
            printf("other results with mxcsr = %x\n", mode);
            exit(1);
        }
        /* the logger is the host's code and finds the host's settings */
        KEEPS(fmi.DoStep(c, -1, 1e-3, 0));
        CHECK(((mxcsr_in_logger ^ mode) & 0xffc0u) == 0);
        KEEPS(fmi.FreeInstance(c));
    }
    unload();
}

static int open_files(void) {
    int count = 0;
    DIR *folder = opendir("/proc/self/fd");
    CHECK(folder);
    while (readdir(folder)) count++;
    closedir(folder);
    return count;
}

/* The working folder and the open files stay as they are, and the library goes when it is told to. */
static void traces(void) {
    char before[4096], after[4096];
    CHECK(getcwd(before, sizeof before));
    int files = open_files();
    load();
    for (int refused = 0; refused < 4; refused++) {
        Component c = NULL;
        if (refused == 1) CHECK(!fmi.Instantiate("guest", 1, "{no}", resources, &callbacks, 0, 0));
        if (refused == 2) CHECK(!fmi.Instantiate("guest", 1, guid, "file:///nowhere", &callbacks, 0, 0));
        if (refused == 3) {
            c = make();
            CHECK(fmi.DoStep(c, 0, 1e-3, 0) == 3);
            fmi.FreeInstance(c);
        }
        c = make();
        begin(c, 0.03, 0);
        steps(c, 0, 3);
        CHECK(open_files() == files);
        fmi.FreeInstance(c);
        CHECK(open_files() == files);
        unload();
        load();
    }
    unload();
    CHECK(getcwd(after, sizeof after) && strcmp(before, after) == 0);
}

static void save(const char *path) {
    load();
    Component c = make();
    begin(c, 0.03, 0);
    steps(c, 0, 50);
    void *state = NULL;
    size_t size = 0;
    CHECK(fmi.GetFMUstate(c, &state) == 0 && fmi.SerializedFMUstateSize(c, state, &size) == 0);
    char *bytes = malloc(size);
    CHECK(bytes && fmi.SerializeFMUstate(c, state, bytes, size) == 0);
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(bytes, 1, size, file) == size && fclose(file) == 0);
    free(bytes);
    CHECK(fmi.FreeFMUstate(c, &state) == 0 && state == NULL);
    steps(c, 50, 100);
    print_outputs(c);
    fmi.FreeInstance(c);
    unload();
}

static void continue_from(const char *path) {
    load();
    FILE *file = fopen(path, "rb");
    static char bytes[1 << 22];
    CHECK(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    Component c = make();
    void *state = NULL;
    CHECK(fmi.DeSerializeFMUstate(c, bytes, size, &state) == 0 && fmi.SetFMUstate(c, state) == 0);
    CHECK(fmi.FreeFMUstate(c, &state) == 0);
    steps(c, 50, 100);
    print_outputs(c);
    fmi.FreeInstance(c);
    unload();
}

/* A model that panics in its step, for the slip that is its only input. */
static void panic(void) {
    load();
    Component other = make(), c = make();
    begin(other, 0, 0);
    begin(c, 0, 0);
    CHECK(fmi.DoStep(c, 0, 1e-3, 0) == 0);
    double one = 1;
    CHECK(fmi.SetReal(c, &slip, 1, &one) == 0);
    CHECK(fmi.DoStep(c, 1e-3, 1e-3, 0) == 4 && messages == 1);
    /* nothing helps any more, not even a reset */
    CHECK(fmi.DoStep(c, 1e-3, 1e-3, 0) == 4);
    CHECK(fmi.Reset(c) == 4);
    fmi.FreeInstance(c);
    CHECK(fmi.DoStep(other, 0, 1e-3, 0) == 0);
    fmi.FreeInstance(other);
    unload();
}

int main(int count, char **arguments) {
    if (count < 8) return 2;
    library = arguments[1], guid = arguments[2], resources = arguments[3];
    slip = (unsigned)atoi(arguments[4]), stripes = (unsigned)atoi(arguments[5]);
    for (char *item = strtok(arguments[6], ","); item && n_outputs < 64; item = strtok(NULL, ","))
        outputs[n_outputs++] = (unsigned)atoi(item);
    const char *what = arguments[7], *argument = count > 8 ? arguments[8] : "";
    if (!strcmp(what, "made")) growth(0, atol(argument));
    else if (!strcmp(what, "run")) growth(1, atol(argument));
    else if (!strcmp(what, "threads")) threads(atoi(argument));
    else if (!strcmp(what, "floats")) floats();
    else if (!strcmp(what, "traces")) traces();
    else if (!strcmp(what, "save")) save(argument);
    else if (!strcmp(what, "continue")) continue_from(argument);
    else if (!strcmp(what, "panic")) panic();
    else return 2;
    return 0;
}
