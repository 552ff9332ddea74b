/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a verified trajectory: the list of its crossings, and where switching functions stand. */
#include "model/regions/switching_functions.h"
#include "model/regions/regions.h"
#include "certify.h"
#include "trajectory.h"

#include <math.h>

static struct passed *new_passed(struct trajectory *t, int function, int breakpoint, bool upward, mpfr_srcptr off)
{
	struct passed *p = MORE(t->noted.list, t->noted.count);
	*p = (struct passed){ .function = function, .breakpoint = breakpoint, .upward = upward };
	mpfi_init2(p->at, t->precision);
	mpfi_set_q(p->at, t->base);
	mpfi_increase(p->at, off);
	return p;
}

void trajectory_note(struct trajectory *t, const struct guard *guard, mpfr_srcptr off)
{
	struct passed *p = new_passed(t, guard->function, guard->breakpoint, guard->upward, off);
	INTERVAL slope = OVER_BITS(t->precision);
	trajectory_dot(t, guard->slope, t->x, slope);
	p->speed = t->noted.speed = fabs(mpfi_get_d(slope));
	t->noted.size = 0;
	for (int i = 0; i < t->n; i++)
		t->noted.size += fabs(guard->near_row[i] * mpfi_get_d(t->x[i]));
	p->size = t->noted.size;
}

/* By an event that was noted, or by a load that jumps */
void trajectory_note_plain(struct trajectory *t, int function, int breakpoint, bool upward, mpfr_srcptr off)
{
	struct passed *p = new_passed(t, function, breakpoint, upward, off);
	p->jumped = t->noted.speed == 0;
	p->speed = t->noted.speed;
	p->size = t->noted.size;
}

/* ---- where switching functions stand ---- */

/* e - at, 1 above, -1 below; 0: not told apart */
int trajectory_side(const struct trajectory *t, int function, mpq_srcptr at)
{
	RATIONALS *row = rationals(t->n);
	INTERVAL value = OVER_BITS(t->precision);
	trajectory_row(t, t->s->function[function].row, row);
	trajectory_dot(t, row, t->x, value);
	mpfi_sub_q(value, value, at);
	return mpfr_sgn(&value->left) > 0 ? 1 : mpfr_sgn(&value->right) < 0 ? -1 : 0;
}
