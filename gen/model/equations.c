/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Written equations and sketches to residuals, one for each coordinate, and residuals to M, C, K and loads. */
#include "plgen.h"

struct indexed {
	struct building *b;
	struct snapshot *snapshot;
	int index;
};

/* ---- collection ---- */

static void add_residual(struct snapshot *s, struct form *form, struct place at, struct place end)
{
	ENLARGE(s->residual, (size_t)s->residuals + 1);
	s->residual[s->residuals++] = (struct residual){ form, at, end };
}

static bool is_zero(const struct value *value)
{
	return value->rows == 1 && value->columns == 1 && value->cell[0]->terms == 0;
}

/* Left side minus right side, cell by cell; a plain 0 fits any size. */
static void collect_equation(void *context)
{
	struct indexed *work = context;
	const struct equation *equation = &work->b->spec->equation[work->index];
	struct value *left = collect(&work->b->collector, equation->left), *right = collect(&work->b->collector, equation->right);
	const struct value *shape = is_zero(left) ? right : left;
	if (!is_zero(left) && !is_zero(right) && (left->rows != right->rows || left->columns != right->columns))
		error(equation->at, NULL, "the sides of the equation do not fit: %d x %d and %d x %d", left->rows, left->columns, right->rows, right->columns);
	for (int i = 0; i < shape->rows * shape->columns; i++) {
		const struct form *l = is_zero(left) ? left->cell[0] : left->cell[i], *r = is_zero(right) ? right->cell[0] : right->cell[i];
		add_residual(work->snapshot, form_sum(l, r, true), equation->at, equation->end);
	}
}

static int component_of(const struct node *coordinate)
{
	return coordinate->symbol->index + (coordinate->component ? coordinate->component - 1 : 0);
}


/* The element's force on its first coordinate, as it stands on the left side. */
static void collect_element(void *context)
{
	struct indexed *work = context;
	struct building *b = work->b;
	const struct element *element = &b->spec->element[work->index];
	struct value *value = collect(&b->collector, element->value);
	if (value->rows != 1 || value->columns != 1)
		error(element->value->start, NULL, "expected a scalar, found a %d x %d matrix", value->rows, value->columns);
	struct form *form;
	if (element->kind == ELEMENT_FORCE) {
		form = form_sum(NEW(struct form), value->cell[0], true);
	} else {
		int order = element->kind == ELEMENT_MASS ? 2 : element->kind == ELEMENT_DAMPER ? 1 : 0;
		if (!is_constant(value->cell[0]))
			error(element->value->start, "what moves belongs in an equation, or in a force", "a mass, spring or damper needs a constant");
		form = coordinate_form(b->model, component_of(element->from), order);
		if (element->to)
			form = form_sum(form, coordinate_form(b->model, component_of(element->to), order), true);
		form = form_product(&b->collector, value->cell[0], form);
	}
	work->snapshot->element[work->index] = form;
}

void collect_equations(struct building *b, struct snapshot *snapshot)
{
	for (int i = 0; i < b->spec->equations; i++)
		if (b->spec->equation[i].right)
			statement_guard(collect_equation, &(struct indexed){ b, snapshot, i });
	snapshot->written = snapshot->residuals;
	snapshot->element = ARRAY(struct form *, (size_t)b->spec->elements);
	for (int i = 0; i < b->spec->elements; i++)
		statement_guard(collect_element, &(struct indexed){ b, snapshot, i });
}

/* ---- where a derivative stands ---- */

static const struct node *find_derivative(const struct node *node, int coord, int primes)
{
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD && node->primes == primes) {
		int first = component_of(node), last = node->component || !node->symbol->length ? first : first + node->symbol->length - 1;
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
			continue;               /* broken: it has been told */
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
	return find_mass(spec, coord) || find_in_equations(spec, coord, 2) ? 2 : 1;
}

/* ---- does each coordinate have its equation? ---- */

static int order_of(const struct model *model, int coord)
{
	return model->system.velocity[coord] >= 0 ? 2 : 1;
}

static const char *highest_name(const struct model *model, int coord)
{
	return format("%s%s", model->coord_name[coord], order_of(model, coord) == 2 ? "''" : "'");
}

static bool has_coordinate_of_order(const struct form *form, int coord, int order)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD && form->term[i].basis.index == coord && (order < 0 || form->term[i].basis.order == order))
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

/* A written equation can be the coordinate's own if it has its highest derivative or, at last, if a mass statement gives
 * that. Coordinates that no sketch touches have only written ones and choose first. */
enum choice { UNTOUCHED, HIGHEST, ANY };

static bool can_own(const struct building *b, int row, int coord, enum choice choice)
{
	if (choice == UNTOUCHED && is_sketched(b, coord))
		return false;
	int order = choice == ANY && find_mass(b->spec, coord) ? -1 : order_of(b->model, coord);
	return has_coordinate_of_order(b->snapshot->residual[row].form, coord, order);
}

/* An augmenting path of the bipartite matching from equation `row`. */
static bool augment(const struct building *b, int row, enum choice choice, bool *visited)
{
	for (int k = 0; k < b->model->n; k++) {
		int j = (row + k) % b->model->n;        /* that of the same number first: the rows of a vector equation */
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
	return find_in_equations(b->spec, coord, 1) ? highest_name(b->model, coord) : format("%s''", b->model->coord_name[coord]);
}

/* Each coordinate gets a written equation; sketched ones without get an empty one to which the elements add. */
static bool assign_equations(struct building *b)
{
	if (b->model->relative) {
		b->owner = b->model->owner;
		return true;
	}
	int n = b->model->n, written = b->snapshot->written, all = written, surplus = -1, missing = -1;
	b->owner = ARRAY(int, (size_t)n);
	for (int j = 0; j < n; j++)
		b->owner[j] = -1;
	bool *owns = ARRAY(bool, (size_t)written);
	for (enum choice choice = UNTOUCHED; choice <= ANY; choice++)
		for (int i = 0; i < written; i++)
			owns[i] = owns[i] || augment(b, i, choice, ARRAY(bool, (size_t)n));
	for (int i = written - 1; i >= 0; i--)
		surplus = owns[i] ? surplus : i;
	for (int j = 0; j < n; j++) {
		if (b->owner[j] < 0 && is_sketched(b, j))
			b->owner[j] = all++;
		else if (b->owner[j] < 0)
			missing = j;
	}
	if (all > n)
		say_error(b->snapshot->residual[surplus < 0 ? written - 1 : surplus].at, NULL, "surplus equation: %s for %s", plural(all, "equation"),
			  plural(n, "coordinate"));
	else if (all < n)
		say_error(b->spec->end, "each coordinate needs an equation of motion", "missing equation: %s, %s; none determines %s", plural(n, "coordinate"),
			  plural(all, "equation"), missing_name(b, missing));
	return all == n;
}

/* Over other coordinates than the written ones: equations combined as they are, and those of velocities that stand alone */
static void combine_residuals(const struct building *b, struct snapshot *s)
{
	const struct relative *relative = b->model->relative;
	int written = b->spec->components;
	const struct form **equation = ARRAY(const struct form *, (size_t)written);
	for (int j = 0; j < written; j++)
		equation[j] = s->residual[b->owner[j]].form;
	for (int j = 0; j < written; j++)
		s->residual[b->owner[j]].form = combined_equation(relative, j, equation);
	for (int i = written; i < b->model->n; i++)
		add_residual(s, relative->extra[i - written], b->model->coord[i]->at, b->model->coord[i]->at);
}

/* Forces of elements: on the first coordinate as they are, on the second reversed. */
static void add_elements(const struct building *b, struct snapshot *s)
{
	const struct relative *relative = b->model->relative;
	int written = b->spec->components;
	while (s->residuals < written)
		add_residual(s, NEW(struct form), b->spec->element[0].at, b->spec->element[0].end);
	for (int i = 0; i < b->spec->elements; i++) {
		const struct element *element = &b->spec->element[i];
		struct residual *from = &s->residual[b->owner[component_of(element->from)]];
		from->form = form_sum(from->form, s->element[i], false);
		if (!element->to)
			continue;
		struct residual *to = &s->residual[b->owner[component_of(element->to)]];
		to->form = form_sum(to->form, s->element[i], true);
	}
	if (relative)
		combine_residuals(b, s);
}

/* ---- the mass matrix ---- */

static bool zero_column(const struct model *model, int coord)
{
	const mpq_t *A = (const mpq_t *)(order_of(model, coord) == 2 ? model->system.M : model->system.C);
	for (int i = 0; i < model->n; i++)
		if (mpq_sgn(A[i * model->n + coord]) != 0)
			return false;
	return true;
}

static void tell_singular(const struct building *b, int coord)
{
	const struct model *model = b->model;
	int order = order_of(model, coord);
	const struct node *highest = find_in_equations(b->spec, coord, order);
	const struct element *mass = find_mass(b->spec, coord);
	struct place at = highest ? highest->at : mass ? mass->at : model->coord[coord]->at;
	if (!highest && !mass)
		say_error(at, "every coordinate needs a mass, or a first derivative", "singular mass matrix: no derivative of %s stands in an equation",
			  model->coord_name[coord]);
	else if (zero_column(model, coord))
		say_error(at, "every coordinate needs a mass", "singular mass matrix: the factor of %s is 0", highest_name(model, coord));
	else
		say_error(at, NULL, "singular mass matrix: the equations do not determine %s", highest_name(model, coord));
}

/* Prefer to name a coordinate without any mass over one that elimination happened to stop at. */
static void check_mass(const struct building *b)
{
	const struct model *model = b->model;
	int n = model->n, column;
	mpq_t *inverse = rationals((size_t)n * (size_t)n);
	bool regular = leading_inverse(&model->system, inverse, &column);
	rationals_free(inverse, (size_t)n * (size_t)n);
	if (regular)
		return;
	for (int j = n - 1; j >= 0; j--)
		if (zero_column(model, j))
			column = j;
	tell_singular(b, column);
}

static void fill_row(struct linear *system, int row, const struct form *form)
{
	int n = system->n;
	mpq_t *matrix[] = { system->K, system->C, system->M };
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD)
			mpq_set(matrix[form->term[i].basis.order][row * n + form->term[i].basis.index], form->term[i].factor);
}

/* ---- loads and inputs ---- */

static struct load *load_of_wave(struct model *model, const struct wave *wave)
{
	struct linear *system = &model->system;
	for (int i = 0; i < system->loads; i++)
		if (system->load[i].wave == wave)
			return &system->load[i];
	ENLARGE(system->load, (size_t)system->loads + 1);
	struct load *load = &system->load[system->loads++];
	*load = (struct load){ .wave = wave };
	return load;
}

/* Room for t^power: columns of lower powers come first, so that those already there stay. */
static void make_room(struct model *model, struct load *load, int power)
{
	int columns = (power + 1) * (oscillates(load->wave) ? 2 : 1);
	if (columns <= load->columns)
		return;
	ENLARGE(load->force, (size_t)columns);
	for (; load->columns < columns; load->columns++)
		load->force[load->columns] = rationals((size_t)model->system.segments * (size_t)model->n);
	load->powers = power + 1;
}

static int load_column(const struct basis *basis)
{
	return oscillates(basis->wave) ? 2 * basis->power + basis->sine : basis->power;
}

/* The loads of a form get their place; a constant is the power 0 of the polynomial load. */
void place_loads(struct building *b, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind <= BASIS_PI)
			make_room(b->model, load_of_wave(b->model, b->polynomial), 0);
		else if (basis->kind == BASIS_WAVE)
			make_room(b->model, load_of_wave(b->model, basis->wave), basis->power);
	}
}

/* value[load][column] of the terms of a form; `spread` is called for each */
void spread_loads(struct building *b, const struct form *form, void (*spread)(void *context, int load, int column, mpq_srcptr factor), void *context)
{
	struct linear *system = &b->model->system;
	mpq_t constant;
	mpq_init(constant);
	struct form plain = { 0, form->term, 0 };
	while (plain.terms < form->terms && form->term[plain.terms].basis.kind <= BASIS_PI)
		plain.terms++;
	constant_value(&b->collector, &plain, constant);
	if (mpq_sgn(constant) != 0)
		spread(context, (int)(load_of_wave(b->model, b->polynomial) - system->load), 0, constant);
	for (int i = plain.terms; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_WAVE)
			spread(context, (int)(load_of_wave(b->model, basis->wave) - system->load), load_column(basis), form->term[i].factor);
	}
	mpq_clear(constant);
}

struct force_row {
	struct linear *system;
	int segment, row;
};

static void add_force(void *context, int load, int column, mpq_srcptr factor)
{
	const struct force_row *f = context;
	mpq_ptr force = f->system->load[load].force[column][f->segment * f->system->n + f->row];
	mpq_sub(force, force, factor);          /* the residual has the load on the left side */
}

static void fill_inputs(struct linear *system, int row, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_INPUT)
			mpq_neg(system->input[basis->index].force[basis->order][row], form->term[i].factor);
	}
}

static void make_input_forces(struct linear *system)
{
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k < 2; k++)
			system->input[i].force[k] = rationals((size_t)system->n);
}

static void name_inputs(struct building *b)
{
	struct linear *system = &b->model->system;
	system->inputs = b->spec->inputs;
	system->input = ARRAY(struct input, (size_t)system->inputs);
	for (const struct symbol *s = b->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_INPUT)
			system->input[s->index] = (struct input){ .name = s->name, .first_order = s->first_order };
	make_input_forces(system);
}

/* ---- changes of formula in time ---- */

static bool same_cells(const struct value *a, const struct value *b)
{
	if (a->rows != b->rows || a->columns != b->columns)
		return false;
	for (int i = 0; i < a->rows * a->columns; i++)
		if (!same_in_states(a->cell[i], b->cell[i]))
			return false;
	return true;
}

static struct value *collect_in(struct building *b, struct node *node, int segment)
{
	b->collector.interval = segment;
	forget_lets(b->spec);
	return collect(&b->collector, node);
}

/* The first term of sums whose coordinates or inputs are not those of the first segment. */
static const struct node *changing_term(struct building *b, struct node *node, int segment)
{
	const struct node *found = NULL;
	if (node->kind != NODE_SUM)
		return same_cells(collect_in(b, node, 0), collect_in(b, node, segment)) ? NULL : node;
	for (int i = 0; i < node->children && !found; i++)
		found = changing_term(b, node->child[i], segment);
	return found;
}

static const struct node *first_changing_term(struct building *b, int segment)
{
	const struct spec *spec = b->spec;
	const struct node *term = NULL;
	for (int i = 0; i < spec->equations && !term; i++) {
		term = changing_term(b, spec->equation[i].left, segment);
		term = term ? term : changing_term(b, spec->equation[i].right, segment);
	}
	for (int i = 0; i < spec->elements && !term; i++)
		term = changing_term(b, spec->element[i].value, segment);
	return term;
}

static void tell_change(void *context)
{
	struct indexed *work = context;
	struct building *b = work->b;
	const struct spec *spec = b->spec;
	for (int i = 0; i < spec->elements; i++)
		if (spec->element[i].kind != ELEMENT_FORCE && !same_in_states(b->snapshot[0].element[i], work->snapshot->element[i]))
			error(spec->element[i].value->start, "what moves belongs in an equation, or in a force", "a mass, spring or damper needs a constant");
	const struct node *term = first_changing_term(b, work->index);
	b->collector.term = term;
	not_linear(&b->collector, term, format("has a factor that changes at t = %s", readable_text(b->model->system.change[work->index - 1])));
}

static bool same_equations(const struct building *b, const struct snapshot *s)
{
	for (int i = 0; i < b->model->n; i++)
		if (!same_in_states(b->snapshot->residual[i].form, s->residual[i].form))
			return false;
	return true;
}

/* Only loads may change their formula in time. */
static bool check_changes(struct building *b)
{
	for (int s = 1; s < b->model->system.segments; s++)
		if (!same_equations(b, &b->snapshot[s]))
			return statement_guard(tell_change, &(struct indexed){ b, &b->snapshot[s], s });
	return true;
}

/* An equation is as many scalar ones at all times. */
static bool check_sizes(const struct building *b)
{
	const struct snapshot *first = b->snapshot;
	for (int s = 1; s < b->model->system.segments; s++)
		for (int i = 0; i < first->written || i < first[s].written; i++)
			if (i >= first->written || i >= first[s].written || first->residual[i].at.offset != first[s].residual[i].at.offset) {
				say_error((i < first->written ? first : first + s)->residual[i].at, NULL, "the size of the equation changes at t = %s",
					  readable_text(b->model->system.change[s - 1]));
				return false;
			}
	return true;
}

/* ---- what is left over ---- */

static bool holds_atom(const struct form *form)
{
	return form->terms > 0 && form->term[form->terms - 1].basis.kind == BASIS_ATOM;
}

bool is_linear(const struct building *b)
{
	for (int s = 0; s < b->model->system.segments; s++)
		for (int i = 0; i < b->model->n; i++)
			if (holds_atom(b->snapshot[s].residual[i].form) || !same_equations(b, &b->snapshot[s]))
				return false;
	return true;
}

/* The equations for all time, in which nothing is taken apart that a state multiplies. */
void collect_whole(struct building *b)
{
	int keep = (int)b->collector.keep;
	b->collector.keep = KEEP_ALL;
	b->whole = NEW(struct snapshot);
	b->collector.whole_time = true;
	forget_lets(b->spec);
	collect_equations(b, b->whole);
	b->collector.whole_time = false;
	b->collector.keep = (unsigned)keep;
	if (!diagnostics_errors())
		add_elements(b, b->whole);
	for (struct symbol *s = b->spec->first; s && !b->collector.fixings; s = s->next)
		if (s->kind == SYMBOL_LET && s->progress == COLLECTED && s->collected->rows * s->collected->columns == 1)
			s->whole = s->collected->cell[0];
}

/* What depends on time alone, in each interval of time: t < 1 ? ... has one formula there. What is then still no load, such as
 * sqrt(t), is left over if it is the same in all intervals; if it is not, all that is no plain load for all time is. */
static void part_loads(void *context)
{
	struct building *b = context;
	struct collector *c = &b->collector;
	int n = b->model->n, segments = b->model->system.segments;
	b->load = ARRAY(struct form *, (size_t)(segments * n));
	b->time_left = ARRAY(struct form *, (size_t)n);
	struct point *point = point_new(c, 0, NULL);
	for (int i = 0; i < n; i++) {
		const struct form *whole = time_part(b->whole->residual[i].form, false);
		bool same = true;
		for (c->interval = 0; c->interval < segments; c->interval++) {
			struct form *here = form_at(point, whole), *left = time_part(here, true);
			b->load[c->interval * n + i] = form_sum(here, left, true);
			b->time_left[i] = c->interval == 0 ? left : b->time_left[i];
			same = same && same_form(left, b->time_left[i]);
		}
		if (!same)
			b->time_left[i] = time_part(whole, true);
		for (int s = 0; s < segments && !same; s++)
			b->load[s * n + i] = form_sum(whole, b->time_left[i], true);
	}
	c->interval = 0;
}

static const struct form *load_form(const struct building *b, int segment, int row)
{
	return b->whole ? b->load[segment * b->model->n + row] : b->snapshot[segment].residual[row].form;
}

/* ---- the whole ---- */

/* The first in the text of those that are not piecewise linear; or of all */
static const struct atom *first_atom(const struct building *b, bool all)
{
	const struct atom *first = NULL;
	for (int s = 0; s < b->model->system.segments; s++)
		for (int i = 0; i < b->model->n; i++)
			for (int k = 0; k < b->snapshot[s].residual[i].form->terms; k++) {
				const struct basis *basis = &b->snapshot[s].residual[i].form->term[k].basis;
				const struct atom *a = basis->atom;
				if (a && (!first || a->node->start.offset < first->node->start.offset) && (all || !is_piecewise_form(form_unit(*basis))))
					first = a;
			}
	return first;
}

static bool keeps_atoms(const struct building *b)
{
	return first_atom(b, true) != NULL;
}

static const char input_rewrite[] = "the load as an input is exact beside it";

/* Scheme exact was asked for, and what it would have to switch on it cannot */
static void tell_atom(void *context)
{
	const struct building *b = context;
	const struct atom *atom = first_atom(b, false);
	bool changes = !atom;
	atom = atom ? atom : first_atom(b, true);
	const char *rewrite = changes ? input_rewrite : rewrite_of(atom->node);
	error(atom->node->start, format("%s%setd1, etdrk2, etdrk4, nc2, nc3, dq4, bm3 and pl are the schemes that could", rewrite, *rewrite ? "; " : ""),
	      changes ? "switching beside loads that change their formula in time is not built yet: scheme exact cannot treat '%s'"
		      : "'%s' is not piecewise linear: scheme exact cannot treat it", text_between(atom->node->start, atom->node->end));
}

/* No scheme was asked for, and exact is not possible: what stood in its way */
static void find_obstacle(void *context)
{
	struct building *b = context;
	struct model *model = b->model;
	const struct atom *atom = first_atom(b, false), *any = first_atom(b, true);
	const char *why = "is not piecewise linear", *rewrite;
	model->obstacle = atom ? atom->node : any ? any->node : NULL;
	for (int s = 1; s < model->system.segments && !model->obstacle; s++) {
		model->obstacle = same_equations(b, &b->snapshot[s]) ? NULL : first_changing_term(b, s);
		why = format("has a factor that changes at t = %s", readable_text(model->system.change[s - 1]));
	}
	b->collector.interval = 0;
	forget_lets(b->spec);
	if (!model->obstacle)
		return;
	if (!atom && any)
		why = "switches beside loads that change their formula in time";
	rewrite = !atom && any ? input_rewrite : rewrite_of(model->obstacle);
	model->obstacle_text = format("%s%s%s", why, *rewrite ? "; " : "", rewrite);
}

/* Exact where nothing is left over and no scheme was asked for; the equations for all time where something is. */
static bool settle_scheme(struct building *b)
{
	struct model *model = b->model;
	bool linear = is_linear(b);
	if (!linear && !model->scheme_at.source && !b->overrides->solution && !is_piecewise_linear(b)) {
		model->scheme = SCHEME_ETDRK4;
		silent_guard(find_obstacle, b);
	}
	b->collector.scheme = scheme_name(model->scheme);
	if (model->scheme == SCHEME_EXACT && b->overrides->loads_left) {
		say_error(model->scheme_at.source ? model->scheme_at : b->spec->name_at, "etd1, etdrk2, etdrk4, nc2, nc3, dq4 and bm3 have; pl holds loads over a step",
			  "--loads leftover needs a scheme with a quadrature: exact has none");
		return false;
	}
	if (model->scheme == SCHEME_EXACT && !linear && is_piecewise_linear(b)) {
		find_regions(b);
		collect_whole(b);               /* for outputs and NAME_rhs */
		if (!diagnostics_errors())
			statement_guard(part_loads, b);
		return !diagnostics_errors();
	}
	if (model->scheme == SCHEME_EXACT && keeps_atoms(b))
		return statement_guard(tell_atom, b);
	if (model->scheme == SCHEME_EXACT)
		return check_changes(b);
	if (!linear || b->overrides->loads_left || b->spec->has_operator)
		collect_whole(b);
	model->loads_left = b->whole && b->overrides->loads_left;
	if (b->whole && !diagnostics_errors())
		statement_guard(part_loads, b);
	return !diagnostics_errors();
}

/* The same coordinates, loads and inputs, nothing acting yet */
struct linear empty_system(const struct model *model)
{
	struct linear system = linear_like(&model->system);
	system.loads = model->system.loads;
	system.load = ARRAY(struct load, (size_t)system.loads);
	for (int l = 0; l < system.loads; l++) {
		system.load[l] = model->system.load[l];
		system.load[l].force = ARRAY(mpq_t *, (size_t)system.load[l].columns);
		for (int k = 0; k < system.load[l].columns; k++)
			system.load[l].force[k] = rationals((size_t)system.segments * (size_t)system.n);
	}
	system.inputs = model->system.inputs;
	system.input = ARRAY(struct input, (size_t)system.inputs);
	for (int i = 0; i < system.inputs; i++)
		system.input[i] = model->system.input[i];
	make_input_forces(&system);
	return system;
}

void fill_system(struct building *b, struct linear *system, int segment, int row, const struct form *residual)
{
	fill_row(system, row, residual);
	fill_inputs(system, row, residual);
	spread_loads(b, residual, add_force, &(struct force_row){ system, segment, row });
}

void build_system(struct building *b)
{
	struct model *model = b->model;
	struct linear *system = &model->system;
	size_t cells = (size_t)model->n * (size_t)model->n;
	if (!check_sizes(b) || !assign_equations(b))
		return;
	for (int s = 0; s < system->segments; s++)
		add_elements(b, &b->snapshot[s]);
	if (!settle_scheme(b))
		return;
	const struct snapshot *rows = b->whole ? b->whole : b->snapshot;
	system->M = rationals(cells);
	system->C = rationals(cells);
	system->K = rationals(cells);
	for (int i = 0; i < model->n; i++)
		fill_row(system, i, rows->residual[i].form);
	check_mass(b);
	name_inputs(b);
	for (int i = 0; i < model->n; i++)
		fill_inputs(system, i, rows->residual[i].form);
	for (int s = 0; s < system->segments && !model->loads_left; s++)
		for (int i = 0; i < model->n; i++)
			place_loads(b, load_form(b, s, i));
	if (model->switching)
		place_region_loads(b);
	for (int s = 0; s < system->segments && !model->loads_left; s++)
		for (int i = 0; i < model->n; i++)
			spread_loads(b, load_form(b, s, i), add_force, &(struct force_row){ system, s, i });
	model->owner = b->owner;
	model->residual = rows->residual;
	model->snapshot = b->snapshot;
	model->whole = b->whole;
}
