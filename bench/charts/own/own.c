/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * own [-q] EVERY UNITS FOLDER
 *
 * Error against time of plgen's steps and of peers on one model, over UNITS outputs EVERY seconds apart:
 * FOLDER/own.csv. own.sh compiles it for the model; FOLDER/model.so is the model as plgen makes it, FOLDER/list has a
 * line for each further variant: file, name, `step` or `tolerance`, setting, options. -q: each time taken once, for
 * tests.
 */
#include "../charts.h"
#include "own.h"
#include "peers.h"
#include "truth.h"

#include <dlfcn.h>
#include <limits.h>

struct history history;

/* Steps in an output, and tolerances as 10 to the minus these; fewer where there are many states. Radau of s stages
 * holds its estimate to the power (s + 1)/(2 s) of the tolerance, so it needs smaller ones to be as accurate. */
static const int parts[] = {1, 2, 4, 8, 16, 32, 64, 256, 0}, parts_large[] = {1, 4, 16, 64, 128, 0};
enum { LARGE = N > 12 };
static const int digits[] = {3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 0}, digits_large[] = {4, 7, 10, 13, 0};
static const int digits_radau[] = {3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 15, 17, 0},
	digits_radau_large[] = {4, 7, 10, 13, 16, 0};

#define RADAU "Radau IIA as in the kept charts, Jacobian by differences; equations inlined"
static const struct peer peers[] = {
	{"RK4", false, rk4, "classical, steps in an output; equations inlined"},
	{"Dormand-Prince", true, own_dormand, "5(4), PI controller, free interpolant of order 4; equations inlined"},
	{"DOP853", true, own_dop853, "as in the kept charts, interpolant of order 7; equations inlined"},
	{"RADAU5", true, own_radau5, RADAU, .digits = LARGE ? digits_radau_large : digits_radau},
	{"RADAU9", true, own_radau9, RADAU, .digits = LARGE ? digits_radau_large : digits_radau},
	{"RADAU13", true, own_radau13, RADAU, .digits = LARGE ? digits_radau_large : digits_radau},
	{"GSL rk8pd", true, own_rk8pd, "driver with scaled control, applied to each output time"},
	{"CVODE Adams", true, own_adams, "fixed-point iteration, output from its interpolant"},
	{"CVODE BDF", true, own_bdf, "Newton, dense, Jacobian by differences, output from its interpolant"},
	{"exact in regions, bisection", false, own_regions,
	 "as in the kept charts, borders and matrices from the tables of plgen's C",
	 has_regions},
	{"exp(A h), loop", false, exponential_loop, "found once; linear, constant loads, no inputs", is_affine, true},
	{"exp(A h) rounded, literals", false, exponential_literals,
	 "as in the kept charts: correctly rounded, constants in code; linear, constant loads, no inputs",
	 has_literals, true},
};
enum { PEERS = sizeof peers / sizeof *peers, MOST_LINES = 200 };

struct line {
	const struct peer *peer;        /* NULL: ours */
	char name[64], file[200], options[100];
	bool tolerance;
	double setting;
	void *state;
	const pl_model *model;
	const pl_modelf *single;
	int steps;                      /* of ours in an output */
	/* NAME_run keeps the rows wanted: a step is an output, and its outputs are the states */
	bool rows;
	double error, evaluations, ns;
	const char *word;               /* ok, failed, gave up, refused */
	char *refusal;                  /* NULL: none */
};

/* ---- ours ---- */

/* What both kinds of descriptor have under one name */
#define OF(line, member) ((line)->single ? (line)->single->member : (line)->model->member)

static void open_ours(struct line *line, const char *folder)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s", folder, line->file);
	line->refusal = variant_refused(path);
	if (line->refusal) {
		line->word = "refused";
		return;
	}
	void *handle = object_open(path);
	const void *model = handle ? dlsym(handle, "subject_model") : NULL;
	if (!model)
		leave(path, "no model in it");
	if (strstr(line->options, "--real float"))
		line->single = model;
	else
		line->model = model;
	line->steps = line->tolerance ? 1 : (int)line->setting;
	line->state = room_for(1, OF(line, size));
	/* outputs may be in units of their own, and states are in SI units */
	line->rows = line->steps == 1 && !dlsym(handle, "subject_units") &&
		same_names(N, OF(line, outputs), OF(line, state_names), OF(line, output_names));
}

/* Rows of inputs for the steps of output k: as plrt.h has it, row j + 1 where an input is a ramp */
static void samples_of(int k, int steps, double *u)
{
	const double *now = history.sample + (size_t)k * INPUTS, *next = now + INPUTS;
	for (int j = 0; j < steps; j++)
		for (int i = 0; i < INPUTS; i++)
			*u++ = history.ramp[i] ? now[i] + (j + 1) * (next[i] - now[i]) / steps : now[i];
}

static bool run_ours(struct line *line, double *rows)
{
	const int steps = line->steps;
	double u[INPUTS > 0 ? steps * INPUTS : 1];
	line->model->init(line->state);
	if (line->model->hold)
		line->model->hold(line->state, history.sample);
	if (line->rows)
		line->model->run(line->state, (size_t)history.units, history.ends, rows);
	for (int k = 0; !line->rows && k < history.units; k++, rows += N) {
		if (INPUTS > 0)
			samples_of(k, steps, u);
		line->model->run(line->state, (size_t)steps, INPUTS > 0 ? u : NULL, NULL);
		line->model->get(line->state, rows);
	}
	return line->model->status(line->state) == 0;
}

static bool run_single(struct line *line, double *rows)
{
	const int steps = line->steps;
	double u[INPUTS > 0 ? steps * INPUTS : 1];
	float narrow[INPUTS > 0 ? steps * INPUTS : 1], row[N];
	line->single->init(line->state);
	for (int i = 0; i < INPUTS; i++)
		narrow[i] = (float)history.sample[i];
	if (line->single->hold)
		line->single->hold(line->state, narrow);
	if (line->rows) {
		line->single->run(line->state, (size_t)history.units, history.single_ends, history.single);
		for (int i = 0; i < history.units * N; i++)
			rows[i] = history.single[i];
	}
	for (int k = 0; !line->rows && k < history.units; k++, rows += N) {
		if (INPUTS > 0)
			samples_of(k, steps, u);
		for (int i = 0; i < steps * INPUTS; i++)
			narrow[i] = (float)u[i];
		line->single->run(line->state, (size_t)steps, INPUTS > 0 ? narrow : NULL, NULL);
		line->single->get(line->state, row);
		for (int i = 0; i < N; i++)
			rows[i] = row[i];
	}
	return line->single->status(line->state) == 0;
}

/* ---- the history ---- */

static void describe(const char *folder, bool *velocity)
{
	const pl_model *model = variant_model(folder, "model");
	void *state = room_for(1, model->size);
	model->init(state);
	model->get(state, history.start);
	for (int i = 0; i < N; i++)
		velocity[i] = model->state_names[i][strlen(model->state_names[i]) - 1] == '\'';
	for (int i = 0; i < INPUTS; i++)
		history.ramp[i] = model->start_samples[i] == 1;
	free(state);
}

/* Inputs: two sines with periods of 40 and 17 outputs, each input by its number later */
static void make_signal(void)
{
	history.sample = room_for((size_t)(history.units + 2) * (INPUTS > 0 ? INPUTS : 1), sizeof(double));
	for (int k = 0; k <= history.units + 1; k++)
		for (int i = 0; i < INPUTS; i++)
			history.sample[k * INPUTS + i] = sin(2 * M_PI * k / 40 + i) + sin(2 * M_PI * k / 17 + i) / 2;
	history.single = room_for((size_t)history.units * N, sizeof(float));
	if (INPUTS == 0)
		return;
	const size_t count = (size_t)history.units * INPUTS;
	history.ends = room_for(count, sizeof(double));
	history.single_ends = room_for(count, sizeof(float));
	for (int k = 0; k < history.units; k++)
		samples_of(k, 1, history.ends + (size_t)k * INPUTS);
	for (size_t i = 0; i < count; i++)
		history.single_ends[i] = (float)history.ends[i];
}

static void find_scales(const bool *velocity, const double *rows)
{
	double most[2] = {0, 0};
	for (int k = -1; k < history.units; k++)
		for (int i = 0; i < N; i++) {
			double *to = &most[velocity[i]];
			*to = fmax(*to, fabs(k < 0 ? history.start[i] : rows[k * N + i]));
		}
	for (int i = 0; i < N; i++)
		history.scale[i] = most[velocity[i]] > 0 ? most[velocity[i]] : 1;
}

static double off_by(const double *rows, const double *truth)
{
	double most = 0;
	for (int k = 0; k < history.units * N; k++) {
		const double off = fabs(rows[k] - truth[k]) / history.scale[k % N];
		if (!(off <= most))
			most = off;
		if (!isfinite(off))
			return HUGE_VAL;
	}
	return most;
}

/* ---- the lines ---- */

static int read_list(const char *folder, struct line *lines)
{
	char text[1000], kind[20];
	FILE *f = file_in(folder, "list", "r");
	int count = 0;
	while (count < MOST_LINES && fgets(text, sizeof text, f)) {
		struct line *line = &lines[count];
		if (sscanf(text, "%199[^\t]\t%63[^\t]\t%19[^\t]\t%lf\t%99[^\n]", line->file, line->name, kind,
		           &line->setting, line->options) != 5)
			leave("list", text);
		line->tolerance = strcmp(kind, "tolerance") == 0;
		open_ours(line, folder);
		count++;
	}
	fclose(f);
	return count;
}

static const int *settings_of(const struct peer *peer)
{
	static const int once[] = {1, 0}, never[] = {0};
	if (peer->applies && !peer->applies())
		return never;
	if (peer->once)
		return once;
	if (peer->digits)
		return peer->digits;
	if (peer->tolerance)
		return LARGE ? digits_large : digits;
	return LARGE ? parts_large : parts;
}

static int add_peers(struct line *lines, int count)
{
	for (int p = 0; p < PEERS; p++)
		for (const int *k = settings_of(&peers[p]); *k && count < MOST_LINES; k++) {
			struct line *line = &lines[count++];
			line->peer = &peers[p];
			line->tolerance = peers[p].tolerance;
			line->setting = line->tolerance ? pow(10, -*k) : *k;
			snprintf(line->name, sizeof line->name, "%s", peers[p].name);
		}
	return count;
}

/* Its time is that of one pass through the whole history */
static double pass(struct line *line, double *rows, bool *good)
{
	const double begin = own_ns();
	history.evaluations = 0;
	history.most = line->tolerance ? 60000000L / N : LONG_MAX;
	if (line->single)
		*good = run_single(line, rows);
	else if (line->model)
		*good = run_ours(line, rows);
	else if (setjmp(history.gave_up) == 0)
		*good = line->peer->run(line->setting, rows);
	else
		line->word = "gave up";
	return (own_ns() - begin) / history.units;
}

static void find_error(struct line *line, double *rows, const double *truth)
{
	bool good = false;
	line->word = "ok";
	line->ns = pass(line, rows, &good);
	line->error = good ? off_by(rows, truth) : HUGE_VAL;
	line->evaluations = line->peer ? (double)history.evaluations / history.units : -1;
	if (!isfinite(line->error) && strcmp(line->word, "gave up") != 0)
		line->word = "failed";
}

/* Rounds in turn, so that what disturbs the machine meets all alike; the least time counts */
static void find_times(struct line *lines, int count, double *rows)
{
	enum { ROUNDS = 3 };
	for (int round = 0; round < ROUNDS; round++)
		for (struct line *line = lines; line < lines + count; line++) {
			const double whole = line->ns * history.units;
			const int repeats = whole > 1e8 ? 0 : whole > 2e6 ? 1 : (int)(2e6 / (whole + 1e3)) + 1;
			bool good;
			if (strcmp(line->word, "ok") != 0)
				continue;
			for (int k = 0; k < repeats; k++)
				line->ns = fmin(line->ns, pass(line, rows, &good));
		}
}

/* ---- what comes out ---- */

static void put_line(FILE *csv, const struct line *line, double agreement)
{
	const bool good = strcmp(line->word, "ok") == 0;
	const char *settings = line->peer ? line->peer->settings : line->refusal ? line->refusal : line->options;
	fprintf(csv, "\"%s\",%s,%s,%.6g,", line->name, line->peer ? "peer" : "ours",
	        line->tolerance ? "tolerance" : "step",
	        line->tolerance ? line->setting : history.every / line->setting);
	if (good)
		fprintf(csv, "%.4g,ok,", line->error);
	else
		fprintf(csv, "%s,%s,", line->word, line->word);
	if (good && line->peer)
		fprintf(csv, "%.6g,", line->evaluations);
	else
		fputs("none,", csv);
	if (good)
		fprintf(csv, "%.5g,", line->ns);
	else
		fputs("none,", csv);
	fprintf(csv, "%.2g,", agreement);
	put_quoted(csv, settings);
	putc('\n', csv);
}

static void write_table(const char *folder, const struct line *lines, int count, double agreement)
{
	FILE *csv = table_open(folder, "own.csv", "method,family,setting_kind,setting,largest,word,"
	                       "evaluations_per_output,ns_min,truth_agreement,settings");
	for (const struct line *line = lines; line < lines + count; line++)
		put_line(csv, line, agreement);
	table_close(csv, "own.csv");
}

int main(int argc, char **argv)
{
	static struct line lines[MOST_LINES];
	static bool velocity[N];
	struct gragg x = {.size = N, .velocity = velocity, .most = 1000000000L / N};
	const bool quick = argc > 1 && strcmp(argv[1], "-q") == 0;
	if (argc != 4 + quick) {
		fputs("usage: own [-q] EVERY UNITS FOLDER\n", stderr);
		return 2;
	}
	const char *folder = argv[3 + quick];
	history.every = atof(argv[1 + quick]);
	history.units = atoi(argv[2 + quick]);
	if (!(history.every > 0) || history.units < 1)
		leave("UNTIL and EVERY", "an output at least has to come before the end");
	double *truth = room_for((size_t)history.units * N, sizeof *truth),
		*rows = room_for((size_t)history.units * N, sizeof *rows);
	describe(folder, velocity);
	make_signal();
	if (!find_truth(&x, truth))
		leave("what is true", "extrapolation does not come to the end: the motion grows without bound, or its "
		      "equations are too stiff or too rough for it");
	find_scales(velocity, truth);
	const int ours = read_list(folder, lines), count = add_peers(lines, ours);
	/* of what is true with whatever comes nearest, another road in every case */
	double agreement = HUGE_VAL;
	for (struct line *line = lines; line < lines + count; line++)
		if (!line->refusal) {
			find_error(line, rows, truth);
			if (strcmp(line->word, "ok") == 0)
				agreement = fmin(agreement, line->error);
		}
	if (!quick)
		find_times(lines, count, rows);
	write_table(folder, lines, count, agreement);
	return 0;
}
