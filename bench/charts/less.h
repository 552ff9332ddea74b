/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LESS_H
#define LESS_H

#include <complex.h>

enum { MODES = 80 };

/* q_i'' + 2 zeta w_i q_i' + w_i^2 q_i = b_i u,  y = sum c_i q_i + d u */
struct modal {
	int modes;
	double zeta, w[MODES], b[MODES], c[MODES], d;
};

/* The same as y = sum c (s - p)^-1 u over these poles and the conjugates of what is complex */
struct poles { int count; double complex p[MODES], c[MODES]; };
/* To an even number r of states, and those decoupled: less_balance.c */
void balance(const struct modal *m, int r, struct poles *out);

#endif
