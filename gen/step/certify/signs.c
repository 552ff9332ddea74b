/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a verified trajectory: signs of rows over x, each of which is enclosed apart from 0 or not known; and sliders
 * without mass. */
#include "model/contacts/contacts.h"
#include "event_state.h"

#include <math.h>

/* Whether all of an enclosure is 0 to half of the bits, BITS_OF_ONE or fewer, of such a size, or of 2^-64 */
bool trajectory_is_none(const struct trajectory *t, mpfi_srcptr value, double size)
{
	const int bits = t->precision < BITS_OF_ONE ? t->precision : BITS_OF_ONE;
	REAL least = WITH_BITS(53);
	mpfr_set_d(least, fmax(size, 0x1p-64), MPFR_RNDN);
	mpfr_div_2si(least, least, bits / 2, MPFR_RNDN);
	return mpfr_cmpabs(&value->left, least) <= 0 && mpfr_cmpabs(&value->right, least) <= 0;
}

/* What row . x may be summed from: of positions and of speeds the largest */
double trajectory_size(const struct trajectory *t, const mpq_t *row)
{
	double most[2] = { 0, 0 }, size = 0;
	for (int i = 0; i < t->layout.states; i++)
		most[i >= t->system->n] = fmax(most[i >= t->system->n], fabs(mpfi_get_d(t->x[i])));
	for (int i = 0; i < t->n; i++)
		size += fabs(mpq_get_d(row[i])) *
			(i < t->layout.states ? most[i >= t->system->n] : fabs(mpfi_get_d(t->x[i])));
	return size;
}

/* Of row . x - less: its sign, 0 where it is 0; *known false: it is not told apart from 0. For --solution what enough
 * bits do not tell apart from 0 is 0. */
int trajectory_sign(const struct trajectory *t, const mpq_t *row, mpq_srcptr less, bool *known)
{
	INTERVAL value = OVER_BITS(t->precision);
	trajectory_dot(t, row, t->x, value);
	if (less)
		mpfi_sub_q(value, value, less);
	int sign = mpfr_sgn(&value->left) > 0 ? 1 : mpfr_sgn(&value->right) < 0 ? -1 : 0;
	*known = sign != 0 || (mpfr_zero_p(&value->left) && mpfr_zero_p(&value->right)) ||
		 (t->full->request.solution && t->precision >= BITS_OF_ONE &&
		  trajectory_is_none(t, value, trajectory_size(t, row) + (less ? fabs(mpq_get_d(less)) : 0)));
	return sign;
}

void trajectory_assign(struct trajectory *t, int count, const int *state, mpq_t *const *row)
{
	for (int k = 0; k < count; k++)
		trajectory_dot(t, row[k], t->x, t->y[state[k]]);
	for (int k = 0; k < count; k++)
		mpfi_set(t->x[state[k]], t->y[state[k]]);
	deviation_assign(t, count, state, row);
}

void trajectory_hold(struct trajectory *t)
{
	const struct region *r = &t->s->region[t->region];
	SCRATCH int *state = ARRAY(int, (size_t)r->holds + 1);
	SCRATCH mpq_t **row = ARRAY(mpq_t *, (size_t)r->holds + 1);
	for (int k = 0; k < r->holds; k++) {
		state[k] = r->hold[k].state;
		row[k] = trajectory_row_of(t, r->hold[k].row);
	}
	trajectory_assign(t, r->holds, state, row);
	for (int k = 0; k < r->holds; k++)
		rationals_free(row[k], (size_t)t->n);
}

bool trajectory_unknown(struct trajectory *t, const char *what)
{
	t->undecided = format("at t = %s s it is not known %s", trajectory_time(t->base), what);
	return false;
}

/* ---- where what was held goes ---- */

/* The side to which a switching function on a breakpoint moves in a region, by its first derivative that is not 0;
 * still: its first one is but rounding */
int trajectory_heads(const struct trajectory *t, const struct area *area, int function, bool still, bool *known)
{
	mpq_t *row = trajectory_row_of(t, t->s->function[function].row);
	int sign = 0;
	*known = true;
	for (int k = 0; k < t->n && sign == 0 && *known; k++) {
		mpq_t *next = trajectory_times(t, row, area->A);
		rationals_free(row, (size_t)t->n);
		row = next;
		if (k > 0 || !still)
			sign = trajectory_sign(t, row, NULL, known);
	}
	rationals_free(row, (size_t)t->n);
	return sign;
}

/* How often a switching function that was let go has the value 0 where it is: with its slope, and for a contact, whose
 * force was 0, with its acceleration */
static int order_of(struct trajectory *t, const struct guard *guard)
{
	bool known;
	if (!guard->release)
		return 0;
	if (impact_resting(t->s, t->when.segment, guard->function,
			   interval_of(t->s, t->region, guard->function) - (guard->upward ? 1 : -1)) >= 0)
		return 3;
	RATIONALS *row = trajectory_row_of(t, t->s->function[guard->function].row);
	RATIONALS *slope = trajectory_times(t, row, t->at->A);
	int sign = trajectory_sign(t, slope, NULL, &known);
	return known && sign != 0 ? 0 : 2;
}

void trajectory_let_go(struct trajectory *t, const struct guard *guard)
{
	t->fresh.order[guard->function] = order_of(t, guard);
	t->fresh.back[guard->function] = !guard->upward;
}

/* Of sliders without mass one that would slide back where it is; -1: none does, -2: not known. What is 0, as all that
 * slides with one velocity is where it is met as 0, counts by its slope. */
static int slides_back(const struct trajectory *t, const struct guard *met, const struct guard **release)
{
	for (int k = 0; k < t->at->guards; k++) {
		const struct guard *guard = &t->at->guard[k];
		bool known;
		if (!guard->release || is_stick(&t->s->function[guard->function],
					       interval_of(t->s, t->region, guard->function)))
			continue;
		int sign = trajectory_sign(t, guard->row, NULL, &known);
		bool none = known && sign == 0;
		if (!known && met)
			none = trajectory_meets(t, met, guard);
		if (none)
			sign = trajectory_sign(t, guard->slope, NULL, &known);
		*release = guard;
		if (!known)
			return -2;
		if (sign > 0)
			return guard->function;
	}
	return -1;
}

/* A slider without mass whose velocity an event has turned round sticks from there on. */
bool trajectory_slide(struct trajectory *t, const struct guard *guard, mpfr_srcptr off)
{
	const struct guard *release, **gone;
	if (t->s->sliders == 0)
		return true;
	trajectory_hold(t);
	gone = ARRAY(const struct guard *, t->s->functions);
	int count = 0, back = slides_back(t, guard, &release);
	for (; back >= 0 && count < t->s->functions; count++) {
		gone[count] = release;
		if (off)
			trajectory_note_plain(t, back, release->breakpoint, release->upward, off);
		trajectory_enter(t, t->region + release->leads);
		trajectory_hold(t);
		back = slides_back(t, guard, &release);
	}
	for (int k = 0; k < count && back == -1; k++)
		trajectory_let_go(t, gone[k]);
	if (off)
		mpfr_set(t->fresh.off, off, MPFR_RNDU);
	else
		mpfr_set_zero(t->fresh.off, 1);
	discard(gone);
	return back == -1 || trajectory_unknown(t, "what slides on");
}
