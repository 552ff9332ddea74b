/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modes of a model over a param. */
#ifndef PLGEN_REPORT_CAMPBELL_H
#define PLGEN_REPORT_CAMPBELL_H

#include "report/report.h"

enum whirl { WHIRL_NONE, WHIRL_PLANAR, WHIRL_FORWARD, WHIRL_BACKWARD, WHIRL_MIXED };

/* Forward is from the first to the second; by: how it was found */
struct whirl_pair { int first, second; const char *by; };
struct whirl_mode {
	struct mode_shape shape;
	double re, im;                  /* [1/s], [rad/s] */
	double hertz, ratio;            /* of the motion, damped; damping ratio */
	enum whirl whirl;
	double measure;                 /* 1: in circles forward, -1: backward */
	int branch;                     /* its number over all values */
};
struct modes_at { double value; int modes; struct whirl_mode *mode; };
struct whirl_crossing { double order, value; int branch; struct whirl_mode mode; };
struct campbell {
	/* The model with this definition, NAME=VALUE; leaves the statement where there is none */
	const struct model *(*build)(void *context, const char *definition);
	void *context;
	const char *param, *unit, *name;
	double hertz;                   /* of a value of 1 */
	double from, to;
	int values, n, orders, pairs, branches, crossings;
	double *order;
	const char *const *coord;
	struct whirl_pair *pair;
	struct modes_at *at;
	struct whirl_crossing *crossing;
};

/* ---- campbell.c ---- */

void find_campbell(struct campbell *c, const char *sweep, const char *orders, const char *pairs); /* NULL: by itself */
const struct whirl_mode *mode_of_branch(const struct modes_at *at, int branch); /* NULL: it has none there */

/* ---- campbell_picture.c ---- */

void print_campbell(FILE *to, const struct campbell *c, const struct picture_look *look, enum picture_format as);

#endif
