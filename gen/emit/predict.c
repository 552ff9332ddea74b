/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predictors of a quadrature: Runge and Kutta in y' = A y + B r, the loads' part exact. */
#include "emit/emit.h"

bool adds_driven(const struct emitter *e)
{
	const struct program *program = e->step->program;
	for (int i = 0; i < program->nodes; i++)
		if (program->node_table[i] != NONE)
			return true;
	return false;
}

static int add_terms(const struct coefficient *row, int columns, const char *vector, const char **term)
{
	int terms = 0;
	for (int j = 0; j < columns; j++)
		if (!row[j].zero)
			term[terms++] = scaled(row[j].value, format("%s[%d]", vector, j));
	return terms;
}

static void emit_unrolled_slope(const struct emitter *e)
{
	int states = e->system->states, channels = e->model->channels;
	const struct slopes slopes = state_slopes(e->step, 0);
	bool reads = false;
	for (int i = 0; i < states; i++) {
		const char **term = ARRAY(const char *, (size_t)(states + channels) + 1);
		int terms = add_terms(slopes.A + i * states, states, "z", term);
		reads = reads || terms > 0;
		terms += add_terms(slopes.B + i * channels, channels, "left", term + terms);
		const char *sum = terms ? tree(terms, term, 12) : "0.0";
		say(e, "    dz[%d] = %s;  /* %s' */\n", i, sum, e->model->state_name[i]);
	}
	if (!reads)
		say(e, "    (void)z;\n");
}

static void emit_slope(const struct emitter *e)
{
	int channels = e->model->channels;
	say(e, "\n/* dz = A z + B r, r what is left over */\n"
	       "static void $n_slope_of(%sconst double z[$N_STATES], const double left[%d], double dz[$N_STATES])\n"
	       "{\n", many_operators(e) ? "int which, " : "", channels);
	if (e->step->program->loops)
		say(e, "    pl_multiply($N_STATES, $N_STATES, %s, z, dz);\n"
		       "    pl_multiply_add($N_STATES, %d, %s, left, dz);\n", matrix_text(e, "A"), channels,
		    matrix_text(e, "B"));
	else
		emit_unrolled_slope(e);
	say(e, "}\n");
}

static void emit_predictor_head(const struct emitter *e, const struct reads *r)
{
	bool driven = adds_driven(e);
	say(e, "\n/* One step of Runge and Kutta of length tau on all but the loads, whose exact part is added%s */\n",
	    driven ? "" : " (there are none)");
	say(e, "static void $n_predict(%s%s, double tau, const double first[$N_STATES]",
	    leftover_parameters(e, r, false), needs_node(e, r) ? ", int half, int end" : "");
	if (driven)
		say(e, ", const double middle[$N_STATES], const double last[$N_STATES]");
	say(e, ", double y[$N_STATES])\n"
	       "{\n");
}

/* RK4 in z' = A z + r(t, z + what the loads have added so far) */
void emit_predictor(const struct emitter *e)
{
	struct reads r = reads_of_leftover(e);
	bool driven = adds_driven(e);
	emit_slope(e);
	emit_predictor_head(e, &r);
	say(e, "    static const double ahead[3] = {0.5, 0.5, 1.0}, weight[3] = {2.0, 2.0, 1.0};\n"
	       "    double z[$N_STATES], dz[$N_STATES], sum[$N_STATES], left[%d];\n"
	       "    int i, k;\n"
	       "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        dz[i] = first[i];\n"
	       "        sum[i] = first[i];\n"
	       "    }\n", e->model->channels);
	say(e, "    for (k = 0; k < 3; k++) {\n"
	       "        for (i = 0; i < $N_STATES; i++) {\n"
	       "            z[i] = s->y[i] + ahead[k] * tau * dz[i];\n"
	       "            y[i] = z[i]%s;\n"
	       "        }\n"
	       "        %s\n"
	       "        $n_slope_of(%sz, left, dz);\n"
	       "        for (i = 0; i < $N_STATES; i++) { sum[i] += weight[k] * dz[i]; }\n"
	       "    }\n", driven ? " + (k < 2 ? middle[i] : last[i])" : "",
	    leftover_call(e, "k < 2 ? half : end", "y", "left", FROM_INSIDE), many_operators(e) ? "which, " : "");
	say(e, "    for (i = 0; i < $N_STATES; i++) { y[i] = s->y[i] + tau / 6.0 * sum[i]%s; }\n"
	       "}\n", driven ? " + last[i]" : "");
}
