/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solutions of linear equations as atoms: x of M x = f, where M depends on the state. Highest derivatives that have
 * factors of the state are such; one atom is one component of x, and all components share M and f. */
#include "collect/collect.h"
#include "math/math.h"

static int rows_of(int operands)
{
	int rows = 1;
	while (rows * (rows + 1) < operands)
		rows++;
	return rows;
}

struct linear_system system_of(const struct atom *atom, const struct form *const *operand)
{
	const int n = rows_of(atom->operands);
	return (struct linear_system){ n, operand + n, operand, operand == atom->operand ? atom->written : NULL };
}

static bool all_constant(int count, const struct form *const *x)
{
	for (int i = 0; i < count; i++)
		if (!is_constant(x[i]))
			return false;
	return true;
}

bool is_constant_system(const struct atom *atom)
{
	return atom->kind == ATOM_SOLUTION &&
	       all_constant(atom->operands - rows_of(atom->operands), atom->operand + rows_of(atom->operands));
}

/* All components ask for that of the same matrix. */
static const mpq_t *inverse_of(const struct node *node, int n, const mpq_t *value)
{
	static struct last_inverse last;
	int column;
	if (!inverse_kept(&last, n, value, &column))
		error(node->start, NULL, "the mass matrix is singular here: highest derivatives are not determined");
	return last.inverse;
}

void round_long(mpq_ptr value)
{
	enum { BITS = 256 };
	REAL near = WITH_BITS(BITS);
	if (mpz_sizeinbase(mpq_numref(value), 2) + mpz_sizeinbase(mpq_denref(value), 2) <= 4 * BITS)
		return;
	mpfr_set_q(near, value, MPFR_RNDN);
	mpfr_get_q(value, near);
}

static struct form *rounded(struct collector *c, const struct form *x)
{
	RATIONAL value = ZERO;
	constant_value(c, x, value);
	round_long(value);
	return form_constant(value);
}

/* Of a constant M: its inverse times f */
static struct form *constant_solution(struct collector *c, const struct node *node, const struct linear_system *e,
				      int component)
{
	struct form *x = NEW(struct form);
	const int n = e->n;
	RATIONALS *value = rationals((size_t)(n * n));
	for (int i = 0; i < n * n; i++) {
		constant_value(c, e->M[i], value[i]);
		round_long(value[i]);
	}
	const mpq_t *inverse = inverse_of(node, n, value);
	for (int j = 0; j < n; j++)
		form_add_to(x, e->f[j], inverse[component * n + j]);
	return is_constant(x) ? rounded(c, x) : x;
}

/* Multipliers stay unknowns of their own, though M is constant: then a step projects onto their constraints. */
static bool has_multipliers(const struct collector *c, const struct linear_system *e)
{
	return e->written && e->written->highest[e->n - 1].index >= c->frame->coords;
}

struct form *kept_solution(struct collector *c, const struct node *node, const struct linear_system *e, int component)
{
	const int n = e->n, cells = n * n;
	SCRATCH const struct form **operand = ARRAY(const struct form *, cells + n);
	bool zero = true;
	for (int i = 0; i < n; i++)
		zero = zero && e->f[i]->terms == 0;
	if (zero)
		return NEW(struct form);
	if (all_constant(cells, e->M) && !has_multipliers(c, e))
		return constant_solution(c, node, e, component);
	if (n == 1 && !(e->written && e->written->slope))
		return kept_product(c, node, e->f[0], kept_reciprocal(c, node, e->M[0]));
	for (int i = 0; i < n; i++)
		operand[i] = e->f[i];
	for (int i = 0; i < cells; i++)
		operand[n + i] = e->M[i];
	return kept_component(c, node,
			      (struct atom){ .kind = ATOM_SOLUTION, .component = component, .written = e->written },
			      cells + n, operand);
}

bool same_solution(const struct atom *a, const struct atom *b)
{
	bool same = a->operands == b->operands;
	if (a->operand == b->operand)
		return true;
	for (int i = 0; i < a->operands && same; i++)
		same = a->operand[i] == b->operand[i];
	return same;
}
