/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The matrices of the rotating beam by other roads: quadrature of the shape functions, closed forms of beams and bars,
 * and the published frequencies of a rotating cantilever.
 *
 *     beam COMMITTED DEFAULT SLENDER       (prefixes of files, see meson.build)
 */
#include "mtx_file.h"
#include "tap.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_sort_vector.h>
#include <math.h>
#include <string.h>

enum { MATRICES = 4, ALL = 6 };

static const char *const names[ALL] = { "M", "K", "G", "D", "fu", "fw" };
enum { M, K, G, D, FU, FW };

struct beam {
	const char *name;
	size_t elements;
	double L, S, I, rho, E;
	gsl_matrix *of[ALL];
};

static struct beam committed = { "default beam", 5, 8, 7.2968e-5, 8.2189e-9, 2.7667e3, 6.8952e10, { NULL } };
static struct beam slender = { "slender beam", 20, 1, 1, 0.00020408163265306123, 1, 4900, { NULL } };

static double get(const struct beam *b, int which, size_t i, size_t j)
{
	return gsl_matrix_get(b->of[which], i, j);
}

static void read_beam(struct beam *b, const char *prefix)
{
	for (int which = 0; which < ALL; which++)
		b->of[which] = mtx_file(prefix, names[which]);
}

/* ---- the files ---- */

static void sizes(const struct beam *b)
{
	const double n = 3 * (double)b->elements;
	bool good = true;
	for (int which = 0; which < ALL; which++) {
		good = close_to((double)b->of[which]->size1, n, 0, "rows of %s", names[which]) && good;
				good =
                    close_to((double)b->of[which]->size2, which < MATRICES ? n : 1, 0, "columns of %s", names[which]) &&
					good;
		}
	ok(good, "%s: sizes", b->name);
}

static void antisymmetric(const struct beam *b)
{
	bool good = true;
	for (size_t i = 0; i < 3 * b->elements; i++)
		for (size_t j = 0; j <= i; j++)
			good = close_to(get(b, G, i, j), -get(b, G, j, i), 0, "G[%zu][%zu]", i + 1, j + 1) && good;
	ok(good, "%s: G is antisymmetric", b->name);
}

/* A compiler that contracts products and sums may change the last digits. */
static void same_files(const char *prefix)
{
	for (int which = 0; which < ALL; which++) {
		gsl_matrix *now = mtx_file(prefix, names[which]);
		const gsl_matrix *then = committed.of[which];
		bool good = now->size1 == then->size1 && now->size2 == then->size2;
		for (size_t i = 0; good && i < then->size1; i++)
			for (size_t j = 0; j < then->size2; j++) {
				const double expected = gsl_matrix_get(now, i, j), found = gsl_matrix_get(then, i, j);
                                good = close_to(found, expected, 1e-13 * fabs(expected), "%s[%zu][%zu]", names[which],
												i + 1, j + 1) &&
									   good;
						}
		ok(good, "models/beam/%s.mtx is what beam_matrices writes", names[which]);
		gsl_matrix_free(now);
	}
}

/* ---- quadrature ---- */

/* What the six coordinates of an element contribute at one point: u, u', v, v', v''. */
struct shapes {
	double u[6], du[6], v[6], dv[6], ddv[6];
};

static struct shapes shapes(double l, double z)
{
	return (struct shapes){
		{ 1 - z, 0, 0, z, 0, 0 },
		{ -1 / l, 0, 0, 1 / l, 0, 0 },
        { 0, 1 - 3 * z * z + 2 * z * z * z, l * z * (1 - z) * (1 - z), 0, z * z * (3 - 2 * z), l * z * z * (z - 1) },
		{ 0, 6 * z * (z - 1) / l, (1 - z) * (1 - 3 * z), 0, 6 * z * (1 - z) / l, z * (3 * z - 2) },
		{ 0, (12 * z - 6) / (l * l), (6 * z - 4) / l, 0, (6 - 12 * z) / (l * l), (6 * z - 2) / l }
	};
}

/* The integrands of the energies, by pairs of coordinates; of the loads in the first column. */
static double integrand(const struct beam *b, int which, const struct shapes *s, double x, int i, int j)
{
	const double m = b->rho * b->S;
	switch (which) {
	case M:
		return m * (s->u[i] * s->u[j] + s->v[i] * s->v[j]);
	case K:
		return b->E * b->S * s->du[i] * s->du[j] + b->E * b->I * s->ddv[i] * s->ddv[j];
	case G:
		return m * (s->v[i] * s->u[j] - s->u[i] * s->v[j]);
	case D:     /* tension at x over w^2: m integral of x dx from x to L */
		return m / 2 * (b->L * b->L - x * x) * s->dv[i] * s->dv[j];
	case FU:
		return m * x * s->u[i];
	default:
		return m * x * s->v[i];
	}
}

static void add_point(const struct beam *b, int which, gsl_matrix *sum, size_t element, double z, double weight)
{
	const double l = b->L / (double)b->elements, x = l * ((double)element + z);
	const struct shapes s = shapes(l, z);
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < (which < MATRICES ? 6 : 1); j++) {
                    const int row = 3 * (int)element - 3 + i, column = which < MATRICES ? 3 * (int)element - 3 + j : 0;
					if (row >= 0 && column >= 0)
						*gsl_matrix_ptr(sum, (size_t)row, (size_t)column) += weight * l *
                                                                             integrand(b, which, &s, x, i, j);
				}
}

static void quadrature(const struct beam *b)
{
	enum { POINTS = 6 };            /* exact to degree 11; D has 6 */
	gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(POINTS);
	for (int which = 0; which < ALL; which++) {
		gsl_matrix *sum = gsl_matrix_calloc(b->of[which]->size1, b->of[which]->size2);
		for (size_t element = 0; element < b->elements; element++)
			for (size_t k = 0; k < POINTS; k++) {
				double z, weight;
				gsl_integration_glfixed_point(0, 1, k, &z, &weight, rule);
				add_point(b, which, sum, element, z, weight);
			}
		bool good = true;
		for (size_t i = 0; i < sum->size1; i++)
			for (size_t j = 0; j < sum->size2; j++) {
				/* Entries of unlike units: compare over the diagonal, or over the vector's largest. */
								const double expected = gsl_matrix_get(sum, i, j),
                                             scale = which == K || which == M
                                                         ? sqrt(gsl_matrix_get(sum, i, i) * gsl_matrix_get(sum, j, j))
                                                         : gsl_matrix_max(sum);
                                good = close_to(get(b, which, i, j), expected, 1e-14 * scale, "%s[%zu][%zu]",
                                                names[which], i + 1, j + 1) &&
									   good;
						}
		ok(good, "%s: %s by Gauss quadrature", b->name, names[which]);
		gsl_matrix_free(sum);
	}
	gsl_integration_glfixed_table_free(rule);
}

/* ---- statics: the stretch of a bar in the centrifugal field ---- */

/* K + w^2 (D - M), or K alone */
static gsl_matrix *effective_stiffness(const struct beam *b, double w)
{
	gsl_matrix *k = gsl_matrix_alloc(3 * b->elements, 3 * b->elements);
	for (size_t i = 0; i < k->size1; i++)
		for (size_t j = 0; j < k->size2; j++)
			gsl_matrix_set(k, i, j, get(b, K, i, j) + w * w * (get(b, D, i, j) - get(b, M, i, j)));
	return k;
}

/* Tip of k q = w^2 fu */
static double static_stretch(const struct beam *b, gsl_matrix *k, double w)
{
	const size_t n = k->size1;
	gsl_vector *q = gsl_vector_alloc(n);
	for (size_t i = 0; i < n; i++)
		gsl_vector_set(q, i, w * w * get(b, FU, i, 0));
	gsl_linalg_cholesky_decomp1(k);
	gsl_linalg_cholesky_svx(k, q);
	const double tip = gsl_vector_get(q, n - 3);
	gsl_vector_free(q);
	gsl_matrix_free(k);
	return tip;
}

/* E u'' + rho w^2 (x + u) = 0: u(L) = tan(b L)/b - L, b = w sqrt(rho/E).  Without the u in the field it is rho w^2
 * L^3/(3E), and linear elements are exact at their nodes. */
static void stretch(const struct beam *b, double w)
{
	const double simple = b->rho * w * w * b->L * b->L * b->L / (3 * b->E);
	const double beta = w * sqrt(b->rho / b->E), full = tan(beta * b->L) / beta - b->L;
	const double found = static_stretch(b, effective_stiffness(b, 0), w);
	const double with_field = static_stretch(b, effective_stiffness(b, w), w);
        ok(close_to(found, simple, 1e-12 * simple, "stretch"), "%s, w = %g: stretch rho w^2 L^3/(3E) = %.9g m", b->name,
		   w, simple);
        ok(close_to(with_field, full, 2e-6 * full, "stretch"), "%s, w = %g: with its own field, %.9g m", b->name, w,
		   full);
}

/* ---- frequencies ---- */

/* Of the beam at rest, ascending. */
static gsl_vector *frequencies(const struct beam *b)
{
	const size_t n = 3 * b->elements;
	gsl_vector *w = gsl_vector_alloc(n);
	gsl_matrix *k = gsl_matrix_alloc(n, n), *m = gsl_matrix_alloc(n, n);
	gsl_eigen_gensymm_workspace *workspace = gsl_eigen_gensymm_alloc(n);
	gsl_matrix_memcpy(k, b->of[K]);
	gsl_matrix_memcpy(m, b->of[M]);
	gsl_eigen_gensymm(k, m, w, workspace);
	for (size_t i = 0; i < n; i++)
		gsl_vector_set(w, i, sqrt(gsl_vector_get(w, i)));
	gsl_sort_vector(w);
	gsl_eigen_gensymm_free(workspace);
	gsl_matrix_free(k);
	gsl_matrix_free(m);
	return w;
}

static double nearest(const gsl_vector *w, double expected)
{
	double found = gsl_vector_get(w, 0);
	for (size_t i = 1; i < w->size; i++)
		if (fabs(gsl_vector_get(w, i) - expected) < fabs(found - expected))
			found = gsl_vector_get(w, i);
	return found;
}

/* Roots of cos x cosh x = -1; cubic elements come from above, with an error of about (x/n)^4/720. */
static void bending(const struct beam *b, const gsl_vector *w)
{
	static const double root[] = { 1.8751040687119611, 4.6940911329741746, 7.8547574382376126 };
	for (size_t k = 0; k < 3; k++) {
		const double L2 = b->L * b->L, expected = root[k] * root[k] / L2 * sqrt(b->E * b->I / (b->rho * b->S));
		const double error = pow(root[k] / (double)b->elements, 4) / 720, found = gsl_vector_get(w, k);
                ok(close_to(found, expected * (1 + error / 2), expected * (error / 2 + 1e-8), "frequency"),
                   "%s: bending frequency %zu, %.6g rad/s, at most %.1g too high", b->name, k + 1, expected, error);
		}
}

/* Of a bar of linear elements: w^2 = 6 E/(rho l^2) (1 - cos a)/(2 + cos a), a = (2k - 1) pi/(2n). */
static void axial(const struct beam *b, const gsl_vector *w)
{
	const double l = b->L / (double)b->elements;
	bool good = true;
	for (size_t k = 1; k <= b->elements; k++) {
		const double a = (2 * (double)k - 1) * M_PI / (2 * (double)b->elements);
		const double expected = sqrt(6 * b->E / (b->rho * l * l) * (1 - cos(a)) / (2 + cos(a)));
		good = close_to(nearest(w, expected), expected, 1e-10 * expected, "axial frequency %zu", k) && good;
	}
	ok(good, "%s: axial frequencies of linear elements in closed form", b->name);
}

static void largest(const gsl_vector *w)
{
	ok(close_to(gsl_vector_get(w, w->size - 1), 10423, 0.5, "largest frequency"),
		"default beam: largest frequency 10423 rad/s");
}

/* ---- rotation ---- */

/* The first frequency of M q'' + 2 w G q' + [K + w^2 (D - M)] q = 0: the least imaginary part among the eigenvalues of
 * s [1 0; 0 M] - [0 1; -K' -2wG]. */
static double rotating_frequency(const struct beam *b, double w)
{
	const size_t n = 3 * b->elements;
		gsl_matrix *k = effective_stiffness(b, w), *a = gsl_matrix_calloc(2 * n, 2 * n),
				   *c = gsl_matrix_calloc(2 * n, 2 * n);
		for (size_t i = 0; i < n; i++) {
		gsl_matrix_set(a, i, n + i, 1);
		gsl_matrix_set(c, i, i, 1);
		for (size_t j = 0; j < n; j++) {
			gsl_matrix_set(a, n + i, j, -gsl_matrix_get(k, i, j));
			gsl_matrix_set(a, n + i, n + j, -2 * w * get(b, G, i, j));
			gsl_matrix_set(c, n + i, n + j, get(b, M, i, j));
		}
	}
	gsl_vector_complex *alpha = gsl_vector_complex_alloc(2 * n);
	gsl_vector *beta = gsl_vector_alloc(2 * n);
	gsl_eigen_gen_workspace *workspace = gsl_eigen_gen_alloc(2 * n);
	gsl_eigen_gen(a, c, alpha, beta, workspace);
	double least = INFINITY;
	for (size_t i = 0; i < 2 * n; i++) {
		const double value = GSL_IMAG(gsl_vector_complex_get(alpha, i)) / gsl_vector_get(beta, i);
		least = fmin(least, fabs(value));
	}
	gsl_eigen_gen_free(workspace);
	gsl_vector_free(beta);
	gsl_vector_complex_free(alpha);
	gsl_matrix_free(k);
	gsl_matrix_free(a);
	gsl_matrix_free(c);
	return least;
}

/* In units of the slender beam, rho S L^4/(E I) = 1; figures published for rotating cantilevers of slenderness 70. */
static void chordwise(const struct beam *b)
{
	static const struct { double speed, frequency; } published[] = {
		{ 2, 3.6195 }, { 4, 3.8880 }, { 6, 4.2393 }, { 8, 4.6105 }, { 10, 4.9700 }
	};
	for (size_t i = 0; i < sizeof published / sizeof *published; i++) {
		const double found = rotating_frequency(b, published[i].speed);
                ok(close_to(found, published[i].frequency, 1e-3 * published[i].frequency, "frequency"),
                   "%s at speed %g: first chordwise frequency %.5f, published %.4f", b->name, published[i].speed, found,
				   published[i].frequency);
		}
}

static void judge(const struct beam *b)
{
	sizes(b);
	antisymmetric(b);
	quadrature(b);
	gsl_vector *w = frequencies(b);
	bending(b, w);
	axial(b, w);
	if (b == &committed)
		largest(w);
	gsl_vector_free(w);
}

int main(int argc, char **argv)
{
	if (argc != 4)
		return 99;
	read_beam(&committed, argv[1]);
	read_beam(&slender, argv[3]);
	judge(&committed);
	same_files(argv[2]);
	stretch(&committed, 4);
	stretch(&committed, 15);
	judge(&slender);
	chordwise(&slender);
	return tap_end();
}
