/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was chosen for the needs of a spec, and from what: accuracy against cost. */
#include "report/report.h"

#include <string.h>

const char *alternative_text(const struct alternative *a)
{
	return format("%s, %s%s", a->single ? "float" : "double", step_form_name(a->form),
		      a->compensated ? ", two words" : "");
}

const char *need_text(const struct requirement *r)
{
	const struct need *need = r->need;
	const char *text = format("%s within %s%s until %s", need->output,
				  text_between(need->bound->start, need->bound->end), need->percent ? " %" : "",
				  text_between(need->until->start, need->until->end));
	for (int i = 0; i < need->inputs; i++)
		text = format("%s%s |%s| <= %s", text, i ? "," : " for", need->input[i].name,
			      text_between(need->input[i].most->start, need->input[i].most->end));
	return text;
}

static const char *unit_of_cost(const struct model *model)
{
	return model->target ? format("instructions on %s", model->target->name)
			     : "operations, those of double counted twice";
}

const char *certified_text(const struct step *step, int i)
{
	const struct alternative *a = &step->choice->alternative[step->choice->taken];
	const struct certificate *c = &a->certificate[i];
	const double needed = needed_error(&step->model->requirement[i], c);
	return format("certified %.2g at every sample: rounding, %s; a margin of %.3g", c->rounding,
		      alternative_text(a), needed / c->rounding);
}

static void person_alternative(FILE *to, const struct step *step, int i)
{
	const struct alternative *a = &step->choice->alternative[i];
	if (a->refused) {
		fprintf(to, "              %-26s there is none: %s\n", alternative_text(a), a->refused);
		return;
	}
	fprintf(to, "    %c %7.0f %-26s", i == step->choice->taken ? '*' : ' ', a->cost, alternative_text(a));
	if (a->why) {
		fprintf(to, " not certified: %s\n", a->why);
		return;
	}
	for (int k = 0; k < step->model->requirements; k++)
		fprintf(to, "%s%.2g", k ? ", " : " ", a->certificate[k].rounding);
	fprintf(to, a->excess > 1 ? "; misses by a factor of %.3g\n" : "; a margin of %.3g\n",
		a->excess > 1 ? a->excess : 1 / a->excess);
}

void person_needs(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	fputs("\nNeeds:\n", to);
	for (int i = 0; i < model->requirements; i++)
		fprintf(to, "    %s: %s\n", need_text(&model->requirement[i]), certified_text(step, i));
	fprintf(to, "Alternatives (* taken; %s, the outputs counted; bound of the error):\n", unit_of_cost(model));
	for (int i = 0; i < step->choice->alternatives; i++)
		person_alternative(to, step, i);
}

static const char *json_quoted(const char *text)
{
	const char *quoted = "";
	for (; *text; text++)
		quoted = format("%s%s%c", quoted, *text == '"' || *text == '\\' ? "\\" : "", *text);
	return format("\"%s\"", quoted);
}

void json_needs(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	fputs("  \"needs\": [", to);
	for (int i = 0; i < model->requirements; i++)
		fprintf(to, "%s%s", i ? ", " : "", json_quoted(need_text(&model->requirement[i])));
	fputs("],\n  \"alternatives\": [", to);
	for (int i = 0; i < step->choice->alternatives; i++) {
		const struct alternative *a = &step->choice->alternative[i];
		fprintf(to, "%s\n    {\"real\": \"%s\", \"form\": \"%s\", \"accuracy\": \"%s\", \"taken\": %s",
			i ? "," : "", a->single ? "float" : "double", step_form_name(a->form),
			a->compensated ? "compensated" : "plain", i == step->choice->taken ? "true" : "false");
		if (a->refused || a->why) {
			fprintf(to, ", \"why\": %s}", json_quoted(a->refused ? a->refused : a->why));
			continue;
		}
		fprintf(to, ", \"cost\": %.17g, \"excess\": %.17g, \"errors\": [", a->cost, a->excess);
		for (int k = 0; k < model->requirements; k++)
			fprintf(to, "%s{\"certified\": %.17g, \"rounding\": %.17g, \"needed\": %.17g}", k ? ", " : "",
				a->certificate[k].rounding, a->certificate[k].rounding,
				needed_error(&model->requirement[k], &a->certificate[k]));
		fputs("]}", to);
	}
	fputs("],\n", to);
}
