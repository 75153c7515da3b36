/* Steps an FMU and prints its outputs, bit by bit: for comparing binaries of different systems.

   step LIBRARY GUID RESOURCES SLIP OUTPUT... (value references) */
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
static void *find(const char *library, const char *name) {
    return (void *)GetProcAddress(LoadLibraryA(library), name);
}
#else
#include <dlfcn.h>
static void *find(const char *library, const char *name) {
    return dlsym(dlopen(library, RTLD_NOW | RTLD_LOCAL), name);
}
#endif

static void logger(void *environment, const char *name, int status, const char *category, const char *format, ...) {
    (void)environment;
    printf("%s %d %s %s\n", name, status, category, format);
}

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

#define CALL(function, ...)                                    \
    do {                                                       \
        int status = ((int (*)())find(library, "fmi2" #function))(__VA_ARGS__); \
        if (status != 0) {                                     \
            printf("%s: status %d\n", #function, status);      \
            return 1;                                          \
        }                                                      \
    } while (0)

int main(int count, char **arguments) {
    if (count < 6) return 2;
    const char *library = arguments[1];
    Callbacks callbacks = {logger, calloc, free, NULL, NULL};
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);
    void *symbol = find(library, "fmi2Instantiate");
    if (!symbol) return 3;
    memcpy(&instantiate, &symbol, sizeof symbol);
    void *c = instantiate("step", 1, arguments[2], arguments[3], &callbacks, 0, 0);
    if (!c) return 1;
    unsigned slip = (unsigned)atoi(arguments[4]);
    size_t one = 1;
    CALL(SetupExperiment, c, 0, 0.0, 0.0, 0, 0.0);
    CALL(EnterInitializationMode, c);
    CALL(ExitInitializationMode, c);
    for (int k = 0; k < 500; k++) {
        double value = 0.001 * (k % 60);
        CALL(SetReal, c, &slip, one, &value);
        CALL(DoStep, c, k * 1e-3, 1e-3, 0);
        for (int i = 5; i < count; i++) {
            unsigned reference = (unsigned)atoi(arguments[i]);
            double output;
            uint64_t bits;
            CALL(GetReal, c, &reference, one, &output);
            memcpy(&bits, &output, sizeof bits);
            printf("%08x%08x\n", (unsigned)(bits >> 32), (unsigned)bits);
        }
    }
    void (*release)(void *);
    symbol = find(library, "fmi2FreeInstance");
    memcpy(&release, &symbol, sizeof symbol);
    release(c);
    return 0;
}
