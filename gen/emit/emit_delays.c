/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Delayed inputs: the model is NAME_core, which has them as inputs; around it NAME, which keeps the samples. */
#include "emit/emit.h"

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
	outer.name = outer.own = outer.degree = delays_of(e)->name;
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

void emit_delay_declarations(const struct emitter *core)
{
	const struct delays *d = delays_of(core);
	const struct emitter outer = around(core), *e = &outer;
	say(e, "\n/* $n: $n_core, whose last inputs are %s */\n"
	       "#ifndef $N_DECLARED\n"
	       "#define $N_DECLARED\n"
	       "\n"
	       "#ifdef __cplusplus\n"
	       "extern \"C\" {\n"
	       "#endif\n"
	       "\n", delay_list(core));
	say(e, "enum { $N_STATES = %d, $N_INPUTS = %d, $N_OUTPUTS = %d };\n"
	       "#define $N_H %s  /* step [s] */\n"
	       "\n"
	       "typedef struct $n $n;  /* copy it to save, assign it to restore */\n"
	       "struct $n {\n"
	       "    $n_core core;          /* what else there is of it: $n_core_...(&s->core, ...) */\n"
	       "    double past[%d][%d];  /* samples of each input, in a ring */\n"
	       "%s"
	       "    int newest;\n"
	       "};\n"
	       "\n", e->system->states, d->inputs, e->model->outputs, shortest(round_rational(d->h)), d->inputs,
	    samples_kept(core), core->ramps ? format("    double ends[%d][%d];  /* where a ramp to each ended that "
						     "%s_hold left */\n", d->inputs, samples_kept(core), e->name)
					    : "");
	say(e, "void   $n_init($n *s);  /* as $n_core_init; inputs have been 0 */\n"
	       "void   $n_set($n *s, double t, const double y[$N_STATES]);  /* the samples stay */\n"
	       "void   $n_get(const $n *s, double y[$N_STATES]);\n"
	       "double $n_time(const $n *s);\n"
	       "int    $n_status(const $n *s);\n"
	       "%s"
	       "void   $n_step($n *s, const double u[$N_INPUTS]);  /* one step of h */\n"
	       "void   $n_out(const $n *s, double out[$N_OUTPUTS]);\n"
	       "void   $n_run($n *s, size_t n, const double *u, double *out);  /* n rows of u, of out or NULL */\n",
	    core->ramps ? spell(e, "void   $n_hold($n *s, const double u[$N_INPUTS]);  /* the sample now */\n") : "");
	if (e->step->series.emitted)
		say(e, "void   $n_at(const $n *s, const double u[$N_INPUTS], double tau, double y[$N_STATES]);\n");
	say(e, "extern const pl_model $n_model;\n"
	       "\n"
	       "#ifdef __cplusplus\n"
	       "}\n"
	       "#endif\n"
	       "\n"
	       "#endif\n");
}

/* ---- what delays.h asks ---- */

static void emit_list(const struct emitter *e, const char *name, int (*entry)(const struct emitter *e, int input))
{
	const struct delays *d = delays_of(e);
	say(e, "static const int $n_%s[] = {", name);
	for (int i = 0; i < d->inputs + d->count; i++)
		say(e, "%s%d", i ? ", " : "", entry(e, i));
	say(e, "};\n");
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

static void emit_samples_of_core(const struct emitter *e)
{
	const struct delays *d = delays_of(e);
	say(e, "\n/* Of each input of $n_core: which sample it is of, how many of its steps ago; is it a ramp? */\n");
	emit_list(e, "input_of", input_of);
	emit_list(e, "parts_ago", parts_ago);
	if (e->ramps)
		emit_list(e, "is_ramp", is_ramp);
	const struct size sizes[] = {
		{ "STATES", e->system->states }, { "OUTPUTS", e->model->outputs }, { "INPUTS", d->inputs },
		{ "ALL", d->inputs + d->count }, { "PARTS", d->parts }, { "RING", samples_kept(e) },
		{ "RAMPS", e->ramps }, { "AT", e->step->series.emitted }
	};
	emit_sizes(e, sizeof sizes / sizeof *sizes, sizes);
	say(e, "#define PL_CORE(name) $n_core_##name\n"
	       "#define PL_CORE_H $N_CORE_H\n"
	       "#include \"delays.h\"\n");
}

static void emit_model(const struct emitter *e)
{
	const struct delays *d = delays_of(e);
	const char **names = names_of_inputs(e);
	bool at = e->step->series.emitted;
	say(e, "\n");
	emit_name_list(e, "state_names", e->system->states, e->step->shown->model->state_name);
	emit_name_list(e, "input_names", d->inputs, names);
	emit_name_list(e, "output_names", e->model->outputs, names_of_outputs(e));
	say(e, "static const int $n_start_samples[] = {");
	for (int i = 0; i < d->inputs; i++)
		say(e, "%s%d", i ? ", " : "", samples_ahead(e->system->input[i].hold));
	say(e, "};\n\n");
	emit_wrappers(e);
	say(e, "\n"
	       "const pl_model $n_model = {\n"
	       "    PL_MODEL_VERSION, sizeof(double), \"$n\", sizeof(struct $n),\n"
	       "    $N_STATES, $N_INPUTS, $N_OUTPUTS, $N_H,\n"
	       "    $n_state_names, $n_input_names, $n_output_names,\n"
	       "    $n_any_init, $n_any_set, $n_any_get, $n_any_time, $n_any_step,\n"
	       "    $n_any_out, $n_any_run, %s, NULL, $n_any_status,\n"
	       "    0, NULL, NULL, NULL,\n"
	       "    %s, $n_start_samples\n"
	       "};\n", at ? spell(e, "$n_any_at") : "NULL", e->ramps ? spell(e, "$n_any_hold") : "NULL");
}

void emit_delays(const struct emitter *core)
{
	const struct emitter outer = around(core), *e = &outer;
	say(e, "\n/* ---- $n: the samples of delayed inputs ---- */\n");
	emit_samples_of_core(e);
	emit_model(e);
}
