/* SPDX-License-Identifier: MIT-0 */
/* contacts.h: the law of contacts at one instant, for the runtime's own use: by guards.c and events.c.  Impacts act one
 * after the other; where that has no end they become slower and slower, and what touches comes to rest.  What sticks,
 * rests or slips behind an event is the combination of those at rest in which all agree.
 *
 * It has no guard, for it is a part of the file that includes it, which says first what its `contacts` and its
 * `instant` are, and MOST, how many at rest it looks at together, in 3^MOST combinations; RESTING, where there may be
 * more, which that file brings to agree.  contacts: impacts, as
 * impact[k] with its switching function, breakpoint, upward and restitution; h; max_events, most.
 * instant: a state and what stands of it, with time [s] after the start of the step, and chain.  The enclosed run of
 * the generator (gen/step/certify) goes by it, too, with limits of its own, and names of roots.h. */

/* How many impacts there may be at one instant before they are ended, and how many more before that again; how many are
 * listed; how often speeds are taken from what comes to rest; how many places of the list are left for that */
enum { MOST_AT_ONCE = 1000, SOME = 100, MOST_SWEEPS = 1000, LAST = 6 };
#ifndef LISTED_AT_ONCE
#define LISTED_AT_ONCE 12
#endif

/* CALM: of the fastest impact, what is slower is over.  BRIEF: of h, what is over by then is at rest.  SPAN: of h,
 * impacts within that follow each other in no time to speak of.  DEEP: so many times what rounding may have done is no
 * rounding any more. */
#ifdef REAL_IS_FLOAT
#define CALM_OF_REAL 0x1p-20f
#define BRIEF_OF_REAL PL_BRIEFF
#define SPAN_OF_REAL 0x1p-8f
#else
#define CALM_OF_REAL 0x1p-48
#define BRIEF_OF_REAL PL_BRIEF
#define SPAN_OF_REAL 0x1p-10
#endif
#ifndef CALM /* the generator has its own */
#define CALM CALM_OF_REAL
#define BRIEF BRIEF_OF_REAL
#define SPAN SPAN_OF_REAL
#endif
#ifndef TOGETHER
#define TOGETHER BRIEF
#define HANGING (8 * MOST * MOST)
#define IN_DOUBT 0
#define ROUNDS 1 /* states are rounded, not enclosed */
#endif
#define DEEP 64

/* A switching function at rest, or next to where it would be with no velocity */
typedef struct resting {
	int expression, held; /* the interval in which it is held */
	int impact;           /* whose contact rests there; -1: friction sticks */
	int hold;             /* which of them that is, for the file's own use */
} resting;

/* ---- what the law asks of the file that includes it ---- */

/* The unit in which it counts time [s], and h in that unit */
static real unit(const contacts *m);
static real step_of(const contacts *m);

/* The interval of a switching function, and into another one; renew: behind such changes, what stands of the state;
 * whether nothing that is held there excludes another */
static int interval_of(const contacts *m, const instant *at, int expression);
static void go_to(const contacts *m, instant *at, int expression, int interval);
static void renew(const contacts *m, instant *at);
static int can_be(const contacts *m, const instant *at);

/* The interval in which the contact of impact k rests; -1: it is no bounce */
static int rest_of(const contacts *m, int k);

/* How far beyond the guard of impact k, and what rounding may have done to that */
static real depth(const contacts *m, const instant *at, int k, real *noise);

/* The speed at which it comes closer [1/s], 0 where that is but rounding; the rate of that [1/unit] */
static real speed_of(const contacts *m, const instant *at, int k);
static real press_of(const contacts *m, const instant *at, int k);

/* The speed of one that has met; a speed that is nothing but what rounding makes of forces over a step, once it is
 * asked for at this instant (below 0: never yet) */
static real speed_of_met(const contacts *m, instant *at, int k);
static real least_speed(const contacts *m, const instant *at, real least);

/* The state by the jump of impact k; a set, as bits, by impacts with restitution 0, which keep momentum, until what is
 * left of their speeds is nothing to speak of; without what rounding has left of the way to it; what is held is put
 * where it is held */
static void jump(const contacts *m, instant *at, int k);
static void stop_all(const contacts *m, instant *at, uint32_t set);
static void put_on(const contacts *m, instant *at, int k);
static void keep(const contacts *m, instant *at);

/* Each switching function into the interval where it is now; jumped: past a bounce, too */
static void follow(const contacts *m, instant *at, int jumped);

/* An event is listed where there is room; 0: there is none, and no speed is lost, so that it may not go on. */
static int has_listed(const contacts *m, instant *at, int loses, real time, int expression, int breakpoint, int upward);

static int listed(const instant *at);
static void count_rest(instant *at);
static void say(instant *at, int status);

/* Whether what rests there is pressed, by more than rounding */
static int is_pressed(const contacts *m, const instant *at, int k);

#ifdef ROUNDS
/* The sizes of what the speed of bounce k is summed from, and of what forces do to it in this time [s] */
static real speed_terms(const contacts *m, const instant *at, int k, real along);
#endif

/* Those at rest, at most MOST; the interval of one before this instant */
static int find_resting(const contacts *m, const instant *at, resting *found);
static int interval_before(const contacts *m, const instant *at, int expression);

/* Whether all of them agree with these intervals of theirs, what is held is not let go, what is not is: 2; 1: it hangs
 * in the balance.  May leave them there, not renewed. */
static int agrees(const contacts *m, instant *at, const resting *r, int count, const int *interval);

#ifndef RESTING
/* The state by the jump of impact k with restitution 0 */
static void stop(const contacts *m, instant *at, int k);
#endif

/* ---- impacts that follow each other ---- */

/* Before the first impact of a step */
static inline pl_chain no_impact(real h)
{
	pl_chain chain;
	chain.last = -h;
	chain.most = chain.least = 0;
	chain.acting = 0;
	chain.close = chain.impacts = chain.ended = chain.all = chain.full = 0;
	return chain;
}

static void go_on(pl_chain *chain, real time, real span)
{
	if (time - chain->last > span) {
		chain->most = 0;
		chain->close = 0;
	}
	if (time > chain->last) {
		chain->impacts = chain->ended = 0;
		chain->acting = 0;
	}
	chain->last = time;
}

/* One more event; 0: there have been too many in this step. */
static int has_time(const contacts *m, pl_chain *chain)
{
	chain->full = ++chain->all > m->most;
	return !chain->full;
}

/* One more impact, number k.  Whether it is listed: the list has the first ones of an instant and, once it is half
 * full, of no time to speak of. */
static int is_listed(pl_chain *chain, int k, int count, int most)
{
	if (chain->impacts % (SOME / 2) == 0 && chain->ended == 0) {
		chain->acting = 0;
	}
	chain->acting |= (uint32_t)1 << k;
	chain->impacts++;
	chain->close++;
	return chain->impacts <= LISTED_AT_ONCE && !(2 * count > most && chain->close > LISTED_AT_ONCE);
}

/* Whether there is room for one more impact */
static int has_room(const contacts *m, instant *at, int k)
{
	pl_chain *chain = &at->chain;
	if (is_listed(chain, k, listed(at), m->max_events)) {
		chain->full = !has_listed(m, at, m->impact[k].restitution < 1, chain->last, m->impact[k].expression,
								  m->impact[k].breakpoint, m->impact[k].upward);
	}
	if (!chain->full && !has_time(m, chain)) {
		say(at, PL_TOO_MANY_EVENTS);
	}
	return !chain->full;
}

/* ---- places ---- */

/* The interval before the guard of a bounce */
static int free_of(const contacts *m, int k)
{
	return rest_of(m, k) + (m->impact[k].upward ? -1 : 1);
}

static int rests(const contacts *m, const instant *at, int k)
{
	return interval_of(m, at, m->impact[k].expression) == rest_of(m, k);
}

/* Whether a bounce flies before its guard, or rests */
static int is_before(const contacts *m, const instant *at, int k)
{
	const int rest = rest_of(m, k), interval = rest < 0 ? -1 : interval_of(m, at, m->impact[k].expression);
	return rest >= 0 && (interval == rest || interval == free_of(m, k));
}

/* Whether a bounce is on its guard, but for so much at least, flying or at rest, or where rounding has taken it */
static int touches_by(const contacts *m, const instant *at, int k, real least)
{
	real noise, beyond_it;
	if (!is_before(m, at, k)) {
		return 0;
	}
	beyond_it = depth(m, at, k, &noise);
	return beyond_it >= -larger(noise, least);
}

static int touches(const contacts *m, const instant *at, int k)
{
	return touches_by(m, at, k, 0);
}

#ifdef ROUNDS
/* The most that rounding in a step does to the guard of any bounce.  All of them count: of balls in a row those that
 * lie still have places and speeds of the size of rounding, which say nothing of how it came about. */
static real rounding_of_places(const contacts *m, const instant *at)
{
	real largest = 0;
	int k;
	for (k = 0; k < m->impacts; k++) {
		real noise;
		if (rest_of(m, k) >= 0) {
			(void)depth(m, at, k, &noise);
			largest = larger(largest, noise + m->h * noise_of(speed_terms(m, at, k, m->h)));
		}
	}
	return largest;
}
#endif

/* Whether a bounce stops a switching function that would go this way */
static int is_stopped(const contacts *m, const instant *at, int expression, int way)
{
	int k;
	for (k = 0; k < m->impacts; k++) {
		if (m->impact[k].expression == expression && m->impact[k].upward == (way > 0) && is_before(m, at, k)) {
			return 1;
		}
	}
	return 0;
}

/* How long it flies that leaves the guard of k, from how it is pressed back there [unit]; -1: for good */
static real flight(const contacts *m, const instant *at, int k)
{
	const real speed = rest_of(m, k) < 0 ? 1 : speed_of(m, at, k), press = speed > 0 ? 0 : press_of(m, at, k);
	return press > 0 ? -2 * speed / press : -1;
}

/* A length [unit] not much longer than the shortest flight that begins there */
static inline real shortened(const contacts *m, const instant *at, real length)
{
	int k;
	for (k = 0; k < m->impacts; k++) {
		const int flies = speed_of(m, at, k) < 0 && touches(m, at, k) && !rests(m, at, k);
		const real along = flies ? flight(m, at, k) : 0;
		if (along > 0) {
			length = smaller(length, 2 * along);
		}
	}
	return length;
}

/* ---- contacts that come to rest ---- */

/* Into the intervals in which those of a set rest, as far as they all can.  Returns those that do now. */
static uint32_t seat(const contacts *m, instant *at, uint32_t set)
{
	uint32_t laid = 0;
	int k;
	for (k = 0; k < m->impacts; k++) {
		const int expression = m->impact[k].expression, before = interval_of(m, at, expression);
		if (!(set >> k & 1) || rests(m, at, k)) {
			continue;
		}
		go_to(m, at, expression, rest_of(m, k));
		if (can_be(m, at)) {
			laid |= (uint32_t)1 << k;
		} else {
			go_to(m, at, expression, before); /* others hold it already */
		}
	}
	renew(m, at);
	return laid;
}

#ifndef RESTING
static void stop_all(const contacts *m, instant *at, uint32_t set)
{
	real slow = 0;
	int k, sweeps, moving = 1;
	for (sweeps = 0; sweeps < MOST_SWEEPS && moving; sweeps++) {
		real fastest = 0;
		for (k = 0; k < m->impacts; k++) {
			if (set >> k & 1) {
				fastest = larger(fastest, magnitude(speed_of(m, at, k)));
				stop(m, at, k);
				put_on(m, at, k);
			}
		}
		slow = sweeps == 0 ? CALM * CALM * fastest : slow;
		moving = fastest > slow;
	}
}
#endif

/* Those of a set, as bits, come to rest together and with those that do, as far as they all can, listed at this
 * time. */
static void lay_down(const contacts *m, instant *at, uint32_t set, real time)
{
	uint32_t laid;
	int k;
	for (k = 0; k < m->impacts; k++) {
		set |= (uint32_t)(rest_of(m, k) >= 0 && rests(m, at, k)) << k;
	}
	stop_all(m, at, set);
	laid = seat(m, at, set);
	keep(m, at);
	for (k = 0; k < m->impacts; k++) {
		if (laid >> k & 1) {
			count_rest(at);
			(void)has_listed(m, at, 1, time, m->impact[k].expression, m->impact[k].breakpoint,
					m->impact[k].upward);
		}
	}
}

/* Impacts without an end become slower and slower: what has met and has at most the speed `slow` rests together. */
static void calm(const contacts *m, instant *at, real slow, uint32_t met)
{
	uint32_t set = 0;
	int k;
	for (k = 0; k < m->impacts; k++) {
		if (met >> k & 1 && magnitude(speed_of(m, at, k)) <= slow && !rests(m, at, k)) {
			set |= (uint32_t)1 << k;
		}
	}
	lay_down(m, at, set, at->chain.last);
}

/* Where impacts go on and on, those that act and lose speed come to rest, and so does what they press against: but for
 * what has been parted for good.  0: nothing does. */
static int give_up(const contacts *m, instant *at, uint32_t met)
{
	uint32_t set = 0;
	real fastest = 0;
	int k;
	for (k = 0; k < m->impacts; k++) {
		fastest = met >> k & 1 ? larger(fastest, speed_of(m, at, k)) : fastest;
	}
	for (k = 0; k < m->impacts; k++) {
		const real speed = met >> k & 1 && m->impact[k].restitution < 1 ? speed_of(m, at, k) : -16 * fastest;
		if (speed > 0 || (at->chain.acting >> k & 1 && speed > -16 * fastest)) {
			set |= (uint32_t)1 << k;
		}
	}
	lay_down(m, at, set, at->chain.last);
	at->chain.impacts = MOST_AT_ONCE - SOME;
	at->chain.ended++;
	return set != 0;
}

/* All impacts at this instant; begins: the one whose guard was met, or -1.  Returns those that acted, as bits.  What
 * has met once stays together: what rounding makes of that while speeds go to 0 has no size to be held against. */
static uint32_t apply_impacts(const contacts *m, instant *at, int begins)
{
	pl_chain *chain = &at->chain;
	uint32_t acted = 0, met = 0;
	real slow = -1;
	int k, calms = 0;
	go_on(chain, at->time, SPAN * m->h);
	for (k = 0; k < m->impacts && !chain->full; k++) {
		real speed = 0;
		if (met >> k & 1 || touches(m, at, k)) {
			met |= (uint32_t)1 << k;
			speed = speed_of_met(m, at, k);
		}
		if (k != begins && !(speed > 0)) {
			continue;
		}
		slow = larger(least_speed(m, at, slow), CALM * chain->most);
		if (speed <= slow && (k != begins || (slow > 0 && rest_of(m, k) >= 0
				&& !(m->impact[k].restitution < 1)))) {
			met |= (uint32_t)1 << k;
			begins = k == begins ? -1 : begins;
			calms = 1;
			continue;
		}
		chain->most = larger(chain->most, speed);
		if (chain->impacts == MOST_AT_ONCE) {
			chain->full = !give_up(m, at, met);
			say(at, chain->full ? PL_TOO_MANY_EVENTS : 0);
			begins = k = -1;
			continue;
		}
		if (!has_room(m, at, k)) {
			break;
		}
		jump(m, at, k);
		if (rest_of(m, k) >= 0) {
			go_to(m, at, m->impact[k].expression, free_of(m, k));
			put_on(m, at, k);
			met |= (uint32_t)1 << k;
		} else {
			follow(m, at, 1);
			met = 0;
		}
		acted |= (uint32_t)1 << k;
		begins = k == begins ? -1 : begins;
		calms = 0;
		k = -1;
	}
	if (calms) {
		calm(m, at, slow, met);
	}
	return acted;
}

/* ---- what sticks, rests or slips ---- */

/* Lists what changes from these intervals to those. */
static void list_changes(const contacts *m, instant *at, const resting *r, int count, const int *from, const int *to)
{
	int i, k;
	for (i = 0; i < count; i++) {
		const int up = to[i] > from[i];
		for (k = from[i]; k != to[i]; k += up ? 1 : -1) {
			(void)has_listed(m, at, 1, at->time, r[i].expression, k - !up, up);
		}
	}
}

static void enter_all(const contacts *m, instant *at, const resting *r, int count, const int *interval)
{
	int i;
	for (i = 0; i < count; i++) {
		go_to(m, at, r[i].expression, interval[i]);
	}
	renew(m, at);
}

/* Those at rest in the combination of this number, three ways each: what it costs, by changes and then by what slips */
static int combine(const resting *r, int count, int number, const int *before, int *interval)
{
	int cost = 0, i;
	for (i = 0; i < count; i++, number /= 3) {
		interval[i] = r[i].held + number % 3 - 1;
		cost += (interval[i] != before[i]) * 2 * MOST + (number % 3 != 1);
	}
	return cost;
}

#ifdef RESTING
/* More than MOST of them, in `interval`, brought to agree; 0: they do not come to */
static int pivot(const contacts *m, instant *at, const resting *r, int count, int *interval);
#else
#define RESTING MOST
#define pivot(m, at, r, count, interval) 0
#endif

/* next: the combination in which all agree, with fewest changes, then most that is held; 0: there is none.  how: what
 * agrees says */
static int best_of(const contacts *m, instant *at, const resting *r, int count, const int *before, int *next, int *how)
{
	int best = -1, least = 0, all = 1, number, i;
	for (i = 0; i < count; i++) {
		all *= 3;
	}
	for (number = 0; number < all; number++) {
		int interval[MOST], agreed, cost = combine(r, count, number, before, interval);
		if (best >= 0 && cost >= least) {
			continue;
		}
		agreed = agrees(m, at, r, count, interval);
		cost += agreed == 1 ? HANGING : 0;
		if (agreed != 0 && (best < 0 || cost < least)) {
			best = number;
			least = cost;
			*how = agreed;
		}
	}
	if (best >= 0) {
		(void)combine(r, count, best, before, next);
	}
	return best >= 0;
}

/* What is at rest: whether it is held, and where else it goes.  Changes count from where things were before the instant
 * with `turned`, so that what turns round changes once; else from now. */
static void resolve(const contacts *m, instant *at, int turned)
{
	resting r[RESTING];
	int now[RESTING], before[RESTING], next[RESTING], found, how = 2, i;
	const int count = find_resting(m, at, r);
	for (i = 0; i < count; i++) {
		now[i] = interval_of(m, at, r[i].expression);
		before[i] = turned ? interval_before(m, at, r[i].expression) : now[i];
		next[i] = now[i];
	}
	if (count == 0 || agrees(m, at, r, count, now) == 2) {
		return;
	}
	found = count <= MOST ? best_of(m, at, r, count, before, next, &how) : pivot(m, at, r, count, next);
	if (!found) {
		say(at, PL_UNDECIDED);
		enter_all(m, at, r, count, now);
	} else {
		say(at, how == 1 ? IN_DOUBT : 0);
		list_changes(m, at, r, count, now, next);
		enter_all(m, at, r, count, next);
	}
}

/* ---- behind impacts ---- */

/* The largest rate at which one of those that touch is pressed [1/unit], and the most that rounding does to their
 * places: they lie on each other, and what that takes one by moves another one. */
static real most_pressed(const contacts *m, const instant *at, real *rounding)
{
	real most = 0, noise;
	int k;
	for (k = 0; k < m->impacts; k++) {
		if (touches(m, at, k)) {
			(void)depth(m, at, k, &noise);
			*rounding = larger(*rounding, noise);
		}
	}
	for (k = 0; k < m->impacts; k++) {
		if (touches_by(m, at, k, *rounding)) {
			most = larger(most, press_of(m, at, k));
		}
	}
	return most;
}

/* Several contacts that are as good as at rest together, those of them that fly as bits: all that any of them could
 * still do is over within BRIEF of h under the force that presses one of them, or lower than rounding. */
static uint32_t near_rest(const contacts *m, const instant *at)
{
	real noise = 0, unused;
	const real brief = TOGETHER * step_of(m), most = most_pressed(m, at, &noise), fastest = most * brief / 2;
	uint32_t set = 0;
	int k, together = 0;
	for (k = 0; k < m->impacts; k++) {
		const real loss = 1 - m->impact[k].restitution;
		real speed;
		if (!is_before(m, at, k) || depth(m, at, k, &unused) < -larger(noise, fastest * brief * unit(m))) {
			continue;
		}
		speed = magnitude(speed_of(m, at, k));
		if (rests(m, at, k)) {
			together++;
		} else if (speed <= fastest * loss || unit(m) * speed * speed <= 2 * most * noise * loss * loss) {
			set |= (uint32_t)1 << k;
			together++;
		}
	}
	return together > 1 ? set : 0;
}

/* Several that pass impacts to each other come to rest together if all of them are pressed then. */
static void rest_together(const contacts *m, instant *at, uint32_t set)
{
	const uint32_t laid = seat(m, at, set);
	int k, pressed = 1;
	for (k = 0; k < m->impacts; k++) {
		pressed = pressed && (!(laid >> k & 1) || is_pressed(m, at, k));
	}
	for (k = 0; k < m->impacts; k++) {
		if (laid >> k & 1) {
			go_to(m, at, m->impact[k].expression, free_of(m, k));
		}
	}
	renew(m, at);
	if (pressed) {
		lay_down(m, at, laid, at->time);
		resolve(m, at, 0);
	}
}

/* Behind impacts: which of them rest, after infinitely many more in no time to speak of */
static void come_to_rest(const contacts *m, instant *at, uint32_t acted)
{
	const real brief = (listed(at) > m->max_events - LAST ? SPAN : BRIEF) * step_of(m);
	uint32_t set;
	int k;
	for (k = 0; k < m->impacts; k++) {
		const real e = m->impact[k].restitution, along = acted >> k & 1 && e < 1 ? flight(m, at, k) : -1;
		const real left = along / (1 - e);
		if (left >= 0 && left <= brief && touches(m, at, k)) {
			lay_down(m, at, (uint32_t)1 << k, at->time + left * unit(m));
			resolve(m, at, 0);
		}
	}
	set = acted != 0 && m->impacts > 1 ? near_rest(m, at) : 0; /* of one alone it says nothing */
	if (set != 0) {
		rest_together(m, at, set);
	}
}
