/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads, forms and equations for a reader: what would fill pages is cut short. */
#include "reads.h"

#include <string.h>

static const char *times_t(mpq_srcptr factor)
{
	if (mpq_cmp_ui(factor, 1, 1) == 0)
		return "t";
	return mpq_cmp_si(factor, -1, 1) == 0 ? "-t" : format("%s*t", readable_text(factor));
}

static const char *joined(const char *left, const char *right)
{
	return *left && *right ? format("%s*%s", left, right) : *left ? left : right;
}

const char *column_text(const struct load *load, int column)
{
	const struct forcing *forcing = load->forcing;
	bool turns = oscillates(forcing);
	int power = turns ? column / 2 : column;
	const char *text = power == 0 ? "" : power == 1 ? "t" : format("t^%d", power);
	if (mpq_sgn(forcing->a) != 0)
		text = joined(text, format("exp(%s)", times_t(forcing->a)));
	if (turns) {
		RATIONAL size = ZERO;
		mpq_abs(size, forcing->p);
		const char *phase = mpq_sgn(size) == 0
					    ? ""
					    : format(" %c %s", mpq_sgn(forcing->p) < 0 ? '-' : '+',
						     readable_text(size));
		text = joined(text, format("%s(%s%s)", column % 2 ? "sin" : "cos", times_t(forcing->w), phase));
	}
	return *text ? text : "1";
}

struct spelling {
	const struct model *model;
	int budget;                 /* atoms that may still be spelled out */
};

static const char *spell_form(struct spelling *s, const struct form *form);

/* The let that the atom is the value of */
static const char *let_of(const struct model *model, const struct atom *atom)
{
	for (const struct symbol *s = model->spec->first; s; s = s->next) {
		const struct form_term *only = s->kind == SYMBOL_LET && s->made.full && s->made.full->terms == 1
						       ? s->made.full->term
						       : NULL;
		if (only && only->basis.atom == atom && mpq_cmp_ui(only->factor, 1, 1) == 0)
			return s->name;
	}
	return NULL;
}

static const char *spell_operand(struct spelling *s, const struct form *form)
{
	const char *text = spell_form(s, form);
	const struct form_term *only = form->terms == 1 ? form->term : NULL;
	bool single = only && mpq_cmp_ui(only->factor, 1, 1) == 0 &&
		      !(only->basis.atom && only->basis.atom->kind == ATOM_COMPARE);
	return single ? text : format("(%s)", text);
}

static const char *spell_product(struct spelling *s, const struct atom *a)
{
	const char *text = "";
	for (int i = 0; i < a->operands; i++) {
		const struct atom *inner = a->operand[i]->terms == 1 ? a->operand[i]->term[0].basis.atom : NULL;
		if (*text && inner && inner->kind == ATOM_RECIPROCAL && a->exponent[i] == 1 &&
		    !let_of(s->model, inner)) {
			text = format("%s/%s", text, spell_operand(s, inner->operand[0]));
			continue;
		}
		const char *factor = spell_operand(s, a->operand[i]);
		bool product = strpbrk(factor, "*/") && factor[0] != '(' && a->exponent[i] > 1;
		factor = product ? format("(%s)", factor) : factor;
		text = format("%s%s%s", text, *text ? "*" : "",
			      a->exponent[i] > 1 ? format("%s^%u", factor, a->exponent[i]) : factor);
	}
	return text;
}

static const char *spell_call(struct spelling *s, const struct atom *a)
{
	const char *text = "";
	for (int i = 0; i < a->operands; i++)
		text = format("%s%s%s", text,
			      !i                                 ? ""
			      : a->function == FN_TABLE && i % 2 ? "; "
								 : ", ",
			      spell_form(s, a->operand[i]));
	return format("%s(%s)", function_name(a->function), text);
}

static const char *spell_atom(struct spelling *s, const struct atom *a)
{
	static const char *const sign[] = { "<", "<=", ">", ">=", "==", "!=" };
	const char *let = let_of(s->model, a), *first, *second;
	if (let)
		return let;
	if (s->budget-- <= 0)
		return "...";
	switch (a->kind) {
	case ATOM_PRODUCT:    return spell_product(s, a);
	case ATOM_RECIPROCAL: return format("1/%s", spell_operand(s, a->operand[0]));
	case ATOM_POWER:
		first = spell_operand(s, a->operand[0]);
		return format("%s^%s", first, spell_operand(s, a->operand[1]));
	case ATOM_CALL:       return spell_call(s, a);
	case ATOM_PARAM:      return a->param->name;
	case ATOM_SOLUTION:   return format("(M^-1 f)[%d]", a->component + 1);
	case ATOM_COMPARE:
		first = spell_form(s, a->operand[0]);
		return format("%s %s %s", first, sign[a->comparison], spell_form(s, a->operand[1]));
	default:
		first = spell_form(s, a->operand[0]);
		second = spell_form(s, a->operand[1]);
		return format("(%s ? %s : %s)", first, second, spell_form(s, a->operand[2]));
	}
}

static const char *basis_text(struct spelling *s, const struct basis *basis)
{
	const struct model *model = s->model;
	switch (basis->kind) {
	case BASIS_ATOM:  return spell_atom(s, basis->atom);
	case BASIS_ONE:   return "";
	case BASIS_PI:    return "pi";
	case BASIS_INPUT: return format("%s%s", model->system.input[basis->index].name, basis->order ? "'" : "");
	case BASIS_COORD:
		return format(strchr(model->names.coord[basis->index], ' ') ? "(%s)%.*s" : "%s%.*s",
			      model->names.coord[basis->index], basis->index < model->n ? basis->order : 0, "''");
	default:          break;
	}
	struct load load = { .forcing = basis->forcing };
	return column_text(&load, oscillates(basis->forcing) ? 2 * basis->power + basis->sine : basis->power);
}

static const char *add_term(struct spelling *s, const char *text, const struct form_term *term, bool negate)
{
	RATIONAL size = ZERO;
	mpq_abs(size, term->factor);
	bool minus = (mpq_sgn(term->factor) < 0) != negate;
	const char *what = basis_text(s, &term->basis);
	const char *factor = *what && mpq_cmp_ui(size, 1, 1) == 0 ? "" : readable_text(size);
	return format("%s%s%s%s%s", text,
		      *text   ? (minus ? " - " : " + ")
		      : minus ? "-"
			      : "",
		      factor, *factor && *what ? "*" : "", what);
}

/* It is 0 but where a frequency was changed: nobody wrote it. */
static bool is_lead(const struct model *model, const struct basis *basis)
{
	return basis->atom && basis->atom->kind == ATOM_PARAM &&
	       basis->atom->param->tuning.number > model->spec->tuned.count;
}

static const char *spell_form(struct spelling *s, const struct form *form)
{
	const char *text = "";
	for (int i = 0; i < form->terms; i++)
		if (!is_lead(s->model, &form->term[i].basis))
			text = add_term(s, text, &form->term[i], false);
	return *text ? text : "0";
}

const char *form_text(const struct model *model, const struct form *form)
{
	return spell_form(&(struct spelling){ model, 200 }, form);
}

/* Coordinates on the left, accelerations first; loads and inputs on the right. */
const char *equation_text(const struct model *model, const struct form *residual)
{
	struct spelling spelling = { model, 200 }, *s = &spelling;
	const char *left = "", *right = "";
	for (int order = 2; order >= 0; order--)
		for (int i = 0; i < residual->terms; i++)
			if (residual->term[i].basis.kind == BASIS_COORD && residual->term[i].basis.order == order)
				left = add_term(s, left, &residual->term[i], false);
	for (int i = 0; i < residual->terms; i++)
		if (residual->term[i].basis.kind != BASIS_COORD)
			right = add_term(s, right, &residual->term[i], true);
	return format("%s = %s", *left ? left : "0", *right ? right : "0");
}
