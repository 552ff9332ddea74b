/* SPDX-License-Identifier: MIT-0 */
/* Random systems whose state chooses formulas, each in two variants (steps of 1/4 and 1/32, or by radau and auto):
 * every crossing, and the states, beside the equations by hand with crossings located in long double. TABLE=1:
 * figures. */
#include VARIANTS
#include "random_system.h"
#include "tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SECONDS = 10, SAMPLES = 4 * SECONDS };

struct figures {
	double error, most;
	int count, status;
};

static struct figures follow(const struct variant *v, const struct switched_system *s,
							 const real truth[SAMPLES + 1][MOST_OF_STATES])
{
	const pl_model *m = v->model;
	const int each = (int)lround(0.25 / m->h);
	double y[MOST_STATES];
	struct figures f = { 0, 0, 0, 0 };
	void *state = calloc(1, m->size);
	m->init(state);
	for (int k = 1; k <= SAMPLES; k++) {
		m->run(state, (size_t)each, NULL, NULL);
		m->get(state, y);
		for (int i = 0; i < s->states; i++) {
			f.error = worse(f.error, (double)fabsl(y[i] - truth[k][i]));
			f.most = fmax(f.most, (double)fabsl(truth[k][i]));
		}
	}
	f.count = (int)v->crossed(state);
	f.status = m->status(state);
	free(state);
	return f;
}

int main(void)
{
	double worst = 0;
	int crossings = 0;
	for (const struct variant *v = VARIANT_TABLE; v->model;) {
		const unsigned seed = (unsigned)strtoul(v->model->name + strlen("random"), NULL, 10);
		const struct switched_system s = random_switched(seed);
		static real truth[SAMPLES + 1][MOST_OF_STATES];
		real y[HAND_MOST] = { 0 }, times[1000], ahead[HAND_MOST] = { 0 };
		int count = 0;
		memcpy(y, s.start, sizeof s.start);
		memcpy(ahead, y, sizeof s.start);
		place_switched(&s, 0, y);
		gragg(s.f, s.states, 0, 1e-6L, 1, 0, NULL, ahead);  /* from rest: where it is going */
		place_switched(&s, 1e-6L, ahead);
		for (int k = 1; k <= SAMPLES; k++) {
			count += follow_switched(&s, (k - 1) / 4.0L, k / 4.0L, y, times, 1000);
			memcpy(truth[k], y, sizeof truth[k]);
		}
		crossings += count;
		for (int variant = 0; variant < 2; variant++, v++) {
			const struct figures f = follow(v, &s, (const real (*)[MOST_OF_STATES])truth);
			worst = worse(worst, f.error / f.most);
			if (!ok(f.count == count && f.status == 0 && f.error < 1e-7 * f.most, "%s: %d crossings",
					v->model->name,
					count))
				note("%d crossings, off by %.3g, status %d", f.count, f.error / f.most, f.status);
			if (getenv("TABLE"))
				note("%.3g", f.error / f.most);
		}
	}
	note("%d crossings, off by %.3g at most", crossings, worst);
	return tap_end();
}
