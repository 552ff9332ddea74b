/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The recipes of the schemes: which numbers they take, and what they do with them. */
#include "inner.h"

/* Cox and Matthews 2002, (4): y+ = E y + p1 r0, p1 = h phi1(A h); also what pl does with terms that are not linear */
static void recipe_etd1(struct recipe *r)
{
	int full = add_table(r, "full", 1, 1, true), p1 = add_phi(r, full, "p1", 1, 1, 1, (long[]){ 1 });
	int r0 = add_remainder(r, add_node(r, 0, 1), STAGE_STATE);
	times_left(r, add_sum(r, STAGE_STATE, full, NONE, "y = E y + p1 r0"), full, p1, r0);
}

/* Cox and Matthews 2002, (22): a = E y + p1 r0; y+ = a + p2 (r(t+h, a) - r0) */
static void recipe_etdrk2(struct recipe *r)
{
	int full = add_table(r, "full", 1, 1, true), p1 = add_phi(r, full, "p1", 1, 1, 1, (long[]){ 1 });
	int p2 = add_phi(r, full, "p2", 1, 1, 2, (long[]){ 0, 1 }), a = new_stage(r);
	int r0 = add_remainder(r, add_node(r, 0, 1), STAGE_STATE);
	times_left(r, add_sum(r, a, full, NONE, "a = E y + p1 r0"), full, p1, r0);
	int ra = add_remainder(r, add_node(r, 1, 1), a), difference = add_combination(r, ra, r0, false);
	times_left(r, add_sum(r, STAGE_STATE, NONE, a, "y = a + p2 (r(t+h, a) - r0)"), full, p2, difference);
}

/* Cox and Matthews 2002, (26)-(29), with F a, in which loads would have to start anew at t + h/2, written as E y + F q1
 * r0 and the loads' exact part; F q1 = p1 - q1. */
static void recipe_etdrk4(struct recipe *r)
{
	int full = add_table(r, "full", 1, 1, true), half = add_table(r, "half", 1, 2, true);
	int q1 = add_phi(r, half, "q1", 1, 2, 1, (long[]){ 1 }), c0 = add_phi(r, full, "c0", 1, 1, 1, (long[]){ 1 });
	add_phi_part(r, full, c0, 1, 2, 1, (long[]){ -2 });
	int b1 = add_phi(r, full, "b1", 1, 1, 3, (long[]){ 1, -3, 2 });
	int b2 = add_phi(r, full, "b2", 1, 1, 3, (long[]){ 0, 2, -2 });
	int b3 = add_phi(r, full, "b3", 1, 1, 3, (long[]){ 0, -1, 2 });
	int start = add_node(r, 0, 1), middle = add_node(r, 1, 2), end = add_node(r, 1, 1);
	int flow = new_stage(r), a = new_stage(r), b = new_stage(r), c = new_stage(r);
	int r0 = add_remainder(r, start, STAGE_STATE);
	add_sum(r, flow, full, NONE, "w = E y");
	times_left(r, add_sum(r, a, half, NONE, "a = F y + q1 r0"), half, q1, r0);
	int ra = add_remainder(r, middle, a), step = add_combination(r, ra, r0, false);
	times_left(r, add_sum(r, b, NONE, a, "b = F y + q1 r(t+h/2, a)"), half, q1, step);
	int rb = add_remainder(r, middle, b), twice = add_combination(r, rb, NONE, false);
	struct action *sum = add_sum(r, c, NONE, flow, "c = F a + q1 (2 r(t+h/2, b) - r0)");
	times_left(r, sum, full, c0, r0);
	times_left(r, sum, half, q1, twice);
	int rc = add_remainder(r, end, c), both = add_combination(r, ra, rb, true);
	sum = add_sum(r, STAGE_STATE, NONE, flow, "y = E y + b1 r0 + b2 (r(t+h/2, a) + r(t+h/2, b)) + b3 r(t+h, c)");
	times_left(r, sum, full, b1, r0);
	times_left(r, sum, full, b2, both);
	times_left(r, sum, full, b3, rc);
}

/* ---- quadratures ---- */

/* Liu, Wang, Li, Yi 2022: y+ = E y + h sum w_i e^{A (1 - c_i) h} r(t + c_i h, Y_i), Y_i by one step of RK4 of length
 * c_i h; h w_i is folded into the matrices. */
struct quadrature {
	int count;
	struct {
		long p;                 /* c = p/q; w = weight/over */
		unsigned long q;
		long weight;
		unsigned long over;
	} node[4];
};

/* What the node of this stage predicts: r at it */
static int add_predicted(struct recipe *r, long p, unsigned long q)
{
	int half = add_node(r, p, 2 * q), end = add_node(r, p, q), stage = new_stage(r);
	if (is_driven(&r->step->branch->system)) {
		need_loads_at(r, half);
		need_loads_at(r, end);
	}
	add_action(r, (struct action){ .kind = ACTION_PREDICT, .target = stage, .node = end, .half = half });
	return add_remainder(r, end, stage);
}

static void add_quadrature(struct recipe *r, const struct quadrature *q)
{
	static const char *const names[] = { "w1", "w2", "w3", "w4" };
	int full = add_table(r, "full", 1, 1, true), phi_weight[4], left[4];
	int r0 = add_remainder(r, add_node(r, 0, 1), STAGE_STATE);
	r->program->predicts = true;
	for (int i = 0; i < q->count; i++) {
		long p = q->node[i].p;
		unsigned long over = q->node[i].q;
		phi_weight[i] =
			add_weighted(r, full, names[i], (long)over - p, over, q->node[i].weight, q->node[i].over);
		left[i] = p == 0 ? r0 : add_predicted(r, p, over);
	}
	struct action *sum = add_sum(r, STAGE_STATE, full, NONE, "y = E y + h sum of w_i e^{A (1 - c_i) h} r_i");
	for (int i = 0; i < q->count; i++)
		times_left(r, sum, full, phi_weight[i], left[i]);
}

static void recipe_nc2(struct recipe *r)
{
	add_quadrature(r, &(struct quadrature){ 3, { { 0, 1, 1, 6 }, { 1, 2, 2, 3 }, { 1, 1, 1, 6 } } });
}

static void recipe_nc3(struct recipe *r)
{
	add_quadrature(r,
		       &(struct quadrature){ 4, { { 0, 1, 1, 8 }, { 1, 3, 3, 8 }, { 2, 3, 3, 8 }, { 1, 1, 1, 8 } } });
}

/* The weight at 1 is 0. */
static void recipe_dq4(struct recipe *r)
{
	add_quadrature(r, &(struct quadrature){ 3, { { 1, 4, 2, 3 }, { 1, 2, -1, 3 }, { 3, 4, 2, 3 } } });
}

static void recipe_bm3(struct recipe *r)
{
	add_quadrature(r,
		       &(struct quadrature){ 4, { { 0, 1, 1, 18 }, { 1, 4, 4, 9 }, { 3, 4, 4, 9 }, { 1, 1, 1, 18 } } });
}

/* ---- which is whose ---- */

static void recipe_none(struct recipe *r)
{
	internal_error(r->step, "there is a remainder, and it has no recipe");
}

#define SCHEME(id, recipe, ...) [SCHEME_##id] = recipe_##recipe,
void write_recipe(struct recipe *r)
{
	static void (*const recipe[SCHEMES])(struct recipe *) = {
#include "read/schemes.def"
	};
	recipe[r->step->model->scheme](r);
}
#undef SCHEME
