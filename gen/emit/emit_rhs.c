/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_rhs: the equations as written, for any ODE solver. */
#include "steps.h"
#include "model/building.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"

/* What a row leaves, left side minus right side, without its highest derivatives */
static const char *residual(int row)
{
	return format("residual[%d]", row);
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

/* ---- scalar equations: their own text ---- */

static const char *let_name(const void *context, const struct symbol *let)
{
	return c_name(((const struct emitter *)context)->c, let, 0);
}

static const struct symbol *symbol_of(const struct spec *spec, int number)
{
	const struct symbol *s = spec->first;
	while (s->number != number)
		s = s->next;
	return s;
}

static const char *operand(const void *context, const struct tape_node *n)
{
	const struct emitter *e = context;
	const struct model *written = e->model->written;
	switch (n->op) {
	case TAPE_PARAM: return c_name(e->c, symbol_of(e->model->spec, n->index), 0);
	case TAPE_INPUT: return input_name(e, n->index, n->part);
	case TAPE_COORD: return written_local(e->c, written, n->part ? written->system.velocity[n->index] : n->index);
	default:         return "t";
	}
}

static const char *number(const void *context, mpq_srcptr value)
{
	return shortest(finite_number(context, value));
}

/* Left side minus right side of each equation, with its highest derivatives or without */
static tape_ref *written_residuals(const struct emitter *e, struct tape *t, bool highest)
{
	const struct spec *spec = e->model->spec;
	struct tape_expressions *x = tape_expressions_new(t, spec->count.symbols, highest, let_name, e);
	tape_ref *residual = ARRAY(tape_ref, spec->equations);
	for (int i = 0; i < spec->equations; i++) {
		tape_ref left = tape_expression(x, spec->equation[i].left), zero = tape_number(t, 0);
		tape_ref right = tape_unary(t, TAPE_NEG, tape_expression(x, spec->equation[i].right));
		residual[i] = left == zero ? right : right == zero ? left : tape_binary(t, TAPE_ADD, left, right);
	}
	return residual;
}

/* dydt of the highest derivatives, where their factors depend on the state: by elimination on the tape */
static void set_solved(const struct emitter *e, struct tape *t, const tape_ref *without)
{
	const struct linear *written = &e->model->written->system;
	const int n = written->n, *owner = e->model->equations.owner;
	const tape_ref *with = written_residuals(e, t, true), zero = tape_number(t, 0);
	SCRATCH tape_ref *M = ARRAY(tape_ref, n * n), *right = ARRAY(tape_ref, n), *x = ARRAY(tape_ref, n);
	for (int i = 0; i < n; i++) {
		right[i] = tape_unary(t, TAPE_NEG, without[owner[i]]);
		for (int j = 0; j < n; j++) {
			int order = written->velocity[j] >= 0 ? 2 : 1;
			tape_ref entry = tape_forward(t, with[owner[i]], TAPE_COORD, j, order);
			M[i * n + j] = entry == zero ? TAPE_NONE : entry;
		}
	}
	tape_solve(tape_factors_new(t, n, M), right, x);
	for (int i = 0; i < n; i++)
		tape_set(t, format("dydt[%d]", highest_state(written, i)), x[i], 10, NULL);
}

static struct tape *written_tape(const struct emitter *e)
{
	struct tape *t = tape_new();
	const tape_ref *without = written_residuals(e, t, false);
	if (e->model->equations.moving_mass)
		set_solved(e, t, without);
	for (int i = 0; i < e->model->spec->equations && !e->model->equations.moving_mass; i++)
		tape_set(t, residual(i), without[i], 10, NULL);
	return t;
}

/* Whether the program of the equations' text solves them too */
static bool solves(const struct emitter *e)
{
	return e->model->equations.moving_mass && is_scalar_text(e->model->written);
}

static void emit_read_params(const struct emitter *e, const struct tape *t)
{
	bool *read = ARRAY(bool, (size_t)e->model->spec->count.symbols + 1);
	RATIONAL value = ZERO;
	tape_mark(t, TAPE_PARAM, 0, read);
	for (const struct symbol *s = e->model->spec->first; s; s = s->next) {
		if (!read[s->number])
			continue;
		param_value(s, value);
		say(e, "    const double %s = %s;\n", c_name(e->c, s, 0), finite_text(s->at, value));
	}
}

static void emit_read_states(const struct emitter *e, const struct tape *t)
{
	const struct model *written = e->model->written;
	bool *read[2];
	for (int order = 0; order < 2; order++) {
		read[order] = ARRAY(bool, (size_t)written->n + 1);
		tape_mark(t, TAPE_COORD, order, read[order]);
	}
	for (int i = 0; i < written->system.states; i++)
		if (read[i >= written->n][written->system.coord[i]])
			say(e, "    const double %s = y[%d];\n", written_local(e->c, written, i), i);
}

static void emit_read_inputs(const struct emitter *e, const struct tape *t)
{
	int inputs = e->model->spec->count.inputs;
	for (int order = 0; order < 2; order++) {
		bool *read = ARRAY(bool, (size_t)inputs + 1);
		tape_mark(t, TAPE_INPUT, order, read);
		for (int i = 0; i < inputs; i++)
			if (read[i])
				say(e, "    const double %s = u[%d];\n", input_name(e, i, order),
				    i + order * given_inputs(e));
	}
}

static void emit_written_residuals(const struct emitter *e, const struct tape *t)
{
	const struct tape_target to = { .real = "double", .number = number, .operand = operand, .size = "pl_magnitude",
					.context = e, .indent = 4 };
	emit_read_params(e, t);
	emit_read_states(e, t);
	emit_read_inputs(e, t);
	tape_print(t, &to, e->to);
}

/* ---- vectors, sketches, and what is not linear in them: the collected equations ---- */

/* Of a segment of time; with atoms: for all time */
static struct formulas *collected(const struct emitter *e, int segment, int indent)
{
	const struct model *model = e->model;
	int rows = model->written->n;
	const struct residual *from = model->equations.full ? model->equations.full->residual
							     : model->equations.segment_equations[segment].residual;
	const struct form **form = ARRAY(const struct form *, (size_t)rows);
	for (int i = 0; i < rows; i++)
		form[i] = without_highest(model, from[i].form);
	struct formulas *f = formulas_new(e, (struct reading){ .written = true }, rows, form);
	for (int i = 0; i < rows; i++)
		tape_set(formulas_tape(f), residual(i), formula(f, form[i]), indent + 14, NULL);
	return f;
}

static int segments_of(const struct emitter *e)
{
	return e->model->equations.full ? 1 : e->system->segments;
}

/* if (t < ...) {, } else if ..., } else { */
static void emit_segment(const struct emitter *e, int segment)
{
	if (segment + 1 < e->system->segments)
		say(e, "    %sif (t < $n_change[%d].hi) {\n", segment ? "} else " : "", segment);
	else
		say(e, "    } else {\n");
}

/* What is left of the equations, segment after segment; returns what reads t, u and y */
struct read { bool time, inputs, states; };

static void note(struct read *read, const struct tape *t)
{
	read->time = read->time || tape_reads(t, TAPE_TIME, -1, -1);
	read->inputs = read->inputs || tape_reads(t, TAPE_INPUT, -1, -1);
	read->states = read->states || tape_reads(t, TAPE_COORD, -1, -1);
}

static struct read emit_collected_residuals(const struct emitter *e)
{
	bool several = segments_of(e) > 1;
	struct read read = { .time = several };
	for (int s = 0; s < segments_of(e); s++) {
		struct formulas *f = collected(e, s, several ? 8 : 4);
		note(&read, formulas_tape(f));
		if (several)
			emit_segment(e, s);
		struct reads reads = reads_of_formulas(f);
		if (e->model->equations.full)
			emit_nominal_params_read(e, &reads);
		emit_formulas(f, several ? 8 : 4);
	}
	if (several)
		say(e, "    }\n");
	return read;
}

static struct read emit_residuals(const struct emitter *e)
{
	struct read read = { false, false, false };
	if (!solves(e))
		say(e, "    double residual[%d];  /* left side minus right side, without the highest derivatives */\n",
		    e->model->written->n);
	if (!is_scalar_text(e->model->written))
		return emit_collected_residuals(e);
	struct tape *t = written_tape(e);
	emit_written_residuals(e, t);
	note(&read, t);
	return read;
}

/* What the function is handed and does not read. Of models of first order alone the residuals may read no state, and
 * nothing else does. */
static void emit_unread(const struct emitter *e, struct read read)
{
	for (int i = 0; i < e->model->written->n; i++)
		read.states = read.states || e->model->written->system.velocity[i] >= 0;
	say(e, "%s%s%s", read.time ? "" : "    (void)t;\n", read.inputs || !given_inputs(e) ? "" : "    (void)u;\n",
	    read.states ? "" : "    (void)y;\n");
}

void check_rhs(const struct emitter *e)
{
	if (e->model->contacts.drags > 0 || e->model->contacts.massless_sliders > 0 ||
	    (e->model->switching && has_dry_friction(e->model->switching)))
		error((struct place){ source_argument("--rhs"), 0 }, "a solver has to go from event to event itself",
		      "--rhs has no formula for friction, whose force is a set where it sticks");
}

bool rhs_needs_math(const struct emitter *e)
{
	bool calls = false;
	struct emitter written = *e;
	written.model = e->model->written;
	written.system = &written.model->system;
	if (is_scalar_text(written.model))
		return tape_cost(written_tape(&written)).calls > 0;
	for (int s = 0; s < segments_of(&written); s++)
		calls = calls || tape_cost(formulas_tape(collected(&written, s, 4))).calls > 0;
	return calls;
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
	if (solves(e))
		return;
	for (int i = 0; i < n; i++) {
		struct summands s = { 0 };
		for (int j = 0; j < n; j++)
			if (!factor[i * n + j].zero)
				add_summand(&s, scaled(factor[i * n + j].value, format("residual[%d]", j)));
		say(e, "    dydt[%d] = %s;  /* the inverse mass matrix times them */\n", highest_state(written, i),
		    sum_of(&s, 12));
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
	emit_unread(e, emit_residuals(e));
	emit_derivatives(e);
	say(e, "}\n");
}
