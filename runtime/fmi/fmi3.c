/* SPDX-License-Identifier: MIT-0 */
/* A model as an FMU for co-simulation of FMI 3.0: plfmu.h with the standard's names, and stubs for what it declares and
 * this FMU does not offer. */
#include "plfmu.h"

#include "fmi3.h"

static fmi3Status status_of(enum fmu_result result)
{
    return result == FMU_OK ? fmi3OK : result == FMU_WARNING ? fmi3Warning : fmi3Error;
}

static void log_message(fmu_instance *i, enum fmu_result result, const char *text)
{
    const fmi3LogMessageCallback callback = (fmi3LogMessageCallback)i->callback;
    if (callback) {
        callback(i->environment, status_of(result),
                 result == FMU_WARNING ? fmu_category_warning : fmu_category_error, text);
    }
}

static fmi3Status absent(fmi3Instance instance, const char *function)
{
    return status_of(fmu_absent((fmu_instance *)instance, function));
}

/* ---- creation ---- */

FMI3_Export const char *FMI3(GetVersion)(void)
{
    return fmi3Version;
}

FMI3_Export fmi3Status FMI3(SetDebugLogging)(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
    const fmi3String categories[])
{
    return instance ? status_of(fmu_logging((fmu_instance *)instance, loggingOn, nCategories, categories)) : fmi3Error;
}

/* No instance says yet which categories the importer wants to see: an error is always logged. */
static fmi3Instance refused(fmi3LogMessageCallback logMessage, fmi3InstanceEnvironment environment, const char *why)
{
    if (logMessage) {
        logMessage(environment, fmi3Error, fmu_category_error, why);
    }
    return NULL;
}

FMI3_Export fmi3Instance FMI3(InstantiateCoSimulation)(fmi3String instanceName, fmi3String instantiationToken,
    fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
    fmi3Boolean earlyReturnAllowed, const fmi3ValueReference requiredIntermediateVariables[],
    size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3IntermediateUpdateCallback intermediateUpdate)
{
    fmu_instance *i;
    (void)resourcePath;
    (void)visible;
    (void)requiredIntermediateVariables;
    (void)intermediateUpdate;
    if (eventModeUsed) {
        return refused(logMessage, instanceEnvironment, "this FMU has no event mode");
    }
    if (nRequiredIntermediateVariables > 0) {
        return refused(logMessage, instanceEnvironment, "this FMU offers no intermediate update");
    }
    i = fmu_new(instanceName, instantiationToken);
    if (!i) {
        return refused(logMessage, instanceEnvironment, "the instantiation token is another, or out of memory");
    }
    i->environment = instanceEnvironment;
    i->may_return_early = earlyReturnAllowed;
    i->callback = (void (*)(void))logMessage;
    i->log = log_message;
    fmu_logging(i, loggingOn, 0, NULL);
    return i;
}

FMI3_Export fmi3Instance FMI3(InstantiateModelExchange)(fmi3String instanceName,
    fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
    fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage)
{
    (void)instanceName;
    (void)instantiationToken;
    (void)resourcePath;
    (void)visible;
    (void)loggingOn;
    return refused(logMessage, instanceEnvironment, "this FMU is for co-simulation only");
}

FMI3_Export fmi3Instance FMI3(InstantiateScheduledExecution)(fmi3String instanceName,
    fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
    fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
    fmi3UnlockPreemptionCallback unlockPreemption)
{
    (void)instanceName;
    (void)instantiationToken;
    (void)resourcePath;
    (void)visible;
    (void)loggingOn;
    (void)clockUpdate;
    (void)lockPreemption;
    (void)unlockPreemption;
    return refused(logMessage, instanceEnvironment, "this FMU is for co-simulation only");
}

FMI3_Export void FMI3(FreeInstance)(fmi3Instance instance)
{
    free(instance);
}

/* ---- from mode to mode ---- */

FMI3_Export fmi3Status FMI3(EnterInitializationMode)(fmi3Instance instance, fmi3Boolean toleranceDefined,
    fmi3Float64 tolerance, fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    fmu_instance *i = (fmu_instance *)instance;
    enum fmu_result result;
    (void)toleranceDefined;
    (void)tolerance;
    (void)stopTimeDefined;
    (void)stopTime;
    if (!i) {
        return fmi3Error;
    }
    result = fmu_enter(i, "fmi3EnterInitializationMode");
    return status_of(result == FMU_OK ? fmu_initialize(i, startTime) : result);
}

FMI3_Export fmi3Status FMI3(ExitInitializationMode)(fmi3Instance instance)
{
    return instance ? status_of(fmu_leave((fmu_instance *)instance, "fmi3ExitInitializationMode")) : fmi3Error;
}

FMI3_Export fmi3Status FMI3(Terminate)(fmi3Instance instance)
{
    return instance ? status_of(fmu_end((fmu_instance *)instance, "fmi3Terminate")) : fmi3Error;
}

FMI3_Export fmi3Status FMI3(Reset)(fmi3Instance instance)
{
    if (!instance) {
        return fmi3Error;
    }
    fmu_begin(&((fmu_instance *)instance)->data);
    return fmi3OK;
}

/* ---- values: all are Float64 ---- */

FMI3_Export fmi3Status FMI3(GetFloat64)(fmi3Instance instance, const fmi3ValueReference valueReferences[],
    size_t nValueReferences, fmi3Float64 values[], size_t nValues)
{
    if (!instance || nValues != nValueReferences) {
        return fmi3Error;
    }
    return status_of(fmu_get((fmu_instance *)instance, valueReferences, nValueReferences, values));
}

FMI3_Export fmi3Status FMI3(SetFloat64)(fmi3Instance instance, const fmi3ValueReference valueReferences[],
    size_t nValueReferences, const fmi3Float64 values[], size_t nValues)
{
    if (!instance || nValues != nValueReferences) {
        return fmi3Error;
    }
    return status_of(fmu_set((fmu_instance *)instance, valueReferences, nValueReferences, values));
}

/* ---- derivatives, of outputs by inputs and tunable params ---- */

FMI3_Export fmi3Status FMI3(GetDirectionalDerivative)(fmi3Instance instance, const fmi3ValueReference unknowns[],
    size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
    fmi3Float64 sensitivity[], size_t nSensitivity)
{
    if (!instance || nSeed != nKnowns || nSensitivity != nUnknowns) {
        return fmi3Error;
    }
    return status_of(fmu_derivative((fmu_instance *)instance, "fmi3GetDirectionalDerivative", false, unknowns,
                                    nUnknowns, knowns, nKnowns, seed, sensitivity));
}

FMI3_Export fmi3Status FMI3(GetAdjointDerivative)(fmi3Instance instance, const fmi3ValueReference unknowns[],
    size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
    fmi3Float64 sensitivity[], size_t nSensitivity)
{
    if (!instance || nSeed != nUnknowns || nSensitivity != nKnowns) {
        return fmi3Error;
    }
    return status_of(fmu_derivative((fmu_instance *)instance, "fmi3GetAdjointDerivative", true, unknowns, nUnknowns,
                                    knowns, nKnowns, seed, sensitivity));
}

/* ---- a step ---- */

FMI3_Export fmi3Status FMI3(DoStep)(fmi3Instance instance, fmi3Float64 currentCommunicationPoint,
    fmi3Float64 communicationStepSize, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
    fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn,
    fmi3Float64 *lastSuccessfulTime)
{
    fmu_instance *i = (fmu_instance *)instance;
    fmi3Status status;
    bool early;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!i) {
        return fmi3Error;
    }
    status = status_of(fmu_step(i, currentCommunicationPoint, communicationStepSize, "fmi3DoStep", &early));
    if (eventHandlingNeeded) {
        *eventHandlingNeeded = fmi3False;
    }
    if (terminateSimulation) {
        *terminateSimulation = fmi3False;
    }
    if (earlyReturn) {
        *earlyReturn = early;
    }
    if (lastSuccessfulTime) {
        *lastSuccessfulTime = fmu_time(&i->data);
    }
    return status;
}

/* ---- saved states ---- */

FMI3_Export fmi3Status FMI3(GetFMUState)(fmi3Instance instance, fmi3FMUState *FMUState)
{
    return instance && FMUState ? status_of(fmu_save((fmu_instance *)instance, FMUState)) : fmi3Error;
}

FMI3_Export fmi3Status FMI3(SetFMUState)(fmi3Instance instance, fmi3FMUState FMUState)
{
    return instance ? status_of(fmu_restore((fmu_instance *)instance, FMUState)) : fmi3Error;
}

FMI3_Export fmi3Status FMI3(FreeFMUState)(fmi3Instance instance, fmi3FMUState *FMUState)
{
    (void)instance;
    if (FMUState) {
        free(*FMUState);
        *FMUState = NULL;
    }
    return fmi3OK;
}

FMI3_Export fmi3Status FMI3(SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState FMUState,
    size_t *size)
{
    (void)FMUState;
    if (!instance || !size) {
        return fmi3Error;
    }
    *size = sizeof(fmu_saved);
    return fmi3OK;
}

FMI3_Export fmi3Status FMI3(SerializeFMUState)(fmi3Instance instance, fmi3FMUState FMUState,
    fmi3Byte serializedState[], size_t size)
{
    return instance ? status_of(fmu_serialize((fmu_instance *)instance, FMUState, serializedState, size)) : fmi3Error;
}

FMI3_Export fmi3Status FMI3(DeserializeFMUState)(fmi3Instance instance, const fmi3Byte serializedState[],
    size_t size, fmi3FMUState *FMUState)
{
    if (!instance || !FMUState) {
        return fmi3Error;
    }
    return status_of(fmu_deserialize((fmu_instance *)instance, serializedState, size, FMUState));
}

/* ---- what this FMU does not offer: no variables of other types, no events, clocks, configuration ---- */

/* Such a function reads its instance alone. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

#define ABSENT(function, parameters) \
    FMI3_Export fmi3Status FMI3(function) parameters \
    { \
        return absent(instance, "fmi3" #function); \
    }
#define ABSENT_TYPE(type) \
    ABSENT(Get##type, (fmi3Instance instance, const fmi3ValueReference valueReferences[], \
                       size_t nValueReferences, fmi3##type values[], size_t nValues)) \
    ABSENT(Set##type, (fmi3Instance instance, const fmi3ValueReference valueReferences[], \
                       size_t nValueReferences, const fmi3##type values[], size_t nValues))

ABSENT_TYPE(Float32)
ABSENT_TYPE(Int8)
ABSENT_TYPE(UInt8)
ABSENT_TYPE(Int16)
ABSENT_TYPE(UInt16)
ABSENT_TYPE(Int32)
ABSENT_TYPE(UInt32)
ABSENT_TYPE(Int64)
ABSENT_TYPE(UInt64)
ABSENT_TYPE(Boolean)
ABSENT_TYPE(String)
ABSENT(EnterEventMode, (fmi3Instance instance))
ABSENT(GetBinary, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                   size_t valueSizes[], fmi3Binary values[], size_t nValues))
ABSENT(GetClock, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                  fmi3Clock values[]))
ABSENT(SetBinary, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                   const size_t valueSizes[], const fmi3Binary values[], size_t nValues))
ABSENT(SetClock, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                  const fmi3Clock values[]))
ABSENT(GetNumberOfVariableDependencies, (fmi3Instance instance, fmi3ValueReference valueReference,
                                         size_t *nDependencies))
ABSENT(GetVariableDependencies, (fmi3Instance instance, fmi3ValueReference dependent,
                                 size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
                                 size_t elementIndicesOfIndependents[], fmi3DependencyKind dependencyKinds[],
                                 size_t nDependencies))
ABSENT(EnterConfigurationMode, (fmi3Instance instance))
ABSENT(ExitConfigurationMode, (fmi3Instance instance))
ABSENT(GetIntervalDecimal, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                            fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]))
ABSENT(GetIntervalFraction, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                             fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]))
ABSENT(GetShiftDecimal, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         fmi3Float64 shifts[]))
ABSENT(GetShiftFraction, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          fmi3UInt64 counters[], fmi3UInt64 resolutions[]))
ABSENT(SetIntervalDecimal, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                            const fmi3Float64 intervals[]))
ABSENT(SetIntervalFraction, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                             const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
ABSENT(SetShiftDecimal, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         const fmi3Float64 shifts[]))
ABSENT(SetShiftFraction, (fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
ABSENT(EvaluateDiscreteStates, (fmi3Instance instance))
ABSENT(UpdateDiscreteStates, (fmi3Instance instance, fmi3Boolean *discreteStatesNeedUpdate,
                              fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
                              fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
                              fmi3Float64 *nextEventTime))
ABSENT(EnterContinuousTimeMode, (fmi3Instance instance))
ABSENT(CompletedIntegratorStep, (fmi3Instance instance, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                 fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation))
ABSENT(SetTime, (fmi3Instance instance, fmi3Float64 time))
ABSENT(SetContinuousStates, (fmi3Instance instance, const fmi3Float64 continuousStates[], size_t nContinuousStates))
ABSENT(GetContinuousStateDerivatives, (fmi3Instance instance, fmi3Float64 derivatives[], size_t nContinuousStates))
ABSENT(GetEventIndicators, (fmi3Instance instance, fmi3Float64 eventIndicators[], size_t nEventIndicators))
ABSENT(GetContinuousStates, (fmi3Instance instance, fmi3Float64 continuousStates[], size_t nContinuousStates))
ABSENT(GetNominalsOfContinuousStates, (fmi3Instance instance, fmi3Float64 nominals[], size_t nContinuousStates))
ABSENT(GetNumberOfEventIndicators, (fmi3Instance instance, size_t *nEventIndicators))
ABSENT(GetNumberOfContinuousStates, (fmi3Instance instance, size_t *nContinuousStates))
ABSENT(EnterStepMode, (fmi3Instance instance))
ABSENT(GetOutputDerivatives, (fmi3Instance instance, const fmi3ValueReference valueReferences[],
                              size_t nValueReferences, const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues))
ABSENT(ActivateModelPartition, (fmi3Instance instance, fmi3ValueReference clockReference, fmi3Float64 activationTime))
