/* SPDX-License-Identifier: MIT-0 */
/* A model as an FMU for co-simulation of FMI 2.0: plfmu.h with the standard's names, and stubs for what it declares and
 * this FMU does not offer. */
#include "plfmu.h"

#include "fmi2.h"

#define FMI(name) FMI2(name)
#define FMI_EXPORT FMI2_Export
#define FMI_STATE(before, after) FMI2(before##FMUstate##after)
#define FMI_DESERIALIZE FMI2(DeSerializeFMUstate)
#define FMI_TYPE(name) fmi2##name
#define FMI_NAME(function) "fmi2" #function
typedef fmi2Component fmi_instance;
typedef fmi2FMUstate fmi_saved;
#include "fmi.h"

/* The text is a printf format there. */
static void log_message(fmu_instance *i, enum fmu_result result, const char *text)
{
	const fmi2CallbackLogger callback = (fmi2CallbackLogger)i->callback;
	if (callback) {
		callback(i->environment, i->name, status_of(result), category_of(result), "%s", text);
	}
}

/* ---- creation ---- */

FMI2_Export const char *FMI2(GetTypesPlatform)(void)
{
	return fmi2TypesPlatform;
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

/* ---- from mode to mode ---- */

FMI2_Export fmi2Status FMI2(SetupExperiment)(fmi2Component c, fmi2Boolean toleranceDefined,
	fmi2Real tolerance, fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
	fmu_instance *i = (fmu_instance *)c;
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
	return fmi2Discard;
}

FMI2_Export fmi2Status FMI2(GetIntegerStatus)(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
	return fmi2Discard;
}

FMI2_Export fmi2Status FMI2(GetStringStatus)(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
	return fmi2Discard;
}

/* ---- what this FMU does not offer: no variables of other types, no model exchange (fmi.h) ---- */

#define ABSENT_TYPE(type) \
	ABSENT(Get##type, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2##type value[])) \
	ABSENT(Set##type, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2##type value[]))

ABSENT_TYPE(Integer)
ABSENT_TYPE(Boolean)
ABSENT_TYPE(String)
ABSENT(NewDiscreteStates, (fmi2Component c, fmi2EventInfo *fmi2eventInfo))
ABSENT(GetDerivatives, (fmi2Component c, fmi2Real derivatives[], size_t nx))
ABSENT(SetRealInputDerivatives, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
								 const fmi2Real value[]))
ABSENT(GetRealOutputDerivatives, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
								  fmi2Real value[]))
ABSENT(CancelStep, (fmi2Component c))
