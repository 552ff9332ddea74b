/* SPDX-License-Identifier: MIT-0 */
/* A model as an FMU for co-simulation of FMI 3.0: plfmu.h with the standard's names, and stubs for what it declares and
 * this FMU does not offer. */
#include "plfmu.h"

#include "fmi3.h"

#define FMI(name) FMI3(name)
#define FMI_EXPORT FMI3_Export
#define FMI_STATE(before, after) FMI3(before##FMUState##after)
#define FMI_DESERIALIZE FMI3(DeserializeFMUState)
#define FMI_TYPE(name) fmi3##name
#define FMI_NAME(function) "fmi3" #function
typedef fmi3Instance fmi_instance;
typedef fmi3FMUState fmi_saved;
#include "fmi.h"

static void log_message(fmu_instance *i, enum fmu_result result, const char *text)
{
	const fmi3LogMessageCallback callback = (fmi3LogMessageCallback)i->callback;
	if (callback) {
		callback(i->environment, status_of(result), category_of(result), text);
	}
}

/* ---- creation ---- */

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
	return refused(logMessage, instanceEnvironment, "this FMU is for co-simulation only");
}

FMI3_Export fmi3Instance FMI3(InstantiateScheduledExecution)(fmi3String instanceName,
	fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
	fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
	fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
	fmi3UnlockPreemptionCallback unlockPreemption)
{
	return refused(logMessage, instanceEnvironment, "this FMU is for co-simulation only");
}

/* ---- from mode to mode ---- */

FMI3_Export fmi3Status FMI3(EnterInitializationMode)(fmi3Instance instance, fmi3Boolean toleranceDefined,
	fmi3Float64 tolerance, fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
	fmu_instance *i = (fmu_instance *)instance;
	enum fmu_result result;
	if (!i) {
		return fmi3Error;
	}
	result = fmu_enter(i, "fmi3EnterInitializationMode");
	return status_of(result == FMU_OK ? fmu_initialize(i, startTime) : result);
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

/* ---- what this FMU does not offer: no variables of other types, no events (fmi.h), clocks, configuration ---- */

#define ABSENT_TYPE(type) \
	ABSENT(Get##type, (fmi3Instance c, const fmi3ValueReference valueReferences[], \
					   size_t nValueReferences, fmi3##type values[], size_t nValues)) \
	ABSENT(Set##type, (fmi3Instance c, const fmi3ValueReference valueReferences[], \
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
ABSENT(GetBinary, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
				   size_t valueSizes[], fmi3Binary values[], size_t nValues))
ABSENT(GetClock, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
				  fmi3Clock values[]))
ABSENT(SetBinary, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
				   const size_t valueSizes[], const fmi3Binary values[], size_t nValues))
ABSENT(SetClock, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
				  const fmi3Clock values[]))
ABSENT(GetNumberOfVariableDependencies, (fmi3Instance c, fmi3ValueReference valueReference,
										 size_t *nDependencies))
ABSENT(GetVariableDependencies, (fmi3Instance c, fmi3ValueReference dependent,
						 size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
					 size_t elementIndicesOfIndependents[], fmi3DependencyKind dependencyKinds[],
								 size_t nDependencies))
ABSENT(EnterConfigurationMode, (fmi3Instance c))
ABSENT(ExitConfigurationMode, (fmi3Instance c))
ABSENT(GetIntervalDecimal, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
							fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]))
ABSENT(GetIntervalFraction, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
				 fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]))
ABSENT(GetShiftDecimal, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
						 fmi3Float64 shifts[]))
ABSENT(GetShiftFraction, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
						  fmi3UInt64 counters[], fmi3UInt64 resolutions[]))
ABSENT(SetIntervalDecimal, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
							const fmi3Float64 intervals[]))
ABSENT(SetIntervalFraction, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
							 const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
ABSENT(SetShiftDecimal, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
						 const fmi3Float64 shifts[]))
ABSENT(SetShiftFraction, (fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,
						  const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]))
ABSENT(EvaluateDiscreteStates, (fmi3Instance c))
ABSENT(UpdateDiscreteStates, (fmi3Instance c, fmi3Boolean *discreteStatesNeedUpdate,
				  fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
				  fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
							  fmi3Float64 *nextEventTime))
ABSENT(GetContinuousStateDerivatives, (fmi3Instance c, fmi3Float64 derivatives[], size_t nContinuousStates))
ABSENT(GetNumberOfEventIndicators, (fmi3Instance c, size_t *nEventIndicators))
ABSENT(GetNumberOfContinuousStates, (fmi3Instance c, size_t *nContinuousStates))
ABSENT(EnterStepMode, (fmi3Instance c))
ABSENT(GetOutputDerivatives, (fmi3Instance c, const fmi3ValueReference valueReferences[],
							  size_t nValueReferences, const fmi3Int32 orders[],
									fmi3Float64 values[], size_t nValues))
ABSENT(ActivateModelPartition, (fmi3Instance c, fmi3ValueReference clockReference, fmi3Float64 activationTime))
