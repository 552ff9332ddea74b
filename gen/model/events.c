/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Intervals of regions in which something is held, and what begins at their ends. */
#include "model/model.h"

int impact_at(const struct switching *s, int expression, mpq_srcptr at, bool upward)
{
	for (int i = 0; i < s->impacts; i++)
		if (s->impact[i].expression == expression && s->impact[i].upward == upward &&
		    mpq_equal(s->impact[i].at, at))
			return i;
	return -1;
}

int impact_resting(const struct switching *s, int expression, int interval)
{
	for (int i = 0; i < s->impacts; i++)
		if (s->impact[i].bounces && s->impact[i].expression == expression &&
		    rest_of(s, &s->impact[i]) == interval)
			return i;
	return -1;
}

int rest_of(const struct switching *s, const struct impact *impact)
{
	const struct expression *e = &s->expression[impact->expression];
	for (int k = 1; k < e->breaks && impact->bounces; k++)
		if (is_stick(e, k) && mpq_equal(e->at[k], impact->at))
			return k;
	return -1;
}

bool has_bounces(const struct model *model)
{
	bool any = false;
	for (int i = 0; i < model->impacts; i++)
		any = any || model->impact[i].bounces;
	return any;
}

bool has_events(const struct switching *s)
{
	return rubs(s) || s->impacts > 0;
}

bool rubs(const struct switching *s)
{
	return s->frictions > 0 || s->sliders > 0;
}

int grips_in(const struct switching *s)
{
	return s->frictions + s->sliders;
}

const struct atom *atom_of_grip(const struct switching *s, int index)
{
	return index < s->frictions ? s->friction[index].atom : s->slider[index - s->frictions].atom;
}

int grip_of(const struct switching *s, const struct atom *a)
{
	int index = grips_in(s) - 1;
	while (index >= 0 && atom_of_grip(s, index) != a)
		index--;
	return index;
}
