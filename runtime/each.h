/* SPDX-License-Identifier: MIT-0 */
/* each.h: NAME_batch of a model whose instances share nothing: each takes its steps by itself, as NAME_step takes them,
 * between its place in the arrays and back. Included by the file of the model, which defines before it
 *
 *     PL_TYPE, PL_INSTANCES          one instance, and the struct that the header has of many
 *     PL_ROWS                        numbers that one PL_TYPE takes up
 *     PL_PARAMS, PL_TUNED            above 0: PL(retune), PL(use) with tunable params, of one step: member h
 *     PL_RAMPS                       whether there is PL(hold)
 *     PL_STATES, PL_INPUTS, PL_OUTPUTS */
#include "numbers.h"

#include "given.h"

#include <string.h>

/* How many bytes of an instance are in row i: in the last there may be fewer. */
static size_t PL(row_size)(const PL_TYPE *s, size_t i)
{
	const size_t left = sizeof *s - i * sizeof(real);
	return left < sizeof(real) ? left : sizeof(real);
}

void PL(batch_take)(const PL_INSTANCES *b, size_t j, PL_TYPE *s)
{
	size_t i;
	for (i = 0; i < PL_ROWS; i++) {
		memcpy((char *)s + i * sizeof(real), &b->y[i * b->count + j], PL(row_size)(s, i));
	}
}

void PL(batch_give)(PL_INSTANCES *b, size_t j, const PL_TYPE *s)
{
	size_t i;
	for (i = 0; i < PL_ROWS; i++) {
		memcpy(&b->y[i * b->count + j], (const char *)s + i * sizeof(real), PL(row_size)(s, i));
	}
}

/* Its peaks are what its outputs are now. */
static void PL(batch_begin)(PL_INSTANCES *b, size_t j, const PL_TYPE *s)
{
	real out[PL_OUTPUTS];
	size_t i;
	PL(batch_give)(b, j, s);
	PL(out)(s, out);
	for (i = 0; i < PL_OUTPUTS && b->peak; i++) {
		b->peak[i * b->count + j] = pl_magnitude(out[i]);
	}
}

void PL(batch_init)(PL_INSTANCES *b)
{
	size_t j;
	PL(init)(&b->shared);
	for (j = 0; j < b->count; j++) {
		PL(batch_begin)(b, j, &b->shared);
	}
}

void PL(batch_set)(PL_INSTANCES *b, size_t j, const real y[PL_STATES])
{
	PL_TYPE one;
	PL(batch_take)(b, j, &one);
	PL(set)(&one, PL(time)(&one), y);
	PL(batch_begin)(b, j, &one);
}

static void PL(batch_report)(PL_INSTANCES *b, size_t j, const PL_TYPE *s, real *out, real *sum)
{
	real now[PL_OUTPUTS];
	size_t i;
	PL(out)(s, now);
	for (i = 0; i < PL_OUTPUTS; i++) {
		const size_t at = i * b->count + j;
		if (out) {
			out[at] = now[i];
		}
		if (b->peak && pl_magnitude(now[i]) > b->peak[at]) {
			b->peak[at] = pl_magnitude(now[i]);
		}
		if (sum) {
			pl_sum_squares(sum + at, PL_OUTPUTS * b->count, now[i]);
		}
	}
}

static void PL(batch_one)(PL_INSTANCES *b, size_t j, size_t n, const real *u, real *out, real *sum)
{
	PL_TYPE one;
	PL(batch_take)(b, j, &one);
	for (; n > 0; n--) {
		PL(step)(&one PL_GIVEN);
		u = u ? u + PL_INPUTS : NULL;
		if (out || sum || b->peak) {
			PL(batch_report)(b, j, &one, out, sum);
		}
		out = out ? out + PL_OUTPUTS * b->count : NULL;
	}
	PL(batch_give)(b, j, &one);
}

/* n steps, with sums as NAME_many has them, or without */
static void PL(batch_steps)(PL_INSTANCES *b, size_t n PL_TAKEN_ROWS, real *out, real *sum)
{
	size_t j;
	for (j = 0; j < b->count; j++) {
		PL(batch_one)(b, j, n, PL_THE_INPUTS, out, sum);
	}
	if (b->count > 0) {
		PL(batch_take)(b, 0, &b->shared);
	}
}

/* For kernels: what instances share, the inputs */
void PL(batch_share)(PL_INSTANCES *b, size_t n PL_TAKEN_ROWS, real *now)
{
	size_t k;
	for (k = 0; k < n; k++) {
#if PL_INPUTS > 0
		now += PL_INPUTS;
		memcpy(now, u, PL_INPUTS * sizeof *u);
#endif
		PL(step)(&b->shared PL_GIVEN);
#if PL_INPUTS > 0
		u += PL_INPUTS;
#endif
	}
	(void)now;
}

#if PL_PARAMS > 0
/* ---- of many.h ---- */

#if PL_RAMPS
static void PL(many_hold)(void *to, const real *u)
{
	PL_INSTANCES *const b = (PL_INSTANCES *)to;
	size_t j;
	PL(hold)(&b->shared, u);
	for (j = 0; j < b->count; j++) {
		PL_TYPE one;
		PL(batch_take)(b, j, &one);
		PL(hold)(&one, u);
		PL(batch_give)(b, j, &one);
	}
}
#endif

static int PL(many_use)(PL_INSTANCES *b, size_t j, const PL(coeffs) *c, real *out)
{
	PL_TYPE one;
	PL(batch_take)(b, j, &one);
	PL(use)(&one, c);
	PL(out)(&one, out);
	PL(batch_begin)(b, j, &one);
	return 0;
}
#endif

#define PL_NOW PL_INPUTS
#define PL_DRIVES (PL_PARAMS > 0)
#include "many.h"
#include "undef.h"
