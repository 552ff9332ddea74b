/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params of what is not linear: an instance holds their values, which expressions read where they stand. */
#include "emit/emit.h"

/* ---- of either kind ---- */

const char *param_list(const struct emitter *e)
{
	const struct tuning *t = tunables_of(e->model);
	const char *list = "";
	for (int k = 0; k < t->params; k++)
		list = format("%s%s%s", list, k ? ", " : "", t->param[k].symbol->name);
	return list;
}

void emit_nominal_params(const struct emitter *e)
{
	const struct tuning *t = tunables_of(e->model);
	say(e, "{");
	for (int k = 0; k < t->params; k++)
		say(e, "%s%s", k ? ", " : "", finite_text(t->param[k].at, t->nominal[k]));
	say(e, "},\n");
}

void emit_tuning_wrapper(const struct emitter *e)
{
	const struct tuning *t = tunables_of(e->model);
	const char **name = ARRAY(const char *, (size_t)t->params);
	for (int k = 0; k < t->params; k++)
		name[k] = t->param[k].symbol->name;
	say(e, "\n");
	emit_name_list(e, "param_names", t->params, name);
	say(e, "\n"
	       "static int $n_any_retune(void *s, const double *params, double h)\n"
	       "{\n"
	       "    $n_coeffs fresh = $n_nominal;\n"
	       "    const int status = $n_retune(&fresh, params, h);\n"
	       "    if (status == 0)\n"
	       "        $n_use((struct $n *)s, &fresh);\n"
	       "    return status;\n"
	       "}\n");
}

/* ---- in functions ---- */

void emit_param_locals(const struct emitter *e, const bool *reads)
{
	for (int k = 0; k < held_values(e->model); k++)
		if (reads[k])
			say(e, "    const double %s = %s;\n", param_local(e, k), param_text(e, k));
}

void emit_nominal_params_read(const struct emitter *e, const struct reads *reads)
{
	const struct tuning *t = tunables_of(e->model);
	if (!t)
		return;
	bool *read = ARRAY(bool, (size_t)t->params);
	for (int k = 0; k < t->params; k++)
		read[k] = reads->param[k];
	for (int i = e->model->spec->inputs; i < e->system->inputs; i++)
		if (reads->input[i])
			read[param_of_input(e->model->spec, i)] = true;
	for (int k = 0; k < t->params; k++)
		if (read[k])
			say(e, "    const double %s = %s;\n", param_local(e, k),
			    finite_text(t->param[k].at, t->nominal[k]));
	for (int k = t->params; k < held_values(e->model); k++)
		if (reads->param[k])
			say(e, "    const double %s = 0.0;\n", param_local(e, k));
}

/* ---- the C ---- */
