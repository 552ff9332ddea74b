/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beside the collocation the Taylor series: what the runtime (switches.h) is told of it. */
#include "emit/emit.h"

#include <math.h>

/* ---- where the series is bounded by stability ---- */

/* -J_ii + sum over j of |J_ij| of one kind of the entries of row i; NULL: it has none */
static const char *row_bound(const struct emitter *e, int coord, bool twice)
{
	const struct motion *m = e->step->motion;
	const char **term = ARRAY(const char *, (size_t)m->entries + 1);
	int terms = 0;
	for (int k = 0; k < m->entries; k++) {
		const struct motion_entry *entry = &m->entry[k];
		if (entry->coord != coord || entry->twice != twice)
			continue;
		term[terms++] = !twice && entry->of == coord ? format("-slope_of[%d]", k)
							     : format("pl_magnitude(slope_of[%d])", k);
	}
	return terms ? tree(terms, term, 12) : NULL;
}

/* Of Gershgorin's circles how far they reach to the left; of the derivatives by coordinates, which are squared rates,
 * their size */
static void emit_bound_rates(const struct emitter *e)
{
	int n = e->system->n;
	say(e, "\n/* Bounds on how fast the motion may decay [1/s], and on the square of how fast it may turn: "
	       "Gershgorin's */\n"
	       "static void $n_bound_rates(const double slope_of[], double rates[2])\n"
	       "{\n"
	       "    double size;\n");
	for (int i = 0; i < 2 * n; i++) {
		const char *bound = row_bound(e, i / 2, i % 2);
		if (bound)
			say(e, "    size = %s;\n"
			       "    rates[%d] = size > rates[%d] ? size : rates[%d];\n", bound, i % 2, i % 2, i % 2);
	}
	say(e, "    (void)size;\n"
	       "    (void)slope_of;\n"
	       "    (void)rates;\n"
	       "}\n");
}

/* ---- what it is told ---- */

void emit_series_beside(const struct emitter *e)
{
	emit_series_functions(e);
	emit_series_ahead(e);
	emit_hidden_table(e);
	emit_bound_rates(e);
}

/* ---- which is next ---- */

/* How many series a step of the collocation is worth, by what they cost; some less, so that they do not take turns */
static double worth(const struct emitter *e)
{
	const struct collocation *x = e->step->collocation;
	double iterations = 2.2 + splits(e) * 3, series = e->step->program->multiplications;
	double step = iterations * e->step->iteration.multiplications + 4.0 * x->stages * x->stages * e->system->n;
	double ratio = floor(step / series * 12) / 16;
	return ratio < 1 ? 1 : ratio > 8 ? 8 : ratio;
}

void emit_switching_limits(const struct emitter *e)
{
	say(e, "#define PL_MEASURED %d  /* columns behind the states whose last terms count too */\n"
	       "#define PL_WORTH %s  /* so many series a step of the collocation costs */\n"
	       "#define PL_CHOICES %d\n"
	       "#define PL_UNSEEN %d\n"
	       "#define PL_SLOPES %d\n", e->step->expansion->measured, shortest(worth(e)), has_choices(e),
	    has_unseen(e), e->step->slopes != NULL);
	if (has_unseen(e))
		emit_unseen_sizes(e);
}
