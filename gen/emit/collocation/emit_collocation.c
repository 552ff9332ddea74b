/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps by collocation, as long as a tolerance lets them be, with outputs from their polynomials; beside them, where
 * the scheme switches, steps by the Taylor series.  How they go is in the runtime (radau.h, which the model's file
 * includes): here is what it is given of the model. */
#include "emit/series/series.h"
#include "emit/steps.h"
#include "model/reads.h"
#include "step/collocation/collocation.h"
#include "step/contacts/series_contacts.h"
#include "step/series/expansion.h"
#include "step/regions/guards.h"

#include <float.h>
#include <math.h>
#include <string.h>

static int stages(const struct emitter *e)
{
	return e->step->collocation->stages;
}

static bool switches(const struct emitter *e)
{
	return e->step->taylor.expansion != NULL;
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
	say(e, "    double start[$N_STATES], poly[%d][$c];  /* start of an internal step; its polynomial in "
	       "time, row k of time^k */\n"
	       "    double gain[$N_STATES];  /* change of the state over the internal step */\n"
	       "    double at, at_low;  /* its start, in h after the step k - back */\n"
	       "    double size, per;     /* its length in h; the polynomial's time is per (t - start)/h */\n"
	       "    double want;          /* proposed length of the next, in h */\n"
	       "    double scale[$c], unit[$c];  /* largest size of each state so far; its reciprocal */\n"
	       "    int back;             /* steps of h since then */\n"
	       "    int stop, ready;      /* where it ends, 1: a step of h, 2: a change of the loads%s; its polynomial "
	       "may be extrapolated */\n",
	    rows(e), has_switching(e) ? ", 3: a crossing" : "");
	if (e->model->spec->joined.held)
		say(e, "    uint64_t until;       /* an internal step ends with this step of h */\n");
	if (loads_change(e->system))
		say(e, "    int leg;              /* the segment of time that it is in */\n");
	if (switches(e))
		say(e, "    int series, stiff;    /* the polynomial is a series; the next one is of the collocation "
		       "*/\n"
		       "    double product;       /* of the length that the last series had and how fast the motion "
		       "may be there */\n"
		       "    int bounds, patience, run;  /* series in a row that stability bounds; how many may be; "
		       "steps of the "
		       "collocation */\n");
	if (has_switching(e))
		emit_switching_members(e);
}

void emit_collocation_place(const struct emitter *e)
{
	emit_state_table(e);
	emit_floors(e);
	say(e, "\nstatic void $n_place($n *s);  /* what follows from a state that was set */\n");
}

/* ---- what the collocation is given ---- */

/* 1/s: of the loads that what chooses formulas reads, or what lets a contact go: at rest no error speaks of them */
static double frequency_of_choices(const struct emitter *e)
{
	const struct reads reads = reads_of_choices(e);
	double highest = 0;
	for (int l = 0; l < e->system->loads; l++)
		if (reads.load[l] && oscillates(e->system->load[l].forcing))
			highest = fmax(highest, mpq_get_d(e->system->load[l].forcing->w));
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
	const double solved = fmax(0.05 * tolerance(e), 4 * (e->model->request.single ? FLT_EPSILON : DBL_EPSILON));
	say(e, "#define PL_TOLERANCE %s\n"
	       "#define PL_SOLVED %s  /* what Newton's method may leave */\n"
	       "#define PL_CROWDED %s  /* [h]: loads are followed so far; 0: as far as the error lets a step go */\n",
	    shortest(tolerance(e)), shortest(solved), shortest(longest_step(e)));
	/* of a step that says where things go its inside is looked at, where what is left out has lower powers */
	say(e, "#define PL_SHARE_OF_FIRST %s\n", has_switching(e) && !switches(e) ? "0.0625" : "1.0");
	if (traces(e))
		say(e, "#define PL_TRACE_READS %d  /* known numbers */\n"
		       "#define PL_RISE %d.0  /* what an exponent may gain from node to node */\n"
		       "#define PL_RISE_FACTOR %s\n",
		    trace_reads_known(e), 2 * stages(e), shortest(exp(2 * stages(e))));
}

/* ---- tables: nodes, the integrals up to them, the modes of these, the places in the Jacobian ---- */

static void emit_entry_table(const struct emitter *e)
{
	const struct motion *m = e->step->collocation->motion;
	int *row = ARRAY(int, 3 * (size_t)m->entries + 3), rows = m->entries ? m->entries : 1;
	for (int k = 0; k < m->entries; k++) {
		row[3 * k] = m->entry[k].coord;
		row[3 * k + 1] = m->entry[k].of;
		row[3 * k + 2] = m->entry[k].twice;
	}
	say(e, "\n/* Entries of the Jacobian: row, coordinate; 1: derivative by the coordinate, 0: by its derivative\n"
	       " * that is one below the highest */\n");
	emit_integer_rows(e, "short", format("entry[%d][3]", rows), rows, 3, row);
}

static void emit_mode_tables(const struct emitter *e)
{
	const struct collocation *x = e->step->collocation;
	const size_t row = 2 * (size_t)x->stages;
	double *mode = ARRAY(double, 2 * (size_t)x->modes), *left = ARRAY(double, (size_t)x->modes * row);
	double *right = ARRAY(double, (size_t)x->modes * row);
	for (int k = 0; k < x->modes; k++) {
		mode[2 * k] = x->mode[k].re;
		mode[2 * k + 1] = x->mode[k].im;
		memcpy(left + (size_t)k * row, x->mode[k].left, row * sizeof *left);
		memcpy(right + (size_t)k * row, x->mode[k].right, row * sizeof *right);
	}
	const int sizes[] = { x->modes, x->stages, 2 };
	emit_array(e, "Modes of the integrals: A v = z v, u A = z u; real and imaginary parts; the first is real",
		   "mode", 2, (const int[]){ x->modes, 2 }, mode, NULL);
	emit_array(e, "u, with u v = 1", "to_mode", 3, sizes, left, NULL);
	emit_array(e, "v, of a pair twice, since its conjugate adds the same", "from_mode", 3, sizes, right, NULL);
}

static void emit_stage_tables(const struct emitter *e)
{
	const struct collocation *x = e->step->collocation;
	const int sizes[] = { x->stages, x->stages };
	emit_array(e, "Collocation nodes, as fractions of a step", "node", 1, sizes, x->node, NULL);
	emit_array(e, "Integrals from 0 to each node of the Lagrange polynomials of the nodes", "once", 2, sizes,
		   x->once, NULL);
	emit_array(e, "The same, integrated twice", "twice", 2, sizes, x->twice, NULL);
	emit_array(e, "Coefficients of the Lagrange polynomials, from the constant on", "monomial", 2, sizes,
		   x->monomial, NULL);
	emit_entry_table(e);
	if (splits(e))
		emit_mode_tables(e);
}

/* ---- where the series is bounded by stability ---- */

/* -J_ii + sum over j of |J_ij| of one kind of the entries of row i; NULL: it has none */
static const char *row_bound(const struct emitter *e, int coord, bool twice)
{
	const struct motion *m = e->step->collocation->motion;
	struct summands s = { 0 };
	for (int k = 0; k < m->entries; k++)
		if (m->entry[k].coord == coord && m->entry[k].twice == twice)
			add_summand(&s, format(!twice && m->entry[k].of == coord ? "-slope_of[%d]"
					       : "pl_magnitude(slope_of[%d])", k));
	return s.terms ? sum_of(&s, 12) : NULL;
}

/* Of Gershgorin's circles how far they reach to the left; of the derivatives by coordinates, which are squared rates,
 * their size */
static void emit_bound_rates(const struct emitter *e)
{
	int n = e->system->n;
	say(e, "\n/* Bounds on how fast the motion may decay [1/s], and on the square of how fast it may turn: "
	       "Gershgorin's */\n"
	       "static void $n_bound_rates(const double slope_of[], double rates[2])\n"
	       "{\n"
	       "    double size;\n");
	for (int i = 0; i < 2 * n; i++) {
		const char *bound = row_bound(e, i / 2, i % 2);
		if (bound)
			say(e, "    size = %s;\n"
			       "    rates[%d] = size > rates[%d] ? size : rates[%d];\n", bound, i % 2, i % 2, i % 2);
	}
	say(e, "    (void)size;\n"
	       "    (void)slope_of;\n"
	       "    (void)rates;\n"
	       "}\n");
}

/* ---- what it is given ---- */

static void emit_series_beside(const struct emitter *e)
{
	if (!meets_contacts(e))
		emit_series_functions(e);
	emit_series_ahead(e);
	emit_hidden_table(e);
	emit_bound_rates(e);
}

/* ---- which is next ---- */

/* How many series a step of the collocation is worth, by what they cost; some less, so that they do not take turns */
static double worth(const struct emitter *e)
{
	const struct collocation *x = e->step->collocation;
	double iterations = 2.2 + splits(e) * 3, series = e->step->program->multiplications;
	double step = iterations * e->step->collocation->iteration.multiplications +
		      4.0 * x->stages * x->stages * e->system->n;
	double ratio = floor(step / series * 12) / 16;
	return ratio < 1 ? 1 : ratio > 8 ? 8 : ratio;
}

static void emit_switching_limits(const struct emitter *e)
{
	say(e, "#define PL_MEASURED %d  /* columns behind the states whose last terms count too */\n"
	       "#define PL_WORTH %s  /* so many series a step of the collocation costs */\n"
	       "#define PL_CHOICES %d\n"
	       "#define PL_UNRESOLVED %d\n"
	       "#define PL_SLOPES %d\n", e->step->taylor.expansion->measured, shortest(worth(e)), has_choices(e),
	    has_unresolved(e), e->step->taylor.slopes != NULL);
	if (has_unresolved(e))
		emit_unresolved_sizes(e);
}

/* Formulas that the state chooses, for passage.h */
static void emit_passage_limits(const struct emitter *e)
{
	emit_switching_macros(e);
	say_macro(e, "MAX_SPLITS", integer_text(max_splits(e->model)));
	say_macro(e, "WATCH_READS", integer_text(watch_reads_known(e)));
	if (!meets_contacts(e))
		return;
	say_macro(e, "EVENT_ORDER", integer_text(e->step->taylor.switching->order));
	say_macro(e, "EVENT_COLUMNS", integer_text(e->system->states + e->step->taylor.switching->columns));
	if (!switches(e))
		say_macro(e, "CHOICES", integer_text(has_choices(by_series(e, e->step->taylor.switching))));
}

/* Whether models of derivatives begin their steps where it stands */
static bool is_followed(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	return d && d->blocks > 0 && d->block[0].step->model->spec->joined.held;
}

static void emit_include(const struct emitter *e)
{
	const struct expansion *x = e->step->taylor.expansion, *d = e->step->taylor.switching;
	emit_sizes(e, "radau.h", { "STATES", e->system->states }, { "COORDS", e->system->n },
		   { "BLOCK", e->step->collocation->motion->solved }, { "STAGES", stages(e) },
		   { "MODES", splits(e) ? e->step->collocation->modes : 0 },
		   { "ENTRIES", e->step->collocation->motion->entries },
		   { "DIFFERENCES", e->step->collocation->motion->differences }, { "INPUTS", e->system->inputs },
		   { "KNOWN", known_values(e) }, { "SEGMENTS", e->system->segments },
		   { "COLUMNS", e->system->states + (x ? x->columns : 0) }, { "TRIES", e->model->truncation.substeps },
		   { "ORDER", x ? x->order : 0 }, { "SWITCHING_FUNCTIONS", d ? d->functions : 0 },
		   { "CONTACTS", meets_contacts(e) }, { "TERMS", d ? terms_of_events(e) : 0 },
		   { "WAYS", d ? d->functions + (meets_contacts(e) ? d->contacts->ways : 0) : 0 },
		   { "ARGUMENTS", traces(e) ? e->step->taylor.unresolved->unresolved_functions : 0 },
		   { "FLOORS", has_floors(e) }, { "CONSTRAINTS", e->model->equations.correction != NULL },
		   { "MASSES", moving_masses(e) }, { "ALIGNED", e->model->spec->joined.held },
		   { "FOLLOWED", is_followed(e) });
	emit_moved_columns(e);
	emit_counts_macro(e);
	say(e, "#define PL_KIND(i) (%s)\n", kind_text(e, "(i)"));
	emit_limits(e);
	if (has_switching(e))
		emit_passage_limits(e);
	if (switches(e))
		emit_switching_limits(e);
	say(e, "#include \"radau.h\"\n");
}

/* ---- the step ---- */

static void emit_step_function(const struct emitter *e)
{
	open_function(e, NULL, "%s", head_of_step(e));
	say(e, "    const int wrong = $n_collocated(s, %s);\n", e->system->inputs ? "u" : "NULL");
	emit_step_end(e);
	say(e, "    $n_settle(s, wrong);\n"
	       "}\n");
}

void emit_collocation_step(const struct emitter *e)
{
	emit_stage_tables(e);
	if (meets_contacts(e))
		emit_series_functions(by_series(e, e->step->taylor.switching));
	emit_motion(e);
	emit_inputs_now(e);
	if (has_switching(e)) {
		emit_switching_tables(meets_contacts(e) ? by_series(e, e->step->taylor.switching) : e);
		emit_passing_table(e, stages(e) + meets_contacts(e));
	}
	if (meets_contacts(e)) {
		emit_event_tables(e);
		emit_events_along(e);
	}
	if (switches(e))
		emit_series_beside(e);
	emit_arguments(e);
	if (e->model->spec->joined.held)
		emit_counting(e);
	emit_constraints(e);
	emit_include(e);
	emit_step_function(e);
}

void emit_collocation_at(const struct emitter *e)
{
	emit_at_by(e, "between");
}
