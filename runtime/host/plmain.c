/* SPDX-License-Identifier: MIT-0 */
/* A driver for hosts: runs one model and writes its outputs as CSV, or as they are.
 *
 *     cc -Iruntime runtime/host/plmain.c model_pl.c runtime/phases.c ... -DMODEL=scs -o m
 *     ./m 30 < inputs.csv > out.csv
 *
 * A model made with --real float is compiled with -DFLOAT too.  Tunable params, and the step, take other values on the
 * command line: ./m 30 k2=60 step=0.005.
 *
 * One row at every step k*h <= T, from t = 0 on: t and the outputs, in as few digits as read back the same.  --raw: the
 * same numbers as binary in the machine's order of bytes, doubles or with -DFLOAT floats, without the line of names.
 *
 * A model with inputs reads a record of them from standard input: rows
 * of as many numbers as inputs, separated by commas; a first line that gives the inputs' names may precede them.  Row
 * k, the first being row 0, is the sample at k h: of an input that is held it acts from k h to (k + 1) h, one with
 * `hold first` goes straight from it to row k + 1.  So n steps take n rows, and where an input is a ramp n + 1. A run
 * that leaves the finite numbers ends there, with exit status 1 and the rows before it written. */
#include "plrt.h"
#include "digits.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef MODEL
#error "say which model to drive: -DMODEL=NAME, with the name that the generated code bears"
#endif
#define JOIN(a, b) a##b
#define DESCRIPTOR(name) JOIN(name, _model)

#ifdef FLOAT
typedef float real;
typedef pl_modelf descriptor;
enum { PLACES = 6, BITS = 24 };
#else
typedef double real;
typedef pl_model descriptor;
enum { PLACES = 15, BITS = 53 };
#endif

extern const descriptor DESCRIPTOR(MODEL);

static const descriptor *const model = &DESCRIPTOR(MODEL);

/* The linker does not see types: a descriptor of the other one has `real_size` in the same place, and its name. */
static void check_type(void)
{
	if (model->version != PL_MODEL_VERSION) {
		fprintf(stderr, "plmain: error: the model was compiled with a plrt.h whose descriptors have version "
			"%d, and "
						"plmain.c with one of version %d\n", model->version, PL_MODEL_VERSION);
		exit(2);
	}
	if (model->real_size == (int)sizeof(real))
		return;
	fprintf(stderr, "%s: error: plmain.c was compiled %s -DFLOAT, and the model is in %s\n", model->name,
			sizeof(real) == sizeof(float) ? "with" : "without",
			model->real_size == (int)sizeof(float) ? "float" : "double");
	fprintf(stderr, "note: -DFLOAT is for models made with --real float, and for no others\n");
	exit(2);
}

static void fail(const char *what)
{
	fprintf(stderr, "%s: error: %s\n", model->name, what);
	exit(1);
}

static void *need(void *memory)
{
	if (memory == NULL)
		fail("out of memory");
	return memory;
}

static void fail_write(void)
{
	fprintf(stderr, "%s: error: cannot write to standard output", model->name);
	if (errno != 0)
		fprintf(stderr, ": %s", strerror(errno));
	fprintf(stderr, "\n");
	exit(1);
}

/* ---- numbers as text ---- */

enum { LONGEST = 26 }; /* characters of a number, its sign and a comma */

/* In as few digits as read back the same, -0 as 0; returns the end, no NUL */
static char *put_shortest(char *to, real value)
{
	if (value - value != 0)
		return to + sprintf(to, "%g", (double)value);
	if (value < 0) {
		*to++ = '-';
		value = -value;
	} else if (value == 0) {
		value = 0; /* not -0 */
	}
	return digits_text(to, digits_shortest((double)value, sizeof value == sizeof(float)), PLACES);
}

static void print_shortest(FILE *to, real value)
{
	char text[LONGEST];
	fwrite(text, 1, (size_t)(put_shortest(text, value) - text), to);
}

/* ---- the samples on standard input ---- */

typedef struct samples {
	char *line; /* without its end, NUL-terminated; `room` bytes */
	size_t room, length;
	unsigned long number; /* of the line, from 1 */
	int again;            /* this line was read ahead and is to be read once more */
} samples;

static void bad_input(const samples *in, size_t column, const char *what)
{
	fprintf(stderr, "<stdin>:%lu:%lu: error: %s\n", in->number, (unsigned long)column + 1, what);
	if (in->length != 0)
		fprintf(stderr, "%s\n%*s^\n", in->line, column < 10000 ? (int)column : 0, "");
	exit(1);
}

/* The most samples that an input has had when the first step comes; without ramps and the like 0 */
static int most_ahead(void)
{
	int most = 0, i;
	for (i = 0; i < model->inputs; i++)
		if (model->start_samples[i] > most)
			most = model->start_samples[i];
	return most;
}

/* What `steps` steps take */
static uint64_t rows_for(uint64_t steps)
{
	return steps + (uint64_t)most_ahead();
}

static void too_few(const samples *in, uint64_t row, uint64_t steps, double h)
{
	const uint64_t rows = rows_for(steps);
	const char *const ramps = most_ahead() == 0  ? ""
					  : most_ahead() > 1 ? ": an input goes through samples behind the step's end"
						  : ": a ramp starts at row 0, of t = 0, and ends a step at the next";
	fprintf(stderr,
			"<stdin>:%lu:1: error: too few samples: expected row %.0f, of t = %.6g, found the end of the "
				"file\n",
			in->number, (double)row, (double)row * h);
	if (rows == 1)
		fprintf(stderr, "note: 1 step takes row 0%s\n", ramps);
	else
		fprintf(stderr, "note: %.0f step%s rows 0 to %.0f%s\n", (double)steps, steps == 1 ? " takes" : "s take",
				(double)(rows - 1), ramps);
	exit(1);
}

static int next_line(samples *in)
{
	int c;
	if (in->again) {
		in->again = 0;
		return 1;
	}
	in->length = 0;
	in->number++;
	while ((c = getchar()) != EOF && c != '\n') {
		if (in->length + 2 > in->room) {
			in->room *= 2;
			in->line = (char *)need(realloc(in->line, in->room));
		}
		in->line[in->length++] = (char)c;
	}
	if (ferror(stdin))
		fail("cannot read standard input");
	if (in->length != 0 && in->line[in->length - 1] == '\r')
		in->length--;
	in->line[in->length] = '\0';
	return c != EOF || in->length != 0;
}

static const char *skip_blanks(const char *p)
{
	while (*p == ' ' || *p == '\t')
		p++;
	return p;
}

/* What must follow column i. */
static char separator(int i)
{
	return i + 1 < model->inputs ? ',' : '\0';
}

/* A first line that starts as a name does gives the names, in the model's order; else it is the first sample. */
static void read_header(samples *in)
{
	const char *p;
	int i;
	if (!next_line(in))
		bad_input(in, 0, "expected samples of the inputs, found the end of the file");
	p = skip_blanks(in->line);
	if (*p != '_' && !(*p >= 'A' && *p <= 'Z') && !(*p >= 'a' && *p <= 'z')) {
		in->again = 1;
		return;
	}
	for (i = 0; i < model->inputs; i++) {
		const char *const name = skip_blanks(p), *const expected = model->input_names[i];
		p = skip_blanks(name + strcspn(name, " \t,"));
		if (strncmp(name, expected, strlen(expected)) != 0 || strcspn(name, " \t,") != strlen(expected)
			|| *p != separator(i)) {
			fprintf(stderr, "<stdin>:%lu:%lu: error: expected the input '%s'%s\n%s\n", in->number,
					(unsigned long)(name - in->line) + 1, expected,
					separator(i) ? " and a ','" : " and the end of the line", in->line);
			exit(1);
		}
		p += *p == ',';
	}
}

/* 0: there is no row left */
static int read_sample(samples *in, real *u)
{
	const char *p;
	char *end;
	int i;
	if (!next_line(in))
		return 0;
	p = in->line;
	for (i = 0; i < model->inputs; i++) {
		p = skip_blanks(p);
		u[i] = (real)digits_read(p, &end);
		if (end == p)
			bad_input(in, (size_t)(p - in->line), "expected a number");
		if (u[i] - u[i] != 0)
			bad_input(in, (size_t)(p - in->line), "expected a finite number");
		p = skip_blanks(end);
		if (*p != separator(i))
			bad_input(in, (size_t)(p - in->line),
					  separator(i) ? "expected ',': one column for each input" : "expected the "
						"end of the line");
		p += *p == ',';
	}
	return 1;
}

/* ---- the run ---- */

static void print_header(void)
{
	int i;
	printf("t");
	for (i = 0; i < model->outputs; i++)
		printf(",%s", model->output_names[i]);
	printf("\n");
}

/* t and the outputs, and their text */
typedef struct row {
	real *value;
	char *text;
	int raw;
} row;

static row new_row(int raw)
{
	const size_t columns = (size_t)model->outputs + 1;
	row r;
	r.value = (real *)need(malloc(columns * sizeof *r.value));
	r.text = (char *)need(malloc(columns * LONGEST));
	r.raw = raw;
	return r;
}

static void write_row(const row *r, const void *state)
{
	size_t written, length;
	char *end = r->text;
	int i;
	r->value[0] = model->time(state);
	model->out(state, r->value + 1);
	if (r->raw) {
		length = (size_t)(model->outputs + 1) * sizeof *r->value;
		written = fwrite(r->value, 1, length, stdout);
	} else {
		for (i = 0; i <= model->outputs; i++) {
			end = put_shortest(end, r->value[i]);
			*end++ = i < model->outputs ? ',' : '\n';
		}
		length = (size_t)(end - r->text);
		written = fwrite(r->text, 1, length, stdout);
	}
	if (written != length)
		fail_write();
}

/* After a step: what a model has a status for ends the run, at the time that the step led to. */
static void check_status(const void *state)
{
	const int status = model->status != NULL ? model->status(state) : 0;
	if (status == 0)
		return;
	if (fflush(stdout) != 0)
		fail_write();
	fprintf(stderr, "%s: error: t = ", model->name);
	print_shortest(stderr, model->time(state));
	fprintf(stderr, ":");
	if (status & PL_TOO_MANY_EVENTS)
		fprintf(stderr, " the step has met more crossings, or needed a longer search for them, than its "
			"bound%s",
				status & PL_NOT_FINITE ? ";" : "");
	if (status & PL_NOT_FINITE)
		fprintf(stderr, " the step has left the finite numbers");
	if (status & PL_TOO_MANY_STEPS)
		fprintf(stderr, " the step needed more substeps than its bound");
	if (status & PL_INACCURATE)
		fprintf(stderr, " the last terms of the step are above the tolerance");
	if (status & PL_UNDECIDED)
		fprintf(stderr, " no combination of stick and slip was valid at an event");
	if (status & PL_PENETRATED)
		fprintf(stderr, " the step has ended beyond a stop");
	if (status & PL_SINGULAR_MASS)
		fprintf(stderr, " the mass matrix is singular, or gradients of constraints depend on each other");
	if (status & PL_LEFT_RANGE)
		fprintf(stderr, " a state has left the range that the spec gives it");
	if (status & ~(PL_UNDECIDED | PL_TOO_MANY_EVENTS | PL_NOT_FINITE | PL_TOO_MANY_STEPS | PL_INACCURATE |
				   PL_LEFT_RANGE | PL_PENETRATED | PL_SINGULAR_MASS))
		fprintf(stderr, " status %d", status);
	fprintf(stderr, "\n");
	exit(1);
}

/* The last k with k h <= end.  Since h and the quotient are rounded, what is a whole number but for that counts as
 * whole. */
static uint64_t steps_until(double end, double h)
{
	const double steps = end / h;
	if (!(steps < 9007199254740992.0)) {
		fprintf(stderr, "%s: error: T is more than 2^53 steps\n", model->name);
		exit(2);
	}
	return (uint64_t)(steps + 1e-9 + steps * (BITS == 24 ? 0x1p-23 : 0x1p-52));
}

static void usage(const char *program)
{
	int i;
	fprintf(stderr, "usage: %s [--raw] T%s %s> out.csv\n    T: time of the end [s]; the step is ", program,
			model->retune != NULL ? " [NAME=VALUE ...]" : "", model->inputs > 0 ? "< inputs.csv " : "");
	print_shortest(stderr, model->h);
	fprintf(stderr, " s\n");
	for (i = 0; i < model->params; i++) {
		fprintf(stderr, "    %s=", model->param_names[i]);
		print_shortest(stderr, model->param_values[i]);
		fprintf(stderr, "\n");
	}
	if (model->retune != NULL) {
		fprintf(stderr, "    step=");
		print_shortest(stderr, model->h);
		fprintf(stderr, "\n");
	}
	exit(2);
}

static double end_of_run(int argc, char **argv)
{
	char *rest = NULL;
	double end = argc >= 2 ? strtod(argv[1], &rest) : 0.0;
	if (argc < 2 || rest == argv[1] || *rest != '\0' || end - end != 0.0 || end < 0.0) {
		if (argc >= 2)
			fprintf(stderr, "%s: error: expected a time, finite and not negative, found "
				"'%s'\n", model->name, argv[1]);
		usage(argc > 0 ? argv[0] : model->name);
	}
	return end;
}

/* ---- other values of the params ---- */

/* The place for the value of a param, or of the step; NULL: there is none of this name */
static real *place_of(const char *text, size_t length, real *params, real *h)
{
	int i;
	for (i = 0; i < model->params; i++)
		if (strlen(model->param_names[i]) == length && strncmp(model->param_names[i], text, length) == 0)
			return &params[i];
	return length == 4 && strncmp(text, "step", 4) == 0 ? h : NULL;
}

/* NAME=VALUE ...: params and h, as the model has them where they are not named */
static void read_values(int count, char **text, const char *program, real *params, real *h)
{
	int i;
	*h = model->h;
	for (i = 0; i < model->params; i++)
		params[i] = model->param_values[i];
	for (i = 0; i < count; i++) {
		const size_t length = strcspn(text[i], "=");
		char *rest = NULL;
		real *place = model->retune != NULL && text[i][length] == '='
				? place_of(text[i], length, params, h) : NULL;
		const double value = place != NULL ? strtod(text[i] + length + 1, &rest) : 0.0;
		if (place == NULL || rest == text[i] + length + 1 || *rest != '\0') {
			fprintf(stderr, "%s: error: expected %s, found '%s'\n", model->name,
					model->retune != NULL ? "NAME=VALUE, a tunable param or step, and a number"
							  : "nothing after the time: the model has no tunable params",
					text[i]);
			usage(program);
		}
		*place = (real)value;
	}
}

static void retune(void *state, const real *params, real h)
{
	const int status = model->retune(state, params, h);
	if (status == PL_NO_STEP)
		fail("the step is not above 0");
	if (status == PL_NO_RATE)
		fail("with these values a load's frequency is below 0");
	if (status == PL_OUT_OF_RANGE)
		fail("these values are outside of the ranges that the spec gives, or make other regions: a "
			"restitution not "
			 "within 0 and 1, a gap or a force of friction below 0, breakpoints in another order");
	if (status == PL_SINGULAR)
		fail("with these values the mass matrix has no inverse");
	if (status != 0)
		fail("with these values the numbers of the step are not finite");
}

/* The rows read last, the newest last: most_ahead() + 1 of them; what they hold of inputs, each ahead as far as it has
 * to be */
static void take_row(samples *in, real *rows, real *u, uint64_t number, uint64_t steps, double h)
{
	const int most = most_ahead(), n = model->inputs;
	int i;
	memmove(rows, rows + n, sizeof *rows * (size_t)(most * n));
	if (!read_sample(in, rows + most * n))
		too_few(in, number, steps, h);
	for (i = 0; i < n; i++)
		u[i] = rows[model->start_samples[i] * n + i];
}

/* u for step k: of inputs that are held row k, of ramps row k + 1, of others one further ahead */
static void next_sample(samples *in, real *rows, real *u, uint64_t k, uint64_t steps, double h)
{
	take_row(in, rows, u, k + (uint64_t)most_ahead(), steps, h);
}

/* The names, and the samples before the first step; what is held has its own there */
static void begin_samples(samples *in, void *state, real *rows, real *u, uint64_t steps, double h)
{
	const int most = most_ahead(), n = model->inputs;
	int k, i;
	read_header(in);
	for (k = 0; k < most; k++) {
		take_row(in, rows, u, (uint64_t)k, steps, h);
		for (i = 0; i < n; i++)
			if (model->start_samples[i] == 0)
				u[i] = rows[most * n + i];
		model->hold(state, u);
	}
}

static void run(double end, int raw, int count, char **text, const char *program)
{
	void *state = need(malloc(model->size));
	row r = new_row(raw);
	real *u = (real *)need(malloc(sizeof *u * (size_t)(model->inputs + 1)));
	real *rows = (real *)need(calloc((size_t)((model->inputs + 1) * 8), sizeof *rows));
	real *params = (real *)need(malloc(sizeof *params * (size_t)(model->params + 1)));
	samples in = {NULL, 256, 0, 0, 0};
	real h;
	uint64_t k, steps;

	in.line = (char *)need(malloc(in.room));
	read_values(count, text, program, params, &h);
	model->init(state);
	if (count > 0)
		retune(state, params, h);
	steps = steps_until(end, (double)h);
	if (rows_for(steps) > 0 && model->inputs > 0)
		begin_samples(&in, state, rows, u, steps, (double)h);
	if (!raw)
		print_header();
	write_row(&r, state);
	for (k = 0; k < steps; k++) {
		if (model->inputs > 0)
			next_sample(&in, rows, u, k, steps, (double)h);
		model->step(state, model->inputs > 0 ? u : NULL);
		check_status(state);
		write_row(&r, state);
	}
	free(in.line);
	free(params);
	free(rows);
	free(u);
	free(r.text);
	free(r.value);
	free(state);
}

/* Is --raw among the arguments?  It goes from them. */
static int take_raw(int *argc, char **argv)
{
	int i, kept = 1;
	for (i = 1; i < *argc; i++)
		if (strcmp(argv[i], "--raw") != 0)
			argv[kept++] = argv[i];
	i = *argc > kept;
	*argc = kept < *argc ? kept : *argc;
	return i;
}

int main(int argc, char **argv)
{
	const int raw = take_raw(&argc, argv);
	double end;
	check_type();
	end = end_of_run(argc, argv);
	run(end, raw, argc - 2, argv + 2, argv[0]);
	if (ferror(stdout) || fclose(stdout) != 0)
		fail_write();
	return 0;
}
