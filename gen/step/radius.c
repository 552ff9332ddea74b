/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far a Taylor series reaches from the start, for a reader: its coefficients at t = 0, inputs 0, in long double;
 * from how they fall an estimate of the radius of convergence; how many steps they serve. Nothing emitted reads it. */
#include "step/step.h"

#include <float.h>
#include <math.h>

enum { LOOKED_AT = 40, WINDOW = 7, WINDOWS = 3, ENVELOPES = 4 };

struct values {
	const struct step *step;
	const struct linear *system;
	const struct expansion *x;
	int segment;
	long double *load;          /* per column of the loads */
	long double **c;            /* per sequence */
};

/* ---- the coefficients ---- */

static long double column_at_start(const struct load *load, int column)
{
	bool turns = oscillates(load->wave);
	double phase = mpq_get_d(load->wave->p);
	if (column / (turns ? 2 : 1) > 0)               /* t^k */
		return 0;
	return turns ? column ? sinl(phase) : cosl(phase) : 1;
}

static long double sum_value(const struct values *v, const struct sequence *s, int k)
{
	const struct expansion *x = v->x;
	long double sum = 0;
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *t = &s->term[i];
		if (t->slot >= 0) {
			int at = (t->slot * v->system->segments + v->segment) * (x->order + 1) + k;
			sum += x->changing[at] * v->load[t->a];
			continue;
		}
		long double operand = 0;
		if (t->kind == TERM_TIME)
			operand = t->a == 0;
		else if (t->kind == TERM_PARAM)
			operand = mpq_get_d(v->step->model->held->nominal[t->a]);
		else if (t->kind == TERM_LOAD)
			operand = v->load[t->a];
		else if (t->kind == TERM_SEQUENCE)
			operand = v->c[t->a][k];
		else if (t->kind == TERM_PRODUCT)
			for (int j = 0; j <= k; j++)
				operand += v->c[t->a][j] * v->c[t->b][k - j];
		sum += t->factor[k] * operand;
	}
	return sum;
}

static long double function_at_start(const struct values *v, const struct sequence *s)
{
	long double a = v->c[s->a][0];
	switch (s->function) {
	case FN_SIN:   return sinl(a);
	case FN_COS:   return cosl(a);
	case FN_TAN:   return tanl(a);
	case FN_EXP:   return expl(a);
	case FN_LOG:   return logl(a);
	case FN_SINH:  return sinhl(a);
	case FN_COSH:  return coshl(a);
	case FN_TANH:  return tanhl(a);
	case FN_ASIN:  return asinl(a);
	case FN_ACOS:  return acosl(a);
	case FN_ATAN:  return atanl(a);
	case FN_ATAN2: return atan2l(a, v->c[s->b][0]);
	default:       return NAN;
	}
}

/* Linear in t, just after t = 0 */
static long double form_at_start(const struct values *v, const struct form *form)
{
	long double sum = 0, soon = 1e-9L * mpq_get_d(v->step->model->h);
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		long double factor = mpq_get_d(form->term[i].factor);
		sum += factor * (basis->kind == BASIS_PI ? acosl(-1) : basis->power > 0 ? soon : 1);
	}
	return sum;
}

static bool holds_at_start(const struct values *v, const struct sequence *s)
{
	if (s->choice == CHOICE_BY_SEQUENCE)
		return v->c[s->test][0] != 0;
	if (s->choice == CHOICE_BY_HOLD) {
		const struct divided *d = &v->x->expression[s->expression];
		return v->c[d->sequence][0] == (long double)mpq_get_d(d->at[s->breakpoint]);
	}
	if (s->choice == CHOICE_BY_STATE) {
		const struct divided *d = &v->x->expression[s->expression];
		return v->c[d->sequence][0] > (long double)mpq_get_d(d->at[s->breakpoint]);
	}
	long double a = form_at_start(v, s->left), b = form_at_start(v, s->right);
	switch (s->comparison) {
	case CMP_LT: return a < b;
	case CMP_LE: return a <= b;
	case CMP_GT: return a > b;
	case CMP_GE: return a >= b;
	case CMP_EQ: return a == b;
	default:     return a != b;
	}
}

static long double recurrence(const struct values *v, const struct sequence *s, int sequence, int k)
{
	const long double *a = s->a == NONE ? NULL : v->c[s->a], *b = s->b == NONE ? NULL : v->c[s->b];
	const long double *c = v->c[sequence];
	long double sum = 0;
	switch (s->kind) {
	case SEQUENCE_SUM:
		return sum_value(v, s, k);
	case SEQUENCE_INTEGRAL:
		if (k > 0)
			return sum_value(v, s, k - 1);
		return s->state != NONE ? mpq_get_d(v->step->model->initial[s->state]) : function_at_start(v, s);
	case SEQUENCE_QUOTIENT:
		for (int j = 0; j < k; j++)
			sum += c[j] * b[k - j];
		return ((a ? a[k] : k == 0) - sum) / b[0];
	case SEQUENCE_ROOT:
		for (int j = 1; j < k; j++)
			sum += c[j] * c[k - j];
		return k ? (a[k] - sum) / (2 * c[0]) : sqrtl(a[0]);
	case SEQUENCE_POWER:
		for (int j = 0; j < k; j++)
			sum += ((long double)s->exponent * (k - j) - j) * a[k - j] * c[j];
		return k ? sum / (k * a[0]) : powl(a[0], s->exponent);
	case SEQUENCE_RATE:
		return (k + 1) * a[k + 1];
	default:
		return holds_at_start(v, s) ? a[k] : b[k];
	}
}

static struct values evaluate(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	struct values v = { .step = step, .system = system, .x = expansion_of(step, LOOKED_AT) };
	const struct expansion *x = v.x;
	v.load = ARRAY(long double, (size_t)load_columns(system));
	v.c = ARRAY(long double *, (size_t)x->count);
	for (int i = 0; i < x->count; i++)
		v.c[i] = ARRAY(long double, (size_t)x->order + 2);
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int j = 0; j < system->load[l].columns; j++)
			v.load[column++] = column_at_start(&system->load[l], j);
	while (v.segment < system->segments - 1 && mpq_sgn(system->change[v.segment]) <= 0)
		v.segment++;
	for (int k = 0; k <= x->order; k++)
		for (int i = 0; i < x->count; i++) {
			const struct sequence *s = &x->sequence[i];
			int own = k - s->late;
			if (own >= 0 && own <= s->top && own <= s->degree)
				v.c[i][own] = recurrence(&v, s, i, own);
		}
	return v;
}

/* ---- how they fall ---- */

/* |c_k| fall as k^-p R^-k. Of each of three windows the largest of |c_k| r^k, r what the last pass found for R, so that
 * neither zeros nor the beat of a pair of singularities counts. False: one of them has nothing but zeros. */
static bool fit(const long double *c, long double *log_radius, long double *power)
{
	long double r = 0;
	for (int pass = 0; pass < ENVELOPES; pass++) {
		long double k[WINDOWS], y[WINDOWS];
		for (int w = 0; w < WINDOWS; w++) {
			int last = LOOKED_AT - (WINDOWS - 1 - w) * (LOOKED_AT - WINDOW) / WINDOWS;
			long double most = -LDBL_MAX;
			for (int j = last - WINDOW + 1; j <= last; j++) {
				long double size = fabsl(c[j]) > 0 ? logl(fabsl(c[j])) : -LDBL_MAX;
				if (!isfinite(c[j]))
					return false;
				if (size > -LDBL_MAX && size + j * r > most) {
					most = size + j * r;
					y[w] = size;
					k[w] = j;
				}
			}
			if (most == -LDBL_MAX)
				return false;
		}
		long double early = (y[0] - y[1]) / (k[1] - k[0]), late = (y[1] - y[2]) / (k[2] - k[1]);
		long double of_early = logl(k[1] / k[0]) / (k[1] - k[0]), of_late = logl(k[2] / k[1]) / (k[2] - k[1]);
		*power = (early - late) / (of_early - of_late);
		*log_radius = early - *power * of_early;
		r = late;
	}
	return true;
}

static double find_radius(const struct values *v)
{
	enum { ENTIRE = 5 };            /* k^5 R^-k is no singularity's, but of what falls nearly as 1/k! */
	double least = INFINITY, unit = v->step->model->truncation.over * mpq_get_d(v->step->model->h);
	for (int i = 0; i < v->system->states; i++) {
		long double radius, power;
		if (fit(v->c[i], &radius, &power) && power > -ENTIRE)
			least = fmin(least, (double)expl(radius) * unit);
	}
	return least;
}

/* The last two of the scheme's order, over the size of each state */
static double remainder_at(const struct values *v, int k, double steps)
{
	double worst = 0;
	for (int i = 0; i < v->system->states; i++) {
		const long double *c = v->c[i];
		long double size = fabsl(c[0]) > 0 ? fabsl(c[0]) : fmaxl(fabsl(c[1]), fabsl(c[2]));
		double part = (double)(fabsl(c[k]) / (size > 0 ? size : 1) * powl(steps, k));
		worst = part <= worst ? worst : part;
	}
	return worst;
}

static double find_served(const struct values *v)
{
	enum { MOST_HALVINGS = 60 };
	const struct truncation *truncation = &v->step->model->truncation;
	double tolerance = mpq_get_d(truncation->tolerance), served = ldexp(1, -MOST_HALVINGS);
	int order = v->step->expansion->order;
	for (double steps = served; steps <= EXPANSION_SERVES; steps = steps < 1 ? 2 * steps : steps + 1) {
		if (!(remainder_at(v, order, steps) <= tolerance && remainder_at(v, order - 1, steps) <= tolerance))
			break;
		served = steps;
	}
	return served;
}

struct reach reach_of_series(const struct step *step)
{
	struct values v = evaluate(step);
	struct reach reach = { .known = true, .radius = find_radius(&v) };
	for (int i = 0; i < v.system->states; i++)
		for (int k = 0; k <= v.x->order; k++)
			reach.known = reach.known && isfinite(v.c[i][k]);
	if (step->model->truncation.adaptive && reach.known)
		reach.served = v.system->inputs ? fmin(find_served(&v), 1) : find_served(&v);
	return reach;
}
