/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a way through crossings: dry friction and impacts, by the rules of runtime/guards.c; each sign that decides is
 * enclosed apart from 0, or what it decides is not known. */
#include "step/through.h"

#include <math.h>

enum { MOST_IDLE = 6, MOST_STRUCK = 200, MOST_SOLVED = 4000 };

struct idle {                       /* an expression on a breakpoint that stands twice */
	int expression, stick;      /* stick: the interval between */
	int impact;                 /* that rests there; -1: it is friction */
	int goes;                   /* 1, -1: it has just been let go to this side; 0: it has not */
};

/* Of row . x - less: its sign, 0 where it is exactly 0; *known false: it is not told apart from 0 */
static int sign_of(const struct through *t, const mpq_t *row, mpq_srcptr less, bool *known)
{
	mpfi_t value;
	mpfi_init2(value, t->precision);
	through_dot(t, row, (const mpfi_t *)t->x, value);
	if (less)
		mpfi_sub_q(value, value, less);
	int sign = mpfr_sgn(&value->left) > 0 ? 1 : mpfr_sgn(&value->right) < 0 ? -1 : 0;
	*known = sign != 0 || (mpfr_zero_p(&value->left) && mpfr_zero_p(&value->right));
	mpfi_clear(value);
	return sign;
}

static mpq_t *row_of(const struct through *t, const struct output *output)
{
	mpq_t *row = rationals((size_t)t->n);
	through_row(t, output, row);
	return row;
}

static void assign(struct through *t, int state, const struct output *output, mpfi_t *fresh)
{
	mpq_t *row = row_of(t, output);
	through_dot(t, (const mpq_t *)row, (const mpfi_t *)t->x, fresh[state]);
	rationals_free(row, (size_t)t->n);
}

static void jump(struct through *t, int jumps, const struct jump *list)
{
	for (int k = 0; k < jumps; k++)
		assign(t, list[k].state, list[k].row, t->y);
	for (int k = 0; k < jumps; k++)
		mpfi_set(t->x[list[k].state], t->y[list[k].state]);
}

void through_hold(struct through *t)
{
	const struct region *r = &t->s->region[t->region];
	for (int k = 0; k < r->holds; k++)
		assign(t, r->hold[k].state, r->hold[k].row, t->y);
	for (int k = 0; k < r->holds; k++)
		mpfi_set(t->x[r->hold[k].state], t->y[r->hold[k].state]);
}

static bool unknown(struct through *t, const char *what)
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
		int sign = sign_of(t, (const mpq_t *)gate->row, gate->limit, &known);
		if (known && sign == 0)
			sign = sign_of(t, (const mpq_t *)gate->slope, NULL, &known);
		if (!known)
			return -1;
		if (sign > 0)
			return 0;
	}
	return 1;
}

/* The side to which an expression on a breakpoint moves in a region, by its first derivative that is not 0 */
static int heads(struct through *t, const struct area *area, int expression, bool *known)
{
	mpq_t *row = row_of(t, t->s->expression[expression].row);
	int sign = 0;
	*known = true;
	for (int k = 0; k < t->n && sign == 0 && *known; k++) {
		mpq_t *next = through_times(t, (const mpq_t *)row, (const mpq_t *)area->A);
		rationals_free(row, (size_t)t->n);
		row = next;
		sign = sign_of(t, (const mpq_t *)row, NULL, known);
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
			int sign = heads(t, area, idle[i].expression, &known);
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
	mpq_t *row = row_of(t, t->s->expression[gate->expression].row);
	mpq_t *slope = through_times(t, (const mpq_t *)row, (const mpq_t *)t->at->A);
	int sign = sign_of(t, (const mpq_t *)slope, NULL, &known);
	rationals_free(row, (size_t)t->n);
	rationals_free(slope, (size_t)t->n);
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
		int sign = sign_of(t, (const mpq_t *)gate->row, NULL, &known);
		bool none = known && sign == 0;
		if (!known && met)
			none = through_meets(t, met, gate);
		if (none)
			sign = sign_of(t, (const mpq_t *)gate->slope, NULL, &known);
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
	gone = ARRAY(const struct gate *, (size_t)t->s->expressions);
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
	return back == -1 || unknown(t, "what slides on");
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
				return unknown(t, "what sticks and what slips");
			best = agree > 0 ? region : -1;
		}
	if (best < 0)
		return unknown(t, "what sticks: no combination of what sticks and what slips agrees");
	if (best == t->region)
		return true;
	if (off)
		note_change(t, idle, count, best, off);
	through_enter(t, best);
	return true;
}

bool through_settle(struct through *t, const struct gate *gate, mpfr_srcptr off)
{
	return settle_idle(t, gate, off) && settle_sliders(t, gate, off);
}

/* ---- impacts ---- */

static int free_of(const struct through *t, const struct impact *p)
{
	return rest_of(t->s, t->segment, p) + (p->in[t->segment].upward ? -1 : 1);
}

static void go_to(struct through *t, const struct impact *p, int interval)
{
	int now = interval_of(t->s, t->region, p->in[t->segment].expression);
	if (now != interval)
		through_enter(t, t->region + (interval - now) * t->s->expression[p->in[t->segment].expression].stride);
}

static int breakpoint_of(const struct through *t, const struct impact *p)
{
	const struct expression *e = &t->s->expression[p->in[t->segment].expression];
	int b = 0;
	while (!mpq_equal(e->at[b], p->in[t->segment].at))
		b++;
	return b + (p->bounces && !p->in[t->segment].upward);
}

static bool touches(const struct through *t, const struct impact *p)
{
	int interval = interval_of(t->s, t->region, p->in[t->segment].expression);
	return p->bounces && (interval == rest_of(t->s, t->segment, p) || interval == free_of(t, p)) &&
	       through_side(t, p->in[t->segment].expression, p->in[t->segment].at) == 0;
}

/* Whether a speed is 0 to half the digits of the largest: speeds that impacts have made equal */
static bool is_none(const struct through *t, const mpq_t *row)
{
	mpfi_t value;
	double most = 0, size = 0;
	mpfi_init2(value, t->precision);
	through_dot(t, row, (const mpfi_t *)t->x, value);
	for (int i = t->system->n; i < t->layout.states; i++) {
		most = fmax(most, fabs(mpfi_get_d(t->x[i])));
		size += fabs(mpq_get_d(row[i]));
	}
	size = ldexp(size * most, -t->precision / 2);
	bool none = fabs(mpfr_get_d(&value->left, MPFR_RNDA)) <= size &&
		    fabs(mpfr_get_d(&value->right, MPFR_RNDA)) <= size;
	mpfi_clear(value);
	return none;
}

/* Whether it comes closer: 1, 0, -1: not known. What was struck without restitution, or rests, does not. */
static int closes(const struct through *t, int k, unsigned struck)
{
	const struct impact *p = &t->s->impact[k];
	const struct strike *strike = &p->in[t->segment];
	bool rests = interval_of(t->s, t->region, strike->expression) == rest_of(t->s, t->segment, p);
	bool known, still = rests || ((struck >> k & 1) && mpq_sgn(strike->restitution) == 0);
	mpq_t *row = row_of(t, p->in[t->segment].speed_row);
	int sign = sign_of(t, (const mpq_t *)row, NULL, &known);
	if (!known && !still)
		still = is_none(t, (const mpq_t *)row);
	rationals_free(row, (size_t)t->n);
	return known ? sign > 0 : still ? 0 : -1;
}

/* How fast it comes closer, or parts: at most; 0: it does not bounce */
static double speed_of(struct through *t, const struct impact *p)
{
	if (!p->bounces)
		return 0;
	mpq_t *row = row_of(t, p->in[t->segment].speed_row);
	mpfi_t speed;
	mpfi_init2(speed, t->precision);
	through_dot(t, (const mpq_t *)row, (const mpfi_t *)t->x, speed);
	mpfi_abs(speed, speed);
	double most = mpfr_get_d(&speed->right, MPFR_RNDU);
	mpfi_clear(speed);
	rationals_free(row, (size_t)t->n);
	return most;
}

/* Those that touch and have come to less than `slow` by striking each other without end rest, as the region lets them:
 * what is left of their speeds is below half the digits. For --solution alone: a selftest compares what is listed, too,
 * and the target lists as many impacts as it has room for. */
static unsigned calm(struct through *t, double slow, mpfr_srcptr off)
{
	unsigned laid = 0;
	for (int k = 0; k < t->s->impacts; k++) {
		const struct impact *p = &t->s->impact[k];
		const struct strike *strike = &p->in[t->segment];
		int before = t->region, rest = rest_of(t->s, t->segment, p);
		if (!touches(t, p) || interval_of(t->s, t->region, strike->expression) == rest || speed_of(t, p) > slow)
			continue;
		go_to(t, p, rest);
		if (!t->s->region[t->region].possible) {        /* others hold it already */
			through_enter(t, before);
			continue;
		}
		through_note_plain(t, strike->expression, breakpoint_of(t, p), strike->upward, off);
		laid |= 1u << k;
	}
	through_hold(t);
	return laid;
}

static bool collide(struct through *t, int begins, mpfr_srcptr off, unsigned *struck)
{
	const bool solves = t->whole->asked.solution;
	int rounds = 0;
	double most = 0;
	bool calms = false;
	for (int k = 0; k < t->s->impacts; k++) {
		const struct impact *p = &t->s->impact[k];
		const double slow = ldexp(most, -t->precision / 2);
		int comes = k == begins ? 1 : touches(t, p) ? closes(t, k, *struck) : 0;
		if (solves && comes != 0 && k != begins && speed_of(t, p) <= slow) {
			calms = true;
			continue;
		}
		if (comes < 0 || rounds > (solves ? MOST_SOLVED : MOST_STRUCK))
			return unknown(t, "whether what touches comes closer");
		if (comes == 0)
			continue;
		rounds++;
		calms = false;
		most = fmax(most, speed_of(t, p));
		through_note_plain(t, p->in[t->segment].expression, breakpoint_of(t, p), p->in[t->segment].upward, off);
		jump(t, p->in[t->segment].jumps, p->in[t->segment].jump);
		if (p->bounces)
			go_to(t, p, free_of(t, p));
		*struck |= 1u << k;
		begins = k == begins ? -1 : begins;
		k = -1;
	}
	if (calms)
		*struck &= ~calm(t, ldexp(most, -t->precision / 2), off);
	return true;
}

/* left = 2 v/(a (1 - e)) of what leaves with v and is pressed back by a; false: nothing presses it. *known */
static bool time_left(struct through *t, const struct impact *p, mpfi_ptr left, bool *known)
{
	mpq_t *row = row_of(t, p->in[t->segment].speed_row), part;
	mpq_t *press = through_times(t, (const mpq_t *)row, (const mpq_t *)t->at->A);
	bool presses = sign_of(t, (const mpq_t *)press, NULL, known) > 0;
	mpfi_t a;
	mpq_init(part);
	mpfi_init2(a, t->precision);
	mpfi_set_ui(left, 0);
	if (presses && mpq_sgn(p->in[t->segment].restitution) != 0) {
		through_dot(t, (const mpq_t *)row, (const mpfi_t *)t->x, left);
		through_dot(t, (const mpq_t *)press, (const mpfi_t *)t->x, a);
		mpfi_div(left, left, a);
		mpq_set_si(part, 1, 1);
		mpq_sub(part, p->in[t->segment].restitution, part);
		mpfi_div_q(left, left, part);
		mpfi_mul_ui(left, left, 2);
	}
	mpfi_clear(a);
	mpq_clear(part);
	rationals_free(row, (size_t)t->n);
	rationals_free(press, (size_t)t->n);
	return presses;
}

/* By the stated rule: where infinitely many bounces take no more than 2^-23 h (float: 2^-10) */
static bool come_to_rest(struct through *t, unsigned struck, mpfr_srcptr off)
{
	mpq_t brief, one;
	mpfi_t left;
	bool known = true;
	mpq_inits(brief, one, NULL);
	mpfi_init2(left, t->precision);
	mpq_set_ui(one, 1, 1);
	mpq_div_2exp(brief, t->whole->h, t->whole->asked.single && !t->whole->asked.solution ? 10 : 23);
	for (int k = 0; k < t->s->impacts && known; k++) {
		const struct impact *p = &t->s->impact[k];
		if (!(struck >> k & 1) || !p->bounces || mpq_cmp(p->in[t->segment].restitution, one) >= 0 ||
				!touches(t, p))
			continue;
		bool presses = time_left(t, p, left, &known);
		if (!known || !presses)
			continue;
		bool stands = mpfi_has_zero(left) > 0 && mpq_sgn(p->in[t->segment].restitution) != 0;
		mpfi_sub_q(left, left, brief);
		known = mpfr_sgn(&left->left) > 0 || mpfr_sgn(&left->right) <= 0;
		if (!known || mpfr_sgn(&left->left) > 0)
			continue;
		mpfi_add_q(left, left, brief);
		jump(t, p->in[t->segment].jumps, p->in[t->segment].still);
		go_to(t, p, rest_of(t->s, t->segment, p));
		through_hold(t);
		through_note_plain(t, p->in[t->segment].expression, breakpoint_of(t, p), p->in[t->segment].upward, off);
		mpfi_add(t->list[t->passed - 1].at, t->list[t->passed - 1].at, left);
		t->list[t->passed - 1].stands = stands;
		known = through_settle(t, NULL, off);
	}
	mpfi_clear(left);
	mpq_clears(brief, one, NULL);
	return known || t->undecided || unknown(t, "whether what bounces comes to rest");
}

bool through_strike(struct through *t, const struct gate *gate, mpfr_srcptr off)
{
	unsigned struck = 0;
	bool known = stream_change(t->at->flow, NULL, off, t->x);
	if (!t->s->impact[gate->impact].bounces)
		through_enter(t, t->region + gate->leads);
	known = known && collide(t, gate->impact, off, &struck);
	known = known && stream_change(t->at->flow, NULL, off, t->x);
	if (!known)
		return t->undecided ? false : unknown(t, "when an impact is");
	/* first what an impact sets in motion leaves where it stuck, then what still sticks is held */
	if (!through_follow(t))
		return false;
	through_hold(t);
	return through_settle(t, NULL, off) && come_to_rest(t, struck, off);
}
