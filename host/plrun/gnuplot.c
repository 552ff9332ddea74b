/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gnuplot draws: a script of panels below each other, under a title. Lengths are points of a screen; on a paper, whose
 * column is 85 mm wide, a quarter of a millimetre each. Legends stand above their panel, never on a curve. */
#define _GNU_SOURCE
#include "plrun.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 900, COLUMN = 340, LINE = 17, LINES = 12 };

struct script {
	const struct look *look;
	const char *file, *title, *subtitle;
	FILE *data;
	int panels;
	struct { char *text; size_t length; double height; } *panel;
	FILE *open;                             /* the panel that is being written */
};

struct inks {
	const char *paper, *text, *frame, *grid;
};
static const struct inks light = { "#ffffff", "#202020", "#606060", "#dddddd" };
static const struct inks dark = { "#14171c", "#dde1e6", "#8b929c", "#363c45" };

struct script *script_new(const struct look *look, const char *file, const char *title, const char *subtitle)
{
	const char *display = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
	struct script *s = need(calloc(1, sizeof *s));
	if (!file && !(display && *display) && !(wayland && *wayland))
		fail(WRONG_DATA, "there is no display for a window: --plot FILE.svg draws a file");
	*s = (struct script){ look, file, look->title ? look->title : title, subtitle, need(tmpfile()), 0, NULL, NULL };
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
	int lines;                              /* of the heading */
	char *line[LINES];
};

/* The heading as lines that end where words do, none longer than the sheet is wide */
static int heading_of(const struct script *s, double width, char *line[])
{
	const size_t letters = (size_t)fmax(20, width / 8);
	const char *text[] = { s->title, s->subtitle ? s->subtitle : "" };
	int lines = 0;
	for (int i = 0; i < 2; i++)
		for (const char *c = text[i]; *c && lines < LINES;) {
			size_t length = strlen(c), fits = letters;
			while (length > letters && fits > 0 && c[fits] != ' ')
				fits--;
			length = length > letters && fits > 0 ? fits : length;
			line[lines++] = need(strndup(c, length));
			c += length + strspn(c + length, " ");
		}
	return lines;
}

static struct sheet sheet_of(const struct script *s)
{
	const double scale = s->look->paper ? 4 : 1;
	struct sheet sheet = { .width = s->look->paper ? COLUMN : WIDTH };
	if (s->look->width > 0)
		sheet.width = s->look->width * scale;
	sheet.lines = heading_of(s, sheet.width, sheet.line);
	for (int i = 0; i < s->panels; i++)
		sheet.panels += s->panel[i].height;
	sheet.top = 10 + LINE * sheet.lines;
	sheet.height = s->look->height > 0 ? s->look->height * scale
		     : sheet.top + 25 + sheet.panels * (s->look->paper ? 140 : 180);
	return sheet;
}

/* Nothing of the file's name is in the script: the picture comes out of gnuplot's standard output. */
static void print_terminal(FILE *to, const struct script *s, const struct sheet *sheet)
{
	const struct inks *inks = s->look->dark ? &dark : &light;
	const char *end = s->file ? s->file + strlen(s->file) - 3 : "";
	const bool paper = s->look->paper;
	const double png = paper ? 600 / 25.4 / 4 : 1, svg = paper ? 96 / 25.4 / 4 : 1;
	if (!s->file)
		return;
	if (strcmp(end, "pdf") == 0)
		fprintf(to, "set term pdfcairo noenhanced size %.3fcm,%.3fcm font 'sans,%s' fontscale 1 background "
			    "'%s'\n", sheet->width * (paper ? 0.025 : 0.0254), sheet->height * (paper ? 0.025 : 0.0254),
			paper ? "8" : "9", inks->paper);
	else if (strcmp(end, "png") == 0)
		fprintf(to, "set term pngcairo noenhanced size %.0f,%.0f font 'sans,%.1f' linewidth %.2f "
			    "pointscale %.2f background '%s'\n", sheet->width * png, sheet->height * png,
			paper ? 8 * png : 11.0, png, png, inks->paper);
	else
		fprintf(to, "set term svg noenhanced size %.0f,%.0f font 'sans,%.1f' background '%s'\n",
			sheet->width * svg, sheet->height * svg, paper ? 10.5 : 12.0, inks->paper);
}

static void print_check(FILE *to, const struct script *s, const struct sheet *sheet)
{
	const struct inks *inks = s->look->dark ? &dark : &light;
	fprintf(to, "set encoding utf8\nset grid lt 1 lc rgb '%s'\nset border lc rgb '%s'\nset lmargin %d\n"
		    "set rmargin 3\nset key outside top left horizontal Left reverse samplen 4 textcolor rgb '%s'\n",
		inks->grid, inks->frame, sheet->width < 500 ? 10 : 12, inks->text);
	for (const char *const *part = (const char *const[]){ "xtics", "ytics", "cbtics", "xlabel", "ylabel", "title",
	     NULL }; *part; part++)
		fprintf(to, "set %s textcolor rgb '%s'\n", *part, inks->text);
	fprintf(to, "set format y '%%.5g'\nset format cb '%%.5g'\n");
}

static void print_panels(FILE *to, const struct script *s, const struct sheet *sheet)
{
	const struct inks *inks = s->look->dark ? &dark : &light;
	const double left = sheet->height - sheet->top - 5;
	double bottom = sheet->height - sheet->top;
	fputs("set multiplot\n", to);
	for (int i = 0; i < sheet->lines; i++) {
		fprintf(to, "set label %d ", i + 1);
		print_quoted(to, sheet->line[i]);
		fprintf(to, " noenhanced at screen 0.5,%.6f center textcolor rgb '%s'\n",
			1 - LINE * (0.8 + i) / sheet->height, inks->text);
	}
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
	print_terminal(script, s, &sheet);
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
