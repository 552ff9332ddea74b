/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms with atoms as nodes of a tape. */
#include "tape/tape.h"

struct tape_forms {
	struct tape *tape;
	struct tape_reader reader;
	int room;                   /* for atoms */
	int *uses;                  /* per atom: by how many terms */
	tape_ref *made;             /* per atom; TAPE_NONE: not yet */
	int lets;
	const struct tape_let *let;
	int solutions;
	struct { const struct atom *atom; tape_ref *x; } *solution; /* all components at once */
};

/* ---- what is read how often ---- */

static void make_room(struct tape_forms *f, int atoms)
{
	if (atoms <= f->room)
		return;
	int room = f->room;
	f->room = 2 * atoms;
	ENLARGE(f->uses, (size_t)f->room);
	ENLARGE(f->made, (size_t)f->room);
	for (int i = room; i < f->room; i++) {
		f->uses[i] = 0;
		f->made[i] = TAPE_NONE;
	}
}

void tape_count_form(struct tape_forms *f, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *atom = form->term[i].basis.atom;
		make_room(f, atom ? atom->index + 1 : 0);
		if (!atom || f->uses[atom->index]++ > 0)
			continue;
		for (int k = 0; k < atom->operands; k++)
			tape_count_form(f, atom->operand[k]);
	}
}

static const struct atom *only_atom(const struct form *form)
{
	bool plain = form->terms == 1 && mpq_cmp_ui(form->term[0].factor, 1, 1) == 0;
	return plain ? form->term[0].basis.atom : NULL;
}

struct tape_forms *tape_forms_new(struct tape *t, struct tape_reader reader, int count,
				  const struct form *const *form, int lets, const struct tape_let *let)
{
	struct tape_forms *f = NEW(struct tape_forms);
	*f = (struct tape_forms){ .tape = t, .reader = reader, .lets = lets, .let = let };
	for (int i = 0; i < count; i++)
		tape_count_form(f, form[i]);
	for (int i = 0; i < lets; i++) {        /* where a let stands its factor does not go into it */
		const struct atom *atom = only_atom(let[i].form);
		if (!atom)
			continue;
		make_room(f, atom->index + 1);
		f->uses[atom->index] += 2;
	}
	return f;
}

struct tape *tape_of_forms(const struct tape_forms *f)
{
	return f->tape;
}

/* ---- atoms ---- */

static tape_ref atom_ref(struct tape_forms *f, const struct atom *a);

static const struct form *divisor_of(const struct form *form)
{
	const struct atom *atom = form->terms == 1 ? form->term[0].basis.atom : NULL;
	return atom && atom->kind == ATOM_RECIPROCAL ? atom->operand[0] : NULL;
}

static tape_ref times(struct tape *t, tape_ref product, tape_ref factor)
{
	return product == TAPE_NONE ? factor : tape_binary(t, TAPE_MUL, product, factor);
}

/* product * a^n, squares of what is multiplied more often found first */
static tape_ref times_power(struct tape *t, tape_ref product, tape_ref a, unsigned n)
{
	if (n > 3) {
		tape_ref half = tape_power(t, a, n / 2);
		product = times(t, times(t, product, half), half);
		return n % 2 ? times(t, product, a) : product;
	}
	for (unsigned k = 0; k < n; k++)
		product = times(t, product, a);
	return product;
}

/* `before` times the factors, from the left to the right, over the divisors; before TAPE_NONE: 1 */
static tape_ref product_ref(struct tape_forms *f, const struct atom *a, tape_ref before)
{
	struct tape *t = f->tape;
	SCRATCH tape_ref *below = ARRAY(tape_ref, a->operands);
	tape_ref product = before;
	int divisors = 0;
	for (int i = 0; i < a->operands; i++) {
		const struct form *operand = a->operand[i], *divisor = divisor_of(operand);
		const struct atom *inner = a->exponent[i] == 1 ? only_atom(operand) : NULL;
		if (inner && inner->kind == ATOM_PRODUCT && f->uses[inner->index] <= 1)
			product = product_ref(f, inner, product);
		else if (divisor && f->made[operand->term[0].basis.index] == TAPE_NONE)
			below[divisors++] = tape_power(t, tape_form(f, divisor), a->exponent[i]);
		else
			product = times_power(t, product, tape_form(f, operand), a->exponent[i]);
	}
	if (product == TAPE_NONE)
		product = tape_number(t, 1);
	for (int i = 0; i < divisors; i++)
		product = tape_binary(t, TAPE_DIV, product, below[i]);
	return product;
}

/* Do conditions on these hold as the step says, not as their numbers do? */
static bool is_decided_by_state(const struct tape_forms *f, const struct form *left, const struct form *right)
{
	return f->reader.above && !(is_linear_in_time(left) && is_linear_in_time(right));
}

/* left < right or the like; at equality the functions that ask are the same on either side */
static tape_ref side(struct tape_forms *f, const struct form *left, enum comparison comparison,
		     const struct form *right)
{
	struct tape *t = f->tape;
	if (!is_decided_by_state(f, left, right))
		return tape_compare(t, comparison, tape_form(f, left), tape_form(f, right));
	tape_ref above = f->reader.above(f, f->reader.context, left, right);
	return comparison <= CMP_LE ? tape_unary(t, TAPE_NOT, above) : above;
}

/* The largest or smallest where the order of each two is known: each with each other */
static tape_ref best_ref(struct tape_forms *f, const struct atom *a, int next, int champion)
{
	if (next == a->operands)
		return tape_form(f, a->operand[champion]);
	tape_ref better = side(f, a->operand[next], a->function == FN_MIN ? CMP_LT : CMP_GT, a->operand[champion]);
	tape_ref other = best_ref(f, a, next + 1, next);
	return tape_select(f->tape, better, other, best_ref(f, a, next + 1, champion));
}

static tape_ref extreme_ref(struct tape_forms *f, const struct atom *a)
{
	if (f->reader.above)
		return best_ref(f, a, 1, 0);
	tape_ref best = tape_form(f, a->operand[0]);
	for (int i = 1; i < a->operands; i++) {
		tape_ref x = tape_form(f, a->operand[i]);
		tape_ref better = tape_compare(f->tape, a->function == FN_MIN ? CMP_LT : CMP_GT, x, best);
		best = tape_select(f->tape, better, x, best);
	}
	return best;
}

static tape_ref table_ref(struct tape_forms *f, const struct atom *a)
{
	struct straight *piece;
	int pieces = pieces_of_atom(a, &piece);
	tape_ref x = tape_form(f, a->operand[0]), *below = ARRAY(tape_ref, pieces + 1);
	for (int p = 0; p < pieces && piece[p].end; p++)
		below[p] = side(f, a->operand[0], CMP_LT, form_constant(piece[p].end));
	return tape_table(f->tape, x, pieces, piece, below);
}

tape_ref tape_form_in_time(struct tape *t, const struct form *form)
{
	SCRATCH tape_ref *term = ARRAY(tape_ref, form->terms + 1);
	tape_ref when = tape_operand(t, TAPE_TIME, 0, 1);
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		tape_ref factor = tape_constant(t, form->term[i].factor);
		term[i] = basis->kind == BASIS_FORCING && basis->power > 0 ? times(t, factor, when)
			  : basis->kind == BASIS_PI			? times(t, factor, tape_pi(t))
									: factor;
	}
	return tape_sum(t, form->terms, term);
}

static bool is_decided_in_time(const struct tape_forms *f, const struct atom *a)
{
	bool timed = f->reader.timed;
	for (int i = 0; i < a->operands; i++)
		timed = timed && is_linear_in_time(a->operand[i]);
	return timed;
}

static tape_ref operand_of_condition(struct tape_forms *f, const struct atom *a, int k)
{
	return is_decided_in_time(f, a) ? tape_form_in_time(f->tape, a->operand[k]) : tape_form(f, a->operand[k]);
}

static tape_ref sign_ref(struct tape_forms *f, const struct atom *a)
{
	struct tape *t = f->tape;
	const struct form *zero = form_number(0);
	if (is_decided_by_state(f, a->operand[0], zero))
		return tape_select(t, side(f, a->operand[0], CMP_GT, zero), tape_number(t, 1), tape_number(t, -1));
	return tape_unary(t, TAPE_SIGN, operand_of_condition(f, a, 0));
}

/* The piece below the limits, between and above them */
static tape_ref limited_ref(struct tape_forms *f, const struct atom *a)
{
	struct tape *t = f->tape;
	bool clips = a->function == FN_CLIP;
	tape_ref x = tape_form(f, a->operand[0]), low = tape_form(f, a->operand[1]), high = tape_form(f, a->operand[2]);
	tape_ref below = side(f, a->operand[0], CMP_LT, a->operand[1]);
	tape_ref beyond = side(f, a->operand[0], CMP_GT, a->operand[2]);
	tape_ref under = clips ? low : tape_binary(t, TAPE_ADD, x, tape_unary(t, TAPE_NEG, low));
	tape_ref over = clips ? high : tape_binary(t, TAPE_ADD, x, tape_unary(t, TAPE_NEG, high));
	return tape_select(t, below, under, tape_select(t, beyond, over, clips ? x : tape_number(t, 0)));
}

static tape_ref call_ref(struct tape_forms *f, const struct atom *a)
{
	struct tape *t = f->tape;
	tape_ref x;
	switch (a->function) {
	case FN_TABLE:    return table_ref(f, a);
	case FN_FRICTION:
	case FN_SLIDE:    return f->reader.friction(t, f->reader.context, a);
	case FN_MIN:
	case FN_MAX:      return extreme_ref(f, a);
	case FN_SGN:      return sign_ref(f, a);
	case FN_CLIP:
	case FN_DEADZONE: return limited_ref(f, a);
	case FN_ABS:
		x = tape_form(f, a->operand[0]);
		return tape_select(t, side(f, a->operand[0], CMP_LT, form_number(0)), tape_unary(t, TAPE_NEG, x), x);
	case FN_ATAN2:
		x = tape_form(f, a->operand[0]);
		return tape_binary(t, TAPE_ATAN2, x, tape_form(f, a->operand[1]));
	default:          return tape_call(t, a->function, tape_form(f, a->operand[0]));
	}
}

static tape_ref comparison_ref(struct tape_forms *f, const struct atom *a)
{
	if (is_decided_by_state(f, a->operand[0], a->operand[1]))
		return side(f, a->operand[0], a->comparison, a->operand[1]);
	tape_ref left = operand_of_condition(f, a, 0);
	return tape_compare(f->tape, a->comparison, left, operand_of_condition(f, a, 1));
}

tape_ref tape_condition(struct tape_forms *f, const struct form *condition)
{
	const struct atom *atom = only_atom(condition);
	if (atom && atom->kind == ATOM_COMPARE)
		return comparison_ref(f, atom);
	return tape_binary(f->tape, TAPE_UNEQUAL, tape_form(f, condition), tape_number(f->tape, 0));
}

static tape_ref nominal_ref(struct tape *t, const struct symbol *param)
{
	RATIONAL value = ZERO;
	param_value(param, value);
	return tape_constant(t, value);
}

/* A form that is 0 takes no operation. */
static tape_ref entry_ref(struct tape_forms *f, const struct form *form)
{
	return form->terms ? tape_form(f, form) : TAPE_NONE;
}

static void add_solution(struct tape_forms *f, const struct atom *a, tape_ref *x)
{
	ENLARGE(f->solution, (size_t)f->solutions + 1);
	f->solution[f->solutions].atom = a;
	f->solution[f->solutions++].x = x;
}

static tape_ref solution_ref(struct tape_forms *f, const struct atom *a)
{
	const struct linear_system e = system_of(a, a->operand);
	int known = 0;
	while (known < f->solutions && !same_solution(f->solution[known].atom, a))
		known++;
	if (known == f->solutions) {
		SCRATCH tape_ref *M = ARRAY(tape_ref, e.n * e.n), *right = ARRAY(tape_ref, e.n);
		tape_ref *x = ARRAY(tape_ref, e.n);
		for (int i = 0; i < e.n * e.n; i++)
			M[i] = entry_ref(f, e.M[i]);
		for (int i = 0; i < e.n; i++)
			right[i] = entry_ref(f, e.f[i]);
		tape_solve(tape_factors_new(f->tape, e.n, M), right, x);
		known = f->solutions;           /* operands may have been solutions themselves */
		add_solution(f, a, x);
	}
	tape_ref x = f->solution[known].x[a->component];
	return x == TAPE_NONE ? tape_number(f->tape, 0) : x;
}

static tape_ref new_atom_ref(struct tape_forms *f, const struct atom *a)
{
	struct tape *t = f->tape;
	tape_ref x, condition;
	switch (a->kind) {
	case ATOM_PARAM:      return f->reader.nominal ? nominal_ref(t, a->param)
						      : tape_operand(t, TAPE_PARAM, a->param->tuning.number - 1, 0);
	case ATOM_PRODUCT:    return product_ref(f, a, TAPE_NONE);
	case ATOM_RECIPROCAL: return tape_binary(t, TAPE_DIV, tape_number(t, 1), tape_form(f, a->operand[0]));
	case ATOM_POWER:
		x = tape_form(f, a->operand[0]);
		return tape_binary(t, TAPE_POWER, x, tape_form(f, a->operand[1]));
	case ATOM_CALL:       return call_ref(f, a);
	case ATOM_SOLUTION:   return solution_ref(f, a);
	case ATOM_COMPARE:    return tape_select(t, comparison_ref(f, a), tape_number(t, 1), tape_number(t, 0));
	default:
		condition = tape_condition(f, a->operand[0]);
		x = tape_form(f, a->operand[1]);
		return tape_select(t, condition, x, tape_form(f, a->operand[2]));
	}
}

static tape_ref atom_ref(struct tape_forms *f, const struct atom *a)
{
	make_room(f, a->index + 1);
	if (f->made[a->index] == TAPE_NONE)
		f->made[a->index] = new_atom_ref(f, a);
	return f->made[a->index];
}

/* ---- solutions by lists ---- */

struct listed { const struct atom *atom; int matrix, level, right; }; /* one system */
struct listing {
	struct tape_forms *f;
	const struct tape_solver *solver;
	int *level;                 /* per atom: systems that wait for one another in it, and 1; 0: not known yet */
	int count, matrices, systems;
	struct listed *listed;
};

static bool same_matrix(const struct atom *a, const struct atom *b)
{
	const struct linear_system e = system_of(a, a->operand), other = system_of(b, b->operand);
	bool same = e.n == other.n;
	for (int i = 0; same && i < e.n * e.n; i++)
		same = e.M[i] == other.M[i] || same_form(e.M[i], other.M[i]);
	return same;
}

static void list_system(struct listing *l, const struct atom *a, int level)
{
	int matrix = l->matrices;
	for (int i = 0; i < l->count; i++) {
		if (same_solution(l->listed[i].atom, a))
			return;
		if (matrix == l->matrices && same_matrix(l->listed[i].atom, a))
			matrix = l->listed[i].matrix;
	}
	l->matrices += matrix == l->matrices;
	*MORE(l->listed, l->count) = (struct listed){ a, matrix, level, 0 };
}

static int level_of_form(struct listing *l, const struct form *form);

static int level_of_atom(struct listing *l, const struct atom *a)
{
	int level = 1;
	if (l->level[a->index])
		return l->level[a->index];
	for (int k = 0; k < a->operands; k++) {
		const int inner = level_of_form(l, a->operand[k]);
		level = inner > level ? inner : level;
	}
	const bool listed = a->kind == ATOM_SOLUTION && system_of(a, a->operand).n > LISTED_EQUATIONS;
	if (listed)
		list_system(l, a, level);
	return l->level[a->index] = level + listed;
}

static int level_of_form(struct listing *l, const struct form *form)
{
	int level = 1;
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		const int inner = a ? level_of_atom(l, a) : 1;
		level = inner > level ? inner : level;
	}
	return level;
}

static void set_entries(struct listing *l, const struct atom *a, int matrix)
{
	const struct linear_system e = system_of(a, a->operand);
	for (int i = 0; i < e.n * e.n; i++)
		if (e.M[i]->terms)
			tape_set(l->f->tape, format("matrix_by_%d[%d]", matrix, i), tape_form(l->f, e.M[i]), 10, NULL);
}

static void set_right(struct listing *l, const struct listed *own, const struct tape_system *s)
{
	const struct linear_system e = system_of(own->atom, own->atom->operand);
	for (int i = 0; i < e.n; i++)
		if (e.f[i]->terms)
			tape_set(l->f->tape, format("solved_by_%d[%d]", s->number, i * s->rights + own->right),
				 tape_form(l->f, e.f[i]), 10, NULL);
}

/* The right sides of one matrix that wait for as many systems; rights 0: there are none */
static struct tape_system set_system(struct listing *l, int matrix, int level)
{
	struct tape_system s = { .number = l->systems, .matrix = matrix };
	for (int i = 0; i < l->count; i++) {
		struct listed *own = &l->listed[i];
		const struct linear_system e = system_of(own->atom, own->atom->operand);
		s.factored = s.factored || (own->matrix == matrix && own->level < level);
		if (own->matrix != matrix || own->level != level)
			continue;
		own->right = s.rights++;
		s.n = e.n;
		s.M = e.M;
	}
	s.symmetric = s.rights > 0;
	for (int i = 0; i < s.n * s.n && s.symmetric; i++)
		s.symmetric = same_form(s.M[i], s.M[i % s.n * s.n + i / s.n]);
	for (int i = 0, first = !s.factored; i < l->count && s.rights; i++) {
		if (l->listed[i].matrix != matrix || l->listed[i].level != level)
			continue;
		if (first)
			set_entries(l, l->listed[i].atom, matrix);
		first = false;
		set_right(l, &l->listed[i], &s);
	}
	l->systems += s.rights > 0;
	return s;
}

static void take_solutions(struct listing *l, const struct tape_system *s, int level)
{
	for (int i = 0; i < l->count; i++) {
		const struct listed *own = &l->listed[i];
		if (own->matrix != s->matrix || own->level != level)
			continue;
		tape_ref *x = ARRAY(tape_ref, s->n);
		for (int k = 0; k < s->n; k++)
			x[k] = tape_operand(l->f->tape, TAPE_TABLE, k * s->rights + own->right,
					    l->solver->table + s->number);
		add_solution(l->f, own->atom, x);
	}
}

/* What is set of one level is one run, which may be loops. */
void tape_solve_by_lists(struct tape_forms *f, int count, const struct form *const *form,
			 const struct tape_solver *solver)
{
	SCRATCH int *level = ARRAY(int, f->room + 1);
	struct listing l = { .f = f, .solver = solver, .level = level };
	int levels = 1;
	for (int i = 0, own; i < count; i++) {
		own = level_of_form(&l, form[i]);
		levels = own > levels ? own : levels;
	}
	SCRATCH struct tape_system *system = ARRAY(struct tape_system, l.matrices + 1);
	for (int at = 1; at < levels; at++) {
		for (int m = 0; m < l.matrices; m++)
			system[m] = set_system(&l, m, at);
		for (int m = 0; m < l.matrices; m++) {
			if (!system[m].rights)
				continue;
			tape_statement(f->tape, solver->solve(solver->context, &system[m]));
			take_solutions(&l, &system[m], at);
		}
	}
}

/* ---- forms ---- */

static tape_ref times_call(struct tape *t, tape_ref product, enum function function, tape_ref x)
{
	tape_ref value = tape_call(t, function, x);
	return product == TAPE_NONE ? value : tape_binary(t, TAPE_MUL, product, value);
}

tape_ref tape_forcing(struct tape *t, const struct basis *basis)
{
	const struct forcing *forcing = basis->forcing;
	tape_ref time = tape_operand(t, TAPE_TIME, 0, 0), product = tape_power_of_time(t, basis->power);
	if (mpq_sgn(forcing->a) != 0)
		product = times_call(t, product, FN_EXP, tape_binary(t, TAPE_MUL, tape_constant(t, forcing->a), time));
	if (!oscillates(forcing))
		return product;
	tape_ref angle = tape_binary(t, TAPE_MUL, tape_constant(t, forcing->w), time);
	if (mpq_sgn(forcing->p) != 0)
		angle = tape_binary(t, TAPE_ADD, angle, tape_constant(t, forcing->p));
	return times_call(t, product, basis->sine ? FN_SIN : FN_COS, angle);
}

/* A factor goes into a product that nothing else reads, so that both take one multiplication less. */
tape_ref tape_term(struct tape_forms *f, const struct form_term *term)
{
	struct tape *t = f->tape;
	const struct basis *basis = &term->basis;
	const struct atom *atom = basis->atom;
	bool plus = mpq_cmp_si(term->factor, 1, 1) == 0, minus = mpq_cmp_si(term->factor, -1, 1) == 0;
	make_room(f, atom ? atom->index + 1 : 0);       /* a let that nothing reads may have atoms of its own */
	if (basis->kind == BASIS_ONE)
		return tape_constant(t, term->factor);
	if (atom && atom->kind == ATOM_PRODUCT && f->uses[atom->index] <= 1 && !plus && !minus)
		return product_ref(f, atom, tape_constant(t, term->factor));
	tape_ref x = atom			? atom_ref(f, atom)
		     : basis->kind == BASIS_PI	? tape_pi(t)
						: f->reader.leaf(t, f->reader.context, basis);
	if (plus || minus)
		return plus ? x : tape_unary(t, TAPE_NEG, x);
	tape_ref factor = tape_constant(t, term->factor);
	return atom ? times(t, factor, x) : tape_times_each(t, factor, x);
}

tape_ref tape_form(struct tape_forms *f, const struct form *form)
{
	SCRATCH tape_ref *term = ARRAY(tape_ref, form->terms + 1);
	for (int i = 0; i < form->terms; i++)
		term[i] = tape_term(f, &form->term[i]);
	return tape_sum(f->tape, form->terms, term);
}

void tape_name_lets(struct tape_forms *f)
{
	for (int i = 0; i < f->lets; i++) {
		tape_ref ref = tape_form(f, f->let[i].form);
		if (!tape_is_operand(f->tape, ref))
			tape_name(f->tape, ref, f->let[i].name);
	}
}
