/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a verified trajectory: impacts, what comes to rest by them, what sticks and what slips, by the law of the
 * target, runtime/contacts.h, over enclosures: the nearest number of each, and 0 where it has 0. What that decides
 * while it is more than rounding is not known, and more bits are asked for. */
#include "model/contacts/contacts.h"
#include "certify.h"
#include "event_state.h"

#include <float.h>
#include <limits.h>
#include <math.h>

/* ---- what the law is compiled with ---- */

typedef double real;
typedef struct law contacts;
typedef struct trajectory instant;

enum { MOST = 6, MOST_IMPACTS = 200, MOST_SWEPT = 100000, SELFTEST_BRIEF = 16 };

#define LISTED_AT_ONCE INT_MAX      /* what a selftest compares ends before */
#define HANGING 0                   /* that comes first by its changes, and is not known */
#define IN_DOUBT (1 << 16)
#define CALM m->calm
#define BRIEF m->brief
#define TOGETHER (m->solution ? BRIEF : SELFTEST_BRIEF * BRIEF)
#define SPAN m->span

struct bound {                      /* an impact in this segment of time */
	int expression, breakpoint, upward, rest;
	double restitution;
	const struct impact_law *impact_law;
	mpq_t *speed, *place, **jump, **still;  /* rows over x */
};

struct law {
	const struct switching *s;
	int segment, impacts, max_events, most;
	bool solution;
	double h, calm, brief, span;
	struct bound *impact;
};

static real larger(real a, real b)
{
	return a > b ? a : b;
}

static real smaller(real a, real b)
{
	return a < b ? a : b;
}

static real magnitude(real a)
{
	return fabs(a);
}

static int interval_in(const struct law *m, int region, int expression)
{
	return interval_of(m->s, region, expression);
}

static int place_of_rest(const struct trajectory *t, const struct impact *p)
{
	return rest_of(t->s, t->when.segment, p);
}

#define interval_of interval_now    /* names of the law, which the model has otherwise */
#define rest_of rest_in
#define give_up end_impacts
#include "contacts.h"
#include "agree.h"

/* ---- impacts of a segment of time ---- */

static int breakpoint_of(const struct trajectory *t, const struct impact_law *impact_law, bool bounces)
{
	const struct switching_function *e = &t->s->function[impact_law->function];
	int b = 0;
	while (!mpq_equal(e->at[b], impact_law->at))
		b++;
	return b + (bounces && !impact_law->upward);
}

static mpq_t **rows_of_jumps(const struct trajectory *t, int jumps, const struct jump *list)
{
	mpq_t **row = ARRAY(mpq_t *, (size_t)jumps + 1);
	for (int k = 0; k < jumps && list; k++)
		row[k] = trajectory_row_of(t, list[k].row);
	return row;
}

static void fill_bound(const struct trajectory *t, int k, struct bound *b)
{
	const struct impact *p = &t->s->impact[k];
	const struct impact_law *impact_law = &p->in[t->when.segment];
	*b = (struct bound){ .expression = impact_law->function, .upward = impact_law->upward, .rest = -1,
			    .impact_law = impact_law };
	b->breakpoint = breakpoint_of(t, impact_law, p->bounces);
	b->restitution = p->bounces ? mpq_get_d(impact_law->restitution) : 0;
	b->place = trajectory_row_of(t, t->s->function[impact_law->function].row);
	b->jump = rows_of_jumps(t, impact_law->jumps, impact_law->jump);
	if (!p->bounces)        /* it has no speed */
		return;
	b->speed = trajectory_row_of(t, impact_law->speed_row);
	b->rest = place_of_rest(t, p);
	b->still = rows_of_jumps(t, impact_law->jumps, impact_law->still);
}

static const struct law *law_of(struct trajectory *t)
{
	const bool solution = t->full->request.solution, coarse = t->full->request.single && !solution;
	if (t->law && t->law->segment == t->when.segment)
		return t->law;
	if (!t->law)
		t->chain = no_impact(mpq_get_d(t->full->h));
	struct law *m = NEW(struct law);
	*m = (struct law){ .s = t->s, .segment = t->when.segment, .impacts = t->s->impacts,
			   .max_events = INT_MAX / 4, .most = MOST_IN_STEP, .solution = solution,
			   .h = mpq_get_d(t->full->h), .calm = coarse ? 0x1p-20 : 0x1p-48,
			   .brief = coarse ? 0x1p-10 : 0x1p-23, .span = coarse ? 0x1p-8 : 0x1p-10 };
	m->impact = ARRAY(struct bound, (size_t)m->impacts + 1);
	for (int k = 0; k < m->impacts; k++)
		fill_bound(t, k, &m->impact[k]);
	return t->law = m;
}

/* ---- numbers of enclosures ---- */

/* The end of an enclosure that is next to 0, 0 where it has 0 */
static double nearest(mpfi_srcptr value)
{
	if (mpfi_has_zero(value))
		return 0;
	return mpfr_get_d(mpfi_is_neg(value) ? &value->right : &value->left, MPFR_RNDA);
}

static bool is_none(const struct trajectory *t, const mpq_t *row)
{
	INTERVAL value = OVER_BITS(t->precision);
	trajectory_dot(t, row, t->x, value);
	return trajectory_is_none(t, value, trajectory_size(t, row));
}

static double value_of(const struct trajectory *t, const mpq_t *row)
{
	INTERVAL value = OVER_BITS(t->precision);
	trajectory_dot(t, row, t->x, value);
	return nearest(value);
}

/* ---- what the law asks for ---- */

static real unit(const contacts *m)
{
	(void)m;
	return 1;
}

static real step_of(const contacts *m)
{
	return m->h;
}

static int interval_of(const contacts *m, const instant *t, int expression)
{
	return interval_in(m, t->region, expression);
}

static int interval_before(const contacts *m, const instant *t, int expression)
{
	return interval_in(m, t->event_state->before, expression);
}

static void go_to(const contacts *m, instant *t, int expression, int interval)
{
	int now = interval_of(m, t, expression);
	if (now != interval)
		trajectory_enter(t, t->region + (interval - now) * t->s->function[expression].stride);
}

static void renew(const contacts *m, instant *t)
{
	(void)m;
	(void)t;
}

static int stride_of(const contacts *m, int expression)
{
	return m->s->function[expression].stride;
}

static int is_possible(const contacts *m, int region)
{
	return m->s->region[region].possible;
}

static int region_now(const instant *t)
{
	return t->region;
}

static int can_be(const contacts *m, const instant *t)
{
	return is_possible(m, t->region);
}

static int rest_of(const contacts *m, int k)
{
	return m->impact[k].rest;
}

static real depth(const contacts *m, const instant *t, int k, real *noise)
{
	const struct bound *b = &m->impact[k];
	INTERVAL value = OVER_BITS(t->precision);
	trajectory_dot(t, b->place, t->x, value);
	mpfi_sub_q(value, value, b->impact_law->at);
	*noise = 0;
	return b->upward ? nearest(value) : -nearest(value);
}

/* What is 2^-96 of the fastest is over. */
static real speed_of(const contacts *m, const instant *t, int k)
{
	const double speed = t->undecided ? 0 : value_of(t, m->impact[k].speed);
	return fabs(speed) <= t->chain.most * m->calm * m->calm ? 0 : speed;
}

/* What rests does not come closer, nor what had an impact without restitution. */
static real speed_of_met(const contacts *m, instant *t, int k)
{
	const struct bound *b = &m->impact[k];
	const double speed = speed_of(m, t, k);
	const bool still = rests(m, t, k) || (t->event_state->acted >> k & 1 && !(b->restitution > 0));
	t->event_state->flies = false;
	if (speed == 0 && !still && k != t->event_state->begins && value_of(t, b->speed) == 0 && !is_none(t, b->speed))
		trajectory_unknown(t, "whether what touches comes closer");
	return speed;
}

static real least_speed(const contacts *m, const instant *t, real least)
{
	(void)m;
	(void)t;
	return larger(least, 0);
}

/* All further bounces of what leaves with v and is pressed back by a: 2 v/(a (1 - e)) */
static void note_flight(const struct trajectory *t, const struct bound *b, mpfi_srcptr press)
{
	RATIONAL loss = ZERO;
	t->event_state->bounces = b->restitution > 0;
	mpq_set_ui(loss, 1, 1);
	mpq_sub(loss, loss, b->impact_law->restitution);
	trajectory_dot(t, b->speed, t->x, t->event_state->flight);
	mpfi_abs(t->event_state->flight, t->event_state->flight);
	mpfi_div(t->event_state->flight, t->event_state->flight, press);
	mpfi_mul_ui(t->event_state->flight, t->event_state->flight, 2);
	if (mpq_sgn(loss) > 0)
		mpfi_div_q(t->event_state->flight, t->event_state->flight, loss);
}

/* Of no force, where it does not move, by where it is heading; of one that is not known, the most that it may be */
static real press_of(const contacts *m, const instant *t, int k)
{
	const struct bound *b = &m->impact[k];
	RATIONALS *row = trajectory_times(t, b->speed, t->at->A);
	INTERVAL press = OVER_BITS(t->precision);
	bool known;
	int sign = trajectory_sign(t, row, NULL, &known);
	trajectory_dot(t, row, t->x, press);
	t->event_state->flies = sign > 0;
	t->event_state->doubtful = known ? -1 : k;
	if (sign > 0)
		note_flight(t, b, press);
	if (sign != 0)
		return nearest(press);
	if (!known)
		return fmax(fabs(mpfr_get_d(&press->left, MPFR_RNDA)), fabs(mpfr_get_d(&press->right, MPFR_RNDA)));
	if (!m->solution || value_of(t, b->speed) != 0)
		return 0;
	return trajectory_heads(t, t->at, b->expression, true, &known) == (b->upward ? 1 : -1) ? DBL_MIN : 0;
}

static void assign(struct trajectory *t, int count, const struct jump *jump, mpq_t *const *row)
{
	SCRATCH int *state = ARRAY(int, (size_t)count + 1);
	for (int k = 0; k < count; k++)
		state[k] = jump[k].state;
	trajectory_assign(t, count, state, row);
}

static void jump(const contacts *m, instant *t, int k)
{
	const struct bound *b = &m->impact[k];
	assign(t, b->impact_law->jumps, b->impact_law->jump, b->jump);
	t->event_state->acted |= 1u << k;
	t->event_state->begins = -1;
	if (!m->solution && t->chain.impacts > MOST_IMPACTS)
		trajectory_unknown(t, "whether what touches comes closer");
}

static void stop(const contacts *m, instant *t, int k)
{
	const struct bound *b = &m->impact[k];
	if (b->rest < 0 || t->undecided)
		return;
	assign(t, b->impact_law->jumps, b->impact_law->still, b->still);
	if (t->event_state->doubtful == k)
		trajectory_unknown(t, "whether what bounces comes to rest");
	if (++t->event_state->swept > MOST_SWEPT)
		trajectory_unknown(t, "what impacts without end come to: so many are not followed");
}

static void put_on(const contacts *m, instant *t, int k)
{
	(void)m;        /* enclosed, it is there */
	(void)t;
	(void)k;
}

static void keep(const contacts *m, instant *t)
{
	(void)m;
	trajectory_hold(t);
}

/* An event is listed by its enclosed time, and what bounces on behind it by that of the last bounce. */
static int has_listed(const contacts *m, instant *t, int loses, real time, int expression, int breakpoint, int upward)
{
	(void)m;
	(void)loses;
	(void)time;
	if (!t->event_state->off)
		return 1;
	trajectory_note_plain(t, expression, breakpoint, upward, t->event_state->off);
	if (t->event_state->flies) {
		struct passed *last = &t->noted.list[t->noted.count - 1];
		last->stands = t->event_state->bounces && mpfi_has_zero(t->event_state->flight);
		mpfi_add(last->at, last->at, t->event_state->flight);
		t->event_state->flies = false;
	}
	return 1;
}

static int listed(const instant *t)
{
	(void)t;
	return 0;
}

static void count_rest(instant *t)
{
	(void)t;
}

static void say(instant *t, int status)
{
	if (t->undecided || status == 0)
		return;
	if (status == IN_DOUBT)
		trajectory_unknown(t, "what sticks and what slips");
	else if (status == PL_UNDECIDED)
		trajectory_unknown(t, "what sticks: no combination of what sticks and what slips agrees");
	else
		trajectory_unknown(t, "whether what touches comes closer");
}

/* What a load that jumps, or an impact, takes out of its interval passes the breakpoint there. */
static void follow(const contacts *m, instant *t, int jumped)
{
	for (int e = 0; e < t->s->functions; e++) {
		const struct switching_function *x = &t->s->function[e];
		for (int way = 1; way;) {
			const int interval = interval_of(m, t, e);
			way = interval < x->breaks && trajectory_side(t, e, x->at[interval]) > 0	  ? 1
			      : interval > 0 && trajectory_side(t, e, x->at[interval - 1]) < 0 ? -1 : 0;
			if (way == 0 || (!jumped && is_stopped(m, t, e, way)))
				break;
			(void)has_listed(m, t, 1, t->time, e, interval - (way < 0), way > 0);
			trajectory_enter(t, t->region + way * x->stride);
		}
	}
}

/* ---- what sticks, rests or slips ---- */

/* The side to which the guard that was met has let a switching function go; 0: it has not */
static int side_let_go(const instant *t, int expression)
{
	const struct guard *guard = t->event_state->met;
	return !guard || !guard->release || guard->function != expression ? 0 : guard->upward ? 1 : -1;
}

/* Whether the speed of a contact is but rounding: what rests has none */
static bool is_still(const contacts *m, const instant *t, int k)
{
	return rests(m, t, k) ? value_of(t, m->impact[k].speed) == 0 : is_none(t, m->impact[k].speed);
}

/* Whether what is next to its hold is there, with a velocity that is but rounding; what may bounce comes to rest by the
 * time of its bounces, as on the target rounding makes some velocity of none */
static bool is_there(const contacts *m, const instant *t, int expression, int held, int impact)
{
	if (impact < 0) {
		RATIONALS *row = trajectory_row_of(t, t->s->function[expression].row);
		INTERVAL velocity = OVER_BITS(t->precision);
		trajectory_dot(t, row, t->x, velocity);
		mpfi_sub_q(velocity, velocity, t->s->function[expression].at[held]);
		return trajectory_is_none(t, velocity, trajectory_size(t, row));
	}
	return !(m->impact[impact].restitution > 0) && touches(m, t, impact) && is_still(m, t, impact);
}

static int find_resting(const contacts *m, const instant *t, resting *found)
{
	int count = 0;
	for (int e = 0; e < t->s->functions; e++)
		for (int k = 1; k < t->s->function[e].breaks && count < MOST; k++) {
			const int side = interval_of(m, t, e) - k, impact = impact_resting(t->s, t->when.segment, e, k);
			if (!is_stick(&t->s->function[e], k) || side < -1 || side > 1)
				continue;
			if (side == 0 || side == side_let_go(t, e) || is_there(m, t, e, k, impact))
				found[count++] = (resting){ .expression = e, .held = k, .impact = impact };
		}
	return count;
}

static int holds_in(const contacts *m, instant *t, int region, int expression)
{
	const struct area *area = trajectory_area(t, region);
	(void)m;
	for (int k = 0; k < area->guards; k++) {
		const struct guard *guard = &area->guard[k];
		bool known;
		if (guard->function != expression || !guard->release)
			continue;
		if (side_let_go(t, expression) == (guard->upward ? 1 : -1))
			return 0;
		int sign = trajectory_sign(t, guard->row, guard->limit, &known);
		if (known && sign == 0)
			sign = trajectory_sign(t, guard->slope, NULL, &known);
		if (!known || sign > 0)
			return !known;
	}
	return 2;
}

static int heading_in(const contacts *m, instant *t, int region, const resting *one, int *known)
{
	const bool still = one->impact >= 0 && is_still(m, t, one->impact);
	bool event_state;
	const int way = trajectory_heads(t, trajectory_area(t, region), one->expression, still, &event_state);
	*known = event_state;
	return way;
}

static int is_freed(const contacts *m, const instant *t, int region, const resting *one, int side, int known)
{
	(void)m;
	(void)region;
	return side == side_let_go(t, one->expression) && (one->impact >= 0 || !known);
}

static int is_pressed(const contacts *m, const instant *t, int k)
{
	bool known, any = false;
	t->event_state->flies = false;
	t->event_state->doubtful = -1;
	if (!m->solution)
		t->event_state->together = true;
	for (int g = 0; g < t->at->guards; g++) {
		const struct guard *guard = &t->at->guard[g];
		if (!guard->release || guard->function != m->impact[k].expression)
			continue;
		if (trajectory_sign(t, guard->row, guard->limit, &known) >= 0)
			return 0;
		any = true;
	}
	return any;
}

/* ---- events ---- */

/* guard: what was met, NULL: nothing; off: how far from base it may be, NULL: what changes is not listed */
static const struct law *begin(struct trajectory *t, const struct guard *guard, mpfr_srcptr off)
{
	const struct law *m = law_of(t);
	t->event_state->met = guard;
	t->event_state->off = off;
	t->event_state->acted = 0;
	t->event_state->swept = 0;
	t->event_state->begins = t->event_state->doubtful = -1;
	t->event_state->flies = t->event_state->together = false;
	t->time = mpq_get_d(t->base);
	t->event_state->before = t->region;
	t->chain.all = 0;
	return m;
}

/* What is on its guard with a speed of 0, and rested there before or had an impact without restitution, has the value 0
 * where it is, with its slope. */
static void note_touching(const struct law *m, struct trajectory *t)
{
	for (int k = 0; k < m->impacts; k++) {
		const struct bound *b = &m->impact[k];
		const bool rested = b->rest >= 0 && interval_in(m, t->event_state->before, b->expression) == b->rest,
			   acted = t->event_state->acted >> k & 1 && !(b->restitution > 0);
		if (b->rest < 0 || !(rested || acted) || rests(m, t, k) || !touches(m, t, k) ||
		    fabs(speed_of(m, t, k)) > 0)
			continue;
		t->fresh.order[b->expression] = 2;
		t->fresh.back[b->expression] = b->upward;
		if (t->event_state->off)
			mpfr_set(t->fresh.off, t->event_state->off, MPFR_RNDU);
		else
			mpfr_set_zero(t->fresh.off, 1);
	}
}

bool trajectory_resolve(struct trajectory *t, const struct guard *guard, mpfr_srcptr off)
{
	const struct law *m = begin(t, guard, off);
	if (guard)
		t->event_state->before -= guard->leads;
	resolve(m, t, guard != NULL);
	note_touching(m, t);
	return !t->undecided && trajectory_slide(t, guard, off);
}

bool trajectory_take_up(struct trajectory *t, mpfr_srcptr off)
{
	const struct law *m = begin(t, NULL, off);
	follow(m, t, 1);
	(void)apply_impacts(m, t, -1);
	resolve(m, t, 0);
	keep(m, t);
	note_touching(m, t);
	return !t->undecided && trajectory_slide(t, NULL, off);
}

bool trajectory_impact(struct trajectory *t, const struct guard *guard, mpfr_srcptr off)
{
	const struct law *m = begin(t, NULL, off);
	bool known = stream_change(t->at->flow, NULL, off, t->x);
	trajectory_enter(t, t->region + (m->impact[guard->impact].rest >= 0 ? 0 : guard->leads));
	t->event_state->begins = guard->impact;
	const unsigned acted = apply_impacts(m, t, guard->impact);
	known = known && stream_change(t->at->flow, NULL, off, t->x);
	if (!known || t->undecided)
		return t->undecided ? false : trajectory_unknown(t, "when an impact is");
	follow(m, t, 0);
	resolve(m, t, 1);
	come_to_rest(m, t, acted);
	keep(m, t);
	if (t->event_state->together)
		return trajectory_unknown(t, "whether several come to rest together");
	note_touching(m, t);
	return !t->undecided && trajectory_slide(t, NULL, off);
}
