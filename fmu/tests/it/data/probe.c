/* A small FMU for the importer's tests: FMI 2.0 (FMI=2) or 3.0 (FMI=3), Co-Simulation and Model
 * Exchange, with exact solutions to compare with.
 *
 *   T dx/dt = u - x               a lag, whose input is held
 *   dh/dt = v, dv/dt = -g         a ball; at h = 0 it bounces with v+ = -e v-   (state event)
 *   every 0.1 s: n += 1, held = u                                               (time event)
 *
 * `fail` = 100 makes it end the simulation at 0.9 s; any other value makes the status with that number come from the step (or the derivatives) after 1 s. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PERIOD 0.1
#define EXPORT __attribute__((visibility("default")))

typedef struct {
    double time, u, T, x, h, v, g, e, held, arr[3];
    float f32;
    int32_t n, fail;
    int64_t mode, big;
    bool on, me, ended;
    char label[64];
    /* Not part of the state that is saved: */
    void *environment;
    const void *callbacks;
    void (*log3)(void *, int, const char *, const char *);
} M;

static int live; /* Instances alive in this process, for the tests of freeing. */

static void start(M *m)
{
    m->time = 0; m->u = 1; m->T = 0.5; m->x = 0; m->h = 1; m->v = 0; m->g = 9.81; m->e = 0.7;
    m->held = 0; m->n = 0; m->fail = 0; m->mode = 1; m->on = true; m->ended = false; m->f32 = 0.5f;
    m->arr[0] = 1; m->arr[1] = 2; m->arr[2] = 3;
    m->big = 9007199254740993; /* 2^53 + 1 */
    strcpy(m->label, "probe");
}

static double next_event(const M *m) { return m->n * PERIOD; }

static void sample(M *m)
{
    while (next_event(m) <= m->time + 1e-9) { m->held = m->u; m->n++; }
}

static void bounce(M *m) { if (m->h <= 0 && m->v < 0) { m->h = 0; m->v = -m->e * m->v; } }

/* The exact solution from one communication point to the next. */
static void advance(M *m, double end)
{
    while (m->time < end) {
        sample(m);
        double stop = next_event(m) < end - 1e-9 ? next_event(m) : end, dt = stop - m->time;
        m->x = m->u + (m->x - m->u) * exp(-dt / m->T);
        while (dt > 0) {
            double hit = (m->v + sqrt(m->v * m->v + 2 * m->g * m->h)) / m->g;
            double step = hit < dt ? hit : dt;
            m->h += m->v * step - 0.5 * m->g * step * step;
            m->v -= m->g * step;
            if (hit <= dt) { m->h = 0; m->v = -m->e * m->v; }
            dt -= step;
            if (m->v < 1e-9 && m->h < 1e-12) break;
        }
        m->time = stop;
    }
}

static double number(const M *m, unsigned r)
{
    switch (r) {
    case 0: return m->time;
    case 1: return m->u;
    case 2: return m->T;
    case 3: return m->x;
    case 4: return (m->u - m->x) / m->T;
    case 5: return m->h;
    case 6: return m->v;
    case 7: return -m->g;
    case 8: return m->g;
    case 9: return m->e;
    case 10: return m->held;
    case 11: return m->x * 30 / 3.14159265358979323846; /* x in rpm if x is in rad/s */
    case 12: return 2 * m->u;                           /* direct feed-through */
    default: return NAN;
    }
}

static bool set_number(M *m, unsigned r, double value)
{
    switch (r) {
    case 1: m->u = value; return true;
    case 2: m->T = value; return true;
    case 3: m->x = value; return true;
    case 5: m->h = value; return true;
    case 6: m->v = value; return true;
    case 8: m->g = value; return true;
    case 9: m->e = value; return true;
    default: return false;
    }
}

static bool stops(const M *m, double time) { return m->fail == 100 && time > 0.9 - 1e-9; }
static int failing(const M *m, double time) { return m->fail && m->fail != 100 && time > 1 ? m->fail : 0; }

#if FMI == 2
typedef int bool_t;
typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;
typedef struct { int again, terminate, nominals, states, defined; double next; } EventInfo;
#define F(name) EXPORT int fmi2##name
#define LOG(m, status, ...) ((const Callbacks *)(m)->callbacks)->logger((m)->environment, "probe", status, "logStatusError", __VA_ARGS__)
#define N
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *resources, const Callbacks *c, int visible, int logging)
{
    if (strcmp(guid, "{probe}")) {
        c->logger(c->environment, name, 3, "logStatusError", "wrong guid %s of %s", guid, name);
        return NULL;
    }
    (void)visible; (void)logging; (void)resources;
    M *m = c->allocate(1, sizeof(M));
    start(m);
    m->me = kind == 0; m->callbacks = c; m->environment = c->environment;
    live++;
    return m;
}
EXPORT void fmi2FreeInstance(M *m) { if (m) { live--; ((const Callbacks *)m->callbacks)->release(m); } }
F(SetupExperiment)(M *m, int a, double b, double t, int c, double d) { (void)a; (void)b; (void)c; (void)d; m->time = t; return 0; }
F(EnterInitializationMode)(M *m) { (void)m; return 0; }
F(NewDiscreteStates)(M *m, EventInfo *i) { bounce(m); sample(m); memset(i, 0, sizeof *i); i->states = 1; i->defined = 1; i->next = next_event(m); return 0; }
F(CompletedIntegratorStep)(M *m, int a, int *e, int *t) { (void)m; (void)a; *e = 0; *t = 0; return 0; }
F(DoStep)(M *m, double t, double h, int a)
{
    (void)a;
    if (failing(m, t + h)) { LOG(m, 3, "step to %g s failed", t + h); return failing(m, t + h); }
    m->time = t; advance(m, t + h);
    m->ended = stops(m, m->time);
    return m->ended ? 2 : 0; /* fmi2Discard: the only way of FMI 2.0 to say so */
}
F(GetRealStatus)(M *m, int kind, double *v) { (void)kind; *v = m->time; return 0; }
F(GetBooleanStatus)(M *m, int kind, int *v) { (void)kind; *v = m->ended; return 0; }
F(GetStatus)(M *m, int k, int *v) { (void)m; (void)k; (void)v; return 2; }
F(GetIntegerStatus)(M *m, int k, int *v) { (void)m; (void)k; (void)v; return 2; }
F(GetStringStatus)(M *m, int k, const char **v) { (void)m; (void)k; (void)v; return 2; }
F(CancelStep)(M *m) { (void)m; return 3; }
F(SetRealInputDerivatives)(M *m, const unsigned *r, size_t n, const int *o, const double *v) { (void)m; (void)r; (void)n; (void)o; (void)v; return 3; }
F(GetRealOutputDerivatives)(M *m, const unsigned *r, size_t n, const int *o, double *v) { (void)m; (void)r; (void)n; (void)o; (void)v; return 3; }
F(GetDirectionalDerivative)(M *m, const unsigned *u, size_t nu, const unsigned *k, size_t nk, const double *s, double *d)
{
    for (size_t i = 0; i < nu; i++) { d[i] = 0; for (size_t j = 0; j < nk; j++) if (u[i] == 4) d[i] += (k[j] == 1 ? s[j] : k[j] == 3 ? -s[j] : 0) / m->T; }
    return 0;
}
#define REAL(Op) fmi2##Op##Real
#define INTEGER(Op) fmi2##Op##Integer
#define STATE(x) fmi2##x##FMUstate
#define SIZE fmi2SerializedFMUstateSize
#define SER fmi2SerializeFMUstate
#define DESER fmi2DeSerializeFMUstate
#define RATES fmi2GetDerivatives
#else
typedef bool bool_t;
#define F(name) EXPORT int fmi3##name
#define LOG(m, status, ...) do { char text[99]; snprintf(text, sizeof text, __VA_ARGS__); (m)->log3((m)->environment, status, "logStatusError", text); } while (0)
#define N , size_t nv
typedef void (*Log)(void *, int, const char *, const char *);
static void *make(const char *token, const char *resources, bool me, void *env, Log log)
{
    (void)resources;
    if (strcmp(token, "{probe}")) { char t[99]; snprintf(t, sizeof t, "wrong token %s", token); log(env, 3, "logStatusError", t); return NULL; }
    M *m = calloc(1, sizeof(M));
    start(m);
    m->me = me; m->environment = env; m->log3 = log;
    live++;
    return m;
}
EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
EXPORT void *fmi3InstantiateCoSimulation(const char *n, const char *t, const char *r, bool v, bool l, bool event, bool early, const unsigned *q, size_t nq, void *env, Log log, const void *iu)
{
    (void)n; (void)v; (void)l; (void)early; (void)q; (void)nq; (void)iu;
    return event ? NULL : make(t, r, false, env, log);
}
EXPORT void *fmi3InstantiateModelExchange(const char *n, const char *t, const char *r, bool v, bool l, void *env, Log log) { (void)n; (void)v; (void)l; return make(t, r, true, env, log); }
EXPORT void fmi3FreeInstance(M *m) { if (m) { live--; free(m); } }
F(EnterInitializationMode)(M *m, bool a, double b, double t, bool c, double d) { (void)a; (void)b; (void)c; (void)d; m->time = t; return 0; }
F(UpdateDiscreteStates)(M *m, bool *a, bool *t, bool *n, bool *s, bool *d, double *next) { bounce(m); sample(m); *a = *t = *n = false; *s = *d = true; *next = next_event(m); return 0; }
F(CompletedIntegratorStep)(M *m, bool a, bool *e, bool *t) { (void)m; (void)a; *e = false; *t = false; return 0; }
F(DoStep)(M *m, double t, double h, bool a, bool *event, bool *ends, bool *early, double *last)
{
    (void)a;
    *event = *ends = *early = false; *last = m->time;
    if (failing(m, t + h)) { LOG(m, 3, "step to %g s failed", t + h); return failing(m, t + h); }
    m->time = t; advance(m, t + h); *last = m->time; *ends = stops(m, m->time);
    return 0;
}
F(GetDirectionalDerivative)(M *m, const unsigned *u, size_t nu, const unsigned *k, size_t nk, const double *s, size_t ns, double *d, size_t nd)
{
    (void)ns; (void)nd;
    for (size_t i = 0; i < nu; i++) { d[i] = 0; for (size_t j = 0; j < nk; j++) if (u[i] == 4) d[i] += (k[j] == 1 ? s[j] : k[j] == 3 ? -s[j] : 0) / m->T; }
    return 0;
}
F(GetNumberOfContinuousStates)(M *m, size_t *n) { (void)m; *n = 3; return 0; }
F(GetNumberOfEventIndicators)(M *m, size_t *n) { (void)m; *n = 1; return 0; }
F(GetFloat32)(M *m, const unsigned *r, size_t n, float *v N) { (void)r; (void)nv; for (size_t i = 0; i < n; i++) v[i] = m->f32; return 0; }
F(SetFloat32)(M *m, const unsigned *r, size_t n, const float *v N) { (void)r; (void)nv; for (size_t i = 0; i < n; i++) m->f32 = v[i]; return 0; }
F(GetInt64)(M *m, const unsigned *r, size_t n, int64_t *v N) { (void)nv; for (size_t i = 0; i < n; i++) v[i] = r[i] == 50 ? m->big : m->mode; return 0; }
F(SetInt64)(M *m, const unsigned *r, size_t n, const int64_t *v N) { (void)nv; for (size_t i = 0; i < n; i++) *(r[i] == 50 ? &m->big : &m->mode) = v[i]; return 0; }
F(GetBinary)(M *m, const unsigned *r, size_t n, size_t *sizes, const unsigned char **v N)
{
    static const unsigned char bytes[] = {1, 255, 0};
    (void)m; (void)r; (void)nv;
    for (size_t i = 0; i < n; i++) { sizes[i] = sizeof bytes; v[i] = bytes; }
    return 0;
}
#define REAL(Op) fmi3##Op##Float64
#define INTEGER(Op) fmi3##Op##Int32
#define STATE(x) fmi3##x##FMUState
#define SIZE fmi3SerializedFMUStateSize
#define SER fmi3SerializeFMUState
#define DESER fmi3DeserializeFMUState
#define RATES fmi3GetContinuousStateDerivatives
/* What the standard demands and no test calls. */
#define STUB(name) EXPORT int fmi3##name(void) { return 3; }
STUB(SetDebugLogging) STUB(InstantiateScheduledExecution) STUB(SetBinary) STUB(GetClock) STUB(SetClock)
STUB(GetNumberOfVariableDependencies) STUB(GetVariableDependencies) STUB(GetAdjointDerivative)
STUB(EnterConfigurationMode) STUB(ExitConfigurationMode) STUB(GetIntervalDecimal) STUB(GetIntervalFraction)
STUB(GetShiftDecimal) STUB(GetShiftFraction) STUB(SetIntervalDecimal) STUB(SetIntervalFraction)
STUB(SetShiftDecimal) STUB(SetShiftFraction) STUB(EvaluateDiscreteStates) STUB(EnterStepMode)
STUB(GetOutputDerivatives) STUB(ActivateModelPartition) STUB(GetInt8) STUB(SetInt8) STUB(GetUInt8) STUB(SetUInt8)
STUB(GetInt16) STUB(SetInt16) STUB(GetUInt16) STUB(SetUInt16) STUB(GetUInt32) STUB(SetUInt32) STUB(GetUInt64) STUB(SetUInt64)
#endif

#if FMI == 2
F(SetDebugLogging)(M *m, int on, size_t n, const char *const *c) { (void)m; (void)on; (void)n; (void)c; return 0; }
#define SIZES_FIT 0
#else
#define SIZES_FIT (nv == n ? 0 : 3)
#endif
F(ExitInitializationMode)(M *m)
{
    if (m->T > 0) return 0;
    LOG(m, 3, "T must be positive, but is %g", m->T);
    return 3;
}
F(Terminate)(M *m) { (void)m; return 0; }
F(Reset)(M *m) { start(m); return 0; }
F(EnterEventMode)(M *m) { (void)m; return 0; }
F(EnterContinuousTimeMode)(M *m) { (void)m; return 0; }
F(SetTime)(M *m, double t) { m->time = t; return 0; }
F(SetContinuousStates)(M *m, const double *x, size_t n) { (void)n; m->x = x[0]; m->h = x[1]; m->v = x[2]; return 0; }
F(GetContinuousStates)(M *m, double *x, size_t n) { (void)n; x[0] = m->x; x[1] = m->h; x[2] = m->v; return 0; }
F(GetNominalsOfContinuousStates)(M *m, double *x, size_t n) { (void)m; for (size_t i = 0; i < n; i++) x[i] = 1; return 0; }
F(GetEventIndicators)(M *m, double *z, size_t n) { (void)n; z[0] = m->h == 0 && m->v > 0 ? 1e-300 : m->h; return 0; }
EXPORT int RATES(M *m, double *d, size_t n)
{
    (void)n;
    if (failing(m, m->time)) return failing(m, m->time);
    d[0] = number(m, 4); d[1] = m->v; d[2] = -m->g;
    return 0;
}
EXPORT int REAL(Get)(M *m, const unsigned *r, size_t n, double *v N)
{
    if (n == 1 && r[0] == 20) { memcpy(v, m->arr, sizeof m->arr); return 0; }
    for (size_t i = 0; i < n; i++) { v[i] = number(m, r[i]); if (isnan(v[i])) { LOG(m, 3, "no variable %u", r[i]); return 3; } }
    return SIZES_FIT;
}
EXPORT int REAL(Set)(M *m, const unsigned *r, size_t n, const double *v N)
{
    if (n == 1 && r[0] == 20) { memcpy(m->arr, v, sizeof m->arr); return 0; }
    for (size_t i = 0; i < n; i++) if (!set_number(m, r[i], v[i])) { LOG(m, 3, "cannot set %u", r[i]); return 3; }
    return SIZES_FIT;
}
static int32_t *integer(M *m, unsigned r) { return r == 30 ? &m->n : &m->fail; }
EXPORT int INTEGER(Get)(M *m, const unsigned *r, size_t n, int32_t *v N) { for (size_t i = 0; i < n; i++) v[i] = r[i] == 40 ? (int32_t)m->mode : *integer(m, r[i]); return SIZES_FIT; }
EXPORT int INTEGER(Set)(M *m, const unsigned *r, size_t n, const int32_t *v N)
{
    for (size_t i = 0; i < n; i++) { if (r[i] == 40) m->mode = v[i]; else *integer(m, r[i]) = v[i]; }
    return SIZES_FIT;
}
F(GetBoolean)(M *m, const unsigned *r, size_t n, bool_t *v N) { (void)r; for (size_t i = 0; i < n; i++) v[i] = m->on; return SIZES_FIT; }
F(SetBoolean)(M *m, const unsigned *r, size_t n, const bool_t *v N) { (void)r; for (size_t i = 0; i < n; i++) m->on = v[i]; return SIZES_FIT; }
F(GetString)(M *m, const unsigned *r, size_t n, const char **v N) { (void)r; for (size_t i = 0; i < n; i++) v[i] = m->label; return SIZES_FIT; }
F(SetString)(M *m, const unsigned *r, size_t n, const char *const *v N) { (void)r; for (size_t i = 0; i < n; i++) { strncpy(m->label, v[i], 63); } return SIZES_FIT; }
EXPORT int STATE(Get)(M *m, M **s) { if (!*s) *s = malloc(sizeof(M)); **s = *m; return 0; }
EXPORT int STATE(Set)(M *m, M *s) { M now = *m; *m = *s; m->environment = now.environment; m->callbacks = now.callbacks; m->log3 = now.log3; return 0; }
EXPORT int STATE(Free)(M *m, M **s) { (void)m; free(*s); *s = NULL; return 0; }
EXPORT int SIZE(M *m, M *s, size_t *n) { (void)m; (void)s; *n = sizeof(M); return 0; }
EXPORT int SER(M *m, M *s, unsigned char *b, size_t n) { (void)m; memcpy(b, s, n); return 0; }
EXPORT int DESER(M *m, const unsigned char *b, size_t n, M **s) { (void)m; if (n != sizeof(M)) return 3; *s = malloc(n); memcpy(*s, b, n); return 0; }
EXPORT int probe_live(void) { return live; }
