/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a step does: what of the model is exact, what is approximated, and how far that may be off. A line is a
 * sentence, or indented one of a list: the comment at the top of the C has them, and --explain. */
#include "report/report.h"
#include "step/collocation/collocation.h"
#include "step/linear/forms.h"
#include "step/linear/rows.h"
#include "step/series/expansion.h"
#include "step/series/switching.h"

/* Which modes are kept, and what is lost at most */
static void text_kept_modes(FILE *to, const struct model *model)
{
	const char *lost = "";
	for (int i = 0; i < model->outputs; i++)
		lost = format("%s%s%s", lost, i ? ", " : "", truncation_text(model, i));
	fprintf(to, "Modes %s of %d are kept; %s. From the start and under the loads%s outputs lose at most %s (sums "
		    "of |residues|, for all time).\n",
		mode_numbers(model->reduction.truncated, true), modes_of_model(model->reduction.truncated),
		static_correction_text(model), model->system.inputs ? ", inputs 0," : "", lost);
}

static void text_of_linear(FILE *to, const struct model *model)
{
	if (!scheme_row(model->scheme)->holds_coupling)
		fprintf(to, "%s is approximated; each constant is its closed form, correctly rounded.\n",
			model->reduction.truncated                ? "Scheme exact: modes are dropped, nothing else"
			: model->scheme == SCHEME_EXACT ? "Scheme exact: nothing"
							: "There is no remainder: nothing");
	if (model->reduction.truncated)
		text_kept_modes(to, model);
	if (model->equations.misses)
		fprintf(to, "Constraints hold as exactly: what a state misses of them decays with poles at -%d/h, "
			"which stand in P(s) and not in B(s).\n",
			DECAY_OF_MISSES);
}

static const char *operator_text(const struct model *model)
{
	if (*model->schedule.operator[0].text)
		return format("equations' Jacobian at %s", model->schedule.operator[0].text);
	bool own = scheme_row(model->scheme)->holds_coupling;
	return own ? "own terms of each coordinate" : "linear terms with constant coefficients";
}

static void text_of_remainder(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	fprintf(to, "y' = A y + loads + inputs + r(t, y). A: the %s%s.\n", operator_text(model),
		step->branches > 1 ? format(", and so on: %d operators", step->branches) : "");
	fprintf(to, "Exact: A%s, each constant correctly rounded; approximated: r, a force on %d equation%s.\n",
		model->remainder.loads ? " and the inputs" : ", the loads and the inputs",
		model->remainder.force_columns, model->remainder.force_columns == 1 ? "" : "s");
}

/* Where errors are measured otherwise than by the largest size of a state */
static void text_floors(FILE *to, const struct model *model)
{
	const mpq_t *absolute = model->truncation.absolute;
	const char *list = "";
	for (int i = 0; i < model->system.states && absolute; i++)
		if (mpq_sgn(absolute[i]) != 0)
			list = format("%s%s%s %s", list, *list ? ", " : "", model->names.state[i],
				      readable_text(absolute[i]));
	if (*list)
		fprintf(to, "Beside the tolerance of their size now states may be off by an absolute one: %s.\n", list);
}

static void text_of_series(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	const struct truncation *t = &model->truncation;
	const char *tolerance = shortest(round_rational(t->tolerance));
	const bool events = step->taylor.switching || step->taylor.expansion->contacts;
	const char *every = events ? "Every step without an event" : "Every step";
	if (t->adaptive)
		fprintf(to, "A series reaches as far as its last two terms are below %s of the largest value of each "
			    "state so far: %s, or a part of h, of which there are %d at most.\n", tolerance,
			model->system.inputs ? "h" : "several h, whose states the one series gives", t->substeps);
	else if (mpq_sgn(t->tolerance) != 0)
		fprintf(to, "%s does the same work; where the last two terms are above %s of the "
			    "largest value of a state so far, %s_status says PL_INACCURATE.\n", every, tolerance,
			model->name);
	else
		fprintf(to, "%s does the same work, and nothing estimates its error.\n", every);
	text_floors(to, model);
	if (t->over > 1)
		fprintf(to, "One expansion is over %d steps, with the error of one of %d h; those before the last are "
			    "values of its series. Costs are a step's share.\n", t->over, t->over);
}

/* What is solved at which nodes, how long an internal step is */
static void text_of_collocation(FILE *to, const struct step *step)
{
	const struct truncation *t = &step->model->truncation;
	const struct collocation *x = step->collocation;
	const bool apart = x->motion->apart;
	fprintf(to, "%s%d stages, of order %d; an internal step is as long as its error is below %s of the largest "
		    "value of each state so far: several h, whose states its polynomial gives, or a part of h, of "
		    "which %d are tried at most.\n", step->taylor.expansion ? "The collocation: " : "", t->stages,
		2 * t->stages - 1, readable_text(t->tolerance), t->substeps);
	text_floors(to, step->model);
	fprintf(to, apart ? "Newton's method with the Jacobian of its start, by the modes of its stages: one real and "
			    "%d complex systems of %d.\n"
			  : "Newton's method with the Jacobian at each node: %d stages by %d unknowns.\n",
		apart ? (t->stages - 1) / 2 : t->stages, x->motion->coords);
	if (step->taylor.expansion)
		fprintf(to, "One iteration of it: %d multiplications, %d additions, %d calls.\n",
			x->iteration.multiplications, x->iteration.additions, x->iteration.calls);
}

/* Between two crossings the method, at them parts of a step */
static void text_of_event_split(FILE *to, const struct step *step)
{
	const struct event_split *x = step->event_split;
	fprintf(to, "Parts of such a step%s go by scheme etdrk4, with e^{A tau} made by the target: some %d KB of "
		    "stack. The look takes %d multiplications and %d additions beside the costs below.\n",
		x->certain < 1 ? ", so short that no pole turns by more than 1," : "", x->kilobytes, x->multiplications,
		x->additions);
}

/* What scheme pl holds, and what that does */
static void text_held(FILE *to, const struct step *step)
{
	const struct linear *system = &step->branch->system;
	int n = system->n;
	fputs("Scheme pl holds these accelerations at their value at the start of each step:\n", to);
	for (int i = 0; i < n; i++)
		for (int k = 0; k < 2; k++)
			for (int j = 0; j < n; j++) {
				RATIONAL factor = ZERO;
				mpq_neg(factor, (k ? system->heldC : system->heldK)[i * n + j]);
				if (mpq_sgn(factor) != 0)
					fprintf(to, "    in %s'': %s * %s%s\n", step->model->names.coord[i],
						readable_text(factor), step->model->names.coord[j], k ? "'" : "");
			}
	fprintf(to,
		"It is of first order in h. Its modified equation y' = L y - (h/2) R L y (R: the held terms) has "
		"growth rate\n"
		"%.6g 1/s, the largest real part of its poles, at h = %s s.\n",
		growth_rate(step), readable_text(step->model->h));
}

void text_scheme(FILE *to, const struct step *step)
{
	const struct model *model = step->model;
	if (model->scheme != SCHEME_EXACT)
		fprintf(to, "%s\n", scheme_note(model->scheme, order_of_step(step)));
	if (loses_order(step->shown->model))
		fprintf(to, "So where all is smooth; here of order %s at most: %s.\n", order_text(step->shown->model),
			smoothness_text(step->shown->model));
	switch (step->is.flow) {
	case FLOW_LINEAR:      (model->switching ? text_regions(to, step) : text_of_linear(to, model)); break;
	case FLOW_RECIPE:      text_of_remainder(to, step); break;
	case FLOW_SERIES:      text_of_series(to, step); break;
	case FLOW_COLLOCATION: text_of_collocation(to, step); break;
	case FLOW_NORMAL:      text_normal(to, step); break;
	}
	if (scheme_row(model->scheme)->holds_coupling)
		text_held(to, step);
	if (step->taylor.switching)
		text_series_switching(to, step);
	if (step->event_split)
		text_of_event_split(to, step);
	if (step->is.flow == FLOW_SERIES || step->is.flow == FLOW_COLLOCATION)
		fputs("The state is double-double: its low parts, which hold the rounding errors, are in low.\n", to);
}

const char *operations_text(const struct step *step)
{
	const struct program *p = step->program;
	const char *text = format("%d multiplications, %d additions", p->multiplications, p->additions);
	if (step->refresh)
		text = format("%s; every %d steps, for the functions of the loads, %d and %d more", text,
			      step->refresh->steps, p->forcing_multiplications, p->forcing_additions);
	else if (p->forcing_multiplications)
		text = format("%s (%d and %d of them for loads)", text,
			      p->forcing_multiplications, p->forcing_additions);
	return p->calls ? format("%s, %d calls of the model's own functions", text, p->calls) : text;
}

void text_peaks(FILE *to, const struct step *step)
{
	if (peaks_by_values(step))
		fputs("Peaks are looked for by values inside a step where the last three ends do not show that none is "
		      "passed.\n", to);
	else if (peak_outputs(step->model) > 0)
		fprintf(to, "The look for peaks takes %d and %d more, the outputs counted, where a bound shows that "
			    "none passes its peak.\n", step->program->peak_multiplications,
			step->program->peak_additions);
}

void text_rounding(FILE *to, const struct step *step)
{
	const struct drift drift = drift_of(step);
	if (drift.known)
		fprintf(to, "%s.\n", drift_text(&drift, step->model->h));
	if (step->rounding.known)
		fprintf(to, "%s.\n", rounding_text(step));
}
