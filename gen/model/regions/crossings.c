/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether a scheme with a remainder goes from crossing to crossing: each comparison of the remainder is
 * of a switching function of the state with a breakpoint, or of times, the formulas on both sides have derivatives
 * there, and the tables of a part of a step, which the target makes, are no larger than those of tunable models. Else
 * it steps across, and is of the order that is left there. */
#include "model/capability.h"
#include "model/contacts/contacts.h"

struct following {
	bool *seen;                 /* per atom */
	bool compares;              /* something is chosen by the state */
	bool lost;                  /* something is not treated */
};

static void follow_form(struct following *f, const struct form *form);

static void compare(struct following *f, const struct form *a, const struct form *b)
{
	f->compares = f->compares || !is_linear_in_time(a) || !is_linear_in_time(b);
}

static void follow_comparison(struct following *f, const struct atom *a)
{
	bool timed = is_linear_in_time(a->operand[0]) && is_linear_in_time(a->operand[1]);
	compare(f, a->operand[0], a->operand[1]);
	f->lost = f->lost || (!timed && a->comparison >= CMP_EQ);
}

static void follow_choice(struct following *f, const struct atom *a)
{
	const struct form *condition = a->operand[0];
	const struct atom *test = condition->terms == 1 ? condition->term[0].basis.atom : NULL;
	bool plain = test && test->kind == ATOM_COMPARE && mpq_cmp_ui(condition->term[0].factor, 1, 1) == 0;
	f->lost = f->lost || (!plain && !is_stepwise(condition));
}

/* sqrt(x^2) has a kink, and no breakpoint is known of it. */
static bool is_root_of_even(const struct form *form)
{
	const struct atom *product = form->terms == 1 ? form->term[0].basis.atom : NULL;
	bool even = product && product->kind == ATOM_PRODUCT;
	for (int i = 0; even && i < product->operands; i++)
		even = product->exponent[i] % 2 == 0;
	return even;
}

static void follow_call(struct following *f, const struct atom *a)
{
	struct straight *piece;
	switch (a->function) {
	case FN_ABS:
	case FN_SGN:
		compare(f, a->operand[0], a->operand[0]);
		break;
	case FN_MIN:
	case FN_MAX:
		f->lost = f->lost || a->operands > LIMIT_COMPARED;
		for (int i = 1; i < a->operands; i++)
			compare(f, a->operand[0], a->operand[i]);
		break;
	case FN_CLIP:
	case FN_DEADZONE:
		compare(f, a->operand[0], a->operand[1]);
		compare(f, a->operand[0], a->operand[2]);
		break;
	case FN_TABLE:
		f->lost = f->lost || pieces_of_atom(a, &piece) > LIMIT_STRAIGHTS;
		compare(f, a->operand[0], a->operand[0]);
		break;
	case FN_SQRT:
		f->lost = f->lost || is_root_of_even(a->operand[0]);
		break;
	case FN_FRICTION:
	case FN_SLIDE:
		f->lost = true;
		break;
	default:
		break;
	}
}

static void follow_atom(struct following *f, const struct atom *a)
{
	if (f->seen[a->index])
		return;
	f->seen[a->index] = true;
	if (a->kind == ATOM_COMPARE)
		follow_comparison(f, a);
	if (a->kind == ATOM_CHOOSE)
		follow_choice(f, a);
	if (a->kind == ATOM_CALL)
		follow_call(f, a);
	const struct written_system *written = a->written && a->written->slope ? a->written : NULL;
	for (int i = 0; i < (written ? written->rows : a->operands); i++)       /* operands have iterates */
		follow_form(f, written ? written->residual[i] : a->operand[i]);
}

static void follow_form(struct following *f, const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.atom)
			follow_atom(f, form->term[i].basis.atom);
}

/* What stands against parts of a step, made by the target */
static bool is_full(const struct model *model)
{
	const struct facts facts = facts_of_model(model);
	return objection_to(CAN_SPLIT, &facts, model).why != NULL;
}

bool follows_crossings(const struct model *model)
{
	if (is_full(model))
		return false;
	if (has_contacts(model))
		return true;
	if (!scheme_row(model->scheme)->event_split || model->remainder.smooth.kind == SMOOTH_ALL)
		return false;
	struct following f = { .seen = ARRAY(bool, (size_t)atoms_count(model->equations.atoms)) };
	for (int c = 0; c < model->remainder.force_columns; c++)
		follow_form(&f, model->schedule.operator[0].left[c]);
	return f.compares && !f.lost;
}
