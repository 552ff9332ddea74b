/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_at of steps in normal modes: the step is made on a copy, for its forces; between them is their polynomial. */
#include "emit/emit.h"

#include <math.h>

/* Forces at nodes, that at the start first, become the polynomial's coefficients. */
static void emit_powers(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	int most = m->points ? m->points : m->stages, stages = m->stages;
	say(e, "\n/* Of polynomials through forces at the nodes of a step%s: powers 1 and up\n"
	       " * from what the other forces exceed that at the start by */\n"
	       "static const double $n_of_nodes[%d] = {", m->points ? ", and through past ones and the new one" : "",
	    stages * stages);
	say_numbers(e, stages * stages, m->within.nodes);
	say(e, "};\n");
	if (m->points) {
		say(e, "static const double $n_of_past[%d] = {", most * most);
		say_numbers(e, most * most, m->within.past);
		say(e, "};\n");
	}
	say(e, "\nstatic void $n_powers(int degree, const double *factor, double force[][%d])\n"
	       "{\n"
	       "    double rise[%d][%d];\n"
	       "    int i, j, k;\n"
	       "    for (k = 0; k < degree; k++)\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            rise[k][i] = force[k + 1][i] - force[0][i];\n"
	       "    for (j = 1; j <= degree; j++)\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            double sum = 0.0;\n"
	       "            for (k = 0; k < degree; k++)\n"
	       "                sum += factor[(j - 1) * degree + k] * rise[k][i];\n"
	       "            force[j][i] = sum;\n"
	       "        }\n"
	       "}\n", m->width, most, m->width, m->width, m->width);
}

/* The force of a term of the series: a power of the polynomial; once nothing changes, what acts on the term */
static void emit_term_force(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	const char *indent = m->settled ? "    " : "";
	if (m->settled)
		say(e, "            if (f)\n"
		       "                $n_forces(s, which, f, x, v, force);\n"
		       "            for (i = 0; f && i < %d; i++)\n"
		       "                force[i] -= k ? still[i] : 0.0;\n"
		       "            if (!f)\n", m->width);
	say(e, "%s            for (i = 0; i < %d; i++)\n"
	       "%s                force[i] = k <= degree ? scale * power[k][i] : 0.0;\n", indent, m->width, indent);
}

/* eta and rate go on by tau. f: the functions of time that no longer change, else NULL */
static void emit_inside(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	int width = m->width;
	const char *stiffness = emit_bank_table(e, "stiffness", "lambda of each mode [1/s^2]", 0, width,
						m->within.stiffness);
	const char *damping = m->within.damping ? emit_bank_table(e, "damping", "2 delta of each mode [1/s]", 0, width,
								  m->within.damping) : NULL;
	const char *waves = wave_values(e) ? emit_bank_table(e, "swing", "Known loads: forces on modes",
							     wave_values(e), width, m->wave) : NULL;
	int parts = m->within.angle > 1 ? (int)ceil(m->within.angle) : 1;
	say(e, "\n/* Modes go on by tau, forces on them being polynomials%s: by series over parts of the\n"
	       " * time, in which no mode turns by more than 1 */\n"
	       "static void $n_inside(const $n *s, int which, double tau, int degree, double power[][%d],%s%s\n"
	       "    double eta[%d], double rate[%d])\n"
	       "{\n"
	       "    const double theta = tau / $N_H;\n"
	       "    const int parts = theta > 0.0 && theta < 1.0 ? 1 + (int)(theta * %d.0) : %d;\n"
	       "    const double d = theta / (double)parts;\n"
	       "    double x[%d], v[%d], force[%d];\n"
	       "    int i, j, k, part;\n", m->settled ? ", or all that acts" : "", width,
	    m->settled ? " const double *f," : "", wave_values(e) ? format(" double wave[%d],", wave_values(e)) : "",
	    width, width, parts, parts + 1, width, width, width);
	if (wave_values(e))
		say(e, "    double swing[%d];\n", wave_values(e));
	if (m->settled)
		say(e, "    double still[%d];\n"
		       "    for (i = 0; i < %d; i++)\n"
		       "        x[i] = v[i] = 0.0;\n"
		       "    if (f)\n"
		       "        $n_forces(s, which, f, x, v, still);\n", width, width);
	say(e, "    for (part = 0; part < parts; part++) {\n"
	       "        double scale = 1.0;\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            x[i] = eta[i];\n"
	       "            v[i] = rate[i];\n"
	       "        }\n", width);
	if (wave_values(e))
		say(e, "        for (i = 0; i < %d; i++)\n"
		       "            swing[i] = wave[i];\n", wave_values(e));
	say(e, "        for (k = 0; k < %d; k++) {\n"
	       "            const double by = d * $N_H / (double)(k + 1);\n", m->within.terms);
	emit_term_force(e);
	emit_wave_force(e, waves);
	say(e, "            for (i = 0; i < %d; i++) {\n"
	       "                const double next = by * (force[i] - %s[i] * x[i]%s);\n"
	       "                x[i] = by * v[i];\n"
	       "                v[i] = next;\n"
	       "                eta[i] += x[i];\n"
	       "                rate[i] += v[i];\n"
	       "            }\n"
	       "            scale *= d;\n"
	       "        }\n"
	       "        for (j = 0; j < degree; j++)  /* powers from the part's end on */\n"
	       "            for (k = degree - 1; k >= j; k--)\n"
	       "                for (i = 0; i < %d; i++)\n"
	       "                    power[k][i] += d * power[k + 1][i];\n"
	       "    }\n"
	       "    (void)s;\n"
	       "    (void)which;\n"
	       "}\n", width, stiffness, damping ? format(" - %s[i] * v[i]", damping) : "", width);
}

/* Past forces and the new one */
static void emit_at_past(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	say(e, "    if (s->known < %d) {\n"
	       "        $n_collocate(&next, force);\n"
	       "        $n_powers(%d, $n_of_nodes, force);\n"
	       "    } else {\n"
	       "        for (k = 0; k < %d; k++) {\n"
	       "            for (i = 0; i < %d; i++)\n"
	       "                force[k][i] = s->force[at][i];\n"
	       "            at = at ? at - 1 : %d;\n"
	       "        }\n"
	       "        $n_advance(&next, force[%d]);\n", m->points, m->stages, m->points, m->width, m->points - 1,
	    m->points);
	if (!m->twice)
		say(e, "        for (i = 0; i < %d; i++)\n"
		       "            force[%d][i] = next.force[next.newest][i];\n", m->width, m->points);
	say(e, "        $n_powers(%d, $n_of_past, force);\n"
	       "        degree = %d;\n"
	       "    }\n", m->points, m->points);
}

static void emit_at_settled(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	say(e, "    if (s->segment == %d) {\n"
	       "        double f[%d];\n"
	       "        $n_functions_at(s, 0, 0, f);\n", e->system->segments - 1, functions_of_time(e) + 1);
	if (has_bank(e))
		say(e, "        if (s->which != %d)\n"
		       "            $n_serve(&next, %d);\n", m->settled_bank, m->settled_bank);
	say(e, "        $n_inside(s, next.which, tau, 0, force, f%s, next.eta, next.rate);\n"
	       "        $n_of_modes(next.which, next.eta, y);\n"
	       "        $n_of_modes(next.which, next.rate, y + %d);\n"
	       "        return;\n"
	       "    }\n", wave_values(e) ? ", wave" : "", m->modes);
}

void emit_normal_at(const struct emitter *e)
{
	const struct normal *m = normal_of_step(e);
	int most = m->points ? m->points : m->stages;
	emit_powers(e);
	emit_inside(e);
	say(e, "\nvoid $n_at(const $n *s, double tau, double y[$N_STATES])\n"
	       "{\n"
	       "    $n next = *s;\n"
	       "    double force[%d][%d], eta[%d], rate[%d];\n"
	       "    int i, k, %sdegree = %d;\n%s", most + 1, m->width, m->width, m->width,
	    m->points ? "at = s->newest, " : "", m->stages, wave_array(e));
	emit_waves_now(e);
	if (m->settled)
		emit_at_settled(e);
	if (m->points)
		emit_at_past(e);
	else
		say(e, "    $n_collocate(&next);\n"
		       "    for (k = 0; k <= %d; k++)\n"
		       "        for (i = 0; i < %d; i++)\n"
		       "            force[k][i] = next.force[k][i];\n"
		       "    $n_powers(degree, $n_of_nodes, force);\n", m->stages, m->width);
	say(e, "    for (i = 0; i < %d; i++) {\n"
	       "        eta[i] = s->eta[i];\n"
	       "        rate[i] = s->rate[i];\n"
	       "    }\n"
	       "    $n_inside(s, s->which, tau, degree, force%s%s, eta, rate);\n"
	       "    $n_of_modes(s->which, eta, y);\n"
	       "    $n_of_modes(s->which, rate, y + %d);\n"
	       "}\n", m->width, m->settled ? ", NULL" : "", wave_values(e) ? ", wave" : "",
	    m->modes);
}
