/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coordinates in which rigid-body modes are parted from relative motion. A drive that turns, a train that
 * rolls: positions grow without bound while forces depend on their differences only, and a difference of two large
 * numbers has lost its digits. So where the equations do not change when coordinates are moved by n, the step keeps
 * x_k - (n_k/n_p) x_p of each coordinate and its neighbour in a tree, beside one coordinate that alone is moved.
 * Where a sum of the equations is free of states, u, that one is the centre X = sum w_j x_j, w = u W with W what
 * multiplies the highest derivatives: only loads and inputs act on it, and nothing that rounds inside changes its
 * velocity. Otherwise it is a coordinate as written.
 * A coordinate is measured from one that acts on it, and so is carried along wherever that goes. From one that does not
 * it is not: b of a'' + a' = 0, b' = b - a may grow without bound while a rests, and a = (a - b) + b would be lost.
 *
 * The model is built a second time over these coordinates, so that regions, remainders, Jacobians and tunable params
 * are derived in them from the start; where the user looks, states are the written ones. */
#include "inner.h"
#include "model/building.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "model/tunable/tuning.h"

#include <string.h>

/* ---- what the equations read ---- */

struct dependences {
	const struct model *model;
	/* factors of coordinates in every form, sums inside functions too; and of velocities */
	struct echelon place, rate;
	bool *strong, *weak;        /* n x n: read in one sum, in one equation */
	bool *acts;                 /* n x n, [i][j]: i stands in the equation of j; then, that or through others */
	bool *seen;                 /* per atom */
};

static void join(bool *joined, int n, int a, int b)
{
	joined[a * n + b] = joined[b * n + a] = true;
}

/* A coordinate in the equation of `own` */
static void join_equation(struct dependences *l, int own, int coord)
{
	join(l->weak, l->model->n, own, coord);
	l->acts[coord * l->model->n + own] = true;
}

/* Coordinates of a sum, one after the other */
static void join_terms(struct dependences *l, const struct form *form)
{
	int last = -1, count = 0;
	for (int i = 0; i < form->terms; i++)
		count += form->term[i].basis.kind == BASIS_COORD && form->term[i].basis.order == 0;
	for (int i = 0; i < form->terms && count == 2; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind != BASIS_COORD || basis->order != 0)
			continue;
		if (last >= 0)
			join(l->strong, l->model->n, last, basis->index);
		last = basis->index;
	}
}

/* What follows from the rows before is not kept: of M(q) there are as many operands as n^2 in each of n solutions. */
static void add_row(struct echelon *e, mpq_t *row)
{
	const int rank = e->rank;
	echelon_add(e, row);
	if (e->rank == rank)
		rationals_free(row, (size_t)e->width);
}

static void look_at(struct dependences *l, const struct form *form, int own)
{
	int n = l->model->n;
	mpq_t *place = rationals(n), *rate = rationals(n);
	join_terms(l, form);
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		const struct atom *atom = basis->kind == BASIS_ATOM ? basis->atom : NULL;
		if (basis->kind == BASIS_COORD) {
			join_equation(l, own, basis->index);
			if (basis->order == 0 && own != basis->index)
				join(l->strong, n, own, basis->index);
			if (basis->order == 0)
				mpq_set(place[basis->index], form->term[i].factor);
			else if (!is_highest(&l->model->frame, basis))
				mpq_set(rate[basis->index], form->term[i].factor);
		}
		if (!atom)
			continue;
		for (int k = 0; k < atom->operands && !l->seen[atom->index]; k++)
			look_at(l, atom->operand[k], own);
		l->seen[atom->index] = true;
	}
	add_row(&l->place, place);
	add_row(&l->rate, rate);
}

/* An atom is looked at once, but joins all equations in which it stands. */
static void join_atoms(struct dependences *l, const struct form *form, int own)
{
	for (const struct form_term **term = terms_within(form, l->seen); *term; term++)
		if ((*term)->basis.kind == BASIS_COORD)
			join_equation(l, own, (*term)->basis.index);
}

static struct dependences look_new(const struct model *model)
{
	size_t n = (size_t)model->n;
	return (struct dependences){ model,
			      echelon_new(model->n),
			      echelon_new(model->n),
			      ARRAY(bool, n *n),
			      ARRAY(bool, n *n),
			      ARRAY(bool, n *n),
			      ARRAY(bool, (size_t)atoms_count(model->equations.atoms)) };
}

/* The equations; of tunable models also at values that are related by nothing */
static struct dependences look_at_equations(const struct model *model)
{
	struct dependences l = look_new(model);
	for (int i = 0; i < model->n; i++)
		look_at(&l, model->equations.residual[i].form, coordinate_of_row(model, i));
	for (int i = 0; i < model->n && model->remainder.force_columns + (model->switching != NULL) > 0; i++) {
		memset(l.seen, 0, (size_t)atoms_count(model->equations.atoms));
		join_atoms(&l, model->equations.residual[i].form, coordinate_of_row(model, i));
	}
	memset(l.seen, 0, (size_t)atoms_count(model->equations.atoms));
	for (int i = 0; i < model->n && model_elsewhere(model); i++)
		look_at(&l, model_elsewhere(model)->equations.residual[i].form, coordinate_of_row(model, i));
	return l;
}

/* ---- sums of equations that no state enters ---- */

/* One column for each basis that depends on states, one row of unknown factors for each equation */
struct balance {
	int bases, first;           /* first: of the second set of equations */
	struct basis *basis;
	mpq_t **factor;             /* per basis: of it in each equation */
};

static void weigh(struct balance *b, int n, int from, int row, const struct form_term *term)
{
	int at = from ? b->first : 0;
	while (at < b->bases && basis_order(&b->basis[at], &term->basis) != 0)
		at++;
	if (at == b->bases) {
		b->bases++;
		ENLARGE(b->basis, (size_t)b->bases);
		ENLARGE(b->factor, (size_t)b->bases);
		b->basis[at] = term->basis;
		b->factor[at] = rationals(n);
	}
	mpq_set(b->factor[at][row], term->factor);
}

/* Of tunable models at other values too */
static int free_sums(const struct model *model, mpq_t ***sum)
{
	struct balance b = { 0 };
	struct echelon e = echelon_new(model->n);
	for (int row = 0; row < model->n * (model_elsewhere(model) ? 2 : 1); row++) {
		int i = row % model->n;
		b.first = row < model->n ? 0 : row == model->n ? b.bases : b.first;
		const struct form *form = (row == i ? model : model_elsewhere(model))->equations.residual[i].form;
		for (int k = 0; k < form->terms; k++) {
			const struct basis *basis = &form->term[k].basis;
			bool coord = basis->kind == BASIS_COORD && !is_highest(&model->frame, basis);
			if (basis->kind == BASIS_ATOM ? basis->atom->state : coord)
				weigh(&b, model->n, row - i, i, &form->term[k]);
		}
	}
	for (int k = 0; k < b.bases; k++)
		echelon_add(&e, b.factor[k]);
	return echelon_null_space(&e, sum);
}

/* w = u W: what a sum of equations multiplies the highest derivatives with */
static mpq_t *weights_of(const struct model *model, const mpq_t *u)
{
	int n = model->n;
	mpq_t *w = rationals(n);
	RATIONAL product = ZERO;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			mpq_mul(product, u[i],
				(model->system.velocity[j] >= 0 ? model->system.M : model->system.C)[i * n + j]);
			mpq_add(w[j], w[j], product);
		}
	return w;
}

/* Do the weights change with tunable params? */
static bool retunes(const struct model *model, const mpq_t *w, const mpq_t *other)
{
	RATIONAL ratio = ZERO;
	const size_t n = (size_t)model->n;
	return !rationals_zero(n, w) && !rationals_multiple(n, other, w, ratio);
}

/* ---- groups ---- */

struct group {                      /* coordinates that are moved together */
	int n;                      /* of the model */
	const mpq_t *motion;        /* n: how far each is moved */
	mpq_t *weight;              /* of the centre, sum of weight times motion = motion of the root; or NULL */
	int root;
	bool split;                 /* coordinates of both orders: velocities of the second stand alone */
};

static int support(int n, const mpq_t *v)
{
	int count = 0;
	for (int j = 0; j < n; j++)
		count += mpq_sgn(v[j]) != 0;
	return count;
}

static void spread(const bool *joined, int n, int from, int number, int *component)
{
	component[from] = number;
	for (int j = 0; j < n; j++)
		if (component[j] < 0 && joined[from * n + j])
			spread(joined, n, j, number, component);
}

static int *components_of(const struct dependences *l, int *count)
{
	int n = l->model->n, *component = ARRAY(int, n);
	*count = 0;
	for (int j = 0; j < n; j++)
		component[j] = -1;
	for (int j = 0; j < n; j++)
		if (component[j] < 0)
			spread(l->weak, n, j, (*count)++, component);
	return component;
}

/* Whatever acts through others acts too. */
static void close_acts(struct dependences *l)
{
	int n = l->model->n, *reached = ARRAY(int, n);
	bool *direct = ARRAY(bool, (size_t)(n * n));
	memcpy(direct, l->acts, (size_t)(n * n) * sizeof *direct);
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++)
			reached[j] = -1;
		spread(direct, n, i, 0, reached);
		for (int j = 0; j < n; j++)
			l->acts[i * n + j] = reached[j] == 0;
	}
}

static int first_entry(int n, const mpq_t *v)
{
	int j = 0;
	while (j < n && mpq_sgn(v[j]) == 0)
		j++;
	return j;
}

/* The sum of the vectors that lie in a component; a vector may be 0: of weights that change with tunable params */
static mpq_t *sum_in(int n, int vectors, mpq_t **vector, const int *component, int number, int *count)
{
	mpq_t *sum = rationals(n);
	*count = 0;
	for (int v = 0; v < vectors; v++) {
		int first = first_entry(n, vector[v]);
		if (first == n || component[first] != number)
			continue;
		for (int j = 0; j < n; j++)
			mpq_add(sum[j], sum[j], vector[v][j]);
		++*count;
	}
	return sum;
}

static void scale(int n, mpq_t *v, mpq_srcptr divisor)
{
	for (int j = 0; j < n; j++)
		mpq_div(v[j], v[j], divisor);
}

/* The first motion of a component: what no velocity feels either, if there is such; else the only one of several
 * coordinates that no force feels. */
static mpq_t *motion_in(int n, int places, mpq_t **place, int rates, mpq_t **rate, const int *component, int number)
{
	int count, several = 0;
	mpq_t *motion = sum_in(n, rates, rate, component, number, &count), **shared = ARRAY(mpq_t *, n);
	if (support(n, motion) > 1)
		return motion;
	for (int v = 0; v < places; v++)
		if (support(n, place[v]) > 1)
			shared[several++] = place[v];
	mpq_t *other = sum_in(n, several, shared, component, number, &several);
	if (several == 1)
		return other;
	if (count)
		return motion;
	motion = sum_in(n, places, place, component, number, &count);
	return count == 1 ? motion : NULL;
}

/* Coordinates of both orders? */
static bool is_mixed(const struct model *model, const mpq_t *motion, const mpq_t *weight)
{
	bool order[2] = { false, false };
	for (int j = 0; j < model->n; j++)
		if (mpq_sgn(motion[j]) != 0 || mpq_sgn(weight[j]) != 0)
			order[model->system.velocity[j] >= 0] = true;
	return order[0] && order[1];
}

/* Names that `operator at` fixes: a difference is fixed where both are. */
static bool fixed_in_part(const struct model *model, const struct group *g)
{
	for (int order = 0; order < 2; order++) {
		int fixed = 0, all = 0;
		for (int j = 0; j < g->n; j++) {
			bool member = mpq_sgn(g->motion[j]) != 0 || (g->weight && mpq_sgn(g->weight[j]) != 0),
			     found = false;
			for (int i = 0; i < model->spec->operators.fixeds && member; i++) {
				const struct fixed *f = &model->spec->operators.fixed[i];
				int first = f->symbol ? f->symbol->index + (f->component ? f->component - 1 : 0) : 0;
				int length = f->symbol && f->symbol->length && !f->component ? f->symbol->length : 1;
				found = found || (f->symbol && f->symbol->kind == SYMBOL_COORD && f->primes == order &&
						  first <= j && j < first + length);
			}
			fixed += found;
			all += member;
		}
		if (fixed > 0 && (fixed < all || g->split))
			return true;
	}
	return false;
}

/* Do both act on each other? */
static bool go_together(const struct dependences *l, int a, int b)
{
	return l->acts[a * l->model->n + b] && l->acts[b * l->model->n + a];
}

/* Nothing of the group acts on it that it does not act on */
static bool leads_group(const struct dependences *l, const mpq_t *motion, int coord)
{
	int n = l->model->n;
	for (int j = 0; j < n; j++)
		if (mpq_sgn(motion[j]) != 0 && l->acts[j * n + coord] && !l->acts[coord * n + j])
			return false;
	return true;
}

/* Of those that lead the first; of these one of first order, where there is such */
static int root_in(const struct dependences *l, const mpq_t *motion, bool split)
{
	int n = l->model->n, root = first_entry(n, motion);
	while (!leads_group(l, motion, root))
		for (root++; mpq_sgn(motion[root]) == 0; root++)
			;
	for (int j = 0; j < n && split; j++)
		if (mpq_sgn(motion[j]) != 0 && l->model->system.velocity[j] < 0 && go_together(l, root, j))
			return j;
	return root;
}

/* What a centre is made of moves with the root. */
static bool centres(const struct dependences *l, const struct group *g, const mpq_t *weight)
{
	for (int j = 0; j < g->n; j++)
		if (mpq_sgn(weight[j]) != 0 && !go_together(l, g->root, j))
			return false;
	return support(g->n, weight) > 1 && !is_mixed(l->model, g->motion, weight);
}

/* Whether it is one, and which */
static bool make_group(const struct dependences *l, const mpq_t *motion, mpq_t *weight, struct group *g)
{
	const struct model *model = l->model;
	int n = model->n;
	*g = (struct group){ .n = n, .motion = motion, .split = is_mixed(model, motion, motion) };
	g->root = root_in(l, motion, g->split);
	RATIONAL sum = ZERO;
	for (int j = 0; j < n && weight; j++)
		rational_addmul(sum, weight[j], motion[j]);
	if (mpq_sgn(sum) != 0 && centres(l, g, weight)) {
		mpq_div(sum, sum, motion[g->root]);
		scale(n, weight, sum);
		g->weight = weight;
	}
	if (support(n, motion) <= 1 && !g->weight)
		return false;
	if (!fixed_in_part(model, g))
		return true;
	if (model->schedule.operators > 0 && !scheme_row(model->scheme)->holds_coupling)
		say_warning(model->spec->operators.at, "fix all of them, or none",
			    "the operator fixes some of the coordinates of a rigid-body mode: they are kept as "
			    "written, and where they grow their differences lose digits");
	return false;
}

/* ---- the tree ---- */

static void link_to(struct relative *r, const struct group *g, int coord, int parent)
{
	struct link *link = &r->link[coord];
	link->kind = LINK_PARENT;
	link->from = parent;
	link->reversed = coord > parent;
	mpq_div(link->ratio, g->motion[coord], g->motion[parent]);
	r->sequence[r->links++] = coord;
}

/* Breadth first from the root: neighbours in a sum, then in an equation, then the rest; none that it does not act on */
static void grow_tree(struct relative *r, const struct dependences *l, const struct group *g)
{
	int n = g->n, *queue = ARRAY(int, n), done = 0, count = 1;
	bool *in = ARRAY(bool, n);
	queue[0] = g->root;
	in[g->root] = true;
	for (int stage = 0; stage < 3; stage++) {
		const bool *joined = stage == 0 ? l->strong : l->weak;
		for (done = 0; done < count; done++)
			for (int j = 0; j < n; j++) {
				bool near = stage == 2 ? queue[done] == g->root : joined[queue[done] * n + j];
				if (in[j] || !near || mpq_sgn(g->motion[j]) == 0 || !l->acts[queue[done] * n + j])
					continue;
				in[j] = true;
				link_to(r, g, j, queue[done]);
				queue[count++] = j;
			}
	}
}

/* x_root = X + sum of shift[k] times what is kept at k, from X = sum of weight[j] x_j and x_j = (n_j/n_root) x_root
 * + d_j */
static void place_root(struct relative *r, const struct group *g, int first)
{
	int n = g->n;
	struct link *root = &r->link[g->root];
	mpq_t *d = rationals((size_t)(n * n));  /* d_j over what is kept */
	RATIONAL product = ZERO;
	root->kind = LINK_CENTRE;
	root->weight = g->weight;
	root->shift = rationals(n);
	for (int j = 0; j < n; j++)
		if (mpq_sgn(g->motion[j]) == 0)
			mpq_set_ui(d[j * n + j], 1, 1);
	for (int i = first; i < r->links; i++) {
		int j = r->sequence[i], p = r->link[j].from;
		for (int k = 0; k < n; k++)
			mpq_mul(d[j * n + k], r->link[j].ratio, d[p * n + k]);
		mpq_set_si(d[j * n + j], r->link[j].reversed ? -1 : 1, 1);
	}
	for (int j = 0; j < n; j++)
		for (int k = 0; k < n; k++) {
			mpq_mul(product, g->weight[j], d[j * n + k]);
			mpq_sub(root->shift[k], root->shift[k], product);
		}
}

/* ---- equations, combined as coordinates are ---- */

/* Where each equation has the highest derivative of one coordinate alone, what multiplies it; NULL: not so. Tunable
 * params would have to be divided by. */
static mpq_t *leading_factors(const struct model *model)
{
	int n = model->n;
	mpq_t *factor = rationals(n);
	for (int j = 0; j < n; j++)
		for (int i = 0; i < n; i++) {
			mpq_srcptr entry =
				(model->system.velocity[j] >= 0 ? model->system.M : model->system.C)[i * n + j];
			if (i == model->equations.owner[j])
				mpq_set(factor[j], entry);
			else if (mpq_sgn(entry) != 0)
				return NULL;
		}
	for (int j = 0; j < n; j++)
		if (mpq_sgn(factor[j]) == 0)
			return NULL;
	return model_elsewhere(model) ? NULL : factor;
}

static struct form *divided(const struct relative *r, int coord, struct form *const *equation, mpq_srcptr times)
{
	RATIONAL factor = ZERO;
	mpq_div(factor, times, r->solved[coord]);
	return form_scale(equation[coord], factor);
}

static bool same_order(const struct model *model, int a, int b)
{
	return (model->system.velocity[a] >= 0) == (model->system.velocity[b] >= 0);
}

struct form *combined_equation(const struct relative *r, int coord, struct form *const *equation)
{
	const struct link *link = &r->link[coord];
	struct form *form = NEW(struct form);
	if (!r->solved || link->kind == LINK_NONE || link->rate || link->velocity >= 0)
		return equation[coord];
	if (link->kind == LINK_PARENT && !same_order(r->written, coord, link->from))
		return equation[coord];
	RATIONAL one = RATIO(1, 1);
	if (link->kind == LINK_PARENT) {
		struct form *own = divided(r, coord, equation, one),
			    *from = divided(r, link->from, equation, link->ratio);
		form = link->reversed ? form_difference(from, own) : form_difference(own, from);
	}
	for (int j = 0; j < r->written->n && link->kind == LINK_CENTRE; j++)
		if (mpq_sgn(link->weight[j]) != 0)
			form = form_sum(form, divided(r, j, equation, link->weight[j]), false);
	return form;
}

/* Whether it is one; moved[j]: coordinate j stands in this motion, or its centre, or in one that was tried before */
static bool add_group(struct relative *r, const struct dependences *l, const mpq_t *motion, mpq_t *weight, bool *moved)
{
	struct group g;
	bool made = make_group(l, motion, weight, &g);
	for (int j = 0; j < l->model->n; j++)
		moved[j] = moved[j] || mpq_sgn(motion[j]) != 0 || (g.weight && mpq_sgn(g.weight[j]) != 0);
	if (!made)
		return false;
	int first = r->links;
	grow_tree(r, l, &g);
	if (g.weight)
		place_root(r, &g, first);
	return g.weight || r->links > first;
}

/* Of several coordinates, which no other such motion has, and no group */
static bool moves_alone(int n, int places, mpq_t **place, int which, const bool *moved)
{
	bool alone = support(n, place[which]) > 1;
	for (int j = 0; j < n && alone; j++) {
		int others = 0;
		for (int v = 0; v < places; v++)
			others += v != which && mpq_sgn(place[v][j]) != 0 && support(n, place[v]) > 1;
		alone = mpq_sgn(place[which][j]) == 0 || (others == 0 && !moved[j]);
	}
	return alone;
}

struct relative *relative_of(const struct model *model)
{
	bool events = model->contacts.drags + model->contacts.impacts > 0 ||
		      (model->switching && has_events(model->switching));
	if (model->n < 2 || events || model->spec->count.multipliers > 0)
		return NULL;        /* friction, impacts and constraints act on coordinates as written */
	struct dependences l = look_at_equations(model);
	struct echelon both = l.place;
	mpq_t **place, **rate, **sum;
	int n = model->n, count, groups = 0, places = echelon_null_space(&l.place, &place);
	if (places == 0)
		return NULL;
	close_acts(&l);
	both.row = ARRAY(mpq_t *, n);
	both.pivot = ARRAY(int, n);
	both.rank = 0;
	for (int k = 0; k < 2; k++) {
		const struct echelon *from = k ? &l.rate : &l.place;
		for (int i = 0; i < from->rank; i++)
			echelon_add(&both, rationals_copied(n, from->row[i]));
	}
	int rates = echelon_null_space(&both, &rate), sums = free_sums(model, &sum);
	int *component = components_of(&l, &count);
	for (int s = 0, all = sums; s < all; s++) {
		const mpq_t *u = sum[s];
		sum[s] = weights_of(model, u);
		if (model_elsewhere(model) && retunes(model, sum[s], weights_of(model_elsewhere(model), u)))
			sum[s] = rationals(n);
	}
	struct relative *r = relative_new(model);
	bool *moved = ARRAY(bool, n);
	for (int c = 0; c < count; c++) {
		int found;
		mpq_t *motion = motion_in(n, places, place, rates, rate, component, c),
		      *weight = sum_in(n, sums, sum, component, c, &found);
		if (motion)
			groups += add_group(r, &l, motion, found == 1 ? weight : NULL, moved);
	}
	for (int v = 0; v < places; v++)
		if (moves_alone(n, places, place, v, moved))
			groups += add_group(r, &l, place[v], NULL, moved);
	if (groups == 0)
		return NULL;
	complete_relative(r);
	r->solved = leading_factors(model);
	return r;
}
