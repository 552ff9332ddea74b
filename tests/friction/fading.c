/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fading F0 F1 S0 S1 C W X STEPS H: x'' + x + friction(x', F, S) = C cos(W t) from rest at X, F = F0 + F1 t while that
 * is above 0, S = S0 + S1 t while that is above F. Between two events in closed form, these by bisection, all in long
 * double. Prints x and x' after so many steps of h. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef long double real;

static real f0, f1, s0, s1, c, w;
static real t, x, v;
static int way;                         /* it slides: 1, -1; it sticks: 0 */

static real force(real at)
{
	return fmaxl(f0 + f1*at, 0);
}

static real held(real at)
{
	return fmaxl(s0 + s1*at, force(at));
}

static real pull(real at)
{
	return c*cosl(w*at) - x;
}

/* After so long, in which the formula of F stays the one of its middle */
static void slide(real dt, real *x_then, real *v_then)
{
	const real end = t + dt, load = c/(1 - w*w), brakes = f0 + f1*(t + dt/2) > 0 ? way : 0;
	const real y = x - load*cosl(w*t) + brakes*(f0 + f1*t), u = v + load*w*sinl(w*t) + brakes*f1;
	*x_then = load*cosl(w*end) - brakes*(f0 + f1*end) + y*cosl(dt) + u*sinl(dt);
	*v_then = -load*w*sinl(w*end) - brakes*f1 - y*sinl(dt) + u*cosl(dt);
}

/* Sticks, or slides the way that it is pulled */
static void decide(void)
{
	way = fabsl(pull(t)) <= held(t) ? 0 : pull(t) > 0 ? 1 : -1;
}

/* Whether it is let go, or turns round, within dt */
static int is_over(real dt)
{
	real y, u;
	if (way == 0)
		return fabsl(pull(t + dt)) > held(t + dt);
	slide(dt, &y, &u);
	return way*u < 0;
}

static void advance(real dt)
{
	real y = x, u = 0;
	const int over = is_over(dt);
	real before = 0;
	for (int i = 0; i < 80 && over; i++) {
		const real middle = (before + dt)/2;
		*(is_over(middle) ? &dt : &before) = middle;
	}
	if (way != 0)
		slide(dt, &y, &u);
	t += dt;
	x = y;
	v = over ? 0 : u;
	if (over && way == 0)
		way = pull(t) > 0 ? 1 : -1;
	else if (over)
		decide();
}

int main(int count, char **argument)
{
	real *all[] = { &f0, &f1, &s0, &s1, &c, &w, &x };
	if (count != 10)
		return 2;
	for (int i = 0; i < 7; i++)
		*all[i] = strtold(argument[i + 1], NULL);
	const real end = strtold(argument[8], NULL)*strtold(argument[9], NULL), gone = f1 < 0 ? -f0/f1 : -1;
	decide();
	while (t < end) {
		real dt = fminl(end - t, 1e-3L);
		if (t < gone && t + dt > gone)
			dt = gone - t;
		advance(dt);
	}
	printf("%.18Lg %.18Lg\n", x, v);
	return 0;
}
