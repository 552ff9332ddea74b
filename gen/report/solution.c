/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The closed-form solution as CSV: every value is its own residue sum, correctly rounded; nothing is stepped. That of a
 * piecewise-linear model goes from crossing to crossing. */
#include "model/regions/switching_functions.h"
#include "model/regions/regions.h"
#include "report/report.h"
#include "step/linear/images.h"
#include "step/certify/certify.h"

#include <math.h>
#include <string.h>

static void check_outputs(const struct model *model)
{
	refuse(CAN_SOLUTION, model, model->request.at.end);
	for (int j = 0; j < model->outputs; j++)
		if (!model->output[j].form && model->output[j].value)
			error(model->output[j].value->start,
			      "--solution prints outputs that are linear in states and loads",
			      "output '%s' has no closed form", model->output[j].name);
	for (int j = 0; j < model->outputs; j++)
		/* the rate of what a stop, friction or another piecewise linear term acts on */
		if (model->switching &&
		    !rationals_zero((size_t)model->remainder.force_columns, model->output[j].force_column))
			error(model->output[j].value ? model->output[j].value->start : model->request.at.end,
			      "positions, velocities and loads have one formula in all of them",
			      "output '%s' has another formula in each region, which --solution does not print",
			      model->output[j].name);
}

static unsigned long last_step(const struct model *model, mpq_srcptr end)
{
	RATIONAL steps = ZERO;
	INTEGER last = INTEGER_ZERO;
	mpq_div(steps, end, model->h);
	mpz_fdiv_q(last, mpq_numref(steps), mpq_denref(steps));
	if (mpz_cmp_ui(last, LIMIT_ROWS) >= 0)
		error(model->request.at.end, NULL, "--solution would print more rows than the limit of %d", LIMIT_ROWS);
	unsigned long rows = mpz_get_ui(last);
	return rows;
}

struct closed_form {                /* of one output */
	int count;
	struct started *list;
};

/* What a step finds has no formula. */
static void check_peaks_of(const struct model *model)
{
	for (int i = 0; i < model->outputs; i++)
		if (model->output[i].peak)
			error(model->output[i].value->start, "a step finds it", "the peak of '%s' has no closed form",
			      model->output[i].name);
}

/* ---- through crossings ---- */

enum { FEWEST_BITS = 192, MOST_BITS = 6144 };

struct printing {
	FILE *to;
	const struct model *model;
	unsigned long last, rows;   /* steps; those printed */
	int passed;                 /* likewise of crossings */
	double *largest;            /* per output */
	const char *why;            /* of what is not reported: at this precision */
};

/* To the nearest double. What is 0 to 2^-128 of the largest value so far, or to 2^-192, is 0. */
static bool round_value(mpfi_srcptr x, double *largest, double *value)
{
	if (!round_enclosure(x, value)) {
		double most = fmax(fabs(mpfr_get_d(&x->left, MPFR_RNDA)), fabs(mpfr_get_d(&x->right, MPFR_RNDA)));
		if (!mpfi_has_zero(x) || most > ldexp(fmax(*largest, 0x1p-64), -128))
			return false;
		*value = 0;
	}
	*largest = fmax(*largest, fabs(*value));
	return true;
}

static bool print_passed(struct printing *p, const struct trajectory *t)
{
	const struct passed *list;
	int count = trajectory_passed(t, &list);
	for (; p->passed < count; p->passed++) {
		const struct passed *now = &list[p->passed];
		double when, latest = 0;
		if (!round_value(now->at, &latest, &when)) {
			p->why = format("a crossing at t = %.12g s is not known to all digits", mpfi_get_d(now->at));
			return false;
		}
		fprintf(p->to, "# t = %.17g: %s passes %s %s\n", when,
			text_of_function(p->model, now->function),
			readable_text(p->model->switching->function[now->function].at[now->breakpoint]),
			now->upward ? "upward" : "downward");
	}
	return true;
}

static bool print_row(struct printing *p, const struct trajectory *t, mpq_srcptr time)
{
	const struct model *model = p->model;
	SCRATCH double *value = ARRAY(double, model->outputs);
	INTERVAL x = OVER_BITS(53);
	for (int j = 0; j < model->outputs; j++) {
		trajectory_value(t, &model->output[j], x);
		if (!round_value(x, &p->largest[j], &value[j])) {
			p->why = format("output '%s' is not known to all digits at t = %s s", model->output[j].name,
					readable_text(time));
			return false;
		}
		if (!isfinite(value[j]))
			error(model->request.at.end, NULL, "output '%s' leaves the range of double at t = %s s",
			      model->output[j].name, readable_text(time));
	}
	fprintf(p->to, "%.17g", nearest_double(time));
	for (int j = 0; j < model->outputs; j++)
		fprintf(p->to, ",%.17g", value[j]);
	fputc('\n', p->to);
	return true;
}

/* What was not decided with fewer bits, with so many; true: all is */
static bool print_with(struct printing *p, int precision)
{
	struct trajectory *t = trajectory_start(p->model, NULL, p->model->initial, precision);
	bool reported = true;
	RATIONAL time = ZERO;
	for (; p->rows <= p->last && reported; p->rows += reported) {
		mpq_set_ui(time, p->rows, 1);
		mpq_mul(time, time, p->model->h);
		progress("row", (int)p->rows, (int)p->last);
		reported = trajectory_reach(t, time);
		if (!reported)
			p->why = trajectory_undecided(t);
		reported = reported && print_passed(p, t) && print_row(p, t, time);
	}
	trajectory_free(t);
	return reported;
}

/* The bits that what was lost so far says all rows take: widths grow where the motion spreads, so that bits go with the
 * time. Where more of them brought no row, twice as many. */
static int more_bits(const struct printing *p, int bits, unsigned long rows_before, int bits_before)
{
	if (bits_before == 0 || p->rows <= rows_before)
		return 2 * bits;
	const double per_row = (bits - bits_before) / (double)(p->rows - rows_before);
	const double all = bits + 1.05 * per_row * (double)(p->last - p->rows) + 16;
	return (int)fmax(1.25 * bits, fmin(all, fmax(MOST_BITS, 2 * bits)));
}

static void print_trajectory(FILE *to, const struct model *model, unsigned long last)
{
	enum { EQUAL = 3 };
	struct printing p = { .to = to, .model = model, .last = last,
			      .largest = ARRAY(double, model->outputs) };
	const char *before = NULL;
	fputc('t', to);
	for (int j = 0; j < model->outputs; j++)
		fprintf(to, ",%s", model->output[j].name);
	fputc('\n', to);
	int equal = 1;                  /* what more bits do not tell apart, may be one */
	int bits_before = 0, next;
	unsigned long rows_before = 0;
	for (int bits = FEWEST_BITS; !print_with(&p, bits); bits = next) {
		next = more_bits(&p, bits, rows_before, bits_before);
		bits_before = bits;
		rows_before = p.rows;
		equal = before && strcmp(before, p.why) == 0 ? equal + 1 : 1;
		before = p.why;
		if (next > MOST_BITS || equal == EQUAL) {
			progress_end();
			error(model->request.at.end, "until then it is known: a shorter --solution prints it", "%s",
			      p.why);
		}
	}
	progress_end();
}

void print_solution(FILE *to, const struct model *model, struct resolvent *written, mpq_srcptr end)
{
	check_outputs(model);
	check_peaks_of(model);
	unsigned long last = last_step(model, end);
	if (model->switching) {
		print_trajectory(to, model, last);
		return;
	}
	check_pole_size(model, written);
	struct closed_form *form = ARRAY(struct closed_form, model->outputs);
	fputc('t', to);
	for (int j = 0; j < model->outputs; j++) {
		form[j].count = responses_of_output(written, &model->system, model->initial,
						    &model->output[j], &form[j].list);
		fprintf(to, ",%s", model->output[j].name);
	}
	fputc('\n', to);
	RATIONAL t = ZERO;
	for (unsigned long k = 0; k <= last; k++) {
		progress("row", (int)k, (int)last);
		fprintf(to, "%.17g", nearest_double(t));
		for (int j = 0; j < model->outputs; j++) {
			struct coefficient value = started_value(form[j].count, form[j].list, t, false,
								 model->request.at.step, model->output[j].name);
			if (!isfinite(value.value))
				error(model->request.at.end, NULL, "output '%s' leaves the range of double at t = %s s",
				      model->output[j].name, readable_text(t));
			fprintf(to, ",%.17g", value.value);
		}
		fputc('\n', to);
		mpq_add(t, t, model->h);
	}
	progress_end();
}
