/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What coefficients at one time may not show: functions that are all but constant over most of their range, as tanh and
 * exp are, and what is divided by. Where they bend follows from their arguments, whose polynomials are at hand; so
 * these have a column each, and bound how far a series serves (emit/series/emit_reach.c). */
#include "inner.h"

#include <math.h>

/* ---- between which bounds a form stays, whatever the state ---- */

struct bounds { double low, high; };

static struct bounds bounds_of_form(const struct form *form);

static struct bounds times(struct bounds a, struct bounds b)
{
	const double corner[] = { a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high };
	struct bounds product = { corner[0], corner[0] };
	for (int i = 0; i < 4; i++) {
		product.low = fmin(product.low, corner[i]);
		product.high = fmax(product.high, corner[i]);
		if (isnan(corner[i]))
			return (struct bounds){ -INFINITY, INFINITY };
	}
	return product;
}

static struct bounds to_the_power(struct bounds base, unsigned n)
{
	struct bounds power = base;
	if (n % 2 == 0) {
		double most = fmax(fabs(base.low), fabs(base.high));
		double least = base.low > 0 ? base.low : base.high < 0 ? -base.high : 0;
		return (struct bounds){ pow(least, n), pow(most, n) };
	}
	for (; n > 1; n--)
		power = times(power, base);
	return power;
}

static struct bounds bounds_of_atom(const struct atom *atom)
{
	struct bounds product = { 1, 1 };
	if (atom->kind == ATOM_CALL)
		switch (atom->function) {
#define REAL_FUNCTION(NAME, name, argument, value, low, high) case FN_##NAME: return (struct bounds){ low, high };
#include "read/functions.def"
#undef REAL_FUNCTION
		case FN_ABS: return (struct bounds){ 0, INFINITY };
		default:     break;
		}
	if (atom->kind != ATOM_PRODUCT)
		return (struct bounds){ -INFINITY, INFINITY };
	for (int i = 0; i < atom->operands; i++)
		product = times(product, to_the_power(bounds_of_form(atom->operand[i]), atom->exponent[i]));
	return product;
}

static struct bounds bounds_of_form(const struct form *form)
{
	struct bounds sum = { 0, 0 };
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		double factor = mpq_get_d(form->term[i].factor);
		struct bounds of_basis = { -INFINITY, INFINITY };
		if (basis->kind == BASIS_ONE)
			of_basis = (struct bounds){ 1, 1 };
		else if (basis->kind == BASIS_ATOM)
			of_basis = bounds_of_atom(basis->atom);
		of_basis = times(of_basis, (struct bounds){ factor, factor });
		sum.low += of_basis.low;
		sum.high += of_basis.high;
	}
	return sum;
}

/* A divisor that never falls by more than this hides nothing. */
static bool stays_near(const struct form *form)
{
	enum { FACTOR = 16 };
	struct bounds b = bounds_of_form(form);
	return (b.low > 0 && b.high <= FACTOR * b.low) || (b.high < 0 && b.low >= FACTOR * b.high);
}

/* ---- what is there ---- */

struct finding {
	const struct model *model;
	bool *seen;                 /* per atom */
	int count;
	struct unresolved *unresolved;
	bool looks;
};

/* Of one that time or the state has, by its logarithm */
static bool divides(const struct form *exponent)
{
	return !is_constant(exponent) || (exponent->terms == 1 && mpq_sgn(exponent->term->factor) < 0);
}

static bool hides(const struct atom *atom, enum unresolved_kind *kind)
{
	switch (atom->kind) {
	case ATOM_RECIPROCAL: *kind = UNRESOLVED_DIVISOR; return true;
	case ATOM_POWER:      *kind = UNRESOLVED_DIVISOR; return divides(atom->operand[1]);
	case ATOM_CALL:       break;
	default:              return false;
	}
	switch (atom->function) {
	case FN_EXP:  *kind = UNRESOLVED_RISE; return true;
	case FN_SINH:
	case FN_COSH: *kind = UNRESOLVED_SPREAD; return true;
	case FN_TANH: *kind = UNRESOLVED_TURN; return true;
	case FN_ATAN: *kind = UNRESOLVED_ARC; return true;
	case FN_LOG:  *kind = UNRESOLVED_DIVISOR; return true;
	default:      return false;
	}
}

static void add_unresolved(struct finding *f, const struct form *form, enum unresolved_kind kind, int power)
{
	f->looks = f->looks || kind < UNRESOLVED_ARC;
	for (int i = 0; i < f->count; i++)
		if (f->unresolved[i].form == form && f->unresolved[i].kind == kind && f->unresolved[i].power >= power)
			return;
	*MORE(f->unresolved, f->count) = (struct unresolved){ .form = form, .kind = kind, .power = power };
}

/* Powers so high that terms of the first orders are nothing where their base is small */
static void find_in_product(struct finding *f, const struct atom *atom)
{
	enum { OF_FORCINGS = 4, HIGH = 8 };
	for (int i = 0; i < atom->operands; i++) {
		const struct form *base = atom->operand[i];
		const struct atom *of = base->terms == 1 ? base->term[0].basis.atom : NULL;
		bool forcing = of && of->kind == ATOM_CALL && (of->function == FN_SIN || of->function == FN_COS);
		if (forcing && atom->exponent[i] >= OF_FORCINGS)
			add_unresolved(f, of->operand[0], UNRESOLVED_TEETH, (int)atom->exponent[i]);
		f->looks = f->looks || (!forcing && atom->exponent[i] >= HIGH);
	}
}

static void find_in_atom(struct finding *f, const struct atom *atom)
{
	enum unresolved_kind kind;
	if (atom->kind == ATOM_PRODUCT)
		find_in_product(f, atom);
	if (hides(atom, &kind) && !(kind == UNRESOLVED_DIVISOR && stays_near(atom->operand[0])))
		add_unresolved(f, atom->operand[0], kind, 1);
	else if (atom->kind == ATOM_POWER || (atom->kind == ATOM_CALL && atom->function == FN_SQRT))
		f->looks = true;
}

/* Of iterates of Newton's method the first coefficients alone are read: what is solved for follows its residuals. */
static void find_in_form(struct finding *f, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *atom = form->term[i].basis.atom;
		if (!atom || f->seen[atom->index])
			continue;
		f->seen[atom->index] = true;
		if (!atom->highest && (atom->time || atom->state || atom->velocity || atom->input))
			find_in_atom(f, atom);
		const struct written_system *written = atom->written && atom->written->slope ? atom->written : NULL;
		for (int k = 0; k < (written ? written->rows : atom->operands); k++)
			find_in_form(f, written ? written->residual[k] : atom->operand[k]);
		for (int k = 0; written && k < written->rows; k++)
			find_in_form(f, written->found[k]);
	}
}

struct unresolved *unresolved_of(const struct model *model, int *count, bool *looks)
{
	struct finding f = { .model = model, .seen = ARRAY(bool, (size_t)atoms_count(model->equations.atoms)) };
	for (int e = 0; e < model->remainder.force_columns && model->truncation.adaptive; e++)
		find_in_form(&f, model->schedule.operator[0].left[e]);
	*count = f.count;
	*looks = f.looks;
	return f.unresolved;
}

/* Of several loads that may cancel the highest frequency; of one that grows its rate: what it is says nothing of what
 * it comes to. */
double crowded_frequency(const struct linear *system)
{
	enum { MANY = 3 };
	double highest = 0, growth = 0;
	int forcings = 0;
	for (int l = 0; l < system->loads; l++) {
		const struct forcing *forcing = system->load[l].forcing;
		growth = fmax(growth, forcing ? mpq_get_d(forcing->a) : 0);
		if (oscillates(forcing)) {
			highest = fmax(highest, mpq_get_d(forcing->w));
			forcings++;
		}
	}
	return fmax(growth, forcings >= MANY ? highest : 0);
}
