/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a verified trajectory: the first event of a piece, and what is behind it. */
#include "model/contacts/contacts.h"
#include "certify.h"
#include "event_state.h"

#include <math.h>

enum {
	AT_ONCE = 64,               /* events at one instant, before they count as without end */
	SPARE_BITS = 64
};

/* ---- an event-free piece ---- */

static void near_of(const struct trajectory *t, const mpfi_t *x, struct near *room)
{
	for (int i = 0; i < t->n; i++) {
		double low = mpfr_get_d(&x[i]->left, MPFR_RNDD), high = mpfr_get_d(&x[i]->right, MPFR_RNDU);
		room->x[i] = low / 2 + high / 2;
		room->off[i] = (high - low) * (1 + 1e-9) + 1e-13 * fabs(room->x[i]);
	}
}

/* row . x, and by how much it is not known */
static double value_near(int n, const double *row, const struct near *x, double *off)
{
	double sum = 0;
	for (int i = 0; i < n; i++) {
		sum += row[i] * x->x[i];
		*off += fabs(row[i]) * x->off[i];
	}
	return sum;
}

/* A cubic lies within its Bezier points, and the guard is off it by its fourth derivative. */
static bool is_event_free(const struct trajectory *t, const struct guard *g, const struct near *x, const struct near *y,
		     const double *most, double tau)
{
	int n = t->n;
	double off = 1e-13 * fabs(g->near_limit), bend = 0, slope = 0;
	double from = value_near(n, g->near_row, x, &off), to = value_near(n, g->near_row, y, &off);
	double leaves = value_near(n, g->near_slope, x, &slope) * tau / 3;
	double arrives = value_near(n, g->near_slope, y, &slope) * tau / 3;
	for (int i = 0; i < n; i++)
		bend += g->fourth[i] * most[i];
	off += slope * tau + bend * tau * tau * tau * tau / 384 * (1 + 1e-9);
	return from + off < g->near_limit && to + off < g->near_limit && from + leaves + off < g->near_limit &&
	       to - arrives + off < g->near_limit;
}

bool trajectory_event_free(struct trajectory *t, const mpfi_t *y, double tau)
{
	const struct near *from = &t->piece.near[0], *to = &t->piece.near[1];
	near_of(t, (const mpfi_t *)t->x, &t->piece.near[0]);
	near_of(t, y, &t->piece.near[1]);
	for (int i = 0; i < t->n; i++) {
		t->piece.most[i] = 0;
		for (int j = 0; j < t->n; j++)
			t->piece.most[i] += t->at->growth[i * t->n + j] * (fabs(from->x[j]) + from->off[j]);
	}
	for (int k = 0; k < t->at->guards; k++)
		if (!t->resting[t->at->guard[k].function] &&
		    !is_event_free(t, &t->at->guard[k], from, to, t->piece.most, tau))
			return false;
	return true;
}

/* ---- the first event of a piece ---- */

static void add_room(struct trajectory *t, int degree)
{
	if (degree < t->piece.terms)
		return;
	ENLARGE(t->piece.value, (size_t)degree + 1);
	ENLARGE(t->piece.slope, (size_t)degree + 1);
	for (; t->piece.terms <= degree; t->piece.terms++) {
		mpfi_init2(t->piece.value[t->piece.terms], t->precision);
		mpfi_init2(t->piece.slope[t->piece.terms], t->precision);
	}
}

/* The guard's polynomial in s, less its limit, and that of its slope */
static void expand_guard(struct trajectory *t, const struct guard *guard, int degree, mpq_srcptr tau)
{
	INTERVAL length = OVER_BITS(t->precision);
	mpfi_set_q(length, tau);
	add_room(t, degree);
	for (int m = 0; m <= degree; m++) {
		trajectory_dot(t, (const mpq_t *)guard->row, (const mpfi_t *)t->piece.room.term[m], t->piece.value[m]);
		trajectory_dot(t, (const mpq_t *)guard->slope, (const mpfi_t *)t->piece.room.term[m],
			       t->piece.slope[m]);
		mpfi_mul(t->piece.slope[m], t->piece.slope[m], length);
	}
	mpfi_sub_q(t->piece.value[0], t->piece.value[0], guard->limit);
}

/* For --solution, what so many bits do not tell apart from 0 is 0. */
static void clear_none(struct trajectory *t, const struct guard *guard, int degree)
{
	double size = fabs(guard->near_limit);
	if (!t->full->request.solution || t->precision < BITS_OF_ONE)
		return;
	for (int m = 0; m <= degree; m++)
		for (int i = 0; i < t->n; i++)
			size += fabs(guard->near_row[i] * mpfi_get_d(t->piece.room.term[m][i]));
	for (int m = 0; m <= degree; m++)
		if (mpfi_has_zero(t->piece.value[m]) && trajectory_is_none(t, t->piece.value[m], size)) {
			mpfi_set_ui(t->piece.value[m], 0);
			if (m > 0)
				mpfi_set_ui(t->piece.slope[m - 1], 0);
		}
}

/* How many first coefficients of a polynomial that begins below 0 are exactly 0 */
static int zeros_of(const struct trajectory *t, int degree)
{
	int order = 0;
	while (order < degree && mpfr_zero_p(&t->piece.value[order]->left) &&
	       mpfr_zero_p(&t->piece.value[order]->right))
		order++;
	return mpfr_sgn(&t->piece.value[order]->right) < 0 ? order : 0;
}

/* A polynomial has its first coefficients 0, fresh: but that it was let go `fresh_off` away: it is divided by that
 * power of s. */
static int divide_by_power(struct trajectory *t, int degree, int order, bool fresh, mpq_srcptr tau)
{
	INTERVAL wide = OVER_BITS(t->precision);
	int rest = degree - order;
	for (int m = 0; m <= degree; m++) {
		if (m < degree && fresh) {
			mpfi_set_fr(wide, t->fresh.off);
			mpfi_div_q(wide, wide, tau);
			mpfi_mul(wide, wide, t->piece.value[m + 1]);
			mpfi_mul_ui(wide, wide, 2 * (unsigned long)(m + 1));
			mpfi_mag(t->fresh.most_off, wide);
			mpfi_increase(t->piece.value[m], t->fresh.most_off);
		}
		if (m >= order)
			mpfi_set(t->piece.value[m - order], t->piece.value[m]);
	}
	for (int m = 0; m <= rest; m++)
		mpfi_set_ui(t->piece.slope[m], 0);
	for (int m = 1; m <= rest; m++)
		mpfi_mul_ui(t->piece.slope[m - 1], t->piece.value[m], (unsigned long)m);
	return rest;
}

static bool is_fresh(const struct trajectory *t, const struct guard *guard)
{
	return t->fresh.order[guard->function] > 0 && guard->upward == t->fresh.back[guard->function] &&
	       !guard->release;
}

/* Whether nothing of a polynomial is told apart from 0, or all of it is 0 */
static bool is_none(const struct trajectory *t, int degree, bool event_state)
{
	for (int m = 0; m <= degree; m++)
		if (event_state ? mpfi_is_zero(t->piece.value[m]) <= 0 : !mpfi_has_zero(t->piece.value[m]))
			return false;
	return true;
}

static bool bounces(const struct trajectory *t, const struct guard *guard)
{
	return guard->impact >= 0 && t->s->impact[guard->impact].bounces;
}

/* Whether what may be at one instant goes one after the other: impacts touch by what was found; what lets go does so
 * before an impact. */
static bool is_met_with(const struct trajectory *t, const struct guard *guard, const struct guard *found)
{
	return (bounces(t, guard) && (bounces(t, found) || found->release)) || (guard->release && bounces(t, found));
}

/* 1: found; -1: not known; 0: none */
int trajectory_first(struct trajectory *t, int degree, mpq_srcptr tau, const struct guard **found, mpfi_ptr at)
{
	REAL end = WITH_BITS(t->precision);
	INTERVAL root = OVER_BITS(t->precision);
	int result = 0;
	mpfr_set_d(end, 1.0 + 77 * 0x1p-20, MPFR_RNDN);
	for (int k = 0; k < t->at->guards && result >= 0; k++) {
		const struct guard *guard = &t->at->guard[k];
		if (t->resting[guard->function] || (result > 0 && trajectory_meets(t, *found, guard)))
			continue;
		int terms = degree;
		expand_guard(t, guard, degree, tau);
		clear_none(t, guard, degree);
		bool fresh = is_fresh(t, guard);
		int order = fresh ? t->fresh.order[guard->function] : zeros_of(t, degree);
		if (order > 0 && degree > order)
			terms = divide_by_power(t, degree, order, fresh, tau);
		enum rise rise = first_rise(terms, (const mpfi_t *)t->piece.value, (const mpfi_t *)t->piece.slope, end,
					    root);
		if (rise == RISE_UNKNOWN && t->precision >= BITS_OF_ONE && result > 0 &&
		    is_met_with(t, guard, *found)) {
			if (guard->release)
				*found = guard;
			continue;
		}
		if (rise == RISE_UNKNOWN && t->precision >= BITS_OF_ONE && is_none(t, terms, !fresh)) {
			t->resting[guard->function] = true;     /* let go by no force */
			continue;
		}
		if (rise == RISE_UNKNOWN) {
			trajectory_lost(t, guard, "it comes closer than is known");
			result = -1;
		} else if (rise == RISE_AT && mpfr_cmp_ui(&root->left, 1) <= 0) {
			*found = guard;
			mpfi_set(at, root);
			result = 1;
			mpfr_min(end, end, &root->right, MPFR_RNDU);
		}
	}
	return result;
}

/* ---- an event ---- */

/* How far from base + s tau the event may be [s], rounded up */
static void width_of(mpfi_srcptr at, mpfr_srcptr s, mpq_srcptr tau, mpfr_ptr off)
{
	REAL other = WITH_BITS(64);
	mpfr_sub(off, &at->right, s, MPFR_RNDU);
	mpfr_sub(other, s, &at->left, MPFR_RNDU);
	mpfr_max(off, off, other, MPFR_RNDU);
	mpfr_mul_q(off, off, tau, MPFR_RNDU);
}

/* Each event would lengthen the time by all bits of the enclosures: it is kept to little more than these, and x is that
 * of any time so close. */
static bool shorten_base(struct trajectory *t, const struct stream *flow, mpfr_ptr off)
{
	const mp_bitcnt_t bits = (mp_bitcnt_t)t->precision + SPARE_BITS;
	if (mpz_sizeinbase(mpq_denref(t->base), 2) <= bits)
		return true;
	REAL least = WITH_BITS(2);
	mpfr_set_ui_2exp(least, 1, -(mpfr_exp_t)bits, MPFR_RNDN);
	mpz_mul_2exp(mpq_numref(t->base), mpq_numref(t->base), bits);
	mpz_fdiv_q(mpq_numref(t->base), mpq_numref(t->base), mpq_denref(t->base));
	mpz_set_ui(mpq_denref(t->base), 1);
	mpq_div_2exp(t->base, t->base, bits);
	mpfr_add(off, off, least, MPFR_RNDU);
	return stream_change(flow, NULL, least, t->deviation->core) && stream_change(flow, NULL, least, t->x);
}

/* What sticks and slips behind it */
static bool resolve(struct trajectory *t, const struct guard *guard, mpfr_srcptr off)
{
	trajectory_hold(t);
	if (!trajectory_resolve(t, guard, off))
		return false;
	trajectory_let_go(t, guard);
	t->noted.list[t->noted.count - 1].faint = t->fresh.order[guard->function] == 3;
	mpfr_set(t->fresh.off, off, MPFR_RNDU);
	return true;
}

bool trajectory_pass(struct trajectory *t, const struct guard *guard, int degree, mpq_srcptr tau, mpfi_srcptr at)
{
	REAL s = WITH_BITS(t->precision), off = WITH_BITS(64);
	RATIONAL part = ZERO;
	const struct stream *before = t->at->flow;
	mpfi_mid(s, at);
	if (mpfi_cmp_ui(at, 1) == 0)
		mpfr_set_ui(s, 1, MPFR_RNDN);
	if (mpfr_cmp_ui(&at->left, 0) <= 0)
		mpfr_set_zero(s, 1);
	/* Of a reference, which a target is to follow: impacts may enlarge its rounding each time, as they do boxes. */
	const bool followed = t->noted.most > 0 && has_events(t->s);
	width_of(at, s, tau, off);
	deviation_over_part(t, degree, tau, s);
	deviation_take(t);
	mpfr_get_q(part, s);
	mpq_mul(part, part, tau);
	mpq_add(t->base, t->base, part);
	bool known = shorten_base(t, before, off);
	t->piece.at_once = mpq_sgn(part) == 0 ? t->piece.at_once + 1 : 0;
	trajectory_note(t, guard, off);
	deviation_begin(t);
	if (guard->impact >= 0) {
		mpfi_clear(t->noted.list[--t->noted.count].at);    /* its impact is noted again */
		known = known && trajectory_impact(t, guard, off);
	} else {
		trajectory_enter(t, t->region + guard->leads);
		known = known && stream_change(before, t->at->flow, off, t->x);
		if (has_events(t->s))
			known = known && resolve(t, guard, off);
	}
	trajectory_hold(t);
	const bool crossed = known && !followed && deviation_cross(t, guard, before, off);
	trajectory_loads(t);
	(crossed ? deviation_loads : deviation_renew)(t);
	if (!known)
		return t->undecided ? false : trajectory_lost(t, guard, "when is not known well enough");
	if (t->noted.most > 0 && t->noted.count >= t->noted.most)
		return trajectory_lost(t, guard, "that many crossings are not followed");
	return t->piece.at_once < AT_ONCE || trajectory_lost(t, guard, "breakpoints are passed without end");
}
