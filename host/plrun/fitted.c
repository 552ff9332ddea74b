/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The method of a fit, and what it has found. Gauss and Newton's method with Levenberg's damping is GSL's; it ends a
 * thousandth of a standard error from the least sum of squares, or at the rounding of the runs. With J the derivatives
 * of the residuals, by singular values of J with columns of length 1: s^2 (J^T J)^-1, s^2 = |residuals|^2/(samples -
 * values), is the covariance, and a singular value of 0 a direction that the records do not determine. */
#include "plrun.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ROUNDS = 100 };                     /* improvements */

/* ---- the method ---- */

struct attempt {                        /* what GSL is given: the unknowns that are not held */
	struct fit *f;
	const struct unknown *unknown;
	int unknowns;
	size_t samples;
	struct estimate *e;
	double *value;                          /* of all, those that are held included */
	const char *error;                      /* of the last run; NULL: it was one */
	double *known_at;                       /* where `e->at` is; NULL: nowhere */
};

static bool is_at(const struct attempt *a)
{
	return a->known_at && memcmp(a->known_at, a->value, sizeof *a->value * (size_t)a->unknowns) == 0;
}

/* A set of values without a run is far off. */
static void evaluate_at(struct attempt *a, const gsl_vector *x)
{
	enum { FAR = 100 };
	int free_one = 0;
	for (int i = 0; i < a->unknowns; i++)
		if (!a->e->held[i])
			a->value[i] = gsl_vector_get(x, (size_t)free_one++);
	if (is_at(a))
		return;
	a->error = fit_evaluate(a->f, a->value, &a->e->at, NULL, NULL);
	if (a->error)
		for (a->e->at.rows = 0; a->e->at.rows < a->samples; a->e->at.rows++)
			a->e->at.residual[a->e->at.rows] = pow(10, FAR);
	a->known_at = a->known_at ? a->known_at : need(calloc((size_t)a->unknowns, sizeof *a->known_at));
	memcpy(a->known_at, a->value, sizeof *a->value * (size_t)a->unknowns);
}

static int residual_at(const gsl_vector *x, void *params, gsl_vector *to)
{
	struct attempt *a = params;
	evaluate_at(a, x);
	for (size_t i = 0; i < a->samples; i++)
		gsl_vector_set(to, i, a->e->at.residual[i]);
	return GSL_SUCCESS;
}

static int jacobian_at(const gsl_vector *x, void *params, gsl_matrix *slope)
{
	struct attempt *a = params;
	int free_one = 0;
	evaluate_at(a, x);
	for (int i = 0; i < a->unknowns; i++) {
		for (size_t k = 0; k < a->samples && !a->e->held[i]; k++)
			gsl_matrix_set(slope, k, (size_t)free_one,
				       a->e->at.jacobian[k * (size_t)a->unknowns + (size_t)i]);
		free_one += !a->e->held[i];
	}
	return GSL_SUCCESS;
}

/* Columns of length 1, so that what depends on others by rounding alone is seen; those of length 0 stay */
static void make_even(gsl_matrix *slope)
{
	for (size_t i = 0; i < slope->size2; i++) {
		gsl_vector_view column = gsl_matrix_column(slope, i);
		const double length = gsl_blas_dnrm2(&column.vector);
		if (length > 0)
			gsl_vector_scale(&column.vector, 1 / length);
	}
}

/* The part of the residuals along their derivatives, by which one more step would lessen it: the length of that
 * step in standard errors */
static double steps_away(const gsl_multifit_nlinear_workspace *w)
{
	const gsl_matrix *slope = gsl_multifit_nlinear_jac(w);
	const size_t rows = slope->size1, columns = slope->size2;
	gsl_matrix *qr = gsl_matrix_alloc(rows, columns);
	gsl_vector *tau = gsl_vector_alloc(columns), *norm = gsl_vector_alloc(columns);
	gsl_vector *residual = gsl_vector_alloc(rows);
	gsl_permutation *order = gsl_permutation_alloc(columns);
	size_t rank = 0;
	int sign;
	gsl_matrix_memcpy(qr, slope);
	gsl_vector_memcpy(residual, gsl_multifit_nlinear_residual(w));
	const double all = gsl_blas_dnrm2(residual);
	make_even(qr);
	gsl_linalg_QRPT_decomp(qr, tau, order, &sign, norm);
	gsl_linalg_QR_QTvec(qr, tau, residual);
	while (rank < columns && fabs(gsl_matrix_get(qr, rank, rank)) > 1e-9)
		rank++;
	double squares = 0;
	for (size_t i = 0; i < rank; i++)
		squares += gsl_vector_get(residual, i) * gsl_vector_get(residual, i);
	gsl_matrix_free(qr);
	gsl_vector_free(tau);
	gsl_vector_free(residual);
	gsl_vector_free(norm);
	gsl_permutation_free(order);
	return all > 0 ? sqrt(squares * (double)(rows - columns)) / all : 0;
}

/* Until that is a thousandth, or values change by no more than 1e-9 of their size, or no smaller sum is found */
static void improve(struct attempt *a, gsl_multifit_nlinear_workspace *w)
{
	int found = steps_away(w) < 1e-3, status = GSL_SUCCESS;
	for (int round = 0; round < MOST_ROUNDS && status == GSL_SUCCESS && !found; round++) {
		status = gsl_multifit_nlinear_iterate(w);
		if (status == GSL_SUCCESS)
			gsl_multifit_nlinear_test(1e-9, 1e-300, 0, &found, w);
		found = found || steps_away(w) < 1e-3;
		if (status == GSL_SUCCESS && round == MOST_ROUNDS - 1)
			say_note(format("%d improvements have not brought it to an end", MOST_ROUNDS));
	}
	evaluate_at(a, gsl_multifit_nlinear_position(w));
}

static size_t count_free(const struct estimate *e)
{
	size_t count = 0;
	for (int i = 0; i < e->at.unknowns; i++)
		count += !e->held[i];
	return count;
}

/* From e->value on, to where it ends, within the ranges */
static void descend(struct attempt *a)
{
	struct estimate *e = a->e;
	const size_t count = count_free(e);
	gsl_multifit_nlinear_parameters how = gsl_multifit_nlinear_default_parameters();
	gsl_multifit_nlinear_fdf what = { .f = residual_at, .df = jacobian_at, .n = a->samples, .p = count,
					  .params = a };
	gsl_multifit_nlinear_workspace *w = gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, what.n, count);
	gsl_vector *x = gsl_vector_alloc(count);
	for (int i = 0, k = 0; i < a->unknowns; i++)
		if (!e->held[i])
			gsl_vector_set(x, (size_t)k++, e->value[i]);
	gsl_multifit_nlinear_init(x, &what, w);
	if (a->error)
		fail(WRONG_DATA, format("the run from which the fit starts has failed: %s", a->error));
	improve(a, w);
	for (int i = 0; i < a->unknowns; i++)
		e->value[i] = unknown_clamped(&a->unknown[i], a->value[i]);
	gsl_multifit_nlinear_free(w);
	gsl_vector_free(x);
}

/* At the values of `e`, ends of ranges included */
static void look(struct attempt *a)
{
	struct estimate *e = a->e;
	memcpy(a->value, e->value, sizeof *a->value * (size_t)a->unknowns);
	gsl_vector *none = gsl_vector_calloc(count_free(e) + 1);
	for (int i = 0, k = 0; i < a->unknowns; i++)
		if (!e->held[i])
			gsl_vector_set(none, (size_t)k++, e->value[i]);
	evaluate_at(a, none);
	gsl_vector_free(none);
	e->squares = 0;
	for (size_t k = 0; k < a->samples; k++)
		e->squares += e->at.residual[k] * e->at.residual[k];
}

/* Has something stopped at an end of its range from which the sum falls inwards? */
static bool turns_back(const struct attempt *a)
{
	const struct estimate *e = a->e;
	bool turns = false;
	for (int i = 0; i < a->unknowns; i++) {
		const struct unknown *u = &a->unknown[i];
		double slope = 0;
		for (size_t k = 0; k < e->at.rows; k++)
			slope += e->at.residual[k] * e->at.jacobian[k * (size_t)e->at.unknowns + (size_t)i];
		turns = turns || (!e->held[i] && ((e->value[i] <= u->low && slope < 0) ||
						  (e->value[i] >= u->high && slope > 0)));
	}
	return turns;
}

/* The best values of all that is not held, from e->value on */
static void solve(struct estimate *e)
{
	enum { MOST_RETURNS = 5 };
	struct attempt a = { .f = e->fit, .e = e, .samples = fit_samples(e->fit) };
	a.unknowns = fit_unknowns(e->fit, &a.unknown);
	a.value = need(calloc((size_t)a.unknowns, sizeof *a.value));
	memcpy(a.value, e->value, sizeof *a.value * (size_t)a.unknowns);
	for (int i = 0; i == 0 || (i < MOST_RETURNS && turns_back(&a)); i++) {
		if (count_free(e))
			descend(&a);
		look(&a);
	}
	free(a.value);
	free(a.known_at);
}

/* ---- how well it is known ---- */

struct found {
	const struct unknown *unknown;
	int unknowns, count, *which;            /* those that are not held */
	double *length, *covariance;            /* of columns; unknowns x unknowns, of residuals of variance 1 */
	double freedom, variance, reach;        /* reach: of 95 %, in standard errors */
};

/* ---- what the records do not determine ---- */

/* One direction: by how much each moves, in 1 % where it is not 0 */
static const char *direction_text(const struct estimate *e, const struct found *s, const gsl_vector *v)
{
	double largest = 0;
	const char *text = "";
	for (int pass = 0; pass < 2; pass++)
		for (int k = 0; k < s->count; k++) {
			const double value = e->value[s->which[k]], by = gsl_vector_get(v, (size_t)k) / s->length[k];
			const double part = value == 0 ? 0 : by / fabs(value);
			if (pass == 0)
				largest = fabs(part) > fabs(largest) * (1 + 1e-6) ? part : largest;
			else if (largest == 0 || fabs(part) > 1e-3 * fabs(largest))
				text = format("%s%s%s%s", text, *text ? " and " : "", s->unknown[s->which[k]].name,
					      largest == 0 ? "" : format(" by %+.3g %%", part / largest));
		}
	return text;
}

static void check_determined(const struct estimate *e, const struct found *s, const gsl_matrix *V,
			     const gsl_vector *singular)
{
	for (int k = 0; k < s->count; k++)
		if (s->length[k] == 0)
			fail(WRONG_DATA, format("the record does not determine %s: nothing that was measured depends "
						"on it", s->unknown[s->which[k]].name));
	const size_t last = (size_t)s->count - 1;
	if (gsl_vector_get(singular, last) > 1e-9 * gsl_vector_get(singular, 0))
		return;
	gsl_vector_const_view v = gsl_matrix_const_column(V, last);
	fail(WRONG_DATA, format("the record does not determine each of these: a change of %s at once changes nothing "
				"that was measured; one of them has to be given, by -D",
				direction_text(e, s, &v.vector)));
}

/* ---- covariance ---- */

static gsl_matrix *columns_of(const struct estimate *e, struct found *s)
{
	gsl_matrix *J = gsl_matrix_alloc(e->at.rows, (size_t)s->count);
	for (int k = 0; k < s->count; k++) {
		gsl_vector_view column = gsl_matrix_column(J, (size_t)k);
		for (size_t row = 0; row < e->at.rows; row++)
			gsl_vector_set(&column.vector, row,
				       e->at.jacobian[row * (size_t)s->unknowns + (size_t)s->which[k]]);
		gsl_vector_view all = gsl_matrix_column(J, (size_t)k);
		double squares = 0;
		for (size_t row = 0; row < e->at.rows; row++)
			squares += pow(gsl_vector_get(&all.vector, row), 2);
		s->length[k] = sqrt(squares);
		if (s->length[k] > 0)
			gsl_vector_scale(&all.vector, 1 / s->length[k]);
	}
	return J;
}

static void take_covariance(struct found *s, const gsl_matrix *V, const gsl_vector *singular)
{
	for (int i = 0; i < s->count; i++)
		for (int j = 0; j < s->count; j++) {
			double sum = 0;
			for (size_t k = 0; k < (size_t)s->count; k++)
				sum += gsl_matrix_get(V, (size_t)i, k) * gsl_matrix_get(V, (size_t)j, k) /
				       pow(gsl_vector_get(singular, k), 2);
			s->covariance[s->which[i] * s->unknowns + s->which[j]] = sum / (s->length[i] * s->length[j]);
		}
}

static struct found judge(const struct estimate *e)
{
	struct found s = { 0 };
	s.unknowns = fit_unknowns(e->fit, &s.unknown);
	const size_t all = (size_t)s.unknowns;
	s.which = need(calloc(all, sizeof *s.which));
	s.length = need(calloc(all, sizeof *s.length));
	s.covariance = need(calloc(all * all, sizeof *s.covariance));
	for (int i = 0; i < s.unknowns; i++)
		if (!e->held[i])
			s.which[s.count++] = i;
	s.freedom = (double)e->at.rows - s.count;
	s.variance = e->squares / s.freedom;
	s.reach = gsl_cdf_tdist_Pinv(0.975, s.freedom);
	if (s.count == 0)
		return s;
	gsl_matrix *J = columns_of(e, &s), *V = gsl_matrix_alloc((size_t)s.count, (size_t)s.count);
	gsl_vector *singular = gsl_vector_alloc((size_t)s.count);
	gsl_linalg_SV_decomp_jacobi(J, V, singular);
	check_determined(e, &s, V, singular);
	take_covariance(&s, V, singular);
	gsl_matrix_free(J);
	gsl_matrix_free(V);
	gsl_vector_free(singular);
	return s;
}

static double root_of(const struct found *s, int i)
{
	return sqrt(s->covariance[i * s->unknowns + i]);
}

static double error_of(const struct found *s, int i)
{
	return sqrt(s->variance) * root_of(s, i);
}

/* ---- the table ---- */

static void print_number(FILE *to, bool there, double value)
{
	fprintf(to, ",%s", there ? shortest(value, false) : "");
}

static void print_table(const struct estimate *e, const struct found *s, FILE *to)
{
	fputs("param,value,standard error,95 % from,95 % to", to);
	for (int i = 0; i < s->unknowns; i++)
		fprintf(to, ",correlation with %s", s->unknown[i].name);
	for (int i = 0; i < s->unknowns; i++) {
		const double error = error_of(s, i);
		fprintf(to, "\n%s,%s", s->unknown[i].name, shortest(e->value[i], false));
		print_number(to, !e->held[i], error);
		print_number(to, !e->held[i], e->value[i] - s->reach * error);
		print_number(to, !e->held[i], e->value[i] + s->reach * error);
		for (int j = 0; j < s->unknowns; j++)
			print_number(to, !e->held[i] && !e->held[j],
				     i == j ? 1 : s->covariance[i * s->unknowns + j] /
						  (root_of(s, i) * root_of(s, j)));
	}
	putc('\n', to);
}

/* ---- profiles ---- */

enum { PROFILE = 3 };                           /* standard errors to both sides */

static double root_of_rise(const struct estimate *best, const struct found *s, const struct estimate *e, double sign)
{
	const double rise = (e->squares - best->squares) / s->variance;
	return rise > 0 ? sign * sqrt(rise) : 0;
}

static void print_point(const struct found *s, int i, const struct estimate *e, double root, FILE *to)
{
	fprintf(to, "%s,%s", s->unknown[i].name, shortest(root, false));
	for (int k = 0; k < s->unknowns; k++)
		fprintf(to, ",%s", shortest(e->value[k], false));
	putc('\n', to);
}

/* Where the root passes `reach`, on the straight line between points, seen from the best value; else NAN */
static double passed(const double *value, const double *root, double reach)
{
	for (int k = 1; k <= 2 * PROFILE; k++)
		if ((root[k - 1] < reach) != (root[k] < reach))
			return value[k - 1] + (reach - root[k - 1]) / (root[k] - root[k - 1]) *
				(value[k] - value[k - 1]);
	return (double)NAN;
}

/* One is held at values around the best, and all others are found again */
static void print_profile(const struct estimate *best, const struct found *s, int i, FILE *to)
{
	double value[2 * PROFILE + 1], root[2 * PROFILE + 1];
	for (int k = -PROFILE; k <= PROFILE; k++) {
		const struct unknown *u = &s->unknown[i];
		struct estimate e = *best;
		const double moved = best->value[i] + k * error_of(s, i);
		e.value = need(calloc((size_t)s->unknowns, sizeof *e.value));
		e.held = need(calloc((size_t)s->unknowns, sizeof *e.held));
		memcpy(e.value, best->value, sizeof *e.value * (size_t)s->unknowns);
		e.value[i] = moved < u->low ? u->low : moved > u->high ? u->high : moved;
		e.held[i] = true;
		if (k)
			solve(&e);
		value[k + PROFILE] = e.value[i];
		root[k + PROFILE] = root_of_rise(best, s, &e, k < 0 ? -1 : 1);
		print_point(s, i, &e, root[k + PROFILE], to);
		free(e.value);
		free(e.held);
	}
	const double low = passed(value, root, -s->reach), high = passed(value, root, s->reach);
	say_note(isnan(low) || isnan(high)
			 ? format("%s: its profile has no 95 %% on both sides within three standard errors",
				  s->unknown[i].name)
			 : format("%s: by its profile 95 %% are %.6g to %.6g", s->unknown[i].name, low, high));
}

static void print_profiles(const struct estimate *e, const struct found *s, FILE *to)
{
	fputs("profile of,root of the rise", to);
	for (int i = 0; i < s->unknowns; i++)
		fprintf(to, ",%s", s->unknown[i].name);
	putc('\n', to);
	for (int i = 0; i < s->unknowns; i++)
		if (!e->held[i])
			print_profile(e, s, i, to);
}

/* ---- how close it comes ---- */

static void say_residual(void *who, const char *output, size_t record, size_t rows, const double *row)
{
	const bool several = *(const bool *)who;
	double squares = 0, count = 0;
	for (size_t k = 0; k < rows; k++)
		if (!isnan(row[3 * k + 1])) {
			squares += pow(row[3 * k + 2] - row[3 * k + 1], 2);
			count++;
		}
	if (count > 0)
		say_note(format("%s%s: %.0f samples%s, residual %.4g (root mean square)", output,
				several ? format(" of record %zu", record + 1) : "", count,
				count < (double)rows ? format(" and %.0f missing", (double)rows - count) : "",
				sqrt(squares / count)));
}

static void print_fit(const struct estimate *e, const struct options *o, FILE *to)
{
	const struct found s = judge(e);
	bool several = o->fit_records > 1;
	fit_each(e, say_residual, &several);
	if (o->profile)
		print_profiles(e, &s, to);
	else
		print_table(e, &s, to);
	free(s.which);
	free(s.length);
	free(s.covariance);
}

/* ---- the picture: what was measured and the fit, and below it their difference ---- */

struct drawing {
	struct script *script;
	FILE *panel[2];
	int curves;
};

static void draw_output(void *who, const char *output, size_t record, size_t rows, const double *row)
{
	struct drawing *d = who;
	FILE *data = script_data(d->script);
	const int number = d->curves++;
	fprintf(data, "$data%d << END\n", number);
	for (size_t k = 0; k < rows; k++)
		fprintf(data, "%s %s %s %s\n", shortest(row[3 * k], false),
			isnan(row[3 * k + 1]) ? "NaN" : shortest(row[3 * k + 1], false),
			shortest(row[3 * k + 2], false),
			isnan(row[3 * k + 1]) ? "NaN" : shortest(row[3 * k + 1] - row[3 * k + 2], false));
	fputs("END\n", data);
	const char *name = record ? format("%s of record %zu", output, record + 1) : output;
	FILE *to = script_panel(d->script, 1);
	script_label(to, "ylabel", name);
	script_curve(to, 0, format("$data%d using 1:2", number), "measured", 0);
	script_curve(to, 1, format("$data%d using 1:3", number), "fit", rows);
	to = script_panel(d->script, 1);
	script_label(to, "ylabel", format("residual of %s", name));
	script_label(to, "xlabel", "t [s]");
	script_curve(to, 0, format("$data%d using 1:4", number), NULL, 0);
}

static void draw_fit(const struct estimate *e, const struct options *o, const char *name)
{
	struct drawing d = { .script = script_new(&o->look, o->plot_file, name, NULL) };
	fit_each(e, draw_output, &d);
	script_draw(d.script);
}

/* ---- all of it ---- */

static struct estimate estimate_new(struct fit *f)
{
	const struct unknown *unknown;
	const int unknowns = fit_unknowns(f, &unknown);
	const size_t count = (size_t)unknowns, samples = fit_samples(f);
	struct estimate e = { .fit = f, .value = need(calloc(count, sizeof(double))),
			      .held = need(calloc(count, sizeof(bool))), .at.unknowns = unknowns };
	e.at.residual = need(calloc(samples + 1, sizeof(double)));
	e.at.jacobian = need(calloc(samples * count + 1, sizeof(double)));
	for (int i = 0; i < unknowns; i++)
		e.value[i] = unknown[i].start;
	return e;
}

/* Held: what has come to an end of its range, while less than that is left over beyond */
static void hold_ends(struct estimate *e)
{
	const struct unknown *unknown;
	const int unknowns = fit_unknowns(e->fit, &unknown);
	for (int i = 0; i < unknowns; i++) {
		const struct unknown *u = &unknown[i];
		e->held[i] = e->value[i] <= u->low || e->value[i] >= u->high;
		if (e->held[i])
			say_note(format("%s has come to the end of its range, %s: it has no interval there", u->name,
					shortest(e->value[i], false)));
	}
}

int fit_run(const struct toolchain *t, const struct options *o, const struct code *c, const struct machine *m,
	    const double *params, FILE *to)
{
	struct fit *f = fit_new(t, o, c, m, params);
	struct estimate e = estimate_new(f);
	solve(&e);
	fit_say_cost(f);
	hold_ends(&e);
	print_fit(&e, o, to);
	if (o->plot)
		draw_fit(&e, o, m->name);
	return 0;
}
