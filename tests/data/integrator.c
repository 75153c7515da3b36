/* A small, strict FMI 2.0 co-simulation unit for the tests of the importer: y' = k u.
 *
 * It refuses what the standard forbids, so that a master that calls in the wrong order fails.
 * The text parameter `mood` makes steps misbehave: "discard", "error", "fatal"; "mute" is fatal when several
 * values are read.
 * -DWITHOUT_STEP leaves out fmi2DoStep. -DPOLITE returns errors where a wrong call ends the process
 * otherwise.
 *
 * "talk" makes a step log with arguments and a reference to a variable.
 *
 * Defects for the tests of the check: -DHANG_ON_NAN, -DCRASH_IN_RESET, -DFORGETFUL (a restored state lacks
 * the input), -DNOISE (prints), -DNAN_PASSES, -DLEAK, -DLOST_ENVIRONMENT (logs with an environment of its own),
 * -DFLAG_MATTERS (other results where the past is final), -DNEEDS_ROLLBACK (refuses a final past),
 * -DANY_ORDER (refuses no call in the wrong order and no step), -DFOREIGN_MEMORY (frees what it did not allocate), -DKEEPS_MEMORY (does not free what it allocated),
 * -DPLAIN_LOCATION (reads the resource location as "file://" and a path), -DRANDOM (depends on a global
 * variable). -DNEEDS_MEMORY (no instance without the master's functions for memory).
 * -DOWN_MEMORY: calloc and free instead of the master's functions.
 * -DTHIRD: k starts with 2/3. -DSOLVER: errs a little, and otherwise in the first step after a state
 * was restored, as solvers do that choose their steps. -DHANG (in every step), -DLOUD (refuses to be
 * instantiated, in 10 MB with an escape sequence at both ends). */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef void (*Logger)(void *, const char *, Status, const char *, const char *, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, Status);
    void *environment;
} Callbacks;
typedef enum { INSTANTIATED, INITIALIZING, RUNNING, TERMINATED, FAILED, DEAD } Phase;

typedef struct {
    Phase phase;
    int set_up;
    double time, stop, u, rate, y, k, last;
    int count, steps, flag, mode, restored;
    char mood[64];
} Data;
typedef struct {
    Data data;
    Callbacks callbacks;
    char *name, *location;
    int saved;
    /* Steps whose past was final, and when the last of them began. */
    int finals;
    double final;
} Unit;

enum { U = 0, Y = 1, K = 2 };                /* Real */
enum { COUNT = 0, STEPS = 1, MODE = 2, FINALS = 3 }; /* Integer, Enumeration */
enum { MOOD = 0, LOCATION = 1 };             /* String */

static void start_values(Data *d) {
    memset(d, 0, sizeof *d);
    d->k = 2, d->count = 3, d->flag = 1, d->mode = 1;
#ifdef THIRD
    d->k = 2.0 / 3.0;
#endif
    strcpy(d->mood, "good");
}

static Status say(Unit *m, Status status, const char *text) {
    m->callbacks.logger(m->callbacks.environment, m->name, status, "logStatus", text);
    if (status == ERROR) m->data.phase = FAILED;
    if (status == FATAL) m->data.phase = DEAD;
    return status;
}

/* Whoever calls a dead unit ends the process: the test notices. */
static Unit *alive(void *c) {
    Unit *m = c;
    if (m->data.phase == DEAD) abort();
    return m;
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }

#ifdef LEAK
void *lost;
#endif

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *location,
                      const Callbacks *callbacks, int visible, int logging) {
    (void)visible;
    if (type != 1 || !logging) return NULL;
    if (strspn(name, " ") == strlen(name)) {
        callbacks->logger(callbacks->environment, name, ERROR, "logStatus", "blank name");
        return NULL;
    }
#ifdef LOUD
    size_t length = 10000000;
    char *text = memset(malloc(length + 1), 'x', length + 1);
    memcpy(text, "\033[31m\nerror: ", 13);
    memcpy(text + length - 5, "\033[0m", 5);
    text[length] = 0;
    callbacks->logger(callbacks->environment, name, ERROR, "logStatus", text);
    free(text);
    return NULL;
#endif
    if (strcmp(guid, "{integrator}")) {
        callbacks->logger(callbacks->environment, name, ERROR, "logStatus", "wrong guid: 100%% of ##1##");
        return NULL;
    }
#ifdef PLAIN_LOCATION
    if (!location || strncmp(location, "file:///", 8) || access(location + 7, R_OK)) {
        callbacks->logger(callbacks->environment, name, ERROR, "logStatus", "no resources");
        return NULL;
    }
#endif
#ifdef NEEDS_MEMORY
    if (!callbacks->allocate || !callbacks->release) return NULL;
#endif
#ifdef OWN_MEMORY
    Unit *m = calloc(1, sizeof *m);
#else
    Unit *m = callbacks->allocate(1, sizeof *m);
#endif
    m->callbacks = *callbacks;
#ifdef OWN_MEMORY
    m->callbacks.release = free;
#endif
    m->name = strdup(name);
    m->location = strdup(location ? location : "");
    m->final = -HUGE_VAL;
    start_values(&m->data);
#ifdef LOST_ENVIRONMENT
    m->callbacks.environment = (void *)1;
#endif
#ifdef KEEPS_MEMORY
    m->callbacks.allocate(3, 5);
#endif
#ifdef LEAK
    lost = memset(malloc(5000), 1, 5000);
#endif
    return m;
}

void fmi2FreeInstance(void *c) {
    if (!c) return;
    Unit *m = alive(c);
#ifndef POLITE
    if (m->saved) abort(); /* A state leaked. */
#endif
    free(m->name);
    free(m->location);
    void (*release)(void *) = m->callbacks.release;
#ifdef FOREIGN_MEMORY
    release(malloc(4));
#endif
    release(m);
}

Status fmi2SetupExperiment(void *c, int has_tolerance, double tolerance, double start, int has_stop, double stop) {
    (void)has_tolerance, (void)tolerance;
    if (!c) return ERROR;
    Unit *m = alive(c);
#ifdef ANY_ORDER
    if (m->data.phase == RUNNING) return OK;
#endif
    if (m->data.phase != INSTANTIATED) return say(m, ERROR, "fmi2SetupExperiment: wrong phase");
    m->data.set_up = 1;
    m->data.time = start;
    m->data.stop = has_stop ? stop : HUGE_VAL;
    return OK;
}

static Status move(void *c, Phase from, Phase to, const char *text) {
    if (!c) return ERROR;
    Unit *m = alive(c);
#ifndef ANY_ORDER
    if (m->data.phase != from || !m->data.set_up) return say(m, ERROR, text);
#else
    (void)from, (void)text;
#endif
    m->data.phase = to;
    return OK;
}
Status fmi2EnterInitializationMode(void *c) { return move(c, INSTANTIATED, INITIALIZING, "enter: wrong phase"); }
Status fmi2ExitInitializationMode(void *c) { return move(c, INITIALIZING, RUNNING, "exit: wrong phase"); }
Status fmi2Terminate(void *c) {
#ifndef POLITE
    /* A master that ends before a step fails, is wrong. */
    if (alive(c)->data.phase != RUNNING) abort();
#endif
    return move(c, RUNNING, TERMINATED, "terminate: wrong phase");
}
Status fmi2Reset(void *c) {
    if (!c) return ERROR;
#ifdef CRASH_IN_RESET
    *(volatile int *)8 = 1;
#endif
    start_values(&alive(c)->data);
    ((Unit *)c)->final = -HUGE_VAL;
    return OK;
}

static Status readable(Unit *m) {
#ifdef ANY_ORDER
    return (void)m, OK;
#else
    return m->data.phase == INSTANTIATED ? say(m, ERROR, "get before initialization") : OK;
#endif
}

Status fmi2GetReal(void *c, const unsigned *vr, size_t n, double *value) {
    if (!c) return ERROR;
    Unit *m = alive(c);
    if (readable(m)) return ERROR;
    if (n > 1 && !strcmp(m->data.mood, "mute")) return say(m, FATAL, "nothing more to tell");
    for (size_t i = 0; i < n; i++) {
        switch (vr[i]) {
        case U: value[i] = m->data.u; break;
        case Y: value[i] = m->data.y; break;
        case K: value[i] = m->data.k; break;
        default: return say(m, ERROR, "unknown real");
        }
    }
    return OK;
}
Status fmi2GetInteger(void *c, const unsigned *vr, size_t n, int *value) {
    Unit *m = alive(c);
    if (readable(m)) return ERROR;
    for (size_t i = 0; i < n; i++) {
        switch (vr[i]) {
        case COUNT: value[i] = m->data.count; break;
        case STEPS: value[i] = m->data.steps; break;
        case MODE: value[i] = m->data.mode; break;
        case FINALS: value[i] = m->finals; break;
        default: return say(m, ERROR, "unknown integer");
        }
    }
    return OK;
}
Status fmi2GetBoolean(void *c, const unsigned *vr, size_t n, int *value) {
    Unit *m = alive(c);
    if (readable(m)) return ERROR;
    for (size_t i = 0; i < n; i++) {
        if (vr[i]) return say(m, ERROR, "unknown boolean");
        value[i] = m->data.flag;
    }
    return OK;
}
Status fmi2GetString(void *c, const unsigned *vr, size_t n, const char **value) {
    Unit *m = alive(c);
    if (readable(m)) return ERROR;
    for (size_t i = 0; i < n; i++) value[i] = vr[i] == MOOD ? m->data.mood : m->location;
    return OK;
}

Status fmi2SetReal(void *c, const unsigned *vr, size_t n, const double *value) {
    if (!c) return ERROR;
    Unit *m = alive(c);
    for (size_t i = 0; i < n; i++) {
#ifndef NAN_PASSES
        if (!isfinite(value[i])) return say(m, ERROR, "the value is no number; 100%% sure");
#endif
        if (vr[i] == U) {
            if (m->data.phase == INSTANTIATED) return say(m, ERROR, "input before initialization");
            m->data.u = value[i];
            m->data.rate = 0;
        } else if (vr[i] == K) {
            if (m->data.phase == RUNNING) return say(m, ERROR, "fixed parameter");
            m->data.k = value[i];
        } else return say(m, ERROR, "unknown real");
    }
    return OK;
}
Status fmi2SetInteger(void *c, const unsigned *vr, size_t n, const int *value) {
    Unit *m = alive(c);
    for (size_t i = 0; i < n; i++) {
        if (vr[i] != COUNT && (vr[i] != MODE || m->data.phase == RUNNING)) return say(m, ERROR, "not an integer to set");
        *(vr[i] == COUNT ? &m->data.count : &m->data.mode) = value[i];
    }
    return OK;
}
Status fmi2SetBoolean(void *c, const unsigned *vr, size_t n, const int *value) {
    Unit *m = alive(c);
    if (n != 1 || vr[0] || m->data.phase == RUNNING) return say(m, ERROR, "not a boolean to set");
    m->data.flag = value[0];
    return OK;
}
Status fmi2SetString(void *c, const unsigned *vr, size_t n, const char *const *value) {
    (void)vr, (void)n;
    Unit *m = alive(c);
    snprintf(m->data.mood, sizeof m->data.mood, "%s", value[0]);
    return OK;
}
Status fmi2SetRealInputDerivatives(void *c, const unsigned *vr, size_t n, const int *order, const double *value) {
    Unit *m = alive(c);
    if (n != 1 || vr[0] != U || order[0] != 1) return say(m, ERROR, "unknown derivative");
    m->data.rate = value[0];
    return OK;
}

#ifndef WITHOUT_STEP
Status fmi2DoStep(void *c, double time, double h, int no_rollback) {
    if (!c) return ERROR;
#ifdef HANG
    for (;;) sleep(1);
#endif
#ifdef HANG_ON_NAN
    for (volatile int i = 0; isnan(h); i++) {}
#endif
#ifdef NOISE
    printf("step to %g\n", time + h);
#endif
    Unit *m = alive(c);
    Data *d = &m->data;
#ifndef ANY_ORDER
    if (d->phase != RUNNING) return say(m, ERROR, "step: wrong phase");
#ifdef NEEDS_ROLLBACK
    if (no_rollback) return say(m, ERROR, "the past cannot be final");
#endif
    if (!(h > 0) || isinf(h)) return say(m, ERROR, "step: wrong length");
    if (!(fabs(time - d->time) <= 1e-9)) return say(m, ERROR, "step: wrong time");
#endif
    if (time + h > d->stop + 1e-9) return say(m, ERROR, "step beyond the stop time");
    if (!strcmp(d->mood, "error")) return say(m, ERROR, "bad mood");
    if (!strcmp(d->mood, "fatal")) return say(m, FATAL, "very bad mood");
    if (!strcmp(d->mood, "discard")) {
        d->last = time + h / 2;
        d->phase = FAILED;
        return say(m, DISCARD, "half a step only");
    }
    if (!strcmp(d->mood, "talk")) {
        m->callbacks.logger(m->callbacks.environment, m->name, OK, "logStatus",
                            "%s at %.2f s: #r0# is %+d, %d %% of ##%ld (%s)", "step", time, (int)d->u, 50, 7L, "late");
    }
    if (no_rollback) m->finals++, m->final = time;
    d->y += d->k * (d->u * h + d->rate * h * h / 2);
#ifdef SOLVER
    d->y += (d->restored ? 0.5e-6 : 1e-6) * d->k * d->u * h * h;
    d->restored = 0;
#endif
#ifdef FLAG_MATTERS
    if (!no_rollback) d->y -= d->k * d->u * h / 2;
#endif
#ifdef RANDOM
    static int calls;
    d->y += 1e-3 * calls++;
#endif
    d->u += d->rate * h;
    d->time = d->last = time + h;
    d->steps++;
    return OK;
}
#endif

Status fmi2GetRealStatus(void *c, int kind, double *value) {
    if (kind != 2) return DISCARD;
    *value = alive(c)->data.last;
    return OK;
}
Status fmi2GetBooleanStatus(void *c, int kind, int *value) {
    alive(c);
    *value = kind == 3;
    return OK;
}

/* What is not supported, but has to be there. */
Status fmi2SetDebugLogging(void *c, int on, size_t n, const char *const *categories) {
    (void)c, (void)on, (void)n, (void)categories;
    return OK;
}
Status fmi2CancelStep(void *c) { return say(alive(c), ERROR, "no step to cancel"); }
Status fmi2GetDirectionalDerivative(void *c, const unsigned *u, size_t nu, const unsigned *k, size_t nk,
                                    const double *seed, double *result) {
    (void)u, (void)nu, (void)k, (void)nk, (void)seed, (void)result;
    return say(alive(c), ERROR, "no directional derivatives");
}
Status fmi2GetRealOutputDerivatives(void *c, const unsigned *vr, size_t n, const int *order, double *value) {
    (void)vr, (void)n, (void)order, (void)value;
    return say(alive(c), ERROR, "no derivatives of outputs");
}
Status fmi2GetStatus(void *c, int kind, Status *value) { return (void)c, (void)kind, (void)value, DISCARD; }
Status fmi2GetIntegerStatus(void *c, int kind, int *value) { return (void)c, (void)kind, (void)value, DISCARD; }
Status fmi2GetStringStatus(void *c, int kind, const char **value) { return (void)c, (void)kind, (void)value, DISCARD; }

Status fmi2GetFMUstate(void *c, void **state) {
    Unit *m = alive(c);
    if (!*state) {
        *state = malloc(sizeof(Data));
        m->saved++;
    }
    memcpy(*state, &m->data, sizeof(Data));
    return OK;
}
Status fmi2SetFMUstate(void *c, void *state) {
    Data *d = &alive(c)->data;
#ifdef FORGETFUL
    ((Data *)state)->u = d->u;
#endif
#ifndef POLITE
    /* A master that goes back to where it said that it would not, is wrong. */
    if (((Data *)state)->time < ((Unit *)c)->final) abort();
#endif
    memcpy(d, state, sizeof(Data));
    d->restored = 1;
    return OK;
}
Status fmi2FreeFMUstate(void *c, void **state) {
    Unit *m = alive(c);
    if (*state) m->saved--;
    free(*state);
    *state = NULL;
    return OK;
}
Status fmi2SerializedFMUstateSize(void *c, void *state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(Data);
    return OK;
}
Status fmi2SerializeFMUstate(void *c, void *state, char *bytes, size_t size) {
    (void)c;
    memcpy(bytes, state, size);
    return OK;
}
Status fmi2DeSerializeFMUstate(void *c, const char *bytes, size_t size, void **state) {
    Unit *m = alive(c);
    if (size != sizeof(Data)) return say(m, ERROR, "wrong size");
    *state = NULL;
    fmi2GetFMUstate(c, state);
    memcpy(*state, bytes, size);
    return OK;
}
