/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same models against CVODE with its root finding: it stops where an expression passes a breakpoint, and begins
 * anew with the formulas behind. STIFF: by BDF, beside radau. */
#ifdef STIFF
#include "stiff_variants.h"
#define VARIANT_TABLE stiff_table
#define SUFFIX "radau11"
#define SYSTEMS switched_stiff
#define SYSTEM_COUNT switched_stiff_count
#define METHOD CV_BDF
#else
#include "events_variants.h"
#define VARIANT_TABLE events_table
#define SUFFIX "by13"
#define SYSTEMS switched_systems
#define SYSTEM_COUNT switched_count
#define METHOD CV_ADAMS
#endif
#include "../cvode.h"
#include "systems.h"
#include "tap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SECONDS = 6 };

static int slopes(sunrealtype t, N_Vector y, N_Vector dydt, void *context)
{
	const struct switched_system *s = context;
	real now[HAND_MOST] = { 0 }, d[HAND_MOST];
	for (int i = 0; i < s->states; i++)
		now[i] = NV_Ith_S(y, i);
	s->f(t, now, NULL, d);
	for (int i = 0; i < s->states; i++)
		NV_Ith_S(dydt, i) = (double)d[i];
	return 0;
}

static int distances(sunrealtype t, N_Vector y, sunrealtype *g, void *context)
{
	const struct switched_system *s = context;
	real now[HAND_MOST] = { 0 }, e[MOST_EXPRESSIONS];
	int roots = 0;
	for (int i = 0; i < s->states; i++)
		now[i] = NV_Ith_S(y, i);
	s->e(t, now, e);
	for (int i = 0; i < s->expressions; i++)
		for (int k = 0; k < s->breaks[i]; k++)
			g[roots++] = (double)(e[i] - s->at[i][k]);
	return 0;
}

/* y at the end; how many roots. From one stop to the next */
static int solve(const struct switched_system *s, double *end)
{
	struct cvode c;
	int roots = 0, most = 0, found[MOST_EXPRESSIONS * MOST_BREAKS];
	double t = 0;
	for (int i = 0; i < s->states; i++)
		end[i] = (double)s->start[i];
	for (int i = 0; i < s->expressions; i++)
		most += s->breaks[i];
	cvode_open(&c, METHOD, s->states, end, slopes, (void *)(size_t)s, 1e-13, 1e-14, NULL);
	CVodeRootInit(c.memory, most, distances);
	while (t < SECONDS) {
		const double to = s->change > 0 && !after_change ? (double)s->change : SECONDS;
		CVodeSetStopTime(c.memory, to);
		const int flag = CVode(c.memory, to, c.y, &t, CV_NORMAL);
		if (flag == CV_ROOT_RETURN) {
			int root = 0;
			CVodeGetRootInfo(c.memory, found);
			for (int i = 0; i < s->expressions; i++)
				for (int k = 0; k < s->breaks[i]; k++, root++) {
					interval_of[i] += found[root];
					roots += found[root] != 0;
				}
		} else if (flag < 0) {
			roots = -1;
			break;
		} else if (to < SECONDS) {
			after_change = 1;
		}
		CVodeReInit(c.memory, t, c.y);
	}
	for (int i = 0; i < s->states; i++)
		end[i] = NV_Ith_S(c.y, i);
	cvode_close(&c);
	return roots;
}

static void check(const struct switched_system *s)
{
	char name[64];
	double y[MOST_STATES], end[MOST_STATES], worst = 0, most = 0;
	real start[HAND_MOST] = { 0 };
	const struct variant *v = VARIANT_TABLE;
	(void)snprintf(name, sizeof name, "%s_" SUFFIX "_0", s->name);
	while (strcmp(v->model->name, name) != 0)
		v++;
	memcpy(start, s->start, sizeof s->start);
	after_change = 0;
	place_switched(s, 0, start);
	gragg(s->f, s->states, 0, 1e-6L, 1, 0, NULL, start);    /* from rest on a breakpoint: where it is going */
	place_switched(s, 1e-6L, start);
	const int roots = solve(s, end);
	void *state = calloc(1, v->model->size);
	v->model->init(state);
	v->model->run(state, (size_t)lround(SECONDS / v->model->h), NULL, NULL);
	v->model->get(state, y);
	for (int i = 0; i < s->states; i++) {
		worst = worse(worst, fabs(y[i] - end[i]));
		most = fmax(most, fabs(end[i]));
	}
	if (!ok(worst < 1e-9 * most && (int)v->crossed(state) == roots, "%s: %d roots", s->name, roots))
		note("off by %.3g, %d crossings", worst / most, (int)v->crossed(state));
	free(state);
}

int main(void)
{
	for (int i = 0; i < SYSTEM_COUNT; i++)
		check(&SYSTEMS[i]);
	return tap_end();
}
