/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The runs of one model for precision.c: their errors, their times, their rows of the table. */
#ifndef PRECISION_LINES_H
#define PRECISION_LINES_H

#include "charts.h"

#include <stdio.h>

struct line {                       /* one row of the table */
	struct method ours;             /* of ours */
	const struct method *method;
	double setting;
	struct run *run;                /* NULL: refused or failed to open */
	char file[200];                 /* of ours, in the folder of variants */
	char *refused;
	char found[120];                /* columns of the table: five errors, failed, evaluations per unit */
	double largest;                 /* of the errors; NAN: failed, or there is no run */
	int rung;                       /* of the ladder of one method's settings, from the cheapest; 0: its first */
	struct samples samples;
	double pass;                    /* ns per unit of one more pass, by itself; 0: not taken */
	bool dear;                      /* too dear to be timed: sample_ladders */
};

struct lines {
	struct line *line;
	int count;
	double agreement;               /* of the truth's two roads */
};

const struct method *method_of(const struct line *line);
/* All that is no time, against the truth */
void find_errors(struct lines *lines, const struct problem *p, const struct truth *t);
/* FOLDER/NAME.errors keeps these: first what the problem learns of its truth, then a line a run, which is its name,
 * setting and columns. The same bytes whenever it is written. */
void keep_errors(const struct lines *lines, const struct problem *p, const char *folder);
/* The problem's scales alone, before a run is opened; false: there is no such file */
bool read_scales(struct lines *lines, struct problem *p, const char *folder);
/* Leaves the program where the file has not the same runs */
void read_errors(struct lines *lines, const struct problem *p, const char *folder);
/* Once errors are known: of what did not fail. A ladder is a peer's tolerances from the widest on, and a narrower one
 * takes no less time. So where a pass is long and one setting takes 20 times what is cheapest at the error of the next,
 * that and all after it are left without a time: they could only be dearer still. */
void find_times(struct lines *lines, double seconds);
void put_head(FILE *out);
void put_line(FILE *out, const struct lines *lines, const struct line *line, const struct problem *p);

#endif
