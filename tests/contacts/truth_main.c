/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truth STOPS FRICTIONS IMPACTS CHANGES WILD SEED SECONDS (STEPS BITS SPEC FOUND)...: a random scene with at most so
 * many contacts of each kind and changes of the loads, WILD 1: of the wilder ones, 2: with forces that are not
 * piecewise linear, as specs of that many steps in that time (a whole number), and how it moves: lines `scale T`,
 * `event TIME CONTACT FROM TO` in order, `slowest SPEED`, `growth FACTOR` (by which what is off at the start may be off
 * in the end, at least 1), `end q1 ... q1' ...`. A first line `doubtful: WHY`: this scene decides nothing; status 2
 * where that is so with all steps. Bounces that would be over within 2^-BITS of a step are those of a contact that
 * rests. */
#include "truth.h"

#include <math.h>
#include <stdlib.h>

static struct truth found[MOST_VIEWS], nudged[MOST_VIEWS];

static void write_found(const struct scene *s, const struct truth *f, double growth, FILE *to)
{
	static const char *const kind[] = { "stop", "friction", "impact" };
	static const char *const mode[] = { "open", "closed", "resting", "backward", "sticking", "forward" };
	if (f->doubtful)
		fprintf(to, "doubtful: %s\n", f->doubt);
	fprintf(to, "scale 1e%d\n", s->scale);
	for (int i = 0; i < f->events; i++)
		fprintf(to, "event %.17g %d_%s %s %s\n", f->event[i].time, f->event[i].contact,
			kind[s->contact[f->event[i].contact].kind], mode[f->event[i].from], mode[f->event[i].to]);
	fprintf(to, "slowest %.17g\ngrowth %.17g\nend", f->slowest, growth);
	for (int i = 0; i < 2 * s->n; i++)
		fprintf(to, " %.17g", i < s->n ? f->q[i] : f->v[i - s->n]);
	fprintf(to, "\n");
}

/* By how much a nudge at the start has grown */
static double growth_of(const struct scene *s, bool wild, const struct truth *f, const struct truth *n, double nudge)
{
	double growth = 1;
	for (int i = 0; i < s->n; i++)
		growth = fmax(growth, fmax(fabs(n->q[i] - f->q[i]), fabs(n->v[i] - f->v[i])) / nudge);
	return wild ? growth : fmax(1, 0.02 * fmin(growth, 1e5));       /* of which these take a part */
}

/* The spec and what was found; 0: written */
static int write_view(const struct scene *s, char **argument, const char *seconds, const struct truth *f, double growth)
{
	FILE *spec = fopen(argument[2], "w"), *to = fopen(argument[3], "w");
	char step[64];
	if (!spec || !to)
		return 1;
	snprintf(step, sizeof step, "%s/%s", seconds, argument[0]);
	scene_write(s, step, spec);
	write_found(s, f, growth, to);
	return fclose(spec) | fclose(to);
}

int main(int count, char **argument)
{
	static const double nudge = 1e-9;
	enum { FIRST = 8 };
	const int views = (count - FIRST) / 4;
	if (views < 1 || views > MOST_VIEWS || count != FIRST + 4 * views)
		return 1;
	const int most[4] = { atoi(argument[1]), atoi(argument[2]), atoi(argument[3]), atoi(argument[4]) };
	const bool wild = atoi(argument[5]) == 1;
	struct scene s = scene_random((unsigned)atoi(argument[6]), most, wild);
	if (atoi(argument[5]) == 2)
		scene_leave(&s);
	const double seconds = atof(argument[7]);
	double brief[MOST_VIEWS];
	for (int k = 0; k < views; k++)
		brief[k] = ldexp(seconds / atof(argument[FIRST + 4 * k]), -atoi(argument[FIRST + 4 * k + 1]));
	truth_run(&s, seconds, views, brief, 0, found);
	bool decided = false, grows = wild || s.segments > 1;
	for (int k = 0; k < views; k++)
		decided = decided || !found[k].doubtful;
	if (grows && decided)
		truth_run(&s, seconds, views, brief, nudge, nudged);
	for (int k = 0; k < views; k++) {
		const double growth = grows && !found[k].doubtful
			? growth_of(&s, wild, &found[k], &nudged[k], nudge) : 1;
		if (write_view(&s, argument + FIRST + 4 * k, argument[7], &found[k], growth) != 0)
			return 1;
	}
	return decided ? 0 : 2;
}
