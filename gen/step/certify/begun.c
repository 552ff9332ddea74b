/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a verified trajectory: where it begins. */
#include "model/contacts/contacts.h"
#include "event_state.h"

/* ---- the start ---- */

/* Of a row over x at the start: its sign, exactly where the start is rational */
static int sign_at_start(struct trajectory *t, const mpq_t *row, mpq_srcptr less, bool *known)
{
	int sign;
	RATIONAL sum = ZERO;
	*known = true;
	if (t->exact) {
		for (int i = 0; i < t->n; i++)
			rational_addmul(sum, row[i], t->exact[i]);
		sign = mpq_cmp(sum, less);
	} else {
		INTERVAL value = OVER_BITS(t->precision);
		trajectory_dot(t, row, t->x, value);
		mpfi_sub_q(value, value, less);
		sign = mpfr_sgn(&value->left) > 0 ? 1 : mpfr_sgn(&value->right) < 0 ? -1 : 0;
		*known = sign != 0 || (mpfr_zero_p(&value->left) && mpfr_zero_p(&value->right));
	}
	return sign;
}

/* Where a switching function that stands on a breakpoint is heading: the sign of its first derivative that is not 0 */
static int heading(struct trajectory *t, int function, bool *known)
{
	mpq_t *row = rationals(t->n);
	int sign = 0;
	RATIONAL zero = ZERO;
	*known = true;
	trajectory_row(t, t->s->function[function].row, row);
	for (int k = 0; k < t->n && sign == 0 && *known; k++) {
		row = trajectory_times(t, row, t->at->A);
		sign = sign_at_start(t, row, zero, known);
	}
	return sign;
}

/* The interval of a switching function, below where it stands on a breakpoint; then *on */
static int interval_at_start(struct trajectory *t, int function, bool *on, bool *known)
{
	const struct switching_function *e = &t->s->function[function];
	mpq_t *row = rationals(t->n);
	int interval = 0, sign = 1;
	*on = false;
	*known = true;
	trajectory_row(t, e->row, row);
	while (interval < e->breaks && *known) {
		sign = sign_at_start(t, row, e->at[interval], known);
		*on = sign == 0;
		if (sign <= 0)
			break;
		interval++;
	}
	return interval;
}

static bool stands_where(struct trajectory *t, int function)
{
	t->undecided =
		format("at t = %s s it is not known on which side of a breakpoint %s is", trajectory_time(t->base),
			      text_of_function(t->model, function));
	return false;
}

/* On a breakpoint that stands twice it rests first, but what comes to a stop or leaves it */
static int rest_at_start(struct trajectory *t, int function, int interval, bool *on, bool *known)
{
	const struct switching_function *e = &t->s->function[function];
	if (!*on || !is_stick(e, interval + 1))
		return interval;
	int impact = impact_resting(t->s, t->when.segment, function, interval + 1), speed = 0;
	RATIONALS *row = rationals(t->n);
	RATIONAL zero = ZERO;
	if (impact >= 0) {
		trajectory_row(t, t->s->impact[impact].in[t->when.segment].speed_row, row);
		speed = sign_at_start(t, row, zero, known);
	}
	*on = false;
	return speed == 0 ? interval + 1 : t->s->impact[impact].in[t->when.segment].upward ? interval : interval + 2;
}

bool trajectory_place(struct trajectory *t)
{
	int count = t->s->functions, region = t->when.segment * (t->s->segments > 1 ? regions_at_once(t->s) : 0);
	bool *on = ARRAY(bool, count), *above = ARRAY(bool, count), known;
	for (int e = 0; e < count; e++) {
		int interval = interval_at_start(t, e, &on[e], &known);
		if (known)
			interval = rest_at_start(t, e, interval, &on[e], &known);
		if (!known)
			return stands_where(t, e);
		region += interval * t->s->function[e].stride;
	}
	trajectory_enter(t, region);
	if (has_events(t->s) && !trajectory_resolve(t, NULL, NULL))
		return false;
	trajectory_hold(t);
	for (int round = 0; round < count; round++)     /* where one goes may change where another one is heading */
		for (int e = 0; e < count; e++) {
			bool up = on[e] && heading(t, e, &known) > 0;
			if (on[e] && !known)
				return stands_where(t, e);
			if (up != above[e])
				trajectory_enter(t, t->region + (up ? 1 : -1) * t->s->function[e].stride);
			above[e] = up;
		}
	for (int e = 0; e < count; e++)
		t->resting[e] = on[e] && t->exact && heading(t, e, &known) == 0;
	return true;
}
