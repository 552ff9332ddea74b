/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For what grammar.c writes: the functions of specs, in C.  AGAIN is the model's name. */
#include <math.h>

#define JOIN2(a, b) a##_##b
#define JOIN(a, b) JOIN2(a, b)
#define NAME(suffix) JOIN(AGAIN, suffix)

extern const int NAME(coords)[];
void NAME(residual)(double t, const double *y, const double *u, const double *top, double *r);
void NAME(wanted)(double t, const double *y, const double *u, const double *top, double *out);

__attribute__((unused)) static double sgn(double x)
{
	return (x > 0) - (x < 0);
}

__attribute__((unused)) static double deadzone(double x, double low, double high)
{
	return x < low ? x - low : x > high ? x - high : 0;
}

__attribute__((unused)) static double clip(double x, double low, double high)
{
	return x < low ? low : x > high ? high : x;
}

/* Through three points, and on along the end slopes. */
__attribute__((unused)) static double table3(double x, double x0, double y0, double x1, double y1, double x2, double y2)
{
	return x < x1 ? y0 + (x - x0) * ((y1 - y0) / (x1 - x0)) : y1 + (x - x1) * ((y2 - y1) / (x2 - x1));
}
