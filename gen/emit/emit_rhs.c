/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_rhs: the equations as written, for any ODE solver. */
#include "emit/emit.h"

#include <string.h>

/* Params that the equations name */
static void emit_used_constants(const struct emitter *e)
{
	mpq_t value;
	mpq_init(value);
	for (const struct symbol *s = e->model->spec->first; s; s = s->next) {
		if (!is_used(e->c, s, 0) || s->kind != SYMBOL_PARAM)
			continue;
		param_value(s, value);
		say(e, "    const double %s = %s;\n", c_name(e->c, s, 0), finite_text(s->at, value));
	}
	mpq_clear(value);
}

static bool uses_time(const struct node *node);

static bool let_uses_time(struct symbol *let)
{
	if (let->time == TIME_UNKNOWN)
		let->time = uses_time(let->value) ? TIME_READ : TIME_NOT_READ;
	return let->time == TIME_READ;
}

static bool uses_time(const struct node *node)
{
	bool let = node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET;
	bool found = node->kind == NODE_TIME || (let && let_uses_time(node->symbol));
	for (int i = 0; i < node->children && !found; i++)
		found = uses_time(node->child[i]);
	return found;
}

static int state_of_node(const struct model *written, const struct node *node)
{
	int coord = node->symbol->index + (node->component ? node->component - 1 : 0);
	return node->primes ? written->system.velocity[coord] : coord;
}

/* Flags the written states that an expression reads. */
static void mark_states(const struct model *written, const struct node *node, bool *reads)
{
	if (vanishes(node))
		return;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD && node->primes < node->symbol->highest)
		reads[state_of_node(written, node)] = true;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET && !node->symbol->marked) {
		node->symbol->marked = true;
		mark_states(written, node->symbol->value, reads);
	}
	for (int i = 0; i < node->children; i++)
		mark_states(written, node->child[i], reads);
}

static const char *residual_text(const struct identifiers *c, const struct equation *equation)
{
	const char *left = c_expression(c, equation->left), *right = c_expression(c, equation->right);
	if (vanishes(equation->left))
		return format("-(%s)", right);
	return vanishes(equation->right) || strcmp(right, "0.0") == 0 ? left : format("%s - (%s)", left, right);
}

/* Of models of first order alone the residuals may read no state, and nothing else does */
static void emit_unread_states(const struct emitter *e, bool read)
{
	for (int i = 0; i < e->model->written->n; i++)
		read = read || e->model->written->system.velocity[i] >= 0;
	if (!read)
		say(e, "    (void)y;\n");
}

/* ---- vectors and sketches: the collected equations ---- */

/* Left side minus right side of a row, without its highest derivatives, of a form each */
static void emit_residuals_of(const struct emitter *e, const struct form *const *form, int indent)
{
	int rows = e->model->written->n;
	struct formulas *f = formulas_new(e, (struct reading){ .written = true }, rows, form);
	for (int i = 0; i < rows; i++)
		tape_set(formulas_tape(f), format("residual[%d]", i), formula(f, form[i]), 18, NULL);
	emit_formulas(f, indent);
}

static const struct node *side_of(const struct spec *spec, int equation, int side)
{
	return side ? spec->equation[equation].right : spec->equation[equation].left;
}

/* As text the equations are scalar; vectors and sketches exist only collected. */
static bool is_scalar_text(const struct model *model)
{
	for (const struct symbol *s = model->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_MATRIX || (s->kind == SYMBOL_COORD && s->length))
			return false;
	for (int i = 0; i < model->spec->equations; i++)
		for (int side = 0; side < 2; side++)
			if (side_of(model->spec, i, side)->kind == NODE_MATRIX)
				return false;
	return model->spec->elements == 0 && model->spec->equations == model->n;
}

static bool reads_states(const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD)
			return true;
	return false;
}

static bool any_wave(const struct model *model, bool *math)
{
	bool any = false;
	for (int i = 0; i < model->n * model->system.segments; i++) {
		const struct form *form = model->snapshot[i / model->n].residual[i % model->n].form;
		for (int k = 0; k < form->terms; k++) {
			const struct basis *basis = &form->term[k].basis;
			any = any || basis->kind == BASIS_WAVE;
			*math = *math || (basis->kind == BASIS_WAVE && !is_polynomial(basis->wave));
		}
	}
	return any;
}

/* ---- the same with atoms: for all time ---- */

struct rhs_reading { bool time, math; };

static void read_waves(struct rhs_reading *reading, bool *seen, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		reading->time = reading->time || basis->kind == BASIS_WAVE;
		reading->math = reading->math || (basis->kind == BASIS_WAVE && !is_polynomial(basis->wave));
		if (!basis->atom || seen[basis->atom->index])
			continue;
		seen[basis->atom->index] = true;
		for (int k = 0; k < basis->atom->operands; k++)
			read_waves(reading, seen, basis->atom->operand[k]);
	}
}

static const struct form **whole_forms(const struct model *model)
{
	const struct form **form = ARRAY(const struct form *, (size_t)model->n);
	for (int i = 0; i < model->n; i++)
		form[i] = model->whole->residual[i].form;
	return form;
}

static struct rhs_reading reading_of_rhs(const struct model *model)
{
	struct rhs_reading reading = { false, false };
	bool *seen = ARRAY(bool, (size_t)atoms_count(model->atoms));
	const struct form **form = whole_forms(model);
	for (int i = 0; i < model->n; i++)
		read_waves(&reading, seen, form[i]);
	reading.math = reading.math || reads_of(model, model->n, form).math;
	return reading;
}

static void declare_residuals(const struct emitter *e, int count)
{
	say(e, "    double residual[%d];  /* left side minus right side, without the highest derivatives */\n", count);
}

/* What the function is handed and does not read */
static void emit_unread(const struct emitter *e, bool time, bool inputs, bool states)
{
	if (!time)
		say(e, "    (void)t;\n");
	if (inputs)
		say(e, "    (void)u;\n");
	emit_unread_states(e, states);
}

static void emit_whole_residuals(const struct emitter *e)
{
	const struct model *model = e->model;
	const struct form **form = whole_forms(model);
	for (int i = 0; i < model->n; i++)
		form[i] = without_highest(model, form[i]);
	const struct reads reads = reads_of(model, model->n, form);
	emit_nominal_params_read(e, &reads);
	declare_residuals(e, model->n);
	emit_residuals_of(e, form, 4);
	emit_unread(e, reading_of_rhs(model).time, given_inputs(e) > 0, any_of(reads.state, model->system.states));
}

bool rhs_needs_math(const struct emitter *e)
{
	const struct model *model = e->model->written;
	bool math = false;
	if (!is_scalar_text(model) && model->whole)
		return reading_of_rhs(model).math;
	if (!is_scalar_text(model)) {
		any_wave(model, &math);
		return math;
	}
	forget_used(e->c);
	for (int i = 0; i < model->spec->equations; i++) {
		mark_used(e->c, model->spec->equation[i].left, &math);
		mark_used(e->c, model->spec->equation[i].right, &math);
	}
	return math;
}

/* if (t < ...) {, } else if ..., } else { */
static void emit_segment(const struct emitter *e, int segment)
{
	if (segment + 1 < e->system->segments)
		say(e, "    %sif (t < $n_change[%d].hi) {\n", segment ? "} else " : "", segment);
	else
		say(e, "    } else {\n");
}

static void emit_collected_residuals(const struct emitter *e)
{
	int rows = e->model->written->n, segments = e->system->segments;
	bool math = false, several = segments > 1, read = false;
	declare_residuals(e, rows);
	for (int s = 0; s < segments; s++) {
		const struct residual *residual = e->model->snapshot[s].residual;
		if (several)
			emit_segment(e, s);
		const struct form **form = ARRAY(const struct form *, (size_t)rows);
		for (int i = 0; i < rows; i++) {
			form[i] = without_highest(e->model, residual[i].form);
			read = read || reads_states(form[i]);
		}
		emit_residuals_of(e, form, several ? 8 : 4);
	}
	if (several)
		say(e, "    }\n");
	emit_unread(e, any_wave(e->model->written, &math) || several, given_inputs(e) > 0, read);
}

/* ---- scalar equations: their own text ---- */

/* Returns whether there is any */
static bool emit_rhs_inputs(const struct emitter *e)
{
	bool inputs = false;
	for (const struct symbol *s = e->model->spec->first; s; s = s->next) {
		if (!is_used(e->c, s, 0) || s->kind != SYMBOL_INPUT)
			continue;
		say(e, "    const double %s = u[%d];\n", c_name(e->c, s, 0), s->index);
		if (is_used(e->c, s, 1))
			say(e, "    const double %s = u[%d];\n", c_name(e->c, s, 1), given_inputs(e) + s->index);
		say(e, "    (void)%s;\n", c_name(e->c, s, 0));
		inputs = true;
	}
	return inputs;
}

static void emit_rhs_locals(const struct emitter *e, const bool *reads)
{
	emit_used_constants(e);
	for (int i = 0; i < e->model->written->system.states; i++)
		if (reads[i])
			say(e, "    const double %s = y[%d];\n", written_local(e->c, e->model->written, i), i);
	if (!emit_rhs_inputs(e) && given_inputs(e))
		say(e, "    (void)u;\n");
	for (const struct symbol *s = e->model->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_LET && is_used(e->c, s, 0))
			say(e, "    const double %s = %s;\n", c_name(e->c, s, 0), c_expression(e->c, s->value));
}

static void emit_written_residuals(const struct emitter *e)
{
	const struct spec *spec = e->model->spec;
	int states = e->model->written->system.states;
	bool math = false, *reads = ARRAY(bool, (size_t)states), time = false;
	forget_used(e->c);
	for (int i = 0; i < spec->equations; i++)
		for (int side = 0; side < 2; side++) {
			const struct node *node = side_of(spec, i, side);
			mark_used(e->c, node, &math);
			mark_states(e->model->written, node, reads);
			time = time || uses_time(node);
		}
	emit_rhs_locals(e, reads);
	declare_residuals(e, spec->equations);
	for (int i = 0; i < spec->equations; i++)
		say(e, "    residual[%d] = %s;\n", i, residual_text(e->c, &spec->equation[i]));
	emit_unread(e, time, false, any_of(reads, states));
}

/* ---- the highest derivatives ---- */

static void emit_derivatives(const struct emitter *e)
{
	const struct linear *written = &e->model->written->system;
	const struct coefficient *factor = derivatives_of_residuals(e->model);
	int n = written->n;
	for (int i = 0; i < n; i++)
		if (written->velocity[i] >= 0)
			say(e, "    dydt[%d] = y[%d];\n", i, written->velocity[i]);
	for (int i = 0; i < n; i++) {
		const char **term = ARRAY(const char *, (size_t)n);
		int terms = 0, state = written->velocity[i] >= 0 ? written->velocity[i] : i;
		for (int j = 0; j < n; j++)
			if (!factor[i * n + j].zero)
				term[terms++] = scaled(factor[i * n + j].value, format("residual[%d]", j));
		say(e, "    dydt[%d] = %s;  /* the inverse mass matrix times them */\n", state, tree(terms, term, 12));
	}
}

void emit_rhs(const struct emitter *stepped)
{
	struct emitter written = *stepped, *e = &written;
	if (e->model->relative) {
		e->model = e->model->written;
		e->system = &e->model->system;
	}
	say(e, "\n/* The equations as written, for checking against any ODE solver. */\n"
	       "void $n_rhs(double t, const double y[], %sdouble dydt[])\n"
	       "{\n", given_inputs(e) ? "const double u[], " : "");
	if (is_scalar_text(e->model->written))
		emit_written_residuals(e);
	else if (e->model->whole)
		emit_whole_residuals(e);
	else
		emit_collected_residuals(e);
	emit_derivatives(e);
	say(e, "}\n");
}
