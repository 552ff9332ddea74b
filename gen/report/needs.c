/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was chosen for the needs of a spec, and from what: accuracy against cost. */
#include "model/checks.h"
#include "model/linear/modal_truncation.h"
#include "report/report.h"
#include "step/choice.h"

#include <math.h>
#include <string.h>

/* modes 7-12 dropped, static gain kept; NULL: all are there */
static const char *dropped_text(const struct alternative *a)
{
	const struct modal_truncation *s = a->model->truncated;
	const char *numbers = s ? mode_numbers(s, false) : "";
	return *numbers ? format("modes %s dropped%s", numbers, s->static_correction ? ", static gain kept" : "")
		: NULL;
}

/* Of one that is measured */
static const char *tried_text(const struct alternative *a)
{
	return format("%s, %s%s%s%s%s", a->single ? "float" : "double", a->name, a->step ? ", step " : "",
		      a->step ? a->step : "", a->tolerance ? ", tolerance " : "", a->tolerance ? a->tolerance : "");
}

static const char *arithmetic_text(const struct alternative *a)
{
	return format("%s, %s%s", a->single ? "float" : "double", step_form_name(a->form),
		      a->compensated ? ", two words" : "");
}

const char *alternative_text(const struct alternative *a)
{
	if (a->measured)
		return tried_text(a);
	const char *dropped = dropped_text(a);
	return format("%s%s%s", arithmetic_text(a), dropped ? "; " : "", dropped ? dropped : "");
}

static const char *inputs_text(const struct alternative *a)
{
	return a->inputs_tried ? format("the worst of %d inputs tried", a->inputs_tried) : "";
}

const char *error_text(const struct alternative *a, int i)
{
	const struct error_found *e = &a->found[i];
	const char *word = e->exact ? "certified" : "measured";
	if (a->measured)
		return format("measured %.2g (%s%s%s)", e->error, tried_text(a), a->inputs_tried ? "; " : "",
			      inputs_text(a));
	const char *dropped = dropped_text(a);
	if (!dropped)
		return format("%s %.2g (rounding: %s)", word, e->error, arithmetic_text(a));
	return format("%s %.2g (%.2g for %s%s; %s)", word, e->error, e->dropped, dropped,
		      a->inputs_tried ? ", with any inputs" : "", arithmetic_text(a));
}

/* As written, a unit behind it too */
static const char *quantity_text(const struct node *value)
{
	const char *text = text_between(value->start, value->end);
	return value->unit ? format("%s %s", text, value->unit->text) : text;
}

const char *need_text(const struct requirement *r)
{
	const struct need *need = r->need;
	const char *text = format("%s within %s%s until %s", need->output,
				  quantity_text(need->bound), need->percent ? " %" : "", quantity_text(need->until));
	for (int i = 0; i < need->inputs; i++)
		text = format("%s%s |%s| <= %s", text, i ? "," : " for", need->input[i].name,
			      quantity_text(need->input[i].most));
	return text;
}

static const char *unit_of_cost(const struct model *model)
{
	return model->needs.target ? format("instructions on %s", model->needs.target->name)
			     : "operations, those of double counted twice";
}

static const char *neighbours_text(const struct alternative *a)
{
	if (a->neighbours == 0)
		return "";
	const char *names = a->neighbour_names, *text = format(", of %.3g where ", 1 / a->worst_neighbour);
	if (names)
		text = format("%s%s %s 10 %% more or less", text, names, strchr(names, ',') ? "are each" : "is");
	if (a->ends)
		text = format("%s%s%s %s at ends of ranges", text, names ? ", or " : "", a->ends,
			      strchr(a->ends, ',') ? "are" : "is");
	return text;
}

const char *margin_text(const struct step *step, int i)
{
	const struct alternative *a = &step->choice->alternative[step->choice->taken];
	return format("%s at every sample, a margin of %.3g%s%s%s%s", error_text(a, i),
		      a->found[i].needed / a->found[i].error, a->measured || !a->inputs_tried ? "" : ", ",
		      a->measured ? "" : inputs_text(a), neighbours_text(a),
		      a->as_written ? "; a compiler that contracts products is refused" : "");
}

static void text_alternative(FILE *to, const struct step *step, int i)
{
	const struct alternative *a = &step->choice->alternative[i];
	if (a->refused) {
		fprintf(to, "              %s: there is none, %s\n", alternative_text(a), a->refused);
		return;
	}
	fprintf(to, "    %c %7.0f  ", i == step->choice->taken ? '*' : ' ', a->cost);
	if (a->why) {
		fprintf(to, "%s: not measured, %s\n", alternative_text(a), a->why);
		return;
	}
	for (int k = 0; k < step->model->needs.requirements; k++)
		fprintf(to, "%s%s", k ? ", " : "", strchr(error_text(a, k), ' ') + 1);
	if (a->error_ratio <= 1 && a->worst_neighbour > 0.99) {
		fprintf(to, "; misses by a factor of %.3g where %s\n", a->worst_neighbour, a->worst_name);
		return;
	}
	fprintf(to, a->error_ratio > 1 ? "; misses by a factor of %.3g\n" : "; a margin of %.3g\n",
		a->error_ratio > 1 ? a->error_ratio : 1 / a->error_ratio);
}

/* More exact than all that is cheaper; of what there is not, the first with its reason */
static bool is_shown(const struct choice *choice, int i)
{
	const struct alternative *a = &choice->alternative[i];
	bool shown = true;
	for (int k = 0; k < i && shown; k++) {
		const struct alternative *b = &choice->alternative[k];
		if (a->refused)
			shown = !b->refused || strcmp(a->refused, b->refused) != 0;
		else
			shown = !a->why && (b->why || b->error_ratio > a->error_ratio);
	}
	return shown || i == choice->taken;
}

void text_needs(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	const struct choice *choice = step->choice;
	int left = 0;
	fputs("\nNeeds:\n", to);
	for (int i = 0; i < model->needs.requirements; i++)
		fprintf(to, "    %s: %s\n", need_text(&model->needs.requirement[i]), margin_text(step, i));
	const bool measured = choice->alternative[0].measured;
	fprintf(to, "Alternatives (* taken; %s%s, the outputs counted; error):\n", unit_of_cost(model),
		measured ? ", in a second of the model's time" : "");
	for (int i = 0; i < choice->alternatives; i++)
		if (is_shown(choice, i))
			text_alternative(to, step, i);
		else
			left++;
	if (left)
		fprintf(to, "and %d more that are dearer than a more exact one, or that there are not.\n", left);
}

static void json_tried(FILE *to, const struct alternative *a)
{
	fprintf(to, "\"scheme\": \"%s\", ", json_text(a->name));
	if (a->step)
		fprintf(to, "\"step\": %s, ", a->step);
	if (a->tolerance)
		fprintf(to, "\"tolerance\": %s, ", a->tolerance);
}

static void json_modes(FILE *to, const struct alternative *a)
{
	const struct modal_truncation *s = a->model->truncated;
	fprintf(to, "\"modes\": \"%s\", \"statics\": %s, ", s ? mode_numbers(s, true) : "all",
		s && s->static_correction ? "true" : "false");
}

static void json_error(FILE *to, const struct alternative *a, int k)
{
	const struct error_found *e = &a->found[k];
	fprintf(to, "%s{\"%s\": %.17g, ", k ? ", " : "", e->exact ? "certified" : "measured", e->error);
	if (!a->measured)
		fprintf(to, "\"dropped\": %s, ", json_number(e->dropped));
	fprintf(to, "\"needed\": %.17g}", e->needed);
}

void json_needs(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	fputs("  \"needs\": [", to);
	for (int i = 0; i < model->needs.requirements; i++)
		fprintf(to, "%s\"%s\"", i ? ", " : "", json_text(need_text(&model->needs.requirement[i])));
	fputs("],\n  \"alternatives\": [", to);
	for (int i = 0; i < step->choice->alternatives; i++) {
		const struct alternative *a = &step->choice->alternative[i];
		fprintf(to, "%s\n    {", i ? "," : "");
		(a->measured ? json_tried : json_modes)(to, a);
		fprintf(to, "\"real\": \"%s\", \"form\": \"%s\", \"accuracy\": \"%s\", \"taken\": %s",
			a->single ? "float" : "double", step_form_name(a->form),
			a->compensated ? "compensated" : "plain", i == step->choice->taken ? "true" : "false");
		if (a->refused || a->why) {
			fprintf(to, ", \"why\": \"%s\"}", json_text(a->refused ? a->refused : a->why));
			continue;
		}
		fprintf(to, ", \"cost\": %.17g, \"excess\": %.17g, ", a->cost, a->error_ratio);
		if (a->neighbours > 0)
			fprintf(to, "\"neighbours\": %.17g, ", a->worst_neighbour);
		fputs("\"errors\": [", to);
		for (int k = 0; k < model->needs.requirements; k++)
			json_error(to, a, k);
		fputs("]}", to);
	}
	fputs("],\n", to);
}
