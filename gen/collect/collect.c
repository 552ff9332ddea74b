/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Symbolic collection: nodes to values whose cells are forms, linear in what the linear core can carry. */
#include "collect/collect.h"

static struct value *collect_node(struct collector *c, struct node *node);
static bool is_timely(struct node *node);

/* ---- values: matrices of forms; a scalar is 1 x 1 ---- */

static struct value *value_new(int rows, int columns)
{
	struct value *value = NEW(struct value);
	*value = (struct value){ rows, columns, ARRAY(struct form *, (size_t)rows * (size_t)columns) };
	for (int i = 0; i < rows * columns; i++)
		value->cell[i] = NEW(struct form);
	return value;
}

static struct value *scalar(struct form *form)
{
	struct value *value = NEW(struct value);
	*value = (struct value){ 1, 1, ARRAY(struct form *, 1) };
	value->cell[0] = form;
	return value;
}

static const char *shape_text(const struct value *value)
{
	return format("%d x %d", value->rows, value->columns);
}

static bool is_scalar(const struct value *value)
{
	return value->rows == 1 && value->columns == 1;
}

bool is_plain_zero(const struct value *value)
{
	return is_scalar(value) && value->cell[0]->terms == 0;
}

struct form *scalar_of(const struct value *value, const struct node *node, const char *note)
{
	if (!is_scalar(value))
		error(node->start, note, "expected a scalar, found a %d x %d matrix", value->rows, value->columns);
	return value->cell[0];
}

static struct form *collect_scalar(struct collector *c, struct node *node)
{
	return scalar_of(collect_node(c, node), node, NULL);
}

/* ---- what cannot be treated ---- */

static void need_constant(const struct collector *c, const struct node *node, const char *what)
{
	if (c->constant_only)
		error(node->at, NULL, "%s is not a constant", what);
}

/* ---- functions ---- */

/* The argument of a function that no exact scheme will take apart. */
static struct value *collect_argument(struct collector *c, const struct node *node)
{
	const struct node *outer = c->argument, *term = c->term;
	c->argument = node;
	struct value *x = collect_node(c, node->child[0]);
	c->argument = outer;
	c->term = term;
	return x;
}

/* Cell by cell; a scalar goes with every cell of the others */
static struct value *collect_piecewise(struct collector *c, struct node *node)
{
	struct value **argument = ARRAY(struct value *, node->children), *shape = NULL;
	const bool reading = c->reading;
	for (int i = 0; i < node->children; i++) {
		/* in an output it is known again by what it reads in the equations */
		c->reading = reading && node->function != FN_FRICTION;
		argument[i] = collect_node(c, node->child[i]);
		c->reading = reading;
		bool single = is_scalar(argument[i]);
		if (!single && shape && (shape->rows != argument[i]->rows || shape->columns != argument[i]->columns))
			error(node->child[i]->start, NULL, "sizes do not fit: %s and %s", shape_text(shape),
			      shape_text(argument[i]));
		shape = single ? shape : argument[i];
	}
	struct value *result = shape ? value_new(shape->rows, shape->columns) : value_new(1, 1);
	struct form **x = ARRAY(struct form *, node->children);
	for (int k = 0; k < result->rows * result->columns; k++) {
		for (int i = 0; i < node->children; i++)
			x[i] = argument[i]->cell[is_scalar(argument[i]) ? 0 : k];
		result->cell[k] = piecewise_cell(c, node, x);
	}
	return result;
}

/* Functions apply to each cell. */
static struct value *collect_of_vectors(struct collector *c, struct node *node);

static struct value *collect_call(struct collector *c, struct node *node)
{
	if (node->function >= FN_SUM)
		return collect_of_vectors(c, node);
	if (node->function >= FN_ATAN2)
		return collect_piecewise(c, node);
	struct value *x = collect_argument(c, node), *y = value_new(x->rows, x->columns);
	for (int i = 0; i < x->rows * x->columns; i++)
		y->cell[i] = function_of_form(c, node, x->cell[i]);
	return y;
}

/* ---- operators ---- */

/* The limit on exact values, where a part has been added */
static void check_sum(struct place at, const struct form *sum, const struct form *part)
{
	for (int i = 0; i < part->terms; i++) {
		const struct form_term *term = form_find(sum, &part->term[i].basis);
		if (term)
			check_bits(at, term->factor);
	}
}

static struct value *collect_sum(struct collector *c, struct node *node)
{
	struct value *sum = NULL;
	const struct node *outer = c->term;
	const struct place before = working_at();
	RATIONAL minus = RATIO(-1, 1);
	for (int i = 0; i < node->children; i++) {
		if (node->children > 1) {
			c->term = node->child[i];
			work_at(c->term->start);
		}
		struct value *term = collect_node(c, node->child[i]);
		if (!sum)
			sum = value_new(term->rows, term->columns);
		if (sum->rows != term->rows || sum->columns != term->columns)
			error(node->operator[i], NULL, "sizes do not fit: %s and %s", shape_text(sum),
			      shape_text(term));
		for (int k = 0; k < sum->rows * sum->columns; k++) {
			form_add_to(sum->cell[k], term->cell[k], node->inverse[i] ? minus : NULL);
			check_sum(node->operator[i], sum->cell[k], term->cell[k]);
		}
	}
	c->term = outer;
	work_at(before);
	return sum;
}

static struct form *collect_division(struct collector *c, const struct form *a, const struct form *b, struct place at)
{
	RATIONAL value = ZERO;
	mpq_srcptr one = factor_of(a, BASIS_PI), pi = factor_of(b, BASIS_PI);
	if (one && pi && a->terms == 1 && b->terms == 1) {      /* pi/pi */
		mpq_div(value, one, pi);
		return form_constant(value);
	}
	constant_value(c, b, value);
	if (mpq_sgn(value) == 0)
		error(at, NULL, "division by zero");
	mpq_inv(value, value);
	return form_scale(a, value);
}

static bool has_input(const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_INPUT)
			return true;
	return false;
}

static struct form *times(struct collector *c, const struct node *node, const struct form *a, const struct form *b)
{
	if (is_constant(a) || is_constant(b))
		return form_product(c, a, b);
	struct form *switched = keeps_piecewise(c) ? kept_switched(c, node, a, b) : NULL;
	if (switched)
		return switched;
	if (keeps(c))
		return (node->unexpanded ? unexpanded_product : kept_product)(c, node, a, b);
	if (has_coordinate(a) && has_coordinate(b))
		not_linear(c, node, "is not linear");
	if (has_coordinate(a) || has_coordinate(b))
		not_linear(c, node, "has a factor that changes in time");
	if (has_input(a) || has_input(b))
		not_linear(c, node, "multiplies an input by what changes in time");
	return load_product(c, a, b);
}

static struct form *dot(struct collector *c, const struct node *node, const struct value *a, int row,
			const struct value *b, int column)
{
	struct form *sum = NEW(struct form);
	for (int k = 0; k < a->columns; k++) {
		const struct form *x = a->cell[row * a->columns + k], *y = b->cell[k * b->columns + column];
		if (x->terms > 0 && y->terms > 0)
			form_add_to(sum, times(c, node, x, y), NULL);
	}
	return sum;
}

static struct value *multiply(struct collector *c, const struct node *node, const struct value *a,
			      const struct value *b, struct place at)
{
	const bool each = node->each && !is_scalar(a) && a->rows == b->rows && a->columns == b->columns;
	if (!each && !is_scalar(a) && !is_scalar(b) && a->columns != b->rows)
		error(at, NULL, "sizes do not fit: %s times %s", shape_text(a), shape_text(b));
	if (!each && !is_scalar(a) && !is_scalar(b)) {
		struct value *product = value_new(a->rows, b->columns);
		for (int i = 0; i < a->rows; i++)
			for (int j = 0; j < b->columns; j++)
				product->cell[i * b->columns + j] = dot(c, node, a, i, b, j);
		return product;
	}
	const struct value *shape = is_scalar(a) ? b : a;
	struct value *product = value_new(shape->rows, shape->columns);
	for (int i = 0; i < shape->rows * shape->columns; i++)
		product->cell[i] = times(c, node, a->cell[is_scalar(a) ? 0 : i], b->cell[is_scalar(b) ? 0 : i]);
	return product;
}

static struct value *divide(struct collector *c, const struct node *node, const struct value *a, const struct value *b,
			    struct place at);

static struct value *divide_each(struct collector *c, const struct node *node, const struct value *a,
				 const struct value *b, struct place at)
{
	struct value *quotient = value_new(a->rows, a->columns);
	for (int i = 0; i < a->rows * a->columns; i++) {
		const struct value above = { 1, 1, &a->cell[i] }, below = { 1, 1, &b->cell[i] };
		quotient->cell[i] = divide(c, node, &above, &below, at)->cell[0];
	}
	return quotient;
}

static struct value *divide(struct collector *c, const struct node *node, const struct value *a, const struct value *b,
			    struct place at)
{
	if (!is_scalar(b) && node->each)
		return divide_each(c, node, a, b, at);
	if (!is_scalar(b))
		error(at, NULL, "division by a %s matrix", shape_text(b));
	bool kept = !is_constant(b->cell[0]);
	if (kept && !keeps(c))
		not_linear(c, node, "divides by what moves");
	struct value *quotient = value_new(a->rows, a->columns);
	const struct form *inverse = kept ? kept_reciprocal(c, node, b->cell[0]) : NULL;
	for (int i = 0; i < a->rows * a->columns; i++)
		quotient->cell[i] = kept ? kept_product(c, node, a->cell[i], inverse)
					 : collect_division(c, a->cell[i], b->cell[0], at);
	return quotient;
}

/* sum(v), cumsum(v): v_1, v_1 + v_2, ...; dot(a, b): the sum of products */
static struct value *collect_of_vectors(struct collector *c, struct node *node)
{
	const struct value *a = collect_node(c, node->child[0]);
	const struct value *b = node->function == FN_DOT ? collect_node(c, node->child[1]) : NULL;
	const int count = a->rows * a->columns;
	if (b && (b->rows != a->rows || b->columns != a->columns))
		error(node->at, NULL, "sizes do not fit: %s and %s", shape_text(a), shape_text(b));
	struct value *sum = node->function == FN_CUMSUM ? value_new(a->rows, a->columns) : scalar(NEW(struct form));
	for (int i = 0; i < count; i++) {
		struct form *term = b ? times(c, node, a->cell[i], b->cell[i]) : a->cell[i];
		struct form *before = node->function != FN_CUMSUM ? sum->cell[0]
				      : i			  ? sum->cell[i - 1]
								  : NEW(struct form);
		sum->cell[node->function == FN_CUMSUM ? i : 0] = form_sum(before, term, false);
	}
	return sum;
}

/* Whether a factor that no state changes is 0 */
static bool has_zero_factor(struct collector *c, const struct node *node)
{
	for (int i = 0; i < node->children; i++)
		if (!node->inverse[i] && is_timely(node->child[i]) && is_plain_zero(collect_node(c, node->child[i])))
			return true;
	return false;
}

static struct value *collect_product(struct collector *c, struct node *node)
{
	const bool vanishes = c->vanishes;
	c->vanishes = vanishes || (c->frame && !keeps(c) && has_zero_factor(c, node));
	struct value *product = collect_node(c, node->child[0]);
	for (int i = 1; i < node->children; i++) {
		struct value *factor = collect_node(c, node->child[i]);
		product = (node->inverse[i] ? divide : multiply)(c, node, product, factor, node->operator[i]);
		for (int k = 0; k < product->rows * product->columns; k++)
			check_form(node->operator[i], product->cell[k]);
	}
	c->vanishes = vanishes;
	return product;
}

static struct form *collect_power(struct collector *c, struct node *node)
{
	struct form *base = scalar_of(collect_node(c, node->child[0]), node->child[0],
				      "a power is of a number: [q[1]^2; q[2]^2] has those of two components");
	struct form *exponent = collect_scalar(c, node->child[1]);
	if (!is_constant(exponent) && keeps(c))
		return kept_power(c, node, base, exponent);
	if (!is_constant(exponent))
		not_linear(c, node, "is not linear");
	RATIONAL b = ZERO, e = ZERO;
	constant_value(c, exponent, e);
	struct form *power = NULL;
	if (is_constant(base)) {
		constant_value(c, base, b);
		if (!constant_power(node->at, b, e, b))
			met_irrational(c, &c->irrationals.root);
		power = form_constant(b);
		check_form(node->at, power);
	} else if (mpq_cmp_ui(e, 1, 1) == 0) {
		power = base;
	} else if (mpq_sgn(e) == 0) {
		mpq_set_ui(b, 1, 1);
		power = form_constant(b);
	} else if (!c->whole_time && !has_coordinate(base) && !has_input(base) && mpz_cmp_ui(mpq_denref(e), 1) == 0 &&
		   mpq_sgn(e) > 0) {
		if (mpq_cmp_ui(e, LIMIT_LOAD_POWER, 1) > 0)
			error(node->at, NULL, "power of a load beyond the limit of %d", LIMIT_LOAD_POWER);
		power = base;
		for (unsigned long k = mpz_get_ui(mpq_numref(e)); k > 1; k--)
			power = load_product(c, power, base);
	}
	if (!power && keeps(c))
		return kept_power(c, node, base, exponent);
	if (!power)
		not_linear(c, node, "is not linear");
	check_form(node->at, power);
	return power;
}

/* A condition on constants or on time; true is 1, false is 0. */
static struct form *collect_comparison(struct collector *c, struct node *node)
{
	struct form *left = collect_scalar(c, node->child[0]), *right = collect_scalar(c, node->child[1]),
		    *difference = form_sum(left, right, true);
	if (keeps_piecewise(c) && !is_decided(c, 1, &difference))
		return kept_comparison(c, node, node->comparison, left, right);
	RATIONAL truth = ZERO;
	mpq_set_ui(truth, compare_values(node->comparison, order_now(c, node, left, right)), 1);
	return form_constant(truth);
}

static struct value *kept_choices(struct collector *c, struct node *node, const struct form *condition)
{
	struct value *a = collect_node(c, node->child[1]), *b = collect_node(c, node->child[2]),
		     *choice = value_new(a->rows, a->columns);
	if (a->rows != b->rows || a->columns != b->columns)
		error(node->at, NULL, "sizes do not fit: %s and %s", shape_text(a), shape_text(b));
	for (int i = 0; i < a->rows * a->columns; i++)
		choice->cell[i] = (node->unexpanded ? unexpanded_choice : kept_choice)(c, node, condition, a->cell[i],
										       b->cell[i]);
	return choice;
}

static struct value *collect_choice(struct collector *c, struct node *node)
{
	struct form *condition = collect_scalar(c, node->child[0]), *zero = NEW(struct form);
	if (keeps_piecewise(c) && !is_decided(c, 1, &condition))
		return kept_choices(c, node, condition);
	return collect_node(c, node->child[order_now(c, node, condition, zero) != 0 ? 1 : 2]);
}

/* ---- names, matrices ---- */

static void collect_value(struct collector *c, struct symbol *symbol)
{
	struct collector inner = *c;
	inner.term = symbol->value;
	inner.span = (struct span){ NULL, NULL };
	if (symbol->kind == SYMBOL_PARAM || symbol->kind == SYMBOL_MATRIX)
		inner.constant_only = true;
	symbol->made.progress = COLLECTING;
	symbol->made.value = NULL;
	struct value *value = collect_node(&inner, symbol->value);
	if (symbol->kind == SYMBOL_PARAM && !is_scalar(value))
		error(symbol->value->start, "matrix NAME = ...", "a param is a number, found a %s matrix",
		      shape_text(value));
	c->forcings = inner.forcings;
	c->irrationals = inner.irrationals;
	symbol->made.irrational = inner.irrational_count > c->irrational_count;
	c->irrational_count = inner.irrational_count;
	c->changes = inner.changes;
	c->change = inner.change;
	symbol->made.value = value;
	symbol->made.span = inner.span;
	symbol->made.progress = inner.vanishes ? FRESH : COLLECTED;
}

/* A coordinate, whole or one component. */
static struct value *collect_coordinate(struct collector *c, struct node *node)
{
	const struct symbol *symbol = node->symbol;
	need_constant(c, node, format("coordinate '%s'", symbol->name));
	int first = symbol->index + (node->component ? node->component - 1 : 0),
	    rows = node->component || !symbol->length ? 1 : symbol->length;
	struct value *value = value_new(rows, 1);
	for (int i = 0; i < rows; i++)
		value->cell[i] = coordinate_form(c->frame, first + i, node->primes);
	return value;
}

/* A tunable param, or one that is made of such, whose value the target has. In a let or output that is to be linear it
 * gives up in silence, like what is not linear. */
static struct value *collect_tuned(struct collector *c, struct node *node)
{
	const struct symbol *symbol = node->symbol;
	if (!symbol->tuning.number || (c->given && symbol->tuning.derived))
		return collect_node(c, symbol->value);
	if (c->params == PARAMS_INPUTS && !symbol->tuning.factor)
		return scalar(form_unit(
			(struct basis){ .kind = BASIS_INPUT, .index = c->inputs + symbol->tuning.acting }));
	if (!keeps(c))
		not_linear(c, node, "has a tunable factor");
	return scalar(kept_param(c, node, symbol));
}

static struct value *collect_multiplier(struct collector *c, struct node *node)
{
	const int index = node->symbol->index;
	need_constant(c, node, format("constraint '%s'", node->symbol->name));
	if (c->equation || (c->output && !c->multiplier))
		return scalar(form_unit(multiplier_basis(c->frame, index)));
	if (!c->output)
		not_linear(c, node, "is a multiplier, which follows from all equations");
	return scalar(form_alias(c->multiplier[index]));
}

static struct value *collect_name(struct collector *c, struct node *node)
{
	struct symbol *symbol = node->symbol;
	if (symbol->broken)
		abandon();
	if (symbol->kind == SYMBOL_COORD)
		return collect_coordinate(c, node);
	if (symbol->kind == SYMBOL_MULTIPLIER)
		return collect_multiplier(c, node);
	if (symbol->kind == SYMBOL_INPUT) {
		need_constant(c, node, format("input '%s'", symbol->name));
		return scalar(form_unit(
			(struct basis){ .kind = BASIS_INPUT, .index = symbol->index, .order = node->primes }));
	}
	if (symbol->kind == SYMBOL_LET)
		need_constant(c, node, format("let '%s'", symbol->name));
	for (int i = 0; i < c->fixings; i++)
		if (c->fixing[i].symbol == symbol)
			return scalar(form_constant(c->fixing[i].value));
	const bool number = c->constant_only || (symbol->tuning.factor && c->params == PARAMS_INPUTS && !c->reading);
	if (c->params != PARAMS_VALUES && symbol->tuning.tuned && symbol->kind != SYMBOL_LET && !number)
		return collect_tuned(c, node);
	if (symbol->made.progress == COLLECTING && symbol->kind == SYMBOL_PARAM)
		error(node->at, NULL, "param '%s' is defined by itself", symbol->name);
	if (symbol->made.progress == COLLECTING)     /* a let that failed before: that was reported */
		abandon();
	if (symbol->made.progress != COLLECTED)
		collect_value(c, symbol);
	narrow_span(c, symbol->made.span);
	c->irrational_count += symbol->made.irrational;
	return symbol->made.value;
}

static struct value *collect_matrix(struct collector *c, struct node *node)
{
	struct value *value = value_new(node->children / node->columns, node->columns);
	for (int i = 0; i < node->children; i++)
		value->cell[i] = collect_scalar(c, node->child[i]);
	return value;
}

static struct value *collect_file(struct collector *c, struct node *node)
{
	(void)c;
	const struct mtx *file = mtx_read(node->path, node->at);
	struct value *value = value_new(file->rows, file->columns);
	for (int i = 0; i < file->rows * file->columns; i++)
		value->cell[i] = form_constant(file->cell[i]);
	return value;
}

static struct value *collect_anew(struct collector *c, struct node *node)
{
	switch (node->kind) {
	case NODE_NUMBER:  return scalar(form_constant(node->number));
	case NODE_PI:      return scalar(form_unit((struct basis){ .kind = BASIS_PI }));
	case NODE_TIME:
		need_constant(c, node, "'t'");
		return scalar(plain_forcing(c, 1, NULL));
	case NODE_NAME:    return collect_name(c, node);
	case NODE_SUM:     return collect_sum(c, node);
	case NODE_PRODUCT: return collect_product(c, node);
	case NODE_POWER:   return scalar(collect_power(c, node));
	case NODE_CALL:    return collect_call(c, node);
	case NODE_COMPARE: return scalar(collect_comparison(c, node));
	case NODE_MATRIX:  return collect_matrix(c, node);
	case NODE_FILE:    return collect_file(c, node);
	default:           return collect_choice(c, node);
	}
}

/* ---- what time alone decides is kept from interval to interval ---- */

struct kept {
	struct value *value;
	struct span span;
	const struct frame *frame;
	unsigned mode;              /* of the collector */
};

static bool is_timely(struct node *node)
{
	if (node->timely != TIMELY_UNKNOWN)
		return node->timely == TIMELY;
	bool timely = node->kind != NODE_FILE;
	if (node->kind == NODE_NAME && node->symbol->kind != SYMBOL_PARAM)
		timely = node->symbol->kind == SYMBOL_LET && !node->symbol->broken && is_timely(node->symbol->value);
	for (int i = 0; i < node->children && timely; i++)
		timely = is_timely(node->child[i]);
	node->timely = timely ? TIMELY : NOT_TIMELY;
	return timely;
}

static unsigned mode_of(const struct collector *c)
{
	return (unsigned)c->keep | c->whole_time << 2 | c->tolerant << 3 | c->constant_only << 4 | c->closed << 5 |
	       c->output << 6 | c->reading << 9 |
	       c->vanishes << 10 | (unsigned)c->params << 7;
}

/* Cells of values are shared: nobody changes them. What has become a rational is known by those that are collected, so
 * it is not kept. */
static struct value *collect_node(struct collector *c, struct node *node)
{
	if (!c->frame || c->fixings || c->constant_only || !is_timely(node))
		return collect_anew(c, node);
	struct kept *kept = node->kept;
	if (kept && kept->frame == c->frame && kept->mode == mode_of(c) && holds_now(c, kept->span)) {
		narrow_span(c, kept->span);
		return kept->value;
	}
	struct span outer = c->span;
	int irrationals = c->irrational_count;
	c->span = (struct span){ NULL, NULL };
	struct value *value = collect_anew(c, node);
	if (!kept)
		kept = node->kept = NEW(struct kept);
	if (c->irrational_count == irrationals)
		*kept = (struct kept){ value, c->span, c->frame, mode_of(c) };
	narrow_span(c, outer);
	return value;
}

struct value *collect(struct collector *c, struct node *node)
{
	c->term = node;
	c->vanishes = false;                    /* an error may have left one */
	c->span = (struct span){ NULL, NULL };
	work_at(node->start);
	return collect_node(c, node);
}

struct value *collect_constants(struct collector *c, struct node *node)
{
	bool outer = c->constant_only;
	c->constant_only = true;
	struct value *value = collect(c, node);
	c->constant_only = outer;
	return value;
}

void collect_constant(struct collector *c, struct node *node, mpq_ptr number)
{
	struct value *value = collect_constants(c, node);
	if (!is_scalar(value))
		error(node->start, NULL, "expected a number, found a %s matrix", shape_text(value));
	constant_value(c, value->cell[0], number);
}

void forget_lets(const struct spec *spec)
{
	for (struct symbol *s = spec->first; s; s = s->next)
		if (s->kind == SYMBOL_LET)
			s->made.progress = FRESH;
}

void param_value(const struct symbol *param, mpq_ptr value)
{
	struct collector collector = { .scheme = "exact" };
	constant_value(&collector, param->made.value->cell[0], value);
}
