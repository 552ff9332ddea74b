/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Intervals of regions in which something is held, and what begins at their ends. */
#include "contacts.h"

int impact_at(const struct switching *s, int segment, int function, mpq_srcptr at, bool upward)
{
	for (int i = 0; i < s->impacts; i++) {
		const struct impact_law *impact_law = &s->impact[i].in[segment];
		if (impact_law->function == function && impact_law->upward == upward &&
		    mpq_equal(impact_law->at, at))
			return i;
	}
	return -1;
}

int impact_resting(const struct switching *s, int segment, int function, int interval)
{
	for (int i = 0; i < s->impacts; i++)
		if (s->impact[i].bounces && s->impact[i].in[segment].function == function &&
		    rest_of(s, segment, &s->impact[i]) == interval)
			return i;
	return -1;
}

int rest_of(const struct switching *s, int segment, const struct impact *impact)
{
	const struct impact_law *impact_law = &impact->in[segment];
	const struct switching_function *e = &s->function[impact_law->function];
	for (int k = 1; k < e->breaks && impact->bounces; k++)
		if (is_stick(e, k) && mpq_equal(e->at[k], impact_law->at))
			return k;
	return -1;
}

bool has_contacts(const struct model *model)
{
	return model->contacts.drags > 0 || (model->contacts.impacts > 0 && !model->switching);
}

bool gives_motion(const struct model *model)
{
	const struct scheme_row *row = scheme_row(model->scheme);
	return has_contacts(model) && (row->expands || row->collocates);
}

bool has_bounces(const struct model *model)
{
	bool any = false;
	for (int i = 0; i < model->contacts.impacts; i++)
		any = any || model->contacts.impact[i].bounces;
	return any;
}

const char *restitution_text(const struct model *model, const struct impact *impact)
{
	const char *text = readable_text(impact->in->restitution);
	for (int s = 1; s < model->system.segments; s++)
		if (!mpq_equal(impact->in[s].restitution, impact->in[s - 1].restitution))
			text = format("%s, from t = %s on %s", text, readable_text(model->system.change[s - 1]),
				      readable_text(impact->in[s].restitution));
	return text;
}

bool has_events(const struct switching *s)
{
	return has_dry_friction(s) || s->impacts > 0;
}

bool has_dry_friction(const struct switching *s)
{
	return s->frictions > 0 || s->sliders > 0;
}
