/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models with rigid-body modes: states as written, and as they are kept. */
#include "emit/declarations.h"
#include "model/linear/relative.h"

/* The rate of a coordinate, over written values y; or what was gained of it, y being gains */
static const char *rate_text(const struct emitter *e, const struct form *rate, bool full)
{
	struct summands s = { 0 };
	for (int i = 0; i < rate->terms; i++) {
		const struct basis *basis = &rate->term[i].basis;
		const char *operand = basis->kind == BASIS_COORD ? format("y[%d]", basis->index) : NULL;
		if (operand || full)
			add_summand(&s, scaled(finite_number(e, rate->term[i].factor), operand));
	}
	return s.terms > 1 || *sum_of(&s, 12) == '-' ? format("(%s)", sum_of(&s, 12)) : sum_of(&s, 12);
}

/* What is kept at a coordinate, over the written ones or their velocities, which stand `shift` behind; in full, or what
 * varies of it */
static const char *kept_text(const struct emitter *e, const struct link *link, int coord, const int *at, bool full)
{
	const struct relative *r = e->model->relative;
	const char *own = format("y[%d]", at[coord]);
	struct summands s = { 0 };
	if (link->kind == LINK_PARENT) {
		bool rate = link->rate && coord < r->written->n && at[coord] >= r->written->n;
		const char *parent = rate ? rate_text(e, link->rate, full) : format("y[%d]", at[link->from]);
		const char *from = scaled(finite_number(e, link->ratio), parent);
		if (link->reversed)
			return format("%s - %s", from, own);
		return format(*from == '-' ? "%s - (%s)" : "%s - %s", own, from);
	}
	for (int k = 0; k < r->written->n && link->kind == LINK_CENTRE; k++)
		if (mpq_sgn(link->weight[k]) != 0)
			add_summand(&s, scaled(finite_number(e, link->weight[k]), format("y[%d]", at[k])));
	return link->kind == LINK_CENTRE ? sum_of(&s, 12) : own;
}

/* What the written one has gained since the last set: d is what was gained of what is kept, y of the others so far */
static const char *gain_text(const struct emitter *e, const struct link *link, int coord, const int *at,
			     const int *kept)
{
	const struct relative *r = e->model->relative;
	struct summands s = { 0 };
	if (link->kind == LINK_PARENT) {
		bool rate = link->rate && at[coord] >= r->written->n;
		const char *parent = rate ? rate_text(e, link->rate, false) : format("y[%d]", at[link->from]);
		const char *from = scaled(finite_number(e, link->ratio), parent);
		return format("%s %c d[%d]", from, link->reversed ? '-' : '+', kept[coord]);
	}
	add_summand(&s, format("d[%d]", kept[coord]));
	for (int k = 0; k < r->written->n && link->kind == LINK_CENTRE; k++)
		if (mpq_sgn(link->shift[k]) != 0)
			add_summand(&s, scaled(finite_number(e, link->shift[k]), format("d[%d]", kept[k])));
	return sum_of(&s, 12);
}

/* Places of positions (order 0) and velocities in the vector of states, -1: there is none; of velocities that stand
 * alone in `kept` too */
static void find_places(const struct emitter *e, int order, int *at, int *kept)
{
	const struct relative *r = e->model->relative;
	for (int j = 0; j < r->written->n; j++) {
		at[j] = order ? r->written->system.velocity[j] : j;
		kept[j] = !order ? j : r->link[j].velocity >= 0 ? r->link[j].velocity : e->system->velocity[j];
	}
}

static void emit_keep(const struct emitter *e, int order, const int *at, const int *kept, bool full)
{
	const struct relative *r = e->model->relative;
	for (int j = 0; j < r->written->n; j++) {
		const struct link plain = { .kind = LINK_NONE };
		const struct link *link = order && r->link[j].velocity >= 0 ? &plain : &r->link[j];
		if (at[j] >= 0)
			say(e, "    x[%d] = %s;  /* %s */\n", kept[j], kept_text(e, link, j, at, full),
			       e->model->names.state[kept[j]]);
	}
}

/* A coordinate that is measured from another comes after it. */
static void emit_gains(const struct emitter *e, int order, const int *at, const int *kept)
{
	const struct relative *r = e->model->relative;
	int n = r->written->n;
	for (int i = 0; i < n + r->links; i++) {
		int j = i < n ? i : r->sequence[i - n];
		bool alone = order && r->link[j].velocity >= 0, linked = !alone && r->link[j].kind == LINK_PARENT;
		if (at[j] >= 0 && !alone && r->link[j].kind != LINK_NONE && linked == (i >= n))
			say(e, "    y[%d] = %s;\n", at[j], gain_text(e, &r->link[j], j, at, kept));
	}
}

/* What is kept as it is written */
static void emit_unlinked(const struct emitter *e, int order, const int *at, const int *kept, bool gains)
{
	const struct relative *r = e->model->relative;
	for (int j = 0; j < r->written->n; j++)
		if (at[j] >= 0 && ((order && r->link[j].velocity >= 0) || r->link[j].kind == LINK_NONE))
			say(e, "    y[%d] = %c[%d];\n", at[j], gains ? 'd' : 'x', kept[j]);
}

static void emit_keeps(const struct emitter *e, const int *at, const int *kept, bool full)
{
	const int coords = e->model->relative->written->n;
	say(e, "\n/* x: rigid-body and relative coordinates, from the states y as written */\n"
	       "static void $n_keep%s(const double y[$N_STATES], double x[$N_STATES])\n"
	       "{\n", full ? "" : "_d");
	for (int order = 0; order < 2; order++)
		emit_keep(e, order, at + order * coords, kept + order * coords, full);
	say(e, "}\n");
}

/* y, from the gains d */
static void emit_all_gains(const struct emitter *e, const int *at, const int *kept)
{
	const int coords = e->model->relative->written->n;
	for (int order = 0; order < 2; order++) {
		emit_unlinked(e, order, at + order * coords, kept + order * coords, true);
		emit_gains(e, order, at + order * coords, kept + order * coords);
	}
}

/* NAME_keep, NAME_written: a state is what it was at the last set, and what it has gained since; so get gives what set
 * was given. NAME_keep_d, NAME_written_d: of derivatives, which are all gain. */
void emit_conversions(const struct emitter *e)
{
	const int coords = e->model->relative->written->n;
	int *at = ARRAY(int, 2 * (size_t)coords), *kept = ARRAY(int, 2 * (size_t)coords);
	find_places(e, 0, at, kept);
	find_places(e, 1, at + coords, kept + coords);
	emit_keeps(e, at, kept, true);
	say(e, "\n/* And back: what they were at the last set, and what was gained since */\n"
	       "static void $n_written(const $n *s, const double x[$N_STATES], double y[$N_STATES])\n"
	       "{\n"
	       "    double d[$N_STATES];\n"
	       "    int i;\n"
	       "    for (i = 0; i < $N_STATES; i++) { d[i] = x[i] - s->from[i]; }\n");
	emit_all_gains(e, at, kept);
	say(e, "    for (i = 0; i < $N_STATES; i++) { y[i] += s->set[i]; }\n");
	for (int order = 0; order < 2 && !e->step->forced; order++)
		emit_unlinked(e, order, at + order * coords, kept + order * coords, false);
	say(e, "}\n");
	const struct derivatives *d = e->step->derivatives;
	if (d && d->varied)
		emit_keeps(e, at, kept, false);
	if (!d || !d->varied || d->regions)     /* steps of changing loads are of states as written */
		return;
	say(e, "\n/* And back */\n"
	       "static void $n_written_d(const double d[$N_STATES], double y[$N_STATES])\n"
	       "{\n");
	emit_all_gains(e, at, kept);
	say(e, "}\n");
}
