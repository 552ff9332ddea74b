/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truth STOPS FRICTIONS IMPACTS CHANGES WILD SEED SECONDS STEPS BITS SPEC FOUND: a random scene with at most so many
 * contacts of each kind and changes of the loads, WILD 1: of the wilder ones, as a spec of that many steps in that time
 * (a whole number), and how it moves: lines `scale T`, `event TIME CONTACT FROM TO` in order, `slowest SPEED`, `growth
 * FACTOR` (by which what is off at the start may be off in the end, at least 1), `end q1 ... q1' ...`. Status 2: this
 * scene decides nothing. Bounces that would be over within 2^-BITS of a step are those of a contact that rests. */
#include "truth.h"

#include <math.h>
#include <stdlib.h>

static struct truth found, nudged;

static void write_found(const struct scene *s, double growth, FILE *to)
{
	static const char *const kind[] = { "stop", "friction", "impact" };
	static const char *const mode[] = { "open", "closed", "resting", "backward", "sticking", "forward" };
	fprintf(to, "scale 1e%d\n", s->scale);
	for (int i = 0; i < found.events; i++)
		fprintf(to, "event %.17g %d_%s %s %s\n", found.event[i].time, found.event[i].contact,
			kind[s->contact[found.event[i].contact].kind], mode[found.event[i].from],
			mode[found.event[i].to]);
	fprintf(to, "slowest %.17g\ngrowth %.17g\nend", found.slowest, growth);
	for (int i = 0; i < 2 * s->n; i++)
		fprintf(to, " %.17g", i < s->n ? found.q[i] : found.v[i - s->n]);
	fprintf(to, "\n");
}

int main(int count, char **argument)
{
	static const double nudge = 1e-9;
	if (count != 12)
		return 1;
	const int most[4] = { atoi(argument[1]), atoi(argument[2]), atoi(argument[3]), atoi(argument[4]) };
	const bool wild = atoi(argument[5]);
	const struct scene s = scene_random((unsigned)atoi(argument[6]), most, wild);
	const double seconds = atof(argument[7]), brief = ldexp(seconds / atof(argument[8]), -atoi(argument[9]));
	FILE *spec = fopen(argument[10], "w"), *to = fopen(argument[11], "w");
	char step[64];
	double growth = 1;
	if (!spec || !to)
		return 1;
	snprintf(step, sizeof step, "%s/%s", argument[7], argument[8]);
	scene_write(&s, step, spec);
	truth_run(&s, seconds, brief, 0, &found);
	if ((wild || s.segments > 1) && !found.doubtful) {
		truth_run(&s, seconds, brief, nudge, &nudged);
		for (int i = 0; i < s.n; i++)
			growth = fmax(growth, fmax(fabs(nudged.q[i] - found.q[i]), fabs(nudged.v[i] - found.v[i])) /
				      nudge);
		growth = wild ? growth : fmax(1, 0.02 * fmin(growth, 1e5));     /* of which these take a part */
	}
	if (found.doubtful)
		fprintf(to, "doubtful: %s\n", found.doubt);
	write_found(&s, growth, to);
	return fclose(spec) || fclose(to) ? 1 : found.doubtful ? 2 : 0;
}
