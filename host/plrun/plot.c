/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures. Of a run: panels over one axis of time, or of one column over another; a long run is kept as the least and
 * the largest value of each column in buckets of equal length, more of them than a picture has points across, and as
 * the first of each, which is a point over another column. Of a sweep: panels over the range, maps over two, or the
 * runs one on the other, as a list of pictures. */
#define _GNU_SOURCE
#include "plrun.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BUCKETS = 8192, PANELS = 12, FIRST = 0, LEAST, LARGEST, KEPT };      /* BUCKETS: even */

struct picture {
	const struct machine *machine;
	const struct view *view;
	struct picture *next;           /* of a sweep: the next run, over the same axes */
	const char *label;              /* of a sweep */
	double h;
	uint64_t every;                 /* steps from one sample to the next */
	int columns;
	uint64_t stride;                /* samples of a bucket */
	size_t buckets;
	double *value[KEPT];            /* BUCKETS x columns */
};

struct picture *picture_new(const struct machine *m, double h, uint64_t every)
{
	const struct view *v = m->view;
	struct picture *p = need(calloc(1, sizeof *p));
	*p = (struct picture){ .machine = m, .view = v, .h = h, .every = every, .stride = 1, .columns = v->columns };
	for (int kept = 0; kept < KEPT; kept++)
		p->value[kept] = need(calloc((size_t)BUCKETS * (size_t)p->columns + 1, sizeof(double)));
	return p;
}

static double *bucket_of(const struct picture *p, int kept, size_t bucket)
{
	return p->value[kept] + bucket * (size_t)p->columns;
}

/* A bucket with what is in [least, largest] too */
static void widen(struct picture *p, size_t bucket, const double *least, const double *largest)
{
	double *low = bucket_of(p, LEAST, bucket), *high = bucket_of(p, LARGEST, bucket);
	for (int i = 0; i < p->columns; i++) {
		low[i] = least[i] < low[i] ? least[i] : low[i];
		high[i] = largest[i] > high[i] ? largest[i] : high[i];
	}
}

static void halve(struct picture *p)
{
	const size_t size = (size_t)p->columns * sizeof(double);
	for (size_t b = 0; b < BUCKETS; b += 2) {
		widen(p, b, bucket_of(p, LEAST, b + 1), bucket_of(p, LARGEST, b + 1));
		for (int kept = 0; kept < KEPT; kept++)
			memmove(bucket_of(p, kept, b / 2), bucket_of(p, kept, b), size);
	}
	p->buckets = BUCKETS / 2;
	p->stride *= 2;
}

void picture_add(void *who, uint64_t k, const double *out)
{
	struct picture *p = who;
	if (k % p->every)
		return;
	k /= p->every;
	if (k / p->stride >= BUCKETS)
		halve(p);
	size_t bucket = (size_t)(k / p->stride);
	if (bucket == p->buckets) {
		for (int kept = 0; kept < KEPT; kept++)
			memcpy(bucket_of(p, kept, bucket), out, (size_t)p->columns * sizeof *out);
		p->buckets++;
	} else {
		widen(p, bucket, out, out);
	}
}

struct picture *picture_after(struct picture *last, struct picture *p, const char *label)
{
	p->label = label;
	if (last)
		last->next = p;
	return p;
}

/* ---- runs ---- */

static void print_row(FILE *to, const struct picture *p, size_t bucket, int kept)
{
	char text[LONGEST];
	*put_time(text, bucket * p->stride * p->every, p->h, p->machine->single) = 0;
	fputs(text, to);
	for (int i = 0; i < p->columns; i++) {
		*put_shortest(text, bucket_of(p, kept, bucket)[i], p->machine->single) = 0;
		fprintf(to, " %s", text);
	}
	putc('\n', to);
}

/* A bucket of one step is a point; of more it is two, and the line between them is what happens in it. */
static void print_data(FILE *to, const struct picture *p, const char *number)
{
	fprintf(to, "$data%s << END\n", number);
	for (size_t b = 0; b < p->buckets; b++) {
		print_row(to, p, b, LEAST);
		if (p->stride > 1)
			print_row(to, p, b, LARGEST);
	}
	fputs("END\n", to);
	if (p->stride == 1)
		return;
	fprintf(to, "$first%s << END\n", number);
	for (size_t b = 0; b < p->buckets; b++)
		print_row(to, p, b, FIRST);
	fputs("END\n", to);
}

/* Of all runs */
static double extreme_of(const struct picture *p, int kept, int column)
{
	double most = kept == LEAST ? HUGE_VAL : -HUGE_VAL;
	for (; p; p = p->next)
		for (size_t b = 0; b < p->buckets; b++) {
			const double value = bucket_of(p, kept, b)[column];
			if (kept == LEAST ? value < most : value > most)
				most = value;
		}
	return most;
}

/* A logarithm has a picture of what is above 0. */
static void check_log(const struct picture *p, char axis, int column)
{
	const char *name = p->machine->output_names[column];
	if (extreme_of(p, LARGEST, column) <= 0)
		fail(WRONG_DATA, format("--log %c: '%s' is nowhere above 0", axis, name));
	if (extreme_of(p, LEAST, column) <= 0)
		say_note(format("--log %c: '%s' is drawn where it is above 0", axis, name));
}

static void print_log(FILE *to, const struct look *look)
{
	fprintf(to, "%sset logscale x\n%sset logscale y\n", look->log_x ? "" : "un", look->log_y ? "" : "un");
}

static void print_time(FILE *to, const struct picture *p, const struct look *look, bool last)
{
	const double each = (double)(p->stride * p->every) * p->h;
	double end = 0;
	for (const struct picture *q = p; q; q = q->next)
		end = fmax(end, (double)(q->buckets - (q->buckets > 0)) * (double)(q->stride * q->every) * q->h);
	print_log(to, look);
	fprintf(to, "set xrange [%g:%g]\nset offsets 0,0,%s\n", look->log_x ? each : 0, end > 0 ? end : 1,
		look->log_y ? "0,0" : "graph 0.05,graph 0.05");
	script_label(to, "xlabel", last ? "t [s]" : "");
}

static void print_over(FILE *to, const struct picture *p, const struct look *look, int column)
{
	print_log(to, look);
	fputs("set xrange [*:*]\nset offsets graph 0.03,graph 0.03,graph 0.05,graph 0.05\n", to);
	script_label(to, "xlabel", p->view->label[column]);
	if (look->log_x)
		check_log(p, 'x', column);
}

static void print_tics(FILE *to, const struct picture *p, const struct look *look, const struct panel *panel)
{
	double least = extreme_of(p, LEAST, panel->y[0]), most = extreme_of(p, LARGEST, panel->y[0]);
	for (int k = 1; k < panel->curves; k++) {
		const double low = extreme_of(p, LEAST, panel->y[k]), high = extreme_of(p, LARGEST, panel->y[k]);
		least = low < least ? low : least;
		most = high > most ? high : most;
	}
	fputs("set ytics autofreq\n", to);
	if (!look->log_y)
		script_tics(to, 'y', least, most);
}

/* Behind the names of a run's data; of a single one nothing */
static const char *number_of(const struct picture *first, const struct picture *p)
{
	int number = 1;
	for (const struct picture *q = first; q != p; q = q->next)
		number++;
	return first->next ? format("%d", number) : "";
}

/* Points of a run that is longer than the buckets: each is a state that was, and a line between two would be none. */
static void print_panel(FILE *to, const struct picture *p, const struct look *look, const struct panel *panel,
			bool last)
{
	const struct machine *m = p->machine;
	const bool several = p->next || panel->curves > 1;
	int curves = 0;
	if (panel->x < 0)
		print_time(to, p, look, last);
	else
		print_over(to, p, look, panel->x);
	script_label(to, "ylabel", panel_label(p->view, panel));
	print_tics(to, p, look, panel);
	for (int k = 0; k < panel->curves && look->log_y; k++)
		check_log(p, 'y', panel->y[k]);
	for (const struct picture *q = p; q; q = q->next)
		for (int k = 0; k < panel->curves; k++, curves++) {
			const bool points = panel->x >= 0 && q->stride > 1;
			script_curve(to, curves, format("%s%s using %d:%d", points ? "$first" : "$data",
							number_of(p, q), panel->x + 2, panel->y[k] + 2),
				     q->label ? q->label : several ? m->output_names[panel->y[k]] : NULL,
				     points ? 0 : q->buckets * (q->stride > 1 ? 2 : 1));
		}
	putc('\n', to);
}

static int panels_of(const struct view *v)
{
	if (v->panels > PANELS)
		say_note(format("the first %d of %d panels are drawn", PANELS, v->panels));
	return v->panels < PANELS ? v->panels : PANELS;
}

void picture_draw(struct picture *p, const struct options *o)
{
	struct script *s = script_new(&o->look, o->plot_file, p->machine->name, NULL);
	const int panels = panels_of(p->view);
	bool over = false;
	for (const struct picture *q = p; q; q = q->next)
		print_data(script_data(s), q, number_of(p, q));
	for (int i = 0; i < panels; i++) {
		const struct panel *panel = &p->view->panel[i];
		const bool last = i == panels - 1 || panel[1].x >= 0;
		over = over || panel->x >= 0;
		print_panel(script_panel(s, panel_height(p->view, panel, last) + (p->next ? 0.2 : 0)), p, &o->look,
			    panel, last);
	}
	if (over && p->stride > 1)
		say_note(format("one output over another: a point in %llu steps",
				(unsigned long long)(p->stride * p->every)));
	script_draw(s);
}

/* ---- sweeps ---- */

/* Columns: run, the param, the values. */
static void print_curves(FILE *to, const struct machine *m, const struct panel *panel, const struct options *o)
{
	static const char *const what[] = { "final", "rms", "peak" };
	const int kinds = 2 + o->peak;
	script_label(to, "ylabel", panel_label(m->view, panel));
	for (int k = 0; k < panel->curves * kinds; k++) {
		const int column = panel->y[k / kinds];
		script_curve(to, k, format("$data using 2:%d", 3 + k % kinds * m->outputs + column),
			     panel->curves == 1 ? what[k % kinds]
						: format("%s of %s", what[k % kinds], m->output_names[column]),
			     2);                /* a mark on each */
	}
	putc('\n', to);
}

static void print_map(FILE *to, const struct machine *m, const struct panel *panel, const struct options *o)
{
	script_label(to, "title", format("%s of %s", o->peak ? "peak" : "rms", m->view->label[panel->y[0]]));
	fprintf(to, "splot $data using 2:3:%d with pm3d notitle\n", 4 + (1 + o->peak) * m->outputs + panel->y[0]);
}

static void print_range(FILE *to, char axis, const struct range *r, const char *label, bool log)
{
	const bool up = r->from < r->to;
	const double from = up ? r->from : r->to, end = up ? r->to : r->from;
	fprintf(to, "set %crange [%.17g:%.17g]\n", axis, from, end);
	if (log)
		script_log_tics(to, axis, from, end);
	script_label(to, format("%clabel", axis), label);
}

void picture_check(const struct view *v, const struct options *o)
{
	const int kinds = 2 + o->peak;
	for (int i = 0; i < v->panels; i++) {
		if (o->histories && v->panel[i].curves > 1)
			fail(WRONG_USAGE, "--histories: a panel shows one output of all runs; a comma begins another");
		if (o->histories)
			continue;
		if (v->panel[i].x >= 0)
			fail(WRONG_USAGE, "--show: one output over another is a picture of one run");
		if (v->panel[i].curves > 1 && o->ranges == 2)
			fail(WRONG_USAGE, "--show: a map shows one output; a comma begins another map");
		if (v->panel[i].curves * kinds > PICTURE_CURVES)
			fail(WRONG_USAGE, format("--show: a panel has at most %d curves, and each output of a sweep "
						 "is %d", PICTURE_CURVES, kinds));
	}
}

void picture_sweep(const struct machine *m, const struct options *o, const char *lines)
{
	const struct view *v = m->view;
	struct script *s = script_new(&o->look, o->plot_file, m->name, NULL);
	const int panels = panels_of(v);
	const bool map = o->ranges == 2;
	fprintf(script_data(s), "set datafile separator ','\n$data << END\n%sEND\n%s", lines,
		map ? "set view map\nset pm3d interpolate 4,4\nset palette defined "
		      "(0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')\nset lmargin 15\n"
		      "set rmargin 12\nunset grid\n" : "");
	for (int i = 0; i < panels; i++) {
		const bool last = map || i == panels - 1;
		FILE *to = script_panel(s, map ? 2 : panel_height(v, &v->panel[i], last) + 0.15);
		for (size_t r = 0; r < o->ranges; r++)
			print_range(to, r ? 'y' : 'x', &o->range[r], param_label(m, o->range[r].name),
				    o->range[r].log || o->look.log_x);
		if (o->look.log_y)
			fputs("set logscale y\n", to);
		if (!last)
			script_label(to, "xlabel", "");
		(map ? print_map : print_curves)(to, m, &v->panel[i], o);
	}
	script_draw(s);
}
