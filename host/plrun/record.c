/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recorded table as samples of the inputs, and for a fit as what outputs were. Row k is the sample at k h, as
 * everywhere; with a column of times the first row is t = 0, and where times are not k h the record goes straight from
 * row to row. */
#define _GNU_SOURCE
#include "plrun.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { NONE = -1 };

struct choice {                         /* which columns are read */
	const struct machine *machine;
	int inputs, names;              /* names: inputs, then measured outputs */
	int *of;                        /* of each; an output may have none */
	int time;
	bool chosen;                    /* by --column or --time, or for a fit: others may stand beside */
};

static const char *name_of(const struct choice *c, int i)
{
	return i < c->inputs ? c->machine->input_names[i] : c->machine->output_names[i - c->inputs];
}

/* "": none, or the model has no units */
static const char *unit_of(const struct choice *c, int i)
{
	const struct machine *m = c->machine;
	if (i >= c->inputs)
		return m->view ? m->view->unit[i - c->inputs] : "";
	return m->units && m->units->input ? m->units->input[i] : "";
}

/* "t", "time", "Time [s]", "t/s"; another unit is reported where it stands */
static bool is_time(const struct table *t, size_t column)
{
	const char *name = t->header[column].text;
	size_t length = strncasecmp(name, "time", 4) == 0 ? 4 : strncasecmp(name, "t", 1) == 0 ? 1 : 0;
	const char *rest = name + length;
	char unit[16] = "";
	if (!length || (*rest && !strchr(" [(/", *rest)))
		return false;
	sscanf(rest, " %*[[(/] %15[^])]", unit);
	for (size_t end = strlen(unit); end && unit[end - 1] == ' ';)
		unit[--end] = 0;
	if (*unit && strcmp(unit, "s") && strcmp(unit, "sec") && strcmp(unit, "seconds"))
		fail_at(header_place(t, column), format("--time '%s' takes it as seconds all the same", name),
			format("times are in seconds, and these are in '%s'", unit));
	return true;
}

static int find_column(const struct table *t, const char *header)
{
	int found = NONE;
	for (size_t i = 0; i < t->columns; i++) {
		if (strcmp(t->header[i].text, header) != 0)
			continue;
		if (found != NONE)
			fail_at(header_place(t, i), NULL, format("two columns are called '%s'", header));
		found = (int)i;
	}
	return found;
}

/* "u [N]", as --units names it; another unit than the model's is reported where it stands */
static int find_with_unit(const struct table *t, const char *name, const char *unit)
{
	for (size_t i = 0; i < t->columns; i++) {
		const char *header = t->header[i].text;
		char found[64];
		int end = 0;
		if (strncmp(header, name, strlen(name)) != 0)
			continue;
		sscanf(header + strlen(name), " [%63[^]]]%n", found, &end);
		if (!end || header[strlen(name) + (size_t)end])
			continue;
		if (strcmp(found, unit) != 0)
			fail_at(header_place(t, i),
				format("--column '%s=%s' takes its numbers as they are", name, header),
				format("'%s' is in '%s', and this column in '%s'", name, unit, found));
		return (int)i;
	}
	return NONE;
}

static const char *all_headers(const struct table *t)
{
	const char *list = "";
	for (size_t i = 0; i < t->columns; i++)
		list = format("%s%s'%s'", list, i ? ", " : "", t->header[i].text);
	return list;
}

static const char *all_names(const struct choice *c)
{
	const char *list = "";
	for (int i = 0; i < c->names; i++)
		list = format("%s%s%s", list, i ? ", " : "", name_of(c, i));
	return list;
}

static int named_column(const struct table *t, const char *option, const char *header)
{
	int column = find_column(t, header);
	if (column == NONE)
		fail_at(header_place(t, 0), format("its columns are %s", all_headers(t)),
			format("%s: no column is called '%s'", option, header));
	return column;
}

static bool names_an_input(const struct machine *m, const char *name)
{
	for (int i = 0; i < m->inputs; i++)
		if (strcmp(m->input_names[i], name) == 0)
			return true;
	return false;
}

/* Of a fit the record and --input may be two files: each has its own columns. */
static void take_named(const struct options *o, const struct table *t, struct choice *c)
{
	for (size_t k = 0; k < o->columns; k++) {
		int i = 0;
		while (i < c->names && strcmp(name_of(c, i), o->column[k].name) != 0)
			i++;
		if (i < c->names)
			c->of[i] = named_column(t, "--column", o->column[k].value);
		else if (!o->fit || (c->names > c->inputs && !names_an_input(c->machine, o->column[k].name)))
			wrong_usage(format("--column: the model has no %s '%s'; its %s: %s",
					   o->fit ? "output" : "input", o->column[k].name,
					   o->fit ? "names" : "inputs", all_names(c)));
	}
}

static void take_columns(const struct options *o, const struct table *t, struct choice *c)
{
	int found = 0;
	take_named(o, t, c);
	for (int i = 0; i < c->names; i++) {
		if (c->of[i] == NONE)
			c->of[i] = find_column(t, name_of(c, i));
		if (c->of[i] == NONE && *unit_of(c, i))
			c->of[i] = find_with_unit(t, name_of(c, i), unit_of(c, i));
		if (c->of[i] == NONE && i < c->inputs)
			fail_at(header_place(t, 0), format("--column %s=HEADER says which it is; there are %s",
							   name_of(c, i), all_headers(t)),
				format("no column is called '%s', as the input is", name_of(c, i)));
		found += i >= c->inputs && c->of[i] != NONE;
	}
	if (c->names > c->inputs && found == 0)
		fail_at(header_place(t, 0), format("--column NAME=HEADER says which is which; the outputs are %s",
						   all_names(c)), "no column is called as an output is");
	if (o->time)
		c->time = named_column(t, "--time", o->time);
}

static bool is_taken(const struct choice *c, int column)
{
	for (int i = 0; i < c->names; i++)
		if (c->of[i] == column)
			return true;
	return c->time == column;
}

/* What is not an input is the time, or without use: so is what has no name, as row numbers and empty columns do. */
static void take_rest(const struct table *t, struct choice *c)
{
	const char *unused = "";
	for (int i = 0; i < (int)t->columns; i++) {
		if (is_taken(c, i))
			continue;
		if (c->time == NONE && is_time(t, (size_t)i)) {
			c->time = i;
			continue;
		}
		if (!c->chosen && *t->header[i].text)
			fail_at(header_place(t, (size_t)i),
				format("the inputs are %s; with --column or --time other columns are passed over",
				       all_names(c)),
				format("a column too many: no input is called '%s'", t->header[i].text));
		unused = format("%s%s'%s'", unused, *unused ? ", " : "", t->header[i].text);
	}
	if (*unused)
		say_note(format("%s: not read: %s", t->at.path, unused));
}

static void choose(const struct options *o, const struct table *t, struct choice *c)
{
	for (int i = 0; i < c->names; i++)
		c->of[i] = t->header ? NONE : i;
	if (t->header) {
		take_columns(o, t, c);
		take_rest(t, c);
	} else if (o->fit) {
		fail_at((struct place){ t->at.path, t->at.number + 1, t->text + t->next, 0, 0 },
			format("outputs are %s", all_names(c)), "expected a first line with the names of outputs");
	} else if (c->chosen) {
		fail(WRONG_DATA, format("%s: --column and --time name columns, and its first line has no names",
					t->at.path));
	} else if (t->columns != (size_t)c->inputs) {
		fail_at((struct place){ t->at.path, t->at.number + 1, t->text + t->next, 0, 0 },
			format("a first line with names says which is which; the inputs are %s", all_names(c)),
			format("expected %d column%s, one for each input, found %zu", c->inputs,
			       c->inputs == 1 ? "" : "s", t->columns));
	}
}

/* ---- the rows ---- */

static void check_time(struct table *t, const struct record *r, const struct choice *c)
{
	size_t k = r->rows - 1;
	if (k > 0 && !(r->time[k] > r->time[k - 1]))
		fail_at(table_place(t, t->cell[c->time].column), NULL,
			format("times have to rise: %s follows %s", shortest(r->time[k], false),
			       shortest(r->time[k - 1], false)));
}

/* A place where much more time passes than elsewhere has lost rows. Each row is a line. */
static void look_for_gaps(const struct record *r)
{
	double mean = (r->time[r->rows - 1] - r->time[0]) / (double)(r->rows - 1), longest = 0;
	size_t where = 0;
	for (size_t k = 1; k < r->rows; k++)
		if (r->time[k] - r->time[k - 1] > longest) {
			longest = r->time[k] - r->time[k - 1];
			where = k;
		}
	if (longest > 5 * mean)
		say_text(format("%s:%lu:1: warning: %.3g s without a row, where others are %.3g s apart\n", r->path,
				r->last_line - (r->rows - 1 - where), longest, mean));
}

static void begin_at_zero(struct record *r)
{
	double first = r->time[0];
	if (first == 0)
		return;
	say_note(format("%s: its first row, of t = %s, is taken as t = 0", r->path, shortest(first, false)));
	for (size_t k = 0; k < r->rows; k++)
		r->time[k] -= first;
}

/* NAN: a sample that is missing, an empty cell or nan */
static double measured_number(struct table *t, int column)
{
	if (column == NONE || !*t->cell[column].text || strcasecmp(t->cell[column].text, "nan") == 0)
		return (double)NAN;
	return table_number(t, (size_t)column);
}

static void take_row(struct record *r, struct table *t, const struct choice *c, size_t *room)
{
	r->value = grown(r->value, r->rows, room, sizeof *r->value * (size_t)r->width);
	double *row = r->value + r->rows++ * (size_t)r->width;
	for (int i = 0; i < c->names; i++)
		row[i] = i < c->inputs ? table_number(t, (size_t)c->of[i]) : measured_number(t, c->of[i]);
	r->last_line = t->at.number;
}

struct record *record_read(const struct options *o, const char *path, const struct machine *m, int inputs, int outputs)
{
	struct record *r = need(calloc(1, sizeof *r));
	struct table t;
	size_t room = 0, time_room = 0;
	table_open(&t, path);
	struct choice c = { m, inputs, inputs + outputs, need(calloc((size_t)(inputs + outputs) + 1, sizeof(int))),
			    NONE, o->columns || o->time || o->fit };
	choose(o, &t, &c);
	r->path = t.at.path;
	r->inputs = inputs;
	r->width = inputs + outputs;
	while (table_next(&t)) {
		take_row(r, &t, &c, &room);
		if (c.time == NONE)
			continue;
		r->time = grown(r->time, r->rows - 1, &time_room, sizeof *r->time);
		r->time[r->rows - 1] = table_number(&t, (size_t)c.time);
		check_time(&t, r, &c);
	}
	if (r->rows == 0)
		fail_at((struct place){ t.at.path, t.at.number + 1, "", 0, 0 }, NULL,
			"expected rows of numbers, found the end of the file");
	if (r->time && r->rows > 1)
		look_for_gaps(r);
	if (r->time && inputs > 0)
		begin_at_zero(r);
	if (r->time && r->time[0] < 0)
		fail_at((struct place){ t.at.path, r->last_line - r->rows + 1, "", 0, 0 }, NULL,
			"a time before 0, where the model starts");
	free(t.text);
	free(c.of);
	return r;
}

/* ---- samples ---- */

/* Times are written with few digits: a millionth of a step is nothing, and neither is what a step loses that is a
 * float, up to a hundredth of it. */
bool record_on_grid(const struct record *r, double h)
{
	for (size_t k = 0; r->time && k < r->rows; k++) {
		const double off = fabs(r->time[k] - (double)k * h);
		if (!(off < fmin(1e-6 * h + 6e-8 * r->time[k], 0.01 * h)))
			return false;
	}
	return true;
}

uint64_t record_samples(const struct record *r, double h, bool on_grid)
{
	double last = on_grid ? 0 : r->time[r->rows - 1] / h + 1e-6;
	return on_grid ? r->rows : last < (double)MOST_STEPS ? (uint64_t)last + 1 : MOST_STEPS;
}

void record_say(const struct record *r, double h)
{
	double longest = 0, least = 1e300;
	for (size_t k = 1; k < r->rows; k++) {
		double d = r->time[k] - r->time[k - 1];
		longest = d > longest ? d : longest;
		least = d < least ? d : least;
	}
	if (longest - least < 1e-3 * longest)
		say_note(format("%s: a row every %.6g s, and the step is %.6g s: resampled by ramps", r->path, least,
				h));
	else
		say_note(format("%s: rows %.6g to %.6g s apart, and the step is %.6g s: resampled by ramps", r->path,
				least, longest, h));
}

void record_sample(const struct record *r, double h, bool on_grid, uint64_t k, size_t *near, double *u)
{
	const size_t n = (size_t)r->inputs, width = (size_t)r->width;
	if (on_grid) {
		memcpy(u, r->value + k * width, sizeof *u * n);
		return;
	}
	double t = (double)k * h;
	while (*near + 2 < r->rows && r->time[*near + 1] <= t)
		(*near)++;
	size_t next = *near + 1 < r->rows ? *near + 1 : *near;
	const double *from = r->value + *near * width, *to = r->value + next * width;
	double part = next == *near ? 0 : (t - r->time[*near]) / (r->time[next] - r->time[*near]);
	part = part < 1 ? part : 1;
	for (size_t i = 0; i < n; i++)
		u[i] = from[i] + part * (to[i] - from[i]);
}
