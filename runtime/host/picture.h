/* SPDX-License-Identifier: MIT-0 */
/* How the pictures of plgen and plrun look. Colours, dashes and marks of curves have one order: the first output is the
 * same curve in every picture, and no two curves of a panel differ in hue alone. The colours are those of
 * bench/charts/palette.list, which a test measures: each has a contrast of 3:1 with white and with the dark
 * background. A sheet's lengths are points of a screen; on a paper, whose column is 85 mm wide, a quarter of a
 * millimetre each. */
#ifndef PL_PICTURE_H
#define PL_PICTURE_H

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PICTURE_CURVES = 8 };            /* in a panel */

static const struct picture_curve {
	const char *colour, *dash;      /* of gnuplot's `lc rgb` and `dt` */
	int mark;                       /* `pt` */
} picture_curve[PICTURE_CURVES] = {
	{ "#1f6fe0", "1", 7 }, { "#be3028", "(12,5)", 5 }, { "#5c9a52", "(3,3)", 9 }, { "#a3489e", "(14,4,3,4)", 13 },
	{ "#c48600", "(20,6)", 11 }, { "#6a6f78", "(7,4)", 6 }, { "#1f6fe0", "(3,6)", 4 },
	{ "#be3028", "(14,4,3,4,3,4)", 8 }
};

/* ---- a sheet ---- */

enum { PICTURE_WIDE = 900, PICTURE_COLUMN = 340, PICTURE_LINE = 17 };   /* of a screen, of a paper; a line of text */

struct picture_look {
	bool dark, paper;
	const char *title;              /* NULL: the picture's own */
	double width, height;           /* [px], of a paper [mm]; 0: as it comes */
};
struct picture_inks {
	const char *paper, *text, *frame, *grid, *faint;    /* faint: of lines from a label to what it is of */
};

static inline const struct picture_inks *picture_inks_of(const struct picture_look *look)
{
	static const struct picture_inks light = { "#ffffff", "#202020", "#606060", "#dddddd", "#a0a0a0" };
	static const struct picture_inks dark = { "#14171c", "#dde1e6", "#8b929c", "#363c45", "#6b727c" };
	return look->dark ? &dark : &light;
}

/* WIDTHxHEIGHT, each from 20 to 10000; false: it is none */
static inline bool picture_size(struct picture_look *look, const char *text)
{
	char *end;
	look->width = strtod(text, &end);
	if (end == text || *end != 'x')
		return false;
	text = end + 1;
	look->height = strtod(text, &end);
	return end > text && !*end && look->width >= 20 && look->width <= 10000 && look->height >= 20 &&
	       look->height <= 10000;
}

/* A length that is given, in points of the sheet; 0: none is */
static inline double picture_points(const struct picture_look *look, double given)
{
	return given * (look->paper ? 4 : 1);
}

/* How many letters of a text stand in its next line on a sheet so wide: lines end where words do */
static inline size_t picture_line(const char *text, double width)
{
	const size_t letters = width / 8 > 20 ? (size_t)(width / 8) : 20, length = strlen(text);
	size_t fits = letters;
	if (length <= letters)
		return length;
	while (fits > 0 && text[fits] != ' ')
		fits--;
	return fits > 0 ? fits : letters;
}

/* The terminal of gnuplot for svg, png or pdf; returns the size of its letters. `names`: what names inside of an SVG
 * begin with, NULL: as they come */
static inline double picture_terminal(FILE *to, const struct picture_look *look, const char *as, double width,
				      double height, const char *names)
{
	const bool paper = look->paper, pdf = strcmp(as, "pdf") == 0, png = strcmp(as, "png") == 0;
	const double dots = 600 / 25.4 / 4;     /* of a print, to a point of the paper */
	const double scale = pdf ? (paper ? 0.025 : 0.0254) : png ? (paper ? dots : 1) : paper ? 96 / 25.4 / 4 : 1;
	const double letters = pdf ? (paper ? 8 : 9) : png ? (paper ? 8 * dots : 11) : paper ? 10.5 : 12;
	const char *background = picture_inks_of(look)->paper;
	if (pdf)
		fprintf(to, "set term pdfcairo noenhanced size %.3fcm,%.3fcm fontscale 1", width * scale,
			height * scale);
	else if (png)
		fprintf(to, "set term pngcairo noenhanced size %.0f,%.0f linewidth %.2f pointscale %.2f", width * scale,
			height * scale, scale, scale);
	else
		fprintf(to, "set term svg noenhanced size %.0f,%.0f%s%s%s", width * scale, height * scale,
			names ? " name \"" : "", names ? names : "", names ? "\"" : "");
	fprintf(to, " font 'sans,%.1f' background '%s'\n", letters, background);
	return letters;
}

/* The colours of all that is text, grid and border, behind a `reset` */
static inline void picture_colours(FILE *to, const struct picture_look *look)
{
	static const char *const text[] = { "xtics", "ytics", "cbtics", "xlabel", "ylabel", "title", "key" };
	const struct picture_inks *inks = picture_inks_of(look);
	fprintf(to, "set encoding utf8\nset grid lt 1 lc rgb '%s'\nset border lc rgb '%s'\n", inks->grid, inks->frame);
	for (size_t i = 0; i < sizeof text / sizeof *text; i++)
		fprintf(to, "set %s textcolor rgb '%s'\n", text[i], inks->text);
}

/* A title over a sheet, as labels, from this line on; returns the line behind it */
static inline int picture_heading(FILE *to, const struct picture_look *look, const char *text, int line, double width,
				  double height)
{
	for (; *text; line++) {
		const size_t length = picture_line(text, width);
		fprintf(to, "set label %d '", line + 1);
		for (size_t i = 0; i < length; i++)
			fprintf(to, text[i] == '\'' ? "''" : "%c", text[i]);
		fprintf(to, "' noenhanced at screen 0.5,%.6f center textcolor rgb '%s'\n",
			1 - PICTURE_LINE * (0.8 + line) / height, picture_inks_of(look)->text);
		text += length + strspn(text + length, " ");
	}
	return line;
}

/* How many lines that takes */
static inline int picture_heading_lines(const char *text, double width)
{
	int lines = 0;
	for (; *text; lines++) {
		text += picture_line(text, width);
		text += strspn(text, " ");
	}
	return lines;
}

#endif
