/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was derived, as JSON for a program. */
#include "model/reads.h"
#include "model/tunable/tuning.h"
#include "report/report.h"
#include "step/collocation/collocation.h"
#include "step/cost.h"
#include "step/series/expansion.h"
#include "step/linear/forms.h"
#include "step/linear/images.h"
#include "step/linear/rows.h"

#include <math.h>

static void member_names(FILE *to, const char *key, int count, const char *const *name)
{
	fputs("  ", to);
	json_names(to, key, count, name);
	fputs(",\n", to);
}

/* Square */
static void json_rational_matrix(FILE *to, const char *key, int n, const mpq_t *A)
{
	fputs("  ", to);
	json_rationals(to, "    ", key, n, n, A);
	fputs(",\n", to);
}

/* One mode for each pair of poles, for each real pole, and for each two poles at 0 (a rigid body). */
static void json_modes(FILE *to, int count, const struct pole_report *pole)
{
	fputs("  \"modes\": [", to);
	bool first = true;
	for (int i = 0; i < count; i++) {
		int modes = mpfr_zero_p(pole[i].hertz) ? (pole[i].multiplicity + 1) / 2 : pole[i].multiplicity;
		for (int k = 0; k < modes; k++, first = false)
			fprintf(to, "%s\n    {\"frequency_hz\": %s, \"damping_ratio\": %s}", first ? "" : ",",
				json_number(mpfr_get_d(pole[i].hertz, MPFR_RNDN)),
				json_number(mpfr_get_d(pole[i].damping_ratio, MPFR_RNDN)));
	}
	fputs("],\n", to);
}

static void json_poles(FILE *to, const struct step *step)
{
	mpq_t *B;
	const int length = characteristic_of(step->model, step->written, &B);
	fputs("  \"B\": [", to);
	for (int k = 0; k < length; k++)
		fprintf(to, "%s\"%s\"", k ? ", " : "", exact_text(B[k]));
	fputs("],\n", to);
	struct pole_report *pole;
	int count = poles_of(step->model, step->written, &pole);
	json_pole_list(to, count, pole);
	fputs(",\n", to);
	json_modes(to, count, pole);
}

static void json_column(FILE *to, int rows, int columns, int column, const struct coefficient *value)
{
	fputc('[', to);
	for (int i = 0; i < rows; i++)
		fprintf(to, "%s%.17g", i ? ", " : "", value[i * columns + column].value);
	fputc(']', to);
}

/* Columns as the step applies them: to the load states at the start of the step, t^k times cos before sin. */
static void json_loads(FILE *to, const struct step *step)
{
	const struct table *table = step->shown->branch->full;
	fputs("  \"loads\": [", to);
	for (int l = 0, column = 0; l < step->branch->system.loads; l++) {
		const struct load *load = &step->branch->system.load[l];
		int trig = oscillates(load->forcing) ? 2 : 1;
		for (int k = 0; k < load->columns; k += trig) {
			fprintf(to, "%s\n    {\"term\": \"%s\", \"columns\": [", column ? "," : "",
				column_text(load, k));
			for (int i = 0; i < trig; i++, column++) {
				fputs(i ? ", " : "", to);
				json_column(to, table->states, table->columns, column, table->load);
			}
			fputs("]}", to);
		}
	}
	fputs("],\n  \"Gamma\": [", to);
	for (int i = 0, column = 0; i < step->branch->system.inputs; i++) {
		fprintf(to, "%s\n    {\"input\": \"%s\", \"columns\": [", i ? "," : "",
			step->branch->system.input[i].name);
		for (int k = 0; k <= step->branch->system.input[i].hold; k++, column++) {
			fputs(k ? ", " : "", to);
			json_column(to, table->states, table->inputs, column, table->input);
		}
		fputs("]}", to);
	}
	fputs("],\n", to);
}

/* Operators as what multiplies q' and q, and their poles; the remainder of the first, as text */
static void json_split(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	if (step->normal)
		json_normal(to, step);
	fputs("  \"operators\": [", to);
	for (int k = 0; k < model->schedule.operators && !step->normal; k++) {
		struct pole_report *pole;
		int count = poles_of(model, step->shown->branch[k].resolvent, &pole);
		fprintf(to, "%s{\n  \"at\": \"%s\",\n", k ? ", " : "", model->schedule.operator[k].text);
		json_rational_matrix(to, "C", model->n, model->schedule.operator[k].C);
		json_rational_matrix(to, "K", model->n, model->schedule.operator[k].K);
		json_pole_list(to, count, pole);
		fputs("}", to);
	}
	fputs("],\n  \"remainder\": [", to);
	for (int c = 0; c < model->remainder.force_columns; c++)
		fprintf(to, "%s\n    {\"equation\": \"%s\", \"force\": \"%s\"}", c ? "," : "",
			model->names.coord[coordinate_of_row(model, model->remainder.row[c])],
			form_text(model, model->schedule.operator[0].left[c]));
	fputs("],\n", to);
}

static void json_tuning(FILE *to, const struct tuning *t)
{
	fputs("  \"tunable\": [", to);
	for (int k = 0; k < t->given; k++)
		fprintf(to, "%s{\"name\": \"%s\", \"value\": %.17g}", k ? ", " : "", t->param[k].symbol->name,
			nearest_double(t->nominal[k]));
	fputs("],\n", to);
}

/* A step; beside it what refreshes, peaks, blocks of rows and forced parts take */
/* The most instructions of a step on each target, or why there is no bound */
static void json_worst(FILE *to, const struct step *step)
{
	if (unbounded_text(step)) {
		fprintf(to, ",\n    \"unbounded\": \"%s\"", unbounded_text(step));
		return;
	}
	for (int t = 0; worst_target(t); t++)
		fprintf(to, "%s\"%s\": %.0f", t ? ", " : ",\n    \"worst\": {", worst_target(t),
			worst_of_step(step, t, step->model->request.single));
	fputs("}", to);
}

static void json_cost(FILE *to, const struct step *step)
{
	const struct program *program = step->program;
	fprintf(to, "  \"cost\": {\"multiplications\": %d, \"additions\": %d", program->multiplications,
		program->additions);
	if (program->calls)
		fprintf(to, ", \"calls\": %d", program->calls);
	if (program->forcing_multiplications)
		fprintf(to, ",\n    \"loads\": {\"every\": %d, \"multiplications\": %d, \"additions\": %d, "
			"\"numbers\": %d}",
			step->refresh ? step->refresh->steps : 1, program->forcing_multiplications,
			program->forcing_additions, refresh_numbers(step));
	if (program->peak_multiplications)
		fprintf(to, ",\n    \"peaks\": {\"multiplications\": %d, \"additions\": %d}",
			program->peak_multiplications, program->peak_additions);
	if (step->forced)
		fprintf(to, ",\n    \"shown\": {\"multiplications\": %d, \"additions\": %d}",
			step->forced->multiplications, step->forced->additions);
	if (step->board && !step->board->why)
		fprintf(to, ",\n    \"board\": {\"target\": \"cortex-m4\", \"instructions\": %.3g, \"most\": %.3g, "
			"\"steps\": %d, \"bytes\": %ld}", step->board->mean, step->board->most, step->board->steps,
			step->board->bytes);
	json_worst(to, step);
	if (step->rows)
		fprintf(to, ",\n    \"rows\": {\"count\": %d, \"numbers\": %d}", step->rows->count,
			row_numbers(step));
	fputs("}\n", to);
}

/* States of parts that are not modelled, then what reduction left out */
static void json_dropped(FILE *to, const struct model *model)
{
	const struct spec *spec = model->spec;
	const char **name = ARRAY(const char *, (size_t)(spec->assembly.unobservable + model->reduction.dropped));
	for (int i = 0; i < spec->assembly.unobservable; i++)
		name[i] = spec->assembly.unobservable_name[i];
	for (int i = 0; i < model->reduction.dropped; i++)
		name[spec->assembly.unobservable + i] = model->reduction.dropped_name[i];
	member_names(to, "dropped", spec->assembly.unobservable + model->reduction.dropped, name);
}

static void json_assembly(FILE *to, const struct spec *spec)
{
	fputs("  \"scene\": [", to);
	for (int i = 0; i < spec->assembly.parts; i++)
		fprintf(to, "%s{\"name\": \"%s\", \"file\": \"%s\", \"modelled\": %s}", i ? ", " : "",
			spec->assembly.part[i]->name, json_text(spec->assembly.part[i]->file),
			spec->assembly.part[i]->unobservable ? "false" : "true");
	fputs("],\n", to);
}

/* What the spec says of single states */
static void json_bounds(FILE *to, const struct model *model)
{
	const mpq_t *absolute = model->truncation.absolute;
	const bool looks = mpq_sgn(model->truncation.tolerance) != 0 && scheme_row(model->scheme)->expands;
	bool any = false;
	for (int i = 0; i < model->system.states && absolute && looks; i++) {
		if (mpq_sgn(absolute[i]) == 0)
			continue;
		fprintf(to, "%s\"%s\": %s", any ? ", " : "  \"absolute\": {", model->names.state[i],
			shortest(round_rational(absolute[i])));
		any = true;
	}
	fputs(any ? "},\n" : "", to);
	for (int i = 0; i < model->ranges; i++)
		fprintf(to, "%s\"%s\": [%s, %s]", i ? ", " : "  \"ranges\": {",
			model->names.state[model->range[i].state], shortest(round_rational(model->range[i].low)),
			shortest(round_rational(model->range[i].high)));
	fputs(model->ranges ? "},\n" : "", to);
}

/* Its order here, and what it goes by */
static void json_scheme(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	static const char *const smooth[] = { "smooth", "kink", "jump" };
	fprintf(to, "  \"order\": %d,\n  \"smooth\": \"%s\",\n",
		step->taylor.expansion && !loses_order(model) ? order_of_step(step) : order_that_holds(model),
		smooth[model->remainder.smooth.kind]);
	if (step->collocation)
		fprintf(to,
			"  \"stages\": %d,\n"
			"  \"iteration\": {\"multiplications\": %d, \"additions\": %d, \"calls\": %d},\n",
			step->collocation->stages, step->collocation->iteration.multiplications,
			step->collocation->iteration.additions, step->collocation->iteration.calls);
	if ((step->taylor.expansion || step->collocation) && mpq_sgn(model->truncation.tolerance) != 0)
		fprintf(to, "  \"tolerance\": %s,\n", shortest(round_rational(model->truncation.tolerance)));
	if (model->truncation.adaptive && (step->taylor.expansion || step->collocation))
		fprintf(to, "  \"substeps\": %d,\n", model->truncation.substeps);
	if (step->taylor.expansion && model->truncation.over > 1)
		fprintf(to, "  \"over\": %d,\n", model->truncation.over);
	if (step->taylor.switching)
		json_series_switching(to, step);
	if (step->taylor.expansion)
		json_reach(to, step);
}

static const char *place_text(const struct node *node)
{
	return node ? json_text(text_between(node->start, node->end)) : "0";
}

/* Expressions as they are written */
static void json_drawings(FILE *to, const struct spec *spec)
{
	fputs("  \"drawing\": [", to);
	for (int i = 0; i < spec->page.drawings; i++) {
		const struct drawing *d = &spec->page.drawing[i];
		fprintf(to, "%s{\"what\": \"%s\"", i ? ",\n    " : "", d->what);
		for (int k = 0; k < d->points; k++)
			fprintf(to, ", \"%s\": [\"%s\", \"%s\"]", d->points == 1 ? "at" : k ? "to" : "from",
				place_text(d->point[k][0]), place_text(d->point[k][1]));
		if (d->radius)
			fprintf(to, ", \"radius\": \"%s\"", place_text(d->radius));
		if (d->turn)
			fprintf(to, ", \"turned\": \"%s\"", place_text(d->turn));
		fputs("}", to);
	}
	fputs("],\n", to);
}

void explain_json(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	const char **output = ARRAY(const char *, model->outputs);
	const int states = model->system.states;
	double *Phi = ARRAY(double, (size_t)(states * states));
	const char **input = ARRAY(const char *, model->system.inputs);
	for (int i = 0; i < model->system.inputs; i++)
		input[i] = model->system.input[i].name;
	for (int i = 0; i < model->outputs; i++)
		output[i] = model->output[i].name;
	for (int i = 0; i < states * states; i++)
		Phi[i] = step->shown->branch->full->Phi[i].value;
	fprintf(to,
		"{\n  \"model\": \"%s\",\n  \"scheme\": \"%s\",\n  \"form\": \"%s\",\n  \"accuracy\": \"%s\",\n  "
		"\"real\": \"%s\",\n  \"step\": %.17g,\n",
		model->name, scheme_name(model->scheme), step_form_name(step->form),
		step->is.two_words ? "compensated" : "plain", target_name(), nearest_double(model->h));
	member_names(to, "states", states, model->names.state);
	member_names(to, "outputs", model->outputs, output);
	member_names(to, "inputs", model->spec->count.inputs, input);
	json_units(to, step);
	json_dropped(to, model);
	if (model->reduction.truncated)
		json_modal_truncation(to, model);
	if (model->spec->assembly.parts)
		json_assembly(to, model->spec);
	if (model->spec->page.drawings)
		json_drawings(to, model->spec);
	if (model->written->equations.free)
		json_symmetries(to, model->written);
	if (tunables_of(model))
		json_tuning(to, tunables_of(model));
	json_rational_matrix(to, "M", model->written->n, model->written->system.M);
	json_rational_matrix(to, "C", model->written->n, model->written->system.C);
	json_rational_matrix(to, "K", model->written->n, model->written->system.K);
	json_poles(to, step);
	json_point(to, step);
	json_nonlinear(to, step);
	if (!is_nonlinear(step))
		json_linear(to, step);
	if (!step->shown->no.phi) {
		fputs("  ", to);
		json_matrix(to, "    ", "Phi", states, states, states, Phi);
		fputs(",\n", to);
	}
	json_loads(to, step);
	if (scheme_row(model->scheme)->holds_coupling)
		fprintf(to, "  \"growth_rate\": %.17g,\n", growth_rate(step));
	json_scheme(to, step);
	json_bounds(to, model);
	if (step->model->switching)
		json_regions(to, step);
	if (has_remainder(step))
		json_split(to, step);
	struct drift drift = drift_of(step);
	if (drift.known)
		fprintf(to, "  \"drift_per_step\": {\"amplitude\": %.17g, \"phase\": %.17g},\n", drift.amplitude,
			drift.phase);
	if (step->rounding.known)
		fprintf(to, "  \"rounding\": {\"steps\": %d, \"relative\": %.17g, \"state\": \"%s\"},\n",
			step->rounding.steps, step->rounding.relative, step->rounding.state);
	if (step->choice)
		json_needs(to, step);
	json_cost(to, step);
	fputs("}\n", to);
}
