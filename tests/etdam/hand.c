/* SPDX-License-Identifier: MIT-0 */
/* runtime/normal.h without the generator: models by hand without stiffness, all of whose forces are left over, beside
 * their closed forms. Compiled for doubles, and with REAL_IS_FLOAT for floats. */
#include "real.h"
#include "tap.h"

#include <math.h>

#ifdef REAL_IS_FLOAT
#define IN_FLOAT 1
#define EXACT 2e-5
#else
#define IN_FLOAT 0
#define EXACT 1e-12
#endif

/* Nodes 0, 1/2, 1: modes at the others, and how they change, gain these times h^2 and h of the forces there */
static const double gain[2][2][3] = {
	{{7.0 / 96, 1.0 / 16, -1.0 / 96}, {5.0 / 24, 1.0 / 3, -1.0 / 24}},
	{{1.0 / 6, 1.0 / 3, 0}, {1.0 / 6, 2.0 / 3, 1.0 / 6}},
};

static real gained(int node, int row, real h, real first, real middle, real last)
{
	const double *g = gain[node - 1][row];
	return (real)(g[0] * (double)first + g[1] * (double)middle + g[2] * (double)last) * (row ? h : h * h);
}

/* ---- x'' = -2 sin x cos^3 x, of which atan t is one, by three past forces, evaluated twice ---- */

#define bent_H ((real)0.015625)

typedef struct bent {
	real y[2], eta[1], rate[1], force[3][1], past[3][2][1];
	int k, which, newest, known, status;
} bent;

static void bent_modes_of(int which, const real q[], real mode[]) { (void)which, mode[0] = q[0]; }
static void bent_of_modes(int which, const real mode[], real q[]) { (void)which, q[0] = mode[0]; }
static void bent_pass_time(bent *s, const real u[]) { (void)u, s->k++; }
static void bent_look(bent *s) { (void)s; }

static void bent_mode_forces(const bent *s, int which, const real f[], const real eta[], const real rate[],
						   real force[])
{
	(void)s, (void)which, (void)f, (void)rate;
	force[0] = (real)(-2 * sin((double)eta[0]) * pow(cos((double)eta[0]), 3));
}

static void bent_node_modes(const bent *s, int which, int node, real force[3][1], const real forcing[], real eta[],
							   real rate[])
{
	const real h = bent_H, to = h * (real)node / 2;
	(void)which, (void)forcing;
	eta[0] = s->eta[0] + to * s->rate[0] + gained(node, 0, h, force[0][0], force[1][0], force[2][0]);
	rate[0] = s->rate[0] + gained(node, 1, h, force[0][0], force[1][0], force[2][0]);
}

static void bent_predict(const bent *s, int which, const real forcing[], real eta[], real rate[], real expected[])
{
	const double now = (double)s->force[s->newest][0], before = (double)s->force[(s->newest + 2) % 3][0];
	const double first = (double)s->force[(s->newest + 1) % 3][0];
	const real h = bent_H;
	(void)which, (void)forcing;
	eta[0] = s->eta[0] + h * s->rate[0] + h * h * (real)(19 * now / 24 - 5 * before / 12 + first / 8);
	rate[0] = s->rate[0] + h * (real)(23 * now / 12 - 4 * before / 3 + 5 * first / 12);
	expected[0] = (real)(3 * now - 3 * before + first);
}

static const real bent_correct[1][2][1] = {{{bent_H * bent_H * 19 / 180}, {bent_H * 3 / 8}}};

/* Parabolas through 0, 1/2, 1; cubics through 0, -1, -2, 1 */
static const real bent_of_nodes[] = {4, -1, -4, 2};
static const real bent_of_past[] = {-1, (real)1 / 6, (real)1 / 3, (real)0.5, 0, (real)0.5, (real)0.5, (real)-1 / 6,
									(real)1 / 6};
static const real bent_stiffness[1][1] = {{0}};

#define PL(name) bent_##name
#define PL_TYPE bent
#define PL_H bent_H
#define PL_MODES 1
#define PL_WIDTH 1
#define PL_POINTS 3
#define PL_TWICE 1
#define PL_STAGES 2
#define PL_FIRST_SWEEPS 6
#define PL_FUNCTIONS 0
#define PL_FORCINGS 0
#define PL_OPERATORS 1
#define PL_STEADY 0
#define PL_AT 1
#define PL_TERMS 6
#define PL_TURNS 1
#define PL_DAMPED 0
void bent_step(bent *s);
void bent_at(const bent *s, real tau, real y[2]);
#include "normal.h"

static void check_bent(void)
{
	bent s = {.y = {0, 1}};
	double worst = 0, within = 0;
	int k;
	bent_place(&s);
	ok(s.known == 0 && s.newest == 2, "bent: nothing is known at first");
	for (k = 1; k <= 128; k++) {
		const double t = k * (double)bent_H, inside = t - 0.375 * (double)bent_H;
		real y[2];
		bent_at(&s, (real)0.625 * bent_H, y);
		within = fmax(within, fabs((double)y[0] - atan(inside)));
		within = fmax(within, fabs((double)y[1] - 1 / (1 + inside * inside)));
		bent_step(&s);
		worst = fmax(worst, fabs((double)s.eta[0] - atan(t)));
		worst = fmax(worst, fabs((double)s.rate[0] - 1 / (1 + t * t)));
	}
	is_close(worst, 0, fmax(1.5e-7, EXACT), "bent: 128 steps, beside atan t");
	is_close(within, 0, fmax(1.5e-7, EXACT), "bent: inside them");
	ok(s.known == 3 && s.k == 128 && s.status == 0, "bent: three forces are known");
	s.eta[0] = (real)NAN;
	bent_step(&s);
	ok((s.status & PL_NOT_FINITE) != 0, "bent: what is not finite is told");
}

/* ---- a point in the plane under p(t) in x and cos t in y, p = 2, then t from 1 s on, then 0 from 3 s on, in frames:
 * that of the second operator, which serves while 2 - |2 - t| is above 1.5, is turned by 0.3.  By collocation, which is
 * exact here. ---- */

#define plane_H ((real)0.125)

typedef struct plane {
	real y[4], eta[2], rate[2], force[3][2], past[3][2][2], f[3][2];
	int k, segment, which, known, status;
} plane;

static const pl_two plane_change[2] = {{1, 0}, {3, 0}};
static const double turned_by = 0.3;

static real plane_time(const plane *s) { return (real)s->k * plane_H; }
static real plane_until(const plane *s, int change) { return (real)plane_change[change].hi - plane_time(s); }
static void plane_pass_time(plane *s, const real u[]) { (void)u, s->k++; }
static void plane_look(plane *s) { (void)s; }

static void plane_modes_of(int which, const real q[], real mode[])
{
	const double c = which ? cos(turned_by) : 1, d = which ? sin(turned_by) : 0;
	const double x = (double)q[0], y = (double)q[1];
	mode[0] = (real)(c * x + d * y);
	mode[1] = (real)(c * y - d * x);
}

static void plane_functions(const plane *s, int node, real start, real f[])
{
	const real t = plane_time(s) + plane_H * (real)node / 2;
	f[0] = start < 1 ? 2 : start < 3 ? t : 0;
	f[1] = t < 2 ? t : 4 - t;
}

static void plane_forcings(const plane *s, real forcing[])
{
	forcing[0] = (real)cos((double)plane_time(s));
	forcing[1] = (real)sin((double)plane_time(s));
}

static void plane_mode_forces(const plane *s, int which, const real f[], const real eta[], const real rate[],
			      real force[])
{
	const real q[2] = {f[0], 0};
	(void)s, (void)eta, (void)rate;
	plane_modes_of(which, q, force);
}

/* What cos t adds in `to` [s] to the y of a point, or to its speed */
static double of_load(int row, double to, const real forcing[])
{
	const double c = (double)forcing[0], d = (double)forcing[1];
	return row ? c * sin(to) + d * (cos(to) - 1) : c * (1 - cos(to)) + d * (sin(to) - to);
}

static void plane_node_modes(const plane *s, int which, int node, real force[3][2], const real forcing[], real eta[],
							 real rate[])
{
	const real h = plane_H, to = h * (real)node / 2;
	const real y[2] = {0, (real)of_load(0, (double)to, forcing)},
			speed[2] = {0, (real)of_load(1, (double)to, forcing)};
	real of_y[2], of_speed[2];
	int i;
	plane_modes_of(which, y, of_y);
	plane_modes_of(which, speed, of_speed);
	for (i = 0; i < 2; i++) {
		eta[i] = s->eta[i] + to * s->rate[i] + gained(node, 0, h, force[0][i], force[1][i],
				force[2][i]) + of_y[i];
		rate[i] = s->rate[i] + gained(node, 1, h, force[0][i], force[1][i], force[2][i]) + of_speed[i];
	}
}

/* By the polynomial through them: at 1, 3/2 and 2 of the step before */
static void plane_forces_ahead(const plane *s, real force[3][2])
{
	int i;
	for (i = 0; i < 2; i++) {
		force[0][i] = s->force[2][i];
		force[1][i] = s->force[0][i] - 3 * s->force[1][i] + 3 * s->force[2][i];
		force[2][i] = 3 * s->force[0][i] - 8 * s->force[1][i] + 6 * s->force[2][i];
	}
}

/* Of the first operator: [2 x, 2 y, x', y'], amplitudes being scaled by 2 */
static void plane_still(const real x[], const real forcing[], real sum[])
{
	sum[0] = x[0] + 2 * plane_H * x[2];
	sum[1] = x[1] + 2 * plane_H * x[3] + (real)(2 * of_load(0, (double)plane_H, forcing));
	sum[2] = x[2];
	sum[3] = x[3] + (real)of_load(1, (double)plane_H, forcing);
}

static const real plane_bound[1] = {(real)1.5}, plane_omega[2][2] = {{2, 2}, {(real)0.5, (real)0.5}};
static const real plane_next[1][2][2] = {
	{{(real)-0.04466351087439402, (real)0.29552020666133955}, /* cos 0.3 - 1, sin 0.3 */
	 {(real)-0.29552020666133955, (real)-0.04466351087439402}},
};

#define PL(name) plane_##name
#define PL_TYPE plane
#define PL_SINGLE IN_FLOAT
#define PL_H plane_H
#define PL_MODES 2
#define PL_WIDTH 2
#define PL_POINTS 0
#define PL_TWICE 0
#define PL_STAGES 2
#define PL_SWEEPS 1
#define PL_FIRST_SWEEPS 2
#define PL_FUNCTIONS 2
#define PL_FORCINGS 2
#define PL_OPERATORS 2
#define PL_SELECTOR 1
#define PL_SEGMENTS 3
#define PL_STEADY 1
#define PL_STEADY_IN 0
void plane_step(plane *s);
#include "normal.h"

/* Of x'' = p(t) from rest at 0 */
static double x_at(double t)
{
	const double later = t < 3 ? t : 3, part = later - 1;
	const double x = t < 1 ? t * t : 1 + 2 * part + part * part / 2 + part * part * part / 6;
	return x + (t > 3 ? (t - 3) * (2 + 4) : 0);
}

static void check_plane(void)
{
	plane s = {.y = {0, 0, 0, (real)0.5}};
	double worst = 0;
	int k, turned = 0, early = 0;
	plane_place(&s);
	for (k = 1; k <= 40; k++) {
		const double t = k * (double)plane_H;
		real q[2];
		plane_step(&s);
		plane_modes_of(s.which, s.eta, q);
		if (s.which) {                  /* back: the inverse of a turn is the one the other way */
			q[0] = (real)(cos(turned_by) * (double)s.eta[0] - sin(turned_by) * (double)s.eta[1]);
			q[1] = (real)(sin(turned_by) * (double)s.eta[0] + cos(turned_by) * (double)s.eta[1]);
		}
		worst = fmax(worst, fabs((double)q[0] - x_at(t)));
		worst = fmax(worst, fabs((double)q[1] - (0.5 * t + 1 - cos(t))));
		turned += s.which == 1;
		early += s.segment != (t >= 3 ? 2 : t >= 1 ? 1 : 0);
	}
	is_close(worst, 0, 20 * EXACT, "plane: 40 steps, beside the closed form");
	ok(turned == 7, "plane: the second operator serves where its value is above the bound");
	ok(early == 0, "plane: formulas change at the ends of steps");
	ok(s.known == 0 && s.status == 0, "plane: once nothing changes, no step before counts");
	s = (plane){.y = {0}, .k = 7};
	plane_place(&s);
	s.segment = 0;
	s.k = 9;
	plane_step(&s);
	ok(s.segment == 1 && s.known == 0 && (s.status & PL_INACCURATE) != 0, "plane: a change inside a step is told");
}

int main(void)
{
	check_bent();
	check_plane();
	return tap_end();
}
