/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pendulum x'' + sin x = 0 from rest at x0, 0 < x0 < pi, in closed form: sin(x/2) = k sn(t + K), x' = 2 k cn(t +
 * K), k = sin(x0/2). */
#ifndef ELLIPTIC_H
#define ELLIPTIC_H

void pendulum_swing(double x0, double t, double y[2]);

#endif
