/* SPDX-License-Identifier: MIT-0 */
/* A model as an FMU for co-simulation of FMI 2.0: plfmu.h with the standard's names, and stubs for what it declares and
 * this FMU does not offer. */
#include "plfmu.h"

#include "fmi2.h"

static fmi2Status status_of(enum fmu_result result)
{
    return result == FMU_OK ? fmi2OK : result == FMU_WARNING ? fmi2Warning : fmi2Error;
}

/* The text is a printf format there. */
static void log_message(fmu_instance *i, enum fmu_result result, const char *text)
{
    const fmi2CallbackLogger callback = (fmi2CallbackLogger)i->callback;
    if (callback) {
        callback(i->environment, i->name, status_of(result),
                 result == FMU_WARNING ? fmu_category_warning : fmu_category_error, "%s", text);
    }
}

static fmi2Status absent(fmi2Component c, const char *function)
{
    return status_of(fmu_absent((fmu_instance *)c, function));
}

/* ---- creation ---- */

FMI2_Export const char *FMI2(GetTypesPlatform)(void)
{
    return fmi2TypesPlatform;
}

FMI2_Export const char *FMI2(GetVersion)(void)
{
    return fmi2Version;
}

FMI2_Export fmi2Status FMI2(SetDebugLogging)(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
    const fmi2String categories[])
{
    return c ? status_of(fmu_logging((fmu_instance *)c, loggingOn != 0, nCategories, categories)) : fmi2Error;
}

/* No instance says yet which categories the importer wants to see: an error is always logged. */
static fmi2Component refused(const fmi2CallbackFunctions *functions, fmi2String name, const char *why)
{
    if (functions && functions->logger) {
        functions->logger(functions->componentEnvironment, name, fmi2Error, fmu_category_error, "%s", why);
    }
    return NULL;
}

FMI2_Export fmi2Component FMI2(Instantiate)(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
    fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions, fmi2Boolean visible,
    fmi2Boolean loggingOn)
{
    fmu_instance *i;
    (void)fmuResourceLocation;
    (void)visible;
    if (fmuType != fmi2CoSimulation) {
        return refused(functions, instanceName, "this FMU is for co-simulation only");
    }
    i = fmu_new(instanceName, fmuGUID);
    if (!i) {
        return refused(functions, instanceName, "the GUID is another, or out of memory");
    }
    if (functions) {
        i->environment = functions->componentEnvironment;
        i->callback = (void (*)(void))functions->logger;
    }
    i->log = log_message;
    fmu_logging(i, loggingOn != 0, 0, NULL);
    return i;
}

FMI2_Export void FMI2(FreeInstance)(fmi2Component c)
{
    free(c);
}

/* ---- from mode to mode ---- */

FMI2_Export fmi2Status FMI2(SetupExperiment)(fmi2Component c, fmi2Boolean toleranceDefined,
    fmi2Real tolerance, fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    fmu_instance *i = (fmu_instance *)c;
    (void)toleranceDefined;
    (void)tolerance;
    (void)stopTimeDefined;
    (void)stopTime;
    if (!i) {
        return fmi2Error;
    }
    return status_of(i->data.mode == FMU_INSTANTIATED ? fmu_initialize(i, startTime)
                                                      : fmu_out_of_place(i, "fmi2SetupExperiment"));
}

FMI2_Export fmi2Status FMI2(EnterInitializationMode)(fmi2Component c)
{
    return c ? status_of(fmu_enter((fmu_instance *)c, "fmi2EnterInitializationMode")) : fmi2Error;
}

FMI2_Export fmi2Status FMI2(ExitInitializationMode)(fmi2Component c)
{
    return c ? status_of(fmu_leave((fmu_instance *)c, "fmi2ExitInitializationMode")) : fmi2Error;
}

FMI2_Export fmi2Status FMI2(Terminate)(fmi2Component c)
{
    return c ? status_of(fmu_end((fmu_instance *)c, "fmi2Terminate")) : fmi2Error;
}

FMI2_Export fmi2Status FMI2(Reset)(fmi2Component c)
{
    if (!c) {
        return fmi2Error;
    }
    fmu_begin(&((fmu_instance *)c)->data);
    return fmi2OK;
}

/* ---- values: all are Real ---- */

FMI2_Export fmi2Status FMI2(GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
    fmi2Real value[])
{
    return c ? status_of(fmu_get((fmu_instance *)c, vr, nvr, value)) : fmi2Error;
}

FMI2_Export fmi2Status FMI2(SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
    const fmi2Real value[])
{
    return c ? status_of(fmu_set((fmu_instance *)c, vr, nvr, value)) : fmi2Error;
}

/* ---- derivatives, of outputs by inputs and tunable params ---- */

FMI2_Export fmi2Status FMI2(GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
    size_t nUnknown, const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
    fmi2Real dvUnknown[])
{
    return c ? status_of(fmu_derivative((fmu_instance *)c, "fmi2GetDirectionalDerivative", false, vUnknown_ref,
                                        nUnknown, vKnown_ref, nKnown, dvKnown, dvUnknown)) : fmi2Error;
}

/* ---- a step: done when it returns, so nothing is ever pending ---- */

FMI2_Export fmi2Status FMI2(DoStep)(fmi2Component c, fmi2Real currentCommunicationPoint,
    fmi2Real communicationStepSize, fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    bool early;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!c) {
        return fmi2Error;
    }
    return status_of(fmu_step((fmu_instance *)c, currentCommunicationPoint, communicationStepSize, "fmi2DoStep",
                              &early));
}

FMI2_Export fmi2Status FMI2(GetRealStatus)(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    if (!c || s != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = fmu_time(&((fmu_instance *)c)->data);
    return fmi2OK;
}

FMI2_Export fmi2Status FMI2(GetBooleanStatus)(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    if (!c || s != fmi2Terminated) {
        return fmi2Discard;
    }
    *value = fmi2False;
    return fmi2OK;
}

FMI2_Export fmi2Status FMI2(GetStatus)(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    (void)c;
    (void)s;
    (void)value;
    return fmi2Discard;
}

FMI2_Export fmi2Status FMI2(GetIntegerStatus)(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    (void)c;
    (void)s;
    (void)value;
    return fmi2Discard;
}

FMI2_Export fmi2Status FMI2(GetStringStatus)(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    (void)c;
    (void)s;
    (void)value;
    return fmi2Discard;
}

/* ---- saved states ---- */

FMI2_Export fmi2Status FMI2(GetFMUstate)(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return c && FMUstate ? status_of(fmu_save((fmu_instance *)c, FMUstate)) : fmi2Error;
}

FMI2_Export fmi2Status FMI2(SetFMUstate)(fmi2Component c, fmi2FMUstate FMUstate)
{
    return c ? status_of(fmu_restore((fmu_instance *)c, FMUstate)) : fmi2Error;
}

FMI2_Export fmi2Status FMI2(FreeFMUstate)(fmi2Component c, fmi2FMUstate *FMUstate)
{
    (void)c;
    if (FMUstate) {
        free(*FMUstate);
        *FMUstate = NULL;
    }
    return fmi2OK;
}

FMI2_Export fmi2Status FMI2(SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    (void)FMUstate;
    if (!c || !size) {
        return fmi2Error;
    }
    *size = sizeof(fmu_saved);
    return fmi2OK;
}

FMI2_Export fmi2Status FMI2(SerializeFMUstate)(fmi2Component c, fmi2FMUstate FMUstate,
    fmi2Byte serializedState[], size_t size)
{
    return c ? status_of(fmu_serialize((fmu_instance *)c, FMUstate, serializedState, size)) : fmi2Error;
}

FMI2_Export fmi2Status FMI2(DeSerializeFMUstate)(fmi2Component c, const fmi2Byte serializedState[],
    size_t size, fmi2FMUstate *FMUstate)
{
    if (!c || !FMUstate) {
        return fmi2Error;
    }
    return status_of(fmu_deserialize((fmu_instance *)c, serializedState, size, FMUstate));
}

/* ---- what this FMU does not offer: no variables of other types, no model exchange ---- */

/* Such a function reads its instance alone. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

#define ABSENT(function, parameters) \
    FMI2_Export fmi2Status FMI2(function) parameters \
    { \
        return absent(c, "fmi2" #function); \
    }
#define ABSENT_TYPE(type) \
    ABSENT(Get##type, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2##type value[])) \
    ABSENT(Set##type, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2##type value[]))

ABSENT_TYPE(Integer)
ABSENT_TYPE(Boolean)
ABSENT_TYPE(String)
ABSENT(EnterEventMode, (fmi2Component c))
ABSENT(NewDiscreteStates, (fmi2Component c, fmi2EventInfo *fmi2eventInfo))
ABSENT(EnterContinuousTimeMode, (fmi2Component c))
ABSENT(CompletedIntegratorStep, (fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                 fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation))
ABSENT(SetTime, (fmi2Component c, fmi2Real time))
ABSENT(SetContinuousStates, (fmi2Component c, const fmi2Real x[], size_t nx))
ABSENT(GetDerivatives, (fmi2Component c, fmi2Real derivatives[], size_t nx))
ABSENT(GetEventIndicators, (fmi2Component c, fmi2Real eventIndicators[], size_t ni))
ABSENT(GetContinuousStates, (fmi2Component c, fmi2Real x[], size_t nx))
ABSENT(GetNominalsOfContinuousStates, (fmi2Component c, fmi2Real x_nominal[], size_t nx))
ABSENT(SetRealInputDerivatives, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
                                 const fmi2Real value[]))
ABSENT(GetRealOutputDerivatives, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
                                  fmi2Real value[]))
ABSENT(CancelStep, (fmi2Component c))
