/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Invariant subspaces to any precision. From what double precision found, a basis X and a left one Y, Y^T X = 1, follow
 * from residuals in multiprecision,
 *
 *     T = Y^T A X,   R = A X - X T,   X <- X - sum over other eigenvectors i of v_i (w_i R) / (lambda_i - theta)
 *
 * and so for Y: Newton's method with the derivative of the start, which gains about as many bits a time as double
 * precision found.
 */
#include "math/invariant.h"

#include <math.h>

enum {
	MOST_CORRECTIONS = 60,
	GUARD_BITS = 64,            /* of the work, beyond what is asked for */
	SNAP_BITS = 24              /* so many bits above what is asked for a number is nothing beside its column */
};

struct correcting {
	const struct invariants *of;
	const struct invariant *part;
	int k;                      /* columns */
	mpfr_t *X, *Y, *R, *S;      /* n x k: bases, A X, A^T Y, then residuals */
	mpfr_t *T, *G;              /* k x k */
	mpfr_t x;
};

static void prepare_cells(struct invariants *of, int precision)
{
	if (of->precision >= precision)
		return;
	clear_reals(&of->value);
	of->value = reals((size_t)of->cells, precision);
	of->precision = precision;
	for (int c = 0; c < of->cells; c++)
		mpfr_set_q(of->value[c], of->A[of->cell[c].row * of->n + of->cell[c].column], MPFR_RNDN);
}

/* R = A X, or A^T X */
static void apply(const struct correcting *w, bool transposed, mpfr_t *X, mpfr_t *R)
{
	const struct invariants *of = w->of;
	for (int i = 0; i < of->n * w->k; i++)
		mpfr_set_zero(R[i], 1);
	for (int c = 0; c < of->cells; c++) {
		const int row = transposed ? of->cell[c].column : of->cell[c].row;
		const int column = transposed ? of->cell[c].row : of->cell[c].column;
		for (int a = 0; a < w->k; a++)
			if (!mpfr_zero_p(X[column * w->k + a]))
				mpfr_fma(R[row * w->k + a], of->value[c], X[column * w->k + a], R[row * w->k + a],
					 MPFR_RNDN);
	}
}

/* G = Y^T X, k x k */
static void inner(const struct correcting *w, mpfr_t *Y, mpfr_t *X, mpfr_t *G)
{
	for (int a = 0; a < w->k; a++)
		for (int b = 0; b < w->k; b++) {
			mpfr_set_zero(G[a * w->k + b], 1);
			for (int i = 0; i < w->of->n; i++)
				mpfr_fma(G[a * w->k + b], Y[i * w->k + a], X[i * w->k + b], G[a * w->k + b], MPFR_RNDN);
		}
}

static void swap_rows(mpfr_t *G, int k, int a, int b)
{
	for (int j = 0; j < k && a != b; j++)
		mpfr_swap(G[a * k + j], G[b * k + j]);
}

/* G <- G^-1 by Gauss and Jordan, by way of T; false: singular */
static bool invert(const struct correcting *w)
{
	const int k = w->k;
	for (int i = 0; i < k * k; i++)
		mpfr_set_ui(w->T[i], i / k == i % k, MPFR_RNDN);
	for (int c = 0; c < k; c++) {
		int pivot = c;
		for (int r = c + 1; r < k; r++)
			if (mpfr_cmpabs(w->G[r * k + c], w->G[pivot * k + c]) > 0)
				pivot = r;
		if (mpfr_zero_p(w->G[pivot * k + c]))
			return false;
		swap_rows(w->G, k, c, pivot);
		swap_rows(w->T, k, c, pivot);
		mpfr_set(w->T[k * k], w->G[c * k + c], MPFR_RNDN);
		for (int j = 0; j < k; j++) {
			mpfr_div(w->G[c * k + j], w->G[c * k + j], w->T[k * k], MPFR_RNDN);
			mpfr_div(w->T[c * k + j], w->T[c * k + j], w->T[k * k], MPFR_RNDN);
		}
		for (int r = 0; r < k; r++) {
			if (r == c)
				continue;
			mpfr_neg(w->T[k * k], w->G[r * k + c], MPFR_RNDN);
			for (int j = 0; j < k; j++) {
				mpfr_fma(w->G[r * k + j], w->T[k * k], w->G[c * k + j], w->G[r * k + j], MPFR_RNDN);
				mpfr_fma(w->T[r * k + j], w->T[k * k], w->T[c * k + j], w->T[r * k + j], MPFR_RNDN);
			}
		}
	}
	for (int i = 0; i < k * k; i++)
		mpfr_swap(w->G[i], w->T[i]);
	return true;
}

/* Y <- Y (Y^T X)^-T */
static bool make_dual(const struct correcting *w)
{
	const int k = w->k;
	inner(w, w->Y, w->X, w->G);
	if (!invert(w))
		return false;
	for (int i = 0; i < w->of->n; i++) {
		for (int a = 0; a < k; a++) {
			mpfr_set_zero(w->T[a], 1);
			for (int b = 0; b < k; b++)
				mpfr_fma(w->T[a], w->G[a * k + b], w->Y[i * k + b], w->T[a], MPFR_RNDN);
		}
		for (int a = 0; a < k; a++)
			mpfr_set(w->Y[i * k + a], w->T[a], MPFR_RNDN);
	}
	return true;
}

/* R - X T, or X T^T; its largest entry on the balanced matrix */
static double residual(const struct correcting *w, bool transposed, mpfr_t *X, mpfr_t *R, double *largest)
{
	const int k = w->k;
	double most = 0;
	*largest = 0;
	for (int i = 0; i < w->of->n; i++)
		for (int a = 0; a < k; a++) {
			const double scale = transposed ? w->of->scale[i] : 1 / w->of->scale[i];
			for (int b = 0; b < k; b++) {
				mpfr_srcptr factor = w->T[transposed ? a * k + b : b * k + a];
				mpfr_neg(w->G[0], factor, MPFR_RNDN);
				mpfr_fma(R[i * k + a], X[i * k + b], w->G[0], R[i * k + a], MPFR_RNDN);
			}
			const double left = fabs(mpfr_get_d(R[i * k + a], MPFR_RNDN)) * scale;
			const double size = fabs(mpfr_get_d(X[i * k + a], MPFR_RNDN)) * scale;
			most = left > most ? left : most;
			*largest = size > *largest ? size : *largest;
		}
	return most;
}

/* The eigenvalue that a column, or a pair of them, is corrected by */
static void middle(const struct correcting *w, int a, double *re, double *im)
{
	const int step = w->part->real ? 1 : 2, at = a * step, k = w->k;
	*re = mpfr_get_d(w->T[at * k + at], MPFR_RNDN);
	*im = step == 1 ? 0 : mpfr_get_d(w->T[at * k + at + 1], MPFR_RNDN);
}

/* What column a of the balanced residual has of eigenvector j, divided by the distance of its eigenvalue */
static void part_along(const struct correcting *w, bool transposed, int a, int j, const double *r_re,
		       const double *r_im, double *re, double *im)
{
	const struct invariants *of = w->of;
	const int n = of->n;
	double theta_re, theta_im, sum_re = 0, sum_im = 0;
	middle(w, a, &theta_re, &theta_im);
	for (int i = 0; i < n; i++) {
		const double v_re = transposed ? of->V_re[i * n + j] : of->W_re[j * n + i];
		const double v_im = transposed ? of->V_im[i * n + j] : of->W_im[j * n + i];
		sum_re += v_re * r_re[i] - v_im * r_im[i];
		sum_im += v_re * r_im[i] + v_im * r_re[i];
	}
	const double x = of->re[j] - theta_re, y = of->im[j] - theta_im, square = x * x + y * y;
	*re = (sum_re * x + sum_im * y) / square;
	*im = (sum_im * x - sum_re * y) / square;
}

static void add_double(const struct correcting *w, mpfr_ptr to, double value, int exponent)
{
	mpfr_set_d((mpfr_ptr)w->x, value, MPFR_RNDN);
	mpfr_mul_2si((mpfr_ptr)w->x, w->x, exponent, MPFR_RNDN);
	mpfr_sub(to, to, w->x, MPFR_RNDN);
}

/* X less what its residual R asks for; `exponent`: R is looked at times 2^-exponent, so that nothing underflows */
static void correct(const struct correcting *w, bool transposed, mpfr_t *X, mpfr_t *R, int exponent)
{
	const struct invariants *of = w->of;
	const int n = of->n, step = w->part->real ? 1 : 2, k = w->k;
	SCRATCH double *r = ARRAY(double, 4 * (size_t)n);
	double *r_im = r + n, *e = r + 2 * n, *e_im = r + 3 * n;
	const double sign = transposed ? -1 : 1;        /* y = y1 - i y2 */
	SCRATCH bool *own = ARRAY(bool, n);
	for (int a = 0; a < w->part->members; a++)
		own[of->member[w->part->first + a]] = true;
	for (int a = 0; a < w->part->members; a++) {
		for (int i = 0; i < n; i++) {
			const double scale = transposed ? of->scale[i] : 1 / of->scale[i];
			e[i] = e_im[i] = r_im[i] = 0;
			for (int b = 0; b < step; b++) {
				mpfr_mul_2si((mpfr_ptr)w->x, R[i * k + a * step + b], -exponent, MPFR_RNDN);
				(b ? r_im : r)[i] = scale * mpfr_get_d(w->x, MPFR_RNDN) * (b ? sign : 1);
			}
		}
		for (int j = 0; j < n; j++) {
			double re, im;
			if (own[j])
				continue;
			part_along(w, transposed, a, j, r, r_im, &re, &im);
			for (int i = 0; i < n; i++) {
				const double v_re = transposed ? of->W_re[j * n + i] : of->V_re[i * n + j];
				const double v_im = transposed ? of->W_im[j * n + i] : of->V_im[i * n + j];
				e[i] += v_re * re - v_im * im;
				e_im[i] += v_re * im + v_im * re;
			}
		}
		for (int i = 0; i < n; i++) {
			const double scale = transposed ? 1 / of->scale[i] : of->scale[i];
			add_double(w, X[i * k + a * step], scale * e[i], exponent);
			if (step == 2)
				add_double(w, X[i * k + a * step + 1], sign * scale * e_im[i], exponent);
		}
	}
}

/* false: it does not get better */
static bool refine(const struct correcting *w, int bits)
{
	const double wanted = ldexp(1, -bits);
	double before = HUGE_VAL;
	for (int round = 0; round < MOST_CORRECTIONS; round++) {
		double X_largest, Y_largest;
		if (!make_dual(w))
			return false;
		apply(w, false, w->X, w->R);
		apply(w, true, w->Y, w->S);
		inner(w, w->Y, w->R, w->T);
		const double right = residual(w, false, w->X, w->R, &X_largest) / (X_largest * w->of->size);
		const double left = residual(w, true, w->Y, w->S, &Y_largest) / (Y_largest * w->of->size);
		const double worst = right > left ? right : left;
		if (!(worst <= 1) || (round > 3 && worst > before / 2))
			return false;
		if (worst <= wanted)
			return true;
		before = worst;
		const int exponent = ilogb(worst);
		correct(w, false, w->X, w->R, exponent);
		correct(w, true, w->Y, w->S, exponent);
	}
	return false;
}

/* ---- scaled: what double precision chose does not show ---- */

/* The first of the largest of the leading entries of X's columns together */
static int largest_entry(const struct correcting *w)
{
	int at = 0;
	double most = 0;
	for (int i = 0; i < w->of->leading; i++) {
		const double re = mpfr_get_d(w->X[i * w->k], MPFR_RNDN);
		const double size = w->k == 1 ? fabs(re) : hypot(re, mpfr_get_d(w->X[i * w->k + 1], MPFR_RNDN));
		if (size > most * (1 + 1e-9)) {
			most = size;
			at = i;
		}
	}
	return at;
}

static void scale_one(const struct correcting *w)
{
	mpfr_set(w->G[0], w->X[largest_entry(w)], MPFR_RNDN);
	for (int i = 0; i < w->of->n; i++) {
		mpfr_div(w->X[i], w->X[i], w->G[0], MPFR_RNDN);
		mpfr_mul(w->Y[i], w->Y[i], w->G[0], MPFR_RNDN);
	}
}

/* row of two <- row [G_0, G_1; G_2, G_3] */
static void turn_row(const struct correcting *w, mpfr_t *row, int a, int b, int c, int d)
{
	mpfr_mul(w->S[0], row[0], w->G[a], MPFR_RNDN);
	mpfr_fma(w->S[0], row[1], w->G[b], w->S[0], MPFR_RNDN);
	mpfr_mul(w->S[1], row[0], w->G[c], MPFR_RNDN);
	mpfr_fma(w->S[1], row[1], w->G[d], w->S[1], MPFR_RNDN);
	mpfr_set(row[0], w->S[0], MPFR_RNDN);
	mpfr_set(row[1], w->S[1], MPFR_RNDN);
}

/* z = the eigenvector X g of p, g = (T_01, p - T_00), over its largest entry c: X becomes (Re z, Im z), T
 * [a, b; -b, a]. G = (Re g_0, Im g_0; Re g_1, Im g_1) / c, and Y^T <- G^-1 Y^T. */
static bool scale_pair(const struct correcting *w)
{
	mpfr_t *T = w->T, *G = w->G;
	REALS *R = reals(6, mpfr_get_prec(w->T[0]));
	const int at = largest_entry(w);
	mpfr_add(R[0], T[0], T[3], MPFR_RNDN);          /* a */
	mpfr_div_2ui(R[0], R[0], 1, MPFR_RNDN);
	mpfr_sub(R[1], T[0], R[0], MPFR_RNDN);          /* b^2 = - (T_00 - a)^2 - T_01 T_10 */
	mpfr_sqr(R[2], R[1], MPFR_RNDN);
	mpfr_fma(R[2], T[1], T[2], R[2], MPFR_RNDN);
	mpfr_neg(R[2], R[2], MPFR_RNDN);
	bool good = mpfr_sgn(R[2]) > 0 && !mpfr_zero_p(T[1]);
	mpfr_sqrt(R[2], R[2], MPFR_RNDN);
	mpfr_neg(R[1], R[1], MPFR_RNDN);                /* g = (T_01, R_1 + i b) */
	mpfr_mul(R[3], w->X[2 * at], T[1], MPFR_RNDN);  /* c */
	mpfr_fma(R[3], w->X[2 * at + 1], R[1], R[3], MPFR_RNDN);
	mpfr_mul(R[4], w->X[2 * at + 1], R[2], MPFR_RNDN);
	mpfr_sqr(R[5], R[3], MPFR_RNDN);
	mpfr_fma(R[5], R[4], R[4], R[5], MPFR_RNDN);
	mpfr_div(R[3], R[3], R[5], MPFR_RNDN);          /* 1/c = R_3 - i R_4 */
	mpfr_div(R[4], R[4], R[5], MPFR_RNDN);
	mpfr_mul(G[0], T[1], R[3], MPFR_RNDN);
	mpfr_mul(G[1], T[1], R[4], MPFR_RNDN);
	mpfr_neg(G[1], G[1], MPFR_RNDN);
	mpfr_mul(G[2], R[2], R[4], MPFR_RNDN);
	mpfr_fma(G[2], R[1], R[3], G[2], MPFR_RNDN);
	mpfr_mul(G[3], R[1], R[4], MPFR_RNDN);
	mpfr_fms(G[3], R[2], R[3], G[3], MPFR_RNDN);
	for (int i = 0; i < w->of->n; i++)
		turn_row(w, w->X + 2 * i, 0, 2, 1, 3);
	good = good && make_dual(w);            /* which works in T */
	mpfr_set(T[0], R[0], MPFR_RNDN);
	mpfr_set(T[3], R[0], MPFR_RNDN);
	mpfr_neg(T[2], R[2], MPFR_RNDN);
	mpfr_set(T[1], R[2], MPFR_RNDN);
	return good;
}

static bool scale_basis(const struct correcting *w)
{
	if (w->part->members > 1)
		return true;
	if (w->k == 2)
		return scale_pair(w);
	scale_one(w);
	return true;
}

/* To `bits` behind the largest of its column; what is less than the guard is 0, as it is in truth where symmetry
 * makes it so. */
static void round_all(const struct correcting *w, mpfr_t *X, bool dual, int bits, mpq_t *rounded)
{
	const int n = w->of->n, k = w->k;
	REAL most = WITH_BITS(mpfr_get_prec(X[0])), largest = WITH_BITS(mpfr_get_prec(X[0]));
	for (int a = 0; a < k; a++) {
		mpfr_set_zero(largest, 1);
		for (int i = 0; i < n; i++) {
			mpfr_mul_d(most, X[i * k + a], dual ? w->of->scale[i] : 1 / w->of->scale[i], MPFR_RNDN);
			if (mpfr_cmpabs(most, largest) > 0)
				mpfr_abs(largest, most, MPFR_RNDN);
		}
		mpfr_div_2ui(largest, largest, (unsigned long)(bits - SNAP_BITS), MPFR_RNDN);
		for (int i = 0; i < n; i++) {
			mpfr_mul_d(most, X[i * k + a], dual ? w->of->scale[i] : 1 / w->of->scale[i], MPFR_RNDN);
			mpfr_prec_round(X[i * k + a], bits, MPFR_RNDN);
			if (mpfr_cmpabs(most, largest) > 0)
				mpfr_get_q(rounded[dual ? a * n + i : i * k + a], X[i * k + a]);
		}
	}
}

static void round_block(const struct correcting *w, int bits, mpq_t *block)
{
	for (int i = 0; i < w->k * w->k; i++) {
		const bool some = fabs(mpfr_get_d(w->T[i], MPFR_RNDN)) > ldexp(w->of->size, SNAP_BITS - bits);
		mpfr_prec_round(w->T[i], bits, MPFR_RNDN);
		if (some)
			mpfr_get_q(block[i], w->T[i]);
	}
}

bool invariant_refine(struct invariants *of, int part, int bits, mpq_t *block, mpq_t *right, mpq_t *left)
{
	const int n = of->n, precision = bits + GUARD_BITS;
	struct correcting w = { .of = of, .part = &of->part[part], .k = of->part[part].columns };
	const size_t cells = (size_t)n * (size_t)w.k, square = (size_t)w.k * (size_t)w.k + 1;
	SCRATCH double *X = ARRAY(double, cells), *Y = ARRAY(double, cells);
	prepare_cells(of, precision);
	mpfr_init2(w.x, precision);
	mpfr_t **all[] = { &w.X, &w.Y, &w.R, &w.S, &w.T, &w.G };
	for (int i = 0; i < 6; i++)
		*all[i] = reals(i < 4 ? cells : square, precision);
	invariant_start(of, part, X, Y);
	for (size_t i = 0; i < cells; i++) {
		mpfr_set_d(w.X[i], X[i], MPFR_RNDN);
		mpfr_set_d(w.Y[i], Y[i], MPFR_RNDN);
	}
	const bool good = refine(&w, bits + GUARD_BITS / 4) && scale_basis(&w);
	if (good) {
		round_block(&w, bits, block);
		round_all(&w, w.X, false, bits, right);
		round_all(&w, w.Y, true, bits, left);
	}
	for (int i = 0; i < 6; i++)
		clear_reals(all[i]);
	mpfr_clear(w.x);
	return good;
}
