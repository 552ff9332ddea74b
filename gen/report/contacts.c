/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contacts, friction and impacts beside a series: in words and as JSON. */
#include "model/contacts/contacts.h"
#include "report/report.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "step/contacts/series_contacts.h"

/* The interval of its expression in which it is held */
static int held_in(const struct step *step, const struct series_hold *hold)
{
	return step->taylor.switching->function[hold->function].rank[hold->breakpoint] + 1;
}

/* Friction, and where it sticks */
static const char *contact_text(const struct step *step, int hold)
{
	const struct contacts *c = step->taylor.switching->contacts;
	const struct model *model = step->model;
	const struct node *node = NULL;
	for (int i = 0, drag = 0; i <= hold; i++)
		if (c->hold[i].impact == NONE)
			node = model->contacts.drag[drag++].atom->node;
	return format("%s; sticks in interval %d of switching function %d", text_between(node->start, node->end),
		      held_in(step, &c->hold[hold]), c->hold[hold].function);
}

static const char *rest_text(const struct step *step, const struct series_impact *series_impact)
{
	const struct contacts *c = step->taylor.switching->contacts;
	return series_impact->hold == NONE ? "" : format("; a bounce of restitution %s, which rests in interval %d of "
						  "switching function %d",
						  shortest(series_impact->restitution),
						  held_in(step, &c->hold[series_impact->hold]),
						  series_impact->function);
}

void text_impact_rules(FILE *to, const struct model *model)
{
	if (model->contacts.impacts > 1)
		fputs("Those of one instant act in this order, each from the state that the one before has left.\n",
		      to);
	if (has_bounces(model))
		fprintf(to, "Bounces that would all be over within 2^-23 h come to rest: %s_rested counts.\n",
			model->name);
}

void text_contacts(FILE *to, const struct step *step)
{
	const struct contacts *c = step->taylor.switching->contacts;
	for (int i = 0, friction = 0; c && i < c->holds; i++)
		if (c->hold[i].impact == NONE)
			fprintf(to, "    friction %d: %s\n", friction++, contact_text(step, i));
	for (int i = 0; c && i < c->series_impacts; i++) {
		const struct when *when = step->model->contacts.impact[i].when;
		fprintf(to, "    impact %d: %s%s\n", i, text_between(when->at, when->end),
			rest_text(step, &c->series_impact[i]));
	}
	if (c)
		text_impact_rules(to, step->shown->model);
}

void json_contacts(FILE *to, const struct step *step)
{
	const struct contacts *c = step->taylor.switching->contacts;
	bool first = true;
	if (c && step->model->contacts.drags > 0)
		fputs("  \"frictions\": [", to);
	for (int i = 0; c && i < c->holds; i++) {
		if (c->hold[i].impact != NONE)
			continue;
		fprintf(to, "%s{\"expression\": %d, \"sticks\": %d}", first ? "" : ", ", c->hold[i].function,
			held_in(step, &c->hold[i]));
		first = false;
	}
	if (c && step->model->contacts.drags > 0)
		fputs("],\n", to);
	for (int i = 0; c && i < c->series_impacts; i++) {
		const struct series_impact *s = &c->series_impact[i];
		fprintf(to, "%s{\"expression\": %d, \"upward\": %s, \"restitution\": ", i ? ", " : "  \"impacts\": [",
			s->function, s->upward ? "true" : "false");
		if (s->hold == NONE)
			fputs("null}", to);
		else
			fprintf(to, "%.17g, \"rests\": %d}", s->restitution, held_in(step, &c->hold[s->hold]));
		if (i == c->series_impacts - 1)
			fputs("],\n", to);
	}
}
