/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of a tape, at any precision. */
#include "tape/tape.h"

/* Of numbers one of which is not defined there is no order: what is chosen by it is not defined either. */
static void compare_mpfr(enum tape_op op, mpfr_srcptr a, mpfr_srcptr b, mpfr_ptr value)
{
	if (mpfr_nan_p(a) || mpfr_nan_p(b)) {
		mpfr_set_nan(value);
		return;
	}
	int order = mpfr_cmp(a, b);
	bool holds = op == TAPE_LESS	  ? order < 0
		     : op == TAPE_AT_MOST ? order <= 0
		     : op == TAPE_EQUAL	  ? order == 0
					  : order != 0;
	mpfr_set_ui(value, holds, MPFR_RNDN);
}

static void judge_mpfr(enum tape_op op, mpfr_srcptr a, mpfr_ptr value)
{
	if (mpfr_nan_p(a))
		mpfr_set_nan(value);
	else
		mpfr_set_si(value, op == TAPE_SIGN ? mpfr_sgn(a) : mpfr_zero_p(a) != 0, MPFR_RNDN);
}

static void choose_mpfr(const struct tape_node *n, mpfr_t *value, mpfr_ptr result)
{
	if (mpfr_nan_p(value[n->a]))
		mpfr_set_nan(result);
	else
		mpfr_set(result, value[mpfr_zero_p(value[n->a]) ? n->c : n->b], MPFR_RNDN);
}

void tape_node_mpfr(const struct tape_node *n, const struct tape_values *from, mpfr_t *value, mpfr_ptr result)
{
	mpfr_srcptr a = n->a == TAPE_NONE ? NULL : value[n->a], b = n->b == TAPE_NONE ? NULL : value[n->b];
	switch (n->op) {
	case TAPE_CONSTANT: mpfr_set_q(result, n->value, MPFR_RNDN); return;
	case TAPE_TRUE:
	case TAPE_FALSE:    mpfr_set_ui(result, n->op == TAPE_TRUE, MPFR_RNDN); return;
	case TAPE_NEG:      mpfr_neg(result, a, MPFR_RNDN); return;
	case TAPE_SIGN:
	case TAPE_NOT:      judge_mpfr(n->op, a, result); return;
	case TAPE_SIZE:     mpfr_abs(result, a, MPFR_RNDN); return;
	case TAPE_CALL:
		mpfr_set(result, a, MPFR_RNDN);
		wide_value((enum function)n->index, result);
		return;
	case TAPE_ADD:      mpfr_add(result, a, b, MPFR_RNDN); return;
	case TAPE_MUL:      mpfr_mul(result, a, b, MPFR_RNDN); return;
	case TAPE_DIV:      mpfr_div(result, a, b, MPFR_RNDN); return;
	case TAPE_POWER:    mpfr_pow(result, a, b, MPFR_RNDN); return;
	case TAPE_ATAN2:    mpfr_atan2(result, a, b, MPFR_RNDN); return;
	case TAPE_LESS:
	case TAPE_AT_MOST:
	case TAPE_EQUAL:
	case TAPE_UNEQUAL:  compare_mpfr(n->op, a, b, result); return;
	case TAPE_SELECT:   choose_mpfr(n, value, result); return;
	case TAPE_ACCUMULATE:
		mpfr_add(result, b, value[n->c], MPFR_RNDN);
		mpfr_add(result, result, a, MPFR_RNDN);
		return;
	default:            from->operand(from->context, n, result);
	}
}

void tape_run_mpfr(const struct tape *t, const struct tape_values *from, mpfr_t *value)
{
	for (int i = 0; i < tape_length(t); i++)
		tape_node_mpfr(tape_node(t, i), from, value, value[i]);
}
