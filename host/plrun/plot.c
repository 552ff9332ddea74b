/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures by gnuplot. Of a run: a panel for each output over one axis of time; a long run is kept as the least and the
 * largest value of each output in buckets of equal length, more of them than a picture has points across. Of a sweep: a
 * panel for each output over the range, or a map over two. */
#define _GNU_SOURCE
#include "plrun.h"

#include <stdlib.h>
#include <string.h>

enum { BUCKETS = 8192, PANELS = 12 };   /* BUCKETS: even */

struct picture {
	const struct machine *machine;
	double h;
	uint64_t every;                 /* steps from one sample to the next */
	int panels;
	uint64_t stride;                /* samples of a bucket */
	size_t buckets;
	double *least, *largest;        /* BUCKETS x panels */
};

struct picture *picture_new(const struct machine *m, double h, uint64_t every)
{
	struct picture *p = need(calloc(1, sizeof *p));
	*p = (struct picture){ .machine = m, .h = h, .every = every, .stride = 1 };
	p->panels = m->outputs < PANELS ? m->outputs : PANELS;
	p->least = need(calloc((size_t)BUCKETS * (size_t)p->panels, sizeof(double)));
	p->largest = need(calloc((size_t)BUCKETS * (size_t)p->panels, sizeof(double)));
	return p;
}

/* Bucket `from` with what is in [least, largest] too */
static void widen(struct picture *p, size_t bucket, const double *least, const double *largest)
{
	double *low = p->least + bucket * (size_t)p->panels, *high = p->largest + bucket * (size_t)p->panels;
	for (int i = 0; i < p->panels; i++) {
		low[i] = least[i] < low[i] ? least[i] : low[i];
		high[i] = largest[i] > high[i] ? largest[i] : high[i];
	}
}

static void begin_bucket(struct picture *p, size_t bucket, const double *least, const double *largest)
{
	size_t n = (size_t)p->panels;
	memmove(p->least + bucket * n, least, n * sizeof *least);
	memmove(p->largest + bucket * n, largest, n * sizeof *largest);
}

static void halve(struct picture *p)
{
	size_t n = (size_t)p->panels;
	for (size_t b = 0; b < BUCKETS; b++) {
		if (b % 2 == 0)
			begin_bucket(p, b / 2, p->least + b * n, p->largest + b * n);
		else
			widen(p, b / 2, p->least + b * n, p->largest + b * n);
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
		begin_bucket(p, bucket, out, out);
		p->buckets++;
	} else {
		widen(p, bucket, out, out);
	}
}

/* ---- gnuplot's words ---- */

static void print_quoted(FILE *to, const char *text)
{
	for (putc('\'', to); *text; text++)
		fprintf(to, *text == '\'' ? "''" : "%c", *text);
	putc('\'', to);
}

static void print_row(FILE *to, const struct picture *p, size_t bucket, const double *value)
{
	char text[LONGEST];
	*put_time(text, bucket * p->stride * p->every, p->h, p->machine->single) = 0;
	fputs(text, to);
	for (int i = 0; i < p->panels; i++) {
		*put_shortest(text, value[bucket * (size_t)p->panels + (size_t)i], p->machine->single) = 0;
		fprintf(to, " %s", text);
	}
	putc('\n', to);
}

/* A bucket of one step is a point; of more it is two, and the line between them is what happens in it. */
static void print_data(FILE *to, const struct picture *p)
{
	fputs("$data << END\n", to);
	for (size_t b = 0; b < p->buckets; b++) {
		print_row(to, p, b, p->least);
		if (p->stride > 1)
			print_row(to, p, b, p->largest);
	}
	fputs("END\n", to);
}

/* Nothing of the file's name is in the script: the picture comes out of gnuplot's standard output. */
static void print_terminal(FILE *to, int panels, const char *file)
{
	int height = 120 + (panels == 1 ? 360 : 180 * panels);
	const char *end = file ? file + strlen(file) - 3 : "";
	if (!file)
		return;
	if (strcmp(end, "pdf") == 0)
		fprintf(to, "set term pdfcairo noenhanced size %.1fin,%.1fin font 'sans,10'\n", 9.0, height / 100.0);
	else
		fprintf(to, "set term %s noenhanced size 900,%d font 'sans,11' background '#ffffff'\n",
			strcmp(end, "png") == 0 ? "pngcairo" : "svg", height);
}

static void print_panels(FILE *to, const struct picture *p)
{
	double end = (double)((p->buckets ? p->buckets - 1 : 0) * p->stride * p->every) * p->h;
	fprintf(to, "set multiplot layout %d,1 title ", p->panels);
	print_quoted(to, p->machine->name);
	fprintf(to, " noenhanced\nset grid lt 1 lc rgb '#dddddd'\nset lmargin 12\nset rmargin 3\nunset key\n"
		    "set xrange [0:%g]\nset offsets 0,0,graph 0.05,graph 0.05\nset format y '%%.3g'\n",
		end > 0 ? end : 1.0);
	for (int i = 0; i < p->panels; i++) {
		fputs("set ylabel ", to);
		print_quoted(to, p->machine->output_names[i]);
		fprintf(to, " noenhanced\n%splot $data using 1:%d with %s lc rgb '#1f5fa8' lw 1.2\n",
			i == p->panels - 1 ? "set xlabel 't [s]'\n" : "", i + 2, p->buckets > 1 ? "lines" : "points");
	}
	fputs("unset multiplot\n", to);
}

static void write_picture(const struct said *said, const char *file)
{
	struct output *output;
	FILE *to = output_open(file, &output);
	fwrite(said->out, 1, said->out_length, to);
	output_done(output, to);
}

static void check_display(const char *file)
{
	const char *display = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
	if (!file && !(display && *display) && !(wayland && *wayland))
		fail(WRONG_DATA, "there is no display for a window: --plot FILE.svg draws a file");
}

/* -d: gnuplot without what the user has it do at its start */
static void draw(FILE *script, const char *file)
{
	const char *window[] = { "gnuplot", "-d", "--persist", "-", NULL }, *drawn[] = { "gnuplot", "-d", "-", NULL };
	struct said said = { 0 };
	char *error = run_command(file ? drawn : window, script, &said);
	if (!error && said.status)
		error = format("gnuplot could not draw:\n%s", said.err);
	if (error)
		fail(WRONG_DATA, error);
	if (file)
		write_picture(&said, file);
	fclose(script);
}

static void say_panels(int panels, const struct machine *m)
{
	if (panels < m->outputs)
		say_note(format("the first %d of %d outputs are drawn", panels, m->outputs));
}

void picture_draw(struct picture *p, const char *file)
{
	FILE *script = need(tmpfile());
	check_display(file);
	say_panels(p->panels, p->machine);
	print_terminal(script, p->panels, file);
	print_data(script, p);
	print_panels(script, p);
	draw(script, file);
}

/* ---- sweeps ---- */

static void print_label(FILE *to, char axis, const char *text)
{
	fprintf(to, "set %clabel ", axis);
	print_quoted(to, text);
	fputs(" noenhanced\n", to);
}

/* Curves of one output over one range: they differ in points and dashes, too. Columns: run, the param, the values. */
static void print_curves(FILE *to, const struct machine *m, int output, bool peak)
{
	static const char *const what[] = { "final", "rms", "peak" };
	static const char *const style[] = { "pt 7 dt 1 lc rgb '#1f5fa8'", "pt 4 dt 2 lc rgb '#d55e00'",
					     "pt 8 dt 4 lc rgb '#333333'" };
	print_label(to, 'y', m->output_names[output]);
	for (int k = 0; k < 2 + peak; k++)
		fprintf(to, "%s $data using 2:%d with linespoints title '%s' ps 0.5 lw 1.2 %s", k ? "," : "plot",
			3 + k * m->outputs + output, what[k], style[k]);
	putc('\n', to);
}

static void print_map(FILE *to, const struct machine *m, int output, bool peak)
{
	fputs("set title ", to);
	print_quoted(to, format("%s of %s", peak ? "peak" : "rms", m->output_names[output]));
	fprintf(to, " noenhanced\nsplot $data using 2:3:%d with pm3d notitle\n",
		4 + (1 + peak) * m->outputs + output);
}

static void print_axis(FILE *to, char axis, const struct range *r, bool map)
{
	const bool up = r->from < r->to;
	fprintf(to, "set %crange [%.17g:%.17g]\n", axis, up ? r->from : r->to, up ? r->to : r->from);
	fprintf(to, "set %clabel offset %d,0\n", axis, axis == 'y' && map ? -3 : 0);
	if (r->log)
		fprintf(to, "set logscale %c\n", axis);
	print_label(to, axis, r->name);
}

void picture_sweep(const struct machine *m, const struct options *o, const char *lines)
{
	FILE *script = need(tmpfile());
	const int panels = m->outputs < PANELS ? m->outputs : PANELS;
	const bool map = o->ranges == 2;
	check_display(o->plot_file);
	say_panels(panels, m);
	print_terminal(script, map ? 2 * panels : panels, o->plot_file);
	fprintf(script, "set datafile separator ','\n$data << END\n%sEND\n", lines);
	fprintf(script, "set multiplot layout %d,1 title ", panels);
	print_quoted(script, m->name);
	fputs(" noenhanced\nset grid lt 1 lc rgb '#dddddd'\nset lmargin 12\nset key outside right\n"
	      "set format y '%.3g'\n", script);
	for (size_t i = 0; i < o->ranges; i++)
		print_axis(script, i ? 'y' : 'x', &o->range[i], map);
	if (map)
		fputs("set view map\nset pm3d interpolate 4,4\nset format cb '%.3g'\nset palette defined "
		      "(0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')\n", script);
	for (int i = 0; i < panels; i++)
		(map ? print_map : print_curves)(script, m, i, o->peak);
	fputs("unset multiplot\n", script);
	draw(script, o->plot_file);
}
