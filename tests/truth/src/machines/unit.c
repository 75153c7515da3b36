/* The FMI 2.0 functions of a machine. What the machine is stands above: numbers, slope(), begin() and measure(). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;
enum { OK, WARNING, DISCARD, ERROR };
/* an input that does nothing, of units that have one */
#define IDLE (PARAMETERS + INPUTS + OUTPUTS)

typedef struct {
    double p[PARAMETERS + 1], u[INPUTS + 1], x[STATES + 1], y[OUTPUTS + 1], idle;
    int begun;
} Unit;

static void reset(Unit *m) {
    memset(m, 0, sizeof *m);
    memcpy(m->p, start_values, PARAMETERS * sizeof(double));
}

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
int fmi2SetDebugLogging(void *c, int on, size_t n, const char *const names[]) {
    (void)c, (void)on, (void)n, (void)names;
    return OK;
}
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *location, const Callbacks *callbacks,
                      int visible, int logging) {
    (void)name, (void)location, (void)callbacks, (void)visible, (void)logging;
    if (type != 1 || strcmp(guid, GUID)) return NULL;
    Unit *m = malloc(sizeof *m);
    if (m) reset(m);
    return m;
}
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void *c, int t, double tolerance, double start, int s, double stop) {
    (void)c, (void)t, (void)tolerance, (void)start, (void)s, (void)stop;
    return OK;
}
int fmi2EnterInitializationMode(void *c) {
    (void)c;
    return OK;
}
static void show(Unit *m) {
    if (!m->begun) begin(m->p, m->u, m->x);
    measure(m->p, m->u, m->x, m->y);
}
int fmi2ExitInitializationMode(void *c) {
    Unit *m = c;
    show(m);
    m->begun = 1;
    return OK;
}
int fmi2Terminate(void *c) {
    (void)c;
    return OK;
}
int fmi2Reset(void *c) {
    reset(c);
    return OK;
}
int fmi2GetReal(void *c, const unsigned vr[], size_t n, double value[]) {
    Unit *m = c;
    show(m);
    for (size_t k = 0; k < n; k++) {
        unsigned v = vr[k];
        if (v < PARAMETERS) value[k] = m->p[v];
        else if (v < PARAMETERS + INPUTS) value[k] = m->u[v - PARAMETERS] * input_factors[v - PARAMETERS];
        else if (v < IDLE) value[k] = m->y[v - PARAMETERS - INPUTS] * output_factors[v - PARAMETERS - INPUTS];
        else if (v == IDLE) value[k] = m->idle;
        else return ERROR;
    }
    return OK;
}
int fmi2SetReal(void *c, const unsigned vr[], size_t n, const double value[]) {
    Unit *m = c;
    for (size_t k = 0; k < n; k++) {
        unsigned v = vr[k];
        if (!isfinite(value[k])) return ERROR;
        if (v < PARAMETERS) m->p[v] = value[k];
        else if (v < PARAMETERS + INPUTS) m->u[v - PARAMETERS] = value[k] / input_factors[v - PARAMETERS];
        else if (v == IDLE) m->idle = value[k];
        else return ERROR;
    }
    return OK;
}
#define NONE(type, name, constant)                                                       \
    int fmi2Get##name(void *c, const unsigned vr[], size_t n, type value[]) {            \
        (void)c, (void)vr, (void)value;                                                  \
        return n ? ERROR : OK;                                                           \
    }                                                                                    \
    int fmi2Set##name(void *c, const unsigned vr[], size_t n, constant type value[]) {   \
        (void)c, (void)vr, (void)value;                                                  \
        return n ? ERROR : OK;                                                           \
    }
typedef const char *Text;
NONE(int, Integer, const)
NONE(int, Boolean, const)
NONE(Text, String, const)

/* Runge and Kutta, with steps of at most LONGEST seconds. */
int fmi2DoStep(void *c, double time, double step, int final) {
    (void)time, (void)final;
    Unit *m = c;
    step /= SLOWER;
    int count = (int)ceil(step / LONGEST - 1e-9);
    if (count < 1) count = 1;
    double h = step / count, k1[STATES + 1], k2[STATES + 1], k3[STATES + 1], k4[STATES + 1], z[STATES + 1];
    for (int s = 0; s < count; s++) {
        slope(m->p, m->u, m->x, k1);
        for (int i = 0; i < STATES; i++) z[i] = m->x[i] + h / 2 * k1[i];
        slope(m->p, m->u, z, k2);
        for (int i = 0; i < STATES; i++) z[i] = m->x[i] + h / 2 * k2[i];
        slope(m->p, m->u, z, k3);
        for (int i = 0; i < STATES; i++) z[i] = m->x[i] + h * k3[i];
        slope(m->p, m->u, z, k4);
        for (int i = 0; i < STATES; i++) m->x[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
    for (int i = 0; i < STATES; i++)
        if (!isfinite(m->x[i])) return ERROR;
    return OK;
}
int fmi2CancelStep(void *c) {
    (void)c;
    return ERROR;
}
int fmi2GetFMUstate(void *c, void **state) {
    if (!*state) *state = malloc(sizeof(Unit));
    if (!*state) return ERROR;
    memcpy(*state, c, sizeof(Unit));
    return OK;
}
int fmi2SetFMUstate(void *c, void *state) {
    memcpy(c, state, sizeof(Unit));
    return OK;
}
int fmi2FreeFMUstate(void *c, void **state) {
    (void)c;
    free(*state);
    *state = NULL;
    return OK;
}
int fmi2SerializedFMUstateSize(void *c, void *state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(Unit);
    return OK;
}
int fmi2SerializeFMUstate(void *c, void *state, char bytes[], size_t size) {
    (void)c;
    if (size < sizeof(Unit)) return ERROR;
    memcpy(bytes, state, sizeof(Unit));
    return OK;
}
int fmi2DeSerializeFMUstate(void *c, const char bytes[], size_t size, void **state) {
    (void)c;
    if (size < sizeof(Unit) || !(*state = malloc(sizeof(Unit)))) return ERROR;
    memcpy(*state, bytes, sizeof(Unit));
    return OK;
}
int fmi2GetDirectionalDerivative(void *c, const unsigned a[], size_t n, const unsigned b[], size_t k,
                                 const double d[], double e[]) {
    (void)c, (void)a, (void)n, (void)b, (void)k, (void)d, (void)e;
    return ERROR;
}
int fmi2SetRealInputDerivatives(void *c, const unsigned v[], size_t n, const int o[], const double d[]) {
    (void)c, (void)v, (void)n, (void)o, (void)d;
    return ERROR;
}
int fmi2GetRealOutputDerivatives(void *c, const unsigned v[], size_t n, const int o[], double d[]) {
    (void)c, (void)v, (void)n, (void)o, (void)d;
    return ERROR;
}
int fmi2GetStatus(void *c, int kind, int *v) {
    (void)c, (void)kind, (void)v;
    return DISCARD;
}
int fmi2GetRealStatus(void *c, int kind, double *v) {
    (void)c, (void)kind, (void)v;
    return DISCARD;
}
int fmi2GetIntegerStatus(void *c, int kind, int *v) {
    (void)c, (void)kind, (void)v;
    return DISCARD;
}
int fmi2GetBooleanStatus(void *c, int kind, int *v) {
    (void)c, (void)kind, (void)v;
    return DISCARD;
}
int fmi2GetStringStatus(void *c, int kind, Text *v) {
    (void)c, (void)kind, (void)v;
    return DISCARD;
}
