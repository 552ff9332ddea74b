/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Stability of exponential multistep methods. With functions of time frozen, and without forces of time alone, a step
 * is a linear map of [eta, eta', past forces]; its spectral radius says by how much that grows at each step. It is
 * looked for at the times where each operator of a schedule serves: the first, the last, and where functions are
 * largest. Undamped modes stand on the circle, and a little beyond it by what a step leaves out: what counts is by how
 * much all steps together may let them grow, operator by operator.
 */
#include "inner.h"

#include <math.h>

enum {
	TIMES = 512,                /* at which functions are looked at, to choose from */
	CHOICES = 3,                /* of each operator */
	SAMPLE_BITS = 64
};

struct frozen {
	const struct normal *normal;
	int functions;
	const double *f;            /* of time: all, the first is 1 */
	int schedule;
	double *matrix[2];          /* the remainder, of eta and of eta': modes x modes */
	double h;
};

/* ---- the remainder at a time ---- */

static void freeze(struct frozen *z)
{
	const struct normal *m = z->normal;
	size_t cells = (size_t)m->modes * (size_t)m->modes;
	for (size_t i = 0; i < cells; i++)
		z->matrix[0][i] = z->matrix[1][i] = 0;
	for (int k = 0; k < m->matrices; k++)
		for (int t = 0; t < m->matrix[k].terms; t++) {
			double by = m->matrix[k].term[t].factor[z->schedule] * z->f[m->matrix[k].term[t].function];
			const double *value = m->matrix[k].value + (size_t)z->schedule * cells;
			for (size_t i = 0; i < cells; i++)
				z->matrix[m->matrix[k].term[t].velocity][i] += by * value[i];
		}
}

/* By modes, not by places */
static void forces_at(const struct frozen *z, const double *eta, const double *rate, double *force)
{
	int n = z->normal->modes;
	for (int i = 0; i < n; i++) {
		const double *stiffness = z->matrix[0] + i * n, *damping = z->matrix[1] + i * n;
		double sum = 0;
		for (int j = 0; j < n; j++)
			sum += stiffness[j] * eta[j] + damping[j] * rate[j];
		force[i] = sum;
	}
}

/* ---- the map of a step ---- */

static void step_of_frozen(const struct frozen *z, bool twice, const double *from, double *to)
{
	const struct normal *m = z->normal;
	int n = m->modes, width = m->width, points = m->multistep.points;
	const double *flow = m->multistep.step.flow + z->schedule * 4 * width,
		     *correct = m->multistep.correct + z->schedule * 2 * width;
	const double *weight = m->multistep.step.weight + z->schedule * points * 2 * width;
	double *force = to + 2 * n;
	for (int k = points - 1; k > 0; k--)
		for (int i = 0; i < n; i++)
			to[(2 + k) * n + i] = from[(1 + k) * n + i];
	for (int i = 0; i < n; i++) {
		int at = m->place[i];
		to[i] = flow[at] * from[i] + flow[width + at] * from[n + i];
		to[n + i] = flow[2 * width + at] * from[i] + flow[3 * width + at] * from[n + i];
		for (int k = 0; k < points; k++) {
			to[i] += weight[2 * k * width + at] * from[(2 + k) * n + i];
			to[n + i] += weight[(2 * k + 1) * width + at] * from[(2 + k) * n + i];
		}
	}
	forces_at(z, to, to + n, force);
	for (int i = 0; i < n; i++) {
		double excess = force[i];
		for (int k = 0; k < points; k++)
			excess -= m->multistep.extrapolate[k] * from[(2 + k) * n + i];
		to[i] += correct[m->place[i]] * excess;
		to[n + i] += correct[width + m->place[i]] * excess;
	}
	if (twice)
		forces_at(z, to, to + n, force);
}

/* [eta, eta', forces at the nodes of the last step] */
static void collocation_of_frozen(const struct frozen *z, const double *from, double *to)
{
	const struct normal *m = z->normal;
	int n = m->modes, width = m->width, nodes = m->collocation.stages + 1;
	double *force = to + 2 * n;
	const double *old = from + 2 * n;
	for (int i = 0; i < n; i++)
		force[i] = old[m->collocation.stages * n + i];
	for (int k = 1; k < nodes; k++)
		for (int i = 0; i < n; i++) {
			double sum = 0;
			for (int l = 0; l < nodes; l++)
				sum += m->collocation.ahead[(k - 1) * nodes + l] * old[l * n + i];
			force[k * n + i] = sum;
		}
	for (int sweep = 0; sweep < m->collocation.sweeps; sweep++)
		for (int k = 1; k < nodes; k++) {
			const double *flow = m->collocation.stage[k - 1].flow + z->schedule * 4 * width;
			const double *weight = m->collocation.stage[k - 1].weight + z->schedule * nodes * 2 * width;
			for (int i = 0; i < n; i++) {
				int at = m->place[i];
				double eta = flow[at] * from[i] + flow[width + at] * from[n + i];
				double rate = flow[2 * width + at] * from[i] + flow[3 * width + at] * from[n + i];
				for (int l = 0; l < nodes; l++) {
					eta += weight[2 * l * width + at] * force[l * n + i];
					rate += weight[(2 * l + 1) * width + at] * force[l * n + i];
				}
				to[i] = eta;
				to[n + i] = rate;
			}
			forces_at(z, to, to + n, force + k * n);
		}
}

static void map_of_frozen(const struct frozen *z, bool twice, const double *from, double *to)
{
	if (z->normal->multistep.points)
		step_of_frozen(z, twice, from, to);
	else
		collocation_of_frozen(z, from, to);
}

static double radius_by_eigenvalues(const struct frozen *z, bool twice, int size)
{
	SCRATCH double *matrix = ARRAY(double, (size_t)size * (size_t)size), *from = ARRAY(double, (size_t)size),
		       *to = ARRAY(double, (size_t)size);
	for (int j = 0; j < size; j++) {
		from[j] = 1;
		map_of_frozen(z, twice, from, to);
		from[j] = 0;
		for (int i = 0; i < size; i++)
			matrix[i * size + j] = to[i];
	}
	return spectral_radius(size, matrix);
}

/* Amplitudes times frequencies, rates, and forces over a step, so that each counts alike */
static double size_of_state(const struct frozen *z, const double *x, double h)
{
	const struct normal *m = z->normal;
	double sum = 0;
	for (int i = 0; i < (2 + m->kept) * m->modes; i++) {
		double scale = i < m->modes ? m->frequency[z->schedule * m->modes + i] : i < 2 * m->modes ? 1 : h;
		sum += scale * x[i] * scale * x[i];
	}
	return sqrt(sum);
}

/* Of many modes: by what so many steps make of any state, in the mean of the second half of them */
static double radius_by_steps(const struct frozen *z, bool twice, int size)
{
	enum { STEPS = 8192 };
	double *x[2] = { ARRAY(double, (size_t)size), ARRAY(double, (size_t)size) }, growth = 0;
	unsigned seed = 1;
	for (int i = 0; i < 2 * z->normal->modes; i++) {
		seed = seed * 1103515245u + 12345u;
		x[0][i] = (double)(seed >> 8) / 8388608 - 1;
	}
	for (int k = 0; k < STEPS; k++) {
		double before = size_of_state(z, x[k % 2], z->h);
		map_of_frozen(z, twice, x[k % 2], x[(k + 1) % 2]);
		double after = size_of_state(z, x[(k + 1) % 2], z->h);
		for (int i = 0; i < size && after > 0; i++)
			x[(k + 1) % 2][i] /= after;
		growth += k >= STEPS / 2 && before > 0 && after > 0 ? log(after / before) : 0;
	}
	discard(x[0]);
	discard(x[1]);
	return exp(growth / (STEPS - STEPS / 2));
}

static double radius_of(struct frozen *z, bool twice)
{
	enum { BY_EIGENVALUES = 160 };
	int size = (2 + z->normal->kept) * z->normal->modes;
	freeze(z);
	return (size <= BY_EIGENVALUES ? radius_by_eigenvalues : radius_by_steps)(z, twice, size);
}

/* ---- times to look at ---- */

/* Where functions of time are looked at: as long as they change, else two turns of the slowest, or a thousand steps */
static double span_of(const struct step *step)
{
	const struct linear *system = &step->model->system;
	double h = nearest_double(step->model->h), slowest = 0;
	double span = loads_change(system) ? nearest_double(system->change[system->segments - 2]) : 0;
	for (int l = 0; l < system->loads; l++) {
		double w = nearest_double(system->load[l].forcing->w);
		if (w > 0 && (slowest == 0 || w < slowest))
			slowest = w;
	}
	if (step->model->remainder.split->ends_steady)
		return span;
	double turns = slowest > 0 ? 4 * acos(-1) / slowest : 0;
	span = span > turns ? span : turns;
	return span > 1000 * h ? span : 1000 * h;
}

static void no_state(void *context, const struct basis *basis, mpfr_ptr value)
{
	(void)context;
	(void)basis;
	mpfr_set_zero(value, 1);
}

/* [time][function] */
static double *functions_at(const struct step *step, double span)
{
	const struct splitting *split = step->model->remainder.split;
	struct sample *sample = sample_new(SAMPLE_BITS, no_state, NULL);
	double *f = ARRAY(double, (size_t)(TIMES * split->functions));
	REAL t = WITH_BITS(SAMPLE_BITS), value = WITH_BITS(SAMPLE_BITS);
	for (int i = 0; i < TIMES; i++) {
		mpfr_set_d(t, span * i / (TIMES - 1), MPFR_RNDN);
		sample_at(sample, t);
		for (int k = 0; k < split->functions; k++) {
			sample_form(sample, split->function[k].form, value);
			f[i * split->functions + k] = mpfr_get_d(value, MPFR_RNDN);
		}
	}
	return f;
}

static int schedule_at(const struct step *step, const double *f)
{
	const struct model *model = step->model;
	int schedule = 0;
	if (model->remainder.split->selector < 0)
		return 0;
	while (schedule + 1 < model->schedule.operators &&
	       f[model->remainder.split->selector] > nearest_double(model->schedule.operator[schedule].at))
		schedule++;
	return schedule;
}

/* How large the functions are, each beside its largest value */
static double size_at(int functions, const double *f, const double *largest)
{
	double size = 0;
	for (int k = 1; k < functions; k++)
		size += largest[k] > 0 ? fabs(f[k]) / largest[k] : 0;
	return size;
}

struct chosen {                     /* of an operator */
	int times;                  /* of all at which it serves; */
	int time[CHOICES];          /* those looked at, 0: none */
};

static struct chosen *choose_times(const struct step *step, const double *f)
{
	int functions = step->model->remainder.split->functions, operators = step->normal->operators;
	double *largest = ARRAY(double, (size_t)functions), *size = ARRAY(double, (size_t)operators);
	struct chosen *chosen = ARRAY(struct chosen, (size_t)operators);
	for (int i = 0; i < TIMES * functions; i++)
		if (fabs(f[i]) > largest[i % functions])
			largest[i % functions] = fabs(f[i]);
	for (int i = 0; i < TIMES; i++) {
		const double *now = f + i * functions;
		struct chosen *own = &chosen[schedule_at(step, now)];
		double size_now = size_at(functions, now, largest), *most = &size[own - chosen];
		if (own->times++ == 0)
			own->time[0] = own->time[2] = i;
		own->time[1] = i;
		own->time[2] = size_now > *most ? i : own->time[2];
		*most = size_now > *most ? size_now : *most;
	}
	return chosen;
}

/* ---- the whole ---- */

/* Of one operator: the largest radius, and what a step lets grow at most, as ln of the factor, in the mean */
static double growth_of_schedule(struct frozen *z, const struct chosen *own, const double *f, bool twice,
			     struct stability *found)
{
	double growth = 0;
	int looked = 0;
	for (int c = 0; c < CHOICES; c++) {
		bool again = c > 0 && (own->time[c] == own->time[0] || own->time[c] == own->time[c - 1]);
		if (again)
			continue;
		z->f = f + own->time[c] * z->functions;
		double radius = radius_of(z, twice);
		growth += radius > 1 ? log(radius) : 0;
		looked++;
		if (!(radius <= found->radius)) {
			found->radius = radius;
			found->schedule = z->schedule;
			found->time = found->span * own->time[c] / (TIMES - 1);
		}
	}
	return growth / looked;
}

struct stability stability_of(const struct step *step, bool twice)
{
	const struct normal *m = step->normal;
	size_t cells = (size_t)m->modes * (size_t)m->modes;
	struct frozen z = { .normal = m, .functions = step->model->remainder.split->functions,
			    .matrix = { ARRAY(double, cells), ARRAY(double, cells) },
			    .h = nearest_double(step->model->h) };
	struct stability found = { .span = span_of(step) };
	const double *f = functions_at(step, found.span);
	const struct chosen *chosen = choose_times(step, f);
	double steps = found.span / z.h;
	for (z.schedule = 0; z.schedule < m->operators; z.schedule++)
		if (chosen[z.schedule].times)
			found.growth += growth_of_schedule(&z, &chosen[z.schedule], f, twice, &found) * steps *
					chosen[z.schedule].times / TIMES;
	found.growth_factor = exp(found.growth);
	return found;
}
