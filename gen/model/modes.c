/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The modes of a linear model and what each of them gives to the outputs. Where M^-1 C has the invariant subspaces of
 * M^-1 K, which it has if both commute (Caughey and O'Kelly 1965), modes are coordinates, m'' + c m' + lambda m =
 * force; else they are those of the state matrix. Sizes are sums of |residues| in double precision: to choose by and to
 * tell.
 */
#include "model/model.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { MODE_BITS = 128 };           /* of the numbers that a model of modes is made of */
#define UNSEEN 1e-13                /* of what it is a sum of: less is rounding */
#define PERHAPS_RIGID 1e-9          /* of the largest pole's square: whether it is 0 is found in more digits */

struct mode_basis {
	struct invariants *invariants; /* of A, or of M^-1 K */
	bool moves;                 /* of M^-1 K */
	mpq_t *A;                   /* the matrix that it is of */
	mpq_t *D;                   /* M^-1 C, where modes are coordinates */
	mpq_t *inverse;             /* W^-1 */
};

/* ---- what stands against it ---- */

static const char *objection_of_outputs(const struct model *model)
{
	if (!model->declared_outputs)
		return "there is no output, and what a mode contributes is seen in outputs";
	for (int i = 0; i < model->outputs; i++)
		if (!model->output[i].form)
			return format("output %s is not linear", model->output[i].name);
	return NULL;
}

static const char *objection(const struct model *model)
{
	if (model->switching)
		return "the equations are piecewise linear, and each region has modes of its own";
	if (model->obstacle || model->operators)
		return "the equations are not linear, and modes are of linear ones";
	if (model->scheme != SCHEME_EXACT)
		return "that needs scheme exact";
	if (model->tuning)
		return "there are tunable params, and modes follow from them";
	if (model->written != model)
		return "--reduce has taken other states: what no output sees is left out with modes, too";
	return objection_of_outputs(model);
}

/* ---- which matrix ---- */

static bool is_symmetric(int n, const mpq_t *A)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < i; j++)
			if (!mpq_equal(A[i * n + j], A[j * n + i]))
				return false;
	return true;
}

static bool all_of_second_order(const struct linear *system)
{
	for (int i = 0; i < system->n; i++)
		if (system->velocity[i] < 0)
			return false;
	return true;
}

static bool is_zero(size_t count, const mpq_t *A)
{
	for (size_t i = 0; i < count; i++)
		if (mpq_sgn(A[i]) != 0)
			return false;
	return true;
}

static bool commute(int n, const mpq_t *A, const mpq_t *B)
{
	const size_t cells = (size_t)n * (size_t)n;
	mpq_t *AB = rationals(cells), *BA = rationals(cells);
	rational_product(n, n, n, A, B, AB);
	rational_product(n, n, n, B, A, BA);
	bool same = true;
	for (size_t i = 0; i < cells && same; i++)
		same = mpq_equal(AB[i], BA[i]);
	rationals_free(AB, cells);
	rationals_free(BA, cells);
	return same;
}

static bool all_real(const struct invariants *of)
{
	for (int p = 0; p < invariants_count(of); p++)
		if (!invariant_part(of, p)->real)
			return false;
	return true;
}

/* false: coordinates do not have modes of their own */
static bool take_coordinates(struct mode_basis *basis, const struct linear *system)
{
	const int n = system->n;
	const size_t cells = (size_t)n * (size_t)n;
	if (!all_of_second_order(system))
		return false;
	basis->A = rationals(cells);
	basis->D = rationals(cells);
	rational_product(n, n, n, (const mpq_t *)basis->inverse, (const mpq_t *)system->K, basis->A);
	rational_product(n, n, n, (const mpq_t *)basis->inverse, (const mpq_t *)system->C, basis->D);
	if (!is_zero(cells, (const mpq_t *)basis->D) &&
	    !commute(n, (const mpq_t *)basis->A, (const mpq_t *)basis->D))
		return false;
	if (is_symmetric(n, (const mpq_t *)system->M) && is_symmetric(n, (const mpq_t *)system->K))
		basis->invariants = invariants_symmetric(n, (const mpq_t *)basis->A, (const mpq_t *)system->M,
							 (const mpq_t *)system->K);
	if (!basis->invariants)
		basis->invariants = invariants_of(n, (const mpq_t *)basis->A, n);
	basis->moves = basis->invariants && all_real(basis->invariants);
	return basis->moves;
}

static struct mode_basis *basis_of(const struct linear *system)
{
	struct mode_basis *basis = NEW(struct mode_basis);
	int column;
	basis->inverse = rationals((size_t)system->n * (size_t)system->n);
	leading_inverse(system, basis->inverse, &column);
	if (take_coordinates(basis, system))
		return basis;
	basis->A = state_matrix(system, false);
	basis->invariants = invariants_of(system->states, (const mpq_t *)basis->A, system->n);
	return basis->invariants ? basis : NULL;
}

/* ---- a mode in double precision ---- */

struct picture {                    /* of one mode, to tell its size by */
	int k, columns;             /* states; coordinates, where modes are coordinates */
	bool moves;
	double *T;                  /* k x k */
	double *right, *left;       /* states x k, k x states */
	double *c;                  /* one output's row: k */
	bool hidden;                /* the output does not see it */
};

struct survey {                     /* of all modes */
	const struct model *model;
	struct mode_basis *basis;
	struct modes *modes;
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
static void lift(const struct survey *s, struct picture *p, const double *X, const double *Y)
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

static struct picture picture_of(const struct survey *s, const struct mode *mode)
{
	const int states = s->model->system.states, n = s->basis->moves ? s->model->n : states;
	struct picture p = { .k = mode->states, .columns = mode->columns, .moves = mode->moves };
	const size_t cells = (size_t)n * (size_t)p.columns, all = (size_t)states * (size_t)p.k;
	double *X = ARRAY(double, cells), *Y = ARRAY(double, cells);
	invariant_start(s->basis->invariants, mode->first, X, Y);
	p.right = ARRAY(double, all);
	p.left = ARRAY(double, all);
	p.c = ARRAY(double, (size_t)p.k);
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
	discard(X);
	discard(Y);
	return p;
}

static void picture_free(struct picture *p)
{
	discard(p->right);
	discard(p->left);
	discard(p->c);
	discard(p->T);
}

/* ---- how large a mode's answer is ---- */

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
	for (int i = 0; i < c; i++)
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
static void drive(const struct survey *s, const struct picture *p, const mpq_t *force, double *b)
{
	const struct linear *system = &s->model->system;
	const int n = system->n;
	double *column = ARRAY(double, (size_t)n);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			if (mpq_sgn(force[j]) != 0)
				column[i] += s->inverse[i * n + j] * nearest_double(force[j]);
	for (int r = 0; r < p->k; r++) {
		double sum = 0, size = 0;
		for (int i = 0; i < n; i++) {
			const int state = system->velocity[i] >= 0 ? system->velocity[i] : i;
			sum += p->left[r * system->states + state] * column[i];
			size += fabs(p->left[r * system->states + state] * column[i]);
		}
		b[r] = fabs(sum) <= UNSEEN * size ? 0 : sum;
	}
	discard(column);
}

/* x of F x = b, n x n, both destroyed; false: singular, as far as double precision tells */
static bool solve(int n, double *F, double *b)
{
	for (int c = 0; c < n; c++) {
		int pivot = c;
		double most = 0;
		for (int i = 0; i < n; i++)
			for (int j = c; j < n; j++)
				most = fabs(F[i * n + j]) > most && i >= c ? fabs(F[i * n + j]) : most;
		for (int r = c + 1; r < n; r++)
			pivot = fabs(F[r * n + c]) > fabs(F[pivot * n + c]) ? r : pivot;
		if (!(fabs(F[pivot * n + c]) > 1e-14 * most))
			return false;
		for (int j = 0; j < n; j++) {
			const double swap = F[c * n + j];
			F[c * n + j] = F[pivot * n + j];
			F[pivot * n + j] = swap;
		}
		const double swap = b[c];
		b[c] = b[pivot];
		b[pivot] = swap;
		for (int r = 0; r < n; r++) {
			const double factor = r == c ? 0 : F[r * n + c] / F[c * n + c];
			for (int j = c; j < n && factor != 0; j++)
				F[r * n + j] -= factor * F[c * n + j];
			b[r] -= factor * b[c];
		}
	}
	for (int i = 0; i < n; i++)
		b[i] /= F[i * n + i];
	return true;
}

/* The forced part of a load, per column k states: of t^j e^{at} (cos, sin), from the highest power down,
 * (a - T) P_c + w P_s = B_c - (j+1) P_c', (a - T) P_s - w P_c = B_s - (j+1) P_s'. False: it has a pole of the mode. */
static bool forced(const struct picture *p, const struct load *load, const double *B, double *P)
{
	const int k = p->k, trig = oscillates(load->wave) ? 2 : 1, size = trig * k;
	const double a = nearest_double(load->wave->a), w = nearest_double(load->wave->w);
	double *F = ARRAY(double, (size_t)size * (size_t)size);
	bool good = true;
	for (int power = load->powers - 1; power >= 0 && good; power--) {
		double *x = P + power * size;
		for (int i = 0; i < size; i++)
			x[i] = B[power * size + i] - (power + 1 < load->powers ? (power + 1) * x[size + i] : 0);
		for (int r = 0; r < size; r++)
			for (int c = 0; c < size; c++)
				F[r * size + c] = r / k == c / k ? (r == c ? a : 0) - p->T[r % k * k + c % k]
						: r % k == c % k ? (r < c ? w : -w) : 0;
		good = solve(size, F, x);
	}
	discard(F);
	return good;
}

/* The values of a load's columns at a time */
static void load_at(const struct load *load, double t, double *q)
{
	const double e = exp(nearest_double(load->wave->a) * t);
	const double angle = nearest_double(load->wave->w) * t + nearest_double(load->wave->p);
	const int trig = oscillates(load->wave) ? 2 : 1;
	for (int c = 0; c < load->columns; c++)
		q[c] = pow(t, c / trig) * e * (trig == 1 ? 1 : c % 2 == 0 ? cos(angle) : sin(angle));
}

/* The largest |c P q| in a segment that ends at `end`; HUGE_VAL: no bound */
static double forced_peak(const struct picture *p, const struct load *load, const double *P, double end)
{
	const int k = p->k, trig = oscillates(load->wave) ? 2 : 1;
	const double a = nearest_double(load->wave->a);
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
static bool survey_loads(const struct survey *s, const struct picture *p, int segment, double at, double sign,
			 double *jump, double *sum)
{
	const struct linear *system = &s->model->system;
	const double end = segment + 1 < system->segments ? nearest_double(system->change[segment]) : HUGE_VAL;
	bool good = true;
	for (int l = 0; l < system->loads && good; l++) {
		const struct load *load = &system->load[l];
		const size_t cells = (size_t)load->columns * (size_t)p->k;
		double *B = ARRAY(double, cells), *P = ARRAY(double, cells), *q = ARRAY(double, (size_t)load->columns);
		bool any = false;
		for (int c = 0; c < load->columns; c++)
			drive(s, p, (const mpq_t *)load->force[c] + segment * system->n, B + c * p->k);
		for (size_t i = 0; i < cells; i++)
			any = any || B[i] != 0;
		good = !any || forced(p, load, B, P);
		load_at(load, at, q);
		for (int c = 0; c < load->columns && good && any; c++)
			for (int i = 0; i < p->k; i++)
				jump[i] += sign * P[c * p->k + i] * q[c];
		if (good && any && sum)
			*sum += forced_peak(p, load, P, end);
		discard(B);
		discard(P);
		discard(q);
	}
	return good;
}

/* Sizes in one output of what starts and loads give */
static void survey_output(const struct survey *s, const struct picture *p, const double *start, double *size,
			  double *transient)
{
	const struct linear *system = &s->model->system;
	double *jump = ARRAY(double, (size_t)p->k), most = 0;
	bool good = true;
	*transient = 0;
	for (int segment = 0; segment < system->segments && good; segment++) {
		const double at = segment ? nearest_double(system->change[segment - 1]) : 0;
		double sum = 0;
		for (int i = 0; i < p->k; i++)
			jump[i] = segment ? 0 : start[i];
		good = (!segment || survey_loads(s, p, segment - 1, at, 1, jump, NULL)) &&
		       survey_loads(s, p, segment, at, -1, jump, &sum);
		*transient += peak_of(p, jump);
		most = sum > most ? sum : most;
	}
	*size = good ? *transient + most : HUGE_VAL;
	*transient = good ? *transient : HUGE_VAL;
	discard(jump);
}

/* A step of an input: |c T^-1 B| that it comes to, and the way there; a jump of u' likewise */
static double survey_input(const struct survey *s, const struct picture *p, const struct input *input)
{
	const int k = p->k;
	double *B = ARRAY(double, (size_t)k), *F = ARRAY(double, (size_t)k * (size_t)k), sum = 0;
	bool any = false;
	for (int i = 0; i < k * k; i++)
		F[i] = -p->T[i];
	drive(s, p, (const mpq_t *)input->force[0], B);
	for (int i = 0; i < k; i++)
		any = any || B[i] != 0;
	if (any && !p->hidden)
		sum = solve(k, F, B) ? fabs(along(p, B)) + peak_of(p, B) : HUGE_VAL;
	drive(s, p, (const mpq_t *)input->force[1], B);
	sum += peak_of(p, B);
	discard(B);
	discard(F);
	return sum;
}

static void see_output(const struct survey *s, struct picture *p, int output)
{
	const int states = s->model->system.states;
	const mpq_t *row = (const mpq_t *)s->model->output[output].state;
	p->hidden = true;
	for (int j = 0; j < p->k; j++) {
		double sum = 0, size = 0;
		for (int i = 0; i < states; i++) {
			const double term = mpq_sgn(row[i]) ? nearest_double(row[i]) * p->right[i * p->k + j] : 0;
			sum += term;
			size += fabs(term);
		}
		p->c[j] = fabs(sum) <= UNSEEN * size ? 0 : sum;
		p->hidden = p->hidden && p->c[j] == 0;
	}
}

static void survey_mode(const struct survey *s, struct mode *mode)
{
	const struct model *model = s->model;
	const int states = model->system.states, inputs = model->system.inputs;
	struct picture p = picture_of(s, mode);
	double *start = ARRAY(double, (size_t)p.k);
	for (int r = 0; r < p.k; r++) {
		double size = 0;
		for (int i = 0; i < states; i++) {
			const double term = p.left[r * states + i] * nearest_double(model->initial[i]);
			start[r] += term;
			size += fabs(term);
		}
		start[r] = fabs(start[r]) <= UNSEEN * size ? 0 : start[r];
	}
	mode->size = ARRAY(double, (size_t)model->outputs + 1);
	mode->transient = ARRAY(double, (size_t)model->outputs + 1);
	mode->by_input = ARRAY(double, (size_t)(model->outputs * inputs) + 1);
	for (int o = 0; o < model->outputs; o++) {
		see_output(s, &p, o);
		if (!p.hidden)
			survey_output(s, &p, start, &mode->size[o], &mode->transient[o]);
		mode->seen = mode->seen || mode->size[o] > 0;
		for (int i = 0; i < inputs; i++) {
			mode->by_input[o * inputs + i] = survey_input(s, &p, &model->system.input[i]);
			mode->seen = mode->seen || mode->by_input[o * inputs + i] > 0;
		}
	}
	discard(start);
	picture_free(&p);
}

/* ---- shares ---- */

static double share_of(double part, double sum)
{
	return part == 0 ? 0 : isinf(part) ? HUGE_VAL : part / sum;
}

static void find_shares(struct modes *modes)
{
	const int outputs = modes->model->outputs, inputs = modes->model->system.inputs;
	for (int o = 0; o < outputs; o++)
		for (int e = 0; e <= inputs; e++) {
			double sum = 0;
			for (int i = 0; i < modes->count; i++) {
				const struct mode *mode = &modes->mode[i];
				const double part = e ? mode->by_input[o * inputs + e - 1] : mode->size[o];
				sum += isinf(part) ? 0 : part;
			}
			for (int i = 0; i < modes->count; i++) {
				struct mode *mode = &modes->mode[i];
				const double part = e ? mode->by_input[o * inputs + e - 1] : mode->size[o];
				const double share = share_of(part, sum);
				mode->share = share > mode->share ? share : mode->share;
			}
		}
}

int *modes_by_share(const struct modes *modes)
{
	int *order = ARRAY(int, (size_t)modes->count + 1);
	for (int i = 0; i < modes->count; i++) {
		int at = i;
		for (; at > 0; at--) {
			const struct mode *a = &modes->mode[order[at - 1]], *b = &modes->mode[i];
			const bool first = a->rigid && a->seen, second = b->rigid && b->seen;
			if (first > second || (first == second && a->share >= b->share))
				break;
			order[at] = order[at - 1];
		}
		order[at] = i;
	}
	return order;
}

/* ---- the whole ---- */

/* Poles of its largest size; the sum of all squared, where modes are coordinates */
static void describe(const struct survey *s, struct mode *mode)
{
	const struct invariant *part = invariant_part(s->basis->invariants, mode->first);
	mode->re = part->re;
	mode->im = part->im;
	if (!mode->moves)
		return;
	const struct picture p = picture_of(s, mode);
	const int c = p.columns, k = p.k;
	const double half = p.T[c * k + c] / 2, root = half * half - part->re;
	mode->re = root < 0 ? half : half + sqrt(root);
	mode->im = root < 0 ? sqrt(-root) : 0;
	discard(p.right);
	discard(p.left);
	discard(p.c);
	discard(p.T);
}

static double largest_eigenvalue(const struct mode_basis *basis)
{
	double largest = 0;
	for (int i = 0; i < invariants_count(basis->invariants); i++) {
		const struct invariant *part = invariant_part(basis->invariants, i);
		largest = fmax(largest, hypot(part->re, part->im));
	}
	return largest;
}

/* To the nearest of so many bits */
static void round_to_bits(mpq_ptr q, int bits)
{
	mpfr_t x;
	mpfr_init2(x, bits);
	mpfr_set_q(x, q, MPFR_RNDN);
	mpfr_get_q(q, x);
	mpfr_clear(x);
}

static void clear_small(int count, mpq_t *x, int stride)
{
	double largest = 0;
	for (int i = 0; i < count; i++)
		largest = fmax(largest, fabs(nearest_double(x[i * stride])));
	for (int i = 0; i < count; i++)
		if (fabs(nearest_double(x[i * stride])) <= 1e-30 * largest)
			mpq_set_ui(x[i * stride], 0, 1);
		else
			round_to_bits(x[i * stride], MODE_BITS);
}

/* Of two poles 0: 1 in the largest coordinate, in which the second state has no part */
static void make_unit(int states, int coords, mpq_t *left, mpq_t *right)
{
	mpq_t scale, part, product;
	int at = 0;
	mpq_inits(scale, part, product, NULL);
	for (int i = 1; i < coords; i++)
		if (fabs(nearest_double(right[2 * i])) > fabs(nearest_double(right[2 * at])) * (1 + 1e-9))
			at = i;
	mpq_set(scale, right[2 * at]);
	for (int i = 0; i < 2 * states && mpq_sgn(scale) != 0; i++) {
		mpq_div(right[i], right[i], scale);
		mpq_mul(left[i], left[i], scale);
	}
	mpq_set(part, right[2 * at + 1]);
	for (int i = 0; i < states && mpq_sgn(scale) != 0; i++) {
		mpq_mul(product, part, right[2 * i]);
		mpq_sub(right[2 * i + 1], right[2 * i + 1], product);
		mpq_mul(product, part, left[states + i]);
		mpq_add(left[i], left[i], product);
	}
	for (int i = 0; i < 2; i++) {
		clear_small(states, right + i, 2);
		clear_small(states, left + i * states, 1);
	}
	mpq_clears(scale, part, product, NULL);
}

/* Two poles 0 with one eigenvector: z becomes (z_i, row i of the block times z), i the larger row, whose derivatives
 * are exactly the second and 0. */
static void straighten(struct mode *mode, int states, int coords)
{
	mpq_t *S = rationals(4), *inverse = rationals(4), *left = rationals(2 * (size_t)states),
	      *right = rationals(2 * (size_t)states);
	const mpq_t *T = (const mpq_t *)mode->block;
	int column;
	const bool second = fabs(nearest_double(T[2])) + fabs(nearest_double(T[3])) >
			    fabs(nearest_double(T[0])) + fabs(nearest_double(T[1]));
	mpq_set_ui(S[second], 1, 1);
	mpq_set(S[2], T[2 * second]);
	mpq_set(S[3], T[2 * second + 1]);
	if (rational_inverse(2, (const mpq_t *)S, inverse, &column)) {
		rational_product(2, 2, states, (const mpq_t *)S, (const mpq_t *)mode->left, left);
		rational_product(states, 2, 2, (const mpq_t *)mode->right, (const mpq_t *)inverse, right);
		make_unit(states, coords, left, right);
		for (int i = 0; i < 2 * states; i++) {
			mpq_swap(mode->left[i], left[i]);
			mpq_swap(mode->right[i], right[i]);
		}
		for (int i = 0; i < 4; i++)
			mpq_set_ui(mode->block[i], i == 1, 1);
	}
	rationals_free(S, 4);
	rationals_free(inverse, 4);
	rationals_free(left, 2 * (size_t)states);
	rationals_free(right, 2 * (size_t)states);
}

/* T^2 = 0, as far as its digits tell, or of one state T = 0 */
static bool is_nilpotent(const struct mode *mode, double largest)
{
	const int k = mode->states;
	mpq_t *square = rationals((size_t)k * (size_t)k);
	double most = 0;
	rational_product(k, k, k, (const mpq_t *)mode->block, (const mpq_t *)mode->block, square);
	for (int i = 0; i < k * k; i++)
		most = fmax(most, fabs(nearest_double(square[i])));
	rationals_free(square, (size_t)k * (size_t)k);
	return most <= 1e-25 * largest * largest;
}

/* What may have a pole 0 is looked at in more digits. */
static bool find_rigid(struct modes *modes, int index)
{
	struct mode *mode = &modes->mode[index];
	if (!mode_refine(modes, index))
		return false;
	const int c = mode->moves ? mode->columns : mode->states, k = mode->states;
	bool zero = true;
	const double largest = largest_eigenvalue(modes->basis);
	for (int i = 0; i < c; i++)
		for (int j = 0; j < c && mode->moves; j++)
			zero = zero && mpq_sgn(mode->block[(c + i) * k + j]) == 0;
	if (!mode->moves)
		zero = is_nilpotent(mode, largest);
	mode->rigid = zero;
	if (zero && !mode->moves) {
		mode->re = 0;
		mode->weight = (mode->states + 1) / 2;
		if (mode->states == 2)
			straighten(mode, modes->model->system.states, modes->model->n);
	}
	return true;
}

static int by_frequency(const void *a, const void *b)
{
	const struct mode *p = a, *q = b;
	const double x = hypot(p->re, p->im), y = hypot(q->re, q->im);
	return x < y ? -1 : x > y ? 1 : p->first - q->first;
}

static void list_modes(const struct survey *s, struct modes *modes)
{
	modes->count = invariants_count(s->basis->invariants);
	modes->mode = ARRAY(struct mode, (size_t)modes->count + 1);
	for (int i = 0; i < modes->count; i++) {
		const struct invariant *part = invariant_part(s->basis->invariants, i);
		struct mode *mode = &modes->mode[i];
		*mode = (struct mode){ .first = i, .columns = part->columns, .moves = s->basis->moves };
		mode->states = part->columns * (mode->moves ? 2 : 1);
		mode->weight = mode->moves || part->real ? part->columns : part->columns / 2;
		describe(s, mode);
	}
	qsort(modes->mode, (size_t)modes->count, sizeof *modes->mode, by_frequency);
}

struct modes *modes_of(const struct model *model, const char **why)
{
	struct survey s = { .model = model };
	const size_t n = (size_t)model->n, states = (size_t)model->system.states;
	*why = objection(model);
	if (*why)
		return NULL;
	s.basis = basis_of(&model->system);
	*why = s.basis ? NULL : "its poles are not found in double precision";
	if (*why)
		return NULL;
	struct modes *modes = s.modes = NEW(struct modes);
	*modes = (struct modes){ .model = model, .basis = s.basis };
	s.A = doubles_of(s.basis->moves ? n * n : states * states, (const mpq_t *)s.basis->A);
	s.D = s.basis->moves ? doubles_of(n * n, (const mpq_t *)s.basis->D) : NULL;
	s.inverse = doubles_of(n * n, (const mpq_t *)s.basis->inverse);
	list_modes(&s, modes);
	const double largest = largest_eigenvalue(s.basis);
	for (int i = 0; i < modes->count; i++) {
		const struct invariant *part = invariant_part(s.basis->invariants, modes->mode[i].first);
		const double size = hypot(part->re, part->im) / largest;
		if (!*why && size * (s.basis->moves ? 1 : size) <= PERHAPS_RIGID && !find_rigid(modes, i))
			*why = "two poles are too close for double precision";
	}
	for (int i = 0, number = 1; i < modes->count; number += modes->mode[i++].weight)
		modes->mode[i].number = number;
	for (int i = 0; i < modes->count && !*why; i++)
		survey_mode(&s, &modes->mode[i]);
	find_shares(modes);
	discard(s.A);
	discard(s.inverse);
	return *why ? NULL : modes;
}

/* ---- in more digits ---- */

/* block, right and left of a mode of coordinates, from Theta, X and Y^T */
static void lift_exactly(const struct modes *modes, struct mode *mode, const mpq_t *theta, const mpq_t *X,
			 const mpq_t *Y)
{
	const int n = modes->model->n, c = mode->columns, k = mode->states, states = 2 * n;
	const int *velocity = modes->model->system.velocity;
	mpq_t *DX = rationals((size_t)n * (size_t)c), *damping = rationals((size_t)c * (size_t)c);
	rational_product(n, n, c, (const mpq_t *)modes->basis->D, X, DX);
	rational_product(c, n, c, Y, (const mpq_t *)DX, damping);
	for (int i = 0; i < c; i++) {
		mpq_set_ui(mode->block[i * k + c + i], 1, 1);
		for (int j = 0; j < c; j++) {
			mpq_neg(mode->block[(c + i) * k + j], theta[i * c + j]);
			mpq_neg(mode->block[(c + i) * k + c + j], damping[i * c + j]);
			round_to_bits(mode->block[(c + i) * k + c + j], MODE_BITS);
		}
		for (int j = 0; j < n; j++) {
			mpq_set(mode->right[j * k + i], X[j * c + i]);
			mpq_set(mode->right[velocity[j] * k + c + i], X[j * c + i]);
			mpq_set(mode->left[i * states + j], Y[i * n + j]);
			mpq_set(mode->left[(c + i) * states + velocity[j]], Y[i * n + j]);
		}
	}
	rationals_free(DX, (size_t)n * (size_t)c);
	rationals_free(damping, (size_t)c * (size_t)c);
}

bool mode_refine(struct modes *modes, int index)
{
	struct mode *mode = &modes->mode[index];
	struct mode_basis *basis = modes->basis;
	const int states = modes->model->system.states, n = basis->moves ? modes->model->n : states;
	const size_t k = (size_t)mode->states, c = (size_t)mode->columns, cells = (size_t)n * c;
	if (mode->block)
		return true;
	mpq_t *theta = rationals(c * c), *X = rationals(cells), *Y = rationals(cells);
	if (!invariant_refine(basis->invariants, mode->first, MODE_BITS, theta, X, Y))
		return false;
	if (!mode->moves) {
		mode->block = theta;
		mode->right = X;
		mode->left = Y;
		return true;
	}
	mode->block = rationals(k * k);
	mode->right = rationals(k * (size_t)states);
	mode->left = rationals(k * (size_t)states);
	lift_exactly(modes, mode, (const mpq_t *)theta, (const mpq_t *)X, (const mpq_t *)Y);
	rationals_free(theta, c * c);
	rationals_free(X, cells);
	rationals_free(Y, cells);
	return true;
}
