/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plrun: a spec is made a program, and run: the column of calls. */
#define _GNU_SOURCE
#include "plrun.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct start {
	struct options options;
	struct toolchain *tools;
	struct code *code;
	struct machine *machine;
	struct view view;
	double *params;                         /* NULL: none is changed */
};

/* What plgen says are lines; what is wrong with plgen is not. */
static _Noreturn void end_with(int status, const char *error)
{
	if (!strchr(error, '\n'))
		fail(status, error);
	fputs(error, stderr);
	exit(status);
}

/* The definitions that plgen has to be given: of a tunable param another number is no other model. */
static size_t definitions_for(const struct options *o, const struct code *c, bool numbers, const char **definition)
{
	size_t count = 0;
	double value;
	for (size_t i = 0; i < o->definitions; i++) {
		bool number = read_number(o->definition[i].value, &value);
		if (!number || (numbers && !(c && is_tunable(c, o->definition[i].name))))
			definition[count++] = format("%s=%s", o->definition[i].name, o->definition[i].value);
	}
	return count;
}

static bool gives_tunable(const struct options *o, const struct code *c)
{
	double value;
	bool any = false;
	for (size_t i = 0; i < o->definitions; i++)
		any = any || (read_number(o->definition[i].value, &value) && is_tunable(c, o->definition[i].name));
	return any;
}

/* Which params are tunable is known of the C alone. Mostly none of those given is, and the C with all numbers is what
 * is wanted; else it is made without the numbers, and once more with those that belong into it. What keeps the first of
 * these from being made is reported of the one with all. */
static void make_code(struct start *s)
{
	const char **definition = need(calloc(s->options.definitions + 1, sizeof *definition));
	const size_t few = definitions_for(&s->options, NULL, false, definition);
	size_t all = definitions_for(&s->options, NULL, true, definition);
	char *error;
	int status;
	s->code = generate(s->tools, &s->options, definition, all, true, &error, &status);
	if (few < s->options.definitions && (!s->code || gives_tunable(&s->options, s->code))) {
		definitions_for(&s->options, NULL, false, definition);
		s->code = generate(s->tools, &s->options, definition, few, true, &error, &status);
		all = definitions_for(&s->options, s->code, true, definition);
		s->code = generate(s->tools, &s->options, definition, all, false, &error, &status);
	} else if (s->code) {
		say_text(s->code->said);
	}
	if (!s->code)
		end_with(status, error);
	free(definition);
}

static void set_params(struct start *s)
{
	const struct machine *m = s->machine;
	for (size_t i = 0; i < s->options.definitions; i++) {
		double value;
		if (!is_tunable(s->code, s->options.definition[i].name) ||
		    !read_number(s->options.definition[i].value, &value))
			continue;
		if (!s->params) {
			s->params = need(malloc(sizeof *s->params * (size_t)m->params));
			memcpy(s->params, m->param_values, sizeof *s->params * (size_t)m->params);
		}
		for (int k = 0; k < m->params; k++)
			if (strcmp(m->param_names[k], s->options.definition[i].name) == 0)
				s->params[k] = param_value(m, k, value);
	}
}

static void check_end(const struct start *s)
{
	if (s->options.fit)
		return;
	if (s->options.until < 0 && !s->options.input)
		wrong_usage("when does it end? plrun MODEL.spec T, in seconds");
	if (s->options.input && s->machine->inputs == 0)
		wrong_usage(format("--input: the model '%s' has no inputs", s->machine->name));
	if (!s->options.input && s->machine->inputs > 0)
		wrong_usage(format("the model '%s' has inputs: --input FILE.csv gives their samples",
				   s->machine->name));
}

/* How many steps a row is apart from the next */
static uint64_t steps_between(const struct options *o, const struct machine *m)
{
	if (o->every < 0)
		return 1;
	double steps = o->every / m->h;
	uint64_t whole = (uint64_t)(steps + 0.5);
	if (!(steps < 9e15) || whole == 0 || steps - (double)whole > 1e-6 * steps ||
	    (double)whole - steps > 1e-6 * steps)
		wrong_usage(format("--every takes a multiple of the step, %s s, found %s",
				   shortest(m->h, m->single), shortest(o->every, false)));
	return whole;
}

struct watchers {
	struct rows *rows;
	struct picture *picture;
	struct stats *stats;
	struct psd *psd;
};

static void watch_all(void *who, uint64_t k, const double *out)
{
	struct watchers *w = who;
	if (w->rows)
		rows_add(w->rows, k, out);
	if (w->picture)
		picture_add(w->picture, k, out);
	if (w->stats)
		stats_add(w->stats, k, out);
	if (w->psd)
		psd_add(w->psd, k, out);
}

/* Rows on a terminal, beside a picture, would hide what is said about it. */
static int run_once(struct start *s)
{
	const struct options *o = &s->options;
	const struct machine *m = s->machine;
	struct job job = { .machine = m, .params = s->params, .h = m->h, .until = o->until, .reported = true };
	struct watchers w = { NULL, NULL, NULL, NULL };
	struct stats stats = stats_new(m->outputs);
	uint64_t every = steps_between(o, m), crossed = 0;
	job.crossed = &crossed;
	job.record = o->input ? record_read(o, o->input, m, m->inputs, 0) : NULL;
	char *error = plan_run(&job);
	if (error && job.record)                /* its last line is where more was expected */
		fail_at((struct place){ job.record->path, job.record->last_line, "", 0, 0 }, NULL, error);
	if (error)
		fail(WRONG_DATA, error);
	if (job.resampled)
		record_say(job.record, job.h);
	struct output *output;
	FILE *to = output_open(o->output, &output);
	if (o->window)
		w.psd = psd_new(m, o, job.h, job.steps);
	else if (o->stats)
		w.stats = &stats;
	else if (!o->plot || o->output || !isatty(STDOUT_FILENO))
		w.rows = rows_new(to, m, job.h, every, o->raw);
	if (o->plot && !o->window)
		w.picture = picture_new(m, job.h, every);
	job.apart = w.stats || w.psd ? 0 : every;
	error = run_steps(&job, watch_all, &w);
	progress_end();
	if (w.rows)
		rows_end(w.rows);
	if (w.stats)
		stats_print(to, w.stats, m, job.h, crossed);
	if (w.psd)
		psd_print(to, w.psd, o);
	output_done(output, to);
	if (w.picture)
		picture_draw(w.picture, o);
	if (w.psd && o->plot)
		psd_draw(w.psd, o);
	if (error)
		fprintf(stderr, "%s: error: %s\n", m->name, error);
	return error ? WRONG_DATA : 0;
}

static int run_sweep(struct start *s, struct workers w)
{
	struct output *output;
	if (s->options.plot)
		picture_check(&s->view, &s->options);
	FILE *to = output_open(w.rank == 0 ? s->options.output : NULL, &output);
	int status = sweep_run(s->tools, &s->options, s->code, s->machine, to, w);
	output_done(output, to);
	return status;
}

static int run_fit(struct start *s)
{
	struct output *output;
	FILE *to = output_open(s->options.output, &output);
	int status = fit_run(s->tools, &s->options, s->code, s->machine, s->params, to);
	output_done(output, to);
	return status;
}

int main(int argc, char **argv)
{
	struct start s = { 0 };
	char *error;
	int status;
	watch_for_signals();
	struct workers w = workers_begin(&argc, &argv);
	read_options(argc, argv, &s.options);
	if (w.rank != 0)
		leave_notes_to_first();
	if (w.size > 1 && !s.options.sweep)
		fail(WRONG_USAGE, "several processes share out a sweep, and nothing else");
	s.tools = find_tools();
	if (s.options.chart)
		run_chart(s.tools, &s.options);
	if (s.options.page)
		make_page(s.tools, &s.options);
	make_code(&s);
	s.machine = machine_of(s.tools, s.code, &error);
	if (!s.machine)
		fail(WRONG_DATA, error);
	s.view = view_of(s.machine, s.options.show);
	machine_show(s.machine, &s.view, &s.options);
	check_end(&s);
	set_params(&s);
	status = s.options.fit ? run_fit(&s) : s.options.sweep ? run_sweep(&s, w) : run_once(&s);
	if (fclose(stdout) != 0)
		fail(WRONG_DATA, format("cannot write to standard output: %s", strerror(errno)));
	workers_end();
	return status;
}
