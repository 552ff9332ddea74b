/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was derived: for a person, and as JSON for a program. */
#include "model/checks.h"
#include "model/building.h"
#include "model/reads.h"
#include "report/report.h"
#include "step/collocation/collocation.h"
#include "step/series/expansion.h"
#include "step/linear/forms.h"
#include "step/linear/images.h"
#include "step/exponential/normal.h"
#include "step/tunable/tuned.h"
#include "step/cost.h"

#include <string.h>

static void text_matrix(FILE *to, const char *name, int n, const mpq_t *A)
{
	int width = 1;
	for (int i = 0; i < n * n; i++) {
		int length = (int)strlen(readable_text(A[i]));
		width = length > width ? length : width;
	}
	for (int i = 0; i < n; i++) {
		fprintf(to, "    %s [", i == 0 ? format("%s =", name) : "   ");
		for (int j = 0; j < n; j++)
			fprintf(to, " %*s", width, readable_text(A[i * n + j]));
		fputs(" ]\n", to);
	}
}

static void text_force(FILE *to, const char *what, int n, const mpq_t *force)
{
	if (rationals_zero((size_t)n, force))
		return;
	fprintf(to, "    %s on the equations: [", what);
	for (int i = 0; i < n; i++)
		fprintf(to, " %s", readable_text(force[i]));
	fputs(" ]\n", to);
}

static void text_loads(FILE *to, const struct linear *system)
{
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++)
			text_force(to, format("load %s", column_text(&system->load[l], k)), system->n,
				     system->load[l].force[k]);
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k < 2; k++)
			text_force(to, format("input %s%s", system->input[i].name, k ? "'" : ""), system->n,
				     system->input[i].force[k]);
}

static void text_poles(FILE *to, const struct model *model, const struct resolvent *resolvent)
{
	mpq_t *B;
	const int length = characteristic_of(model, resolvent, &B);
	fprintf(to, "\n    B(s) = %s\n\n", polynomial_text(length, B));
	struct pole_report *pole;
	int count = poles_of(model, resolvent, &pole);
	fprintf(to, "    %-36s %-16s damping ratio\n", "pole [1/s]", "frequency [Hz]");
	for (int i = 0; i < count; i++)
		fprintf(to, "    %s\n", pole_row(&pole[i]));
}

void text_linear_part(FILE *to, const struct step *step)
{
	if (is_nonlinear(step))
		fputs("\nOf the terms that are linear with constant coefficients:\n", to);
	text_poles(to, step->model, step->written);
}

static int tuned_entries(const struct tuning *t, int systems)
{
	int entries = t->all.entries;
	for (int k = 0; k < systems; k++)
		entries += t->system[k].entries;
	return entries;
}

static void text_tuning(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	const struct tuning *t = tunables_of(model);
	fputs("Tunable on the target:", to);
	for (int k = 0; k < t->given; k++)
		fprintf(to, "%s %s = %s", k ? "," : "", t->param[k].symbol->name, readable_text(t->nominal[k]));
	if (model->params.held && model->switching && !model->params.retuned)
		fputs("; they act like held inputs.\n", to);
	else if (model->params.held && !model->params.retuned)
		fputs("; expressions read them there. Operators, orders and choices are those of these values.\n", to);
	else
		fprintf(to, "; %s there have %d entries.\n",
			model->params.retuned ? "matrices and rows of regions that change with them" : "the equations",
			tuned_entries(t, step->branches));
	if (step->blocks && !step->blocks->solved)
		fprintf(to, "They touch %d of %d independent blocks; %s.\n", step->blocks->touched, step->blocks->all,
			step->blocks->full ? "another h does, too" : "the others have tables, of this h");
}

static void text_operations(FILE *to, const struct step *step)
{
	fprintf(to, "Step: form %s, h = %s s; %s.\n", step_form_text(step), readable_text(step->model->h),
		operations_text(step));
	if (step->no.refresh && step->program->forcing_multiplications)
		fprintf(to, "No refresh of the functions of the loads: %s.\n", step->no.refresh);
	text_peaks(to, step);
	if (step->model->relative)
		fprintf(to, "Rigid-body modes are kept apart from relative coordinates: the step keeps %s.\n",
			relative_text(step->model));
	text_rounding(to, step);
}

/* About 231 instructions a step on a Cortex-M4, 40 bytes of an instance */
static void text_board(FILE *to, const struct step *step)
{
	const struct board_cost *b = step->board;
	if (unbounded_text(step))
		fprintf(to, "There is no bound on the instructions of a step: %s.\n", unbounded_text(step));
	else
		fprintf(to, "Fitted bound on the instructions of a step by gcc -O2, no number subnormal: %s.\n",
			worst_text(step));
	if (!b || b->why)
		return;
	fprintf(to, "On a Cortex-M4, %s: about %s instructions a step, %s at most, by the operations of %d steps "
		    "from the initial values, inputs 0; an instance has %ld bytes.\n",
		step->model->request.single ? "whose FPU has float" : "double in software", two_digits(b->mean),
		two_digits(b->most), b->steps, b->bytes);
}

void text_cost(FILE *to, const struct step *step)
{
	text_operations(to, step);
	text_board(to, step);
	if (step->choice)
		text_needs(to, step);
}

static void text_step(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	const char *no_at = step_objection(step, CAN_AT);
	text_operations(to, step);
	text_board(to, step);
	if (step->shown->no.phi)
		fprintf(to, "There is no Phi: %s.\n", step->shown->no.phi);
	else
		fprintf(to, "Phi%s, each entry correctly rounded:\n",
			model->switching     ? " of region 0"
			: !has_remainder(step) ? ""
			: step->branches > 1 ? " = e^{A h} of the first operator"
					     : " = e^{A h}");
	for (int i = 0; i < model->system.states && !step->shown->no.phi; i++) {
		fprintf(to, "    %-8s", model->names.state[i]);
		for (int j = 0; j < model->system.states; j++)
			fprintf(to, " %24s",
				shortest(step->shown->branch->full->Phi[i * model->system.states + j].value));
		fputc('\n', to);
	}
	if (tunables_of(model))
		text_tuning(to, step);
	if (model->switching)
		fprintf(to, "%s_at: like a step, with every crossing on the way.\n", model->name);
	else if (no_at)
		fprintf(to, "There is no %s_at: %s.\n", model->name, no_at);
	else if (model->params.tuning)
		fprintf(to, "%s_at: e^{A tau} of the instance's own params, as %s_retune computes it.\n", model->name,
			model->name);
	else if (step->event_split)
		fprintf(to, "%s_at: a part of a step, with every crossing on the way.\n", model->name);
	else if (step->collocation)
		fprintf(to, "%s_at: the polynomial of the internal step, or of the next.\n", model->name);
	else if (step->taylor.expansion)
		fprintf(to, "%s_at: the series of the step, at a part of it.\n", model->name);
	else if (step->layout.powers == PARABOLA)
		fprintf(to, "%s_at: what is exact under a parabola through the remainder, of fourth order in h.\n",
			model->name);
	else if (step->normal)
		fprintf(to, "%s_at: the step's modes under the polynomial of its forces, by series of %d terms.\n",
			model->name, step->normal->within.terms);
	else
		fprintf(to, "%s_at: Taylor series of degree %d on %d part%s of the time.\n", model->name,
			step->series.degree, 1 << step->series.halvings, step->series.halvings ? "s" : "");
}

static void text_nodes(FILE *to, const struct collocation *x)
{
	fprintf(to, "The collocation is of order %d inside its steps, of which each takes two to four iterations; its "
		    "nodes are at\n   ", x->stages + 1);
	for (int i = 0; i < x->stages; i++)
		fprintf(to, "%s %.6g", i ? "," : "", x->node[i]);
	fputs(".\n", to);
}

/* The operators, then the remainder of the first; those of the others differ in linear terms only. */
static void text_split(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	for (int k = 0; k < model->schedule.operators && !step->normal; k++) {
		const struct operator *operator = &model->schedule.operator[k];
		if (!*operator->text)
			continue;
		fprintf(to,
			"A: the Jacobian of the equations at %s (of an entry that still moves there, the constant "
			"part):\n",
			operator->text);
		text_matrix(to, "C", model->n, operator->C);
		text_matrix(to, "K", model->n, operator->K);
		if (!scheme_row(model->scheme)->holds_coupling)
			text_poles(to, model, step->shown->branch[k].resolvent);
	}
	if (step->normal)
		text_frequencies(to, step);
	if (model->schedule.operators > 1)
		fputs("A step uses the first operator whose value is not below the current one, else the last.\n", to);
	fprintf(to, "Scheme %s is of order %d in h.\n", scheme_name(model->scheme), order_of_step(step));
	if (step->collocation)
		text_nodes(to, step->collocation);
	if (step->taylor.expansion)
		text_reach(to, step);
	fprintf(to, "r, left to scheme %s, is a force on each of these equations%s:\n", scheme_name(model->scheme),
		model->schedule.operators > 1 ? " (with the first operator; with the others its linear terms differ)"
					      : "");
	for (int c = 0; c < model->remainder.force_columns; c++)
		fprintf(to, "    %s: %s\n", model->names.coord[coordinate_of_row(model, model->remainder.row[c])],
			form_text(model, model->schedule.operator[0].left[c]));
}

/* A row over the written states, a - 2*b */
static const char *combination_text(const struct model *written, const mpq_t *row)
{
	const char *text = "";
	RATIONAL size = ZERO;
	for (int j = 0; j < written->system.states; j++) {
		int sign = mpq_sgn(row[j]);
		if (sign == 0)
			continue;
		mpq_abs(size, row[j]);
		text = format("%s%s%s%s", text, *text ? sign < 0 ? " - " : " + " : sign < 0 ? "-" : "",
			      mpq_cmp_ui(size, 1, 1) == 0 ? "" : format("%s*", readable_text(size)),
			      written->names.state[j]);
	}
	return text;
}

/* What went: states that no output sees, and with them the poles that cancel in every N/B. */
static void text_reduction(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	fprintf(to, "Reduced to what the outputs can see: %d of %d states.\n", model->system.states,
		model->written->system.states);
	for (int i = 0; i < model->system.states; i++) {
		const mpq_t *row = model->reduction.row;
		const char *text = row ? combination_text(model->written, row + i * model->written->system.states)
				       : model->names.state[i];
		bool same = strcmp(text, model->names.state[i]) == 0;
		fprintf(to, "    state %s%s%s\n", model->names.state[i], same ? "" : " = ", same ? "" : text);
	}
	fprintf(to, "Gone: %s%s.\n", name_list(model->reduction.dropped, model->reduction.dropped_name),
		model->reduction.dropped ? " (no output sees them, nor a combination of the states that are left)"
					 : "nothing");
	struct pole_report *pole;
	int count = poles_of(step->model, step->branch->resolvent, &pole);
	fputs("Poles that are left:\n", to);
	for (int i = 0; i < count; i++)
		fprintf(to, "    %s\n", pole_text(&pole[i]));
}

static void text_assembly(FILE *to, const struct spec *spec)
{
	if (spec->assembly.parts)
		fputs("\nParts:\n", to);
	for (int i = 0; i < spec->assembly.parts; i++)
		if (parts_text(spec, i))
			fprintf(to, "    %s\n", parts_text(spec, i));
}

static const struct form *written_residual(const struct model *model, int row)
{
	const struct equations *e = &model->equations;
	return e->full ? residual_as_written(e->full, e->owner, row) : e->residual[row].form;
}

void text_written(FILE *to, const struct step *step)
{
	const struct spec *spec = step->model->spec;
	const struct element *element = spec->element;
	for (int i = 0; i < spec->equations; i++)
		fprintf(to, "    %s\n",
			written_text(spec->equation[i].part, spec->equation[i].at, spec->equation[i].end));
	for (int i = 0; i < spec->elements; i++)
		if (element[i].kind != ELEMENT_ENERGY)
			fprintf(to, "    %s\n", written_text(element[i].part, element[i].at, element[i].end));
	for (int i = 0; i < spec->lagrange.energies; i++)
		if (energy_text(spec, i))
			fprintf(to, "    %s\n", energy_text(spec, i));
}

void text_equations(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	const struct spec *spec = model->spec;
	text_point(to, step);
	text_written(to, step);
	for (int i = 0; i < spec->page.drawings; i++)
		fprintf(to, "    %s\n",
			written_text(spec->page.drawing[i].part, spec->page.drawing[i].at, spec->page.drawing[i].end));
	text_assembly(to, spec);
	if (spec->elements) {
		fputs("\nEquations of the sketch:\n\n", to);
		for (int i = 0; i < model->written->n; i++)
			fprintf(to, "    %s\n", equation_text(model->written, written_residual(model, i)));
	}
	text_symmetries(to, model->written);
}

void text_course(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	text_scheme(to, step);
	if (model->switching)
		text_region_list(to, step);
	else if (has_remainder(step))
		text_split(to, step);
	if (model->reduction.truncated)
		text_modal_truncation(to, model);
	else if (model->written != model)
		text_reduction(to, step);
	if (model->reduction.irreducible)
		fputs("Nothing to reduce: every state is seen by an output.\n", to);
}

/* In the place of poles; those of A are of the scheme */
static void text_left_out(FILE *to, const struct step *step)
{
	fputc('\n', to);
	text_nonlinear(to, step);
	if (!has_remainder(step) || step->normal || step->shown->model->schedule.operators == 0 ||
	    *step->shown->model->schedule.operator[0].text)
		return;
	fputs("\nOf those terms alone, which are the operator A of the scheme:\n", to);
	text_poles(to, step->model, step->written);
}

void explain_text(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	fprintf(to, "Model %s: %d coordinate%s, %d states, scheme %s\n\n", model->name, model->written->n,
		model->written->n == 1 ? "" : "s", model->written->system.states, scheme_name(model->scheme));
	text_equations(to, step);
	if (units_text(step))
		fprintf(to, "\n%s\n", units_text(step));
	fprintf(to, "\n%sP(s) = M s^2 + C s + K with\n",
		is_nonlinear(step) ? "Of the terms that are linear with constant coefficients:\n" : "");
	text_matrix(to, "M", model->written->n, model->written->system.M);
	text_matrix(to, "C", model->written->n, model->written->system.C);
	text_matrix(to, "K", model->written->n, model->written->system.K);
	text_loads(to, &model->written->system);
	if (model->reduction.truncated)
		fputs("\nOf the modes that are kept:\n", to);
	if (is_nonlinear(step))
		text_left_out(to, step);
	else
		text_poles(to, step->model, step->written);
	const char *irrationals = irrationals_text(&model->equations.irrationals);
	if (irrationals)
		fprintf(to, "\n%s\n", irrationals);
	fputc('\n', to);
	text_course(to, step);
	text_step(to, step);
	if (step->choice)
		text_needs(to, step);
	if (!is_nonlinear(step))
		text_linear(to, step);
}
