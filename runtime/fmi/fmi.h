/* SPDX-License-Identifier: MIT-0 */
/* fmi.h: functions that FMI 2.0 and 3.0 have alike, for fmi2.c and fmi3.c, which say before they include it how their
 * standard spells things:
 *
 *     FMI(name), FMI_EXPORT              a function, and what stands before it
 *     FMI_STATE(before, after)           the same of functions of saved states; FMI_DESERIALIZE is spelt in another way
 *     FMI_TYPE(name), FMI_NAME(function) a type or value; a function's name as text
 *     fmi_instance, fmi_saved            types: what an importer has of an instance, and of a saved state
 */
#ifndef FMI_H
#define FMI_H

/* The standard's functions have parameters that nothing here reads. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

typedef FMI_TYPE(Status) fmi_status;

static fmi_status status_of(enum fmu_result result)
{
	return result == FMU_OK ? FMI_TYPE(OK) : result == FMU_WARNING ? FMI_TYPE(Warning) : FMI_TYPE(Error);
}

static const char *category_of(enum fmu_result result)
{
	return result == FMU_WARNING ? fmu_category_warning : fmu_category_error;
}

FMI_EXPORT const char *FMI(GetVersion)(void)
{
	return FMI_TYPE(Version);
}

FMI_EXPORT fmi_status FMI(SetDebugLogging)(fmi_instance c, FMI_TYPE(Boolean) loggingOn, size_t nCategories,
	const FMI_TYPE(String) categories[])
{
	return c ? status_of(fmu_logging((fmu_instance *)c, loggingOn != 0, nCategories, categories)) : FMI_TYPE(Error);
}

FMI_EXPORT void FMI(FreeInstance)(fmi_instance c)
{
	free(c);
}

/* ---- from mode to mode ---- */

FMI_EXPORT fmi_status FMI(ExitInitializationMode)(fmi_instance c)
{
	return c ? status_of(fmu_leave((fmu_instance *)c, FMI_NAME(ExitInitializationMode))) : FMI_TYPE(Error);
}

FMI_EXPORT fmi_status FMI(Terminate)(fmi_instance c)
{
	return c ? status_of(fmu_end((fmu_instance *)c, FMI_NAME(Terminate))) : FMI_TYPE(Error);
}

FMI_EXPORT fmi_status FMI(Reset)(fmi_instance c)
{
	if (!c) {
		return FMI_TYPE(Error);
	}
	fmu_begin(&((fmu_instance *)c)->data);
	return FMI_TYPE(OK);
}

/* ---- saved states ---- */

FMI_EXPORT fmi_status FMI_STATE(Get, )(fmi_instance c, fmi_saved *saved)
{
	return c && saved ? status_of(fmu_save((fmu_instance *)c, saved)) : FMI_TYPE(Error);
}

FMI_EXPORT fmi_status FMI_STATE(Set, )(fmi_instance c, fmi_saved saved)
{
	return c ? status_of(fmu_restore((fmu_instance *)c, saved)) : FMI_TYPE(Error);
}

FMI_EXPORT fmi_status FMI_STATE(Free, )(fmi_instance c, fmi_saved *saved)
{
	if (saved) {
		free(*saved);
		*saved = NULL;
	}
	return FMI_TYPE(OK);
}

FMI_EXPORT fmi_status FMI_STATE(Serialized, Size)(fmi_instance c, fmi_saved saved, size_t *size)
{
	if (!c || !size) {
		return FMI_TYPE(Error);
	}
	*size = sizeof(fmu_saved);
	return FMI_TYPE(OK);
}

FMI_EXPORT fmi_status FMI_STATE(Serialize, )(fmi_instance c, fmi_saved saved, FMI_TYPE(Byte) bytes[], size_t size)
{
	return c ? status_of(fmu_serialize((fmu_instance *)c, saved, bytes, size)) : FMI_TYPE(Error);
}

FMI_EXPORT fmi_status FMI_DESERIALIZE(fmi_instance c, const FMI_TYPE(Byte) bytes[], size_t size,
	fmi_saved *saved)
{
	return c && saved ? status_of(fmu_deserialize((fmu_instance *)c, bytes, size, saved)) : FMI_TYPE(Error);
}

/* ---- what this FMU does not offer: events, model exchange ---- */

#define ABSENT(function, parameters) \
	FMI_EXPORT fmi_status FMI(function) parameters \
	{ \
		return status_of(fmu_absent((fmu_instance *)c, FMI_NAME(function))); \
	}

ABSENT(EnterEventMode, (fmi_instance c))
ABSENT(EnterContinuousTimeMode, (fmi_instance c))
ABSENT(CompletedIntegratorStep, (fmi_instance c, FMI_TYPE(Boolean) noSetFMUStatePriorToCurrentPoint,
					 FMI_TYPE(Boolean) *enterEventMode, FMI_TYPE(Boolean) *terminateSimulation))
ABSENT(SetTime, (fmi_instance c, double time))
ABSENT(SetContinuousStates, (fmi_instance c, const double x[], size_t nx))
ABSENT(GetContinuousStates, (fmi_instance c, double x[], size_t nx))
ABSENT(GetNominalsOfContinuousStates, (fmi_instance c, double nominals[], size_t nx))
ABSENT(GetEventIndicators, (fmi_instance c, double indicators[], size_t ni))

#endif
