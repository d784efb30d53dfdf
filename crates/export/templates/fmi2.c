/* @TITLE@: the functions of FMI 2.0.4 around @NAME@.c, for co-simulation@ME_TITLE@. */
#include "@NAME@.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* Types of the standard, as its headers fix them. */
typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

/* Value references: parameters, inputs, states, rates of the states, outputs. */
enum {
    PARAMETERS = sizeof(@NAME@_parameters) / sizeof(double),
    INPUTS = @NAME@_INPUTS,
    STATES = @NAME@_STATES,
    OUTPUTS = @NAME@_OUTPUTS
};

typedef struct {
    double t;
    double parameters[PARAMETERS];
    double u[INPUTS];
    double x[STATES];
} instance;

static const double *defaults(void)
{
    return (const double *)&@NAME@_defaults;
}

/* The parameters of an instance as the model takes them. */
static @NAME@_parameters parameters(const instance *m)
{
    @NAME@_parameters p;
    memcpy(&p, m->parameters, sizeof p);
    return p;
}

static void begin(instance *m)
{
    static const double first[INPUTS] = { @INPUT_STARTS@ };
    m->t = 0.0;
    memcpy(m->parameters, defaults(), sizeof m->parameters);
    memcpy(m->u, first, sizeof m->u);
    memset(m->x, 0, sizeof m->x);
}

static void rates(const instance *m, double dx[])
{
    @NAME@_parameters p = parameters(m);
@RATES@
}

static int is_finite(const instance *m)
{
    for (int k = 0; k < STATES; ++k) {
        if (!isfinite(m->x[k])) {
            return 0;
        }
    }
    return 1;
}

EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[])
{
    (void)c, (void)on, (void)n, (void)names;
    return fmi2OK;
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                     const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    instance *m;
    (void)name, (void)type, (void)resources, (void)functions, (void)visible, (void)logging;
    if (guid == NULL || strcmp(guid, "@GUID@") != 0) {
        return NULL;
    }
    m = calloc(1, sizeof *m);
    if (m != NULL) {
        begin(m);
    }
    return m;
}

EXPORT void fmi2FreeInstance(fmi2Component c)
{
    free(c);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start,
                                      fmi2Boolean stop_defined, fmi2Real stop)
{
    (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
    ((instance *)c)->t = start;
    return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c)
{
    (void)c;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmi2Component c)
{
    begin(c);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{
    instance *m = c;
    double dx[STATES], y[OUTPUTS];
    int has_rates = 0, has_outputs = 0;
    for (size_t k = 0; k < n; ++k) {
        size_t at = vr[k];
        if (at < PARAMETERS) {
            value[k] = m->parameters[at];
        } else if ((at -= PARAMETERS) < INPUTS) {
            value[k] = m->u[at];
        } else if ((at -= INPUTS) < STATES) {
            value[k] = m->x[at];
        } else if ((at -= STATES) < STATES) {
            if (!has_rates) {
                rates(m, dx);
                has_rates = 1;
            }
            value[k] = dx[at];
        } else if ((at -= STATES) < OUTPUTS) {
            if (!has_outputs) {
                @NAME@_parameters p = parameters(m);
                @NAME@_outputs(m->t, m->x, m->u, &p, y);
                has_outputs = 1;
            }
            value[k] = y[at];
        } else {
            return fmi2Error;
        }
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{
    instance *m = c;
    for (size_t k = 0; k < n; ++k) {
        size_t at = vr[k];
        if (at < PARAMETERS) {
            m->parameters[at] = value[k];
        } else if ((at -= PARAMETERS) < INPUTS) {
            m->u[at] = value[k];
        } else if ((at -= INPUTS) < STATES) {
            m->x[at] = value[k];
        } else {
            return fmi2Error;
        }
    }
    return fmi2OK;
}

/* There are no integers, booleans and strings. */
#define NONE(kind, type)                                                                                           \
    EXPORT fmi2Status fmi2Get##kind(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value[])         \
    {                                                                                                              \
        (void)c, (void)vr, (void)value;                                                                            \
        return n == 0 ? fmi2OK : fmi2Error;                                                                        \
    }                                                                                                              \
    EXPORT fmi2Status fmi2Set##kind(fmi2Component c, const fmi2ValueReference vr[], size_t n, const type value[])   \
    {                                                                                                              \
        (void)c, (void)vr, (void)value;                                                                            \
        return n == 0 ? fmi2OK : fmi2Error;                                                                        \
    }
NONE(Integer, fmi2Integer)
NONE(Boolean, fmi2Boolean)
NONE(String, fmi2String)

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    if (*state == NULL) {
        *state = malloc(sizeof(instance));
    }
    if (*state == NULL) {
        return fmi2Error;
    }
    memcpy(*state, c, sizeof(instance));
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state)
{
    memcpy(c, state, sizeof(instance));
    return fmi2OK;
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)c, (void)state;
    *size = sizeof(instance);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    (void)c;
    if (size < sizeof(instance)) {
        return fmi2Error;
    }
    memcpy(bytes, state, sizeof(instance));
    return fmi2OK;
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    if (size < sizeof(instance) || fmi2GetFMUstate(c, state) != fmi2OK) {
        return fmi2Error;
    }
    memcpy(*state, bytes, sizeof(instance));
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n,
                                               const fmi2ValueReference known[], size_t m, const fmi2Real dv[], fmi2Real dz[])
{
    (void)c, (void)unknown, (void)n, (void)known, (void)m, (void)dv, (void)dz;
    return fmi2Error;
}

/* Co-simulation: steps of the model's own size at most, inputs held. */

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now, fmi2Real size, fmi2Boolean keep)
{
    instance *m = c;
    @NAME@_parameters p = parameters(m);
    double steps = fmax(1.0, ceil(size / @NAME@_STEP_S - 1e-9));
    double h = size / steps;
    (void)keep;
    for (double k = 0.0; k < steps; k += 1.0) {
        @NAME@_step(now + k * h, m->x, m->u, h, &p);
    }
    m->t = now + size;
    return is_finite(m) ? fmi2OK : fmi2Error;
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c)
{
    (void)c;
    return fmi2Error;
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                              const fmi2Integer order[], const fmi2Real value[])
{
    (void)c, (void)vr, (void)order, (void)value;
    return n == 0 ? fmi2OK : fmi2Error;
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                               const fmi2Integer order[], fmi2Real value[])
{
    (void)c, (void)vr, (void)order, (void)value;
    return n == 0 ? fmi2OK : fmi2Error;
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    if (kind != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = ((instance *)c)->t;
    return fmi2OK;
}

/* No step is ever pending. */
#define NO_STATUS(name, type)                                                                  \
    EXPORT fmi2Status name(fmi2Component c, const fmi2StatusKind kind, type *value)             \
    {                                                                                          \
        (void)c, (void)kind, (void)value;                                                      \
        return fmi2Discard;                                                                    \
    }
NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetBooleanStatus, fmi2Boolean)
NO_STATUS(fmi2GetStringStatus, fmi2String)
@MODEL_EXCHANGE@
