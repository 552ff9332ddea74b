/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pieces of a step between the shortest and the whole, as C: of regions, and of linear parts, whose fastest pole turns
 * far in it. */
#include "inner.h"
#include "emit/text.h"
#include "model/regions/regions.h"
#include "step/regions/guards.h"

/* ---- how many ---- */

/* Of a branch: as many as it has, or as an instance has room for */
static int room_of(const struct emitter *e, int branch)
{
	return e->model->params.retuned ? room_for_rungs(e->step) : e->step->branch[branch].rungs;
}

int rungs_of_all(const struct emitter *e)
{
	int all = 0;
	for (int k = 0; k < e->step->branches; k++)
		all += room_of(e, k);
	return all;
}

/* ---- tables ---- */

/* Where the rungs of each matrix begin, which is fixed */
void emit_ladder_places(const struct emitter *e, const struct guards *g)
{
	int *first = ARRAY(int, (size_t)e->step->branches), next = 0;
	for (int k = 0; k < e->step->branches; next += room_of(e, k++))
		first[k] = next;
	if (!has_ladder(e->step))
		return;
	put_wholes(e, false, "first_rung",
		     "Number of the first, shortest, piece of each linear system in rungs", e->step->branches, first);
	if (g)
		put_wholes(e, false, "guard_rung",
			     "Number of the first row of bend for each guard function", g->rows, g->reach_at);
}

void emit_spacing(const struct emitter *e)
{
	int *spacing = ARRAY(int, (size_t)e->step->branches);
	for (int k = 0; k < e->step->branches; k++)
		spacing[k] = e->step->branch[k].spacing;
	if (has_ladder(e->step))
		put_wholes(e, e->model->params.retuned, "spacing",
			     "Each longer piece is 2^spacing times as long as the one before",
			     e->step->branches, spacing);
}

static const char **names_of_rung(const struct emitter *e)
{
	int size = e->step->layout.size;
	const char **name = layout_names(&e->step->layout, e->system, e->model);
	const char **all = ARRAY(const char *, 2 * (size_t)size + 1);
	for (int i = 0; i < 2 * size; i++)
		all[i] = name[i % size];
	if (!is_compensated(e))
		all[size] = "what stays";
	return all;
}

static int rows_of_rung(const struct emitter *e)
{
	return is_compensated(e) ? 2 * e->step->layout.size : e->step->layout.size + 1;
}

static void emit_rungs(const struct emitter *e, const struct pieces *pieces)
{
	int size = e->step->layout.size, rows = rows_of_rung(e), count = 0;
	double *none = ARRAY(double, (size_t)rows * (size_t)size), **rung = ARRAY(double *, (size_t)rungs_of_all(e));
	for (int k = 0; k < e->step->branches; k++)
		for (int r = 0; r < room_of(e, k); r++)
			rung[count++] = r < e->step->branch[k].rungs ? pieces->piece[k].rung[r] : none;
	put_matrices(e, "rungs",
		      format("Transfer matrices of pieces shorter than h, of the shortest first: e^{A d}%s",
			     is_compensated(e) ? " - I in two words" : ", less I where the last row has 1"),
		      count, rows, size, rung, names_of_rung(e));
}

static int rows_of_reach(const struct emitter *e, const struct guards *g)
{
	return g ? g->reaches : rungs_of_all(e) * e->model->switching->functions;
}

/* Of switching functions: of each matrix as many rows for each as it has rungs, and the rest of its room behind them */
static double *reach_of_all(const struct emitter *e, const struct pieces *pieces)
{
	int size = e->step->layout.size, functions = e->model->switching->functions, at = 0;
	double *reach = ARRAY(double, (size_t)(rungs_of_all(e) * functions * size));
	for (int k = 0; k < e->step->branches; k++) {
		for (int i = 0; i < e->step->branch[k].rungs * functions * size; i++)
			reach[at + i] = pieces->piece[k].reach[i];
		at += room_of(e, k) * functions * size;
	}
	return reach;
}

static void emit_reach_of(const struct emitter *e, const struct pieces *pieces, const struct guards *g)
{
	int rows = rows_of_reach(e, g), size = e->step->layout.size;
	const char **note = ARRAY(const char *, (size_t)rows);
	for (int i = 0; i < rows; i++)
		note[i] = "over the next longer one";
	put_matrix(e, "bend",
		   "How far an event or guard function leaves its chord within such a piece, at most: this row "
		   "times |x''|",
		   rows, size,
		   g ? g->reach : reach_of_all(e, pieces), note);
}

void emit_ladder(const struct emitter *e, const struct pieces *pieces, const struct guards *g)
{
	if (!has_ladder(e->step))
		return;
	emit_rungs(e, pieces);
	if (rows_of_reach(e, g) > 0)
		emit_reach_of(e, pieces, g);
}

/* ---- in the descriptor ---- */

const char *ladder_text(const struct emitter *e, const struct guards *g)
{
	if (!has_ladder(e->step))
		return "{NULL, NULL, NULL, NULL, NULL}";        /* where no piece is halved it is not read */
	return format("{PL(first_rung), PL_OF(spacing), PL_OF(rungs)[0][0], PL_OF%s, PL(%s)}",
		      rows_of_reach(e, g) > 0 ? "(bend)[0]" : "(slopes)[0][0]", g ? "guard_rung" : "first_rung");
}
