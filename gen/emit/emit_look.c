/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The series that a step of a scheme with a leftover is looked at by, from crossing to crossing: emitters that print
 * one of them. */
#include "emit/emit.h"

struct view {
	struct step step;
	struct emitter e;
};

/* The same emitter, whose series is this one */
static const struct emitter *look_by(const struct emitter *e, struct expansion *x)
{
	struct view *view = NEW(struct view);
	view->step = *e->step;
	view->step.expansion = x;
	view->e = *e;
	view->e.step = &view->step;
	view->e.columns = format(x->columns && !x->alone ? "%s_STATES + %d" : "%s_STATES", e->upper, x->columns);
	return &view->e;
}

const struct emitter *looking(const struct emitter *e)
{
	return look_by(e, e->step->cut->look);
}

const struct emitter *ending(const struct emitter *e)
{
	return look_by(e, e->step->cut->ends);
}

const struct emitter *forcing(const struct emitter *e)
{
	return look_by(e, e->step->cut->forces);
}

const struct emitter *sloping(const struct emitter *e)
{
	return look_by(e, e->step->slopes);
}

const char *cut_evaluation(const struct emitter *e, const char *tau, const char *y, const char *left)
{
	return frozen_call(forcing(e), "within", "s", tau, "p->", y, left);
}
