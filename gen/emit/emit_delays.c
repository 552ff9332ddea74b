/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Delayed inputs: the model is NAME_core, which has them as inputs; around it NAME, which keeps the samples. */
#include "declarations.h"
#include "steps.h"
#include "model/tunable/tuning.h"

#include <string.h>

static const struct delays *delays_of(const struct emitter *e)
{
	return e->model->delays;
}

/* As many samples as the longest delay reads, the newest among them */
static int samples_kept(const struct emitter *e)
{
	const struct delays *d = delays_of(e);
	return (d->most + d->parts - 1) / d->parts + 1 + (e->ramps ? 1 : 0);
}

/* The emitter of what is around the core */
static struct emitter around(const struct emitter *e)
{
	struct emitter outer = *e;
	outer.name = outer.spelled.own = outer.spelled.degree = delays_of(e)->name;
	outer.upper = format("%.*s", (int)(strlen(e->upper) - strlen("_CORE")), e->upper);
	return outer;
}

static const char *delay_list(const struct emitter *e)
{
	const struct delays *d = delays_of(e);
	const char *list = "";
	for (int i = 0; i < d->count; i++)
		list = format("%s%s%s(%s)", list, i ? ", " : "", d->delay[i].symbol->delayed->name,
			      text_between(d->delay[i].symbol->when->start, d->delay[i].symbol->when->end));
	return list;
}

static void emit_delay_struct(const struct emitter *e, int samples, bool ramps)
{
	const int inputs = delays_of(e)->inputs;
	say(e, "typedef struct $n $n;  /* copy it to save, assign it to restore */\n"
	       "struct $n {\n"
	       "    $n_core core;          /* the model with delayed inputs as inputs: $n_core_...(&s->core, ...) */\n"
	       "    double past[%d][%d];  /* samples of each input, in a ring */\n", inputs, samples);
	if (ramps)
		say(e, "    double ends[%d][%d];  /* where a ramp to each ended that $n_hold left */\n", inputs,
		    samples);
	say(e, "    int newest;\n"
	       "};\n\n");
}

/* Coefficients are those of the core, and NAME_nominal is its name */
static void declare_params(const struct emitter *e)
{
	say(e, "\n/* As $n_core_retune and $n_core_use; of h, the spec's alone: a delay is so many steps */\n"
	       "enum { $N_PARAMS = $N_CORE_PARAMS };\n"
	       "typedef $n_core_coeffs $n_coeffs;\n"
	       "#define $n_nominal $n_core_nominal\n"
	       "int    $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h);\n"
	       "void   $n_use($n *s, const $n_coeffs *c);\n\n");
}

void emit_delay_declarations(const struct emitter *core)
{
	const struct delays *d = delays_of(core);
	const struct emitter outer = around(core), *e = &outer;
	say(e, "\n/* $n: $n_core, whose last inputs are %s */\n", delay_list(core));
	open_declarations(e, e->upper, "");
	emit_counts(e, d->inputs);
	say(e, "#define $N_H %s  /* step [s] */\n\n", shortest(round_rational(d->h)));
	emit_delay_struct(e, samples_kept(core), core->ramps);
	announce(e, spell(e, "void   $n_init($n *s);"), spell(e, "as $n_core_init; inputs have been 0"));
	announce(e, spell(e, "void   $n_set($n *s, double t, const double y[$N_STATES]);"), "the samples stay");
	declare_reading(e, "");
	if (core->ramps)
		announce(e, spell(e, "void   $n_hold($n *s, const double u[$N_INPUTS]);"), "the sample now");
	declare_driven_step(e, "one step of h");
	if (tunables_of(e->model))
		declare_params(e);
	if (e->model->request.many.batch && !e->model->request.many.device)
		emit_batch_declarations(e);
	if (!e->model->request.many.device) {
		declare_selftest(e);
		declare_model(e);
	}
	close_declarations(e);
	if (e->step->derivatives)
		emit_derivative_declarations(e);
}

/* ---- what delays.h asks ---- */

static int *list_of(const struct emitter *e, int (*entry)(const struct emitter *e, int input))
{
	const int count = delays_of(e)->inputs + delays_of(e)->count;
	int *list = ARRAY(int, (size_t)count);
	for (int i = 0; i < count; i++)
		list[i] = entry(e, i);
	return list;
}

static int input_of(const struct emitter *e, int input)
{
	const struct delays *d = delays_of(e);
	return input < d->inputs ? input : d->delay[input - d->inputs].symbol->delayed->index;
}

static int parts_ago(const struct emitter *e, int input)
{
	const struct delays *d = delays_of(e);
	return input < d->inputs ? 0 : d->delay[input - d->inputs].back;
}

static int is_ramp(const struct emitter *e, int input)
{
	return e->system->input[input].hold != 0;
}

/* Per column and input of the core what its jump by 1 does to the states, where a delay moves it */
static void emit_moved_jumps(const struct emitter *e)
{
	const struct derivatives *derivatives = e->step->derivatives;
	const struct delays *d = delays_of(e);
	const struct layout *x = &e->step->layout;
	const int states = e->system->states, all = d->inputs + d->count;
	const int size[] = { derivatives->columns, all, states };
	double *value = ARRAY(double, (size_t)(size[0] * all * states));
	const double *A = slopes_of(e->step, 0);
	for (int p = 0; p < derivatives->columns; p++)
		for (int k = 0; k < d->count; k++)
			for (int i = 0; i < states; i++)
				value[(p * all + d->inputs + k) * states + i] =
					derivatives->late[p * d->count + k] * A[i * x->size + x->input[d->inputs + k]];
	emit_array(e, "Of each column, where its param moves a delay: what a jump of each input of the core by 1 does "
		   "to the states", "late", 3, size, value, NULL);
}

static void emit_samples_of_core(const struct emitter *e)
{
	const struct delays *d = delays_of(e);
	say(e, "\n/* Of each input of $n_core: which sample it is of, how many of its steps ago; is it a ramp? */\n");
	emit_int_list(e, "input_of", d->inputs + d->count, list_of(e, input_of));
	emit_int_list(e, "parts_ago", d->inputs + d->count, list_of(e, parts_ago));
	const struct derivatives *derivatives = e->step->derivatives;
	if (derivatives && derivatives->late)
		emit_moved_jumps(e);
	if (e->ramps)
		emit_int_list(e, "is_ramp", d->inputs + d->count, list_of(e, is_ramp));
	emit_sizes(e, "delays.h", { "STATES", e->system->states }, { "OUTPUTS", e->model->outputs },
		   { "INPUTS", d->inputs },
		   { "ALL", d->inputs + d->count }, { "PARTS", d->parts }, { "RING", samples_kept(e) },
		   { "RAMPS", e->ramps }, { "AT", e->step->series.emitted },
		   { "DERIVATIVES", derivatives ? derivatives->columns : 0 },
		   { "LATE", derivatives && derivatives->late },
		   { "PARAMS", tunables_of(e->model) ? tunables_of(e->model)->given : 0 });
	say(e, "#define PL_CORE(name) $n_core_##name\n"
	       "#define PL_CORE_H $N_CORE_H\n"
	       "#define PL_SPEC_H $N_H\n"
	       "#include \"delays.h\"\n");
}

static void emit_around(const struct emitter *e)
{
	say(e, "\n/* ---- $n: the samples of delayed inputs ---- */\n");
	emit_samples_of_core(e);
}

void emit_delays_on_device(const struct emitter *core, const char *target)
{
	const struct emitter outer = around(core), *e = &outer;
	emit_around(e);
	emit_whole_kernel(e, target);
}

void emit_delays(const struct emitter *core)
{
	const struct emitter outer = around(core), *e = &outer;
	emit_around(e);
	if (e->step->derivatives)
		emit_derivatives_around(e);
	if (e->model->request.many.batch)
		emit_batch(e);
	if (e->model->request.selftest)
		emit_selftest(e, false);
	say(e, "\n");
	emit_model(e, delays_of(e)->inputs, false);
}
