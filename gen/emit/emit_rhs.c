/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_rhs: the equations as written, for any ODE solver. */
#include "emit/emit.h"

#include <string.h>

/* Params that the equations name */
static void emit_used_constants(const struct emitter *e)
{
	struct collector collector = { .scheme = "exact" };
	mpq_t value;
	mpq_init(value);
	for (const struct symbol *s = e->model->spec->first; s; s = s->next) {
		if (!s->used || s->kind != SYMBOL_PARAM)
			continue;
		constant_value(&collector, s->collected->cell[0], value);
		fprintf(e->to, "    const double %s = %s;\n", s->c_name, finite_text(s->at, value));
	}
	mpq_clear(value);
}

static void clear_used(const struct spec *spec)
{
	for (struct symbol *s = spec->first; s; s = s->next)
		s->used = s->slope_used = false;
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
	bool found = node->kind == NODE_TIME || (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET && let_uses_time(node->symbol));
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

static const char *residual_text(const struct equation *equation)
{
	const char *left = c_expression(equation->left), *right = c_expression(equation->right);
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
		fputs("    (void)y;\n", e->to);
}

/* ---- vectors and sketches: the collected equations ---- */

static const char *join(const char *left, const char *right)
{
	return *left ? format("%s*%s", left, right) : right;
}

static const char *wave_expression(const struct basis *basis)
{
	const struct wave *wave = basis->wave;
	const char *text = "", *phase = mpq_sgn(wave->p) ? format(" + %s", shortest(round_rational(wave->p))) : "";
	for (int k = 0; k < basis->power; k++)
		text = join(text, "t");
	if (mpq_sgn(wave->a) != 0)
		text = join(text, format("exp(%s*t)", shortest(round_rational(wave->a))));
	if (oscillates(wave))
		text = join(text, format("%s(%s*t%s)", basis->sine ? "sin" : "cos", shortest(round_rational(wave->w)), phase));
	return text;
}

static bool is_highest(const struct emitter *e, const struct basis *basis)
{
	return basis->kind == BASIS_COORD && basis->order == e->model->written->frame.coord[basis->index]->highest;
}

static const char *basis_expression(const struct emitter *e, const struct basis *basis)
{
	switch (basis->kind) {
	case BASIS_ONE:   return NULL;
	case BASIS_PI:    return "3.141592653589793";
	case BASIS_WAVE:  return wave_expression(basis);
	case BASIS_INPUT: return format("u[%d]", basis->index + basis->order * e->system->inputs);
	default:          return format("y[%d]", basis->order ? e->model->written->system.velocity[basis->index] : basis->index);
	}
}

static const char *collected_residual(const struct emitter *e, const struct form *form)
{
	const char **term = ARRAY(const char *, (size_t)form->terms + 1);
	int terms = 0;
	for (int i = 0; i < form->terms; i++)
		if (!is_highest(e, &form->term[i].basis))
			term[terms++] = scaled(finite_number(e, form->term[i].factor), basis_expression(e, &form->term[i].basis));
	return terms ? tree(terms, term, 18) : "0.0";
}

/* As text the equations are scalar; vectors and sketches exist only collected. */
static bool is_scalar_text(const struct model *model)
{
	for (const struct symbol *s = model->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_MATRIX || (s->kind == SYMBOL_COORD && s->length))
			return false;
	for (int i = 0; i < model->spec->equations; i++)
		if (model->spec->equation[i].left->kind == NODE_MATRIX || model->spec->equation[i].right->kind == NODE_MATRIX)
			return false;
	return model->spec->elements == 0 && model->spec->equations == model->n;
}

static bool reads_states(const struct emitter *e, const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.kind == BASIS_COORD && !is_highest(e, &form->term[i].basis))
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

static const struct form *without_highest(const struct emitter *e, const struct form *form)
{
	struct form *rest = NEW(struct form);
	for (int i = 0; i < form->terms; i++)
		if (!is_highest(e, &form->term[i].basis))
			rest = form_sum(rest, form_single(form->term[i].basis, form->term[i].factor), false);
	return rest;
}

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

static void emit_whole_residuals(const struct emitter *e)
{
	const struct model *model = e->model;
	const struct form **form = whole_forms(model);
	for (int i = 0; i < model->n; i++)
		form[i] = without_highest(e, form[i]);
	struct writer *writer = writer_new(e, basis_expression, model->n, form);
	fprintf(e->to, "    double residual[%d];  /* left side minus right side, without the highest derivatives */\n", model->n);
	for (int i = 0; i < model->n; i++) {
		const char *text = write_form(writer, form[i], 18);
		fprintf(e->to, "    residual[%d] = %s;\n", i, text);
	}
	if (!reading_of_rhs(model).time)
		fputs("    (void)t;\n", e->to);
	if (e->system->inputs)
		fputs("    (void)u;\n", e->to);
	const struct reads reads = reads_of(model, model->n, form);
	bool read = false;
	for (int i = 0; i < model->system.states; i++)
		read = read || reads.state[i];
	emit_unread_states(e, read);
}

bool rhs_needs_math(const struct model *any)
{
	const struct model *model = any->written;
	bool math = false;
	if (!is_scalar_text(model) && model->whole)
		return reading_of_rhs(model).math;
	if (!is_scalar_text(model)) {
		any_wave(model, &math);
		return math;
	}
	clear_used(model->spec);
	for (int i = 0; i < model->spec->equations; i++) {
		mark_used(model->spec->equation[i].left, &math);
		mark_used(model->spec->equation[i].right, &math);
	}
	return math;
}

static void emit_collected_residuals(const struct emitter *e)
{
	bool math = false, read = false;
	fprintf(e->to, "    double residual[%d];  /* left side minus right side, without the highest derivatives */\n", e->model->written->n);
	for (int segment = 0; segment < e->system->segments; segment++) {
		if (e->system->segments > 1 && segment + 1 < e->system->segments)
			fprintf(e->to, "    %sif (t < %s_change[%d].hi) {\n", segment ? "} else " : "", e->name, segment);
		else if (e->system->segments > 1)
			fputs("    } else {\n", e->to);
		for (int i = 0; i < e->model->written->n; i++)
			fprintf(e->to, "    %sresidual[%d] = %s;\n", e->system->segments > 1 ? "    " : "", i,
				collected_residual(e, e->model->snapshot[segment].residual[i].form));
	}
	if (e->system->segments > 1)
		fputs("    }\n", e->to);
	if (!any_wave(e->model->written, &math) && e->system->segments == 1)
		fputs("    (void)t;\n", e->to);
	if (e->system->inputs)
		fputs("    (void)u;\n", e->to);
	for (int i = 0; i < e->model->written->n * e->system->segments; i++)
		read = read || reads_states(e, e->model->snapshot[i / e->model->written->n].residual[i % e->model->written->n].form);
	emit_unread_states(e, read);
}

/* ---- scalar equations: their own text ---- */

static void emit_rhs_locals(const struct emitter *e, const bool *reads)
{
	const struct spec *spec = e->model->spec;
	bool inputs = false;
	emit_used_constants(e);
	for (int i = 0; i < e->model->written->system.states; i++)
		if (reads[i])
			fprintf(e->to, "    const double %s = y[%d];\n", written_local(e->model->written, i), i);
	for (const struct symbol *s = spec->first; s; s = s->next) {
		if (s->used && s->kind == SYMBOL_INPUT)
			fprintf(e->to, "    const double %s = u[%d];\n", s->c_name, s->index);
		if (s->used && s->kind == SYMBOL_INPUT && s->slope_used)
			fprintf(e->to, "    const double %s = u[%d];\n", s->c_dot, e->system->inputs + s->index);
		if (s->used && s->kind == SYMBOL_INPUT)
			fprintf(e->to, "    (void)%s;\n", s->c_name);
		inputs = inputs || (s->used && s->kind == SYMBOL_INPUT);
	}
	if (e->system->inputs && !inputs)
		fputs("    (void)u;\n", e->to);
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->used && s->kind == SYMBOL_LET)
			fprintf(e->to, "    const double %s = %s;\n", s->c_name, c_expression(s->value));
}

/* Highest derivatives: minus the residuals through W^-1, W what multiplies the highest derivatives. */
static void emit_derivatives(const struct emitter *e)
{
	const struct linear *written = &e->model->written->system;
	int n = written->n, column;
	mpq_t *inverse = rationals((size_t)(n * n));
	leading_inverse(written, inverse, &column);
	for (int i = 0; i < n; i++)
		if (written->velocity[i] >= 0)
			fprintf(e->to, "    dydt[%d] = y[%d];\n", i, written->velocity[i]);
	for (int i = 0; i < n; i++) {
		const char **term = ARRAY(const char *, (size_t)n);
		int terms = 0, state = written->velocity[i] >= 0 ? written->velocity[i] : i;
		for (int j = 0; j < n; j++)
			if (mpq_sgn(inverse[i * n + j]) != 0)
				term[terms++] = scaled(-finite_number(e, inverse[i * n + j]), format("residual[%d]", j));
		fprintf(e->to, "    dydt[%d] = %s;  /* the inverse mass matrix times them */\n", state, tree(terms, term, 12));
	}
}

static void emit_written_residuals(const struct emitter *e)
{
	const struct spec *spec = e->model->spec;
	bool math = false, *reads = ARRAY(bool, (size_t)e->model->written->system.states), time = false;
	clear_used(spec);
	for (int i = 0; i < spec->equations; i++)
		for (int side = 0; side < 2; side++) {
			const struct node *node = side ? spec->equation[i].right : spec->equation[i].left;
			mark_used(node, &math);
			mark_states(e->model->written, node, reads);
			time = time || uses_time(node);
		}
	emit_rhs_locals(e, reads);
	fprintf(e->to, "    double residual[%d];  /* left side minus right side, without the highest derivatives */\n", spec->equations);
	for (int i = 0; i < spec->equations; i++)
		fprintf(e->to, "    residual[%d] = %s;\n", i, residual_text(&spec->equation[i]));
	if (!time)
		fputs("    (void)t;\n", e->to);
	bool read = false;
	for (int i = 0; i < e->model->written->system.states; i++)
		read = read || reads[i];
	emit_unread_states(e, read);
}

void emit_rhs(const struct emitter *stepped)
{
	struct emitter written = *stepped, *e = &written;
	if (e->model->relative) {
		e->model = e->model->written;
		e->system = &e->model->system;
	}
	fputs("\n/* The equations as written, for checking against any ODE solver. */\n", e->to);
	fprintf(e->to, "void %s_rhs(double t, const double y[], %sdouble dydt[])\n{\n", e->name, e->system->inputs ? "const double u[], " : "");
	if (is_scalar_text(e->model->written))
		emit_written_residuals(e);
	else if (e->model->whole)
		emit_whole_residuals(e);
	else
		emit_collected_residuals(e);
	emit_derivatives(e);
	fputs("}\n", e->to);
}
