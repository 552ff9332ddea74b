/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gnuplot draws: a script of panels below each other, under a title. Legends stand above their panel, never on a
 * curve. */
#define _GNU_SOURCE
#include "plrun.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct script {
	const struct look *look;
	const char *file, *title, *subtitle;
	FILE *data;
	int panels;
	struct { char *text; size_t length; double height; } *panel;
	FILE *open;                             /* the panel that is being written */
};

struct script *script_new(const struct look *look, const char *file, const char *title, const char *subtitle)
{
	const char *display = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
	struct script *s = need(calloc(1, sizeof *s));
	if (!file && !(display && *display) && !(wayland && *wayland))
		fail(WRONG_DATA, "there is no display for a window: --plot FILE.svg draws a file");
	*s = (struct script){ .look = look, .file = file, .title = look->as.title ? look->as.title : title,
			      .subtitle = subtitle, .data = need(tmpfile()) };
	return s;
}

FILE *script_data(struct script *s)
{
	return s->data;
}

static void close_panel(struct script *s)
{
	if (s->open)
		fclose(s->open);
	s->open = NULL;
}

FILE *script_panel(struct script *s, double height)
{
	close_panel(s);
	s->panel = need(reallocarray(s->panel, (size_t)s->panels + 1, sizeof *s->panel));
	s->panel[s->panels].height = height;
	s->open = need(open_memstream(&s->panel[s->panels].text, &s->panel[s->panels].length));
	s->panels++;
	return s->open;
}

static void print_quoted(FILE *to, const char *text)
{
	for (putc('\'', to); *text; text++)
		fprintf(to, *text == '\'' ? "''" : "%c", *text);
	putc('\'', to);
}

void script_label(FILE *to, const char *what, const char *text)
{
	fprintf(to, "set %s ", what);
	print_quoted(to, text);
	fputs(" noenhanced\n", to);
}

void script_curve(FILE *to, int k, const char *data, const char *title, size_t points)
{
	const struct picture_curve *c = &picture_curve[k % PICTURE_CURVES];
	fprintf(to, "%s %s with ", k ? "," : "plot", data);
	if (points < 2)
		fprintf(to, "points pt %d ps 0.4", c->mark);
	else if (title)                 /* marks of curves that lie on each other stand apart */
		fprintf(to, "linespoints lw 1.3 dt %s pt %d ps 0.6 pi %zu", c->dash, c->mark,
			points / (9 + (size_t)k) + 1);
	else
		fputs("lines lw 1.3", to);
	fprintf(to, " lc rgb '%s' %s", c->colour, title ? "title " : "notitle");
	if (title)
		print_quoted(to, title);
	fputs(title ? " noenhanced" : "", to);
}

void script_tics(FILE *to, char axis, double from, double end)
{
	const double size = pow(10, floor(log10((end - from) / 4))), more = (end - from) / 4 / size;
	if (end > from && size > 0)
		fprintf(to, "set %ctics %.3g\n", axis,
			size * (more <= 1 ? 1 : more <= 2 ? 2 : more <= 5 ? 5 : 10));
}

void script_log_tics(FILE *to, char axis, double from, double end)
{
	static const int digit[] = { 1, 2, 5 };
	const int most = end < 100 * from ? 3 : 1;      /* of a decade */
	const char *between = "";
	fprintf(to, "set logscale %c\nset %ctics (", axis, axis);
	for (int decade = (int)floor(log10(from)); decade <= log10(end); decade++)
		for (int k = 0; k < most; k++, between = ", ")
			fprintf(to, "%s%de%d", between, digit[k], decade);
	fputs(")\n", to);
}

/* ---- a sheet ---- */

struct sheet {
	double width, height, top, panels;      /* panels: their heights together */
};

static struct sheet sheet_of(const struct script *s)
{
	const struct picture_look *as = &s->look->as;
	struct sheet sheet = { .width = as->paper ? PICTURE_COLUMN : PICTURE_WIDE };
	if (as->width > 0)
		sheet.width = picture_points(as, as->width);
	for (int i = 0; i < s->panels; i++)
		sheet.panels += s->panel[i].height;
	sheet.top = 10 + PICTURE_LINE * (picture_heading_lines(s->title, sheet.width) +
					 picture_heading_lines(s->subtitle ? s->subtitle : "", sheet.width));
	sheet.height = as->height > 0 ? picture_points(as, as->height)
		     : sheet.top + 25 + sheet.panels * (as->paper ? 140 : 180);
	return sheet;
}

static void print_check(FILE *to, const struct script *s, const struct sheet *sheet)
{
	picture_colours(to, &s->look->as);
	fprintf(to, "set lmargin %d\nset rmargin 3\nset key outside top left horizontal Left reverse samplen 4\n"
		    "set format y '%%.5g'\nset format cb '%%.5g'\n", sheet->width < 500 ? 10 : 12);
}

static void print_panels(FILE *to, const struct script *s, const struct sheet *sheet)
{
	const double left = sheet->height - sheet->top - 5;
	double bottom = sheet->height - sheet->top;
	fputs("set multiplot\n", to);
	const int line = picture_heading(to, &s->look->as, s->title, 0, sheet->width, sheet->height);
	picture_heading(to, &s->look->as, s->subtitle ? s->subtitle : "", line, sheet->width, sheet->height);
	for (int i = 0; i < s->panels; i++) {
		const double height = left * s->panel[i].height / sheet->panels;
		bottom -= height;
		fprintf(to, "set origin 0,%.6f\nset size 1,%.6f\n%s\nunset label\n", bottom / sheet->height,
			height / sheet->height, s->panel[i].text);
	}
	fputs("unset multiplot\n", to);
}

/* ---- gnuplot itself ---- */

static void write_picture(const struct said *said, const char *file)
{
	struct output *output;
	FILE *to = output_open(file, &output);
	fwrite(said->out, 1, said->out_length, to);
	output_done(output, to);
}

/* -d: gnuplot without what the user has it do at its start */
void script_draw(struct script *s)
{
	const char *window[] = { "gnuplot", "-d", "--persist", "-", NULL }, *drawn[] = { "gnuplot", "-d", "-", NULL };
	struct said said = { 0 };
	FILE *script = need(tmpfile());
	close_panel(s);
	const struct sheet sheet = sheet_of(s);
	/* Nothing of the file's name is in the script: the picture comes out of gnuplot's standard output. */
	if (s->file)
		picture_terminal(script, &s->look->as, s->file + strlen(s->file) - 3, sheet.width, sheet.height, NULL);
	print_check(script, s, &sheet);
	rewind(s->data);
	for (int c; (c = getc(s->data)) != EOF;)
		putc(c, script);
	print_panels(script, s, &sheet);
	char *error = run_command(s->file ? drawn : window, script, &said);
	if (!error && said.status)
		error = format("gnuplot could not draw:\n%s", said.err);
	if (error)
		fail(WRONG_DATA, error);
	if (s->file)
		write_picture(&said, s->file);
	fclose(s->data);
	fclose(script);
}
