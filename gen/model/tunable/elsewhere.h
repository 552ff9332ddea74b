/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model at other values of its tunable params. */
#ifndef PLGEN_MODEL_ELSEWHERE_H
#define PLGEN_MODEL_ELSEWHERE_H

#include "math/math.h"
#include "model/model.h"
#include "tuning.h"

struct retuned_row;

/* ---- elsewhere.c: a model at other values of its tunable params, and how its entries follow from these ---- */

enum { PLACES = 2 };                /* where it is looked at; what is equal at both is equal for all values */
struct difference {                 /* two models may not have it; with another value of a param ... */
	bool (*same)(const struct model *, const struct model *);
	const char *text, *note;
};
struct elsewhere {
	const struct model *model;
	const struct request *request;
	struct tuning *tuning;      /* params, the spec's values */
	const bool *factor;         /* as in struct request */
	const mpq_t *near;          /* places lie about these values, within 1e-7 of their size; NULL: anywhere */
	int differences;
	const struct difference *difference;
	mpq_t *(*read)(struct elsewhere *s, const struct model *model);     /* its entries */
	ptrdiff_t entries;
	const struct model *other;  /* at the first place */
	struct model *found;
	mpq_t *values;              /* params there */
	int places;                 /* looked at so far */
	mpq_ptr *seen[PLACES];      /* entries there, NULL: 0 */
	mpq_t zero;
};

struct listing {                    /* retuned_rows.c: the numbers of one model, in columns of x */
	const struct model *model;
	const struct layout *x;
	int segments;               /* that outputs have, of time */
	int rows;
	struct retuned_row *row;
	mpq_t *entry;               /* rows x columns */
};
struct listing list_rows(const struct model *model, const struct layout *x, int segments);
/* An output, whose loads have so many segments of time, in one of these, or as x in all */
void row_of_output(const struct layout *x, const struct linear *system, const struct output *output, int segments,
		   int segment, mpq_t *row);
/* factors.c */
const bool *find_factors(struct building *b);   /* per tunable param, of regions: it cannot go as a held input */

#endif
