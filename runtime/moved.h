/* SPDX-License-Identifier: MIT-0 */
/* moved.h: what an event beside a series does to derivatives by params that are states too: part of events.c.  A jump
 * and what holds are made with them: S + f- t*_p, the derivative of the state at the event's own time, becomes that of
 * the state behind it, R_x (S + f- t*_p) + R_p + R_t t*_p, and less f+ t*_p that at fixed time (saltation.h).  What
 * comes to stick without a jump is projected, which knows no t*_p. */

typedef struct leaving { /* what stood before the event */
	int met;             /* whether what is met has a derivative: no formula that goes on without a jump */
	int leapt;           /* a load that jumps has met it, at a time of its own */
	int none, timed;     /* 1: it is where a formula jumps, and no state; at a time that only params move */
	int function, crossings_before, impacts;
	uint64_t held;
	unsigned doubt; /* for the case that the field jumps */
} leaving;

static real *event_times(const pl_events *m, const pl_instant *at)
{
	(void)m;
	return at->moved;
}

static real *states_before(const pl_events *m, const pl_instant *at)
{
	return at->moved + m->moved->columns;
}

static real *field_before(const pl_events *m, const pl_instant *at)
{
	return states_before(m, at) + m->states;
}

/* The friction whose velocity passes 0 there; -1: none does */
static int hold_at(const pl_events *m, const pl_crossing *e)
{
	int i;
	for (i = m->holds - 1; i >= 0; i--) {
		const int off = m->hold[i].interval - e->breakpoint;
		if (m->hold[i].impact < 0 && m->hold[i].expression == e->expression && (off == 0 || off == 1)) {
			break;
		}
	}
	return i;
}

/* What is met, and watches of its derivatives; 0: it has none */
static const int *find_met(const pl_events *m, const pl_instant *at, int *watch, int *apart)
{
	const pl_moved *d = m->moved;
	const int hold = at->freed >= 0 ? at->freed : hold_at(m, &at->next), up = at->next.upward;
	*apart = 1;
	if (at->starting >= 0) {
		*watch = m->impact[at->starting].place;
		return d->place + at->starting * d->columns;
	}
	if (at->freed >= 0) {
		*watch = up ? m->hold[hold].up : m->hold[hold].down;
		*apart = 2;
		return d->pull + 2 * hold * d->columns + up;
	}
	*watch = hold < 0 ? -1 : m->hold[hold].velocity;
	return hold < 0 ? NULL : d->velocity + hold * d->columns;
}

/* Whether the impact that begins, or the friction that lets go, is met so flatly that what follows is not known */
static int is_flat(const pl_events *m, const pl_instant *at, const column *e)
{
	const column f = at->starting >= 0 ? column_of(m->switching, at->c, at->terms, at->next.expression) : *e;
	const real way = at->starting >= 0 && !at->next.upward ? -1 : 1;
	return pl_saltation_grazes(f.terms, column_at(&f, 1), way * 2 * column_at(&f, 2));
}

/* t*_p of each column, in h */
static void find_times(const pl_events *m, const pl_instant *at, leaving *l)
{
	real *when = event_times(m, at);
	int watch, apart, k;
	const int *of = find_met(m, at, &watch, &apart);
	l->met = of != NULL;
	for (k = 0; k < m->moved->columns; k++) {
		when[k] = 0;
	}
	if (of != NULL) {
		const column e = watched(m, at, watch);
		const real rate = column_at(&e, 1);
		const int turns = rate > 0 || rate < 0;
		l->leapt = magnitude(column_at(&e, 0)) > NEAR * (e.terms + magnitude(rate));
		l->doubt = !turns || is_flat(m, at, &e) ? PL_D_GRAZING : 0;
		for (k = 0; k < m->moved->columns && turns && !l->leapt; k++) {
			when[k] = pl_saltation_time(value_of(m, at, of[apart * k]), rate);
		}
	}
}

/* S += sign field t*_p; the derivative of t is t*_p with the sign 1, else 0 */
static void move_time(const pl_events *m, pl_instant *at, const real *field, int sign)
{
	const pl_moved *d = m->moved;
	const real *when = event_times(m, at);
	int i;
	for (i = 0; i < m->states; i++) {
		if (d->column[i] >= 0) {
			at->y[i] += (real)sign * field[d->state[i]] * when[d->column[i]];
			at->low[i] = 0;
		}
	}
	for (i = 0; i < d->columns; i++) {
		if (d->time[i] >= 0) {
			at->y[d->time[i]] = sign > 0 ? when[i] * m->h : 0;
		}
	}
}

static void take_field(const pl_events *m, const pl_instant *at, real *field)
{
	int i;
	for (i = 0; i < m->states; i++) {
		field[i] = at->c[m->switching->columns + i];
	}
}

static leaving leave(const pl_events *m, pl_instant *at)
{
	leaving l;
	real *before = states_before(m, at);
	int i;
	renew(m, at);
	l.function = at->next.expression;
	l.crossings_before = *at->crossings;
	l.impacts = at->chain.all;
	l.none = at->starting >= 0 && m->impact[at->starting].jumps == 0;
	l.timed = l.none && m->impact[at->starting].still < 0;
	l.held = held_now(m, at);
	l.doubt = 0;
	l.leapt = 0;
	find_times(m, at, &l);
	take_field(m, at, field_before(m, at));
	for (i = 0; i < m->states; i++) {
		before[i] = at->y[i];
	}
	if (l.met) {
		move_time(m, at, field_before(m, at), 1);
		renew(m, at);
	}
	return l;
}

/* Derivatives as they were before the event */
static void move_back(const pl_events *m, pl_instant *at)
{
	const pl_moved *d = m->moved;
	const real *before = states_before(m, at);
	int i;
	for (i = 0; i < m->states; i++) {
		at->y[i] = d->column[i] >= 0 ? before[i] : at->y[i];
	}
	for (i = 0; i < d->columns; i++) {
		if (d->time[i] >= 0) {
			at->y[d->time[i]] = 0;
		}
	}
}

/* Events at one instant, or where a step ends: the derivative is that of one side. */
static unsigned order_of_events(const pl_events *m, const pl_instant *at, const leaving *l)
{
	const real none = 64 * REAL_EPSILON * m->h, time = at->time;
	const int again = l->crossings_before > 0 && at->crossing[l->crossings_before - 1].expression != l->function &&
					  time - at->crossing[l->crossings_before - 1].time <= none;
	const int several = (at->chain.acting & (at->chain.acting - 1u)) != 0;
	const int ends = !l->timed && (time <= none || time >= m->h - none);
	return again || several || ends ? PL_D_ONE_SIDED : 0;
}

/* f- - f+ in the place of f-, 0 where it is but rounding; whether there is any */
static int field_jumps(const pl_events *m, const pl_instant *at, real *field)
{
	int i, any = 0;
	for (i = 0; i < m->states; i++) {
		const real behind = at->c[m->switching->columns + i], size = magnitude(field[i]) + magnitude(behind);
		field[i] -= behind;
		if (magnitude(field[i]) <= noise_of(size)) {
			field[i] = 0;
		}
		any = any || (m->moved->column[i] < 0 && magnitude(field[i]) > 0);
	}
	return any;
}

static void arrive(const pl_events *m, pl_instant *at, const leaving *l)
{
	real *field = field_before(m, at);
	const uint64_t begun = held_now(m, at) & ~l->held, ended = l->held & ~held_now(m, at);
	const int jumped = at->chain.all - l->impacts - l->none;
	unsigned doubt = l->doubt;
	if (!l->met) {
		doubt = begun != 0 || ended != 0 || jumped ? PL_D_ONE_SIDED : 0;
	} else if (jumped) {
		renew(m, at);
		take_field(m, at, field);
		move_time(m, at, field, -1);
		doubt |= order_of_events(m, at, l);
	} else {
		move_back(m, at);
		renew(m, at);
		if (begun != 0) {
			doubt = ended != 0 ? PL_D_ONE_SIDED : 0;
		} else if (field_jumps(m, at, field)) {
			move_time(m, at, field, 1);
			move_time(m, at, field, 0);
			doubt |= order_of_events(m, at, l);
		} else {
			doubt = 0;
		}
	}
	renew(m, at);
	keep_moved(m, at);
	if (at->status & PL_UNDECIDED) {
		doubt |= PL_D_UNDECIDED;
	}
	pl_doubt_add(at->doubt, l->leapt ? doubt & PL_D_UNDECIDED : doubt, l->function, at->time);
}

/* A guard of an impact that is all but met, where it turns back: e over a piece, and its breakpoint */
static void miss(const pl_events *m, const pl_instant *at, const column *e, int function, real b, real sign,
				 real end)
{
	real s, peak;
	rescale(e, end, at->work);
	if (turns_back(m->switching->degree, at->work, sign, &s, &peak) &&
		pl_saltation_misses(e->terms + magnitude(b), sign * (b - peak))) {
		pl_doubt_add(at->doubt, PL_D_GRAZING, function, at->time + s * end * m->h);
	}
}
