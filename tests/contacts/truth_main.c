/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truth STOPS FRICTIONS IMPACTS CHANGES SEED SECONDS SPEC FOUND: a random scene with at most so many contacts of each
 * kind and changes of the loads, as a spec, and how it moves: lines `event TIME CONTACT FROM TO` in order, `slowest
 * SPEED`, `growth` of an error at the start, `end q1 ... q1' ...`. Status 2: this scene decides nothing. Bounces that
 * would be over within 2^-23 of a step are those of a contact that rests. */
#include "truth.h"

#include <math.h>
#include <stdlib.h>

static struct truth found, beside;

/* By what an error at the start has grown at the end, seen on one of 1e-9 */
static double growth(const struct scene *s)
{
	double most = 1;
	for (int i = 0; i < s->n; i++) {
		most = fmax(most, fabs(beside.q[i] - found.q[i]) / 1e-9);
		most = fmax(most, fabs(beside.v[i] - found.v[i]) / 1e-9);
	}
	return fmin(most, 1e5);
}

static void write_found(const struct scene *s, FILE *to)
{
	static const char *const kind[] = { "stop", "friction", "impact" };
	static const char *const mode[] = { "open", "closed", "resting", "backward", "sticking", "forward" };
	for (int i = 0; i < found.events; i++)
		fprintf(to, "event %.17g %d_%s %s %s\n", found.event[i].time, found.event[i].contact,
			kind[s->contact[found.event[i].contact].kind], mode[found.event[i].from],
			mode[found.event[i].to]);
	fprintf(to, "slowest %.17g\ngrowth %.3g\nend", found.slowest, growth(s));
	for (int i = 0; i < 2 * s->n; i++)
		fprintf(to, " %.17g", i < s->n ? found.q[i] : found.v[i - s->n]);
	fprintf(to, "\n");
}

int main(int count, char **argument)
{
	if (count != 9)
		return 1;
	const int most[4] = { atoi(argument[1]), atoi(argument[2]), atoi(argument[3]), atoi(argument[4]) };
	const struct scene s = scene_random((unsigned)atoi(argument[5]), most);
	FILE *spec = fopen(argument[7], "w"), *to = fopen(argument[8], "w");
	if (!spec || !to)
		return 1;
	scene_write(&s, spec);
	truth_run(&s, 1e-9, atof(argument[6]), (double)s.step / 1000 / (1 << 23), &beside);
	truth_run(&s, 0, atof(argument[6]), (double)s.step / 1000 / (1 << 23), &found);
	if (found.doubtful)
		fprintf(to, "doubtful: %s\n", found.doubt);
	write_found(&s, to);
	return fclose(spec) || fclose(to) ? 1 : found.doubtful ? 2 : 0;
}
