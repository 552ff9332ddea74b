/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a parsed spec to the equations of motion: M q'' + C q' + K q = force, all rational. */
#include "plgen.h"

#include <string.h>

struct building {
	struct spec *spec;
	struct model *model;
	struct collector collector;
	struct form **residual;     /* per equation: left side minus right side */
	const struct overrides *overrides;
};

/* ---- rational matrices ---- */

void rational_product(int rows, int inner, int columns, const mpq_t *A, const mpq_t *B, mpq_t *AB)
{
	mpq_t product;
	mpq_init(product);
	for (int i = 0; i < rows; i++)
		for (int j = 0; j < columns; j++) {
			mpq_set_ui(AB[i * columns + j], 0, 1);
			for (int k = 0; k < inner; k++) {
				if (mpq_sgn(A[i * inner + k]) == 0 || mpq_sgn(B[k * columns + j]) == 0)
					continue;
				mpq_mul(product, A[i * inner + k], B[k * columns + j]);
				mpq_add(AB[i * columns + j], AB[i * columns + j], product);
			}
		}
	mpq_clear(product);
}

static void subtract_row(int n, mpq_t *target, const mpq_t *row, mpq_srcptr factor)
{
	mpq_t product;
	mpq_init(product);
	for (int j = 0; j < n; j++) {
		mpq_mul(product, row[j], factor);
		mpq_sub(target[j], target[j], product);
	}
	mpq_clear(product);
}

/* Gauss and Jordan on [A | I]. */
bool rational_inverse(int n, const mpq_t *A, mpq_t *inverse, int *column)
{
	int width = 2 * n;
	mpq_t *W = rationals((size_t)(n * width)), pivot;
	mpq_init(pivot);
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++)
			mpq_set(W[i * width + j], A[i * n + j]);
		mpq_set_ui(W[i * width + n + i], 1, 1);
	}
	for (int k = 0; k < n; k++) {
		int row = k;
		while (row < n && mpq_sgn(W[row * width + k]) == 0)
			row++;
		if (row == n) {
			*column = k;
			mpq_clear(pivot);
			return false;
		}
		for (int j = 0; j < width; j++)
			mpq_swap(W[row * width + j], W[k * width + j]);
		mpq_inv(pivot, W[k * width + k]);
		for (int j = 0; j < width; j++)
			mpq_mul(W[k * width + j], W[k * width + j], pivot);
		for (int i = 0; i < n; i++) {
			mpq_set(pivot, W[i * width + k]);
			if (i != k && mpq_sgn(pivot) != 0)
				subtract_row(width, W + i * width, (const mpq_t *)W + k * width, pivot);
		}
	}
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			mpq_set(inverse[i * n + j], W[i * width + n + j]);
	mpq_clear(pivot);
	return true;
}

/* ---- params, lets ---- */

static void define_override(struct building *b, const char *text)
{
	const char *equals = strchr(text, '=');
	char *name = format("%.*s", (int)(equals - text), text);
	struct source *source = source_argument(text);
	struct symbol *symbol = spec_find(b->spec, name);
	if (symbol && symbol->broken)
		return;
	if (!symbol || symbol->kind != SYMBOL_PARAM) {
		const char *note = symbol ? "-D gives a param another value" : spec_suggestion(b->spec, name);
		say_error((struct place){ source, 0 }, note, symbol ? "'%s' is not a param" : "no param is named '%s'", name);
		return;
	}
	struct node *value = parse_argument(b->spec, source, (size_t)(equals - text) + 1);
	if (value)
		symbol->value = value;
	else
		symbol->broken = true;
}

static bool statement_failed(const struct spec *spec, size_t statement)
{
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->broken && s->index >= 0 && s->statement == statement)
			return true;
	return false;
}

struct symbol_work {
	struct building *b;
	struct symbol *symbol;
};

static void evaluate_symbol(void *context)
{
	struct symbol_work *work = context;
	struct node name = { .kind = NODE_NAME, .at = work->symbol->at, .start = work->symbol->at, .end = work->symbol->at, .symbol = work->symbol };
	collect(&work->b->collector, &name);
}

static void evaluate_params(struct building *b)
{
	b->collector.constant_only = true;
	for (struct symbol *s = b->spec->first; s; s = s->next) {
		if (s->kind != SYMBOL_PARAM || s->broken)
			continue;
		if (s->progress == COLLECTING || statement_failed(b->spec, s->statement) ||
		    !statement_guard(evaluate_symbol, &(struct symbol_work){ b, s }))
			s->broken = true;
	}
	b->collector.constant_only = false;
}

/* A let that nothing linear uses may be anything; but a division by zero in it is told all the same. */
static void evaluate_lets(struct building *b)
{
	b->collector.tolerant = true;
	for (struct symbol *s = b->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_LET && !s->broken && s->progress != COLLECTED)
			statement_guard(evaluate_symbol, &(struct symbol_work){ b, s });
	b->collector.tolerant = false;
}

/* ---- scheme and step ---- */

const char *scheme_name(enum scheme scheme)
{
	return scheme == SCHEME_PL ? "pl" : "exact";
}

static void choose_scheme(void *context)
{
	static const char *const known[] = { "exact", "pl", "etd1", "etdrk2", "etdrk4", "nc2", "nc3", "dq4", "bm3" };
	struct building *b = context;
	const char *wanted = b->overrides->scheme ? b->overrides->scheme : b->spec->scheme;
	b->collector.scheme = "exact";
	if (!wanted)
		return;
	struct place at = b->overrides->scheme ? (struct place){ source_argument(wanted), 0 } : b->spec->scheme_at;
	for (int i = 0; i < 9; i++)
		if (strcmp(wanted, known[i]) == 0) {
			if (i > 1)
				error(at, "exact and pl are", "scheme '%s' is not built yet", wanted);
			b->model->scheme = i == 1 ? SCHEME_PL : SCHEME_EXACT;
			b->collector.scheme = known[i];
			return;
		}
	const char *nearest = nearest_name(wanted, 9, known);
	error(at, nearest ? format("did you mean '%s'?", nearest) : "the schemes are exact, pl, etd1, etdrk2, etdrk4, nc2, nc3, dq4, bm3",
	      "unknown scheme '%s'", wanted);
}

static void evaluate_step(void *context)
{
	struct building *b = context;
	struct node *node = b->spec->step;
	struct place at = b->spec->step_at;
	if (b->overrides->step) {
		struct source *source = source_argument(b->overrides->step);
		node = parse_argument(b->spec, source, 0);
		at = (struct place){ source, 0 };
		if (!node)
			abandon();
	}
	b->model->step_at = b->model->end_at = at;
	collect_constant(&b->collector, node, b->model->h);
	if (mpq_sgn(b->model->h) <= 0)
		error(at, NULL, "the step must be above 0");
	if (beyond_double(b->model->h) || round_rational(b->model->h) == 0)
		error(at, NULL, "the step is beyond the range of double");
}

/* ---- equations ---- */

struct equation_work {
	struct building *b;
	int index;
};

/* `t` outside of a function, also in a let */
static const struct node *find_time(const struct node *node)
{
	if (node->kind == NODE_TIME)
		return node;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET)
		return find_time(node->symbol->value);
	for (int i = 0; i < node->children && node->kind != NODE_CALL; i++) {
		const struct node *found = find_time(node->child[i]);
		if (found)
			return found;
	}
	return NULL;
}

static bool form_has(const struct form *form, enum basis_kind kind)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == kind)
			return true;
	return false;
}

static void collect_equation(void *context)
{
	struct equation_work *work = context;
	const struct equation *equation = &work->b->spec->equation[work->index];
	struct collector *c = &work->b->collector;
	struct node *difference = NEW(struct node), *child[] = { equation->left, equation->right };
	bool inverse[] = { false, true };
	struct place operator[] = { equation->at, equation->at };
	*difference = (struct node){ .kind = NODE_SUM, .at = equation->at, .children = 2, .child = child, .inverse = inverse, .operator = operator };
	struct form *form = collect(c, difference);
	if (form_has(form, BASIS_TIME)) {
		const struct node *time = find_time(equation->left);
		time = time ? time : find_time(equation->right);
		error(time ? time->at : equation->at, NULL, "loads that grow with t are not built yet");
	}
	work->b->residual[work->index] = form;
}

static void collect_equations(struct building *b)
{
	b->residual = ARRAY(struct form *, (size_t)b->spec->equations);
	for (int i = 0; i < b->spec->equations; i++)
		if (b->spec->equation[i].right)
			statement_guard(collect_equation, &(struct equation_work){ b, i });
}

static void fill_row(struct model *model, int row, const struct form *form)
{
	int n = model->n;
	mpq_t *matrix[] = { model->system.K, model->system.C, model->system.M };
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD)
			mpq_set(matrix[form->term[i].basis.order][row * n + form->term[i].basis.coord], form->term[i].factor);
}

/* ---- does each coordinate have its equation? ---- */

static const struct node *find_derivative(const struct node *node, int coord, int primes)
{
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD && node->symbol->index == coord && node->primes == primes)
		return node;
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
		found = find_derivative(spec->equation[i].left, coord, primes);
		found = found ? found : find_derivative(spec->equation[i].right, coord, primes);
	}
	for (const struct symbol *s = spec->first; s && !found; s = s->next)
		if (s->kind == SYMBOL_LET && !s->broken)
			found = find_derivative(s->value, coord, primes);
	return found;
}

/* Equation i and coordinate j belong together if i has the acceleration of j. */
static bool has_acceleration(const struct form *form, int coord)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD && form->term[i].basis.coord == coord && form->term[i].basis.order == 2)
			return true;
	return false;
}

/* An augmenting path of the bipartite matching from equation `row`. */
static bool augment(const struct building *b, int row, int *match, bool *visited)
{
	for (int j = 0; j < b->spec->coords; j++) {
		if (visited[j] || !has_acceleration(b->residual[row], j))
			continue;
		visited[j] = true;
		if (match[j] < 0 || augment(b, match[j], match, visited)) {
			match[j] = row;
			return true;
		}
	}
	return false;
}

static void check_count(const struct building *b)
{
	const struct spec *spec = b->spec;
	int *match = ARRAY(int, (size_t)spec->coords), surplus = spec->equations - 1;
	for (int j = 0; j < spec->coords; j++)
		match[j] = -1;
	bool all = true;
	for (int i = 0; i < spec->equations; i++)
		if (!augment(b, i, match, ARRAY(bool, (size_t)spec->coords)) && all) {
			surplus = i;
			all = false;
		}
	if (spec->equations > spec->coords)
		say_error(spec->equation[surplus].at, NULL, "surplus equation: %d equations for %d coordinate%s", spec->equations, spec->coords,
			  spec->coords == 1 ? "" : "s");
	if (spec->equations >= spec->coords)
		return;
	int missing = spec->coords - 1;
	while (missing > 0 && match[missing] >= 0)
		missing--;
	say_error(spec->end, "each coordinate needs an equation of motion", "missing equation: %d coordinate%s, %d equation%s; none determines %s''",
		  spec->coords, spec->coords == 1 ? "" : "s", spec->equations, spec->equations == 1 ? "" : "s", b->model->coord[missing]->name);
}

static void tell_singular(const struct building *b, int coord)
{
	const struct model *model = b->model;
	const struct symbol *symbol = model->coord[coord];
	const struct node *acceleration = find_in_equations(b->spec, coord, 2);
	bool zero = true;
	for (int i = 0; i < model->n; i++)
		zero = zero && mpq_sgn(model->system.M[i * model->n + coord]) == 0;
	if (acceleration && zero)
		say_error(acceleration->at, "every coordinate needs a mass", "singular mass matrix: the factor of %s'' is 0", symbol->name);
	else if (acceleration)
		say_error(acceleration->at, NULL, "singular mass matrix: the equations do not determine %s''", symbol->name);
	else if (find_in_equations(b->spec, coord, 1))
		say_error(symbol->at, NULL, "first-order coordinates are not built yet: %s'' stands in no equation", symbol->name);
	else
		say_error(symbol->at, "every coordinate needs a mass", "singular mass matrix: %s'' stands in no equation", symbol->name);
}

/* Prefer to name a coordinate without any mass over one that elimination happened to stop at. */
static void check_mass(const struct building *b)
{
	const struct model *model = b->model;
	int n = model->n, column;
	if (rational_inverse(n, (const mpq_t *)model->system.M, rationals((size_t)(n * n)), &column))
		return;
	for (int j = 0; j < n; j++) {
		bool zero = true;
		for (int i = 0; i < n; i++)
			zero = zero && mpq_sgn(model->system.M[i * n + j]) == 0;
		if (zero) {
			tell_singular(b, j);
			return;
		}
	}
	tell_singular(b, column);
}

/* ---- loads ---- */

static struct load *load_of_wave(struct model *model, const struct wave *wave)
{
	struct linear *system = &model->system;
	for (int i = 0; i < system->loads; i++)
		if (system->load[i].wave == wave)
			return &system->load[i];
	ENLARGE(system->load, (size_t)system->loads + 1);
	struct load *load = &system->load[system->loads++];
	*load = (struct load){ .wave = wave, .columns = wave ? 2 : 1 };
	for (int i = 0; i < load->columns; i++)
		load->force[i] = rationals((size_t)model->n);
	return load;
}

static void fill_loads(struct building *b, int row, const struct form *form)
{
	mpq_t constant;
	mpq_init(constant);
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_WAVE) {
			struct load *load = load_of_wave(b->model, basis->wave);
			mpq_neg(load->force[basis->sine][row], form->term[i].factor);
		}
	}
	struct form rest = { 0, form->term };
	while (rest.terms < form->terms && form->term[rest.terms].basis.kind <= BASIS_PI)
		rest.terms++;
	constant_value(&b->collector, &rest, constant);
	if (mpq_sgn(constant) != 0)
		mpq_neg(load_of_wave(b->model, NULL)->force[0][row], constant);
	mpq_clear(constant);
}

/* ---- initial values ---- */

struct initial_work {
	struct building *b;
	int index;
};

static void evaluate_initial(void *context)
{
	struct initial_work *work = context;
	const struct initial *initial = &work->b->spec->initial[work->index];
	int state = initial->coord->index + initial->primes * work->b->model->n;
	mpq_ptr value = work->b->model->initial[state];
	collect_constant(&work->b->collector, initial->value, value);
	if (beyond_double(value))
		error(initial->value->start, NULL, "the initial value is beyond the range of double");
}

static void evaluate_initials(struct building *b)
{
	size_t failed = SIZE_MAX;
	for (int i = 0; i < b->spec->initials; i++) {
		size_t statement = b->spec->initial[i].statement;
		if (statement != failed && !statement_guard(evaluate_initial, &(struct initial_work){ b, i }))
			failed = statement;
	}
}

/* ---- outputs ---- */

struct output_work {
	struct building *b;
	struct output *output;
};

static void collect_output(void *context)
{
	struct output_work *work = context;
	work->output->form = collect(&work->b->collector, work->output->value);
}

/* output += factor * (row of M^-1 [force - C v - K q]) */
static void add_acceleration(const struct model *model, const mpq_t *inverse, int coord, mpq_srcptr factor, struct output *output)
{
	int n = model->n;
	mpq_t weight, product;
	mpq_inits(weight, product, NULL);
	for (int i = 0; i < n; i++) {
		mpq_mul(weight, inverse[coord * n + i], factor);
		for (int j = 0; j < n && mpq_sgn(weight) != 0; j++) {
			mpq_mul(product, weight, model->system.K[i * n + j]);
			mpq_sub(output->state[j], output->state[j], product);
			mpq_mul(product, weight, model->system.C[i * n + j]);
			mpq_sub(output->state[n + j], output->state[n + j], product);
		}
		for (int l = 0; l < model->system.loads; l++)
			for (int k = 0; k < model->system.load[l].columns; k++) {
				mpq_ptr sum = model->system.load[l].wave ? output->load[k][l] : output->constant;
				mpq_mul(product, weight, model->system.load[l].force[k][i]);
				mpq_add(sum, sum, product);
			}
	}
	mpq_clears(weight, product, NULL);
}

static void spread_output(struct building *b, const mpq_t *inverse, struct output *output)
{
	struct model *model = b->model;
	for (int i = 0; i < output->form->terms; i++) {
		const struct form_term *term = &output->form->term[i];
		const struct basis *basis = &term->basis;
		if (basis->kind == BASIS_TIME)
			mpq_set(output->time, term->factor);
		else if (basis->kind == BASIS_WAVE)
			mpq_add(output->load[basis->sine][load_of_wave(model, basis->wave) - model->system.load],
				output->load[basis->sine][load_of_wave(model, basis->wave) - model->system.load], term->factor);
		else if (basis->kind == BASIS_COORD && basis->order == 2)
			add_acceleration(model, inverse, basis->coord, term->factor, output);
		else if (basis->kind == BASIS_COORD)
			mpq_add(output->state[basis->coord + basis->order * model->n], output->state[basis->coord + basis->order * model->n],
				term->factor);
	}
	struct form rest = { 0, output->form->term };
	mpq_t constant;
	mpq_init(constant);
	while (rest.terms < output->form->terms && output->form->term[rest.terms].basis.kind <= BASIS_PI)
		rest.terms++;
	constant_value(&b->collector, &rest, constant);
	mpq_add(output->constant, output->constant, constant);
	mpq_clear(constant);
}

static const struct node *find_acceleration(const struct node *node)
{
	if (node->kind == NODE_NAME && node->primes == 2)
		return node;
	for (int i = 0; i < node->children; i++) {
		const struct node *found = find_acceleration(node->child[i]);
		if (found)
			return found;
	}
	return NULL;
}

static void name_outputs(struct building *b)
{
	struct model *model = b->model;
	model->declared_outputs = b->spec->outputs > 0;
	model->outputs = model->declared_outputs ? b->spec->outputs : model->states;
	model->output = ARRAY(struct output, (size_t)model->outputs);
	struct output *output = model->output;
	for (struct symbol *s = b->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_OUTPUT)
			*output++ = (struct output){ .name = s->name, .value = s->value };
	for (int i = 0; i < model->states && !model->declared_outputs; i++)
		model->output[i].name = model->state_name[i];
}

/* Waves that only outputs use get an oscillator too, so all are collected before any is spread. */
static void build_outputs(struct building *b)
{
	struct model *model = b->model;
	int column;
	mpq_t *inverse = rationals((size_t)(model->n * model->n));
	rational_inverse(model->n, (const mpq_t *)model->system.M, inverse, &column);
	b->collector.tolerant = true;
	for (int i = 0; i < model->outputs; i++) {
		struct output *output = &model->output[i];
		if (output->value)
			statement_guard(collect_output, &(struct output_work){ b, output });
		for (int k = 0; output->form && k < output->form->terms; k++)
			if (output->form->term[k].basis.kind == BASIS_WAVE)
				load_of_wave(model, output->form->term[k].basis.wave);
	}
	b->collector.tolerant = false;
	for (int i = 0; i < model->outputs; i++) {
		struct output *output = &model->output[i];
		const struct node *acceleration = output->value && !output->form ? find_acceleration(output->value) : NULL;
		if (acceleration)
			say_error(acceleration->at, NULL, "accelerations in outputs that are not linear are not built yet");
		output->state = rationals((size_t)model->states);
		for (int k = 0; k < 2; k++)
			output->load[k] = rationals((size_t)model->system.loads);
		mpq_inits(output->constant, output->time, NULL);
		if (!output->value)
			mpq_set_ui(output->state[i], 1, 1);
		else if (output->form)
			spread_output(b, (const mpq_t *)inverse, output);
	}
}

/* ---- the whole ---- */

static void name_states(struct building *b)
{
	struct model *model = b->model;
	model->n = b->spec->coords;
	model->states = 2 * model->n;
	model->coord = ARRAY(struct symbol *, (size_t)model->n);
	model->state_name = ARRAY(const char *, (size_t)model->states);
	for (struct symbol *s = b->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_COORD) {
			model->coord[s->index] = s;
			model->state_name[s->index] = s->name;
			model->state_name[model->n + s->index] = format("%s'", s->name);
		}
}

static void check_prefix(const struct building *b)
{
	const char *prefix = b->model->name, *why = prefix_objection(prefix);
	bool given = b->overrides->prefix != NULL;
	struct place at = given ? (struct place){ source_argument(prefix), 0 } : b->spec->name_at;
	bool identifier = *prefix && prefix[strspn(prefix, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789")] == 0 && !strchr("0123456789", prefix[0]);
	if (given && !identifier)
		say_error(at, NULL, "'%s' is not a C identifier", prefix);
	else if (why)
		say_error(at, given ? NULL : "give another with --prefix NAME", "'%s' %s and cannot name generated code", prefix, why);
}

static void check_parts(const struct building *b)
{
	const struct spec *spec = b->spec;
	if (spec->coords == 0)
		say_error(spec->end, "coord x", "missing coordinates: there is no statement 'coord'");
	if (!spec->step && !b->overrides->step)
		say_error(spec->end, "step 0.01, or --step 0.01 on the command line", "missing step");
	if (2 * spec->coords > LIMIT_STATES)
		say_error(b->model->coord[LIMIT_STATES / 2]->at, NULL, "more states than the limit of %d", LIMIT_STATES);
	else if (spec->coords > 0)
		check_count(b);
}

struct model *model_build(struct spec *spec, const struct overrides *overrides)
{
	struct building b = { .spec = spec, .model = NEW(struct model), .overrides = overrides };
	struct model *model = b.model;
	model->spec = spec;
	model->name = overrides->prefix ? overrides->prefix : spec->name;
	mpq_init(model->h);
	for (int i = 0; i < overrides->definitions; i++)
		define_override(&b, overrides->definition[i]);
	name_states(&b);
	if (overrides->prefix || (model->name && *model->name))
		check_prefix(&b);
	evaluate_params(&b);
	statement_guard(choose_scheme, &b);
	collect_equations(&b);
	evaluate_lets(&b);
	model->initial = rationals((size_t)model->states);
	evaluate_initials(&b);
	if (spec->step || overrides->step)
		statement_guard(evaluate_step, &b);
	if (diagnostics_errors() == 0)
		check_parts(&b);
	if (diagnostics_errors())
		return NULL;
	model->system.n = model->n;
	model->system.M = rationals((size_t)(model->n * model->n));
	model->system.C = rationals((size_t)(model->n * model->n));
	model->system.K = rationals((size_t)(model->n * model->n));
	for (int i = 0; i < model->n; i++)
		fill_row(model, i, b.residual[i]);
	check_mass(&b);
	if (diagnostics_errors())
		return NULL;
	for (int i = 0; i < model->n; i++)
		fill_loads(&b, i, b.residual[i]);
	name_outputs(&b);
	build_outputs(&b);
	model->irrationals = b.collector.irrationals;
	return diagnostics_errors() ? NULL : model;
}

void argument_value(struct model *model, const char *text, mpq_ptr value)
{
	struct collector collector = { .scheme = "exact" };
	struct place at = { source_argument(text), 0 };
	struct node *node = parse_argument((struct spec *)model->spec, at.source, 0);
	if (!node)
		abandon();
	collect_constant(&collector, node, value);
	if (mpq_sgn(value) < 0)
		error(at, NULL, "--solution takes a time that is not below 0");
	model->end_at = at;
}
