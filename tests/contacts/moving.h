/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene in one segment of time and mode of its contacts, as equations and as a series; rows over x: moving.c. */
#ifndef MOVING_H
#define MOVING_H

#include "polynomial.h"
#include "truth.h"

#include <math.h>
#include <stdlib.h>

enum { MOST = 5 * MOST_MASSES + 4 };
typedef mpfr_t row[MOST];

struct moving {
	const struct scene *s;
	int size, one, left, segment;   /* entries of x; where 1 is, and what is left */
	int degree;                     /* of its series; those of what is left take products of all */
	enum mode mode[MOST_CONTACTS];
	mpfr_t A[MOST][MOST];
	row force[MOST_CONTACTS];       /* what holds a contact that sticks or rests, along its direction */
	row x;
	mpfr_t series[DEGREE + 1][MOST];
	mpfr_t square[MOST_MASSES][DEGREE + 1], cosine[MOST_MASSES][DEGREE + 1];        /* of q */
	mpfr_t rate[MOST_MASSES][DEGREE + 1];   /* the k-th of q, times k */
	mpfr_t time, tiny;
	int views;
	struct view {
		double brief;
		bool hidden[MOST_CONTACTS];     /* its bounces are listed no more */
		struct truth *found;
	} view[MOST_VIEWS];
};

void row_start(mpfr_t *r, int count);
void row_stop(mpfr_t *r, int count);
void thousandths(mpfr_ptr to, long value);
void dot(int n, mpfr_t *a, mpfr_t *b, mpfr_ptr sum);
void doubt_view(struct truth *found, const char *why);
void doubt(struct moving *m, const char *why);
bool decides(const struct moving *m);
int share(const struct contact *c, int mass);
void fill_equations(struct moving *m);
void measure(const struct moving *m, int index, int derivative, mpfr_t *r);
void measure_now(struct moving *m, int index, int derivative, mpfr_ptr value);
bool guard(const struct moving *m, int index, int which, mpfr_t *r);
void expand(struct moving *m, int degree);
int first_sign(struct moving *m, mpfr_t *r, int from);
void check_limits(struct moving *m);

#endif
