/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What --explain says of the linear part beside its matrices and poles: mode shapes, zeros, static gains, and the
 * state space x' = A x + B u, y = C x + D u: u are the inputs, then the loads, each with its function of time taken as
 * u. */
#include "report/report.h"
#include "step/linear/images.h"

#include <math.h>

/* ---- state space ---- */

struct space {
	const struct model *model;
	int states, drives, outputs;    /* outputs: those that are reported */
	struct drive *drive;
	int *output;
	bool slopes;                    /* an input's u' acts: B1 u', D1 u' beside */
	mpq_t *A, *B, *B1, *C, *D, *D1; /* row-major; drives are columns of B and D */
};

static const mpq_t *force_of(const struct space *s, int drive, bool slope)
{
	const struct linear *system = &s->model->system;
	const struct drive *d = &s->drive[drive];
	if (d->input >= 0)
		return system->input[d->input].force[slope];
	return slope ? NULL : system->load[d->load].force[d->column] + d->segment * system->n;
}

/* Column `drive` of B */
static void fill_column(const struct space *s, const mpq_t *inverse, const mpq_t *force, int drive, mpq_t *B)
{
	RATIONALS *slopes = slopes_by_force(&s->model->system, inverse, force);
	for (int i = 0; i < s->states; i++)
		mpq_swap(B[i * s->drives + drive], slopes[i]);
}

static void fill_inputs(struct space *s)
{
	RATIONALS *inverse = inverse_of_leading(&s->model->system);
	for (int d = 0; d < s->drives; d++) {
		fill_column(s, inverse, force_of(s, d, false), d, s->B);
		const mpq_t *slope = force_of(s, d, true);
		s->slopes = s->slopes || (slope && !rationals_zero((size_t)s->model->n, slope));
		if (slope)
			fill_column(s, inverse, slope, d, s->B1);
	}
}

static void fill_outputs(struct space *s)
{
	int segments = s->model->system.segments;
	for (int i = 0; i < s->outputs; i++) {
		const struct output *output = &s->model->output[s->output[i]];
		for (int j = 0; j < s->states; j++)
			mpq_set(s->C[i * s->states + j], output->state[j]);
		for (int d = 0; d < s->drives; d++) {
			const struct drive *drive = &s->drive[d];
			mpq_set(s->D[i * s->drives + d],
				drive->input >= 0 ? output->input[0][drive->input]
						  : output->load[drive->load][drive->column * segments +
									      drive->segment]);
			if (drive->input < 0)
				continue;
			mpq_set(s->D1[i * s->drives + d], output->input[1][drive->input]);
			s->slopes = s->slopes || mpq_sgn(output->input[1][drive->input]) != 0;
		}
	}
}

static struct space space_of(const struct model *model)
{
	struct space s = { .model = model, .states = model->system.states };
	s.drives = drives_of(model, &s.drive);
	s.output = ARRAY(int, model->outputs + 1);
	for (int i = 0; i < model->outputs; i++)
		if (is_reported(&model->output[i]))
			s.output[s.outputs++] = i;
	size_t states = (size_t)s.states, drives = (size_t)s.drives, outputs = (size_t)s.outputs;
	s.A = state_matrix(&model->system, false);
	s.B = rationals(states * drives);
	s.B1 = rationals(states * drives);
	s.C = rationals(outputs * states);
	s.D = rationals(outputs * drives);
	s.D1 = rationals(outputs * drives);
	fill_inputs(&s);
	fill_outputs(&s);
	return s;
}

/* [A B; 0 0] h has the exponential [Phi Gamma; 0 I]: u held over h (Van Loan 1978). Errors are below 2^-100 of the
 * largest entry; NULL: it could not be found. (states + drives) squared */
static double *held_matrix(const struct space *s)
{
	int size = s->states + s->drives;
	RATIONALS *full = rationals((size_t)(size * size));
	double *held = ARRAY(double, (size_t)(size * size));
	for (int i = 0; i < s->states; i++)
		for (int j = 0; j < size; j++)
			mpq_set(full[i * size + j], j < s->states ? s->A[i * s->states + j]
								   : s->B[i * s->drives + j - s->states]);
	struct taylor *t = taylor_of(size, full, s->model->h);
	if (!taylor_enclose(t, 128))
		return NULL;
	INTERVAL value = OVER_BITS(192);
	RATIONAL exact = ZERO;
	for (int i = 0; i < size * size; i++) {
		taylor_entry(t, i / size, i % size, value);
		held[i] = taylor_exact(t, i / size, i % size, exact) ? nearest_double(exact) : mpfi_get_d(value);
	}
	return held;
}

/* ---- JSON ---- */

static void json_exact(FILE *to, const char *key, int rows, int columns, mpq_t *value)
{
	fputs(",\n    ", to);
	json_rationals(to, "      ", key, rows, columns, (const mpq_t *)value);
}

static void json_discrete(FILE *to, const struct space *s)
{
	double *held = s->slopes || s->model->system.states > LIMIT_HELD_STATES ? NULL : held_matrix(s);
	int size = s->states + s->drives;
	if (!held) {
		fputs(",\n        \"discrete\": null},\n", to);
		return;
	}
	fprintf(to, ",\n        \"discrete\": {\"h\": %.17g, ", nearest_double(s->model->h));
	json_matrix(to, "      ", "A", s->states, s->states, size, held);
	fputs(",\n     ", to);
	json_matrix(to, "      ", "B", s->states, s->drives, size, held + s->states);
	fputs(",\n     ", to);
	json_rationals(to, "      ", "C", s->outputs, s->states, (const mpq_t *)s->C);
	fputs(",\n     ", to);
	json_rationals(to, "      ", "D", s->outputs, s->drives, (const mpq_t *)s->D);
	fputs("}},\n", to);
}

/* Inputs that are another one as it was some time ago [s] */
static void json_delays(FILE *to, const struct model *model)
{
	const struct delays *delays = model->delays;
	RATIONAL delay = ZERO;
	fputs(", \"delays\": [", to);
	for (int i = 0; i < delays->count; i++) {
		mpq_set_si(delay, delays->delay[i].back, 1);
		mpq_mul(delay, delay, model->h);
		fprintf(to, "%s{\"input\": \"%s\", \"of\": \"%s\", \"delay\": %s}", i ? ", " : "",
			delays->delay[i].symbol->name, delays->delay[i].symbol->delayed->name,
			json_number(nearest_double(delay)));
	}
	fputs("]", to);
}

static void json_space(FILE *to, const struct model *model)
{
	struct space s = space_of(model);
	const char **input = ARRAY(const char *, s.drives), **output = ARRAY(const char *, s.outputs);
	for (int d = 0; d < s.drives; d++)
		input[d] = s.drive[d].name;
	for (int i = 0; i < s.outputs; i++)
		output[i] = model->output[s.output[i]].name;
	fputs("  \"ss\": {", to);
	json_names(to, "inputs", s.drives, input);
	fputs(", ", to);
	json_names(to, "outputs", s.outputs, output);
	if (model->delays)
		json_delays(to, model);
	json_exact(to, "A", s.states, s.states, s.A);
	json_exact(to, "B", s.states, s.drives, s.B);
	json_exact(to, "C", s.outputs, s.states, s.C);
	json_exact(to, "D", s.outputs, s.drives, s.D);
	if (s.slopes) {
		json_exact(to, "B_slope", s.states, s.drives, s.B1);
		json_exact(to, "D_slope", s.outputs, s.drives, s.D1);
	}
	json_discrete(to, &s);
}

static void json_shapes(FILE *to, int count, const struct mode_shape *shape, int n)
{
	fputs("  \"shapes\": [", to);
	for (int k = 0; k < count; k++) {
		fprintf(to, "%s\n    {\"pole\": {\"re\": %s, \"im\": %s},\n     \"re\": ", k ? "," : "",
			json_number(mpfr_get_d(shape[k].pole->re, MPFR_RNDN)),
			json_number(mpfr_get_d(shape[k].pole->im, MPFR_RNDN)));
		json_numbers(to, n, shape[k].re);
		fputs(",\n     \"im\": ", to);
		json_numbers(to, n, shape[k].im);
		fputs("}", to);
	}
	fputs("],\n", to);
}

static void json_zero_list(FILE *to, const struct model *model, const struct transfer *t)
{
	struct zero *zero;
	int count = zeros_of_transfer(model, t, &zero);
	bool first = true;
	for (int i = 0; i < count; i++)
		for (int k = 0; k <= zero[i].pair; k++, first = false)
			fprintf(to, "%s{\"re\": %.17g, \"im\": %.17g, \"multiplicity\": %d}", first ? "" : ", ",
				zero[i].re, k ? -zero[i].im : zero[i].im, zero[i].multiplicity);
}

/* Per output over each drive: its static gain, null where a pole is at 0; its zeros, null where it is 0 for all s */
static void json_transfers(FILE *to, const struct model *model, int count, const struct transfer *t)
{
	RATIONAL gain = ZERO;
	fputs("  \"zeros\": [", to);
	for (int k = 0; k < count; k++) {
		fprintf(to, "%s\n    {\"output\": \"%s\", \"input\": \"%s\", \"static_gain\": %s,\n     \"zeros\": ",
			k ? "," : "", t[k].output, t[k].drive,
			static_gain(&t[k], gain) ? json_number(nearest_double(gain)) : "null");
		if (t[k].N.length == 0) {
			fputs("null}", to);
			continue;
		}
		fputc('[', to);
		json_zero_list(to, model, &t[k]);
		fputs("]}", to);
	}
	fputs("],\n", to);
}

int shapes_of_step(const struct step *step, struct mode_shape **shape, const struct model **of)
{
	const struct model *model = step->shown->model;
	struct pole_report *pole;
	*of = model->reduction.truncated ? model : model->written;     /* that the poles are of */
	int count = poles_of(step->model, step->written, &pole);
	return shapes_of(&(*of)->system, count, pole, shape);
}

static int transfers_of_step(const struct step *step, struct transfer **t)
{
	const struct model *model = step->shown->model;
	struct drive *drive;
	if (model->system.states > LIMIT_TRANSFERS || drives_of(model, &drive) == 0)
		return 0;
	return transfers_of(resolvent_of(&model->system), model, t);
}

void json_linear(FILE *to, const struct step *step)
{
	const struct model *of;
	struct mode_shape *shape;
	struct transfer *transfer;
	int shapes = shapes_of_step(step, &shape, &of);
	json_shapes(to, shapes, shape, of->system.n);
	int transfers = transfers_of_step(step, &transfer);
	json_transfers(to, step->shown->model, transfers, transfer);
	json_space(to, step->shown->model);
}

/* ---- for a person ---- */

const char *zeros_text(const struct model *model, const struct transfer *t)
{
	struct zero *zero;
	int count = t->N.length ? zeros_of_transfer(model, t, &zero) : 0;
	const char *text = "";
	for (int i = 0; i < count; i++) {
		text = format("%s%s%.8g", text, *text ? ", " : "", zero[i].re);
		if (zero[i].pair)
			text = format("%s +- %.8g i", text, zero[i].im);
		if (zero[i].multiplicity > 1)
			text = format("%s (%d-fold)", text, zero[i].multiplicity);
	}
	return t->N.length == 0 ? "does not react" : *text ? text : "none";
}

const char *static_gain_text(const struct transfer *t)
{
	RATIONAL gain = ZERO;
	return static_gain(t, gain) ? format("%.8g", nearest_double(gain)) : "infinite";
}

static void text_shapes(FILE *to, const struct model *of, int count, const struct mode_shape *shape)
{
	const struct linear *system = &of->system;
	fputs("\nMode shapes, the largest entry of each 1:\n", to);
	for (int k = 0; k < count; k++) {
		fprintf(to, "    %.8g Hz:", mpfr_get_d(shape[k].pole->hertz, MPFR_RNDN));
		for (int i = 0; i < system->n; i++) {
			fprintf(to, "%s %s %.6g", i ? "," : "", of->names.coord[i], shape[k].re[i]);
			if (shape[k].im[i] != 0)
				fprintf(to, " %c %.6g i", shape[k].im[i] < 0 ? '-' : '+', fabs(shape[k].im[i]));
		}
		fputc('\n', to);
	}
}

static void text_transfers(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	struct transfer *t;
	struct drive *drive;
	int drives = drives_of(model, &drive), count = transfers_of_step(step, &t);
	if (drives && model->system.states > LIMIT_TRANSFERS)
		fprintf(to, "\nStatic gains and zeros are reported up to %d states.\n", LIMIT_TRANSFERS);
	if (count)
		fprintf(to, "\n    %-36s %-16s zeros [1/s]\n", "output over input or load", "static gain");
	for (int k = 0; k < count; k++)
		fprintf(to, "    %-36s %-16s %s\n", format("%s / %s", t[k].output, t[k].drive), static_gain_text(&t[k]),
			zeros_text(model, &t[k]));
}

void text_linear(FILE *to, const struct step *step)
{
	const struct model *of;
	struct mode_shape *shape;
	int count = shapes_of_step(step, &shape, &of);
	if (of->system.n > LIMIT_SHAPES)
		fprintf(to, "\nMode shapes are reported up to %d coordinates.\n", LIMIT_SHAPES);
	else
		text_shapes(to, of, count, shape);
	text_transfers(to, step);
}
