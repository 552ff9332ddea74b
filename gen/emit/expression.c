/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms with atoms as C: what several places use is computed once, under the name of a let where it has one. */
#include "emit/emit.h"

#include <string.h>

/* ---- what is used how often ---- */

struct part {                       /* a sum of several terms inside atoms */
	const struct form *form;
	int uses;
	const char *name;           /* of the local that holds it, once declared */
	const char *let;
};
struct writer {
	const struct emitter *e;
	basis_writer *basis_text;
	int atoms;
	int *uses;                  /* per atom */
	const char **name, **let;   /* per atom: the local that holds it; the let that it is */
	int parts;
	struct part *part;
	int locals;                 /* declared so far */
	const char *when;           /* conditions on time alone hold as they do at this time; NULL: as at any other */
	bool by_intervals;          /* what the state chooses is as interval[] says */
};

static struct part *part_of(const struct writer *w, const struct form *form)
{
	for (int i = 0; i < w->parts; i++)
		if (w->part[i].form == form)
			return &w->part[i];
	return NULL;
}

static void count_form(struct writer *w, const struct form *form);

static void count_operand(struct writer *w, const struct form *form, unsigned times)
{
	if (form->terms == 1) {
		count_form(w, form);
		return;
	}
	struct part *known = part_of(w, form);
	if (known) {
		known->uses += (int)times;
		return;
	}
	ENLARGE(w->part, (size_t)w->parts + 1);
	w->part[w->parts++] = (struct part){ form, (int)times, NULL, NULL };
	count_form(w, form);
}

static void count_form(struct writer *w, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *atom = form->term[i].basis.atom;
		if (!atom || w->uses[atom->index]++ > 0)
			continue;
		for (int k = 0; k < atom->operands; k++)
			count_operand(w, atom->operand[k], atom->exponent ? atom->exponent[k] : 1);
	}
}

/* A let is what its value is in the equations for all time. */
static void name_lets(struct writer *w)
{
	for (const struct symbol *s = w->e->model->spec->first; s; s = s->next) {
		if (s->kind != SYMBOL_LET || !s->whole)
			continue;
		const struct form_term *only = s->whole->terms == 1 ? s->whole->term : NULL;
		if (only && only->basis.atom && mpq_cmp_ui(only->factor, 1, 1) == 0)
			w->let[only->basis.atom->index] = c_name(w->e->c, s, 0);
		for (int i = 0; i < w->parts && s->whole->terms > 1; i++)
			if (same_form(w->part[i].form, s->whole))
				w->part[i].let = c_name(w->e->c, s, 0);
	}
}

struct writer *writer_new(const struct emitter *e, basis_writer *basis_text, int count, const struct form *const *form)
{
	struct writer *w = NEW(struct writer);
	int atoms = atoms_count(e->model->atoms);
	*w = (struct writer){ .e = e, .basis_text = basis_text, .atoms = atoms };
	w->uses = ARRAY(int, (size_t)atoms);
	w->name = ARRAY(const char *, (size_t)atoms);
	w->let = ARRAY(const char *, (size_t)atoms);
	for (int i = 0; i < count; i++)
		count_form(w, form[i]);
	name_lets(w);
	return w;
}

void write_conditions_at(struct writer *w, const char *when)
{
	w->when = when;
}

void write_by_intervals(struct writer *w)
{
	w->by_intervals = true;
}

/* ---- text ---- */

static const char *atom_text(struct writer *w, const struct atom *a);

static const char *declare(struct writer *w, const char *let, const char *text)
{
	const char *name = let ? let : format("part%d", ++w->locals);
	say(w->e, "    const double %s = %s;\n", name, text);
	return name;
}

static const char *basis_in_c(struct writer *w, const struct basis *basis)
{
	return basis->kind == BASIS_ATOM ? atom_text(w, basis->atom) : w->basis_text(w->e, basis);
}

const char *write_form(struct writer *w, const struct form *form, int indent)
{
	const char **term = ARRAY(const char *, (size_t)form->terms + 1);
	for (int i = 0; i < form->terms; i++)
		term[i] = scaled(finite_number(w->e, form->term[i].factor), basis_in_c(w, &form->term[i].basis));
	return form->terms ? tree(form->terms, term, indent) : "0.0";
}

/* A name or a number, or a sum in brackets */
static const char *operand_text(struct writer *w, const struct form *form)
{
	enum { INDENT = 18 };
	const struct form_term *only = form->terms == 1 ? form->term : NULL;
	if (only && only->basis.kind > BASIS_PI && mpq_cmp_ui(only->factor, 1, 1) == 0)
		return basis_in_c(w, &only->basis);
	struct part *part = part_of(w, form);
	if (part && part->name)
		return part->name;
	const char *text = write_form(w, form, INDENT);
	if (part && (part->uses > 1 || part->let))
		return part->name = declare(w, part->let, text);
	bool number = only && only->basis.kind <= BASIS_PI && mpq_sgn(only->factor) > 0;
	return form->terms == 0 || number ? text : format("(%s)", text);
}

static bool is_word(const char *text)
{
	return text[strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789.[]")] == 0;
}

/* What a text needs more than once is a name. */
static const char *word_of(struct writer *w, const struct form *form)
{
	const char *text = operand_text(w, form);
	return is_word(text) ? text : declare(w, NULL, text);
}

static const char *argument_text(struct writer *w, const struct form *form)
{
	enum { LONG = 400 };                    /* compilers limit how deep brackets nest */
	const struct part *part = part_of(w, form);
	if (part && (part->name || part->uses > 1 || part->let))
		return operand_text(w, form);
	const char *text = write_form(w, form, 18);
	return strlen(text) > LONG ? declare(w, NULL, text) : text;
}

/* base^n with few multiplications; base is a name */
static const char *power_text(struct writer *w, const char *base, unsigned n)
{
	if (n == 1)
		return base;
	if (n <= 3)
		return n == 2 ? format("%s * %s", base, base) : format("%s * %s * %s", base, base, base);
	const char *half = declare(w, NULL, power_text(w, base, n / 2));
	return format(n % 2 ? "%s * %s * %s" : "%s * %s", half, half, base);
}

static const struct form *divisor_of(const struct form *form)
{
	const struct atom *atom = form->terms == 1 ? form->term[0].basis.atom : NULL;
	return atom && atom->kind == ATOM_RECIPROCAL ? atom->operand[0] : NULL;
}

/* Of 1/x: a product in brackets */
static const char *inverse_text(struct writer *w, const struct form *form)
{
	const struct atom *atom = form->terms == 1 ? form->term[0].basis.atom : NULL;
	const char *text = operand_text(w, form);
	bool product = atom && atom->kind == ATOM_PRODUCT && !is_word(text);
	return format(product ? "(1.0 / (%s))" : "(1.0 / %s)", text);
}

static const char *product_text(struct writer *w, const struct atom *a)
{
	const char *above = "", *below = "";
	for (int i = 0; i < a->operands; i++) {
		const struct form *operand = a->operand[i], *divisor = divisor_of(operand);
		const struct form *base = divisor && !w->name[operand->term[0].basis.index] ? divisor : operand;
		bool inverse = base == divisor, several = a->exponent[i] > 1;
		const char *power = several ? power_text(w, word_of(w, base), a->exponent[i]) : operand_text(w, base);
		if (inverse)
			below = format("%s / %s", below, is_word(power) ? power : format("(%s)", power));
		else
			above = format("%s%s%s", above, *above ? " * " : "", power);
	}
	return format("%s%s", *above ? above : "1.0", below);
}

/* ---- what interval[] says ---- */

static const char *condition_text(struct writer *w, const struct form *condition);

static bool is_decided_by_state(const struct writer *w, const struct form *left, const struct form *right)
{
	return w->by_intervals && !(is_linear_in_time(left) && is_linear_in_time(right));
}

static const struct atom *choice_in(const struct form *form)
{
	const struct atom *atom = form->terms == 1 ? form->term[0].basis.atom : NULL;
	bool plain = atom && atom->kind == ATOM_CHOOSE && mpq_cmp_ui(form->term[0].factor, 1, 1) == 0;
	return plain ? atom : NULL;
}

/* Is a - b above 0? Of what is itself chosen on the right, as the best so far of min and max, by that choice. */
static const char *above_text(struct writer *w, const struct form *a, const struct form *b)
{
	const struct expansion *x = w->e->step->divided;
	const struct atom *chosen = choice_in(b);
	struct division d;
	if (x && find_division(x, a, b, &d))
		return d.expression == NONE ? (d.above ? "1" : "0")
					    : format("interval[%d] %s %d", d.expression, d.above ? ">" : "<=",
						     upper_rank(x, d.expression, d.breakpoint));
	if (!chosen)
		internal_error(w->e->step, "a choice by the state that no expression stands for");
	const char *first = above_text(w, a, chosen->operand[1]), *second = above_text(w, a, chosen->operand[2]);
	return format("(%s ? %s : %s)", condition_text(w, chosen->operand[0]), first, second);
}

static const char *decided_text(struct writer *w, const struct form *left, enum comparison comparison,
				const struct form *right)
{
	const char *text = above_text(w, left, right);
	return comparison <= CMP_LE ? format("!(%s)", text) : text;
}

/* ---- functions with kinks ---- */

static const char *const comparison_sign[] = { "<", "<=", ">", ">=", "==", "!=" };

/* Whether the first of two arguments is below or above the other; on either side at once the function is the same */
static const char *side_text(struct writer *w, const struct form *left, enum comparison comparison,
			      const struct form *right, const char *x, const char *y)
{
	if (is_decided_by_state(w, left, right))
		return decided_text(w, left, comparison, right);
	return format("%s %s %s", x, comparison_sign[comparison], y);
}

/* min, max where their order is known: each with each other; word: their text */
static const char *best_text(struct writer *w, const struct atom *a, const char *const *word, int next, int champion)
{
	if (next == a->operands)
		return word[champion];
	const struct form *x = a->operand[next], *y = a->operand[champion];
	const char *other = best_text(w, a, word, next + 1, next), *same = best_text(w, a, word, next + 1, champion);
	return format("(%s ? %s : %s)",
		      side_text(w, x, a->function == FN_MIN ? CMP_LT : CMP_GT, y, word[next], word[champion]), other,
		      same);
}

/* (x < x1 ? y0 + slope*(x - x0) : ...): one piece between each two points, the end ones extended */
static const char *table_text(struct writer *w, const struct atom *a)
{
	const char *x = word_of(w, a->operand[0]), *text = "";
	struct straight *piece;
	int pieces = pieces_of_atom(a, &piece);
	for (const struct straight *p = piece; p < piece + pieces; p++) {
		const char *end = p->end ? shortest(finite_number(w->e, p->end)) : "";
		const char *condition = p->end ? format("%s ? ", side_text(w, a->operand[0], CMP_LT,
									    form_constant(p->end), x, end)) : "";
		text = format("%s%s%s%s + %s * (%s - %s)", text, *text ? " : " : "", condition,
			      shortest(finite_number(w->e, p->y)), shortest(finite_number(w->e, p->slope)), x,
			      shortest(finite_number(w->e, p->x)));
	}
	return format("(%s)", text);
}

/* Without libm, which a target may not have: comparisons */
static const char *extreme_text(struct writer *w, const struct atom *a)
{
	const char **word = ARRAY(const char *, (size_t)a->operands);
	for (int i = 0; w->by_intervals && i < a->operands; i++)
		word[i] = word_of(w, a->operand[i]);
	if (w->by_intervals)
		return best_text(w, a, word, 1, 0);
	const char *best = word_of(w, a->operand[0]), *text = best;
	for (int i = 1; i < a->operands; i++) {
		const char *x = word_of(w, a->operand[i]);
		text = format("(%s %s %s ? %s : %s)", x, a->function == FN_MIN ? "<" : ">", best, x, best);
		best = i + 1 < a->operands ? declare(w, NULL, text) : text;
	}
	return text;
}

/* Numbers and the time `when` */
const char *time_text(const struct emitter *e, const struct form *form, const char *when)
{
	const char **term = ARRAY(const char *, (size_t)form->terms + 1);
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		const char *operand = basis->kind == BASIS_PI				? "3.141592653589793"
				      : basis->kind == BASIS_WAVE && basis->power > 0 ? when
										      : NULL;
		term[i] = scaled(finite_number(e, form->term[i].factor), operand);
	}
	return form->terms ? tree(form->terms, term, 18) : "0.0";
}

static bool is_decided_in_time(const struct writer *w, const struct atom *a)
{
	bool timed = w->when != NULL;
	for (int i = 0; i < a->operands; i++)
		timed = timed && is_linear_in_time(a->operand[i]);
	return timed;
}

static const char *call_text(struct writer *w, const struct atom *a)
{
	const char *x, *low, *high, *below, *above;
	switch (a->function) {
	case FN_TABLE: return table_text(w, a);
	case FN_FRICTION:
	case FN_SLIDE:
		return format("%s(s, %d)", spell(w->e, "$n_grip"), felt_of(w->e->model->switching, a));
	case FN_MIN:
	case FN_MAX:   return extreme_text(w, a);
	case FN_ATAN2: return format("atan2(%s, %s)", argument_text(w, a->operand[0]), argument_text(w, a->operand[1]));
	case FN_ABS:
		x = word_of(w, a->operand[0]);
		return format("(%s ? -%s : %s)", side_text(w, a->operand[0], CMP_LT, form_number(0), x, "0.0"), x, x);
	case FN_SGN:
		if (is_decided_by_state(w, a->operand[0], form_number(0)))
			return format("(%s ? 1.0 : -1.0)", above_text(w, a->operand[0], form_number(0)));
		x = is_decided_in_time(w, a) ? declare(w, NULL, time_text(w->e, a->operand[0], w->when))
					     : word_of(w, a->operand[0]);
		return format("(double)((%s > 0.0) - (%s < 0.0))", x, x);
	case FN_CLIP:
	case FN_DEADZONE:
		x = word_of(w, a->operand[0]);
		low = word_of(w, a->operand[1]);
		high = word_of(w, a->operand[2]);
		below = side_text(w, a->operand[0], CMP_LT, a->operand[1], x, low);
		above = side_text(w, a->operand[0], CMP_GT, a->operand[2], x, high);
		if (a->function == FN_CLIP)
			return format("(%s ? %s : %s ? %s : %s)", below, low, above, high, x);
		return format("(%s ? %s - %s : %s ? %s - %s : 0.0)", below, x, low, above, x, high);
	default: return format("%s(%s)", function_name(a->function), argument_text(w, a->operand[0]));
	}
}

static const char *comparison_text(struct writer *w, const struct atom *a)
{
	if (is_decided_by_state(w, a->operand[0], a->operand[1]))
		return decided_text(w, a->operand[0], a->comparison, a->operand[1]);
	if (is_decided_in_time(w, a))
		return format("%s %s %s", time_text(w->e, a->operand[0], w->when), comparison_sign[a->comparison],
			      time_text(w->e, a->operand[1], w->when));
	const char *left = argument_text(w, a->operand[0]);
	return format("%s %s %s", left, comparison_sign[a->comparison], argument_text(w, a->operand[1]));
}

static const char *condition_text(struct writer *w, const struct form *condition)
{
	const struct form_term *only = condition->terms == 1 ? condition->term : NULL;
	const struct atom *atom = only && mpq_cmp_ui(only->factor, 1, 1) == 0 ? only->basis.atom : NULL;
	if (atom && atom->kind == ATOM_COMPARE)
		return comparison_text(w, atom);
	return format("%s != 0.0", operand_text(w, condition));
}

static const char *choice_text(struct writer *w, const struct atom *a)
{
	const char *text = condition_text(w, a->operand[0]), *first = argument_text(w, a->operand[1]);
	return format("(%s ? %s : %s)", text, first, argument_text(w, a->operand[2]));
}

static const char *expression_of(struct writer *w, const struct atom *a)
{
	const char *base;
	switch (a->kind) {
	case ATOM_PARAM:      return c_name(w->e->c, a->param, 0);
	case ATOM_PRODUCT:    return product_text(w, a);
	case ATOM_RECIPROCAL: return inverse_text(w, a->operand[0]);
	case ATOM_POWER:
		base = argument_text(w, a->operand[0]);
		return format("pow(%s, %s)", base, argument_text(w, a->operand[1]));
	case ATOM_CALL:       return call_text(w, a);
	case ATOM_COMPARE:    return format("(double)(%s)", comparison_text(w, a));
	default:              return choice_text(w, a);
	}
}

static const char *atom_text(struct writer *w, const struct atom *a)
{
	if (w->name[a->index])
		return w->name[a->index];
	const char *text = expression_of(w, a);
	bool plain = a->kind == ATOM_COMPARE || a->kind == ATOM_PARAM;
	bool shared = w->let[a->index] || (w->uses[a->index] > 1 && !plain);
	return shared ? (w->name[a->index] = declare(w, w->let[a->index], text)) : text;
}
