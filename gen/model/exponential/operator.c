/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear operator A of y' = A y + loads + inputs + r(t, y), and the remainder r. Without a statement A is what the
 * equations have with constant coefficients; `operator at` takes the Jacobian with some names fixed. Of an entry that
 * still depends on anything, its constant part counts. r is exact: what the equations are minus what A takes. */
#include "model/building.h"
#include "model/contacts/contacts.h"
#include "model/linear/relative.h"

/* ---- the fixed names ---- */

struct point_work {
	struct building *b;
	int which;                  /* of a schedule */
	mpq_srcptr value;           /* of its name; NULL: as written */
	int fixings;
	struct fixing *fixing;
};

static void add_fixing(struct point_work *work, const struct fixed *fixed, int coord, const struct form *value)
{
	struct fixing *f = MORE(work->fixing, work->fixings);
	*f = (struct fixing){ .at = fixed->at, .symbol = fixed->symbol, .coord = coord, .order = fixed->primes };
	f->form = value;
	mpq_init(f->value);
	if (work->value && fixed->values > 1)
		f->form = form_constant(work->value);
	if (fixed->symbol || fixed->values > 1) /* t stays a form, so that quarter turns are exact */
		constant_value(&work->b->collector, f->form, f->value);
}

static void check_order(const struct fixed *fixed)
{
	if (fixed->symbol && fixed->symbol->kind == SYMBOL_COORD && fixed->primes >= fixed->symbol->highest)
		error(fixed->at, NULL, "%s is of first order: its derivative follows from the equations",
		      fixed->symbol->name);
}

/* One value of one name; of a vector each component, from a vector of values or from one for all. */
static void evaluate_fixed(struct point_work *work, const struct fixed *fixed)
{
	struct collector *c = &work->b->collector;
	const struct symbol *symbol = fixed->symbol;
	struct node *node = fixed->value[fixed->values > 1 && !work->value ? work->which : 0];
	bool vector = symbol && symbol->kind == SYMBOL_COORD && symbol->length && !fixed->component;
	int count = vector ? symbol->length : 1,
	    first = symbol && symbol->kind == SYMBOL_COORD
			    ? symbol->index + (fixed->component ? fixed->component - 1 : 0)
			    : 0;
	check_order(fixed);
	const struct value *value = collect_constants(c, node);
	int cells = value->rows * value->columns;
	if (cells != 1 && cells != count)
		error(node->start, NULL, "sizes do not fit: %d components, the value is %d x %d", count, value->rows,
		      value->columns);
	for (int i = 0; i < count; i++)
		add_fixing(work, fixed, first + i, value->cell[cells == 1 ? 0 : i]);
}

static mpq_t *find_fixed(struct point_work *work, int coord, int order)
{
	for (int i = 0; i < work->fixings; i++)
		if (work->fixing[i].symbol && work->fixing[i].symbol->kind == SYMBOL_COORD &&
		    work->fixing[i].coord == coord && work->fixing[i].order == order)
			return &work->fixing[i].value;
	return NULL;
}

/* What is fixed of written coordinates, for those that the model is over. Of coordinates that are measured from each
 * other all are fixed or none (relative.c). */
static void fix_relative(struct point_work *work)
{
	const struct model *model = work->b->model;
	int written = work->b->spec->count.components;
	for (int order = 0; order < 2; order++) {
		mpq_t **value = ARRAY(mpq_t *, written), *kept = rationals(written);
		for (int j = 0; j < written; j++)
			value[j] = find_fixed(work, j, order);
		for (int j = 0; j < written; j++)
			if (value[j] && model->relative->link[j].kind != LINK_NONE)
				relative_value(model->relative, j, value, kept[j]);
		for (int j = 0; j < written; j++)
			if (value[j] && model->relative->link[j].kind != LINK_NONE)
				mpq_set(*value[j], kept[j]);
	}
}

static void evaluate_point(void *context)
{
	struct point_work *work = context;
	for (int i = 0; i < work->b->spec->operators.fixeds; i++)
		evaluate_fixed(work, &work->b->spec->operators.fixed[i]);
	if (work->b->model->relative)
		fix_relative(work);
}

/* ---- a schedule: one name with several values ---- */

static const struct fixed *banked(const struct spec *spec)
{
	for (int i = 0; i < spec->operators.fixeds; i++)
		if (spec->operators.fixed[i].values > 1)
			return &spec->operators.fixed[i];
	return NULL;
}

static void check_schedule(void *context)
{
	const struct building *b = context;
	const struct fixed *schedule = banked(b->spec);
	for (int i = 0; i < b->spec->operators.fixeds; i++)
		if (schedule && b->spec->operators.fixed[i].values > 1 && &b->spec->operators.fixed[i] != schedule)
			error(b->spec->operators.fixed[i].at, NULL,
			      "an operator schedule varies one name: %s has several values already",
			      text_between(schedule->at, schedule->end));
	if (schedule && schedule->symbol && schedule->symbol->kind == SYMBOL_COORD && schedule->symbol->length &&
	    !schedule->component)
		error(schedule->at, NULL, "an operator schedule is chosen by one number: name a component");
}

/* How many operators: as many as values, or the number asked for between two */
static int size_of_schedule(struct building *b, const struct fixed *schedule)
{
	enum { MOST_OPERATORS = 256 };
	const struct node *count = b->spec->operators.count;
	RATIONAL number = ZERO;
	if (!count)
		return schedule ? schedule->values : 1;
	if (!schedule || schedule->values != 2)
		error(count->start, "operator 16 at w = 0, 15",
		      "a number of operators goes with two values of one name");
	collect_constant(&b->collector, b->spec->operators.count, number);
	if (mpz_cmp_ui(mpq_denref(number), 1) != 0 || mpq_cmp_ui(number, 1, 1) < 0 ||
	    mpq_cmp_ui(number, MOST_OPERATORS, 1) > 0)
		error(count->start, NULL, "a number of operators is a whole number from 1 to %d, found %s",
		      MOST_OPERATORS, readable_text(number));
	return (int)mpz_get_si(mpq_numref(number));
}

struct schedule_work {
	struct building *b;
	const struct fixed *schedule;
	int operators;
	mpq_t *value;               /* ends of the parts of the range that they serve; NULL: values are written */
};

static void nearest_root(mpq_ptr value)
{
	REAL root = WITH_BITS(53);
	mpfr_set_q(root, value, MPFR_RNDN);
	mpfr_sqrt(root, root, MPFR_RNDN);
	mpfr_get_q(value, root);
}

/* Parts of equal length in the square of the value, as stiffness and mass terms of a turning frame follow it. Each
 * operator is that at the upper end of its part, as of values that are written: softer than the model it would make
 * the remainder drive the motion. */
static void divide_range(void *context)
{
	struct schedule_work *w = context;
	w->operators = size_of_schedule(w->b, w->schedule);
	if (!w->b->spec->operators.count)
		return;
	size_t count = (size_t)w->operators;
	RATIONALS *limit = rationals(2);
	RATIONAL length = ZERO, part = ZERO;
	for (int k = 0; k < 2; k++)
		collect_constant(&w->b->collector, w->schedule->value[k], limit[k]);
	if (mpq_sgn(limit[0]) < 0 || mpq_cmp(limit[0], limit[1]) >= 0)
		error(w->schedule->value[0]->start, "they are divided into parts of equal length in the square",
		      "operators between two values take the first from 0 up, and the second above it");
	for (int k = 0; k < 2; k++)
		mpq_mul(limit[k], limit[k], limit[k]);
	mpq_sub(length, limit[1], limit[0]);
	w->value = rationals(count);
	for (int k = 0; k < w->operators; k++) {
		mpq_set_si(part, k + 1, (unsigned long)w->operators);
		mpq_canonicalize(part);
		mpq_mul(part, part, length);
		mpq_add(w->value[k], limit[0], part);
		nearest_root(w->value[k]);
	}
}

static void check_rising(const struct building *b, const struct fixed *schedule)
{
	const struct operator *operator = b->model->schedule.operator;
	for (int k = 1; k < b->model->schedule.operators; k++)
		if (mpq_cmp(operator[k - 1].at, operator[k].at) >= 0)
			error(schedule->value[b->spec->operators.count ? 1 : k]->start,
			      "the step uses the first whose value is not below the current one",
			      "the values of an operator schedule rise");
}

/* What a step compares: the name that the schedule varies, as it is now */
static void find_selector(void *context)
{
	struct building *b = context;
	struct collector *c = &b->collector;
	const struct fixed *schedule = banked(b->spec);
	struct symbol *symbol = schedule->symbol;
	struct node name = { .kind = symbol ? NODE_NAME : NODE_TIME,
			     .at = schedule->at,
			     .start = schedule->at,
			     .end = schedule->end,
			     .symbol = symbol,
			     .primes = schedule->primes,
			     .component = schedule->component };
	check_rising(b, schedule);
	c->whole_time = true;
	forget_lets(b->spec);
	struct node *kept = NEW(struct node);
	*kept = name;
	const struct value *value = collect(c, kept);
	c->whole_time = false;
	if (value->rows * value->columns != 1)
		error(schedule->at, NULL, "an operator schedule is chosen by one number, found a %d x %d matrix",
		      value->rows,
		      value->columns);
	b->model->schedule.selector = value->cell[0];
}

/* ---- the Jacobian ---- */

struct jacobian_work {
	struct point_work *point;
	struct operator *operator;
};

static void constant_part(struct collector *c, const struct form *form, mpq_ptr value)
{
	const struct form plain = constant_terms(form);
	constant_value(c, &plain, value);
}

static bool fixes_lets(const struct point_work *point)
{
	for (int i = 0; i < point->fixings; i++)
		if (point->fixing[i].symbol && point->fixing[i].symbol->kind == SYMBOL_LET)
			return true;
	return false;
}

/* The equations with lets replaced by their fixed values */
static const struct segment_equations *fixed_equations(const struct point_work *point)
{
	struct building *b = point->b;
	struct collector *c = &b->collector;
	if (!fixes_lets(point))
		return b->full;
	struct segment_equations *kept = b->full;
	c->fixings = point->fixings;
	c->fixing = point->fixing;
	collect_full(b);
	c->fixings = 0;
	struct segment_equations *fixed = b->full;
	b->full = kept;
	if (diagnostics_errors())
		abandon();
	return fixed;
}

/* The highest derivative of a coordinate of first order keeps its factors: it is what the equations are solved for. */
static void keep_highest(const struct model *model, mpq_t *C)
{
	for (int j = 0; j < model->n; j++)
		for (int i = 0; i < model->n && model->system.velocity[j] < 0; i++)
			mpq_set(C[i * model->n + j], model->system.C[i * model->n + j]);
}

/* C and K at the point: constant parts of d residual / d q' and d residual / d q */
static void find_jacobian(void *context)
{
	struct jacobian_work *work = context;
	struct building *b = work->point->b;
	struct collector *c = &b->collector;
	const struct linear *system = &b->model->system;
	int n = b->model->n;
	const struct segment_equations *equations = fixed_equations(work->point);
	const struct form **residual = ARRAY(const struct form *, n);
	struct point *point = point_new(c, work->point->fixings, work->point->fixing);
	point_at_values(point);
	for (int i = 0; i < n; i++)
		residual[i] = equations->residual[i].form;
	keep_highest(b->model, work->operator->C);
	for (int state = 0; state < system->states; state++) {
		int coord = system->coord[state], order = state >= n;
		mpq_t *matrix = order ? work->operator->C : work->operator->K;
		struct form **slope = form_derivatives(c, n, residual, false, coord, order);
		for (int i = 0; i < n; i++)
			constant_part(c, form_at(point, slope[i]), matrix[i * n + coord]);
	}
}

/* ---- the remainder ---- */

/* Inputs that the linear core carries are not in the remainder, nor are highest derivatives; loads: below. */
static bool is_carried(const struct building *b, const struct basis *basis)
{
	const struct model *model = b->model;
	if (depends_on_time_only(basis))
		return !model->remainder.loads;
	if (basis->kind == BASIS_INPUT)
		return true;
	return is_highest(&model->frame, basis);
}

/* What inputs are with the spec's values of params beside what they are with the instance's */
static struct form *inputs_carried(struct building *b, const struct form *equation)
{
	struct form *more = NEW(struct form);
	for (int k = 0; k < 2 && parts_params(b); k++) {
		const struct form *from = k ? equation : nominal_form(b, equation);
		for (int i = 0; i < from->terms; i++)
			if (from->term[i].basis.kind == BASIS_INPUT)
				more = form_sum(more, form_single(from->term[i].basis, from->term[i].factor), k);
	}
	return more;
}

/* The force that the remainder is on an equation: A's terms minus the equation's own, which stand on the left side */
static struct form *remainder_of(struct building *b, const struct operator *operator, int row)
{
	const struct linear *system = &b->model->system;
	const struct form *equation = b->full->residual[row].form;
	struct form *left = inputs_carried(b, equation);
	if (!b->model->remainder.loads)
		left = form_sum(left, b->time_left[row], true);
	for (int i = 0; i < equation->terms; i++)
		if (!is_carried(b, &equation->term[i].basis))
			left = form_sum(left, form_single(equation->term[i].basis, equation->term[i].factor), true);
	for (int state = 0; state < system->states; state++) {
		struct basis basis = { .kind = BASIS_COORD,
				       .index = system->coord[state],
				       .order = state >= system->n };
		mpq_srcptr factor = (state >= system->n ? operator->C : operator->K)[row * system->n + basis.index];
		left = form_sum(left, form_single(basis, factor), false);
	}
	return left;
}

struct form *carried_form(const struct model *model, int force_column)
{
	const struct form *equation = model->equations.residual[model->remainder.row[force_column]].form;
	struct form *carried = NEW(struct form);
	form_add_to(carried, model->schedule.operator[0].left[force_column], NULL);
	for (int i = 0; i < equation->terms; i++)
		if (!is_highest(&model->frame, &equation->term[i].basis))
			form_add_basis(carried, equation->term[i].basis, equation->term[i].factor);
	return carried;
}

/* Whether contacts that rest press on a row, where a scheme leaves that over */
static bool is_pressed(const struct model *model, int row)
{
	bool any = false;
	for (int i = 0; i < model->contacts.impacts && is_event_split(model->scheme); i++)
		for (int j = 0; j < model->n && model->contacts.impact[i].bounces; j++)
			any = any || (is_moved_by(&model->contacts.impact[i], j) &&
				      mpq_sgn(model->system.M[row * model->n + j]) != 0);
	return any;
}

static void find_force_columns(struct building *b)
{
	struct model *model = b->model;
	int n = model->n;
	struct form **all = ARRAY(struct form *, (size_t)(model->schedule.operators * n));
	model->remainder.row = ARRAY(int, n);
	for (int i = 0; i < n; i++) {
		bool any = is_pressed(model, i);
		for (int k = 0; k < model->schedule.operators; k++) {
			all[k * n + i] = remainder_of(b, &model->schedule.operator[k], i);
			any = any || all[k * n + i]->terms > 0;
		}
		if (any)
			model->remainder.row[model->remainder.force_columns++] = i;
	}
	/* A jump splits steps of a linear model, too, whose parts go by forces: one that is 0 */
	if (model->remainder.force_columns == 0 && model->contacts.impacts > 0 && is_event_split(model->scheme))
		model->remainder.force_columns = 1;
	for (int k = 0; k < model->schedule.operators; k++) {
		struct operator *operator = &model->schedule.operator[k];
		operator->left = ARRAY(struct form *, model->remainder.force_columns);
		for (int e = 0; e < model->remainder.force_columns; e++)
			operator->left[e] = all[k * n + model->remainder.row[e]];
	}
}

/* What Newton's method needs of it */
static void differentiate_left(void *context)
{
	struct building *b = context;
	struct model *model = b->model;
	const struct linear *system = &model->system;
	const struct form *const *left = (const struct form *const *)model->schedule.operator[0].left;
	if (model->equations.implicit && system->n > MOST_TOGETHER)
		return;                         /* derivatives of all iterates: differences take their place */
	model->remainder.slope = ARRAY(struct form *, (size_t)(model->remainder.force_columns * system->states));
	for (int i = 0; i < system->states; i++) {
		struct form **slope = form_derivatives(&b->collector, model->remainder.force_columns, left, false,
						       system->coord[i],
						       i >= system->n);
		for (int e = 0; e < model->remainder.force_columns; e++)
			model->remainder.slope[e * system->states + i] = slope[e];
	}
}

/* ---- forcing terms that the remainder reads get load states, as loads do ---- */

struct visit {
	bool *seen;                 /* per atom */
	void (*visit)(void *context, const struct form *form);
	void *context;
};

static void visit_form(const struct visit *v, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *atom = form->term[i].basis.atom;
		if (!atom || v->seen[atom->index])
			continue;
		v->seen[atom->index] = true;
		for (int k = 0; k < atom->operands; k++)
			visit_form(v, atom->operand[k]);
	}
	v->visit(v->context, form);
}

void visit_remainders(const struct model *model, void (*visit)(void *, const struct form *), void *context)
{
	if (model->schedule.operators == 0)
		return;
	struct visit v = { ARRAY(bool, (size_t)atoms_count(model->equations.atoms)), visit, context };
	for (int k = 0; k < model->schedule.operators; k++)
		for (int e = 0; e < model->remainder.force_columns; e++)
			visit_form(&v, model->schedule.operator[k].left[e]);
	for (int i = 0; model->remainder.slope && i < model->remainder.force_columns * model->system.states; i++)
		visit_form(&v, model->remainder.slope[i]);
	if (model->schedule.selector)
		visit_form(&v, model->schedule.selector);
}

static void place_forcings(void *context, const struct form *form)
{
	struct building *b = context;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_FORCING && !is_polynomial(basis->forcing))
			place_loads(b, form_single(*basis, form->term[i].factor));
	}
}

/* ---- the whole ---- */

static const char *point_text(const struct spec *spec, int which, mpq_srcptr banked_value)
{
	const char *text = "";
	for (int i = 0; i < spec->operators.fixeds; i++) {
		const struct fixed *f = &spec->operators.fixed[i];
		bool found = banked_value && f->values > 1;
		const struct node *value = f->value[f->values > 1 && !found ? which : 0];
		text = format("%s%s%s = %s", text, *text ? ", " : "", text_between(f->at, f->end),
			      found ? readable_text(banked_value) : text_between(value->start, value->end));
	}
	return text;
}

static bool fixes(const struct fixing *fixing, const struct fixed *name)
{
	bool coordinate = name->symbol && name->symbol->kind == SYMBOL_COORD;
	int coord = coordinate ? name->symbol->index + (name->component ? name->component - 1 : 0) : 0;
	return fixing->symbol == name->symbol && fixing->order == name->primes && fixing->coord == coord;
}

/* Of the coordinate at place i the row of its equation: then M, and what shall be symmetric, is so as written */
static mpq_ptr of_coordinates(const struct building *b, const mpq_t *matrix, int i, int j)
{
	return (mpq_ptr)matrix[b->owner[i] * b->model->n + j];
}

/* matrix <- its symmetric part */
static void keep_symmetric(const struct building *b, mpq_t *matrix)
{
	RATIONAL mean = ZERO;
	for (int i = 0; i < b->model->n; i++)
		for (int j = 0; j < i; j++) {
			mpq_ptr lower = of_coordinates(b, matrix, i, j), upper = of_coordinates(b, matrix, j, i);
			mpq_add(mean, lower, upper);
			mpq_div_2exp(mean, mean, 1);
			mpq_set(lower, mean);
			mpq_set(upper, mean);
		}
}

/* Has M q'' + C q' + K q real modes, all of them symmetric? C M^-1 K = K M^-1 C (Caughey and O'Kelly 1965) */
static bool is_classical(const struct building *b, const mpq_t *C, const mpq_t *K)
{
	int n = b->model->n, column;
	size_t cells = (size_t)n * (size_t)n;
	mpq_t *mass = rationals(cells), *inverse = rationals(cells), *damping = rationals(cells),
	      *stiffness = rationals(cells), *solved = rationals(cells), *product = rationals(cells);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			mpq_set(mass[i * n + j], of_coordinates(b, b->model->system.M, i, j));
			mpq_set(damping[i * n + j], of_coordinates(b, C, i, j));
			mpq_set(stiffness[i * n + j], of_coordinates(b, K, i, j));
		}
	bool classical = rational_inverse(n, mass, inverse, &column);
	rational_product(n, n, n, inverse, stiffness, solved);
	rational_product(n, n, n, damping, solved, product);
	for (int i = 0; i < n; i++)             /* of symmetric matrices, K M^-1 C is the transpose */
		for (int j = 0; j < i && classical; j++)
			classical = mpq_equal(product[i * n + j], product[j * n + i]);
	return classical;
}

/* What has real modes: the symmetric part of K, and that of C where it is diagonal in them */
static void keep_modes(const struct building *b, struct operator *operator)
{
	size_t cells = (size_t)b->model->n * (size_t)b->model->n;
	mpq_t *C = rationals(cells), *K = rationals(cells);
	for (size_t i = 0; i < cells; i++) {
		mpq_set(C[i], operator->C[i]);
		mpq_set(K[i], operator->K[i]);
	}
	operator->C = C;
	operator->K = K;
	keep_symmetric(b, K);
	keep_symmetric(b, C);
	for (size_t i = 0; !is_classical(b, C, K) && i < cells; i++)
		mpq_set_ui(C[i], 0, 1);
}

static bool add_operator(const struct schedule_work *w, int which)
{
	struct building *b = w->b;
	struct model *model = b->model;
	const struct fixed *schedule = w->schedule;
	struct operator *operator = &model->schedule.operator[which];
	size_t cells = (size_t)model->n * (size_t)model->n;
	struct point_work point = { b, which, w->value ? w->value[which] : NULL, 0, NULL };
	operator->C = model->system.C;
	operator->K = model->system.K;
	/* what holds coupling terms has an operator of its own */
	operator->text = chooses_operator(model->scheme) ? point_text(b->spec, which, point.value) : "";
	mpq_init(operator->at);
	if (!*operator->text)
		return true;
	operator->C = rationals(cells);
	operator->K = rationals(cells);
	if (!statement_guard(evaluate_point, &point))
		return false;
	diagnostics_context(format("at the operator's point, %s, where the derivatives of the equations are taken",
				   operator->text));
	bool found = statement_guard(find_jacobian, &(struct jacobian_work){ &point, operator });
	diagnostics_context(NULL);
	if (!found)
		return false;
	for (int i = 0; schedule && i < point.fixings; i++)
		if (fixes(&point.fixing[i], schedule))
			mpq_set(operator->at, point.fixing[i].value);
	return true;
}

void build_operators(struct building *b)
{
	struct model *model = b->model;
	const struct fixed *schedule = chooses_operator(model->scheme) ? banked(b->spec) : NULL;
	if (!b->full || !statement_guard(check_schedule, b))
		return;
	struct schedule_work work = { .b = b, .schedule = schedule, .operators = 1 };
	bool good = true;
	if (chooses_operator(model->scheme) && !statement_guard(divide_range, &work))
		return;
	model->schedule.operators = work.operators;
	model->schedule.operator = ARRAY(struct operator, model->schedule.operators);
	for (int k = 0; k < model->schedule.operators && good; k++) {
		good = add_operator(&work, k);
		if (good && scheme_row(model->scheme)->modes)
			keep_modes(b, &model->schedule.operator[k]);
	}
	if (!good || (model->schedule.operators > 1 && !statement_guard(find_selector, b)))
		return;
	find_force_columns(b);
	if (model->remainder.force_columns == 0) {        /* then every operator is the equations' own */
		model->schedule.operators = 0;
		model->schedule.selector = NULL;
		return;
	}
	if (scheme_row(model->scheme)->collocates)
		statement_guard(differentiate_left, b);
	visit_remainders(model, place_forcings, b);
	if (scheme_row(model->scheme)->modes)
		split_remainder(b);
}

struct linear operator_system(const struct model *model, int k)
{
	struct linear system = model->system;
	system.C = model->schedule.operator[k].C;
	system.K = model->schedule.operator[k].K;
	system.force_columns = model->remainder.force_columns;
	system.force_column = ARRAY(mpq_t *, model->remainder.force_columns);
	for (int e = 0; e < model->remainder.force_columns; e++) {
		system.force_column[e] = rationals(model->n);
		mpq_set_ui(system.force_column[e][model->remainder.row[e]], 1, 1);
	}
	return system;
}
