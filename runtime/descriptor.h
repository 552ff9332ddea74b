/* SPDX-License-Identifier: MIT-0 */
/* descriptor.h: NAME_model, the table of names, sizes and functions by which a program runs any model.  Included by the
 * file of the model, which defines before it
 *
 *     PL_TYPE, PL_NAME           the model; its name in quotes
 *     PL_SPEC_H                  the step of the spec [s]
 *     PL_AT, PL_JUMPS, PL_RAMPS  1: there is PL(at), PL(jump), PL(hold)
 *
 *     PL(state_names)[], PL(output_names)[], with inputs PL(input_names)[] and PL(start_samples)[], with params
 *     PL(param_names)[] and PL(nominal) */
#include "numbers.h"

#include "given.h"

static void PL(any_init)(void *s)
{
	PL(init)((struct PL_TYPE *)s);
}

static void PL(any_set)(void *s, real t, const real *y)
{
	PL(set)((struct PL_TYPE *)s, t, y);
}

static void PL(any_get)(const void *s, real *y)
{
	PL(get)((const struct PL_TYPE *)s, y);
}

static real PL(any_time)(const void *s)
{
	return PL(time)((const struct PL_TYPE *)s);
}

static void PL(any_out)(const void *s, real *out)
{
	PL(out)((const struct PL_TYPE *)s, out);
}

static int PL(any_status)(const void *s)
{
	return PL(status)((const struct PL_TYPE *)s);
}

static void PL(any_step)(void *s, const real *u)
{
	(void)u;
	PL(step)((struct PL_TYPE *)s PL_GIVEN);
}

static void PL(any_run)(void *s, size_t n, const real *u, real *out)
{
	(void)u;
	PL(run)((struct PL_TYPE *)s, n PL_GIVEN, out);
}

#if PL_AT
static void PL(any_at)(const void *s, const real *u, real tau, real *y)
{
	(void)u;
	PL(at)((const struct PL_TYPE *)s PL_GIVEN, tau, y);
}
#endif

#if PL_JUMPS
static void PL(any_jump)(void *s, uint64_t n)
{
	PL(jump)((struct PL_TYPE *)s, n);
}
#endif

#if PL_RAMPS
static void PL(any_hold)(void *s, const real *u)
{
	PL(hold)((struct PL_TYPE *)s, u);
}
#endif

#if PL_PARAMS > 0
static int PL(any_retune)(void *s, const real *params, real h)
{
	PL(coeffs) fresh = PL(nominal);
	const int status = PL(retune)(&fresh, params, h);
	if (status == 0) {
		PL(use)((struct PL_TYPE *)s, &fresh);
	}
	return status;
}
#endif

const pl_model PL(model) = {
	PL_MODEL_VERSION, sizeof(real), PL_NAME, sizeof(struct PL_TYPE),
	PL_STATES, PL_INPUTS, PL_OUTPUTS, PL_SPEC_H,
	PL(state_names),
#if PL_INPUTS > 0
	PL(input_names),
#else
	NULL,
#endif
	PL(output_names),
	PL(any_init), PL(any_set), PL(any_get), PL(any_time), PL(any_step), PL(any_out), PL(any_run),
#if PL_AT
	PL(any_at),
#else
	NULL,
#endif
#if PL_JUMPS
	PL(any_jump),
#else
	NULL,
#endif
	PL(any_status),
#if PL_PARAMS > 0
	PL_PARAMS, PL(param_names), PL(nominal).params, PL(any_retune),
#else
	0, NULL, NULL, NULL,
#endif
#if PL_RAMPS
	PL(any_hold),
#else
	NULL,
#endif
#if PL_INPUTS > 0
	PL(start_samples)
#else
	NULL
#endif
};

#include "undef.h"
