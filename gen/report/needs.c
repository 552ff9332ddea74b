/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was chosen for the needs of a spec, and from what: accuracy against cost. */
#include "model/checks.h"
#include "model/linear/modal_truncation.h"
#include "report/report.h"
#include "step/certify/certify.h"

#include <math.h>
#include <string.h>

/* modes 7-12 dropped, static gain kept; NULL: all are there */
static const char *dropped_text(const struct alternative *a)
{
	const struct modal_truncation *s = a->model->reduction.truncated;
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

const char *certified_text(const struct alternative *a, int i)
{
	const struct certificate *c = &a->certificate[i];
	if (a->measured)
		return format("measured %.2g (%s%s)", c->rounding, tried_text(a),
			      a->inputs_tried ? format("; the worst of %d inputs tried", a->inputs_tried) : "");
	const char *dropped = dropped_text(a);
	if (!dropped)
		return format("certified %.2g (rounding: %s)", error_reported(c), arithmetic_text(a));
	if (c->walked)
		return format("certified %.2g (%.2g for %s; %s)", c->error, c->dropped, dropped, arithmetic_text(a));
	return format("certified %.2g = %.2g (%s) + %.2g (%s)", c->rounding + c->dropped, c->dropped, dropped,
		      c->rounding, arithmetic_text(a));
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
	return format(", of %.3g where %s %s 10 %% more or less", 1 / a->worst_neighbour, a->neighbour_names,
		      a->neighbours > 2 ? "are each" : "is");
}

/* What was walked is true of products and sums that are each rounded. */
static const char *contracted_text(const struct alternative *a, int i)
{
	const struct certificate *c = &a->certificate[i];
	return !c->walked      ? ""
	       : a->as_written ? "; a compiler that contracts products is refused"
			       : format("; %.2g where a compiler contracts products", c->rounding + c->dropped);
}

const char *margin_text(const struct step *step, int i)
{
	const struct alternative *a = &step->choice->alternative[step->choice->taken];
	const struct certificate *c = &a->certificate[i];
	return format("%s at every sample, a margin of %.3g%s%s", certified_text(a, i), c->needed / error_reported(c),
		      neighbours_text(a), contracted_text(a, i));
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
		fprintf(to, "%s: not %s, %s\n", alternative_text(a), a->measured ? "measured" : "certified", a->why);
		return;
	}
	for (int k = 0; k < step->model->needs.requirements; k++)
		fprintf(to, "%s%s", k ? ", " : "", strchr(certified_text(a, k), ' ') + 1);
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
	fprintf(to, "Alternatives (* taken; %s%s, the outputs counted; %s):\n", unit_of_cost(model),
		measured ? ", in a second of the model's time" : "", measured ? "error" : "bound of the error");
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
	const struct modal_truncation *s = a->model->reduction.truncated;
	fprintf(to, "\"modes\": \"%s\", \"statics\": %s, ", s ? mode_numbers(s, true) : "all",
		s && s->static_correction ? "true" : "false");
}

static void json_error(FILE *to, const struct alternative *a, int k)
{
	const struct certificate *c = &a->certificate[k];
	fprintf(to, "%s{\"%s\": %.17g, ", k ? ", " : "", a->measured ? "measured" : "certified", error_reported(c));
	if (!a->measured)
		fprintf(to, "\"walked\": %s, \"dropped\": %s, \"rounding\": %s, ", c->walked ? "true" : "false",
			json_number(c->dropped), json_number(c->known ? c->rounding : HUGE_VAL));
	fprintf(to, "\"needed\": %.17g}", c->needed);
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
