/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of a collocation: its nodes, the integrals up to them, the modes of these, the places in the Jacobian. */
#include "emit/emit.h"

static const struct collocation *collocation(const struct emitter *e)
{
	return e->step->collocation;
}

static const struct motion *motion(const struct emitter *e)
{
	return e->step->motion;
}

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
	emit_entry_table(e);
	if (splits(e))
		emit_mode_tables(e);
}
