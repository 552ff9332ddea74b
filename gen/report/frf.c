/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frequency responses N(jw)/B(jw) of linear models as numbers: each is enclosed, and rounded once. */
#include "report/report.h"
#include "step/linear/images.h"

#include <math.h>
#include <string.h>

/* From a decade below the lowest that is not 0 to one above the highest, at whole decades' tenths; without any: 0.1 to
 * 10 Hz */
struct band band_of_poles(int count, const struct pole_report *pole, int rows)
{
	double low = 0, high = 0;
	for (int i = 0; i < count; i++) {
		double hertz = mpfr_get_d(pole[i].hertz, MPFR_RNDN);
		if (hertz > 0 && isfinite(hertz)) {
			low = low == 0 || hertz < low ? hertz : low;
			high = hertz > high ? hertz : high;
		}
	}
	if (low == 0)
		low = high = 1;
	double down = pow(10, floor(log10(low))), up = pow(10, floor(log10(high)));
	return (struct band){ floor(low / down) * down / 10, ceil(high / up) * up * 10, rows };
}

/* ---- the numbers ---- */

static void need_transfers(const struct model *model)
{
	struct drive *drive;
	if (model->system.states > LIMIT_TRANSFERS)
		error(model->request.at.step, "--reduce or --modes makes it smaller",
		      "the model has %d states: frequency responses are limited to %d", model->system.states,
		      LIMIT_TRANSFERS);
	if (drives_of(model, &drive) == 0)
		error(model->request.at.step, "input u, and u in an equation",
		      "there is no input and no load that an output could respond to");
}

/* Over each input alone: what it does some time later is added to what it does at once */
static void join_delays(const struct model *model, struct responses *r)
{
	const struct delays *delays = model->delays;
	int count = 0;
	struct transfer *all = r->transfer;
	for (int k = 0; k < r->count; k++) {
		const int late = all[k].input - delays->inputs;
		int of = k;
		mpq_init(all[k].delay);
		if (late >= 0) {
			const struct delay *d = &delays->delay[late];
			mpq_set_si(all[k].delay, d->back, 1);
			mpq_mul(all[k].delay, all[k].delay, model->h);
			for (of = 0; all[of].input != d->symbol->delayed->index ||
			     strcmp(all[of].output, all[k].output) != 0; of++)
				;
		}
		if (of == k || all[k].N.length == 0)
			continue;
		all[k].earlier = all[of].earlier;
		all[of].earlier = &all[k];
	}
	r->transfer = ARRAY(struct transfer, (size_t)r->count + 1);
	for (int k = 0; k < r->count; k++)
		if (all[k].input < delays->inputs)
			r->transfer[count++] = all[k];
	r->count = count;
}

/* With the turns from frequency 0 on; of a sum, which has no end of zeros, as it is */
static struct angle_course course_of(const struct model *model, const struct transfer *t)
{
	return t->earlier ? (struct angle_course){ 0 } : angle_course_of(model, t);
}

struct responses responses_of(const struct step *step, struct band band)
{
	const struct model *model = step->shown->model;
	need_linear(step, "frequency responses");
	need_transfers(model);
	struct responses r = { .band = band };
	r.count = transfers_of(resolvent_of(&model->system), model, &r.transfer);
	if (model->delays)
		join_delays(model, &r);
	r.size = ARRAY(double, (size_t)band.count * (size_t)r.count + 1);
	r.angle = ARRAY(double, (size_t)band.count * (size_t)r.count + 1);
	for (int k = 0; k < r.count; k++) {
		struct angle_course course = course_of(model, &r.transfer[k]);
		progress("frequency response", k, r.count);
		for (int row = 0; row < band.count; row++) {
			double f = frequency_of(&band, row), angle;
			transfer_at(&r.transfer[k], f, &r.size[row * r.count + k], &angle);
			r.angle[row * r.count + k] =
				r.transfer[k].earlier ? angle : angle_on_course(&course, f, angle);
		}
	}
	progress_end();
	return r;
}

void print_rows(FILE *to, const struct band *band, int count, int ways, double *const *size, double *const *angle,
		char between)
{
	const int digits = ways > 1 ? 12 : 17;
	for (int row = 0; row < band->count; row++) {
		fprintf(to, "%.17g", frequency_of(band, row));
		for (int k = row * count; k < (row + 1) * count; k++)
			for (int w = 0; w < ways; w++)
				fprintf(to, "%c%.*g%c%.*g", between, digits, size[w][k], between, digits, angle[w][k]);
		fputc('\n', to);
	}
}

static void print_sweeps(FILE *to, const struct step *step, struct band band, double amplitude)
{
	static const char *const way[2] = { "up", "down" };
	struct sweeps s = sweeps_of(step, band, amplitude);
	fputs("f", to);
	for (int k = 0; k < s.count; k++)
		for (int w = 0; w < 2; w++)
			fprintf(to, ",%s/%s mag %s,%s/%s phase %s", s.of[k].output, s.of[k].drive, way[w],
				s.of[k].output, s.of[k].drive, way[w]);
	fputc('\n', to);
	print_rows(to, &band, s.count, 2, s.size, s.angle, ',');
}

void print_response(FILE *to, const struct step *step, const char *band, const char *amplitude)
{
	if (amplitude) {
		print_sweeps(to, step, band_of(band), amplitude_of(amplitude));
		return;
	}
	struct responses r = responses_of(step, band_of(band));
	fputs("f", to);
	for (int k = 0; k < r.count; k++)
		fprintf(to, ",%s/%s mag,%s/%s phase", r.transfer[k].output, r.transfer[k].drive, r.transfer[k].output,
			r.transfer[k].drive);
	fputc('\n', to);
	print_rows(to, &r.band, r.count, 1, &r.size, &r.angle, ',');
}
