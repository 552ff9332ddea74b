/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps by the Taylor series of the solution: its sums as straight lines, and what the runtime's taylor.h, which the
 * model's file includes, is given of it. */
#include "inner.h"
#include "emit/steps.h"
#include "step/series/expansion.h"
#include "step/regions/guards.h"

/* Of fixed order, the coefficients locals of the step */
static bool is_straight(const struct emitter *e)
{
	return !truncation_of(e)->adaptive && !spans_steps(e) && !watches(e) && expands_in_step(e) &&
	       !e->model->equations.correction && !holds_energy(e);
}

/* ---- its sum ---- */

/* g0, g1, ...: c[1] + theta (c[2] + ...) of each state, by Horner's rule */
static void emit_horner(const struct emitter *e, const char *c, int degree)
{
	int states = e->system->states;
	for (int i = 0; i < states; i++)
		say(e, "    double g%d = %s[%d][%d];\n", i, c, degree, i);
	for (int k = degree - 1; k > 0; k--)
		for (int i = 0; i < states; i++)
			say(e, "%sg%d = g%d * theta + %s[%d][%d];%s", i % 4 ? " " : "    ", i, i, c, k, i,
			    i % 4 == 3 || i == states - 1 ? "\n" : "");
}

void emit_series_ahead(const struct emitter *e)
{
	const char *unit = spans_steps(e) ? format("%d ", truncation_of(e)->over) : "";
	open_function(e, format("Change of the state from the start of the series to theta %sh later", unit),
		      "static void $n_ahead(const double c[%d][$c], double theta, double gain[$N_STATES])",
		      own_expansion(e)->order + 1);
	if (is_written_out(e, own_expansion(e)->order)) {
		emit_horner(e, "c", own_expansion(e)->order);
		for (int i = 0; i < e->system->states; i++)
			say(e, "    gain[%d] = g%d * theta;\n", i, i);
	} else {                        /* beside a collocation: taylor.h has it */
		say(e, "    int i, k;\n"
		       "    for (i = 0; i < $N_STATES; i++) {\n"
		       "        gain[i] = c[%d][i];\n"
		       "        for (k = %d; k > 0; k--) { gain[i] = gain[i] * theta + c[k][i]; }\n"
		       "        gain[i] *= theta;\n"
		       "    }\n", own_expansion(e)->order, own_expansion(e)->order - 1);
	}
	close_function(e, "");
}

/* ---- the step ---- */

bool expansion_places(const struct emitter *e)
{
	return looks_at_tolerance(e) || spans_steps(e) || has_switching(e);
}

void emit_expansion_place(const struct emitter *e)
{
	if (!expansion_places(e))
		return;
	emit_floors(e);
	if (shares_kinds(e))
		emit_state_table(e);
	say(e, "\nstatic void $n_place($n *s);  /* what follows from a state that was set */\n");
}

/* What is not finite is not kept: the state stays as it was. */
static void emit_keep(const struct emitter *e)
{
	say_wrapped(e, format("if (%s) {  /* one of them is not finite */\n", is_not_finite(e)));
	say(e, moving_masses(e) ? "        s->status |= $n_cause(s, 0, y, PL_NOT_FINITE);\n"
				: "        s->status |= PL_NOT_FINITE;\n");
	say(e, "    } else {\n");
	for (int i = 0; i < e->system->states; i++)
		say(e, "        s->y[%d] = next%d;\n"
		       "        s->low[%d] = low%d;\n", i, i, i, i);
	say(e, "    }\n");
}

/* Of fixed order, all coefficients as locals: one path but for what is kept */
static void emit_straight_step(const struct emitter *e)
{
	open_function(e, NULL, "%s", head_of_step(e));
	say(e, "    const double *const y = s->y;\n");
	emit_coefficients(e);
	for (int i = 0; i < e->system->states; i++)
		say(e, "    double low%d = s->low[%d];\n", i, i);
	emit_series_ends(e);
	emit_keep(e);
	emit_step_end(e);
	close_function(e, "");
}

/* ---- sums of a series that is an array ---- */

/* The k-th coefficient of a state; NULL: it is 0 */
static const char *term_of_series(const struct emitter *e, int state, int k)
{
	return coefficient(e, state, k) ? format("c[%d][%d]", k, state) : NULL;
}

static void emit_ends(const struct emitter *e, const char *accumulate, const char *none)
{
	for (int i = 0; i < e->system->states; i++)
		say_wrapped(e, format("end[%d] = %s(y[%d], %s, &low[%d]);\n", i, accumulate, i,
				      full_gain(e, i, term_of_series, none), i));
	close_function(e, "");
}

/* Of fixed order: all of it */
static void emit_total(const struct emitter *e)
{
	open_function(e, "The end of the series that begins at y: high and low parts",
		      "static inline void $n_total(const double c[%d][$c], const double y[$N_STATES], "
		      "double end[$N_STATES], double low[$N_STATES])", own_expansion(e)->order + 1);
	emit_ends(e, "pl_accumulate", "0.0");
}

void emit_lanes_total(const struct emitter *e)
{
	open_function(e, "Where it ends: high and low parts",
		      "PL_LANES_INLINE void $n_lanes_total(pl_lanes (*c)[$N_STATES], const pl_lanes *y, pl_lanes *end, "
		      "pl_lanes *low)");
	emit_ends(e, "pl_lanes_accumulate", "pl_lanes_all(0.0)");
}

/* m^2 to m^order, each from two before it: then no more than a product and sums wait for the last coefficient */
static void emit_powers(const struct emitter *e, int order)
{
	for (int k = 2; k <= order; k++)
		say(e, "%sm%d = m%s * m%s%s", k == 2 ? "    const double " : (k - 2) % 6 ? ", " : ",\n        ", k,
		    k < 4 ? "" : format("%d", k / 2), k - k / 2 < 2 ? "" : format("%d", k - k / 2),
		    k == order ? ";\n" : "");
}

static const char *term_of_end(int state, int k)
{
	return format("c[%d][%d] * m%s", k, state, k == 1 ? "" : format("%d", k));
}

static void emit_end(const struct emitter *e)
{
	enum { LATE = 2 };              /* of at least 4 */
	int order = own_expansion(e)->order, states = e->system->states;
	open_function(e, "The state m steps after the start of the series: high and low parts",
		      "static void $n_end(const double c[%d][$c], double m, double end[$N_STATES], "
		      "double low[$N_STATES])", order + 1);
	emit_powers(e, order);
	for (int i = 0; i < states; i++) {
		const char *text = "", *late = "";
		for (int k = order; k > order - LATE; k--)
			late = plus(late, term_of_end(i, k));
		for (int k = order - LATE; k > 1; k--)
			text = plus(text, term_of_end(i, k));
		say_wrapped(e, format("end[%d] = pl_accumulate(c[0][%d], %s, %s + %s, &low[%d]);\n", i, i,
				      term_of_end(i, 1), text, late, i));
	}
	close_function(e, "");
}

bool serves_rows(const struct emitter *e)
{
	return own_expansion(e) && !e->step->collocation && truncation_of(e)->adaptive && !e->system->inputs;
}

/* The k-th coefficient as the instance has it; NULL: it is 0 */
static const char *kept_term(const struct emitter *e, int state, int k)
{
	return coefficient(e, state, k) ? format("s->series[%d][%d]", k, state) : NULL;
}

/* The same where the instance has the series: the steps before its end */
static void emit_within(const struct emitter *e)
{
	open_function(e, "The state theta after the start of the series",
		      "static inline void $n_within($n *s, double theta)");
	emit_value(e, "theta", kept_term, truncation_of(e)->adaptive ? "s->base[%d]" : "s->low[%d]", "    ");
	close_function(e, "");
}

static void emit_sums(const struct emitter *e)
{
	bool adaptive = truncation_of(e)->adaptive, several = serves_rows(e) || spans_steps(e);
	if (is_written_out(e, own_expansion(e)->order)) {
		emit_series_ahead(e);
		if (adaptive)
			emit_end(e);
		if (several)
			emit_within(e);
	}
	if (!adaptive && !is_straight(e) && !has_offset(e))
		emit_total(e);
}

void emit_expansion_members(const struct emitter *e)
{
	if (truncation_of(e)->adaptive)
		say(e, "    double series[%d][$c];  /* the last expansion: coefficients in powers of t / h */\n"
		       "    double base[$N_STATES];  /* low parts of the state at its start */\n"
		       "    double next[$N_STATES], left[$N_STATES];  /* the state at its end, in two parts */\n"
		       "    int served, valid;    /* steps since its start; steps that it covers */\n"
		       "    int most;             /* steps that the next one may cover; 0: unknown */\n",
		    own_expansion(e)->order + 1);
	if (spans_steps(e))
		emit_over_members(e);
	if (looks_at_tolerance(e))
		say(e, "    double scale[$c], unit[$c];  "
		       "/* largest size of each state so far; its reciprocal */\n");
	if (has_switching(e))
		emit_switching_members(e);
}

/* ---- what taylor.h is given ---- */

void emit_pass_time(const struct emitter *e)
{
	open_function(e, "Advances time, loads and inputs by a step",
		      "static inline void $n_pass_time($n *s, const double u[])");
	emit_step_end(e);
	close_function(e, "u");
}

void emit_series_functions(const struct emitter *e)
{
	emit_force_table(e);
	emit_expand_from(e);
	if (e->step->taylor.slopes)
		emit_slopes_function(by_series(e, e->step->taylor.slopes));
	if (e->step->taylor.motion)
		emit_motion_function(by_series(e, e->step->taylor.motion));
}

static void emit_model_functions(const struct emitter *e)
{
	emit_series_functions(e);
	if (e->system->inputs)
		emit_inputs_now(e);
	if (!is_straight(e))
		emit_pass_time(e);
	emit_sums(e);
	emit_constraints(e);
}

static void emit_algorithm(const struct emitter *e)
{
	const struct expansion *x = own_expansion(e);
	const struct truncation *t = truncation_of(e);
	emit_sizes(e, "taylor.h", { "STATES", e->system->states }, { "COLUMNS", e->system->states + x->columns },
		   { "MEASURED", x->measured }, { "ORDER", x->order }, { "INPUTS", e->system->inputs },
		   { "SEGMENTS", e->system->segments }, { "SWITCHING_FUNCTIONS", has_switching(e) ? x->functions : 0 },
		   { "TERMS", has_switching(e) ? terms_of_events(e) : 0 },
		   { "CONTACTS", meets_contacts(e) }, { "CHOICES", has_choices(e) }, { "ADAPTIVE", t->adaptive },
		   { "WATCHED", watches(e) }, { "REMAINDERS", t->adaptive ? 3 : watches(e) },
		   { "KINDS", shares_kinds(e) }, { "FLOORS", has_floors(e) }, { "OVER", spans_steps(e) ? t->over : 1 },
		   { "PARTS", has_offset(e) }, { "STRAIGHT", is_straight(e) },
		   { "WRITTEN_OUT", is_written_out(e, x->order) }, { "SERVES", most_served(e) },
		   { "TRIES", t->substeps }, { "MAX_SPLITS", max_splits(e->model) },
		   { "UNRESOLVED", t->adaptive && has_unresolved(e) },
		   { "SLOPES", t->adaptive && e->step->taylor.slopes },
		   { "AT", e->step->series.emitted }, { "CONSERVES", holds_energy(e) },
		   { "CONSTRAINTS", e->model->equations.correction != NULL },
		   { "MASSES", moving_masses(e) });
	emit_moved_columns(e);
	if (has_switching(e))
		emit_switching_macros(e);
	if (looks_at_tolerance(e))
		emit_reach_sizes(e);
	say(e, "#include \"taylor.h\"\n");
}

void emit_serving_step(const struct emitter *e)
{
	say(e, "\n%s { $n_serve(s, %s); }\n", head_of_step(e), e->system->inputs ? "u" : "NULL");
}

void emit_expansion_step(const struct emitter *e)
{
	emit_model_functions(e);
	emit_reach_tables(e);
	if (truncation_of(e)->adaptive && has_unresolved(e))
		emit_hidden_table(e);
	if (spans_steps(e))
		emit_over_table(e);
	if (has_switching(e))
		emit_switching_tables(e);
	if (meets_contacts(e))
		emit_event_tables(e);
	emit_algorithm(e);
	if (is_straight(e))
		emit_straight_step(e);
	else
		emit_serving_step(e);
}

void emit_expansion_at(const struct emitter *e)
{
	emit_at_by(e, "state_at");
}
