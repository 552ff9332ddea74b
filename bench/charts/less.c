/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * less --specs FOLDER           the models, FOLDER/less_*.spec, and their list, FOLDER/less.list
 * less VARIANTS OUTDIR          OUTDIR/less.csv: the error of each over its multiplications in a step
 *
 * What modelling less saves. Three scenes with a load and an output each: a cantilever hit at its tip, a building of 12
 * storeys under a record, a drivetrain of 6 inertias under its engine. Each is found as modes, and stepped by plgen
 * with fewer of them, with the static share of those left out added to the output or not, from coarser meshes, as what
 * balanced truncation leaves, in double and float. Error: largest difference of the output from that of the whole, of
 * the finest mesh, over its largest value. A line: the error that the model has anyway, by its mesh or by a stiffness
 * that is known to 1 %.
 *
 * The whole is solved here mode by mode in closed form, the load a ramp from sample to sample, as in plgen's code.
 */
#include "amplification.h"
#include "less.h"
#include "record.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SAMPLES = 5001, FINEST = 40 };

struct scene {
	const char *name, *step;        /* h [s] as a fraction */
	double h;
	int samples;
	double u[MOST_SAMPLES];
	struct modal whole, anyway;     /* the finest; what the model is anyway: another mesh, or 1 % stiffer */
	const char *anyway_is;
	struct modal subject;           /* whose modes are left out */
	int most_kept;
};

/* ---- from M, K, load and output to modes ---- */

static void modes_of(int n, const double *M, const double *K, const double *load, const double *out, struct modal *m)
{
	const size_t size = (size_t)n;
	gsl_matrix *A = gsl_matrix_alloc(size, size), *B = gsl_matrix_alloc(size, size),
		*V = gsl_matrix_alloc(size, size);
	gsl_vector *values = gsl_vector_alloc(size);
	gsl_eigen_gensymmv_workspace *work = gsl_eigen_gensymmv_alloc(size);
	memcpy(A->data, K, size * size * sizeof *K);
	memcpy(B->data, M, size * size * sizeof *M);
	gsl_eigen_gensymmv(A, B, values, V, work);
	gsl_eigen_gensymmv_sort(values, V, GSL_EIGEN_SORT_VAL_ASC);
	m->modes = 0;
	for (size_t j = 0; j < size; j++) {
		double mass = 0, b = 0, c = 0;
		const double w2 = gsl_vector_get(values, j), largest = gsl_vector_get(values, size - 1);
		for (size_t i = 0; i < size; i++) {
			const double x = gsl_matrix_get(V, i, j);
			for (size_t k = 0; k < size; k++)
				mass += x * M[i * size + k] * gsl_matrix_get(V, k, j);
			b += x * load[i];
			c += x * out[i];
		}
		if (w2 < 1e-9 * largest)        /* what moves as a whole: no output here sees it */
			continue;
		m->w[m->modes] = sqrt(w2);
		m->b[m->modes] = b / sqrt(mass);
		m->c[m->modes++] = c / sqrt(mass);
	}
	gsl_eigen_gensymmv_free(work);
	gsl_vector_free(values);
	gsl_matrix_free(V);
	gsl_matrix_free(B);
	gsl_matrix_free(A);
}

/* A chain: masses, springs before each mass (0: none) with factor `stiffer`; load on masses, output by coordinates */
static void chain(int n, const double *mass, const double *spring, double stiffer, const double *load,
				  const double *out, struct modal *m)
{
	double M[n * n], K[n * n];
	memset(M, 0, sizeof M);
	memset(K, 0, sizeof K);
	for (int i = 0; i < n; i++) {
		const double k = stiffer * spring[i];
		M[i * n + i] = mass[i];
		K[i * n + i] += k;
		if (i > 0) {
			K[(i - 1) * n + i - 1] += k;
			K[(i - 1) * n + i] -= k;
			K[i * n + i - 1] -= k;
		}
	}
	modes_of(n, M, K, load, out, m);
}

/* The beam of models/beam4.spec, at rest: Euler and Bernoulli, elements of Hermite's cubics, clamped at its root */
static void cantilever(int elements, struct modal *m)
{
	const double S = 7.2968e-5, inertia = 8.2189e-9, rho = 2.7667e3, E = 6.8952e10, l = 8.0 / elements;
	const double a = rho * S * l / 420, k = E * inertia / (l * l * l);
	const double Me[4][4] = {{156, 22 * l, 54, -13 * l}, {22 * l, 4 * l * l, 13 * l, -3 * l * l},
	                         {54, 13 * l, 156, -22 * l}, {-13 * l, -3 * l * l, -22 * l, 4 * l * l}};
	const double Ke[4][4] = {{12, 6 * l, -12, 6 * l}, {6 * l, 4 * l * l, -6 * l, 2 * l * l},
	                         {-12, -6 * l, 12, -6 * l}, {6 * l, 2 * l * l, -6 * l, 4 * l * l}};
	const int n = 2 * elements;
	double M[n * n], K[n * n], tip[n];
	memset(M, 0, sizeof M);
	memset(K, 0, sizeof K);
	memset(tip, 0, sizeof tip);
	for (int e = 0; e < elements; e++)
		for (int i = 0; i < 4; i++)
			for (int j = 0; j < 4; j++) {
				const int r = 2 * (e - 1) + i, c = 2 * (e - 1) + j;
				if (r >= 0 && c >= 0) {
					M[r * n + c] += a * Me[i][j];
					K[r * n + c] += k * Ke[i][j];
				}
			}
	tip[n - 2] = 1;
	modes_of(n, M, K, tip, tip, m);
	m->zeta = 0.01;
}

/* ---- the scenes ---- */

static void beam(struct scene *s)
{
	*s = (struct scene){.name = "beam", .step = "1/100", .h = 0.01, .samples = 2001, .most_kept = 15,
	                    .anyway_is = "mesh of 5 elements"};
	for (int k = 0; k < 20; k++)            /* a blow of 0.2 s [N] */
		s->u[k] = pow(sin(M_PI * k / 20), 2);
	cantilever(FINEST, &s->whole);
	cantilever(5, &s->anyway);
	cantilever(10, &s->subject);
}

static void building(struct scene *s)
{
	enum { N = 12 };
	double mass[N], spring[N], load[N], roof[N] = {0};
	*s = (struct scene){.name = "building", .step = "1/50", .h = 0.02, .samples = RECORD_SAMPLES, .most_kept = 12,
	                    .anyway_is = "stiffness 1 % off"};
	record_of_quake(s->u);
	for (int i = 0; i < N; i++) {
		mass[i] = 3e5;                          /* kg */
		spring[i] = 6e8 * (1 - 0.05 * i);       /* N/m, softer upwards: 1.0 Hz */
		load[i] = -mass[i];
	}
	roof[N - 1] = 1;
	chain(N, mass, spring, 1, load, roof, &s->whole);
	chain(N, mass, spring, 1.01, load, roof, &s->anyway);
	s->whole.zeta = s->anyway.zeta = 0.03;
	s->subject = s->whole;
}

static void drivetrain(struct scene *s)
{
	enum { N = 6 };
	/* engine, flywheel, gearbox, shaft, differential, wheels with the vehicle, seen from the engine */
	const double inertia[N] = {0.08, 0.25, 0.02, 0.01, 0.015, 1.2};         /* kg m^2 */
	const double spring[N] = {0, 6e4, 1500, 8000, 1.2e4, 300};              /* N m/rad, before each; 0: free */
	const double torque[N] = {1}, halves[N] = {0, 0, 0, 0, -300, 300};      /* in the half-shafts [N m] */
	*s = (struct scene){.name = "drivetrain", .step = "1/1000", .h = 0.001, .samples = 3001, .most_kept = 5,
	                    .anyway_is = "stiffness 1 % off"};
	for (int k = 0; k < s->samples; k++) {
		const double t = k * s->h, rise = t < 0.2 ? pow(sin(M_PI * t / 0.4), 2) : 1;
		s->u[k] = rise * (100 + 40 * sin(2 * M_PI * 40 * t));           /* and ignition at 2400 1/min */
	}
	chain(N, inertia, spring, 1, torque, halves, &s->whole);
	chain(N, inertia, spring, 1.01, torque, halves, &s->anyway);
	s->whole.zeta = s->anyway.zeta = 0.02;
	s->subject = s->whole;
}

static void (*const scenes[])(struct scene *) = {beam, building, drivetrain};
enum { SCENES = 3 };

/* ---- the solution ---- */

/* Mode by mode: with u = u0 + s t, q = (u0 b + s b t)/w^2 - 2 zeta s b/w^3 + free motion */
static void solve(const struct modal *m, const struct scene *s, double *y)
{
	double q[MODES] = {0}, v[MODES] = {0};
	y[0] = m->d * s->u[0];
	for (int k = 0; k + 1 < s->samples; k++) {
		const double slope = (s->u[k + 1] - s->u[k]) / s->h;
		y[k + 1] = m->d * s->u[k + 1];
		for (int i = 0; i < m->modes; i++) {
			const double w = m->w[i], wd = w * sqrt(1 - m->zeta * m->zeta), w2 = w * w, h = s->h;
			const double rate = slope * m->b[i] / w2, at = s->u[k] * m->b[i] / w2 - 2 * m->zeta / w * rate;
			const double x = q[i] - at, dx = v[i] - rate, decay = exp(-m->zeta * w * h);
			const double turn = (dx + m->zeta * w * x) / wd, c = cos(wd * h), sn = sin(wd * h);
			q[i] = at + rate * h + decay * (x * c + turn * sn);
			v[i] = rate + decay * (dx * c - (m->zeta * w * turn + wd * x) * sn);
			y[k + 1] += m->c[i] * q[i];
		}
	}
}

static double error_over_peak(int samples, const double *y, const double *truth)
{
	double most = 0, peak = 0;
	for (int k = 0; k < samples; k++) {
		most = fmax(most, fabs(y[k] - truth[k]));
		peak = fmax(peak, fabs(truth[k]));
	}
	return most / peak;
}

/* ---- models that are less ---- */

/* The first `kept`; with_static: what the others do to a load at rest goes into d */
static struct modal truncated(const struct modal *m, int kept, bool with_static)
{
	struct modal less = *m;
	for (int i = kept; i < m->modes && with_static; i++)
		less.d += m->c[i] * m->b[i] / (m->w[i] * m->w[i]);
	less.modes = kept < m->modes ? kept : m->modes;
	return less;
}

/* ---- as specs ---- */

struct list { FILE *file; const char *folder; int count; };

static FILE *spec_open(struct list *list, const struct scene *s, const char *model, const char *options, int kept,
					   int states)
{
	const char *name = text("less_%d", ++list->count);
	fprintf(list->file, "%s\t%s\t%s\t%d\t%d\t%s --step %s\n", name, s->name, model, kept, states, options, s->step);
	FILE *f = file_in(list->folder, text("%s.spec", name), "w");
	fprintf(f, "# %s: %s, %d kept\nmodel less\ninput u hold first\n", s->name, model, kept);
	return f;
}

static void put_modal(struct list *list, const struct scene *s, const char *model, const char *options,
					  const struct modal *m, int kept)
{
	FILE *f = spec_open(list, s, model, options, kept, 2 * m->modes);
	fputs("coord ", f);
	for (int i = 0; i < m->modes; i++)
		fprintf(f, "%sq%d", i ? ", " : "", i + 1);
	putc('\n', f);
	for (int i = 0; i < m->modes; i++)
		fprintf(f, "q%d'' + %.17g*q%d' + %.17g*q%d = %.17g*u\n", i + 1, 2 * m->zeta * m->w[i], i + 1,
		        m->w[i] * m->w[i], i + 1, m->b[i]);
	fputs("output y = (", f);
	for (int i = 0; i < m->modes; i++)
		fprintf(f, "%s%.17g*q%d", i ? " + " : "", m->c[i], i + 1);
	fprintf(f, ") + %.17g*u\nstep 1\n", m->d);
	fclose(f);
}

static void put_poles(struct list *list, const struct scene *s, const char *model, const struct poles *b, int states)
{
	FILE *f = spec_open(list, s, model, "", states, states);
	fputs("coord ", f);
	for (int i = 0; i < b->count; i++)
		fprintf(f, cimag(b->p[i]) > 0 ? "%sq%d, r%d" : "%sq%d", i ? ", " : "", i + 1, i + 1);
	putc('\n', f);
	for (int i = 0; i < b->count; i++) {
		const double re = creal(b->p[i]), im = cimag(b->p[i]);
		if (im > 0)
			fprintf(f, "q%d' = %.17g*q%d - %.17g*r%d + u\nr%d' = %.17g*q%d + %.17g*r%d\n", i + 1, re, i + 1,
			        im, i + 1, i + 1, im, i + 1, re, i + 1);
		else
			fprintf(f, "q%d' = %.17g*q%d + u\n", i + 1, re, i + 1);
	}
	fputs("output y = (0*u", f);
	for (int i = 0; i < b->count; i++) {
		const double both = cimag(b->p[i]) > 0 ? 2 : 1;
		fprintf(f, " + %.17g*q%d", both * creal(b->c[i]), i + 1);
		if (both > 1)
			fprintf(f, " - %.17g*r%d", both * cimag(b->c[i]), i + 1);
	}
	fputs(")\nstep 1\n", f);
	fclose(f);
}

static void put_scene(struct list *list, const struct scene *s)
{
	static const int meshes[] = {2, 3, 5, 10, 20, 0};
	struct modal m;
	for (const int *mesh = meshes; *mesh && strcmp(s->name, "beam") == 0; mesh++) {
		cantilever(*mesh, &m);
		put_modal(list, s, "elements, all modes", "", &m, *mesh);
	}
	for (int kept = 1; kept <= s->most_kept; kept++) {
		const bool all = kept >= s->subject.modes;
		m = truncated(&s->subject, kept, false);
		put_modal(list, s, "modes", "", &m, kept);
		m = truncated(&s->subject, kept, true);
		if (!all)
			put_modal(list, s, "modes, static rest", "", &m, kept);
		put_modal(list, s, "modes, static rest, float", "--real float", &m, kept);
	}
	for (int states = 2; states <= 2 * s->most_kept && states <= 12; states += 2) {
		struct poles poles;
		balance(&s->subject, states, &poles);
		put_poles(list, s, "balanced truncation", &poles, states);
	}
}

static int write_specs(const char *folder)
{
	static struct scene s;
	struct list list = {file_in(folder, "less.list", "w"), folder, 0};
	for (int i = 0; i < SCENES; i++) {
		scenes[i](&s);
		put_scene(&list, &s);
	}
	return fclose(list.file) != 0;
}

/* ---- their runs ---- */

static void run_generated(const char *folder, const char *name, const struct scene *s, double *y)
{
	const void *symbol = variant_symbol(folder, name, "subject_model");
	const pl_model *model = symbol;
	const bool single = model->real_size == (int)sizeof(float);
	const pl_modelf *modelf = symbol;
	void *state = calloc(1, single ? modelf->size : model->size);
	float uf[MOST_SAMPLES], yf[MOST_SAMPLES];
	for (int k = 0; k < s->samples; k++)
		uf[k] = (float)s->u[k];
	y[0] = 0;                               /* at rest, and every load begins at 0 */
	if (single) {
		modelf->init(state);
		modelf->hold(state, uf);
		modelf->run(state, (size_t)s->samples - 1, uf + 1, yf);
		for (int k = 1; k < s->samples; k++)
			y[k] = yf[k - 1];
	} else {
		model->init(state);
		model->hold(state, s->u);
		model->run(state, (size_t)s->samples - 1, s->u + 1, y + 1);
	}
	free(state);
}

/* The file NAME.cost has plgen's own count */
static int multiplications(const char *folder, const char *name)
{
	int count = -1;
	FILE *f = file_in(folder, text("%s.cost", name), "r");
	if (fscanf(f, "%d", &count) != 1)
		count = -1;
	fclose(f);
	return count;
}

static int write_table(const char *variants, const char *folder)
{
	static struct scene s[SCENES];
	static double truth[SCENES][MOST_SAMPLES], y[MOST_SAMPLES];
	char line[400], *field[5];                      /* file, scene, model, kept, states */
	FILE *csv = table_open(folder, "less.csv",
	                       "scene,model,kept,states,multiplications,error_over_peak,anyway,error_anyway");
	double anyway[SCENES];
	for (int i = 0; i < SCENES; i++) {
		scenes[i](&s[i]);
		solve(&s[i].whole, &s[i], truth[i]);
		solve(&s[i].anyway, &s[i], y);
		anyway[i] = error_over_peak(s[i].samples, y, truth[i]);
	}
	FILE *list = file_in(variants, "less.list", "r");
	while (fgets(line, sizeof line, list)) {
		split_line("less", line, 5, field);
		int i = 0;
		while (strcmp(s[i].name, field[1]) != 0)
			i++;
		run_generated(variants, field[0], &s[i], y);
		fprintf(csv, "%s,\"%s\",%s,%s,%d,%.3g,%s,%.3g\n", field[1], field[2], field[3], field[4],
		        multiplications(variants, field[0]), error_over_peak(s[i].samples, y, truth[i]), s[i].anyway_is,
		        anyway[i]);
	}
	fclose(list);
	table_close(csv, "less.csv");
	return 0;
}

int main(int argc, char **argv)
{
	const bool specs = flags_of(argc, &argv, "--specs", 1, 2, "less --specs FOLDER\n       less VARIANTS OUTDIR");
	return specs ? write_specs(argv[0]) : write_table(argv[0], argv[1]);
}
