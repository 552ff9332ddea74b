/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Written equations and sketches to residuals, one for each coordinate. */
#include "building.h"
#include "checks.h"
#include "model/contacts/friction.h"
#include "model/linear/relative.h"
#include "lagrange.h"
#include "state_mass.h"

struct indexed {
	struct building *b;
	struct segment_equations *segment_equations;
	int index;
	struct form **terms;        /* per coordinate: of the energies */
};

/* ---- collection ---- */

static void add_residual(struct segment_equations *s, struct form *form, struct place at, struct place end)
{
	*MORE(s->residual, s->residuals) = (struct residual){ form, at, end };
}

/* Left side minus right side, cell by cell; a plain 0 fits any size. */
static void collect_equation(void *context)
{
	struct indexed *work = context;
	const struct equation *equation = &work->b->spec->equation[work->index];
	struct value *left = collect(&work->b->collector, equation->left),
		     *right = collect(&work->b->collector, equation->right);
	const struct value *shape = is_plain_zero(left) ? right : left;
	if (!is_plain_zero(left) && !is_plain_zero(right) &&
	    (left->rows != right->rows || left->columns != right->columns))
		error(equation->at, NULL, "the sides of the equation do not fit: %d x %d and %d x %d", left->rows,
		      left->columns, right->rows, right->columns);
	for (int i = 0; i < shape->rows * shape->columns; i++) {
		const struct form *l = is_plain_zero(left) ? left->cell[0] : left->cell[i],
				  *r = is_plain_zero(right) ? right->cell[0] : right->cell[i];
		add_residual(work->segment_equations, form_sum(l, r, true), equation->at, equation->end);
	}
}

static int component_of(const struct node *coordinate)
{
	return coordinate->symbol->index + (coordinate->component ? coordinate->component - 1 : 0);
}

/* Constant, but for tunable params that the instance has */
static bool is_of_params(const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		const struct atom *a = basis->atom;
		if (basis->kind > BASIS_PI && !(a && a->params && !a->time && !a->input && !a->state))
			return false;
	}
	return true;
}

/* The element's force on its first coordinate, as it stands on the left side. */
static void collect_element(void *context)
{
	struct indexed *work = context;
	struct building *b = work->b;
	const struct element *element = &b->spec->element[work->index];
	if (element->kind == ELEMENT_ENERGY) {
		work->segment_equations->element[work->index] = work->terms[component_of(element->from)];
		return;
	}
	struct form *value = scalar_of(collect(&b->collector, element->value), element->value, NULL);
	struct form *form;
	if (element->kind == ELEMENT_FORCE || element->kind == ELEMENT_FRICTION) {
		form = form_sum(NEW(struct form), value, element->kind == ELEMENT_FORCE);
	} else {
		int order = element->kind == ELEMENT_MASS ? 2 : element->kind == ELEMENT_DAMPER ? 1 : 0;
		if (!is_constant(value) && !is_of_params(value))
			error(element->value->start, "what moves belongs in an equation, or in a force",
			      "a mass, spring or damper needs a constant");
		form = coordinate_form(&b->model->frame, component_of(element->from), order);
		if (element->to)
			form = form_sum(form, coordinate_form(&b->model->frame, component_of(element->to), order),
					true);
		form = is_constant(value) ? form_product(&b->collector, value, form)
						   : kept_product(&b->collector, element->value, value, form);
	}
	work->segment_equations->element[work->index] = form;
}

/* Up to the first statement that changes its formula where none did before: the interval is then collected again, and
 * an atom that several equations have is met first where it is in the other intervals. */
void collect_equations(struct building *b, struct segment_equations *segment_equations)
{
	const int *changes = &b->collector.changes, known = *changes;
	b->collector.equation = true;
	for (int i = 0; i < b->spec->equations && *changes == known; i++)
		if (b->spec->equation[i].right)
			statement_guard(collect_equation, &(struct indexed){ b, segment_equations, i, NULL });
	segment_equations->written = segment_equations->residuals;
	segment_equations->element = ARRAY(struct form *, b->spec->elements);
	struct form **terms =
		b->spec->lagrange.energies && *changes == known ? lagrange_terms(b, segment_equations) : NULL;
	for (int i = 0; i < b->spec->elements && *changes == known; i++)
		statement_guard(collect_element, &(struct indexed){ b, segment_equations, i, terms });
	b->collector.equation = false;
}

/* ---- where a derivative stands ---- */

static const struct node *find_derivative(const struct node *node, int coord, int primes)
{
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD && node->primes == primes) {
		int first = component_of(node),
		    last = node->component || !node->symbol->length ? first : first + node->symbol->length - 1;
		if (first <= coord && coord <= last)
			return node;
	}
	for (int i = 0; i < node->children; i++) {
		const struct node *found = find_derivative(node->child[i], coord, primes);
		if (found)
			return found;
	}
	return NULL;
}

static const struct node *find_in_equations(const struct spec *spec, int coord, int primes)
{
	const struct node *found = NULL;
	for (int i = 0; i < spec->equations && !found; i++) {
		if (!spec->equation[i].right)
			continue;               /* broken: its error was reported */
		found = find_derivative(spec->equation[i].left, coord, primes);
		found = found ? found : find_derivative(spec->equation[i].right, coord, primes);
	}
	for (const struct symbol *s = spec->first; s && !found; s = s->next)
		if (s->kind == SYMBOL_LET && !s->broken)
			found = find_derivative(s->value, coord, primes);
	return found;
}

static const struct element *find_mass(const struct spec *spec, int coord)
{
	for (int i = 0; i < spec->elements; i++)
		if (spec->element[i].kind == ELEMENT_MASS && component_of(spec->element[i].from) == coord)
			return &spec->element[i];
	return NULL;
}

/* A coordinate is of second order if its acceleration stands in an equation or a mass at it. */
int find_order(const struct spec *spec, int coord)
{
	if (find_mass(spec, coord) || has_kinetic_energy(spec, coord) || find_in_equations(spec, coord, 2))
		return 2;
	return is_constrained(spec, coord) && !find_in_equations(spec, coord, 1) ? 2 : 1;
}

/* ---- does each coordinate have its equation? ---- */

static int order_of(const struct model *model, int coord)
{
	return model->system.velocity[coord] >= 0 ? 2 : 1;
}

static const char *highest_name(const struct model *model, int coord)
{
	return format("%s%s", model->names.coord[coord], order_of(model, coord) == 2 ? "''" : "'");
}

static bool has_coordinate_of_order(const struct form *form, int coord, int order)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD && form->term[i].basis.index == coord &&
		    (order < 0 || form->term[i].basis.order == order))
			return true;
	return false;
}

static bool is_sketched(const struct building *b, int coord)
{
	for (int i = 0; i < b->spec->elements; i++) {
		const struct element *element = &b->spec->element[i];
		if (component_of(element->from) == coord || (element->to && component_of(element->to) == coord))
			return true;
	}
	return false;
}

/* A written equation can be the coordinate's own if it has its highest derivative or, at last, if a mass statement
 * gives that. Coordinates that no network touches have only written ones and choose first. */
enum choice { UNTOUCHED, HIGHEST, ANY };

static bool can_own(const struct building *b, int row, int coord, enum choice choice)
{
	if (choice == UNTOUCHED && is_sketched(b, coord))
		return false;
	bool given = choice == ANY && (find_mass(b->spec, coord) || has_kinetic_energy(b->spec, coord));
	int order = given ? -1 : order_of(b->model, coord);
	const struct form *form = b->segment_equations->residual[row].form;
	return has_coordinate_of_order(form, coord, order) ||
	       (order == order_of(b->model, coord) && has_highest(b, form, coord)) ||
	       (order == 1 && has_slider(b, form, coord));
}

/* An augmenting path of the bipartite matching from equation `row`. */
static bool augment(const struct building *b, int row, enum choice choice, bool *visited)
{
	for (int k = 0; k < b->model->n; k++) {
		/* that of the same number first: the rows of a vector equation */
		int j = (row + k) % b->model->n;
		if (visited[j] || !can_own(b, row, j, choice))
			continue;
		visited[j] = true;
		if (b->owner[j] < 0 || augment(b, b->owner[j], choice, visited)) {
			b->owner[j] = row;
			return true;
		}
	}
	return false;
}

static const char *plural(int count, const char *word)
{
	return format("%d %s%s", count, word, count == 1 ? "" : "s");
}

/* A coordinate that stands nowhere is one of second order that was forgotten. */
static const char *missing_name(const struct building *b, int coord)
{
	return find_in_equations(b->spec, coord, 1) ? highest_name(b->model, coord)
						    : format("%s''", b->model->names.coord[coord]);
}

/* Of a part, or of the assembly's own: counted and reported where its text ends */
static void report_missing(const struct building *b, int missing, int all)
{
	const struct symbol *symbol = b->model->frame.coord[missing];
	struct place at = symbol->part ? place_end(symbol->part->source) : b->spec->end;
	int n = b->model->n, coords = 0, owned = 0;
	for (int j = 0; j < n; j++)
		if (b->model->frame.coord[j]->part == symbol->part) {
			coords++;
			owned += b->owner[j] >= 0;
		}
	if (b->spec->assembly.parts == 0) {
		coords = n;
		owned = all;
	}
	say_error(at, "each coordinate needs an equation of motion",
		  "missing equation: %s, %s; none determines %s", plural(coords, "coordinate"),
		  plural(owned, "equation"), missing_name(b, missing));
}

/* ---- whose equation it is, and with which sign ---- */

/* Without a highest derivative a written equation is that of any coordinate in it to which a mass is given. */
static bool owns_alone(const struct building *b, int written, int coord)
{
	const int row = b->owner[coord];
	if (row >= written || can_own(b, row, coord, HIGHEST))
		return true;
	for (int k = 0; k < b->model->n; k++) {
		const int other = b->owner[k];
		if (k == coord || !can_own(b, row, k, ANY) || (other < written && can_own(b, other, k, HIGHEST)))
			continue;
		say_error(b->segment_equations->residual[row].at, "force EXPR on NAME says on which of them it acts",
			  "is this the equation of %s or of %s? It has no %s", b->model->names.coord[coord],
			  b->model->names.coord[k], highest_name(b->model, coord));
		return false;
	}
	return true;
}

struct leading { struct building *b; struct point *start; const struct form *form; int coord; mpq_ptr value; };

static void add_leading(void *context)
{
	const struct leading *l = context;
	struct collector *c = &l->b->collector;
	const int order = order_of(l->b->model, l->coord);
	const struct form *factor = form_at(l->start, *form_derivatives(c, 1, &l->form, false, l->coord, order));
	RATIONAL value = ZERO;
	if (!is_constant(factor))
		return;
	constant_value(c, factor, value);
	mpq_add(l->value, l->value, value);
}

/* Factors of highest derivatives in one written equation at the start; 0 where inputs are in them */
static void leading_factors(struct leading l, int row, mpq_t *factor)
{
	const struct form *form = l.b->segment_equations->residual[row].form;
	struct form *moving = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		const struct form_term *term = &form->term[i];
		if (term->basis.atom && term->basis.atom->highest)
			form_add_basis(moving, term->basis, term->factor);
		else if (is_highest(&l.b->model->frame, &term->basis) && term->basis.index < l.b->model->n)
			mpq_set(factor[term->basis.index], term->factor);
	}
	l.form = moving;
	for (l.coord = 0; l.coord < l.b->model->n && moving->terms > 0; l.coord++) {
		l.value = factor[l.coord];
		silent_guard(add_leading, &l);
	}
}

/* Whether two coordinates have larger factors in each other's equation */
static bool is_exchanged(const int *owner, int written, int n, mpq_t *factor, int j, int k)
{
	RATIONAL now = ZERO, then = ZERO;
	if (owner[j] >= written || owner[k] >= written)
		return false;
	mpq_mul(now, factor[owner[j] * n + j], factor[owner[k] * n + k]);
	mpq_mul(then, factor[owner[j] * n + k], factor[owner[k] * n + j]);
	mpq_abs(now, now);
	mpq_abs(then, then);
	return mpq_cmp(then, now) > 0;
}

static void factors_at_start(struct building *b, int written, mpq_t *factor)
{
	const struct leading l = { .b = b, .start = point_at_state(b, b->model->initial, NULL) };
	for (int i = 0; i < written; i++)
		leading_factors(l, i, &factor[i * b->model->n]);
}

/* Forces of elements and stops act in the equation of their coordinate. Masses that couple equations leave open which
 * one that is: a positive definite mass matrix has the largest product along its diagonal, whatever rows are multiplied
 * by. The sign of that factor is the side on which a force stands. */
static void orient_equations(struct building *b, int written)
{
	const int n = b->model->n;
	for (int j = 0; j < n; j++)
		if (!owns_alone(b, written, j))
			return;
	mpq_t *factor = rationals((size_t)written * (size_t)n);
	factors_at_start(b, written, factor);
	for (int i = 0; i < n; i++)
		for (int k = 0; k < i; k++)
			if (is_exchanged(b->owner, written, n, factor, i, k)) {
				const int row = b->owner[i];
				b->owner[i] = b->owner[k];
				b->owner[k] = row;
				i = k = 0;
			}
	for (int i = 0; i < n; i++)
		b->reversed[b->owner[i]] = b->owner[i] < written && mpq_sgn(factor[b->owner[i] * n + i]) < 0;
}

/* Each coordinate gets a written equation; sketched ones without get an empty one to which the elements add. */
bool assign_equations(struct building *b)
{
	if (b->model->relative) {
		b->owner = b->model->equations.owner;
		b->reversed = b->model->equations.reversed;
		return true;
	}
	int n = b->model->n, written = b->segment_equations->written, all = written, surplus = -1, missing = -1;
	b->owner = ARRAY(int, n);
	b->reversed = ARRAY(bool, n);
	for (int j = 0; j < n; j++)
		b->owner[j] = -1;
	bool *owns = ARRAY(bool, written);
	for (enum choice choice = UNTOUCHED; choice <= ANY; choice++)
		for (int i = 0; i < written; i++)
			owns[i] = owns[i] || augment(b, i, choice, ARRAY(bool, n));
	for (int i = written - 1; i >= 0; i--)
		surplus = owns[i] ? surplus : i;
	for (int j = 0; j < n; j++) {
		if (b->owner[j] < 0 && is_sketched(b, j))
			b->owner[j] = all++;
		else if (b->owner[j] < 0)
			missing = j;
	}
	if (all > n)
		say_error(b->segment_equations->residual[surplus < 0 ? written - 1 : surplus].at, NULL,
			  "surplus equation: %s for %s", plural(all, "equation"), plural(n, "coordinate"));
	else if (all < n)
		report_missing(b, missing, all);
	else if (written > 0 && b->spec->elements + b->spec->whens > 0)
		orient_equations(b, written);
	return all == n && !diagnostics_errors();
}

/* Over other coordinates than the written ones: equations combined as they are, and those of velocities that stand
 * alone */
static void combine_residuals(const struct building *b, struct segment_equations *s)
{
	const struct relative *relative = b->model->relative;
	int written = b->spec->count.components;
	struct form **equation = ARRAY(struct form *, written);
	for (int j = 0; j < written; j++)
		equation[j] = s->residual[b->owner[j]].form;
	for (int j = 0; j < written; j++)
		s->residual[b->owner[j]].form = combined_equation(relative, j, equation);
	for (int i = written; i < b->model->n; i++)
		add_residual(s, relative->extra[i - written], b->model->frame.coord[i]->at,
			     b->model->frame.coord[i]->at);
}

/* Forces of elements: on the first coordinate as they are, on the second reversed. */
void add_elements(struct building *b, struct segment_equations *s)
{
	const struct relative *relative = b->model->relative;
	int written = b->spec->count.components;
	while (s->residuals < written)
		add_residual(s, NEW(struct form), b->spec->element[0].at, b->spec->element[0].end);
	for (int i = 0; i < s->written; i++)
		if (b->reversed[i])
			s->residual[i].form = form_difference(NEW(struct form), s->residual[i].form);
	for (int i = 0; i < b->spec->elements; i++) {
		const struct element *element = &b->spec->element[i];
		struct residual *from = &s->residual[b->owner[component_of(element->from)]];
		from->form = form_sum(from->form, s->element[i], false);
		if (!element->to)
			continue;
		struct residual *to = &s->residual[b->owner[component_of(element->to)]];
		to->form = form_sum(to->form, s->element[i], true);
	}
	resolve_sliders(b, s);
	if (relative)
		combine_residuals(b, s);
	solve_for_highest(b, s);
}

/* ---- the mass matrix ---- */

static bool zero_column(const struct model *model, int coord)
{
	const mpq_t *A = (order_of(model, coord) == 2 ? model->system.M : model->system.C);
	for (int i = 0; i < model->n; i++)
		if (mpq_sgn(A[i * model->n + coord]) != 0)
			return false;
	return true;
}

static void report_singular(const struct building *b, int coord)
{
	const struct model *model = b->model;
	int order = order_of(model, coord);
	const struct node *highest = find_in_equations(b->spec, coord, order);
	const struct element *mass = find_mass(b->spec, coord);
	struct place at = highest ? highest->at : mass ? mass->at : model->frame.coord[coord]->at;
	if (!highest && !mass && !has_kinetic_energy(b->spec, coord))
		say_error(at,
			  b->spec->lagrange.energies ? "every coordinate needs a mass: it stands in no kinetic energy T"
					    : "every coordinate needs a mass, or a first derivative",
			  "singular mass matrix: no derivative of %s stands in an equation", model->names.coord[coord]);
	else if (zero_column(model, coord))
		say_error(at, "every coordinate needs a mass", "singular mass matrix: the factor of %s is 0",
			  highest_name(model, coord));
	else
		say_error(at, NULL, "singular mass matrix: the equations do not determine %s",
			  highest_name(model, coord));
}

/* Prefer to name a coordinate without any mass over one that elimination happened to stop at. */
void check_mass(const struct building *b)
{
	const struct model *model = b->model;
	int n = model->n, column;
	RATIONALS *inverse = rationals((size_t)n * (size_t)n);
	bool regular = leading_inverse(&model->system, inverse, &column), definite;
	const struct energy *kinetic;
	const int negative = negative_mass(b, n, n, model->system.M, &kinetic, &definite);
	if (negative >= 0)
		report_negative_mass(b, kinetic, negative);
	if (regular || negative >= 0)
		return;
	for (int j = n - 1; j >= 0; j--)
		if (zero_column(model, j))
			column = j;
	report_singular(b, column);
}

/* The equations for all time, in which nothing is taken apart that a state multiplies. */
void collect_full(struct building *b)
{
	int keep = (int)b->collector.keep;
	b->collector.keep = KEEP_ALL;
	b->full = NEW(struct segment_equations);
	b->collector.whole_time = true;
	forget_lets(b->spec);
	collect_equations(b, b->full);
	b->collector.keep = (unsigned)keep;
	if (!diagnostics_errors())
		add_elements(b, b->full);       /* what is solved for goes on through changes of formula, too */
	b->collector.whole_time = false;
	for (struct symbol *s = b->spec->first; s && !b->collector.fixings; s = s->next)
		if (s->kind == SYMBOL_LET && s->made.progress == COLLECTED &&
		    s->made.value->rows * s->made.value->columns == 1)
			s->made.full = s->made.value->cell[0];
}
