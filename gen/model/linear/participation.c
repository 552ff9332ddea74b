/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How large each mode's response is in each output, in double precision: sums of |residues|, to choose and report. */
#include "inner.h"

#include <complex.h>
#include <math.h>

#define UNOBSERVABLE 1e-13          /* of what it is a sum of: less is rounding */

struct picture {                    /* of one mode, to find its size by */
	int k, columns;             /* states; coordinates, where modes are coordinates */
	bool moves;
	double *T;                  /* k x k */
	double *right, *left;       /* states x k, k x states */
	double *c;                  /* one output's row: k */
	bool hidden;                /* the output does not see it */
};

struct participation {              /* of all modes */
	const struct model *model;
	const struct mode_basis *basis;
	double *A, *D;              /* of the basis */
	double *inverse;
};

static double *doubles_of(size_t count, const mpq_t *q)
{
	double *d = ARRAY(double, count + 1);
	for (size_t i = 0; i < count; i++)
		d[i] = nearest_double(q[i]);
	return d;
}

/* Y^T A X */
static double *projected(int n, int k, const double *Y, const double *A, const double *X)
{
	double *P = ARRAY(double, (size_t)k * (size_t)k);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			const double a = A[i * n + j];
			for (int r = 0; a != 0 && r < k; r++)
				for (int c = 0; c < k; c++)
					P[r * k + c] += Y[i * k + r] * a * X[j * k + c];
		}
	return P;
}

/* T, right and left of coordinates X and Y^T: m'' = -Theta m - C m' */
static void lift(const struct participation *s, struct picture *p, const double *X, const double *Y)
{
	const int n = s->model->n, c = p->columns, k = p->k, states = 2 * n;
	const int *velocity = s->model->system.velocity;
	double *theta = projected(n, c, Y, s->A, X), *damping = projected(n, c, Y, s->D, X);
	for (int i = 0; i < c; i++) {
		p->T[i * k + c + i] = 1;
		for (int j = 0; j < c; j++) {
			p->T[(c + i) * k + j] = -theta[i * c + j];
			p->T[(c + i) * k + c + j] = -damping[i * c + j];
		}
		for (int j = 0; j < n; j++) {
			p->right[j * k + i] = p->right[velocity[j] * k + c + i] = X[j * c + i];
			p->left[i * states + j] = p->left[(c + i) * states + velocity[j]] = Y[j * c + i];
		}
	}
}

static struct picture picture_of(const struct participation *s, const struct mode *mode)
{
	const int states = s->model->system.states, n = s->basis->moves ? s->model->n : states;
	struct picture p = { .k = mode->states, .columns = mode->columns, .moves = mode->moves };
	const size_t cells = (size_t)n * (size_t)p.columns, all = (size_t)states * (size_t)p.k;
	SCRATCH double *X = ARRAY(double, cells), *Y = ARRAY(double, cells);
	invariant_start(s->basis->invariants, mode->first, X, Y);
	p.right = ARRAY(double, all);
	p.left = ARRAY(double, all);
	p.c = ARRAY(double, p.k);
	p.T = ARRAY(double, (size_t)p.k * (size_t)p.k);
	if (mode->moves) {
		lift(s, &p, X, Y);
	} else {
		p.T = projected(n, p.k, Y, s->A, X);
		for (int i = 0; i < n; i++)
			for (int j = 0; j < p.k; j++) {
				p.right[i * p.k + j] = X[i * p.k + j];
				p.left[j * n + i] = Y[i * p.k + j];
			}
	}
	return p;
}

static void picture_free(struct picture *p)
{
	discard(p->right);
	discard(p->left);
	discard(p->c);
	discard(p->T);
}

/* ---- how large a mode's response is ---- */

/* The largest |c_0 z_0 + c_1 z_1| from z = w on, of the pair of states a and b of T; HUGE_VAL: it grows */
static double pair_peak(const struct picture *p, int a, int b, const double *w)
{
	const int k = p->k;
	const double taa = p->T[a * k + a], tab = p->T[a * k + b], tba = p->T[b * k + a], tbb = p->T[b * k + b];
	const double value = p->c[a] * w[a] + p->c[b] * w[b];
	const double slope = p->c[a] * (taa * w[a] + tab * w[b]) + p->c[b] * (tba * w[a] + tbb * w[b]);
	const double half = (taa + tbb) / 2, root = half * half - (taa * tbb - tab * tba);
	if ((w[a] == 0 && w[b] == 0) || (p->c[a] == 0 && p->c[b] == 0))
		return 0;
	if (root < 0)
		return half > 1e-12 * sqrt(-root) ? HUGE_VAL : hypot(value, (slope - half * value) / sqrt(-root));
	const double slow = half + sqrt(root);  /* real poles: value e^{slow t} and at most t e^{slow t} */
	if (!(slow < 0))
		return HUGE_VAL;
	return fabs(value) + fabs(slope - slow * value) / (-slow * exp(1));
}

/* Are its coordinates independent? */
static bool is_diagonal(const struct picture *p)
{
	const int c = p->columns, k = p->k;
	double most = 0, beside = 0;
	for (int i = 0; i < c && p->moves; i++)         /* then k is 2 c */
		for (int j = 0; j < k; j++) {
			const double size = fabs(p->T[(c + i) * k + j]);
			if (j % c == i)
				most = size > most ? size : most;
			else
				beside = size > beside ? size : beside;
		}
	return p->moves && beside <= 1e-9 * most;
}

static double peak_of(const struct picture *p, const double *w)
{
	double sum = 0;
	bool any = false;
	for (int i = 0; i < p->k; i++)
		any = any || (w[i] != 0 && isfinite(w[i]));
	for (int i = 0; i < p->k; i++)
		if (isnan(w[i]) || isinf(w[i]))
			return HUGE_VAL;
	if (!any || p->hidden)
		return 0;
	if (p->k == 1)
		return p->T[0] < 0 ? fabs(p->c[0] * w[0]) : p->c[0] * w[0] == 0 ? 0 : HUGE_VAL;
	if (p->k == 2)
		return pair_peak(p, 0, 1, w);
	if (!is_diagonal(p))
		return HUGE_VAL;
	for (int i = 0; i < p->columns; i++)
		sum += pair_peak(p, i, p->columns + i, w);
	return sum;
}

static double along(const struct picture *p, const double *w)
{
	double sum = 0;
	for (int i = 0; i < p->k; i++)
		sum += p->c[i] * w[i];
	return sum;
}

/* ---- loads ---- */

/* left W^-1 force: what drives z; what is nothing beside its terms is 0 */
static void drive(const struct participation *s, const struct picture *p, const mpq_t *force, double *b)
{
	const struct linear *system = &s->model->system;
	const int n = system->n;
	SCRATCH double *column = ARRAY(double, n);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			if (mpq_sgn(force[j]) != 0)
				column[i] += s->inverse[i * n + j] * nearest_double(force[j]);
	for (int r = 0; r < p->k; r++) {
		double sum = 0, size = 0;
		for (int i = 0; i < n; i++) {
			const int state = highest_state(system, i);
			sum += p->left[r * system->states + state] * column[i];
			size += fabs(p->left[r * system->states + state] * column[i]);
		}
		b[r] = fabs(sum) <= UNOBSERVABLE * size ? 0 : sum;
	}
}

/* The forced part of a load, per column k states: P = P_c + i P_s of t^j e^{at} (cos, sin), from the highest power
 * down, (a - i w - T) P = B - (j+1) P'. False: it has a pole of the mode. */
static bool forced(const struct picture *p, const struct load *load, const double *B, double *P)
{
	const int k = p->k, trig = oscillates(load->forcing) ? 2 : 1, size = trig * k;
	const double complex rate = nearest_double(load->forcing->a) - I * nearest_double(load->forcing->w);
	SCRATCH double complex *F = ARRAY(double complex, (size_t)k * (size_t)k), *x = ARRAY(double complex, k);
	bool good = true;
	for (int power = load->powers - 1; power >= 0 && good; power--) {
		for (int i = 0; i < k; i++) {
			const double *b = B + power * size + i;
			x[i] = b[0] + (trig == 2 ? I * b[k] : 0) - (power + 1) * x[i];
			for (int j = 0; j < k; j++)
				F[i * k + j] = (i == j ? rate : 0) - p->T[i * k + j];
		}
		good = solve_complex(k, F, x);
		for (int i = 0; i < size; i++)
			P[power * size + i] = i < k ? creal(x[i]) : cimag(x[i - k]);
	}
	return good;
}

/* The values of a load's columns at a time */
static void load_at(const struct load *load, double t, double *q)
{
	const double e = exp(nearest_double(load->forcing->a) * t);
	const double angle = nearest_double(load->forcing->w) * t + nearest_double(load->forcing->p);
	const int trig = oscillates(load->forcing) ? 2 : 1;
	for (int c = 0; c < load->columns; c++)
		q[c] = pow(t, c / trig) * e * (trig == 1 ? 1 : c % 2 == 0 ? cos(angle) : sin(angle));
}

/* The largest |c P q| in a segment that ends at `end`; HUGE_VAL: no bound */
static double forced_peak(const struct picture *p, const struct load *load, const double *P, double end)
{
	const int k = p->k, trig = oscillates(load->forcing) ? 2 : 1;
	const double a = nearest_double(load->forcing->a);
	double sum = 0;
	for (int power = 0; power < load->powers; power++) {
		const double *x = P + power * trig * k;
		const double amplitude = hypot(along(p, x), trig == 2 ? along(p, x + k) : 0);
		const bool grows = a > 0 || power > 0;
		if (amplitude != 0)
			sum += amplitude * (grows ? pow(end, power) * (a > 0 ? exp(a * end) : 1) : 1);
	}
	return sum;
}

struct course {                     /* of z through the segments of time, for one output */
	double *jump;               /* at the start of the segment: z less what is forced */
	double *P, *before;         /* of the loads, one after another */
	double forced, transient;
};

/* What the loads give in segment s: adds P q to the jump with `sign`, and what is forced to *sum */
static bool participation_of_loads(const struct participation *s, const struct picture *p, int segment, double at,
				   double sign,
			 double *jump, double *sum)
{
	const struct linear *system = &s->model->system;
	const double end = segment + 1 < system->segments ? nearest_double(system->change[segment]) : HUGE_VAL;
	bool good = true;
	for (int l = 0; l < system->loads && good; l++) {
		const struct load *load = &system->load[l];
		const size_t cells = (size_t)load->columns * (size_t)p->k;
		SCRATCH double *B = ARRAY(double, cells), *P = ARRAY(double, cells), *q = ARRAY(double, load->columns);
		bool any = false;
		for (int c = 0; c < load->columns; c++)
			drive(s, p, load->force[c] + segment * system->n, B + c * p->k);
		for (size_t i = 0; i < cells; i++)
			any = any || B[i] != 0;
		good = !any || forced(p, load, B, P);
		load_at(load, at, q);
		for (int c = 0; c < load->columns && good && any; c++)
			for (int i = 0; i < p->k; i++)
				jump[i] += sign * P[c * p->k + i] * q[c];
		if (good && any && sum)
			*sum += forced_peak(p, load, P, end);
	}
	return good;
}

/* Sizes in one output of what starts and loads give */
static void participation_of_output(const struct participation *s, const struct picture *p, const double *start,
				    double *size,
			  double *transient)
{
	const struct linear *system = &s->model->system;
	SCRATCH double *jump = ARRAY(double, p->k);
	double most = 0;
	bool good = true;
	*transient = 0;
	for (int segment = 0; segment < system->segments && good; segment++) {
		const double at = segment ? nearest_double(system->change[segment - 1]) : 0;
		double sum = 0;
		for (int i = 0; i < p->k; i++)
			jump[i] = segment ? 0 : start[i];
		good = (!segment || participation_of_loads(s, p, segment - 1, at, 1, jump, NULL)) &&
		       participation_of_loads(s, p, segment, at, -1, jump, &sum);
		*transient += peak_of(p, jump);
		most = sum > most ? sum : most;
	}
	*size = good ? *transient + most : HUGE_VAL;
	*transient = good ? *transient : HUGE_VAL;
}

/* A step of an input: |c T^-1 B| that it comes to, and the way there; a jump of u' likewise */
static double participation_of_input(const struct participation *s, const struct picture *p, const struct input *input)
{
	const int k = p->k;
	SCRATCH double *B = ARRAY(double, k);
	SCRATCH double complex *F = ARRAY(double complex, (size_t)k * (size_t)k), *x = ARRAY(double complex, k);
	double sum = 0;
	bool any = false;
	for (int i = 0; i < k * k; i++)
		F[i] = -p->T[i];
	drive(s, p, input->force[0], B);
	for (int i = 0; i < k; i++) {
		x[i] = B[i];
		any = any || B[i] != 0;
	}
	bool known = solve_complex(k, F, x);
	for (int i = 0; i < k; i++)
		B[i] = creal(x[i]);
	if (any && !p->hidden)
		sum = known ? fabs(along(p, B)) + peak_of(p, B) : HUGE_VAL;
	drive(s, p, input->force[1], B);
	sum += peak_of(p, B);
	return sum;
}

static void see_output(const struct participation *s, struct picture *p, int output)
{
	const int states = s->model->system.states;
	const mpq_t *row = s->model->output[output].state;
	p->hidden = true;
	for (int j = 0; j < p->k; j++) {
		double sum = 0, size = 0;
		for (int i = 0; i < states; i++) {
			const double term = mpq_sgn(row[i]) ? nearest_double(row[i]) * p->right[i * p->k + j] : 0;
			sum += term;
			size += fabs(term);
		}
		p->c[j] = fabs(sum) <= UNOBSERVABLE * size ? 0 : sum;
		p->hidden = p->hidden && p->c[j] == 0;
	}
}

void participation_of_mode(const struct participation *s, struct mode *mode)
{
	const struct model *model = s->model;
	const int states = model->system.states, inputs = model->system.inputs;
	struct picture p = picture_of(s, mode);
	SCRATCH double *start = ARRAY(double, p.k);
	for (int r = 0; r < p.k; r++) {
		double size = 0;
		for (int i = 0; i < states; i++) {
			const double term = p.left[r * states + i] * nearest_double(model->initial[i]);
			start[r] += term;
			size += fabs(term);
		}
		start[r] = fabs(start[r]) <= UNOBSERVABLE * size ? 0 : start[r];
	}
	mode->size = ARRAY(double, model->outputs + 1);
	mode->transient = ARRAY(double, model->outputs + 1);
	mode->by_input = ARRAY(double, (size_t)(model->outputs * inputs) + 1);
	for (int o = 0; o < model->outputs; o++) {
		see_output(s, &p, o);
		if (!p.hidden)
			participation_of_output(s, &p, start, &mode->size[o], &mode->transient[o]);
		mode->seen = mode->seen || mode->size[o] > 0;
		for (int i = 0; i < inputs; i++) {
			mode->by_input[o * inputs + i] = participation_of_input(s, &p, &model->system.input[i]);
			mode->seen = mode->seen || mode->by_input[o * inputs + i] > 0;
		}
	}
	picture_free(&p);
}

/* ---- the whole ---- */

/* Poles of its largest size; the sum of all squared, where modes are coordinates */
void participation_of_poles(const struct participation *s, struct mode *mode)
{
	const struct invariant *part = invariant_part(s->basis->invariants, mode->first);
	mode->re = part->re;
	mode->im = part->im;
	if (!mode->moves)
		return;
	struct picture p = picture_of(s, mode);
	const int c = p.columns, k = p.k;
	const double half = p.T[c * k + c] / 2, root = half * half - part->re;
	mode->re = root < 0 ? half : half + sqrt(root);
	mode->im = root < 0 ? sqrt(-root) : 0;
	picture_free(&p);
}

struct participation *participation_of(const struct modes *modes)
{
	const struct model *model = modes->model;
	const struct mode_basis *basis = modes->basis;
	const size_t n = (size_t)model->n, states = (size_t)model->system.states;
	struct participation *s = NEW(struct participation);
	*s = (struct participation){ .model = model, .basis = basis };
	s->A = doubles_of(basis->moves ? n * n : states * states, basis->A);
	s->D = basis->moves ? doubles_of(n * n, basis->D) : NULL;
	s->inverse = doubles_of(n * n, basis->inverse);
	return s;
}

void participation_free(struct participation *s)
{
	discard(s->A);
	discard(s->D);
	discard(s->inverse);
	discard(s);
}
