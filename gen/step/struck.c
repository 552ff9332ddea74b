/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a way through crossings: impacts, and what comes to rest by them, by the rules of runtime/guards.c. */
#include "step/through.h"

#include <math.h>

/* Impacts at one instant, as runtime/chain.h has them: a selftest goes through MOST_STRUCK of them alone. */
enum { MOST_STRUCK = 200, MOST_AT_ONCE = 1000, SOME = 100, MOST_ENDED = 600, MOST_SWEEPS = 1000,
       CALM_BITS = 48, SELFTEST_BRIEF = 16 };

struct chain {                      /* impacts that follow each other at one instant */
	int impacts, ended;
	unsigned struck, acting;    /* of which those that do not rest now; the last ones */
	double most;                /* the fastest */
};

static void jump(struct through *t, int jumps, const struct jump *list)
{
	for (int k = 0; k < jumps; k++)
		through_assign(t, list[k].state, list[k].row, t->y);
	for (int k = 0; k < jumps; k++)
		mpfi_set(t->x[list[k].state], t->y[list[k].state]);
}

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

/* Whether a speed is 0 but for rounding: speeds that impacts have made equal */
static bool is_none(const struct through *t, const mpq_t *row)
{
	INTERVAL value = OVER_BITS(t->precision);
	through_dot(t, row, (const mpfi_t *)t->x, value);
	return through_is_none(t, value, through_size(t, row));
}

/* Whether it comes closer: 1, 0, -1: not known. What was struck without restitution, or rests, does not. */
static int closes(const struct through *t, int k, unsigned struck)
{
	const struct impact *p = &t->s->impact[k];
	const struct strike *strike = &p->in[t->segment];
	bool rests = interval_of(t->s, t->region, strike->expression) == rest_of(t->s, t->segment, p);
	bool known, still = rests || ((struck >> k & 1) && mpq_sgn(strike->restitution) == 0);
	mpq_t *row = through_row_of(t, p->in[t->segment].speed_row);
	int sign = through_sign(t, (const mpq_t *)row, NULL, &known);
	if (!known && !still)
		still = is_none(t, (const mpq_t *)row);
	rationals_free(row, (size_t)t->n);
	return known ? sign > 0 : still ? 0 : -1;
}

/* How fast it comes closer, below 0: parts; at most. 0: it does not bounce, or whether is not known */
static double speed_of(struct through *t, const struct impact *p)
{
	if (!p->bounces)
		return 0;
	mpq_t *row = through_row_of(t, p->in[t->segment].speed_row);
	mpfi_t speed;
	mpfi_init2(speed, t->precision);
	through_dot(t, (const mpq_t *)row, (const mpfi_t *)t->x, speed);
	double most = 0;
	if (!mpfi_has_zero(speed))
		most = mpfr_get_d(mpfi_is_neg(speed) ? &speed->left : &speed->right, MPFR_RNDA);
	mpfi_clear(speed);
	rationals_free(row, (size_t)t->n);
	return most;
}

static bool is_laid(const struct through *t, int k)
{
	const struct impact *p = &t->s->impact[k];
	return p->bounces &&
	       interval_of(t->s, t->region, p->in[t->segment].expression) == rest_of(t->s, t->segment, p);
}

/* Impacts with restitution 0, which keep momentum, until nothing of a set moves faster than that */
static void halt(struct through *t, unsigned set, double least)
{
	bool moving = true;
	for (int sweeps = 0; sweeps < MOST_SWEEPS && moving; sweeps++) {
		moving = false;
		for (int k = 0; k < t->s->impacts; k++) {
			const struct strike *strike = &t->s->impact[k].in[t->segment];
			if (!(set >> k & 1 || is_laid(t, k)))
				continue;
			moving |= fabs(speed_of(t, &t->s->impact[k])) > least;
			jump(t, strike->jumps, strike->still);
		}
	}
}

/* Into the intervals in which those of a set rest, as far as the region lets them: those that do now */
static unsigned seat(struct through *t, unsigned set)
{
	unsigned laid = 0;
	for (int k = 0; k < t->s->impacts; k++) {
		int before = t->region;
		if (!(set >> k & 1) || is_laid(t, k))
			continue;
		go_to(t, &t->s->impact[k], rest_of(t->s, t->segment, &t->s->impact[k]));
		if (t->s->region[t->region].possible)
			laid |= 1u << k;
		else
			through_enter(t, before);       /* others hold it already */
	}
	return laid;
}

static void note_impact(struct through *t, int k, bool closes, mpfr_srcptr off)
{
	const struct strike *strike = &t->s->impact[k].in[t->segment];
	through_note_plain(t, strike->expression, breakpoint_of(t, &t->s->impact[k]), strike->upward == closes, off);
}

/* Those of a set come to rest together and with those that do. */
static void lay(struct through *t, unsigned set, struct chain *chain, mpfr_srcptr off)
{
	halt(t, set, ldexp(chain->most, -2 * CALM_BITS));
	unsigned laid = seat(t, set);
	for (int k = 0; k < t->s->impacts; k++)
		if (laid >> k & 1)
			note_impact(t, k, true, off);
	chain->struck &= ~laid;
	through_hold(t);
}

/* Those that touch and have come to less than `slow` by striking each other without end come to rest together. For
 * --solution alone: a selftest compares what is listed, too, and the target lists as many as it has room for. */
static void calm(struct through *t, double slow, struct chain *chain, mpfr_srcptr off)
{
	unsigned set = 0;
	for (int k = 0; k < t->s->impacts; k++)
		if (touches(t, &t->s->impact[k]) && fabs(speed_of(t, &t->s->impact[k])) <= slow)
			set |= 1u << k;
	lay(t, set, chain, off);
}

/* Where impacts go on and on, those that act and lose speed come to rest, and so does what they press against: but for
 * what has been parted for good. */
static void end_chain(struct through *t, struct chain *chain, mpfr_srcptr off)
{
	unsigned set = 0;
	double fastest = 0;
	for (int k = 0; k < t->s->impacts; k++)
		if (touches(t, &t->s->impact[k]))
			fastest = fmax(fastest, speed_of(t, &t->s->impact[k]));
	for (int k = 0; k < t->s->impacts; k++) {
		const struct impact *p = &t->s->impact[k];
		bool loses = touches(t, p) && mpq_cmp_ui(p->in[t->segment].restitution, 1, 1) < 0;
		double speed = loses ? speed_of(t, p) : -16 * fastest;
		if (speed > 0 || (chain->acting >> k & 1 && speed > -16 * fastest))
			set |= 1u << k;
	}
	lay(t, set, chain, off);
	chain->impacts = MOST_AT_ONCE - SOME;
	chain->ended++;
}

/* Impacts within 2^-10 h follow each other in no time to speak of. */
static struct chain go_on(struct through *t)
{
	mpq_t since;
	mpq_init(since);
	mpq_sub(since, t->base, t->struck);
	mpq_div(since, since, t->whole->h);
	struct chain chain = { .most = mpq_get_d(since) > 0x1p-10 ? 0 : t->fastest };
	mpq_set(t->struck, t->base);
	mpq_clear(since);
	return chain;
}

/* One more impact; false: there are too many. */
static bool has_room(struct through *t, int k, struct chain *chain)
{
	if (chain->impacts % (SOME / 2) == 0 && chain->ended == 0)
		chain->acting = 0;
	chain->acting |= 1u << k;
	chain->most = fmax(chain->most, speed_of(t, &t->s->impact[k]));
	return chain->impacts++ <= (t->whole->asked.solution ? MOST_AT_ONCE : MOST_STRUCK) && chain->ended < MOST_ENDED;
}

static bool collide(struct through *t, int begins, mpfr_srcptr off, struct chain *chain)
{
	bool calms = false;
	for (int k = 0; k < t->s->impacts; k++) {
		const struct impact *p = &t->s->impact[k];
		int comes = k == begins ? 1 : touches(t, p) ? closes(t, k, chain->struck) : 0;
		if (t->whole->asked.solution && comes != 0 && k != begins &&
		    fabs(speed_of(t, p)) <= ldexp(chain->most, -CALM_BITS)) {
			calms = true;
			continue;
		}
		if (comes == 0)
			continue;
		if (t->whole->asked.solution && chain->impacts == MOST_AT_ONCE && comes > 0) {
			end_chain(t, chain, off);
			begins = k = -1;
			continue;
		}
		if (comes < 0 || !has_room(t, k, chain))
			return through_unknown(t, "whether what touches comes closer");
		calms = false;
		note_impact(t, k, true, off);
		jump(t, p->in[t->segment].jumps, p->in[t->segment].jump);
		if (p->bounces)
			go_to(t, p, free_of(t, p));
		chain->struck |= 1u << k;
		begins = k == begins ? -1 : begins;
		k = -1;
	}
	if (calms)
		calm(t, ldexp(chain->most, -CALM_BITS), chain, off);
	t->fastest = chain->most;
	return true;
}

/* left = 2 v/(a (1 - e)) of what leaves with v and is pressed back by a; false: nothing presses it. *known false:
 * whether anything does is not known, and left is the least that it may be. */
static bool time_left(struct through *t, const struct impact *p, mpfi_ptr left, bool *known)
{
	RATIONALS *row = through_row_of(t, p->in[t->segment].speed_row);
	RATIONALS *press = through_times(t, (const mpq_t *)row, (const mpq_t *)t->at->A);
	RATIONAL part = ZERO;
	INTERVAL a = OVER_BITS(t->precision);
	bool presses = through_sign(t, (const mpq_t *)press, NULL, known) > 0;
	bool leaves = mpq_sgn(p->in[t->segment].restitution) != 0 || !is_none(t, (const mpq_t *)row);
	mpfi_set_ui(left, 0);
	if (t->whole->asked.solution && *known && !presses && !leaves)  /* by a force that begins at 0 */
		presses = through_heads(t, t->at, p->in[t->segment].expression, known) ==
			  (p->in[t->segment].upward ? 1 : -1);
	if ((presses || !*known) && leaves) {
		through_dot(t, (const mpq_t *)row, (const mpfi_t *)t->x, left);
		through_dot(t, (const mpq_t *)press, (const mpfi_t *)t->x, a);
		mpfi_abs(a, a);
		mpfr_set(&a->left, presses ? &a->left : &a->right, MPFR_RNDD);
		mpfi_div(left, left, a);
		mpq_set_si(part, 1, 1);
		mpq_sub(part, p->in[t->segment].restitution, part);
		mpfi_div_q(left, left, part);
		mpfi_mul_ui(left, left, 2);
	}
	return presses;
}

/* What was struck without restitution and is not pressed back parts with a speed of 0. */
static void note_touching(struct through *t, unsigned struck, mpfr_srcptr off)
{
	for (int k = 0; k < t->s->impacts; k++) {
		const struct strike *strike = &t->s->impact[k].in[t->segment];
		if (!(struck >> k & 1) || mpq_sgn(strike->restitution) != 0 || !touches(t, &t->s->impact[k]) ||
				is_laid(t, k) || fabs(speed_of(t, &t->s->impact[k])) > 0)
			continue;
		t->order[strike->expression] = 2;
		t->back[strike->expression] = strike->upward;
		mpfr_set(t->fresh_off, off, MPFR_RNDU);
	}
}

/* By the stated rule: where infinitely many bounces take no more than 2^-23 h (float: 2^-10). What lies already is
 * pressed by what comes to rest on it, and gets its share of the momentum. */
static bool come_to_rest(struct through *t, struct chain *chain, mpfr_srcptr off)
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
		if (!(chain->struck >> k & 1) || !p->bounces || mpq_cmp(p->in[t->segment].restitution, one) >= 0 ||
				!touches(t, p))
			continue;
		bool presses = time_left(t, p, left, &known);
		if (known && !presses)
			continue;
		bool stands = mpfi_has_zero(left) > 0 && mpq_sgn(p->in[t->segment].restitution) != 0;
		mpfi_sub_q(left, left, brief);
		known = mpfr_sgn(&left->left) > 0 || (known && mpfr_sgn(&left->right) <= 0);
		if (!known || mpfr_sgn(&left->left) > 0)
			continue;
		mpfi_add_q(left, left, brief);
		const int before = t->passed;
		lay(t, 1u << k, chain, off);
		if (t->passed == before)
			continue;
		mpfi_add(t->list[t->passed - 1].at, t->list[t->passed - 1].at, left);
		t->list[t->passed - 1].stands = stands;
		known = through_settle(t, NULL, off);
	}
	mpfi_clear(left);
	mpq_clears(brief, one, NULL);
	return known || t->undecided || through_unknown(t, "whether what bounces comes to rest");
}

/* The acceleration by which a contact is pressed; its gap, below 0: open */
static double press_of(const struct through *t, const struct impact *p, double *gap)
{
	const struct strike *strike = &p->in[t->segment];
	mpq_t *row = through_row_of(t, strike->speed_row);
	mpq_t *place = through_row_of(t, t->s->expression[strike->expression].row);
	mpq_t *press = through_times(t, (const mpq_t *)row, (const mpq_t *)t->at->A);
	mpfi_t value;
	mpfi_init2(value, t->precision);
	through_dot(t, (const mpq_t *)place, (const mpfi_t *)t->x, value);
	mpfi_sub_q(value, value, strike->at);
	*gap = strike->upward ? mpfi_get_d(value) : -mpfi_get_d(value);
	through_dot(t, (const mpq_t *)press, (const mpfi_t *)t->x, value);
	double pressed = mpfi_get_d(value);
	mpfi_clear(value);
	rationals_free(row, (size_t)t->n);
	rationals_free(place, (size_t)t->n);
	rationals_free(press, (size_t)t->n);
	return pressed;
}

/* Several contacts that are as good as at rest together, those that fly: all that any of them could still do is over
 * within `brief` [s] under the force that presses one of them. */
static unsigned near_rest(struct through *t, double brief)
{
	unsigned set = 0;
	double most = 0, gap;
	int together = 0;
	for (int k = 0; k < t->s->impacts; k++)
		if (touches(t, &t->s->impact[k]))
			most = fmax(most, press_of(t, &t->s->impact[k], &gap));
	const double fastest = most * brief / 2;
	for (int k = 0; k < t->s->impacts && fastest > 0; k++) {
		const struct impact *p = &t->s->impact[k];
		const struct strike *strike = &p->in[t->segment];
		bool flies = p->bounces && interval_of(t->s, t->region, strike->expression) == free_of(t, p);
		if (!(flies || is_laid(t, k)) || (press_of(t, p, &gap), gap < -fastest * brief))
			continue;
		if (flies && fabs(speed_of(t, p)) > fastest * (1 - mpq_get_d(strike->restitution)))
			continue;
		set |= (unsigned)flies << k;
		together++;
	}
	return together > 1 ? set : 0;
}

/* Whether forces press all of a set, which rests in this region */
static bool all_pressed(const struct through *t, unsigned set)
{
	for (int k = 0; k < t->s->impacts; k++)
		for (int g = 0; g < t->at->gates && set >> k & 1; g++) {
			const struct gate *gate = &t->at->gate[g];
			bool known;
			if (gate->release && gate->expression == t->s->impact[k].in[t->segment].expression &&
			    through_sign(t, (const mpq_t *)gate->row, gate->limit, &known) >= 0)
				return false;
		}
	return true;
}

/* Several that strike each other come to rest together if all of them are pressed then. What rounding adds to the rule
 * on the target is no matter for a selftest, which ends before. */
static bool rest_together(struct through *t, struct chain *chain, mpfr_srcptr off)
{
	const double brief = mpq_get_d(t->whole->h) * 0x1p-23;
	unsigned set = near_rest(t, t->whole->asked.solution ? brief : SELFTEST_BRIEF * brief);
	int before = t->region;
	if (set == 0)
		return true;
	if (!t->whole->asked.solution)
		return through_unknown(t, "whether several come to rest together");
	set = seat(t, set);
	bool pressed = all_pressed(t, set);
	through_enter(t, before);
	if (!pressed)
		return true;
	lay(t, set, chain, off);
	return through_settle(t, NULL, off);
}

/* Contacts at rest that an impact has given a speed away from each other */
static void part(struct through *t, mpfr_srcptr off)
{
	for (int k = 0; k < t->s->impacts; k++) {
		const struct impact *p = &t->s->impact[k];
		if (!is_laid(t, k) || !(speed_of(t, p) < 0))
			continue;
		note_impact(t, k, false, off);
		go_to(t, p, free_of(t, p));
	}
}

bool through_strike(struct through *t, const struct gate *gate, mpfr_srcptr off)
{
	struct chain chain = go_on(t);
	bool known = stream_change(t->at->flow, NULL, off, t->x);
	through_enter(t, t->region + (t->s->impact[gate->impact].bounces ? 0 : gate->leads));
	known = known && collide(t, gate->impact, off, &chain);
	known = known && stream_change(t->at->flow, NULL, off, t->x);
	if (!known)
		return t->undecided ? false : through_unknown(t, "when an impact is");
	/* first what an impact sets in motion leaves where it stuck, then what still sticks is held */
	part(t, off);
	if (!through_follow(t))
		return false;
	through_hold(t);
	if (!through_settle(t, NULL, off) || !come_to_rest(t, &chain, off) || !rest_together(t, &chain, off))
		return false;
	note_touching(t, chain.struck, off);
	return true;
}
