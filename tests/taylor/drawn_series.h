/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equations that drawn_series.c draws; drawn_truth.c has the coefficients of their solution. */
#ifndef DRAWN_SERIES_H
#define DRAWN_SERIES_H

#include <math.h>
#include <mpc.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    SECOND = 12, COORDS = 20, STATES = COORDS + SECOND, INPUTS = 2, TEXT = 200, MOST_NODES = 4000, MOST_ORDER = 20,
    BITS = 480, RADIUS = 16,
    RUNS = 2,                           /* the plain one, and with rounding */
    MOST_SIZE = 40                      /* of an expression */
};

enum kind {
    NUMBER, TIME, INPUT, STATE,
    PIECES,                             /* a: what holds of a function of t with kinks or jumps, whose text is `text` */
    CHOICE,                             /* a or b, one by `text` and one else */
    ADD, SUBTRACT, MULTIPLY, DIVIDE, POWER, ATAN2, SQRT, EXP, LOG, SIN, COS, TAN, ASIN, ACOS, ATAN,
    SINH, COSH, TANH, KINDS
};

extern struct node {
    enum kind kind;
    int a, b, size;
    bool used, forked;                  /* something in it has another formula at other times */
    bool holds;                         /* of a choice: a, else b */
    double value;                       /* at the start; of a number itself */
    char text[TEXT];
    mpc_t z;
    double rounding[MOST_ORDER + 1];
} node[MOST_NODES];
extern int nodes, root[COORDS];
extern double start_time, h, initial[STATES], mass[COORDS][2];
extern bool driven;                     /* by `held` and `ramp` */
extern double sample[INPUTS][2];        /* before and at the end */

/* 0 .. n - 1, drawn */
int below(int n);
const char *state_name(int i);

void make_truth(int order);

#endif
