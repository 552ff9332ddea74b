/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a way through crossings: the list of them, and where expressions stand. */
#include "model/regions/expressions.h"
#include "model/regions/regions.h"
#include "certify.h"
#include "through.h"

#include <math.h>

static struct passed *new_passed(struct through *t, int expression, int breakpoint, bool upward, mpfr_srcptr off)
{
	struct passed *p = MORE(t->noted.list, t->noted.count);
	*p = (struct passed){ .expression = expression, .breakpoint = breakpoint, .upward = upward };
	mpfi_init2(p->at, t->precision);
	mpfi_set_q(p->at, t->base);
	mpfi_increase(p->at, off);
	return p;
}

void through_note(struct through *t, const struct guard *guard, mpfr_srcptr off)
{
	struct passed *p = new_passed(t, guard->expression, guard->breakpoint, guard->upward, off);
	INTERVAL slope = OVER_BITS(t->precision);
	through_dot(t, guard->slope, t->x, slope);
	p->speed = t->noted.speed = fabs(mpfi_get_d(slope));
	t->noted.size = 0;
	for (int i = 0; i < t->n; i++)
		t->noted.size += fabs(guard->near_row[i] * mpfi_get_d(t->x[i]));
	p->size = t->noted.size;
}

/* By an event that was noted, or by a load that jumps */
void through_note_plain(struct through *t, int expression, int breakpoint, bool upward, mpfr_srcptr off)
{
	struct passed *p = new_passed(t, expression, breakpoint, upward, off);
	p->jumped = t->noted.speed == 0;
	p->speed = t->noted.speed;
	p->size = t->noted.size;
}

/* ---- where expressions stand ---- */

/* e - at, 1 above, -1 below; 0: not told apart */
int through_side(const struct through *t, int expression, mpq_srcptr at)
{
	RATIONALS *row = rationals(t->n);
	INTERVAL value = OVER_BITS(t->precision);
	through_row(t, t->s->expression[expression].row, row);
	through_dot(t, row, t->x, value);
	mpfi_sub_q(value, value, at);
	return mpfr_sgn(&value->left) > 0 ? 1 : mpfr_sgn(&value->right) < 0 ? -1 : 0;
}
