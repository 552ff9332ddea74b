/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of steps in normal modes: known loads, to which modes respond exactly. */
#include "emit/emit.h"

int wave_values(const struct emitter *e)
{
	return 2 * e->model->split->waves;
}

/* Of e^{a t} alone there is no sin. */
static bool is_there(const struct emitter *e, int value)
{
	return value % 2 == 0 || oscillates(e->model->split->wave[value / 2].wave);
}

/* NAME_waves: cos and sin of each now, times e^{a t} */
void emit_waves(const struct emitter *e)
{
	int count = wave_values(e);
	const struct form **form = ARRAY(const struct form *, (size_t)count + 1);
	if (count == 0)
		return;
	for (int k = 0; k < count; k++)
		form[k] = form_unit((struct basis){ .kind = BASIS_WAVE, .wave = e->model->split->wave[k / 2].wave,
						    .sine = k % 2 && is_there(e, k) });
	struct reads r = reads_of(e->model, count, form);
	say(e, "\n/* Known loads now */\n"
	       "static void $n_waves(const $n *s, double wave[%d])\n"
	       "{\n", count);
	emit_load_states(e, r.load, false);
	for (int k = 0; k < count; k++)
		say(e, "    wave[%d] = %s;\n", k, is_there(e, k) ? basis_now(e, &form[k]->term[0].basis) : "0.0");
	say(e, "}\n");
}

/* Where a step has them */
const char *wave_array(const struct emitter *e)
{
	return wave_values(e) ? format("    double wave[%d];\n", wave_values(e)) : "";
}

void emit_waves_now(const struct emitter *e)
{
	if (wave_values(e) > 0)
		say(e, "    $n_waves(s, wave);\n");
}

const char *emit_wave_table(const struct emitter *e, const char *name, const struct normal_stage *stage)
{
	int count = wave_values(e);
	return count ? emit_bank_table(e, name, "... and from known loads at its start", 2 * count,
				       normal_of_step(e)->width, stage->wave) : NULL;
}

void add_waves(const struct emitter *e, struct row_sum *s, const char *table, int row)
{
	for (int k = 0; k < wave_values(e); k++)
		if (is_there(e, k))
			add_summand(s, format("%s[%d][i] * wave[%d]", table, 2 * k + row, k));
}

/* Of a step by columns of one matrix, theirs from `first` on */
void add_waves_of_columns(const struct emitter *e, struct row_sum *s, int first)
{
	for (int k = 0; k < wave_values(e); k++)
		if (is_there(e, k))
			add_summand(s, spell(e, "$n_settled[%d][i] * wave[%d]", first + k, k));
}

/* Inside a step: the force of a term of the series, and the waves' next terms */
void emit_wave_force(const struct emitter *e, const char *table)
{
	struct row_sum s = { 0 };
	for (int k = 0; k < wave_values(e); k++)
		if (is_there(e, k))
			add_summand(&s, format("%s[%d][i] * swing[%d]", table, k, k));
	if (s.terms == 0)
		return;
	say(e, "            for (i = 0; i < %d; i++)\n"
	       "                force[i] += %s;\n", normal_of_step(e)->width, tree(s.terms, s.term, 28));
	for (int k = 0; k < e->model->split->waves; k++) {
		const struct wave *wave = e->model->split->wave[k].wave;
		const char *a = shortest(equation_number(e->model, wave->a).value);
		const char *w = shortest(equation_number(e->model, wave->w).value);
		if (!is_there(e, 2 * k + 1)) {
			say(e, "            swing[%d] *= by * %s;\n"
			       "            wave[%d] += swing[%d];\n", 2 * k, a, 2 * k, 2 * k);
			continue;
		}
		bool grows = mpq_sgn(wave->a) != 0;
		say(e, "            {\n"
		       "                const double c = swing[%d];\n"
		       "                swing[%d] = by * (%s%s * swing[%d]);\n"
		       "                swing[%d] = by * (%s%s * c);\n"
		       "                wave[%d] += swing[%d];\n"
		       "                wave[%d] += swing[%d];\n"
		       "            }\n", 2 * k, 2 * k, grows ? format("%s * c - ", a) : "-", w, 2 * k + 1, 2 * k + 1,
		    grows ? format("%s * swing[%d] + ", a, 2 * k + 1) : "", w, 2 * k, 2 * k, 2 * k + 1, 2 * k + 1);
	}
}
