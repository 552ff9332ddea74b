/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scheme takes the equations apart into what is solved exactly and what is held over a step, and writes the step as
 * a program over the tables of the exact part. */
#include "step/step.h"

/* ---- pl ---- */

static mpq_t *normalized(int n, int segments, const mpq_t *inverse, const mpq_t *force)
{
	mpq_t *acceleration = rationals((size_t)segments * (size_t)n);
	for (int s = 0; s < segments; s++)
		rational_product(n, n, 1, inverse, force + s * n, acceleration + s * n);
	return acceleration;
}

static void normalize_loads(const struct linear *written, const mpq_t *inverse, struct linear *split)
{
	int n = written->n;
	split->loads = written->loads;
	split->load = ARRAY(struct load, (size_t)written->loads);
	for (int l = 0; l < written->loads; l++) {
		const struct load *load = &written->load[l];
		split->load[l] = *load;
		split->load[l].force = ARRAY(mpq_t *, (size_t)load->columns);
		for (int k = 0; k < load->columns; k++)
			split->load[l].force[k] = normalized(n, written->segments, inverse, (const mpq_t *)load->force[k]);
	}
	split->inputs = written->inputs;
	split->input = ARRAY(struct input, (size_t)written->inputs);
	for (int i = 0; i < written->inputs; i++) {
		split->input[i] = written->input[i];
		for (int k = 0; k < 2; k++)
			split->input[i].force[k] = normalized(n, 1, inverse, (const mpq_t *)written->input[i].force[k]);
	}
}

/* Fang, Wang, Dai, Zhang 2020: after division by the mass matrix the other coordinates and their velocities are held
 * at their value at the step's start; a coordinate's own terms, loads and inputs stay exact. */
static struct linear piecewise_laplace(const struct linear *written)
{
	int n = written->n, states = written->states, column;
	struct linear split = linear_like(written);
	mpq_t *inverse = rationals((size_t)(n * n)), *highest = rationals((size_t)(n * states));
	leading_inverse(written, inverse, &column);
	highest_derivatives(written, (const mpq_t *)inverse, false, highest);
	split.heldC = rationals((size_t)(n * n));
	split.heldK = rationals((size_t)(n * n));
	for (int i = 0; i < n; i++) {
		mpq_set_ui((written->velocity[i] >= 0 ? split.M : split.C)[i * n + i], 1, 1);
		for (int j = 0; j < states; j++) {
			bool own = written->coord[j] == i;
			mpq_t *matrix = j < n ? (own ? split.K : split.heldK) : own ? split.C : split.heldC;
			mpq_neg(matrix[i * n + written->coord[j]], highest[i * states + j]);
		}
	}
	normalize_loads(written, (const mpq_t *)inverse, &split);
	split.channels = written->channels;
	split.channel = ARRAY(mpq_t *, (size_t)written->channels);
	for (int e = 0; e < written->channels; e++)
		split.channel[e] = normalized(n, 1, inverse, (const mpq_t *)written->channel[e]);
	return split;
}

/* The modified equation of y+ = E y + h phi1 R y is y' = L y - (h/2) R L y + O(h^2), L = A + R: what is held lags by
 * half a step. */
static struct linear modified_equation(const struct linear *written, const struct linear *split, mpq_srcptr h)
{
	int states = split->states;
	mpq_t *L = state_matrix(written, false), *R = state_matrix(split, true), *RL = rationals((size_t)(states * states)), half;
	rational_product(states, states, states, (const mpq_t *)R, (const mpq_t *)L, RL);
	mpq_init(half);
	mpq_div_2exp(half, h, 1);
	for (int i = 0; i < states * states; i++) {
		mpq_mul(RL[i], RL[i], half);
		mpq_sub(L[i], L[i], RL[i]);
	}
	mpq_clear(half);
	return first_order_system(states, (const mpq_t *)L);
}

/* ---- schemes with a leftover: which numbers they take, and what they do with them ---- */

struct recipe {                     /* of one scheme, being written */
	struct program *program;
	int tables;
	struct wanted table[8];
	mpq_srcptr h;
};

static void set(mpq_ptr value, long p, unsigned long q)
{
	mpq_set_si(value, p, q);
	mpq_canonicalize(value);
}

static int add_table(struct recipe *r, const char *name, long p, unsigned long q, bool Phi)
{
	struct wanted *w = &r->table[r->tables];
	*w = (struct wanted){ .Phi = Phi, .name = name };
	mpq_init(w->fraction);
	set(w->fraction, p, q);
	return r->tables++;
}

static struct kernel_part *add_part(struct kernel *kernel, long p, unsigned long q)
{
	struct kernel_part *part = &kernel->part[kernel->parts++];
	mpq_inits(part->fraction, part->impulse, part->power[0], part->power[1], part->power[2], NULL);
	set(part->fraction, p, q);
	return part;
}

static struct kernel *add_kernel(struct recipe *r, int table, const char *name)
{
	struct wanted *w = &r->table[table];
	struct kernel *kernel = &w->kernel[w->kernels++];
	*kernel = (struct kernel){ .name = name };
	return kernel;
}

/* h (c0 phi1 + c1 phi2 + 2 c2 phi3) of A h as the response to c0 + c1 s/h + c2 (s/h)^2 */
static int add_phi(struct recipe *r, int table, const char *name, long p, unsigned long q, int powers, const long *c)
{
	struct kernel_part *part = add_part(add_kernel(r, table, name), p, q);
	part->powers = powers;
	for (int m = 0; m < powers; m++)
		set(part->power[m], c[m], 1);
	return r->table[table].kernels - 1;
}

static int add_node(struct recipe *r, long p, unsigned long q)
{
	struct program *program = r->program;
	mpq_t fraction;
	mpq_init(fraction);
	set(fraction, p, q);
	for (int i = 0; i < program->nodes; i++)
		if (mpq_equal(program->node[i], fraction))
			return i;
	ENLARGE(program->node, (size_t)program->nodes + 1);
	ENLARGE(program->node_table, (size_t)program->nodes + 1);
	mpq_init(program->node[program->nodes]);
	mpq_set(program->node[program->nodes], fraction);
	program->node_table[program->nodes] = NONE;
	mpq_clear(fraction);
	return program->nodes++;
}

static struct action *add_action(struct recipe *r, struct action action)
{
	struct program *program = r->program;
	ENLARGE(program->action, (size_t)program->actions + 1);
	program->action[program->actions] = action;
	return &program->action[program->actions++];
}

static int add_leftover(struct recipe *r, int node, int stage)
{
	add_action(r, (struct action){ .kind = ACTION_LEFTOVER, .target = r->program->lefts, .node = node, .from = stage });
	return r->program->lefts++;
}

static int add_combination(struct recipe *r, int plus, int minus, bool added)
{
	add_action(r, (struct action){ .kind = ACTION_COMBINE, .target = r->program->lefts, .plus = plus, .minus = minus, .added = added });
	return r->program->lefts++;
}

static int new_stage(struct recipe *r)
{
	return ++r->program->stages;
}

static struct action *add_sum(struct recipe *r, int stage, int flow, int plain, const char *note)
{
	return add_action(r, (struct action){ .kind = ACTION_SUM, .target = stage, .flow = flow, .plain = plain, .note = note });
}

static void times_left(struct action *sum, int table, int kernel, int left)
{
	sum->kernel[sum->kernels].table = table;
	sum->kernel[sum->kernels].kernel = kernel;
	sum->kernel[sum->kernels++].left = left;
}

/* Cox and Matthews 2002, (4): y+ = E y + p1 r0, p1 = h phi1(A h); also what pl does with terms that are not linear */
static void recipe_etd1(struct recipe *r)
{
	int full = add_table(r, "full", 1, 1, true), p1 = add_phi(r, full, "p1", 1, 1, 1, (long[]){ 1 });
	int r0 = add_leftover(r, add_node(r, 0, 1), STAGE_STATE);
	times_left(add_sum(r, STAGE_STATE, full, NONE, "y = E y + p1 r0"), full, p1, r0);
}

/* Cox and Matthews 2002, (22): a = E y + p1 r0; y+ = a + p2 (r(t+h, a) - r0) */
static void recipe_etdrk2(struct recipe *r)
{
	int full = add_table(r, "full", 1, 1, true), p1 = add_phi(r, full, "p1", 1, 1, 1, (long[]){ 1 });
	int p2 = add_phi(r, full, "p2", 1, 1, 2, (long[]){ 0, 1 }), a = new_stage(r);
	int r0 = add_leftover(r, add_node(r, 0, 1), STAGE_STATE);
	times_left(add_sum(r, a, full, NONE, "a = E y + p1 r0"), full, p1, r0);
	int ra = add_leftover(r, add_node(r, 1, 1), a), difference = add_combination(r, ra, r0, false);
	times_left(add_sum(r, STAGE_STATE, NONE, a, "y = a + p2 (r(t+h, a) - r0)"), full, p2, difference);
}

/* Cox and Matthews 2002, (26)-(29), with F a, in which loads would have to start anew at t + h/2, written as E y + F q1 r0
 * and the loads' exact part; F q1 = p1 - q1. */
static void recipe_etdrk4(struct recipe *r)
{
	int full = add_table(r, "full", 1, 1, true), half = add_table(r, "half", 1, 2, true);
	int q1 = add_phi(r, half, "q1", 1, 2, 1, (long[]){ 1 }), c0 = add_phi(r, full, "c0", 1, 1, 1, (long[]){ 1 });
	struct kernel_part *part = add_part(&r->table[full].kernel[c0], 1, 2);
	part->powers = 1;
	set(part->power[0], -2, 1);
	int b1 = add_phi(r, full, "b1", 1, 1, 3, (long[]){ 1, -3, 2 }), b2 = add_phi(r, full, "b2", 1, 1, 3, (long[]){ 0, 2, -2 });
	int b3 = add_phi(r, full, "b3", 1, 1, 3, (long[]){ 0, -1, 2 });
	int start = add_node(r, 0, 1), middle = add_node(r, 1, 2), end = add_node(r, 1, 1);
	int flow = new_stage(r), a = new_stage(r), b = new_stage(r), c = new_stage(r);
	int r0 = add_leftover(r, start, STAGE_STATE);
	add_sum(r, flow, full, NONE, "w = E y");
	times_left(add_sum(r, a, half, NONE, "a = F y + q1 r0"), half, q1, r0);
	int ra = add_leftover(r, middle, a), step = add_combination(r, ra, r0, false);
	times_left(add_sum(r, b, NONE, a, "b = F y + q1 r(t+h/2, a)"), half, q1, step);
	int rb = add_leftover(r, middle, b), twice = add_combination(r, rb, NONE, false);
	struct action *sum = add_sum(r, c, NONE, flow, "c = F a + q1 (2 r(t+h/2, b) - r0)");
	times_left(sum, full, c0, r0);
	times_left(sum, half, q1, twice);
	int rc = add_leftover(r, end, c), both = add_combination(r, ra, rb, true);
	sum = add_sum(r, STAGE_STATE, NONE, flow, "y = E y + b1 r0 + b2 (r(t+h/2, a) + r(t+h/2, b)) + b3 r(t+h, c)");
	times_left(sum, full, b1, r0);
	times_left(sum, full, b2, both);
	times_left(sum, full, b3, rc);
}

/* Liu, Wang, Li, Yi 2022: y+ = E y + h sum w_i e^{A (1 - c_i) h} r(t + c_i h, Y_i), Y_i by one step of RK4 of length c_i h; h w_i
 * is folded into the matrices. */
struct quadrature {
	int count;
	struct { long p; unsigned long q; long weight; unsigned long over; } node[4];
};

static const struct quadrature quadratures[SCHEMES] = {
	[SCHEME_NC2] = { 3, { { 0, 1, 1, 6 }, { 1, 2, 2, 3 }, { 1, 1, 1, 6 } } },
	[SCHEME_NC3] = { 4, { { 0, 1, 1, 8 }, { 1, 3, 3, 8 }, { 2, 3, 3, 8 }, { 1, 1, 1, 8 } } },
	[SCHEME_DQ4] = { 3, { { 1, 4, 2, 3 }, { 1, 2, -1, 3 }, { 3, 4, 2, 3 } } },     /* the weight at 1 is 0 */
	[SCHEME_BM3] = { 4, { { 0, 1, 1, 18 }, { 1, 4, 4, 9 }, { 3, 4, 4, 9 }, { 1, 1, 1, 18 } } }
};

/* e^{A (1 - c) h} w h */
static int add_weighted(struct recipe *r, int table, const char *name, long p, unsigned long q, long weight, unsigned long over)
{
	struct kernel_part *part = add_part(add_kernel(r, table, name), (long)q - p, q);
	set(part->impulse, weight, over);
	mpq_mul(part->impulse, part->impulse, r->h);
	return r->table[table].kernels - 1;
}

static void need_loads_at(struct recipe *r, int node)
{
	struct program *program = r->program;
	if (program->node_table[node] != NONE)
		return;
	if (mpq_cmp_ui(program->node[node], 1, 1) == 0) {
		program->node_table[node] = 0;          /* the whole step's */
		return;
	}
	program->node_table[node] = add_table(r, format("part%d", node), 0, 1, false);
	mpq_set(r->table[program->node_table[node]].fraction, program->node[node]);
}

static void recipe_quadrature(struct recipe *r, const struct quadrature *q, bool driven)
{
	static const char *const names[] = { "w1", "w2", "w3", "w4" };
	int full = add_table(r, "full", 1, 1, true), kernel[4], left[4];
	int r0 = add_leftover(r, add_node(r, 0, 1), STAGE_STATE);
	r->program->predicts = true;
	for (int i = 0; i < q->count; i++) {
		kernel[i] = add_weighted(r, full, names[i], q->node[i].p, q->node[i].q, q->node[i].weight, q->node[i].over);
		left[i] = r0;
		if (q->node[i].p == 0)
			continue;
		int half = add_node(r, q->node[i].p, 2 * q->node[i].q), end = add_node(r, q->node[i].p, q->node[i].q), stage = new_stage(r);
		if (driven) {
			need_loads_at(r, half);
			need_loads_at(r, end);
		}
		add_action(r, (struct action){ .kind = ACTION_PREDICT, .target = stage, .node = end, .half = half });
		left[i] = add_leftover(r, end, stage);
	}
	struct action *sum = add_sum(r, STAGE_STATE, full, NONE, "y = E y + h sum of w_i e^{A (1 - c_i) h} r_i");
	for (int i = 0; i < q->count; i++)
		times_left(sum, full, kernel[i], left[i]);
}

static bool is_driven(const struct linear *system)
{
	for (int l = 0; l < system->loads; l++)
		if (load_acts(system, &system->load[l]))
			return true;
	return system->inputs > 0;
}

static void write_recipe(struct recipe *r, const struct step *step)
{
	switch (step->model->scheme) {
	case SCHEME_PL:
	case SCHEME_ETD1:   recipe_etd1(r); break;
	case SCHEME_ETDRK2: recipe_etdrk2(r); break;
	case SCHEME_ETDRK4: recipe_etdrk4(r); break;
	default:            recipe_quadrature(r, &quadratures[step->model->scheme], is_driven(&step->branch[0].system)); break;
	}
}

/* ---- the count of a program of actions ---- */

struct tally {
	const struct step *step;
	struct program *program;
	int *terms;                 /* per row of the sum being counted */
};

static void tally_matrix(struct tally *t, const struct coefficient *c, int columns)
{
	for (int i = 0; i < t->step->branch->system.states; i++)
		for (int j = 0; j < columns; j++) {
			double value = c[i * columns + j].value;
			if (c[i * columns + j].zero && !t->program->loops)
				continue;
			t->terms[i]++;
			t->program->multiplications += t->program->loops || (value != 1 && value != -1);
		}
}

static void tally_flow(struct tally *t, const struct table *table)
{
	if (table->Phi)
		tally_matrix(t, table->Phi, table->states);
	tally_matrix(t, table->load, table->columns);
	tally_matrix(t, table->input, table->inputs);
}

static void tally_sum(struct tally *t, const struct action *a)
{
	struct table *const *table = t->step->branch[0].table;
	int rows = t->step->branch->system.states;
	t->terms = ARRAY(int, (size_t)rows);
	if (a->flow != NONE)
		tally_flow(t, table[a->flow]);
	for (int k = 0; k < a->kernels; k++)
		tally_matrix(t, table[a->kernel[k].table]->kernel[a->kernel[k].kernel], t->step->branch->system.channels);
	for (int i = 0; i < rows; i++)
		t->program->additions += t->terms[i] + (a->plain != NONE) - (t->terms[i] > 0 || a->plain != NONE);
}

/* Three slopes beside the first, which all predictions of a step share, and the sums of Runge and Kutta */
static void tally_prediction(struct tally *t, bool first)
{
	int rows = t->step->branch->system.states, slopes = first ? 4 : 3, n = t->step->branch->system.n;
	int terms = n * (rows + t->step->branch->system.channels);
	t->program->multiplications += slopes * terms + 4 * rows;
	t->program->additions += slopes * terms + 6 * rows;
}

static int leftovers_evaluated(const struct program *program)
{
	int count = 0;
	for (int i = 0; i < program->actions; i++)
		count += program->action[i].kind == ACTION_LEFTOVER ? 1 : program->action[i].kind == ACTION_PREDICT ? 3 : 0;
	return count;
}

static void tally_program(const struct step *step, struct program *program)
{
	struct tally t = { step, program, NULL };
	bool first = true;
	struct cost left = leftover_cost(step);
	for (int i = 0; i < program->actions; i++) {
		const struct action *a = &program->action[i];
		if (a->kind == ACTION_SUM)
			tally_sum(&t, a);
		if (a->kind == ACTION_COMBINE)
			program->additions += step->branch->system.channels;
		if (a->kind == ACTION_PREDICT) {
			tally_prediction(&t, first);
			first = false;
		}
	}
	int count = leftovers_evaluated(program);
	program->multiplications += count * left.multiplications;
	program->additions += count * left.additions;
	program->calls = count * left.calls;
}

/* A page that a person reads is unrolled; what is larger, has several operators, or loads that change, loops over its tables. */
static bool is_page(const struct step *step)
{
	enum { TERMS = 320 };
	int terms = 0;
	for (int i = 0; i < step->program->actions; i++) {
		const struct action *a = &step->program->action[i];
		if (a->kind == ACTION_SUM)
			terms += step->branch->system.states * ((a->flow != NONE ? step->branch->system.states : 0) + a->kernels * step->branch->system.channels);
	}
	return step->branches == 1 && step->branch->system.segments == 1 && step->branch->system.states <= LIMIT_UNROLLED_STATES && terms <= TERMS;
}

static void mark_loads(const struct step *step, struct program *program)
{
	const struct linear *system = &step->branch->system;
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++)
			program->uses[column] = load_acts(system, &system->load[l]);
}

/* ---- the whole ---- */

static void find_growth(struct step *step)
{
	struct linear modified = modified_equation(&step->model->system, &step->branch->system, step->model->h);
	struct pole_report *pole;
	int poles = poles_of(step->model, resolvent_of(&modified), &pole);
	mpfr_init2(step->growth, 53);
	mpfr_set_inf(step->growth, -1);
	for (int i = 0; i < poles; i++)
		mpfr_max(step->growth, step->growth, pole[i].re, MPFR_RNDN);
}

/* The ramps of inputs as channels: u', held and as the slope of u */
static struct linear driven_system(const struct linear *region)
{
	struct linear system = *region;
	system.channels = 2 * region->inputs;
	system.channel = ARRAY(mpq_t *, (size_t)system.channels);
	for (int i = 0; i < system.channels; i++)
		system.channel[i] = region->input[i / 2].force[i % 2];
	return system;
}

/* The linear system of each operator, and what of it a step takes */
static void take_operators(struct step *step)
{
	const struct model *model = step->model;
	const struct switching *regions = model->switching;
	step->branches = regions ? regions->systems : model->operators ? model->operators : 1;
	step->branch = ARRAY(struct branch, (size_t)step->branches);
	for (int k = 0; k < step->branches; k++) {
		struct linear system = regions ? driven_system(&regions->system[k]) : model->operators ? operator_system(model, k) : model->system;
		bool as_written = !regions && !model->operators && model->written == model && model->scheme != SCHEME_PL;
		step->branch[k].system = model->scheme == SCHEME_PL ? piecewise_laplace(&system) : system;
		step->branch[k].resolvent = as_written ? step->written : resolvent_of(&step->branch[k].system);
		check_pole_size(model, step->branch[k].resolvent);
	}
}

static void make_tables(struct step *step, int count, const struct wanted *wanted)
{
	step->tables = count;
	for (int k = 0; k < step->branches; k++)
		step->branch[k].table = tables_of(step->model, step->branch[k].resolvent, &step->branch[k].system, count, wanted);
	step->branch->whole = step->branch[0].table[0];
}

static void make_whole(void *context)
{
	struct step *step = context;
	struct wanted *whole = NEW(struct wanted);
	*whole = (struct wanted){ .Phi = true, .two_words = true, .name = "full", .increments = step->form == FORM_DELTA, .mass = step->mass };
	mpq_init(whole->fraction);
	mpq_set_ui(whole->fraction, 1, 1);
	make_tables(step, 1, whole);
}

static void build_exact(struct step *step)
{
	choose_form(step);
	bool chosen = step->model->asked.form == FORM_AUTO && step->form == FORM_KICK_DRIFT_KICK;
	if (chosen && !silent_guard(make_whole, step)) {        /* kicks may leave the range where Phi does not */
		step->form = FORM_DELTA;
		step->mass = NULL;
		step->momenta = chosen = false;
	}
	if (!chosen)
		make_whole(step);
	if (step->model->tuning)
		mark_tuned_zeros(step);
	find_carries(step);
	step->program = linear_program(step);
	plan_forced(step);
	if (step->forced)
		step->program = linear_program(step);
}

static bool *loads_of_regions(const struct step *step)
{
	const struct switching *s = step->model->switching;
	bool *needed = ARRAY(bool, (size_t)step->branch->system.loads);
	for (int l = 0; l < step->branch->system.loads; l++) {
		for (int k = 0; k < s->systems; k++)
			needed[l] = needed[l] || load_acts(&s->system[k], &s->system[k].load[l]);
		for (int e = 0; e < s->expressions; e++)
			for (int k = 0; k < step->branch->system.load[l].columns; k++)
				needed[l] = needed[l] || mpq_sgn(s->expression[e].row->load[l][k]) != 0;
	}
	return needed;
}

/* Phi over a part of the step, and what inputs add: u held, and u' as the slope of u */
static struct wanted *wanted_piece(const struct step *step, int halvings)
{
	struct recipe *r = NEW(struct recipe);
	int piece = add_table(r, "piece", 1, 1ul << halvings, true);
	add_phi(r, piece, "held", 1, 1ul << halvings, 1, (long[]){ 1 });
	int ramp = add_phi(r, piece, "ramp", 1, 1ul << halvings, 2, (long[]){ 0, 1 });
	mpq_set(r->table[piece].kernel[ramp].part[0].power[1], step->model->h);
	return r->table;
}

static void plan_region(struct step *step, int k)
{
	step->branch[k].halvings = series_halvings(step, k);
	if (step->branch[k].halvings > LIMIT_PIECES)
		error(step->model->asked.step_at, "a smaller step would do", "the largest pole times h is above 2^%d: too many pieces of a step to look for crossings in",
		      LIMIT_PIECES);
	struct linear *system = &step->branch[k].system;
	step->branch[k].table = tables_of(step->model, step->branch[k].resolvent, system, 1, wanted_piece(step, step->branch[k].halvings));
	system->channels = 0;
	int degree = series_degree(step, k, k + 1, step->branch[k].halvings);
	step->series.degree = degree > step->series.degree ? degree : step->series.degree;
}

/* A piecewise-linear model: e^{A d} of each region for pieces d of the step, and the series that finds crossings */
static void build_regions_step(struct step *step)
{
	struct branch *first = step->branch;
	int channels = first->system.channels;  /* ramps of inputs, while tables are made */
	step->tables = 1;
	first->whole = tables_of(step->model, first->resolvent, &first->system, 1, wanted_piece(step, 0))[0];
	first->system.channels = 0;
	series_place_loads(&step->series, &first->system, 0, loads_of_regions(step));
	find_carries(step);
	step->program = linear_program(step);
	step->program->multiplications = step->series.size * step->series.size + 6 * step->model->switching->expressions * step->series.size;
	step->program->additions = step->program->multiplications;
	first->system.channels = channels;
	step->series.degree = 3;
	step->series.emitted = true;
	for (int k = 0; k < step->branches; k++)
		plan_region(step, k);
}

static void build_with_leftover(struct step *step)
{
	struct recipe *recipe = NEW(struct recipe);
	recipe->program = step->program = NEW(struct program);
	recipe->h = step->model->h;
	write_recipe(recipe, step);
	make_tables(step, recipe->tables, recipe->table);
	find_carries(step);
	step->program->reads = ARRAY(bool, (size_t)step->branch->system.states);
	step->program->uses = ARRAY(bool, (size_t)step->branch->whole->columns);
	step->program->loops = !is_page(step);
	mark_loads(step, step->program);
	tally_program(step, step->program);
	count_loads(step->program, &step->branch->system, step->model->asked.single);
}

/* Of tunable models: no Taylor series in the step's own time, but e^{A tau} at any, of every load */
static void place_all_loads(struct step *step)
{
	bool *all = ARRAY(bool, (size_t)step->branch->system.loads);
	for (int l = 0; l < step->branch->system.loads; l++)
		all[l] = true;
	series_place_loads(&step->series, &step->branch->system, 0, all);
	step->series.emitted = true;
}

static void build(void *context)
{
	struct step *step = context;
	const struct model *model = step->model;
	bool left = model->channels > 0 && !model->switching;
	step->form = FORM_DIRECT;
	step->written = resolvent_of(&model->written->system);
	check_pole_size(model, step->written);
	take_operators(step);
	if (model->scheme == SCHEME_PL)
		find_growth(step);
	if (model->switching) {
		need_direct(step);
		build_regions_step(step);
		if (model->asked.selftest)
			need_closed_form(step);
		return;
	}
	if (left)
		need_direct(step);
	if (model->tuning)
		place_all_loads(step);
	else
		series_place(&step->series, &step->branch->system, left && model->scheme <= SCHEME_ETD1);
	if (left)
		build_with_leftover(step);
	else
		build_exact(step);
	if (!model->tuning)
		series_plan(step);
	if (model->asked.selftest)
		need_closed_form(step);
}

struct step *step_build(const struct model *model)
{
	struct step *step = NEW(struct step);
	step->model = model;
	step->shown = step;
	if (!statement_guard(build, step))
		return NULL;
	if (!model->relative)
		return step;
	struct model *plain = NEW(struct model);
	*plain = *model->written;
	plain->asked.form = FORM_DIRECT;
	plain->asked.compensated = plain->asked.selftest = false;
	step->shown = step_build(plain);
	return step->shown ? step : NULL;
}
