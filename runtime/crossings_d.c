/* SPDX-License-Identifier: MIT-0 */
/* crossings.c with the derivatives of x beside it. */
#define WITH_DERIVATIVES
#include "crossings.c"

/* Pieces between crossings that are known need no look at what happens in them. */
void pl_switching_follow(const pl_switching *m, int count, const pl_crossing *crossing, real *x, pl_contact *c,
						 pl_variation *v)
{
	const real *const end = end_of_piece(m, v);
	instant at;
	real done = 0;
	int i, k;
	at.x = x;
	at.c = c;
	at.time = 0;
	at.v = v;
	c->crossings = 0;
	for (i = 0; i < count; i++, crossing++) {
		int stride = 1;
		vary_piece(m, &at, crossing->time - done);
		done = at.time = crossing->time;
		for (k = 0; k < m->size; k++) {
			x[k] = end[k];
		}
		meet_breakpoint(m, &at, crossing->expression, crossing->breakpoint);
		for (k = 0; k < crossing->expression; k++) {
			stride *= m->breaks[k] + 1;
		}
		enter(m, c, c->region + (crossing->upward ? stride : -stride));
	}
	vary_piece(m, &at, m->h - done);
	end_event(m, &at);
}
