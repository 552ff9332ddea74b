/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a way through crossings: what sticks and what slips, by the rules of runtime/guards.c; each sign that decides is
 * enclosed apart from 0, or what it decides is not known. */
#include "step/through.h"

#include <math.h>

enum { MOST_IDLE = 6 };

struct idle {                       /* an expression on a breakpoint that stands twice */
	int expression, stick;      /* stick: the interval between */
	int impact;                 /* that rests there; -1: it is friction */
	int goes;                   /* 1, -1: it has just been let go to this side; 0: it has not */
};

/* Whether all of an enclosure is 0 to half of the bits, BITS_OF_ONE or fewer, of such a size, or of 2^-64 */
bool through_is_none(const struct through *t, mpfi_srcptr value, double size)
{
	const int bits = t->precision < BITS_OF_ONE ? t->precision : BITS_OF_ONE;
	REAL least = WITH_BITS(53);
	mpfr_set_d(least, fmax(size, 0x1p-64), MPFR_RNDN);
	mpfr_div_2si(least, least, bits / 2, MPFR_RNDN);
	return mpfr_cmpabs(&value->left, least) <= 0 && mpfr_cmpabs(&value->right, least) <= 0;
}

/* What row . x may be summed from: of positions and of speeds the largest */
double through_size(const struct through *t, const mpq_t *row)
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
int through_sign(const struct through *t, const mpq_t *row, mpq_srcptr less, bool *known)
{
	INTERVAL value = OVER_BITS(t->precision);
	through_dot(t, row, t->x, value);
	if (less)
		mpfi_sub_q(value, value, less);
	int sign = mpfr_sgn(&value->left) > 0 ? 1 : mpfr_sgn(&value->right) < 0 ? -1 : 0;
	*known = sign != 0 || (mpfr_zero_p(&value->left) && mpfr_zero_p(&value->right)) ||
		 (t->whole->asked.solution && t->precision >= BITS_OF_ONE &&
		  through_is_none(t, value, through_size(t, row) + (less ? fabs(mpq_get_d(less)) : 0)));
	return sign;
}

mpq_t *through_row_of(const struct through *t, const struct output *output)
{
	mpq_t *row = rationals(t->n);
	through_row(t, output, row);
	return row;
}

void through_assign(struct through *t, int state, const struct output *output, mpfi_t *fresh)
{
	RATIONALS *row = through_row_of(t, output);
	through_dot(t, row, t->x, fresh[state]);
}

void through_hold(struct through *t)
{
	const struct region *r = &t->s->region[t->region];
	for (int k = 0; k < r->holds; k++)
		through_assign(t, r->hold[k].state, r->hold[k].row, t->y);
	for (int k = 0; k < r->holds; k++)
		mpfi_set(t->x[r->hold[k].state], t->y[r->hold[k].state]);
}

bool through_unknown(struct through *t, const char *what)
{
	t->undecided = format("at t = %s s it is not known %s", through_time(t->base), what);
	return false;
}

/* ---- what sticks and what slips ---- */

static int find_idle(const struct through *t, const struct gate *gate, struct idle *idle)
{
	int count = 0;
	for (int e = 0; e < t->s->expressions && count < MOST_IDLE; e++) {
		const struct expression *x = &t->s->expression[e];
		int interval = interval_of(t->s, t->region, e);
		bool let_go = gate && gate->release && gate->expression == e;
		if (let_go)
			interval -= gate->upward ? 1 : -1;
		if (is_stick(x, interval))
			idle[count++] = (struct idle){ e, interval, impact_resting(t->s, t->segment, e, interval),
						       let_go ? gate->upward ? 1 : -1 : 0 };
	}
	return count;
}

/* 1: its force holds it in a region, 0: it does not, -1: not known */
static int is_held(struct through *t, struct area *area, const struct idle *idle)
{
	for (int k = 0; k < area->gates; k++) {
		const struct gate *gate = &area->gate[k];
		bool known;
		if (gate->expression != idle->expression || !gate->release)
			continue;
		if (idle->goes == (gate->upward ? 1 : -1))
			return 0;
		int sign = through_sign(t, gate->row, gate->limit, &known);
		if (known && sign == 0)
			sign = through_sign(t, gate->slope, NULL, &known);
		if (!known)
			return -1;
		if (sign > 0)
			return 0;
	}
	return 1;
}

/* The side to which an expression on a breakpoint moves in a region, by its first derivative that is not 0 */
int through_heads(struct through *t, const struct area *area, int expression, bool *known)
{
	mpq_t *row = through_row_of(t, t->s->expression[expression].row);
	int sign = 0;
	*known = true;
	for (int k = 0; k < t->n && sign == 0 && *known; k++) {
		mpq_t *next = through_times(t, row, area->A);
		rationals_free(row, (size_t)t->n);
		row = next;
		sign = through_sign(t, row, NULL, known);
	}
	rationals_free(row, (size_t)t->n);
	return sign;
}

/* 1: all agree with the region, 0: one does not, -1: not known */
static int agrees(struct through *t, int region, const struct idle *idle, int count)
{
	int all = 1;
	if (!t->s->region[region].possible)
		return 0;
	struct area *area = through_area(t, region);
	for (int i = 0; i < count; i++) {
		int side = interval_of(t->s, region, idle[i].expression) - idle[i].stick, agree = 1;
		bool known = true;
		if (idle[i].impact >= 0 && side == (t->s->impact[idle[i].impact].in[t->segment].upward ? 1 : -1))
			return 0;
		if (side == 0)
			agree = is_held(t, area, &idle[i]);
		else if (side != idle[i].goes || idle[i].impact < 0) {
			int sign = through_heads(t, area, idle[i].expression, &known);
			agree = !known ? side == idle[i].goes ? 1 : -1 : sign == side;
		}
		if (agree == 0)
			return 0;
		all = agree < 0 ? -1 : all;
	}
	return all;
}

static int region_with(const struct through *t, const struct idle *idle, int count, int code, int *score)
{
	int region = t->region;
	*score = 0;
	for (int i = 0; i < count; i++, code /= 3) {
		int now = interval_of(t->s, region, idle[i].expression), then = idle[i].stick + code % 3 - 1;
		region += (then - now) * t->s->expression[idle[i].expression].stride;
		*score += (then != now) * 2 * MOST_IDLE + (code % 3 != 1);
	}
	return region;
}

static void note_change(struct through *t, const struct idle *idle, int count, int region, mpfr_srcptr off)
{
	for (int i = 0; i < count; i++) {
		int now = interval_of(t->s, t->region, idle[i].expression);
		int then = interval_of(t->s, region, idle[i].expression);
		for (int way = then > now ? 1 : -1; now != then; now += way)
			through_note_plain(t, idle[i].expression, way > 0 ? now : now - 1, way > 0, off);
	}
}

/* How often an expression that was let go has the value 0 where it is: with its slope, and for a contact, whose force
 * was 0, with its acceleration */
static int order_of(struct through *t, const struct gate *gate)
{
	bool known;
	if (!gate->release)
		return 0;
	if (impact_resting(t->s, t->segment, gate->expression,
			   interval_of(t->s, t->region, gate->expression) - (gate->upward ? 1 : -1)) >= 0)
		return 3;
	RATIONALS *row = through_row_of(t, t->s->expression[gate->expression].row);
	RATIONALS *slope = through_times(t, row, t->at->A);
	int sign = through_sign(t, slope, NULL, &known);
	return known && sign != 0 ? 0 : 2;
}

void through_let_go(struct through *t, const struct gate *gate)
{
	t->order[gate->expression] = order_of(t, gate);
	t->back[gate->expression] = !gate->upward;
}

/* Of sliders without mass one that would slide back where it is; -1: none does, -2: not known. What is 0, as all that
 * slides with one velocity is where it is met as 0, counts by its slope. */
static int slides_back(const struct through *t, const struct gate *met, const struct gate **release)
{
	for (int k = 0; k < t->at->gates; k++) {
		const struct gate *gate = &t->at->gate[k];
		bool known;
		if (!gate->release || is_stick(&t->s->expression[gate->expression],
					       interval_of(t->s, t->region, gate->expression)))
			continue;
		int sign = through_sign(t, gate->row, NULL, &known);
		bool none = known && sign == 0;
		if (!known && met)
			none = through_meets(t, met, gate);
		if (none)
			sign = through_sign(t, gate->slope, NULL, &known);
		*release = gate;
		if (!known)
			return -2;
		if (sign > 0)
			return gate->expression;
	}
	return -1;
}

/* A slider without mass whose velocity an event has turned round sticks from there on. */
static bool settle_sliders(struct through *t, const struct gate *gate, mpfr_srcptr off)
{
	const struct gate *release, **gone;
	if (t->s->sliders == 0)
		return true;
	through_hold(t);
	gone = ARRAY(const struct gate *, t->s->expressions);
	int count = 0, back = slides_back(t, gate, &release);
	for (; back >= 0 && count < t->s->expressions; count++) {
		gone[count] = release;
		if (off)
			through_note_plain(t, back, release->breakpoint, release->upward, off);
		through_enter(t, t->region + release->leads);
		through_hold(t);
		back = slides_back(t, gate, &release);
	}
	for (int k = 0; k < count && back == -1; k++)
		through_let_go(t, gone[k]);
	if (off)
		mpfr_set(t->fresh_off, off, MPFR_RNDU);
	else
		mpfr_set_zero(t->fresh_off, 1);
	discard(gone);
	return back == -1 || through_unknown(t, "what slides on");
}

/* Contacts at rest that are let go have the value 0 where they are, with their slopes. */
static void note_parting(struct through *t, const struct idle *idle, int count, int before, mpfr_srcptr off)
{
	for (int i = 0; i < count; i++) {
		int e = idle[i].expression;
		if (idle[i].impact < 0 || interval_of(t->s, before, e) != idle[i].stick ||
		    interval_of(t->s, t->region, e) == idle[i].stick)
			continue;
		t->order[e] = 2;
		t->back[e] = t->s->impact[idle[i].impact].in[t->segment].upward;
		if (off)
			mpfr_set(t->fresh_off, off, MPFR_RNDU);
		else
			mpfr_set_zero(t->fresh_off, 1);
	}
}

static bool settle_idle(struct through *t, const struct gate *gate, mpfr_srcptr off)
{
	struct idle idle[MOST_IDLE];
	int count = find_idle(t, gate, idle), codes = 1, best = -1;
	if (count == 0)
		return true;
	for (int i = 0; i < count; i++)
		codes *= 3;
	for (int least = 0; best < 0 && least <= MOST_IDLE * (2 * MOST_IDLE + 1); least++)
		for (int code = 0; code < codes && best < 0; code++) {
			int score, region = region_with(t, idle, count, code, &score);
			int agree = score == least ? agrees(t, region, idle, count) : 0;
			if (agree < 0)
				return through_unknown(t, "what sticks and what slips");
			best = agree > 0 ? region : -1;
		}
	if (best < 0)
		return through_unknown(t, "what sticks: no combination of what sticks and what slips agrees");
	if (best == t->region)
		return true;
	int before = t->region;
	if (off)
		note_change(t, idle, count, best, off);
	through_enter(t, best);
	note_parting(t, idle, count, before, off);
	return true;
}

bool through_settle(struct through *t, const struct gate *gate, mpfr_srcptr off)
{
	return settle_idle(t, gate, off) && settle_sliders(t, gate, off);
}
