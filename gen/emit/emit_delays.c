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

/* ---- samples ---- */

static void emit_table_of_delays(const struct emitter *e)
{
	const struct delays *d = delays_of(e);
	int all = d->inputs + d->count;
	say(e, "\n"
	       "/* Of each input of $n_core: which sample it is of, and how many parts of h ago */\n"
	       "static const int $n_input_of[%d] = {", all);
	for (int i = 0; i < all; i++)
		say(e, "%s%d", i ? ", " : "", i < d->inputs ? i : d->delay[i - d->inputs].symbol->delayed->index);
	say(e, "};\n"
	       "static const int $n_parts_ago[%d] = {", all);
	for (int i = 0; i < all; i++)
		say(e, "%s%d", i ? ", " : "", i < d->inputs ? 0 : d->delay[i - d->inputs].back);
	say(e, "};\n");
}

/* Which inputs of the core are held, or ramps; NULL: none is */
static const char *those_of_core(const struct emitter *e, bool ramps, int *count)
{
	const struct delays *d = delays_of(e);
	const char *is = "";
	*count = 0;
	for (int i = 0; i < d->inputs + d->count; i++)
		if ((e->system->input[i].hold != 0) == ramps)
			is = format("%s%si == %d", is, (*count)++ ? " || " : "", i);
	return is;
}

/* A ramp ends where NAME_hold may make the next begin anew, with a jump; delayed ones do so later. */
static void emit_ends(const struct emitter *e, int kept)
{
	const struct delays *d = delays_of(e);
	int count;
	const char *ramps = those_of_core(e, true, &count);
	say(e, "\n"
	       "/* Where the ramp to that sample ended */\n"
	       "static double $n_end(const $n *s, int input, int steps)\n"
	       "{\n"
	       "    const int at = s->newest - steps;\n"
	       "    return s->ends[input][at < 0 ? at + %d : at];\n"
	       "}\n"
	       "\n"
	       "/* Samples from which ramps of $n_core begin with a part of the step: u of those that do so there */\n"
	       "static void $n_starts(const $n *s, int part, double u[%d])\n"
	       "{\n"
	       "    int i;\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        const int ago = $n_parts_ago[i] + %d - part;\n"
	       "        if (ago %% %d == 0%s)\n"
	       "            u[i] = $n_past(s, $n_input_of[i], ago / %d);\n"
	       "    }\n"
	       "}\n", kept, d->inputs + d->count, d->inputs + d->count, d->parts, d->parts,
	    count < d->inputs + d->count ? format(" && (%s)", ramps) : "", d->parts);
}

static void emit_samples_of_core(const struct emitter *e)
{
	const struct delays *d = delays_of(e);
	int all = d->inputs + d->count, parts = d->parts, kept = samples_kept(e);
	say(e, "\n"
	       "static void $n_keep($n *s, const double u[$N_INPUTS])\n"
	       "{\n"
	       "    int i;\n"
	       "    s->newest = s->newest + 1 == %d ? 0 : s->newest + 1;\n"
	       "    for (i = 0; i < $N_INPUTS; i++)\n"
	       "        %ss->past[i][s->newest] = u[i];\n"
	       "}\n"
	       "\n"
	       "/* The sample so many steps before the newest */\n"
	       "static double $n_past(const $n *s, int input, int steps)\n"
	       "{\n"
	       "    const int at = s->newest - steps;\n"
	       "    return s->past[input][at < 0 ? at + %d : at];\n"
	       "}\n", kept, e->ramps ? "s->ends[i][s->newest] = " : "", kept);
	if (e->ramps)
		emit_ends(e, kept);
	say(e, "\n"
	       "/* Inputs of $n_core in a part of the step: 0 .. %d */\n"
	       "static void $n_samples(const $n *s, int part, double u[%d])\n"
	       "{\n"
	       "    int i;\n"
	       "    for (i = 0; i < %d; i++) {\n", parts - 1, all, all);
	for (int ramp = 0; ramp < 2; ramp++) {
		int count;
		const char *is = those_of_core(e, ramp, &count);
		if (count == 0)
			continue;
		if (count < all)
			say(e, "        if (%s) {\n", is);
		if (ramp)
			say(e, "            const int ago = $n_parts_ago[i] + %d - part, whole = ago / %d;\n"
			       "            const double between = (double)(ago %% %d) / %d.0;\n"
			       "            const double now = $n_end(s, $n_input_of[i], whole);\n"
			       "            u[i] = between > 0.0\n"
			       "                       ? now + between *\n"
			       "                                   ($n_past(s, $n_input_of[i], whole + 1) - now)\n"
			       "                       : now;\n",
			    parts - 1, parts, parts, parts);
		else
			say(e, "            const int ago = $n_parts_ago[i] - part;\n"
			       "            u[i] = $n_past(s, $n_input_of[i], ago > 0 ? (ago + %d) / %d : 0);\n",
			    parts - 1, parts);
		say(e, count < all ? "        }\n" : "");
	}
	say(e, "    }\n"
	       "}\n");
}

/* ---- functions ---- */

/* The ramps of those that the text declares */
static const char *those_of_text(const struct emitter *e)
{
	const char *is = "";
	for (int i = 0; i < delays_of(e)->inputs; i++)
		if (e->system->input[i].hold)
			is = format("%s%si == %d", is, *is ? " || " : "", i);
	return is;
}

static void emit_state_functions(const struct emitter *e)
{
	const struct delays *d = delays_of(e);
	say(e, "\n"
	       "void $n_init($n *s)\n"
	       "{\n"
	       "    int i, k;\n"
	       "    $n_core_init(&s->core);\n"
	       "    for (i = 0; i < $N_INPUTS; i++)\n"
	       "        for (k = 0; k < %d; k++)\n"
	       "            %ss->past[i][k] = 0.0;\n"
	       "    s->newest = 0;\n"
	       "}\n"
	       "\n"
	       "void $n_set($n *s, double t, const double y[$N_STATES]) { $n_core_set(&s->core, t, y); }\n"
	       "void $n_get(const $n *s, double y[$N_STATES]) { $n_core_get(&s->core, y); }\n"
	       "double $n_time(const $n *s) { return $n_core_time(&s->core); }\n"
	       "int $n_status(const $n *s) { return $n_core_status(&s->core); }\n"
	       "void $n_out(const $n *s, double out[$N_OUTPUTS]) { $n_core_out(&s->core, out); }\n", samples_kept(e),
	    e->ramps ? "s->ends[i][k] = " : "");
	if (e->ramps)
		say(e, "\n"
		       "void $n_hold($n *s, const double u[$N_INPUTS])\n"
		       "{\n"
		       "    double all[%d];\n"
		       "    int i;\n"
		       "    for (i = 0; i < $N_INPUTS; i++)\n"
		       "        if (%s)\n"
		       "            s->past[i][s->newest] = u[i];\n"
		       "    $n_samples(s, %d, all);\n"
		       "    $n_starts(s, %d, all);\n"
		       "    for (i = 0; i < $N_INPUTS; i++)\n"
		       "        all[i] = u[i];\n"
		       "    $n_core_hold(&s->core, all);\n"
		       "}\n", d->inputs + d->count, those_of_text(e), d->parts - 1, d->parts);
}

static void emit_steps(const struct emitter *e)
{
	const struct delays *d = delays_of(e);
	int all = d->inputs + d->count;
	say(e, "\n"
	       "void $n_step($n *s, const double u[$N_INPUTS])\n"
	       "{\n"
	       "    double all[%d];\n"
	       "    int part;\n"
	       "    $n_keep(s, u);\n"
	       "    for (part = 0; part < %d; part++) {\n"
	       "        $n_samples(s, part, all);\n"
	       "%s"
	       "        $n_core_step(&s->core, all);\n"
	       "    }\n"
	       "}\n"
	       "\n"
	       "void $n_run($n *s, size_t n, const double *u, double *out)\n"
	       "{\n"
	       "    for (; n > 0u; n--, u += $N_INPUTS) {\n"
	       "        $n_step(s, u);\n"
	       "        if (out != NULL) {\n"
	       "            $n_out(s, out);\n"
	       "            out += $N_OUTPUTS;\n"
	       "        }\n"
	       "    }\n"
	       "}\n", all, d->parts, e->ramps ? spell(e, "        $n_starts(s, part, s->core.u);\n") : "");
	if (!e->step->series.emitted)
		return;
	say(e, "\n"
	       "void $n_at(const $n *s, const double u[$N_INPUTS], double tau, double y[$N_STATES])\n"
	       "{\n"
	       "    $n now = *s;\n"
	       "    double all[%d];\n"
	       "    int part;\n"
	       "    $n_keep(&now, u);\n"
	       "    for (part = 0; part < %d && tau > $N_CORE_H; part++, tau -= $N_CORE_H) {\n"
	       "        $n_samples(&now, part, all);\n"
	       "%s"
	       "        $n_core_step(&now.core, all);\n"
	       "    }\n"
	       "    $n_samples(&now, part, all);\n"
	       "%s"
	       "    $n_core_at(&now.core, all, tau, y);\n"
	       "}\n", all, d->parts - 1, e->ramps ? spell(e, "        $n_starts(&now, part, now.core.u);\n") : "",
	    e->ramps ? spell(e, "    $n_starts(&now, part, now.core.u);\n") : "");
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
	say(e, "};\n"
	       "\n"
	       "static void $n_any_init(void *s) { $n_init((struct $n *)s); }\n"
	       "static void $n_any_set(void *s, double t, const double *y) { $n_set((struct $n *)s, t, y); }\n"
	       "static void $n_any_get(const void *s, double *y) { $n_get((const struct $n *)s, y); }\n"
	       "static double $n_any_time(const void *s) { return $n_time((const struct $n *)s); }\n"
	       "static void $n_any_step(void *s, const double *u) { $n_step((struct $n *)s, u); }\n"
	       "static void $n_any_out(const void *s, double *out) { $n_out((const struct $n *)s, out); }\n");
	say(e, "static void $n_any_run(void *s, size_t n, const double *u, double *out)\n"
	       "{\n"
	       "    $n_run((struct $n *)s, n, u, out);\n"
	       "}\n");
	if (at)
		say(e, "static void $n_any_at(const void *s, const double *u, double tau, double *y)\n"
		       "{\n"
		       "    $n_at((const struct $n *)s, u, tau, y);\n"
		       "}\n");
	say(e, "static int $n_any_status(const void *s) { return $n_status((const struct $n *)s); }\n");
	if (e->ramps)
		say(e, "static void $n_any_hold(void *s, const double *u) { $n_hold((struct $n *)s, u); }\n");
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
	emit_table_of_delays(e);
	emit_samples_of_core(e);
	emit_state_functions(e);
	emit_steps(e);
	emit_model(e);
}
