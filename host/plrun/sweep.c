/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run for each row of params, and a line about each: its number, the params, of every output the last value, the root
 * mean square and, with --peak, the largest size, of all rows from t = 0 on, then how it ended.
 * Tunable params go into an instance, others into a variant of the model. */
#define _GNU_SOURCE
#include "plrun.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- the table ---- */

static struct code *generate_with(const struct sweep *s, const char *definition, char **error)
{
	int status;
	return generate(s->tools, s->options, &definition, 1, true, error, &status);
}

/* A name that plgen does not know is wrong in every row: it is reported at once, where it stands. */
static void check_param(const struct sweep *s, const struct table *t, size_t column, const char *value)
{
	char *error = NULL;
	const char *name = t->header[column].text;
	for (size_t i = 0; i < s->options->definitions; i++)
		if (strcmp(s->options->definition[i].name, name) == 0)
			fail_at(header_place(t, column), NULL,
				format("'%s' has a value on the command line, too", name));
	for (size_t i = 0; i < column; i++)
		if (strcmp(t->header[i].text, name) == 0)
			fail_at(header_place(t, column), NULL, format("two columns are called '%s'", name));
	if (s->param[column].tuned || s->param[column].step)
		return;
	generate_with(s, format("%s=%s", name, value), &error);
	if (error && (strstr(error, "no param is named") || strstr(error, "is not a param")))
		fail_at(header_place(t, column), NULL, format("no param is named '%s'", name));
}

static void take_header(struct sweep *s, const struct table *t, const struct code *c)
{
	if (!t->header)
		fail_at((struct place){ t->at.path, t->at.number + 1, t->text + t->next, 0, 0 }, NULL,
			"expected a first line with the names of params");
	s->params = t->columns;
	s->param = need(calloc(s->params, sizeof *s->param));
	for (size_t i = 0; i < s->params; i++) {
		const char *name = t->header[i].text;
		s->param[i] = (struct param){ name, is_tunable(c, name), strcmp(name, "step") == 0 };
		if (s->param[i].step && s->machine->can_retune)
			s->param[i].tuned = true;
	}
}

/* A value as it is given to plgen, and printed: numbers with a point; others are expressions, or plgen says what. */
static const char *value_text(struct table *t, size_t cell, bool is_number)
{
	const char *text = t->cell[cell].text;
	if (!*text || is_number || strspn(text, "+-.,0123456789eE") == strlen(text))
		table_number(t, cell);
	char *value = format("%s", text);
	for (char *comma = value; t->separator != ',' && (comma = strchr(comma, ','));)
		*comma = '.';
	return value;
}

static void read_grid(const struct options *o, struct table *t)
{
	size_t length;
	char *text = grid_text(o->range, o->ranges, &length);
	table_begin(t, "<command line>", text, length);
}

static void read_table(struct sweep *s, const struct code *c)
{
	struct table t;
	if (s->options->ranges)
		read_grid(s->options, &t);
	else
		table_open(&t, s->options->sweep);
	take_header(s, &t, c);
	while (table_next(&t)) {
		s->text = grown(s->text, s->rows, &s->rows_room, sizeof *s->text * s->params);
		for (size_t i = 0; i < s->params; i++)
			s->text[s->rows * s->params + i] = value_text(&t, i, s->param[i].tuned || s->param[i].step);
		s->rows++;
	}
	if (s->rows == 0)
		fail_at((struct place){ t.at.path, t.at.number + 1, "", 0, 0 }, NULL,
			"expected rows of params, found the end of the file");
	for (size_t i = 0; i < s->params; i++)
		check_param(s, &t, i, sweep_value(s, 0, i));
}

/* ---- a line ---- */

static void print_cell(FILE *to, const char *text)
{
	if (!strpbrk(text, ",\"\n")) {
		fputs(text, to);
		return;
	}
	for (putc('"', to); *text; text++)
		fprintf(to, *text == '"' ? "\"\"" : "%c", *text);
	putc('"', to);
}

static void print_value(FILE *to, bool there, double value, bool single)
{
	char text[LONGEST];
	*put_shortest(text, value, single) = 0;
	fprintf(to, ",%s", there ? text : "");
}

/* Does any row differ from the model as it is compiled?  Else its coefficients are the generator's own. */
static bool is_tuned(const struct sweep *s)
{
	double value;
	for (size_t i = 0; i < s->params; i++)
		if (s->param[i].tuned)
			return true;
	for (size_t i = 0; i < s->options->definitions; i++)
		if (is_name_of(s->machine, s->options->definition[i].name) &&
		    read_number(s->options->definition[i].value, &value))
			return true;
	return false;
}

static void set_param(const struct machine *m, int k, const char *text, double *params)
{
	double value;
	if (read_number(text, &value))
		params[k] = param_value(m, k, value);
}

/* The tunables of a row beside those of the command line, and its step */
static double *params_of(const struct sweep *s, size_t row, const struct machine *m, double *h)
{
	double *params = need(malloc(sizeof *params * (size_t)(m->params + 1)));
	*h = m->h;
	memcpy(params, m->param_values, sizeof *params * (size_t)m->params);
	for (int k = 0; k < m->params; k++) {
		for (size_t i = 0; i < s->options->definitions; i++)
			if (strcmp(m->param_names[k], s->options->definition[i].name) == 0)
				set_param(m, k, s->options->definition[i].value, params);
		for (size_t i = 0; i < s->params; i++)
			if (strcmp(m->param_names[k], s->param[i].name) == 0)
				set_param(m, k, sweep_value(s, row, i), params);
	}
	for (size_t i = 0; i < s->params; i++)
		if (s->param[i].step && s->param[i].tuned)
			read_number(sweep_value(s, row, i), h);
	return params;
}

/* Of a job all but what stands in its row; NULL, or why there is none */
static char *plan_row(const struct sweep *s, size_t row, const struct machine *m, struct job *job, double **params)
{
	*job = (struct job){ .machine = m, .record = s->record, .until = s->options->until };
	*params = params_of(s, row, m, &job->h);
	job->params = is_tuned(s) ? *params : NULL;
	return plan_run(job);
}

static char *run_compiled(const struct sweep *s, size_t row, watch *each, void *who);

/* NULL, or how it went wrong */
static char *run_row(const struct sweep *s, size_t row, const struct machine *m, watch *each, void *who)
{
	struct job job;
	double *params;
	char *error = plan_row(s, row, m, &job, &params);
	if (!error)
		error = run_steps(&job, each, who);
	free(params);
	return error && !job.tuned && s->compiled ? run_compiled(s->compiled, row, each, who) : error;
}

/* A row whose values the tunable model does not take, of a model of its own */
static char *run_compiled(const struct sweep *s, size_t row, watch *each, void *who)
{
	struct variant own = { .row = row };
	build_variant(s, &own);
	char *error = own.machine ? run_row(s, row, own.machine, each, who) : own.error;
	if (own.machine)
		machine_close(own.machine);
	return error;
}

static void print_line(FILE *to, const struct sweep *s, size_t row, const struct stats *stats, const char *error)
{
	bool single = s->machine->single;
	fprintf(to, "%zu", row + 1);
	for (size_t i = 0; i < s->params; i++) {
		putc(',', to);
		print_cell(to, sweep_value(s, row, i));
	}
	for (int i = 0; i < s->machine->outputs; i++)
		print_value(to, !error, stats->of[i].last, single);
	for (int i = 0; i < s->machine->outputs; i++)
		print_value(to, !error, error ? 0 : stats_rms(stats, i), single);
	for (int i = 0; s->options->peak && i < s->machine->outputs; i++)
		print_value(to, !error, stats->of[i].peak, single);
	putc(',', to);
	print_cell(to, error ? format("failed: %s", error) : "ok");
	putc('\n', to);
}

/* Rows side by side; done: those of which stats are known. Returns why a device has not made them, or NULL */
static char *run_rows(struct sweep *s, const size_t *row, size_t count, const struct machine *m, struct stats *stats,
		      bool *done)
{
	double **params = need(calloc(count, sizeof *params));
	struct job job;
	bool all = true;
	for (size_t i = 0; i < count; i++) {
		char *error = plan_row(s, row[i], m, &job, &params[i]);
		all = all && !error && job.params && job.h == m->h;
		free(error);
	}
	char *why = !all ? format("their steps are not one")
		  : lanes_run(&job, count, (const double *const *)params, stats, done);
	for (size_t i = 0; i < count; i++)
		free(params[i]);
	free(params);
	return why;
}

/* Of runs that were wanted on a device */
static void note_host(struct sweep *s, size_t row, size_t count, const char *why)
{
	static pthread_mutex_t busy = PTHREAD_MUTEX_INITIALIZER;
	pthread_mutex_lock(&busy);
	if (s->host_runs == 0 || row < s->host_run) {
		s->host_run = row;
		s->host_why = why;
	}
	s->host_runs += count;
	pthread_mutex_unlock(&busy);
}

static char *line_of(struct sweep *s, size_t row, const struct machine *m, struct stats *stats, bool done)
{
	size_t length;
	char *line, *error = NULL;
	FILE *to = need(open_memstream(&line, &length));
	if (!m)
		error = s->variant[s->variant_of[row]].error;
	else if (!done)
		error = run_row(s, row, m, stats_add, stats);
	print_line(to, s, row, stats, error);
	fclose(to);
	return line;
}

/* Rows of one variant */
static void make_lines(struct sweep *s, const size_t *row, size_t count, char **line)
{
	struct variant *v = &s->variant[s->variant_of[row[0]]];
	struct stats *stats = need(calloc(count, sizeof *stats));
	bool *done = need(calloc(count, sizeof *done));
	const struct machine *m = take_variant(s, v);
	const char *why = v->no_kernel ? v->no_kernel : "a model of its own";
	for (size_t i = 0; i < count; i++)
		stats[i] = stats_new(s->machine->outputs);
	if (m && count > 1 && machine_has_lanes(m)) {
		char *error = run_rows(s, row, count, m, stats, done);
		why = error || m->kernel ? error : why;
	}
	if (m && s->options->device && why)
		note_host(s, row[0], count, why);
	for (size_t i = 0; i < count; i++) {
		line[i] = line_of(s, row[i], m, &stats[i], done[i]);
		leave_variant(v);
		free(stats[i].of);
	}
	free(stats);
	free(done);
}

/* line: NULL, each; rows of one variant go together, wherever they stand */
static void compute_lines(void *who, const size_t *row, size_t count, char **line)
{
	struct sweep *s = who;
	size_t *some = need(calloc(2 * count, sizeof *some)), *place = some + count;
	char **made = need(calloc(count, sizeof *made));
	for (size_t i = 0, n = 0; i < count; i++, n = 0) {
		for (size_t k = i; k < count && !line[i]; k++)
			if (s->variant_of[row[k]] == s->variant_of[row[i]]) {
				some[n] = row[k];
				place[n++] = k;
			}
		if (n)
			make_lines(s, some, n, made);
		for (size_t k = 0; k < n; k++)
			line[place[k]] = made[k];
	}
	free(some);
	free(made);
}

/* ---- the runs in a picture, once more: a line keeps none of its rows ---- */

static char *label_of(const struct sweep *s, size_t row)
{
	char *text = format("%s", "");
	for (size_t i = 0; i < s->params; i++)
		text = format("%s%s%s = %s", text, i ? ", " : "", s->param[i].name, sweep_value(s, row, i));
	return text;
}

static void draw_histories(struct sweep *s)
{
	struct picture *first = NULL, *last = NULL;
	for (size_t row = 0; row < s->rows; row++) {
		struct variant *v = &s->variant[s->variant_of[row]];
		const struct machine *m = take_variant(s, v);
		double h;
		if (m) {
			free(params_of(s, row, m, &h));
			struct picture *p = picture_new(s->machine, h, 1);
			char *error = run_row(s, row, m, picture_add, p);
			last = picture_after(last, p, format("%s%s", label_of(s, row), error ? ", failed" : ""));
			first = first ? first : last;
		}
		leave_variant(v);
	}
	if (first)
		picture_draw(first, s->options);
}

/* ---- the sweep ---- */

static void print_names(const struct sweep *s)
{
	static const char *const what[] = { "final", "rms", "peak" };
	fputs("run", s->to);
	for (size_t i = 0; i < s->params; i++) {
		putc(',', s->to);
		print_cell(s->to, s->param[i].name);
	}
	for (int k = 0; k < 2 + s->options->peak; k++)
		for (int i = 0; i < s->machine->outputs; i++)
			fprintf(s->to, ",%s %s", what[k], s->machine->output_names[i]);
	fputs(",status\n", s->to);
}

static bool has_failed(const char *line)
{
	size_t length = strlen(line);
	return length < 4 || strcmp(line + length - 4, ",ok\n") != 0;
}

static char no_more[] = "";                    /* stands for a line that is */

/* Lines are written in the order of the table, as soon as those before them are there. */
static void write_done(struct sweep *s)
{
	for (; s->written < s->rows && s->line[s->written]; s->written++) {
		char *line = s->line[s->written];
		s->failed += has_failed(line);
		if (s->to_draw)                 /* one scan after the other, where there are two ranges */
			fprintf(s->to_draw, "%s%s", s->options->ranges == 2 && s->written &&
				s->written % s->options->range[1].count == 0 ? "\n" : "", line);
		if (fputs(line, s->to) < 0)
			fail(WRONG_DATA, format("cannot write the lines: %s", strerror(errno)));
		free(line);
		s->line[s->written] = no_more;
	}
	if (fflush(s->to) != 0)
		fail(WRONG_DATA, format("cannot write the lines: %s", strerror(errno)));
}

/* With the time that is left, once it is known from the runs that are done */
static char *progress_text(const struct sweep *s)
{
	const double took = difftime(time(NULL), s->began), done = (double)(s->done - s->before);
	char *text = format("%zu of %zu runs", s->done, s->rows);
	return took < 3 ? text : format("%s, %.0f s left", text, took / done * (double)(s->rows - s->done));
}

static void deliver(void *who, size_t row, char *line)
{
	struct sweep *s = who;
	journal_add(s->journal, row, line);
	s->line[row] = line;
	s->done++;
	write_done(s);
	if (s->done < s->rows && progress_wanted())
		progress(progress_text(s));
}

static void add_file(struct hash *h, const char *path)
{
	size_t length;
	char *text = path ? read_whole(path, &length) : NULL;
	if (path && !text)
		fail(WRONG_DATA, format("cannot read '%s': %s", path, strerror(errno)));
	hash_bytes(h, text ? text : "", text ? length + 1 : 1);
	free(text);
}

/* Everything that a line depends on */
static char *key_of(const struct sweep *s, const struct code *c)
{
	const struct options *o = s->options;
	struct hash h;
	hash_begin(&h);
	hash_tools(s->tools, &h);
	hash_text(&h, c->text);
	add_file(&h, o->spec);
	for (size_t i = 0; i < o->ranges; i++)
		hash_text(&h, format("%s=%a:%a:%zu:%d", o->range[i].name, o->range[i].from, o->range[i].to,
				     o->range[i].count, o->range[i].log));
	if (o->ranges == 0)
		add_file(&h, o->sweep);
	hash_text(&h, shortest(o->until, false));
	hash_text(&h, o->time ? o->time : "");
	hash_text(&h, o->peak ? "peak" : "");
	hash_text(&h, o->show ? o->show : "");
	for (size_t i = 0; i < o->passed_count; i++)
		hash_text(&h, o->passed[i]);
	for (size_t i = 0; i < o->definitions; i++)
		hash_text(&h, format("%s=%s", o->definition[i].name, o->definition[i].value));
	if (s->record) {
		hash_bytes(&h, s->record->value,
			   s->record->rows * (size_t)s->record->inputs * sizeof *s->record->value);
		hash_bytes(&h, s->record->time, s->record->time ? s->record->rows * sizeof *s->record->time : 0);
	}
	return hash_name(&h);
}

/* A run ends at its last step, before T where that is no multiple of it: a line has no times that would show it. */
static void note_ends(const struct sweep *s)
{
	size_t early = 0, first = 0;
	double end = 0;
	for (size_t row = 0; row < s->rows; row++) {
		struct job job = { .machine = s->machine, .until = s->options->until, .h = s->machine->h };
		for (size_t i = 0; i < s->params; i++)
			if (s->param[i].step)
				read_number(sweep_value(s, row, i), &job.h);
		if (job.until < 0 || plan_run(&job) || job.until - (double)job.steps * job.h < 1e-6 * job.h)
			continue;
		if (early++ == 0)
			first = row, end = time_number(job.steps, job.h, s->machine->single);
	}
	if (early)
		say_note(format("T = %s is no multiple of the step of %zu of %zu runs, which end before it: run %zu at "
				"t = %s", shortest(s->options->until, false), early, s->rows, first + 1,
				shortest(end, s->machine->single)));
}

static void begin_output(struct sweep *s, const struct code *c, struct workers w)
{
	if (s->record && !record_on_grid(s->record, s->machine->h))
		record_say(s->record, s->machine->h);
	s->line = need(calloc(s->rows, sizeof *s->line));
	if (s->options->plot && w.rank == 0)
		s->to_draw = need(open_memstream(&s->drawn, &s->drawn_length));
	if (w.rank != 0)
		return;
	note_ends(s);
	s->journal = journal_open(key_of(s, c), s->options->resume, s->rows, s->line);
	say_when_interrupted("\nplrun: interrupted; the same command with --resume goes on here\n");
	for (size_t i = 0; i < s->rows; i++)
		s->done += s->line[i] != NULL;
	s->before = s->done;
	s->began = time(NULL);
	if (s->options->resume)
		say_note(format("%zu of %zu runs are done", s->done, s->rows));
	print_names(s);
	write_done(s);
}

int sweep_run(const struct toolchain *t, const struct options *o, const struct code *c, const struct machine *m,
	      FILE *to, struct workers w)
{
	struct sweep s = { .tools = t, .options = o, .machine = m, .to = to };
	s.record = o->input ? record_read(o, o->input, m, m->inputs, 0) : NULL;
	read_table(&s, c);
	if (o->histories && s.rows > PICTURE_CURVES)
		fail(WRONG_USAGE, format("--histories draws at most %d runs, and these are %zu", PICTURE_CURVES,
					 s.rows));
	find_variants(&s);
	c = make_tunable(&s, c);
	m = s.machine;
	o = s.options;
	begin_output(&s, c, w);
	workers_share(w, &(struct lines_wanted){ s.rows, s.line, o->jobs, o->device, compute_lines, deliver, &s });
	if (w.rank != 0)
		return 0;
	progress_end();
	journal_end(s.journal);
	if (s.host_runs)
		say_note(format("--device: %zu of %zu runs were on the host, the first of them run %zu: %s",
				s.host_runs, s.rows, s.host_run + 1, s.host_why));
	if (s.to_draw)
		fclose(s.to_draw);
	if (o->histories)
		draw_histories(&s);
	else if (s.to_draw)
		picture_sweep(m, o, s.drawn);
	if (s.failed)
		fprintf(stderr, "plrun: error: %zu of %zu runs failed: see the column status\n", s.failed, s.rows);
	return s.failed ? WRONG_DATA : 0;
}
