/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Newton's method on the highest derivatives at the nodes of a collocation. */
#include "emit/emit.h"

#include <math.h>

static const struct collocation *collocation(const struct emitter *e)
{
	return e->step->collocation;
}

static const struct motion *motion(const struct emitter *e)
{
	return e->step->motion;
}

int unknowns_of_stages(const struct emitter *e)
{
	return collocation(e)->stages * motion(e)->coords;
}

/* So many unknowns that the elimination is written out; else it loops */
static bool writes_out(const struct emitter *e)
{
	enum { WRITTEN_OUT = 10 };
	return unknowns_of_stages(e) <= WRITTEN_OUT;
}

/* ---- tables ---- */

static void emit_stage_rows(const struct emitter *e, const char *name, const char *note, const double *value)
{
	int s = collocation(e)->stages;
	say(e, "\n/* %s */\n"
	       "static const double $n_%s[%d][%d] = {\n", note, name, s, s);
	for (int i = 0; i < s; i++) {
		say(e, "    {");
		for (int j = 0; j < s; j++)
			say(e, "%s%s", j == 0 ? "" : j % 5 ? ", " : ",\n     ", shortest(value[i * s + j]));
		say(e, "},\n");
	}
	say(e, "};\n");
}

void emit_stage_tables(const struct emitter *e)
{
	const struct collocation *x = collocation(e);
	say(e, "\nstatic const double $n_node[%d] = {  /* of a step, as parts of it */\n    ", x->stages);
	for (int i = 0; i < x->stages; i++)
		say(e, "%s%s", i == 0 ? "" : i % 5 ? ", " : ",\n    ", shortest(x->node[i]));
	say(e, "\n};\n");
	emit_stage_rows(e, "once", "Integrals from 0 to each node of what is 1 at one node and 0 at the "
				   "others", x->once);
	emit_stage_rows(e, "twice", "... integrated twice", x->twice);
	emit_stage_rows(e, "monomial", "The same in powers of time, from the constant on", x->monomial);
}

/* ---- one iteration, written out ---- */

/* sum over j of row[j] k_j of one coordinate */
static const char *stage_sum(const struct emitter *e, const double *row, int coord)
{
	int s = collocation(e)->stages, n = motion(e)->coords;
	const char **term = ARRAY(const char *, (size_t)s);
	for (int j = 0; j < s; j++)
		term[j] = format("%s * k%d", shortest(row[j]), j * n + coord);
	return tree(s, term, 16);
}

static void emit_stage_state(const struct emitter *e, int i)
{
	const struct linear *system = e->system;
	say(e, "    double y%d[$N_STATES], left%d[%d], slope%d[%d];\n", i, i, system->n, i,
	    motion(e)->entries ? motion(e)->entries : 1);
}

static void emit_stage_values(const struct emitter *e, int i)
{
	const struct collocation *x = collocation(e);
	const struct linear *system = e->system;
	for (int c = 0; c < system->n; c++) {
		const char *once = stage_sum(e, x->once + i * x->stages, c);
		int v = system->velocity[c];
		if (v < 0) {
			say(e, "    y%d[%d] = y[%d] + dt * (%s);\n", i, c, c, once);
			continue;
		}
		say(e, "    y%d[%d] = y[%d] + dt * (%s);\n", i, v, v, once);
		say(e, "    y%d[%d] = y[%d] + dt * (%s * y[%d] + dt * (%s));\n", i, c, c, shortest(x->node[i]), v,
		    stage_sum(e, x->twice + i * x->stages, c));
	}
	say(e, "    %s\n", linearize_call(e, format("node[%d]", i), format("y%d", i), format("left%d", i),
					 format("slope%d", i)));
	for (int k = 0; k < motion(e)->entries; k++)
		say(e, "    slope%d[%d] *= %s;\n", i, k, motion(e)->entry[k].twice ? "square" : "dt");
}

/* Of the matrix: 1 on the diagonal, less what a change of k_col makes of the force at node i; NULL: 0 */
static const char *matrix_entry_text(const struct emitter *e, int row, int col)
{
	const struct collocation *x = collocation(e);
	const struct motion *m = motion(e);
	int n = m->coords, i = row / n, j = col / n;
	const char *text = row == col ? "1.0" : "";
	for (int k = 0; k < m->entries; k++) {
		const struct motion_entry *entry = &m->entry[k];
		double factor = (entry->twice ? x->twice : x->once)[i * x->stages + j];
		if (entry->coord == row % n && entry->of == col % n)
			text = *text ? format("%s %s %s * slope%d[%d]", text, factor < 0 ? "+" : "-",
					      shortest(fabs(factor)), i, k)
				     : format("%s * slope%d[%d]", shortest(-factor), i, k);
	}
	return *text ? text : NULL;
}

/* m_row,col less what the rows before take; the factors of rows stand in m too */
static void emit_elimination(const struct emitter *e)
{
	int n = unknowns_of_stages(e);
	bool *there = ARRAY(bool, (size_t)(n * n));
	for (int i = 0; i < n; i++) {
		const char *right = format("left%d[%d] - k%d", i / motion(e)->coords, i % motion(e)->coords, i);
		for (int j = 0; j < n; j++) {
			const char *text = matrix_entry_text(e, i, j);
			for (int k = 0; k < i && k < j; k++)
				if (there[i * n + k] && there[k * n + j])
					text = format("%s - m%d_%d * m%d_%d", text ? text : "0.0", i, k, k, j);
			there[i * n + j] = text != NULL;
			if (!text)
				continue;
			say(e, "    const double m%d_%d = ", i, j);
			say_wrapped(e, format(j < i ? "(%s) * pivot%d;\n" : "%s;\n", text, j));
		}
		for (int k = 0; k < i; k++)
			if (there[i * n + k])
				right = format("%s - m%d_%d * right%d", right, i, k, k);
		say(e, "    const double pivot%d = 1.0 / m%d_%d;\n", i, i, i);
		say(e, "    const double right%d = ", i);
		say_wrapped(e, format("%s;\n", right));
	}
	for (int i = n - 1; i >= 0; i--) {
		const char *text = format("right%d", i);
		for (int j = n - 1; j > i; j--)
			if (there[i * n + j])
				text = format("%s - m%d_%d * d%d", text, i, j, j);
		say(e, "    const double d%d = ", i);
		say_wrapped(e, format("(%s) * pivot%d;\n", text, i));
	}
}

static void emit_change(const struct emitter *e)
{
	int n = unknowns_of_stages(e);
	for (int c = 0; c < motion(e)->coords; c++) {
		int v = e->system->velocity[c];
		if (v < 0)
			say(e, "    weight[%d] = dt * unit[%d];\n", c, c);
		else
			say(e, "    weight[%d] = dt * unit[%d] > square * unit[%d] ? dt * unit[%d] : square * "
			       "unit[%d];\n", c, v, c, v, c);
	}
	for (int i = 0; i < n; i++)
		say(e, "    k[%d] += d%d;\n"
		       "    size = pl_magnitude(d%d) * weight[%d];\n"
		       "    change = size > change || size != size ? size : change;\n",
		    i, i, i, i % motion(e)->coords);
}

static void emit_written_iteration(const struct emitter *e)
{
	int n = unknowns_of_stages(e), known = known_values(e);
	say(e, "\n/* One iteration of Newton's method on the highest derivatives k at the nodes of a step of dt [s]: "
	       "the "
	       "largest\n * change that it makes of the states, relative to their sizes */\n"
	       "static double $n_iterate(const double y[$N_STATES], %s%sdouble dt, const double unit[$N_STATES],\n"
	       "    double k[%d])\n"
	       "{\n", known ? format("const double node[%d][%d], ", collocation(e)->stages, known) : "",
	    interval_parameter(e), n);
	if (e->system->states > e->system->n)
		say(e, "    const double square = dt * dt;\n");
	say(e, "    double change = 0.0, size, weight[%d];\n", motion(e)->coords);
	for (int i = 0; i < n; i++)
		say(e, "%sk%d = k[%d]%s", i % 8 ? " " : "    const double ", i, i,
		    i == n - 1 || i % 8 == 7 ? ";\n" : ",");
	for (int i = 0; i < collocation(e)->stages; i++)
		emit_stage_state(e, i);
	for (int i = 0; i < collocation(e)->stages; i++)
		emit_stage_values(e, i);
	emit_elimination(e);
	emit_change(e);
	say(e, "    return change;\n"
	       "}\n");
}

/* ---- in loops ---- */

static void emit_entry_table(const struct emitter *e)
{
	const struct motion *m = motion(e);
	say(e, "\n/* Of each entry of the Jacobian: row, coordinate, whether it is by the coordinate and not by what "
	       "is one "
	       "below its\n * highest derivative */\n"
	       "static const short $n_entry[%d][3] = {\n    ", m->entries ? m->entries : 1);
	for (int k = 0; k < m->entries; k++)
		say(e, "%s{%d, %d, %d}", k == 0 ? "" : k % 8 ? ", " : ",\n    ", m->entry[k].coord, m->entry[k].of,
		    m->entry[k].twice);
	say(e, "%s\n};\n", m->entries ? "" : "{0, 0, 0}");
}

static void emit_stage_loop(const struct emitter *e)
{
	int s = collocation(e)->stages, n = motion(e)->coords;
	const char *state = highest_text(e, "c");
	say(e, "\n/* The state at node i of a step of dt [s] */\n"
	       "static void $n_stage(const double y[$N_STATES], double dt, int i, const double k[%d], double "
	       "stage[$N_STATES])\n"
	       "{\n"
	       "    int c, j;\n"
	       "    for (c = 0; c < %d; c++) {\n"
	       "        const int state = %s;\n"
	       "        double once = 0.0, twice = 0.0;\n"
	       "        for (j = 0; j < %d; j++) {\n"
	       "            once += $n_once[i][j] * k[j * %d + c];\n"
	       "            twice += $n_twice[i][j] * k[j * %d + c];\n"
	       "        }\n"
	       "        stage[state] = y[state] + dt * once;\n"
	       "        if (state != c)\n"
	       "            stage[c] = y[c] + dt * ($n_node[i] * y[state] + dt * twice);\n"
	       "    }\n"
	       "}\n", unknowns_of_stages(e), n, state, s, n, n);
}

/* The largest change, and k with it */
static void emit_loop_change(const struct emitter *e, const char *d)
{
	int s = collocation(e)->stages, n = motion(e)->coords;
	say(e, "    for (c = 0; c < %d; c++) {\n"
	       "        const int state = %s;\n"
	       "        double weight = dt * unit[state];\n"
	       "        if (state != c && dt * dt * unit[c] > weight)\n"
	       "            weight = dt * dt * unit[c];\n"
	       "        for (i = 0; i < %d; i++) {\n"
	       "            const double size = pl_magnitude(%s[i * %d + c]) * weight;\n"
	       "            k[i * %d + c] += %s[i * %d + c];\n"
	       "            change = size > change || size != size ? size : change;\n"
	       "        }\n"
	       "    }\n"
	       "    return change;\n"
	       "}\n", n, highest_text(e, "c"), s, d, n, n, d, n);
}

static void emit_iteration_head(const struct emitter *e, const char *further)
{
	int known = known_values(e);
	say(e, "\n/* One iteration of Newton's method on the highest derivatives k at the nodes of a step of dt [s]: "
	       "the "
	       "largest\n * change that it makes of the states, relative to their sizes */\n"
	       "static double $n_iterate(const double y[$N_STATES], %s%sdouble dt, const double unit[$N_STATES],\n"
	       "    %sdouble k[%d])\n"
	       "{\n", known ? format("const double node[%d][%d], ", collocation(e)->stages, known) : "",
	    interval_parameter(e), further, unknowns_of_stages(e));
}

static void emit_looped_iteration(const struct emitter *e)
{
	int all = unknowns_of_stages(e), s = collocation(e)->stages, n = motion(e)->coords;
	int entries = motion(e)->entries;
	emit_stage_loop(e);
	emit_entry_table(e);
	emit_iteration_head(e, "");
	say(e, "    double matrix[%d][%d], right[%d], change = 0.0;\n"
	       "    int pivot[%d], i, j, c;\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        double stage[$N_STATES], left[%d], slope_of[%d];\n"
	       "        $n_stage(y, dt, i, k, stage);\n"
	       "        %s\n", all, all, all, all, s, n, entries ? entries : 1,
	    linearize_call(e, "node[i]", "stage", "left", "slope_of"));
	say(e, "        for (c = 0; c < %d; c++) {\n"
	       "            const int row = i * %d + c;\n"
	       "            right[row] = left[c] - k[row];\n"
	       "            for (j = 0; j < %d; j++)\n"
	       "                matrix[row][j] = j == row ? 1.0 : 0.0;\n"
	       "        }\n"
	       "        for (c = 0; c < %d; c++) {\n"
	       "            const short *const entry = $n_entry[c];\n"
	       "            const double *const integral = entry[2] ? $n_twice[i] : $n_once[i];\n"
	       "            const double factor = slope_of[c] * (entry[2] ? dt * dt : dt);\n"
	       "            for (j = 0; j < %d; j++)\n"
	       "                matrix[i * %d + entry[0]][j * %d + entry[1]] -= factor * integral[j];\n"
	       "        }\n"
	       "    }\n", n, n, all, entries, s, n, n);
	say(e, "    if (!pl_factor(%d, matrix[0], pivot))\n"
	       "        return 1e30;\n"
	       "    pl_solve(%d, matrix[0], pivot, right);\n", all, all);
	emit_loop_change(e, "right");
}

/* ---- by the modes of the stages: systems of the size of the coordinates ---- */

static void emit_mode_tables(const struct emitter *e)
{
	const struct collocation *x = collocation(e);
	int s = x->stages;
	say(e, "\n/* Modes of the integrals: A v = z v, u A = z u; real and imaginary parts; the first is real */\n"
	       "static const double $n_mode[%d][2] = {\n", x->modes);
	for (int k = 0; k < x->modes; k++)
		say(e, "    {%s, %s},\n", shortest(x->mode[k].re), shortest(x->mode[k].im));
	say(e, "};\n");
	for (int side = 0; side < 2; side++) {
		say(e, "\n/* %s */\n"
		       "static const double $n_%s[%d][%d][2] = {\n",
		    side ? "v, of a pair twice, since its conjugate adds the same" : "u, with u v = 1",
		    side ? "from_mode" : "to_mode", x->modes, s);
		for (int k = 0; k < x->modes; k++) {
			const double *value = side ? x->mode[k].right : x->mode[k].left;
			say(e, "    {");
			for (int j = 0; j < s; j++)
				say(e, "%s{%s, %s}", j == 0 ? "" : j % 2 ? ", " : ",\n     ", shortest(value[2 * j]),
				    shortest(value[2 * j + 1]));
			say(e, "},\n");
		}
		say(e, "};\n");
	}
}

/* 1 - dt z J_v - dt^2 z^2 J_x for each z */
static void emit_split_factors(const struct emitter *e)
{
	int n = motion(e)->coords, pairs = collocation(e)->modes - 1, entries = motion(e)->entries;
	say(e, "\ntypedef struct $n_factors {  /* of the matrices of one step */\n"
	       "    double real[%d][%d], pair[%d][%d][%d][2];\n"
	       "    int pivot[%d][%d];\n"
	       "} $n_factors;\n"
	       "\n/* Of a step of dt [s]: 1, or 0 where one is singular */\n"
	       "static int $n_factorize(const double slope_of[%d], double dt, $n_factors *f)\n"
	       "{\n"
	       "    int i, j, c, good;\n", n, n, pairs, n, n, pairs + 1, n, entries ? entries : 1);
	say(e, "    for (i = 0; i < %d; i++)\n"
	       "        for (j = 0; j < %d; j++) {\n"
	       "            f->real[i][j] = i == j ? 1.0 : 0.0;\n"
	       "            for (c = 0; c < %d; c++) {\n"
	       "                f->pair[c][i][j][0] = i == j ? 1.0 : 0.0;\n"
	       "                f->pair[c][i][j][1] = 0.0;\n"
	       "            }\n"
	       "        }\n"
	       "    for (i = 0; i < %d; i++)\n"
	       "        for (c = 0; c < %d; c++) {\n"
	       "            const double a = dt * $n_mode[c][0], b = dt * $n_mode[c][1];\n"
	       "            const int twice = $n_entry[i][2];\n"
	       "            const double re = slope_of[i] * (twice ? a * a - b * b : a);\n"
	       "            const double im = slope_of[i] * (twice ? 2.0 * a * b : b);\n"
	       "            if (c == 0) {\n"
	       "                f->real[$n_entry[i][0]][$n_entry[i][1]] -= re;\n"
	       "            } else {\n"
	       "                f->pair[c - 1][$n_entry[i][0]][$n_entry[i][1]][0] -= re;\n"
	       "                f->pair[c - 1][$n_entry[i][0]][$n_entry[i][1]][1] -= im;\n"
	       "            }\n"
	       "        }\n", n, n, pairs, entries, pairs + 1);
	say(e, "    good = pl_factor(%d, f->real[0], f->pivot[0]);\n"
	       "    for (c = 0; c < %d; c++)\n"
	       "        good = pl_factor_complex(%d, f->pair[c][0][0], f->pivot[c + 1]) && good;\n"
	       "    return good;\n"
	       "}\n", n, pairs, n);
}

static void emit_split_iteration(const struct emitter *e)
{
	int s = collocation(e)->stages, n = motion(e)->coords, modes = collocation(e)->modes;
	emit_iteration_head(e, spell(e, "const $n_factors *f, "));
	say(e, "    double right[%d], d[%d], change = 0.0;\n"
	       "    int i, c, m;\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        double stage[$N_STATES], left[%d];\n"
	       "        $n_stage(y, dt, i, k, stage);\n"
	       "        %s\n"
	       "        for (c = 0; c < %d; c++) {\n"
	       "            right[i * %d + c] = left[c] - k[i * %d + c];\n"
	       "            d[i * %d + c] = 0.0;\n"
	       "        }\n"
	       "    }\n", unknowns_of_stages(e), unknowns_of_stages(e), s, n,
	    forces_call(e, "node[i]", "stage", "left"), n, n, n, n);
	say(e, "    for (m = 0; m < %d; m++) {\n"
	       "        double part[2 * %d];\n"
	       "        for (c = 0; c < %d; c++) {\n"
	       "            double re = 0.0, im = 0.0;\n"
	       "            for (i = 0; i < %d; i++) {\n"
	       "                re += $n_to_mode[m][i][0] * right[i * %d + c];\n"
	       "                im += $n_to_mode[m][i][1] * right[i * %d + c];\n"
	       "            }\n"
	       "            part[m ? 2 * c : c] = re;\n"
	       "            if (m)\n"
	       "                part[2 * c + 1] = im;\n"
	       "        }\n"
	       "        if (m)\n"
	       "            pl_solve_complex(%d, f->pair[m - 1][0][0], f->pivot[m], part);\n"
	       "        else\n"
	       "            pl_solve(%d, f->real[0], f->pivot[0], part);\n"
	       "        for (i = 0; i < %d; i++)\n"
	       "            for (c = 0; c < %d; c++)\n"
	       "                d[i * %d + c] += m ? $n_from_mode[m][i][0] * part[2 * c] - $n_from_mode[m][i][1] * "
	       "part[2 * c + 1]\n"
	       "                                   : $n_from_mode[m][i][0] * part[c];\n"
	       "    }\n", modes, n, n, s, n, n, n, n, s, n, n);
	emit_loop_change(e, "d");
}

/* ---- the whole ---- */

void emit_newton(const struct emitter *e)
{
	if (writes_out(e)) {
		emit_written_iteration(e);
		return;
	}
	if (!splits(e)) {
		emit_looped_iteration(e);
		return;
	}
	emit_stage_loop(e);
	emit_entry_table(e);
	emit_mode_tables(e);
	emit_split_factors(e);
	emit_split_iteration(e);
}
