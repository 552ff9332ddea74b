/* SPDX-License-Identifier: MIT-0 */
#include "followed.h"
#include "worse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct truth truth_of(const struct switched_system *s)
{
	struct truth truth = { .most = 0 };
	real y[HAND_MOST] = { 0 };
	memcpy(y, s->start, sizeof s->start);
	after_change = 0;
	place_switched(s, 0, y);
	/* exactly on a breakpoint: where it is going */
	if (s->start[1] == 0 && s->states == 2) {
		real ahead[HAND_MOST] = { 0 };
		memcpy(ahead, y, sizeof s->start);
		gragg(s->f, s->states, 0, 1e-6L, 1, 0, NULL, ahead);
		place_switched(s, 1e-6L, ahead);
	}
	memcpy(truth.y[0], y, sizeof truth.y[0]);
	for (int k = 1; k <= SAMPLES; k++) {
		truth.count += follow_switched(s, (real)(k - 1) / PARTS, (real)k / PARTS, y, truth.crossed
				+ truth.count,
									  ROOM - truth.count);
		memcpy(truth.y[k], y, sizeof truth.y[k]);
		for (int i = 0; i < s->states; i++)
			truth.most = fmax(truth.most, (double)fabsl(y[i]));
	}
	return truth;
}

struct found follow(const struct variant *v, const struct switched_system *s, const struct truth *truth)
{
	const pl_model *m = v->model;
	const int steps = (int)lround(1 / m->h);
	struct found found = { 0, 0, 0, 0 };
	pl_crossing crossing[MOST_EVENTS];
	double y[MOST_STATES];
	void *state = calloc(1, m->size);
	m->init(state);
	for (int k = 1; k <= SECONDS * steps; k++) {
		m->step(state, NULL);
		const int count = v->crossings(state, crossing);
		for (int i = 0; i < count && found.count + i < truth->count; i++)
			found.time = worse(found.time, fabs((k - 1) * m->h + crossing[i].time -
									(double)truth->crossed[found.count + i]));
		found.count += count;
		if (k * PARTS % steps != 0)
			continue;
		m->get(state, y);
		for (int i = 0; i < s->states; i++)
			found.error = worse(found.error,
						(double)fabsl(y[i] - truth->y[k * PARTS / steps][i]) / truth->most);
	}
	found.status = m->status(state);
	if (found.count != (int)v->crossed(state))
		found.count = -1;
	free(state);
	return found;
}

const struct variant *variant_in(const struct variant *table, const char *name)
{
	while (table->model && strcmp(table->model->name, name) != 0)
		table++;
	return table->model ? table : NULL;
}
