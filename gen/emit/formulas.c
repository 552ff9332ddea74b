/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms with atoms as C: a tape of them, its operands under the names of the function that it is printed in. */
#include "formulas.h"
#include "steps.h"
#include "model/contacts/friction.h"
#include "model/reads.h"
#include "model/tunable/tuning.h"
#include "step/series/switching.h"
#include "step/exponential/recipe.h"

struct formulas {
	const struct emitter *e;
	struct tape *tape;
	struct tape_forms *forms;
	bool written;               /* over y[], u[] and t, as NAME_rhs has them */
	const char *when;           /* C: the time at which conditions on time alone hold as they do; NULL: t */
	int systems;
	struct tape_system *system; /* that are solved by lists */
};

/* ---- what a coordinate is called ---- */

static const char *coordinate_now(const struct emitter *e, int coord, int order)
{
	const struct model *written = written_model(e->model);
	if (order > 0 && order >= written->frame.coord[coord]->highest)
		return format("accel%d", coord + 1);
	int state = order ? written->system.velocity[coord] : coord;
	return e->local[e->model->reduction.place ? e->model->reduction.place[state] : state];
}

/* ---- operands: from forms ---- */

static tape_ref leaf(struct tape *t, const void *context, const struct basis *basis)
{
	const struct formulas *f = context;
	bool written = basis->kind == BASIS_FORCING && f->written;
	return written ? tape_forcing(t, basis) : tape_of_basis(t, f->e->system, basis);
}

static tape_ref friction_now(struct tape *t, const void *context, const struct atom *atom)
{
	const struct formulas *f = context;
	const struct model *model = f->e->model;
	return tape_operand(t, TAPE_FRICTION, model->switching ? transmitted_of(model->switching, atom)
							       : motion_of_friction(model, atom), 0);
}

/* ---- what interval[] says ---- */

static const struct atom *choice_in(const struct form *form)
{
	const struct atom *atom = form->terms == 1 ? form->term[0].basis.atom : NULL;
	bool plain = atom && atom->kind == ATOM_CHOOSE && mpq_cmp_ui(form->term[0].factor, 1, 1) == 0;
	return plain ? atom : NULL;
}

/* Is a - b above 0? Of what is itself chosen on the right, as the best so far of min and max, by that choice. */
static tape_ref above(struct tape_forms *forms, const void *context, const struct form *a, const struct form *b)
{
	const struct emitter *e = ((const struct formulas *)context)->e;
	const struct expansion *x = e->step->taylor.switching;
	const struct atom *chosen = choice_in(b);
	struct tape *t = tape_of_forms(forms);
	struct division d;
	if (x && find_division(x, a, b, &d) && d.function == NONE)
		return tape_operand(t, d.above ? TAPE_TRUE : TAPE_FALSE, 0, 0);
	if (x && find_division(x, a, b, &d)) {
		int rank = upper_rank(x, d.function, d.breakpoint);
		tape_ref ref = tape_operand(t, TAPE_ABOVE, d.function, rank);
		return d.above ? ref : tape_unary(t, TAPE_NOT, ref);
	}
	if (!chosen)
		internal_error(e->step, "a choice by the state that no expression stands for");
	tape_ref first = above(forms, context, a, chosen->operand[1]);
	tape_ref second = above(forms, context, a, chosen->operand[2]);
	return tape_select(t, tape_condition(forms, chosen->operand[0]), first, second);
}

/* ---- operands: to C ---- */

static const char *written_operand(const struct emitter *e, const struct tape_node *n)
{
	const struct linear *system = &e->model->written->system;
	if (n->op == TAPE_COORD)
		return format("y[%d]", n->part ? system->velocity[n->index] : n->index);
	if (n->index >= e->model->spec->count.inputs)
		return param_local(e, param_of_input(e->model->spec, n->index));
	return format("u[%d]", n->index + n->part * given_inputs(e));
}

static const char *operand(const void *context, const struct tape_node *n)
{
	const struct formulas *f = context;
	const struct emitter *e = f->e;
	switch (n->op) {
	case TAPE_COORD:    return f->written ? written_operand(e, n) : coordinate_now(e, n->index, n->part);
	case TAPE_INPUT:    return f->written ? written_operand(e, n) : input_name(e, n->index, n->part);
	case TAPE_LOAD:     return load_operand(e, n->index, n->part);
	case TAPE_STATE:    return e->local[n->index];
	case TAPE_SAMPLE:   return input_operand(e, n->index);
	case TAPE_ACCUMULATE: return format("s->%s[%d]", n->part == PLACE_CARRY ? "carry" : "low", n->index);
	case TAPE_PARAM:    return param_local(e, n->index);
	case TAPE_TIME:     return n->part ? f->when : "t";
	case TAPE_FRICTION:
		if (!e->model->switching)
			return format("motion[%d]", n->index);
		return format("%s(s, %d)", spell(e, "$n_friction_force"), n->index);
	case TAPE_ABOVE:    return format("interval[%d] > %d", n->index, n->part);
	default: break;
	}
	if (n->part < LINEAR_TABLES)
		return linear_entry(e, n);
	return n->part >= TABLE_SOLVED ? format("solved_by_%d[%d]", n->part - TABLE_SOLVED, n->index)
				       : format("%s[%d]", n->part == TABLE_NODE ? "node" : "excess", n->index);
}

static const char *number(const void *context, mpq_srcptr value)
{
	const struct formulas *f = context;
	return shortest(finite_number(f->e, value));
}

/* ---- the whole ---- */

static const struct tape_let *lets_of(const struct emitter *e, int *count)
{
	int most = 0;
	for (const struct symbol *s = e->model->spec->first; s; s = s->next)
		most += s->kind == SYMBOL_LET && s->made.full;
	struct tape_let *let = ARRAY(struct tape_let, (size_t)most + 1);
	*count = 0;
	for (const struct symbol *s = e->model->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_LET && s->made.full)
			let[(*count)++] = (struct tape_let){ c_name(e->c, s, 0), s->made.full };
	return let;
}

struct formulas *formulas_new(const struct emitter *e, struct reading how, int count,
			      const struct form *const *form)
{
	struct formulas *f = NEW(struct formulas);
	*f = (struct formulas){ .e = e, .tape = tape_new(), .written = how.written, .when = how.when };
	struct tape_reader reader = { leaf, how.by_intervals ? above : NULL, friction_now, f, how.when != NULL, false };
	int lets;
	const struct tape_let *let = lets_of(e, &lets);
	f->forms = tape_forms_new(f->tape, reader, count, form, lets, let);
	return f;
}

struct tape *formulas_tape(const struct formulas *f)
{
	return f->tape;
}

tape_ref formula(struct formulas *f, const struct form *form)
{
	return tape_form(f->forms, form);
}

/* ---- equations that are solved by lists ---- */

const char *factor_by_lists(const struct emitter *e, struct listed_matrix m)
{
	return spell(e, "$n_factor_by_lists(%d, %d, $n_first_%s_%d, $n_before_%s_%d, matrix_by_%d);", m.n, m.symmetric,
		     m.lists, m.number, m.lists, m.number, m.number);
}

const char *solve_by_lists(const struct emitter *e, struct listed_matrix m, int rights, int solved)
{
	return spell(e, "$n_solve_by_lists(%d, %d, $n_first_%s_%d, $n_before_%s_%d, matrix_by_%d, solved_by_%d);", m.n,
		     rights, m.lists, m.number, m.lists, m.number, m.number, solved);
}

void emit_factor_lists(const struct emitter *e, struct listed_matrix m, const int *first, const int *before)
{
	say(e, "\n/* Factors of a matrix of %d equations: where the columns of each row begin that are not 0, and "
	       "these columns */\n", m.n);
	emit_integers(e, "short", format("first_%s_%d", m.lists, m.number), m.n + 1, first);
	emit_integers(e, "short", format("before_%s_%d", m.lists, m.number), first[m.n] ? first[m.n] : 1, before);
}

static struct listed_matrix matrix_of(const struct tape_system *s)
{
	return (struct listed_matrix){ s->n, s->symmetric, "by", s->matrix };
}

static const char *solve_lists(const void *context, const struct tape_system *s)
{
	struct formulas *f = *(struct formulas *const *)context;
	*MORE(f->system, f->systems) = *s;
	const char *solve = solve_by_lists(f->e, matrix_of(s), s->rights, s->number);
	return s->factored ? solve : format("%s %s", factor_by_lists(f->e, matrix_of(s)), solve);
}

void solve_formulas_by_lists(struct formulas *f, int count, const struct form *const *form)
{
	tape_solve_by_lists(f->forms, count, form, &(struct tape_solver){ solve_lists, &f, TABLE_SOLVED });
}

void emit_solved_locals(const struct formulas *f)
{
	for (int i = 0; i < f->systems; i++) {
		const struct tape_system *s = &f->system[i];
		if (!s->factored)
			say(f->e, "    double matrix_by_%d[%d] = {0.0};\n", s->matrix, s->n * s->n);
		say(f->e, "    double solved_by_%d[%d] = {0.0};\n", s->number, s->n * s->rights);
	}
}

static void emit_factor_columns(const struct emitter *e, const struct tape_system *s)
{
	const int n = s->n;
	int *first = ARRAY(int, n + 1);
	bool *filled = ARRAY(bool, n * n);
	for (int i = 0; i < n * n; i++)
		filled[i] = s->M[i]->terms || s->M[i % n * n + i / n]->terms;
	const int *before = factor_columns(n, filled, first);
	emit_factor_lists(e, matrix_of(s), first, before);
}

void emit_solved_tables(const struct formulas *f)
{
	for (int i = 0; i < f->systems; i++)
		if (!f->system[i].factored)
			emit_factor_columns(f->e, &f->system[i]);
}

tape_ref formula_sizes(struct formulas *f, const struct form *form)
{
	tape_ref *size = ARRAY(tape_ref, (size_t)form->terms + 1);
	for (int k = 0; k < form->terms; k++)
		size[k] = tape_unary(f->tape, TAPE_SIZE, tape_term(f->forms, &form->term[k]));
	return tape_sum(f->tape, form->terms, size);
}

static void note_read(struct reads *r, const struct emitter *e, const struct tape_node *n)
{
	const struct model *model = written_model(e->model);
	if (n->op == TAPE_COORD && n->part > 0 && n->part >= model->frame.coord[n->index]->highest)
		r->highest[n->index] = true;
	else if (n->op == TAPE_COORD)
		r->state[n->part ? model->system.velocity[n->index] : n->index] = true;
	else if (n->op == TAPE_INPUT)
		r->input[n->index + n->part * model->system.inputs] = true;
	else if (n->op == TAPE_LOAD && n->part < 2 && is_polynomial(e->system->load[n->index].forcing))
		r->time = true;                         /* as load_operand has it */
	else if (n->op == TAPE_LOAD)
		r->load[n->index] = true;
	else if (n->op == TAPE_PARAM)
		r->param[n->index] = true;
	r->time = r->time || (n->op == TAPE_TIME && n->part == 0);
}

void note_reads(struct reads *r, const struct emitter *e, const struct tape *t)
{
	const int *uses = tape_uses(t);
	for (int i = 0; i < tape_length(t); i++)
		if (uses[i])
			note_read(r, e, tape_node(t, i));
}

struct reads reads_of_formulas(const struct formulas *f)
{
	struct reads r = reads_of(written_model(f->e->model), 0, NULL);
	note_reads(&r, f->e, f->tape);
	return r;
}

void formulas_finish(struct formulas *f)
{
	tape_name_lets(f->forms);
	const char *broken = tape_check(f->tape);
	if (broken)
		internal_error(f->e->step, broken);
}

void emit_formulas(struct formulas *f, int indent)
{
	formulas_finish(f);
	struct tape_target to = { .real = "double", .number = number, .operand = operand, .size = "pl_magnitude",
				  .accumulate = "pl_accumulate", .context = f, .indent = indent,
				  .rows_alike = f->e->at != NULL, .rolls = f->e->device ? 0 : LONG_RUN };
	tape_print(f->tape, &to, f->e->to);
}
