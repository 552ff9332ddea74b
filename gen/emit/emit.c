/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step program and its tables as C. Everything printed here is meant to be read. */
#include "emit/emit.h"

#include <ctype.h>

static const char *upper_case(const char *name)
{
	char *upper = format("%s", name);
	for (char *c = upper; *c; c++)
		*c = (char)toupper((unsigned char)*c);
	return upper;
}

/* A load leaves no trace where it acts on nothing and no output shows it. */
struct wave_search {
	const struct wave *wave;
	bool found;
};

static void look_for_wave(void *context, const struct form *form)
{
	struct wave_search *search = context;
	for (int i = 0; i < form->terms; i++)
		search->found = search->found || (form->term[i].basis.kind == BASIS_WAVE && form->term[i].basis.wave == search->wave);
}

static bool load_is_needed(const struct model *model, const struct linear *system, int load)
{
	struct wave_search search = { system->load[load].wave, false };
	visit_leftovers(model, look_for_wave, &search);
	bool needed = search.found || load_acts(system, &system->load[load]);
	for (int o = 0; o < model->outputs; o++) {
		const struct form *left = model->output[o].left;
		needed = needed || (left && reads_of(speaker(model), 1, &left).load[load]);
	}
	for (int x = 0; model->switching && x < model->switching->expressions; x++)
		for (int k = 0; k < system->load[load].columns; k++)
			needed = needed || mpq_sgn(model->switching->expression[x].row->load[load][k]) != 0;
	for (int x = 0; model->switching && x < model->switching->systems; x++)
		needed = needed || load_acts(&model->switching->system[x], &model->switching->system[x].load[load]);
	for (int o = 0; o < model->n; o++)
		for (int k = 0; model->highest && model->highest[o] && k < system->load[load].columns * system->segments; k++)
			needed = needed || mpq_sgn(model->highest[o]->load[load][k]) != 0;
	for (int o = 0; o < model->outputs; o++)
		for (int k = 0; k < system->load[load].columns * system->segments; k++)
			needed = needed || mpq_sgn(model->output[o].load[load][k]) != 0;
	return needed;
}

static struct emitter emitter_new(FILE *to, const struct step *step, const char *options)
{
	struct emitter e = { .to = to, .step = step, .model = step->model, .system = &step->branch->system, .options = options };
	size_t loads = (size_t)e.system->loads;
	e.name = step->model->name;
	e.upper = upper_case(e.name);
	e.phase = ARRAY(int, loads);
	e.growth = ARRAY(int, loads);
	for (size_t l = 0; l < loads; l++) {
		const struct wave *wave = e.system->load[l].wave;
		bool needed = e.model->tuning || load_is_needed(e.model, e.system, (int)l);
		e.phase[l] = needed && oscillates(wave) ? e.phases++ : -1;
		e.growth[l] = needed && mpq_sgn(wave->a) != 0 ? e.growths++ : -1;
	}
	for (int i = 0; i < e.system->inputs; i++)
		e.ramps = e.ramps || e.system->input[i].first_order;
	e.local = ARRAY(const char *, (size_t)e.system->states);
	e.c = identifiers_of(step->model, e.upper, e.local);
	return e;
}

static void emit_run(const struct emitter *e)
{
	bool inputs = e->system->inputs > 0;
	say(e, "\nvoid $n_run($n *s, size_t n, %sdouble *out)\n"
	       "{\n"
	       "    for (; n > 0; n--) {\n", inputs ? "const double *u, " : "");
	if (inputs)
		say(e, "        $n_step(s, u);\n"
		       "        u += $N_INPUTS;\n");
	else
		say(e, "        $n_step(s);\n");
	say(e, "        if (out) {\n"
	       "            $n_out(s, out);\n"
	       "            out += $N_OUTPUTS;\n"
	       "        }\n"
	       "    }\n"
	       "}\n");
}

/* Does an output read an acceleration that something left over acts on? */
static bool reads_channels(const struct model *model)
{
	bool any = false;
	for (int i = 0; i < model->outputs + model->n; i++) {
		const struct output *output = i < model->outputs ? &model->output[i] : model->highest[i - model->outputs];
		for (int c = 0; output && c < model->channels; c++)
			any = any || mpq_sgn(output->channel[c]) != 0;
	}
	return any;
}

void emit_header(FILE *to, const struct step *step, const char *options, bool rhs)
{
	struct emitter e = emitter_new(to, step, options);
	emit_banner(&e);
	emit_declarations(&e, rhs);
}

static bool needs_math(const struct emitter *e, bool rhs)
{
	bool math = false;
	for (int i = 0; i < e->model->outputs; i++) {
		const struct form *left = e->model->output[i].left;
		math = math || (left && reads_of(speaker(e->model), 1, &left).math);
	}
	for (int k = 0; k < e->model->operators; k++)
		math = math || reads_of(e->model, e->model->channels, (const struct form *const *)e->model->operator[k].left).math;
	if (e->model->selector)
		math = math || reads_of(e->model, 1, &e->model->selector).math;
	return math || (rhs && rhs_needs_math(e));
}

void emit_code(FILE *to, const struct step *step, const char *options, const char *header_name, bool rhs)
{
	struct emitter e = emitter_new(to, step, options);
	emit_banner(&e);
	if (header_name)
		say(&e, "#include \"%s\"\n", header_name);
	else
		emit_declarations(&e, rhs);
	if (needs_math(&e, rhs))
		say(&e, "\n#include <math.h>\n");
	if (step->program->compensated || step->carries)
		say(&e, "\n#if PL_EXCESS_PRECISION%s\n"
		       "#error \"two-word arithmetic needs sums that have the bits of their type: on x86 compile it with -msse2 -mfpmath=sse\"\n"
		       "#endif\n", step->model->asked.single ? "F" : "");
	emit_phi(&e);
	if (e.system->inputs)
		emit_gamma(&e);
	emit_load_tables(&e);
	if (step->model->tuning)
		emit_nominal(&e);
	if (e.system->segments > 1)
		emit_changes(&e);
	if (step->model->switching) {
		emit_regions(&e);
		emit_region_start(&e);
	}
	emit_access(&e);
	if (step->model->tuning)
		emit_retune(&e);
	else if (e.system->segments > 1)
		emit_passing(&e);
	if (step->model->switching && reads_channels(step->model))
		emit_leftover_functions(&e);
	if (step->model->switching) {
		emit_region_step(&e);
	} else if (has_leftover(step)) {
		emit_leftover_functions(&e);
		emit_leftover_step(&e);
	} else {
		emit_step(&e);
	}
	emit_out(&e);
	emit_run(&e);
	if (step->model->switching)
		emit_region_at(&e);
	else if (step->model->tuning)
		emit_tuned_at(&e);
	else if (step->series.emitted)
		emit_at(&e);
	if (has_jump(&e))
		emit_jump(&e);
	if (e.model->asked.selftest)
		emit_selftest(&e, has_jump(&e));
	if (rhs)
		emit_rhs(&e);
	emit_descriptor(&e);
}
