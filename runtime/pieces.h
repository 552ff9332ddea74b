/* SPDX-License-Identifier: MIT-0 */
/* pieces.h: x on from event to event, in pieces by which e^{A d} goes where a bound shows that nothing happens, and in
 * short ones by a Taylor polynomial up to the first event: part of crossings.c and guards.c.  They define before it
 *
 *     searched, instant          the tables; a state, x, in a region, c, with work
 *     event, no_event            a place s in a piece, 0 to 1, whether there is one, any, and what it is
 *     limited(m, at, length)     a length of a piece [s] that is at most this one
 *     hold(m, at, y, work)       y, but what is held is in its place
 *     is_event_free(m, at, up, y, bend, work)   whether it is certain that nothing happens between x and y, a piece on
 *     first_event(m, at, coefficients, splits)   in a piece, of x(s); behind them is room for work
 *     take_up(m, at, time)       the region may be another one than before
 *     pass(m, at, which, time)   that event, and how it goes on */

/* Moves x on over a piece of length dt, or to the first event in it; splits < 0: without looking for one.  y: x at the
 * end of a whole piece, NULL for others.  What overflows is not looked at, and x is then not finite. */
static event move(const searched *m, instant *at, const climb *up, real dt, const real *y, int *splits, real *x_low,
				  real *work)
{
	const int n = m->size;
	event first = no_event;
	real *const low = work, *const coefficients = work + (WORDS - 1) * n;
	expand_piece(n, m->degree, matrix_now(m, at), dt, at->x, coefficients, low);
	if (pl_not_finite(coefficients, (m->degree + 1) * n)) {
		part_of_piece(n, m->degree, coefficients, low, 1, at->x, (real *)0);
		return no_event;
	}
	if (*splits >= 0) {
		first = first_event(m, at, coefficients, splits);
	}
	if (*splits < 0) {
		at->c->status |= PL_TOO_MANY_EVENTS;
		first = no_event;
	}
	VARIED(vary_piece(m, at, first.s * dt);)
	if (y && !first.any) {
		keep_piece(n, up, y, at->x, x_low);
	} else {
		part_of_piece(n, m->degree, coefficients, low, first.s, at->x, up->rungs > 0 ? x_low : (real *)0);
	}
	return first;
}

/* x on by tau; fresh: the region may be another one than before.  Whether all of it was event-free */
static int go(const searched *m, instant *at, real tau, int fresh)
{
	const int n = m->size;
	real left = tau, *y = at->work, *bend = y + WORDS * n, *x_low = bend + n, *work = x_low + 2 * n;
	int splits = m->max_splits, event_free = 1;
	climb up = at_top;
	at->work = work;
	while (left > REST * m->h) { /* nothing for what rounding leaves */
		const real longest = stand(&up, &m->ladder, m->halvings, at->c->matrix, m->h, left, n, x_low);
		int whole = left > longest * (1 - REST), how;
		const real dt = limited(m, at, whole ? longest : left);
		event first;
		whole = whole && dt >= longest;
		if (whole) {
			take_piece(n, &up, &m->ladder, m->Phi, at->c->matrix, at->x, y, x_low);
			hold(m, at, y, work);
			if (is_event_free(m, at, &up, y, bend, work)) {
				VARIED(vary_piece(m, at, dt);)
				keep_piece(n, &up, y, at->x, x_low);
				VARIED(vary_held(m, at);)
				left -= dt;
				fresh = 0;
				rise(&up);
				continue;
			}
		}
		if (fall(&up)) {
			continue;
		}
		event_free = 0;
		if (fresh) {
			fresh = 0;
			take_up(m, at, tau - left);
			up.bent = 0;
			continue;
		}
		first = move(m, at, &up, dt, whole ? y : (real *)0, &splits, x_low, work);
		VARIED(vary_held(m, at);)
		hold(m, at, at->x, work);
		up.bent = 0;
		if (splits < 0 || is_lost(&up, n, at->x)) {
			break; /* x is held: this region may not be the one, and may be unstable */
		}
		left -= first.s * dt;
		if (!first.any) {
			rise(&up);
			continue;
		}
		to_the_ground(&up);
		how = pass(m, at, &first, tau - left);
		if (how == STAY) {
			break;
		}
		splits = how == SEARCH_NO_MORE ? -1 : splits;
	}
	VARIED(end_event(m, at);)
	return event_free;
}
