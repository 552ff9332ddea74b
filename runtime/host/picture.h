/* SPDX-License-Identifier: MIT-0 */
/* How curves look in the pictures of plgen and plrun: colours, dashes and marks in one order, so that the first output
 * is the same curve in every picture and no two curves of a panel differ in hue alone.  The colours are those of
 * bench/charts/palette.list, which a test measures: each has a contrast of 3:1 with white and with the dark
 * background. */
#ifndef PL_PICTURE_H
#define PL_PICTURE_H

enum { PICTURE_CURVES = 8 };            /* in a panel */

static const struct picture_curve {
	const char *colour, *dash;      /* of gnuplot's `lc rgb` and `dt` */
	int mark;                       /* `pt` */
} picture_curve[PICTURE_CURVES] = {
	{ "#1f6fe0", "1", 7 }, { "#be3028", "(12,5)", 5 }, { "#5c9a52", "(3,3)", 9 }, { "#a3489e", "(14,4,3,4)", 13 },
	{ "#c48600", "(20,6)", 11 }, { "#6a6f78", "(7,4)", 6 }, { "#1f6fe0", "(3,6)", 4 },
	{ "#be3028", "(14,4,3,4,3,4)", 8 }
};

#endif
