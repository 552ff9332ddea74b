/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Responses of piecewise-linear models to a slow sweep, up and down: at each frequency the motion that repeats with the
 * excitation and is stable, near the one before; where there is none near, what the model comes to in time. Of it the
 * harmonic of the excitation's own frequency is reported, over the excitation: a describing function (Gelb and Vander
 * Velde 1968, section 3). Motions that repeat are roots of y(T) - y(0), by Newton's method; they are stable where all
 * eigenvalues of its derivative are inside the unit circle (Floquet). */
#include "model/contacts/contacts.h"
#include "report/report.h"
#include "step/step.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

enum { ROUNDS = 9, STEPS = 10, MEANS = 64, HALVINGS = 5 };
static const double two_pi = 6.283185307179586, near = 0.3, settled = 1e-11;

struct course_of_mover {                /* what is carried from one frequency to the next */
	struct mover *m;
	double *y, *trial, *end, *scale, *M;
	bool repeats;                   /* at the last frequency */
};

/* ---- a motion that repeats ---- */

/* The larger size; what is no number stays none */
static double larger(double size, double x)
{
	return fabs(x) <= size || isnan(size) ? size : fabs(x);
}

/* The shortest d with (I - M) d = end - trial, both in units of the scale; its largest entry. A direction in which the
 * model may stand anywhere is not moved in. */
static double newton_step(struct course_of_mover *c, double *d)
{
	size_t n = (size_t)c->m->states;
	gsl_matrix *U = gsl_matrix_alloc(n, n), *V = gsl_matrix_alloc(n, n);
	gsl_vector *S = gsl_vector_alloc(n), *work = gsl_vector_alloc(n), *b = gsl_vector_alloc(n);
	gsl_vector_view x = gsl_vector_view_array(d, n);
	double largest = 0;
	for (size_t i = 0; i < n; i++) {
		gsl_vector_set(b, i, (c->end[i] - c->trial[i]) / c->scale[i]);
		for (size_t j = 0; j < n; j++)
			gsl_matrix_set(U, i, j, (double)(i == j) - c->M[i * n + j] * c->scale[j] / c->scale[i]);
	}
	gsl_linalg_SV_decomp(U, V, S, work);
	for (size_t i = 0; i < n; i++)
		if (gsl_vector_get(S, i) < 1e-10 * gsl_vector_get(S, 0))
			gsl_vector_set(S, i, 0);
	gsl_linalg_SV_solve(U, V, S, b, &x.vector);
	for (size_t i = 0; i < n; i++) {
		largest = larger(largest, d[i]);
		d[i] *= c->scale[i];
	}
	gsl_matrix_free(U);
	gsl_matrix_free(V);
	gsl_vector_free(S);
	gsl_vector_free(work);
	gsl_vector_free(b);
	return largest;
}

/* A state that never moves counts in units of its own. */
static void complete_scale(struct course_of_mover *c)
{
	for (int i = 0; i < c->m->states; i++)
		if (!(c->scale[i] > 0))
			c->scale[i] = 1;
}

/* What a period is off by, in units of the scale */
static double period_of_trial(struct course_of_mover *c)
{
	int n = c->m->states;
	double off = 0;
	memset(c->scale, 0, sizeof(double) * (size_t)n);
	memcpy(c->end, c->trial, sizeof(double) * (size_t)n);
	mover_period(c->m, c->end, c->M, c->scale);
	complete_scale(c);
	for (int i = 0; i < n; i++)
		off = larger(off, (c->end[i] - c->trial[i]) / c->scale[i]);
	return off;
}

/* From y; true: y is where a stable motion near it starts, and the integrals are of it. While nothing is crossed all is
 * linear: what is off only decays, and may be large. */
static bool find_near(struct course_of_mover *c)
{
	int n = c->m->states;
	SCRATCH double *d = ARRAY(double, n);
	double moved = 0;
	bool found = false, leapt = false;
	memcpy(c->trial, c->y, sizeof(double) * (size_t)n);
	for (int k = 0; k < STEPS; k++) {
		double off = period_of_trial(c);
		if (off <= settled || (k == STEPS - 1 && off <= 1e3 * settled)) {
			found = spectral_radius(c->m->states, c->M) < 1 + 1e-4 && !(leapt && c->m->crossings > 0);
			break;
		}
		double by = newton_step(c, d);
		if (leapt && c->m->crossings > 0)
			break;
		if (c->m->crossings == 0 && by >= near)
			leapt = true;
		else
			moved += by;
		if (!(moved < near))
			break;
		for (int i = 0; i < n; i++)
			c->trial[i] += d[i];
	}
	if (found)
		memcpy(c->y, c->trial, sizeof(double) * (size_t)n);
	return found;
}

/* Integrals that are means over so many periods */
static void take_means(struct course_of_mover *c)
{
	int n = c->m->states;
	SCRATCH double *sum = ARRAY(double, 2 * (size_t)n);
	for (int k = 0; k < MEANS; k++) {
		mover_period(c->m, c->y, NULL, c->scale);
		for (int i = 0; i < 2 * n; i++)
			sum[i] += c->m->integral[i / n][i % n] / MEANS;
	}
	for (int i = 0; i < 2 * n; i++)
		c->m->integral[i / n][i % n] = sum[i];
}

/* At the frequency that the mover is tuned to, in time */
static void approach(struct course_of_mover *c)
{
	c->repeats = false;
	for (int round = 0, periods = 4; !c->repeats && round < ROUNDS; round++) {
		for (int k = 0; k < periods; k++)
			mover_period(c->m, c->y, NULL, NULL);
		periods += periods / 2;
		c->repeats = find_near(c);
	}
	if (!c->repeats)
		take_means(c);
}

/* From one frequency [Hz] to another; 0: from the start. The motion is followed by smaller steps where it is lost, to
 * tell a jump from a step that is too long. */
static void follow(struct course_of_mover *c, double from, double to, int halvings)
{
	bool repeated = c->repeats;
	mover_tune(c->m, two_pi * to);
	c->repeats = find_near(c);
	if (c->repeats)
		return;
	if (from > 0 && repeated && halvings > 0) {
		c->repeats = true;
		follow(c, from, sqrt(from * to), halvings - 1);
		follow(c, sqrt(from * to), to, halvings - 1);
	} else {
		approach(c);
	}
}

/* ---- over a band ---- */

struct sweeping {
	const struct model *model;
	struct sweeps *to;
	int movers;
	struct course_of_mover *course;
	double *harmonic[2];            /* per state of the model: of e^{iwt}, over the amplitude */
};

static void start(struct sweeping *s, const struct drive *drive, double amplitude)
{
	struct mover *list;
	s->movers = movers_of(s->model, drive, &list);
	for (int p = 0; p < s->movers; p++)
		if (!(2 * list[p].rate / s->to->band.from < LIMIT_SAMPLES))
			error(s->model->request.at.step, "a higher frequency to start from is swept sooner",
			      "a period at %g Hz takes more than %d samples to follow the fastest pole of a region",
			      s->to->band.from, LIMIT_SAMPLES);
	s->course = ARRAY(struct course_of_mover, s->movers);
	for (int p = 0; p < s->movers; p++) {
		struct course_of_mover *c = &s->course[p];
		size_t n = (size_t)list[p].states;
		*c = (struct course_of_mover){ &list[p], ARRAY(double, n), ARRAY(double, n), ARRAY(double, n),
			ARRAY(double, n), ARRAY(double, n * n), true };
		c->m->amplitude = amplitude;
		for (size_t i = 0; i < n; i++)
			c->y[i] = mpq_get_d(s->model->initial[c->m->place ? c->m->place[i] : (int)i]);
	}
	for (int k = 0; k < 2; k++)
		s->harmonic[k] = ARRAY(double, s->model->system.states);
}

/* False: some part does not repeat */
static bool all_follow(struct sweeping *s, double from, double hertz)
{
	bool all = true;
	for (int p = 0; p < s->movers; p++) {
		struct mover *m = s->course[p].m;
		follow(&s->course[p], from, hertz, HALVINGS);
		all = all && s->course[p].repeats;
		for (int i = 0; i < m->states; i++)
			for (int k = 0; k < 2; k++)
				s->harmonic[k][m->place ? m->place[i] : i] =
					m->integral[k][i] * 2 / (m->period * m->amplitude);
	}
	return all;
}

/* One row of one direction: sizes and angles, these as near to those before as whole turns let them be */
static void take_row(struct sweeping *s, const struct swept *of, double hertz, double *size, double *angle,
		     const double *before)
{
	int states = s->model->system.states;
	double sums[2] = { of->over[states], of->over[states + 1] * two_pi * hertz };
	for (int k = 0; k < 2; k++)
		for (int i = 0; i < states; i++)
			sums[k] += of->over[i] * s->harmonic[k][i];
	*size = hypot(sums[0], sums[1]);
	*angle = *size > 0 ? atan2(sums[1], sums[0]) * (360 / two_pi) : 0;
	*angle = *angle == 180 ? -180 : *angle;
	if (before)
		*angle += 360 * rint((*before - *angle) / 360);
}

static void sweep_drive(struct sweeping *s, int first, int last)
{
	struct sweeps *to = s->to;
	int rows = to->band.count;
	const double *before = NULL;
	double from = 0;
	for (int k = 0; k < 2 * rows; k++) {
		int down = k >= rows, row = down ? 2 * rows - 1 - k : k;
		double hertz = frequency_of(&to->band, row);
		progress("row of a sweep", k, 2 * rows);
		if (k != rows)          /* down starts where up ended */
			to->unsettled += !all_follow(s, from, hertz);
		for (int i = first; i < last; i++) {
			int at = row * to->count + i;
			take_row(s, &to->of[i], hertz, &to->size[down][at], &to->angle[down][at],
				 before ? before + i - first : NULL);
		}
		before = to->angle[down] + row * to->count + first;
		from = hertz;
	}
	progress_end();
}

static bool is_steady(const struct model *model, const struct drive *drive)
{
	int column = drive->column;
	for (int l = 0; l < drive->load; l++)
		column += model->system.load[l].columns;
	return drive->input < 0 && is_constant_column(&model->system, column);
}

/* At the first term that is not linear, or at the scheme that was asked for all the same */
static _Noreturn void report_remainder(const struct model *model)
{
	static const char *const way = "plrun runs any model, with a record that sweeps";
	const struct node *other = model->nonlinear.obstacle;
	if (other)
		error(other->start, way, "--amplitude is of models that are linear between breakpoints: '%s' is not",
		      text_between(other->start, other->end));
	error(model->request.at.scheme.source ? model->request.at.scheme : model->request.at.step, way,
	      "--amplitude is of models that are linear between breakpoints, and this has other terms");
}

static bool has_friction(const struct model *model)
{
	bool rubbed = has_dry_friction(model->switching);
	for (int p = 0; p < model->switching->parts; p++)
		rubbed = rubbed || has_dry_friction(model->switching->part[p].model->switching);
	return rubbed;
}

bool can_be_swept(const struct step *step)
{
	const struct model *model = step->shown->model;
	return model->switching && !caches_regions(model) && model->contacts.impacts == 0 && !has_friction(model) &&
	       !loads_change(&model->system) && model->system.states <= LIMIT_SWEPT;
}

static void need_sweeps(const struct step *step)
{
	const struct model *model = step->shown->model;
	if (has_remainder(step))
		report_remainder(model);
	if (!model->switching)
		error(model->request.at.step, "leave --amplitude out",
		      "the model is linear: its frequency response is the same at every amplitude");
	if (model->contacts.impacts > 0 || has_friction(model))
		error(model->request.at.step, "plrun runs any model, with a record that sweeps",
		      "--amplitude is of clearances, without impacts and dry friction");
	if (loads_change(&model->system))
		error(model->request.at.step, NULL, "--amplitude is of equations that are the same at all times");
	refuse(CAN_AMPLITUDE, model, model->request.at.step);
	if (model->system.states > LIMIT_SWEPT)
		error(model->request.at.step, NULL, "the model has %d states: sweeps are limited to %d",
		      model->system.states, LIMIT_SWEPT);
}

static int columns_of(const struct model *model, int drives, const struct drive *drive, struct sweeps *s)
{
	s->of = ARRAY(struct swept, (size_t)(drives * model->outputs) + 1);
	s->count = 0;
	for (int d = 0; d < drives; d++)
		for (int i = 0; i < model->outputs && !is_steady(model, &drive[d]); i++)
			if (is_reported(&model->output[i]))
				s->of[s->count++] = (struct swept){ model->output[i].name, drive[d].name, d,
								    output_over(model, i, &drive[d]) };
	return s->count;
}

struct sweeps sweeps_of(const struct step *step, struct band band, double amplitude)
{
	const struct model *model = step->shown->model;
	struct sweeps s = { .band = band };
	struct drive *drive;
	need_sweeps(step);
	int drives = drives_of(model, &drive);
	if (columns_of(model, drives, drive, &s) == 0)
		error(model->request.at.step, "input u, and u in an equation",
		      "there is no input and no changing load that an output linear in states could respond to");
	for (int k = 0; k < 2; k++) {
		s.size[k] = ARRAY(double, (size_t)band.count * (size_t)s.count);
		s.angle[k] = ARRAY(double, (size_t)band.count * (size_t)s.count);
	}
	for (int first = 0, last; first < s.count; first = last) {
		struct sweeping sweeping = { .model = model, .to = &s };
		for (last = first; last < s.count && s.of[last].drive_index == s.of[first].drive_index; last++)
			;
		start(&sweeping, &drive[s.of[first].drive_index], amplitude);
		sweep_drive(&sweeping, first, last);
	}
	if (s.unsettled)
		fprintf(stderr, "plgen: note: at %d of %d frequencies the motion does not repeat with the excitation: "
				"means over %d of its periods\n", s.unsettled, s.count ? 2 * band.count - 1 : 0, MEANS);
	return s;
}
