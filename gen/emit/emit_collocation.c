/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps by collocation, as long as a tolerance lets them be, with outputs from their polynomials; beside them, where
 * the scheme switches, steps by the Taylor series.  How they go is in the runtime (radau.h, which the model's file
 * includes): here is what it is told of the model. */
#include "emit/emit.h"

#include <float.h>
#include <math.h>

static int stages(const struct emitter *e)
{
	return e->step->collocation->stages;
}

static bool changes(const struct emitter *e)
{
	return e->system->segments > 1;
}

static bool switches(const struct emitter *e)
{
	return e->step->expansion != NULL;
}

static double tolerance(const struct emitter *e)
{
	return round_rational(e->model->truncation.tolerance);
}

/* Rows of the polynomial; row 0 would be the state where the internal step starts */
static int rows(const struct emitter *e)
{
	return (switches(e) && e->model->truncation.order > stages(e) ? e->model->truncation.order : stages(e)) + 1;
}

/* ---- members ---- */

void emit_collocation_members(const struct emitter *e)
{
	say(e, "    double start[$N_STATES], poly[%d][$c];  /* of an internal step; its polynomial, from "
	       "time^1 on in "
	       "row 1 */\n"
	       "    double gain[$N_STATES];  /* over all of it */\n"
	       "    double at, at_low;  /* where it starts, in h since the step k - back */\n"
	       "    double size, per;     /* its length in h; 1 over the unit of the polynomial */\n"
	       "    double want;          /* the length that the next may have */\n"
	       "    double scale[$c], unit[$c];  /* the largest size of each state so far; 1 over it */\n"
	       "    int back;             /* steps of h since then */\n"
	       "    int stop, ready;      /* it ends at 1: a step of h, 2: a change of the loads%s; it may be "
	       "extrapolated */\n",
	    rows(e), is_divided(e) ? ", 3: a crossing" : "");
	if (changes(e))
		say(e, "    int leg;              /* the segment of time that it is in */\n");
	if (switches(e))
		say(e, "    int series, stiff;    /* the polynomial is a series; the next one is of the collocation "
		       "*/\n"
		       "    double product;       /* of the length that the last series had and how fast the motion "
		       "may be there */\n"
		       "    int bounds, patience, run;  /* series in a row that stability bounds; how many may be; "
		       "steps of the "
		       "collocation */\n");
	if (is_divided(e))
		emit_divided_members(e);
}

bool collocation_places(const struct emitter *e)
{
	(void)e;
	return true;
}

void emit_collocation_place(const struct emitter *e)
{
	emit_state_table(e);
	emit_floors(e);
	say(e, "\nstatic void $n_place($n *s);\n");
}

/* ---- what the collocation is told ---- */

/* 1/s: of the loads that what chooses formulas reads */
static double frequency_of_choices(const struct emitter *e)
{
	const struct expansion *d = e->step->divided;
	double highest = 0;
	for (int i = 0; d && i < d->expressions; i++) {
		const struct form *form = d->expression[i].form;
		const struct reads reads = reads_of(e->model, 1, &form);
		for (int l = 0; l < e->system->loads; l++)
			if (reads.load[l] && oscillates(e->system->load[l].wave))
				highest = fmax(highest, mpq_get_d(e->system->load[l].wave->w));
	}
	return highest;
}

/* [h], 0: as long as it will. The polynomial of what chooses formulas has half a radian of its loads for a node: where
 * no force shakes in a formula, no error does, and a step would go over what a load passes. */
static double longest_step(const struct emitter *e)
{
	double crowded = crowds(e) ? crowded_steps(e) : 0, frequency = frequency_of_choices(e);
	double chosen = frequency > 0 ? 0.5 * stages(e) / (frequency * mpq_get_d(e->model->h)) : 0;
	return crowded > 0 && chosen > 0 ? fmin(crowded, chosen) : fmax(crowded, chosen);
}

static void emit_limits(const struct emitter *e)
{
	const double solved = fmax(0.05 * tolerance(e), 4 * (e->model->asked.single ? FLT_EPSILON : DBL_EPSILON));
	say(e, "#define PL_TOLERANCE %s\n"
	       "#define PL_SOLVED %s  /* what Newton's method may leave */\n"
	       "#define PL_CROWDED %s  /* [h]: loads are followed so far; 0: as far as the error lets a step go */\n",
	    shortest(tolerance(e)), shortest(solved), shortest(longest_step(e)));
	/* of a step that says where things go its inside is looked at, where what is left out has lower powers */
	say(e, "#define PL_SHARE_OF_FIRST %s\n", is_divided(e) && !switches(e) ? "0.0625" : "1.0");
	if (traces(e))
		say(e, "#define PL_TRACE_READS %d  /* known numbers */\n"
		       "#define PL_RISE %d.0  /* what an exponent may gain from node to node */\n"
		       "#define PL_RISE_FACTOR %s\n",
		    trace_reads_known(e), 2 * stages(e), shortest(exp(2 * stages(e))));
}

/* Formulas that the state chooses, for passage.h */
static void emit_passage_limits(const struct emitter *e)
{
	say(e, "#define PL_CHANGES %d  /* of intervals, until all of them stand */\n"
	       "#define PL_MAX_EVENTS $N_MAX_EVENTS\n"
	       "#define PL_MAX_SPLITS %d\n"
	       "#define PL_WATCH_READS %d  /* known numbers */\n",
	    most_changes(e->step->divided), MAX_SPLITS, watch_reads_known(e));
}

static void emit_include(const struct emitter *e)
{
	const struct expansion *x = e->step->expansion, *d = e->step->divided;
	const struct size sizes[] = {
		{ "STATES", e->system->states }, { "COORDS", e->system->n }, { "STAGES", stages(e) },
		{ "MODES", splits(e) ? e->step->collocation->modes : 0 }, { "ENTRIES", e->step->motion->entries },
		{ "INPUTS", e->system->inputs }, { "KNOWN", known_values(e) }, { "SEGMENTS", e->system->segments },
		{ "COLUMNS", e->system->states + (x ? x->columns : 0) }, { "TRIES", e->model->truncation.substeps },
		{ "ORDER", x ? x->order : 0 }, { "EXPRESSIONS", d ? d->expressions : 0 },
		{ "ARGUMENTS", traces(e) ? e->step->unseen->unseens : 0 }, { "FLOORS", has_floors(e) }
	};
	emit_sizes(e, sizeof sizes / sizeof *sizes, sizes);
	say(e, "#define PL_KIND(i) (%s)\n", kind_text(e, "(i)"));
	emit_limits(e);
	if (is_divided(e))
		emit_passage_limits(e);
	if (switches(e))
		emit_switching_limits(e);
	say(e, "#include \"radau.h\"\n");
}

/* ---- the step ---- */

static const char *u_argument(const struct emitter *e)
{
	return e->system->inputs ? "u" : "NULL";
}

static void emit_step_function(const struct emitter *e)
{
	say(e, "\nvoid $n_step(%s)\n"
	       "{\n"
	       "    const int wrong = $n_collocated(s, %s);\n", step_parameters(e), u_argument(e));
	emit_step_end(e);
	say(e, "    $n_settle(s, wrong);\n"
	       "}\n");
}

void emit_collocation_step(const struct emitter *e)
{
	if (reads_channels(e->model))
		emit_leftover_functions(e);
	emit_stage_tables(e);
	emit_motion(e);
	emit_inputs_now(e);
	if (is_divided(e)) {
		emit_divided_tables(e);
		emit_passing_table(e, stages(e));
	}
	if (switches(e))
		emit_series_beside(e);
	emit_arguments(e);
	emit_include(e);
	emit_step_function(e);
	if (is_divided(e))
		emit_divided_questions(e);
}

/* ---- between steps ---- */

void emit_collocation_at(const struct emitter *e)
{
	bool relative = e->model->relative != NULL;
	const char *y = relative ? "x" : "y";
	say(e, "\nvoid $n_at(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n", driven_parameter(e));
	if (relative)
		say(e, "    double x[$N_STATES];\n");
	say(e, "    $n_between(s, %s, tau, %s);\n", u_argument(e), y);
	if (relative)
		say(e, "    $n_written(s, x, y);\n");
	say(e, "}\n");
}
