/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of steps, outputs and values between steps: of each block of columns the rows of its model, whose states
 * stand in y and in ds. */
#include "inner.h"
#include "emit/declarations.h"
#include "emit/steps.h"
#include "emit/regions/regions.h"
#include "emit/series/series.h"
#include "model/reads.h"
#include "model/tunable/tuning.h"
#include "step/regions/regions.h"
#include "step/linear/forms.h"
#include "step/linear/rows.h"

#include <string.h>

/* ---- what they are called ---- */

/* Of a state its initial value, x(0) */
static const char *column_name(const struct sensitivity *s)
{
	return s->symbol->kind == SYMBOL_COORD ? format("%s(0)", s->name) : s->name;
}

/* In an enum: the initial value of x as X0 */
static const char *index_name(const struct sensitivity *s)
{
	const char *name = s->component ? format("%s %d", s->symbol->name, s->component) : s->symbol->name;
	return s->symbol->kind == SYMBOL_COORD ? format("%s%s0", name, s->primes ? "_dot" : "") : name;
}

static const char *column_list(const struct derivatives *d)
{
	const char *list = "";
	for (int i = 0; i < d->columns; i++)
		list = format("%s%s%s", list, i ? ", " : "", column_name(&d->column[i]));
	return list;
}

static const char *column_count(int columns)
{
	return columns > 1 ? format("%d columns", columns) : "a column";
}

/* In calls, and where they are declared */
static const char *input_arguments(const struct emitter *e)
{
	return !given_inputs(e) ? "" : e->step->derivatives->seeded ? ", u, du" : ", u";
}

static const char *unread_inputs(const struct emitter *e)
{
	return !given_inputs(e) ? "" : e->step->derivatives->seeded ? " u du" : " u";
}

static const char *input_parameters(const struct emitter *e)
{
	const char *u = given_inputs(e) ? format(", const double u[%s_INPUTS]", e->upper) : "";
	return e->step->derivatives->seeded ? format("%s, const double du[%s_INPUTS]", u, e->upper) : u;
}

static bool has_values_between(const struct emitter *e)
{
	bool has = e->step->series.emitted;
	for (int b = 0; b < e->step->derivatives->blocks; b++)
		has = has && e->step->derivatives->block[b].step->series.emitted;
	return has;
}

/* ---- the header ---- */

static bool is_around_core(const struct emitter *e)
{
	return e->model->delays && strcmp(e->name, e->model->delays->name) == 0;
}

static void emit_derivative_struct(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	say(e, "typedef struct $n_d $n_d;\n"
	       "struct $n_d {\n"
	       "    double s[$N_D][$N_STATES];  /* column by column: of %s */\n", state_list(e->step->shown->model));
	if (d->seeded)
		say(e, "    double du[$N_INPUTS];       /* of the last sample */\n");
	if (d->seeded && e->ramps)
		say(e, "    double slope[$N_INPUTS];    /* of that [1/s] */\n");
	for (int b = 0; b < d->blocks && d->apart; b++)
		say(e, "    %s block%d;  /* the states and %s */\n", e->beside[b].name, b,
		    column_count(d->block[b].columns));
	if (d->apart)
		say(e, "    double left[$N_STATES], time;  /* of s, when both were stepped last */\n");
	if (has_peaks(e))
		say(e, "    double peak[%d][$N_D];      /* of peaks so far */\n", peak_outputs(e->model));
	if (d->varied)
		say(e, "    double scale[$N_STATES];    /* the largest size of each state so far */\n");
	say(e, "    unsigned status;            /* 0, or PL_D_... bits */\n"
	       "    pl_doubt doubt;             /* of each the first event: switching function, time */\n"
	       "};\n");
}

void emit_derivative_declarations(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	const char **name = ARRAY(const char *, (size_t)d->columns);
	for (int i = 0; i < d->columns; i++)
		name[i] = index_name(&d->column[i]);
	for (int b = 0; b < d->blocks && d->apart && !is_around_core(e); b++)
		emit_declarations(&e->beside[b], false);
	open_declarations(e, format("%s_D", e->upper), "");
	const char *words = "Derivatives by %s, a column each; by an input: along the change du of its samples.  s is "
			    "left by $n_step_d as it is by $n_step.";
	say_comment(e, "", spell(e, words, column_list(d)));
	say(e, "enum { $N_D = %d };\n", d->columns);
	emit_names_of(e, "D", name, d->columns);
	if (is_around_core(e))
		say(e, "typedef $n_core_d $n_d;\n");
	else
		emit_derivative_struct(e);
	announce(e, spell(e, "void   $n_init_d($n *s, $n_d *ds);"),
		 spell(e, "as $n_init, and the derivatives of that state"));
	announce(e, spell(e, "void   $n_set_d($n_d *ds, double S[$N_D][$N_STATES]);"), "any; NULL: 0");
	announce(e, spell(e, "void   $n_get_d(const $n *s, const $n_d *ds, double S[$N_D][$N_STATES]);"), "");
	if (d->seeded && e->ramps)
		announce(e, spell(e, "void   $n_hold_d($n_d *ds, const double du[$N_INPUTS]);"),
			 spell(e, "as $n_hold, of du"));
	announce(e, spell(e, "void   $n_step_d($n *s, $n_d *ds%s);", input_parameters(e)), "one step of both");
	announce(e, spell(e, "void   $n_out_d(const $n *s, const $n_d *ds, double J[$N_OUTPUTS][$N_D]);"), "");
	if (has_values_between(e))
		announce(e, spell(e, "void   $n_at_d(const $n *s, const $n_d *ds%s, double tau, "
				     "double S[$N_D][$N_STATES]);", input_parameters(e)), "");
	const char *u = given_inputs(e) ? ", const double *u" : "", *du = d->seeded ? ", const double *du" : "";
	announce(e, spell(e, "void   $n_run_d($n *s, $n_d *ds, size_t n%s%s, double *out, double *J);", u, du),
		 "out, J: n rows, or NULL");
	const char *backwards = "A cost backwards: from w, its derivatives by the outputs behind a step, and lam, "
				"those by the state there, to those by the state before it; pb of each column%s are "
				"added to.  $n_gradient goes over n steps from s, with n rows of w or NULL, and room "
				"for that many snapshots, 1 to PL_SNAPSHOTS; ds: the derivatives of s.  It returns how "
				"many steps it has taken between them.";
	const char *samples = !d->seeded ? ""
			    : spell(e, e->ramps ? ", ub of each sample (before: of that at the start; in $n_gradient "
						  "row 0 is of the one before the first step)" : ", ub of each sample");
	say_comment(e, "", spell(e, backwards, samples));
	announce(e, spell(e, "void   $n_back(const $n *s%s, const double *w, double lam[$N_STATES], "
			     "double pb[$N_D]%s);", given_inputs(e) ? spell(e, ", const double u[$N_INPUTS]") : "",
			  d->seeded ? ", double *ub, double *before" : ""), "a step from s");
	announce(e, spell(e, "size_t $n_gradient(const $n *s, $n_d *ds, size_t n%s, const double *w, "
			     "double lam[$N_STATES], double pb[$N_D]%s, $n *snapshot, size_t snapshots);", u,
			  d->seeded ? ", double *ub" : ""), "");
	say(e, "extern const pl_derivatives $n_derivatives;\n");
	close_declarations(e);
}

/* ---- a block's model as an emitter of its own, whose numbers stand elsewhere ---- */

/* Of a state of the block: the column that it is of, from 0; NONE: it is a state itself. *state: which; NONE: it is the
 * derivative of t, and 0; CLOCK: t; PROBE - i: i by nothing */
enum { CLOCK = -2, PROBE = -3 };
static int column_of(const struct model *written, const struct derivative_block *block, int place, int *state)
{
	const struct model *model = block->step->model;
	const int own = model->spec->joined.own, stride = model->spec->joined.stride;
	const int coord = model->system.coord[place];
	const int of = coord < own ? coord : (coord - own) % stride;
	const bool added = of >= written->n, probe = coord - own >= block->columns * stride;
	const int same = added || place < model->n ? of : written->system.velocity[of];
	*state = !added ? (probe ? PROBE - same : same) : coord < own ? CLOCK : NONE;
	return coord < own || added || probe ? NONE : block->first + (coord - own) / stride;
}

static const char **places_of_states(const struct model *written, const struct derivative_block *block)
{
	const int states = block->step->model->system.states;
	const char **place = ARRAY(const char *, (size_t)states);
	for (int i = 0; i < states; i++) {
		int state, column = column_of(written, block, i, &state);
		place[i] = column == NONE ? format("y[%d]", state) : format("ds->s[%d][%d]", column, state);
	}
	return place;
}

static const char **places_of_outputs(const struct model *written, const struct derivative_block *block)
{
	const int own = written->outputs;
	const char **place = ARRAY(const char *, (size_t)block->step->model->outputs + 1);
	for (int i = own; i < own * (1 + block->columns); i++)
		place[i] = format("J[%d][%d]", i % own, block->first + i / own - 1);
	return place;
}

/* Seeds stand behind the inputs, in the order of the columns. */
static int input_of_seed(const struct emitter *e, const struct derivative_block *block, int input)
{
	int seed = given_inputs(e), i = block->first;
	for (; i < block->first + block->columns; i++)
		if (e->step->derivatives->column[i].symbol->kind == SYMBOL_INPUT && seed++ == input)
			return e->step->derivatives->column[i].symbol->index;
	return NONE;
}

static const char *sample_of(const struct emitter *e, const struct derivative_block *block, int input, int sample)
{
	const int hold = block->step->model->system.input[input].hold, seed = input_of_seed(e, block, input);
	if (seed == NONE)
		return sample_text(e, input, sample);
	return format(sample == hold ? "(du == NULL ? 0.0 : du[%d])" : "ds->du[%d]", seed);
}

static const char **samples_of(const struct emitter *e, const struct derivative_block *block)
{
	const struct linear *system = &block->step->model->system;
	const char **text = ARRAY(const char *, (size_t)input_columns(system) + 1);
	for (int i = 0, column = 0; i < system->inputs; i++)
		for (int c = 0; c <= system->input[i].hold; c++)
			text[column++] = sample_of(e, block, i, c);
	return text;
}

static struct emitter emitter_of_block(const struct emitter *e, const struct derivative_block *block)
{
	struct emitter b = e->beside[block - e->step->derivatives->block];
	for (int l = 0; l < b.system->loads; l++) {
		const int own = load_alike(e->system, &b.system->load[l]);
		b.phase[l] = own == NONE ? NONE : e->phase[own];
		b.envelope[l] = own == NONE ? NONE : e->envelope[own];
	}
	struct standing *at = NEW(struct standing);
	at->state = places_of_states(e->step->model->written, block);
	at->output = places_of_outputs(e->step->model->written, block);
	at->input = ARRAY(const char *, (size_t)b.system->inputs + 1);
	at->slope = ARRAY(const char *, (size_t)b.system->inputs + 1);
	for (int i = 0; i < b.system->inputs; i++) {
		const int seed = input_of_seed(e, block, i), input = seed == NONE ? i : seed;
		at->input[i] = format(seed == NONE ? "s->u[%d]" : "ds->du[%d]", input);
		at->slope[i] = format(seed == NONE ? "s->slope[%d]" : "ds->slope[%d]", input);
	}
	at->since = e->step->refresh != NULL;
	b.at = at;
	b.sample = samples_of(e, block);
	return b;
}

/* ---- the functions of a block ---- */

static void emit_block_step(const struct emitter *e, const struct derivative_block *block, int number)
{
	const struct emitter made = emitter_of_block(e, block), *b = &made;
	const int states = b->system->states;
	bool *stepped = ARRAY(bool, (size_t)states), *reads = ARRAY(bool, (size_t)states);
	for (int i = 0; i < states; i++)
		stepped[i] = b->system->coord[i] >= e->step->model->written->n;
	struct formulas *f = formulas_of_step(b, stepped);
	tape_mark(formulas_tape(f), TAPE_STATE, 0, reads);
	const struct reads r = reads_of_formulas(f);
	open_function(e, NULL, "static void $n_step_d%d(const $n *s, const double y[$N_STATES], $n_d *ds%s)", number,
		      input_parameters(e));
	emit_raw_locals(b, reads);
	if (r.time)
		say(e, "    const double t = $n_time(s);\n");
	emit_load_states(b, r.load, r.time);
	emit_formulas(f, 4);
	close_function(e, format("s y%s", unread_inputs(e)));
}

static void emit_block_outputs(const struct emitter *e, const struct derivative_block *block, int number)
{
	const struct emitter b = emitter_of_block(e, block);
	open_function(e, NULL, "static void $n_out_d%d(const $n *s, const double y[$N_STATES], const $n_d *ds, "
		      "double J[$N_OUTPUTS][$N_D])", number);
	emit_outputs_now(&b);
	close_function(e, "s y ds");
}

/* By the Taylor series of the block's model, as the model's own */
static void emit_block_at(const struct emitter *e, const struct derivative_block *block, int number)
{
	const struct emitter made = emitter_of_block(e, block), *b = &made;
	const struct layout *x = &b->step->layout;
	const struct series *series = &b->step->series;
	const int size[] = { x->size, x->size };
	emit_array(e, "A of x' = A x; x: the states and their derivatives, then load states and inputs",
		   format("d%d_slope", number), 2, size, slopes_of(b->step, 0), NULL);
	open_function(e, NULL, "static void $n_at_d%d(const $n *s, const double y[$N_STATES], const $n_d *ds%s, "
			       "double tau, double S[$N_D][$N_STATES])", number, input_parameters(e));
	say(e, "    static const pl_series series = {%d, %d, %d, %d, $n_d%d_slope[0]};"
	       "  /* size, states, degree, halvings */\n"
	       "    double work[%d];\n"
	       "    double x[%d];\n", x->size, b->system->states, series->degree, series->halvings, number,
	    2 * x->size, x->size);
	emit_load_states(b, wanted_loads(b, x->load), false);
	for (int i = 0; i < b->system->states; i++)
		say(e, "    x[%d] = %s;\n", i, b->at->state[i]);
	store_loads(b, x->load);
	store_inputs(b, x->input);
	say(e, "    pl_series_advance(&series, tau, x, work);\n");
	for (int i = 0; i < b->system->states; i++)
		if (b->system->coord[i] >= e->step->model->written->n)
			say(e, "    S%s = x[%d];\n", b->at->state[i] + strlen("ds->s"), i);
	close_function(e, format("s y%s", unread_inputs(e)));
}

/* ---- a block that is a model of its own ---- */

static const char *end_of_series(const struct emitter *b)
{
	const struct truncation *t = truncation_of(b);
	if (b->model->spec->joined.held)
		return given_inputs(b) ? "1" : "((b)->size == 0 || ((b)->k % 8 == 0 && (b)->at - (b)->back >= -8))";
	if (b->step->is.flow != FLOW_SERIES)
		return "0";
	return t->adaptive ? "((b)->served == (b)->valid)" : t->over > 1 ? "((b)->served == 0)" : "1";
}

static void emit_block_beside(const struct emitter *e, int number)
{
	const struct derivatives *d = e->step->derivatives;
	const struct derivative_block *block = &d->block[number];
	const struct emitter *b = &e->beside[number];
	const int states = b->system->states, inputs = given_inputs(b);
	int *column = ARRAY(int, (size_t)states), *state = ARRAY(int, (size_t)states);
	int *input = ARRAY(int, (size_t)inputs + 1);
	for (int i = 0; i < states; i++) {
		column[i] = column_of(e->step->model->written, block, i, &state[i]);
		state[i] = state[i] == NONE ? -1 : state[i];
	}
	for (int i = 0; i < inputs; i++)
		input[i] = i < given_inputs(e) ? i : input_of_seed(e, block, i);
	say(b, "\n/* Of each state of $n its column, -1: it is a state of %s; which state, -1: it is 0, -2: t; "
	       "-3 - i: i by nothing%s */\n", e->name, inputs ? "; of each input the model's" : "");
	emit_int_list(b, "moved_column", states, column);
	emit_int_list(b, "moved_state", states, state);
	if (inputs)
		emit_int_list(b, "moved_input", inputs, input);
	emit_sizes(b, "beside.h", { "STATES", states }, { "INPUTS", inputs }, { "OUTPUTS", b->model->outputs },
		   { "AT", b->step->series.emitted }, { "PAST_SAMPLES", most_samples_before(b) },
		   { "OWN_STATES", e->system->states }, { "OWN_INPUTS", given_inputs(e) },
		   { "OWN_OUTPUTS", e->model->outputs }, { "DERIVATIVES", d->columns }, { "SEEDED", d->seeded },
		   { "PARAMS", tunables_of(b->model) ? tunables_of(b->model)->given : 0 },
		   { "TUNED", b->step->is.tuned }, { "SEGMENTS", b->system->segments }, { "PLACES", has_place(b) },
		   { "CONSTRAINTS", b->model->equations.correction != NULL },
		   { "PROBED", b->model->spec->joined.probe }, { "ALIGNED", b->model->spec->joined.held },
		   { "TURNS", b->step->taylor.expansion != NULL },
		   { "FROM", block->first }, { "WIDE", block->columns },
		   { "DECLARED", e->model->declared_outputs });
	emit_moved_columns(b);
	emit_counts_macro(b);
	if (b->model->spec->joined.held)
		say(b, "#define PL_SHARE 0.7  /* of a length that is to be more exact */\n");
	say(e, "#define PL_OF(name) %s_##name\n"
	       "#define PL_OF_TYPE %s\n"
	       "#define PL_ENDED(b) %s\n"
	       "#include \"beside.h\"\n", e->name, e->name, end_of_series(b));
}

static void emit_beside(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	for (int b = 0; b < d->blocks; b++)
		emit_block_beside(e, b);
	open_function(e, NULL, "static void $n_init_beside($n_d *ds)");
	for (int b = 0; b < d->blocks; b++)
		say(e, "    %s_init(&ds->block%d);\n", e->beside[b].name, b);
	close_function(e, "");
}

/* NULL for what it has not */
static const char *samples_beside(const struct emitter *e)
{
	return !given_inputs(e) ? "NULL, NULL" : e->step->derivatives->seeded ? "u, du" : "u, NULL";
}

/* ---- the functions of the model ---- */

/* y: the states as written */
static void emit_state_now(const struct emitter *e)
{
	say(e, "    double y[$N_STATES];\n"
	       "    $n_get(s, y);\n");
}

static void emit_keep_seeds(const struct emitter *e)
{
	for (int i = 0; i < given_inputs(e) && e->step->derivatives->seeded; i++) {
		const char *now = format("(du == NULL ? 0.0 : du[%d])", i);
		if (e->ramps)
			say(e, "    ds->slope[%d] = %s;\n", i, slope_of_samples(e, now, format("ds->du[%d]", i)));
		say(e, "    ds->du[%d] = %s;\n", i, now);
	}
}

/* Where there are peaks NAME_step_d and NAME_out_d are those of derivatives.h around it. */
static void open_step(const struct emitter *e)
{
	open_function(e, NULL, has_peaks(e) ? "static void $n_one_step_d($n *s, $n_d *ds%s)"
					    : "void $n_step_d($n *s, $n_d *ds%s)", input_parameters(e));
}

static void emit_steps_beside(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	open_step(e);
	for (int b = 0; b < d->blocks; b++)
		say(e, "    %s_step_beside(&ds->block%d, s, ds, %s);\n", e->beside[b].name, b, samples_beside(e));
	say(e, "    $n_step(s%s);\n", given_inputs(e) ? ", u" : "");
	emit_keep_seeds(e);
	say(e, "    $n_get(s, ds->left);\n"
	       "    ds->time = $n_time(s);\n");
	close_function(e, "");
}

/* Of derivatives alone */
static void emit_move(const struct emitter *e)
{
	open_function(e, NULL, "static void $n_move_d(const $n *s, $n_d *ds%s)", input_parameters(e));
	if (e->step->derivatives->varied)
		say(e, "    $n_vary_all(s, ds%s, $N_H);\n", input_arguments(e));
	else
		emit_state_now(e);
	for (int b = 0; b < e->step->derivatives->blocks; b++)
		say(e, "    $n_step_d%d(s, y, ds%s);\n", b, input_arguments(e));
	close_function(e, "");
}

static void emit_step_of_all(const struct emitter *e)
{
	if (e->step->derivatives->apart) {
		emit_steps_beside(e);
		return;
	}
	if (!shares_step(e))
		emit_move(e);
	open_step(e);
	say(e, "    $n_%s(s, ds%s);\n", shares_step(e) ? "step_both" : "move_d", input_arguments(e));
	if (!shares_step(e))
		say(e, "    $n_step(s%s);\n", given_inputs(e) ? ", u" : "");
	emit_keep_seeds(e);
	close_function(e, "");
}

static void emit_at_of_all(const struct emitter *e)
{
	open_function(e, NULL, "void $n_at_d(const $n *s, const $n_d *ds%s, double tau, double S[$N_D][$N_STATES])",
		      input_parameters(e));
	if (e->step->derivatives->varied) {
		say(e, "    $n_d then = *ds;\n"
		       "    $n_vary_all(s, &then%s, tau);\n"
		       "    $n_get_d(s, &then, S);\n", input_arguments(e));
		close_function(e, "");
		return;
	}
	if (!e->step->derivatives->apart)
		emit_state_now(e);
	for (int b = 0; b < e->step->derivatives->blocks; b++)
		if (e->step->derivatives->apart)
			say(e, "    %s_at_beside(s, ds, &ds->block%d, %s, tau, S);\n", e->beside[b].name, b,
			    samples_beside(e));
		else
			say(e, "    $n_at_d%d(s, y, ds%s, tau, S);\n", b, input_arguments(e));
	close_function(e, "");
}

static void emit_outputs_of_all(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	if (e->model->declared_outputs && d->varied)
		return;
	open_function(e, NULL, has_peaks(e)
		      ? "static void $n_now_d(const $n *s, const $n_d *ds, double J[$N_OUTPUTS][$N_D])"
		      : "void $n_out_d(const $n *s, const $n_d *ds, double J[$N_OUTPUTS][$N_D])");
	if (e->model->declared_outputs && d->apart) {
		for (int b = 0; b < d->blocks; b++)
			say(e, "    %s_out_beside(s, ds, &ds->block%d, J);\n", e->beside[b].name, b);
	} else if (e->model->declared_outputs) {
		emit_state_now(e);
		for (int b = 0; b < d->blocks; b++)
			say(e, "    $n_out_d%d(s, y, ds, J);\n", b);
	} else {
		say(e, "    int i, p;\n"
		       "    for (i = 0; i < $N_OUTPUTS; i++) {\n"
		       "        for (p = 0; p < $N_D; p++) { J[i][p] = ds->s[p][i]; }\n"
		       "    }\n");
	}
	close_function(e, "s");
}

/* NAME_retune leaves the initial values as they are: by a tunable param they have no derivative. */
static void leave_start(const struct emitter *e, double *value)
{
	const struct derivatives *d = e->step->derivatives;
	for (int p = 0; p < d->columns; p++)
		for (int i = 0; i < e->system->states && d->column[p].symbol->tuning.tuned; i++)
			value[p * e->system->states + i] = 0;
}

static void emit_start(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	const int states = e->system->states, size[] = { d->columns, states };
	double *value = ARRAY(double, (size_t)(d->columns * states));
	for (int p = 0; p < d->columns && d->varied; p++)
		vary_start(e->step, p, value + p * states);
	for (int b = 0; b < d->blocks; b++)
		for (int i = 0; i < d->block[b].step->model->system.states; i++) {
			int state, column = column_of(e->step->model->written, &d->block[b], i, &state);
			if (column != NONE)
				value[column * states + state] =
					finite_number(e, d->block[b].step->model->initial[i]);
		}
	leave_start(e, value);
	emit_array(e, "Derivatives of the initial state", "d_initial", 2, size, value, NULL);
}

/* For programs that look for other values, as a fit does; initial values and inputs have none here. */
static void emit_values_of_columns(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	const int size[] = { d->columns, 4 };
	double *by = ARRAY(double, 4 * (size_t)d->columns);
	for (int i = 0; i < d->columns; i++) {
		const struct symbol *s = d->column[i].symbol;
		const struct param_range *range = range_of_param(e->model, s);
		/* du is in the input's unit, as u is */
		by[4 * i + 1] = s->kind == SYMBOL_INPUT ? 1 : unit_factor(s->unit);
		if (s->kind == SYMBOL_PARAM) {
			RATIONAL value = ZERO;
			param_value(s, value);
			by[4 * i] = finite_number(e, value);
		}
		by[4 * i + 2] = range ? finite_number(e, range->low) : 0;
		by[4 * i + 3] = range ? finite_number(e, range->high) : 0;
	}
	emit_array(e, "Of each: its value, its unit in SI units, its range, or 0 and 0", "d_by", 2, size, by, NULL);
}

static void emit_inputs_of_columns(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	int *input = ARRAY(int, (size_t)d->columns);
	for (int i = 0; i < d->columns; i++)
		input[i] = d->column[i].symbol->kind == SYMBOL_INPUT ? d->column[i].symbol->index : -1;
	if (d->seeded)
		emit_int_list(e, "d_input", d->columns, input);
}

static void emit_derivatives_of_sizes(const struct emitter *e, int row)
{
	const struct derivatives *d = e->step->derivatives;
	const bool around = is_around_core(e), by_phi = !around && is_linear_alone(e->step) && !e->step->is.tuned &&
							!e->step->shown->no.phi && !has_peaks(e);
	const bool beside = d->apart && d->blocks > 0 && !has_peaks(e) && !given_inputs(e);
	const bool strides = beside && !around && (serves_rows(e) || e->beside[0].model->spec->joined.held);
	if (strides)
		say(e, "#define PL_ENDED(b) %s\n", end_of_series(&e->beside[0]));
	emit_sizes(e, "derivatives.h", { "STATES", e->system->states },
		   { "INPUTS", around ? e->model->delays->inputs : given_inputs(e) },
		   { "OUTPUTS", e->model->outputs }, { "DERIVATIVES", d->columns }, { "SEEDED", d->seeded },
		   { "SLOPED", d->seeded && e->ramps }, { "BESIDE", d->apart },
		   { "STRIDE", strides ? 8 : 1 },
		   { "BY_PHI", by_phi }, { "BY_ROWS", by_phi && has_steady_outputs(e->model) },
		   { "DECLARED", e->model->declared_outputs },
		   { "SCALED", d->varied != NULL }, { "SEGMENTS", row ? e->model->system.segments : 1 },
		   { "OUT_SIZE", row }, { "RELATIVE", row && e->model->relative },
		   { "AROUND", around }, { "BY_SLOPES", row && slopes_of_outputs(e->model) },
		   { "PEAKS", peak_outputs(e->model) }, { "BY_VALUES", peaks_by_values(e->step) });
	if (has_peaks(e))
		say_macro(e, "PEAK_OF(s)", around ? "(s)->core.peak" : "(s)->peak");
	say_include(e, "derivatives.h");
}

/* Around a core with delayed inputs: its derivatives are those of the core. */
void emit_derivatives_around(const struct emitter *e)
{
	static const char *const tables[] = { "d_initial", "d_names", "d_by", "init_beside" };
	for (size_t i = 0; i < sizeof tables / sizeof *tables - !e->step->derivatives->apart; i++)
		say(e, "#define $n_%s $n_core_%s\n", tables[i], tables[i]);
	if (has_peaks(e))
		say(e, "#define $n_peak_output $n_core_peak_output\n");
	emit_derivatives_of_sizes(e, 0);
}

void emit_step_derivatives(const struct emitter *e)
{
	const struct derivatives *d = e->step->derivatives;
	const char **name = ARRAY(const char *, (size_t)d->columns);
	for (int i = 0; i < d->columns; i++)
		name[i] = column_name(&d->column[i]);
	say(e, "\n/* ---- derivatives ---- */\n");
	if (d->apart)
		emit_beside(e);
	for (int b = 0; b < d->blocks && !d->apart; b++) {
		emit_block_step(e, &d->block[b], b);
		if (e->model->declared_outputs)
			emit_block_outputs(e, &d->block[b], b);
	}
	for (int b = 0; b < d->blocks && !d->apart && has_values_between(e); b++)
		emit_block_at(e, &d->block[b], b);
	if (d->varied)
		emit_all_varied(e);
	emit_step_of_all(e);
	if (has_values_between(e))
		emit_at_of_all(e);
	emit_outputs_of_all(e);
	emit_start(e);
	const int row = d->varied && e->model->declared_outputs ? emit_varied_outputs(e) : 0;
	emit_name_list(e, "d_names", d->columns, name);
	emit_values_of_columns(e);
	emit_inputs_of_columns(e);
	emit_derivatives_of_sizes(e, row);
	if (!e->model->request.external)
		return;
	emit_sizes(e, "external.h", { "STATES", e->system->states }, { "INPUTS", given_inputs(e) },
		   { "OUTPUTS", e->model->outputs }, { "DERIVATIVES", d->columns });
	say(e, "#define PL_JAC(name) jac_$n_casadi##name\n"
	       "#include \"external.h\"\n");
}
