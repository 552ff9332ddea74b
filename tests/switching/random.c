/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random systems with stops, at steps so long that several crossings fall into one, against the same model at a
 * hundredth of the step and against the system by hand in long double. Beside it, what the sign test at the ends of the
 * same steps misses.
 *
 * The models are in the header VARIANTS and in TABLE, their kind and seeds in KIND, FIRST and COUNT. */
#include "drive.h"
#include "random_system.h"
#include VARIANTS
#include "tap.h"

#include <math.h>
#include <string.h>

enum { STEPS = 4, SECONDS = 24 };
static const double tolerance = 1e-9;       /* of end states, over the largest value of the kind */
static const double steps[STEPS] = { 0.5, 1, 2, 4 };

static struct sums {
	int systems, states[STEPS], counts[STEPS], sign_states[STEPS], sign_counts[STEPS];
	long crossings;
	double worst, worst_by_hand;
} sums;

static double sizes(const struct hand_system *s, const real *y)
{
	double size = 0.1;
	for (int i = 0; i < 2 * s->n; i++)
		size = fmax(size, fabs((double)y[i]));
	return size;
}

static double apart(const struct hand_system *s, const double *a, const double *b, double size)
{
	double most = 0;
	for (int i = 0; i < 2 * s->n; i++)
		most = fmax(most, isfinite(a[i]) ? fabs(a[i] - b[i]) / size : INFINITY);
	return most;
}

static void narrow(const struct hand_system *s, const struct hand_state *wide, double *y)
{
	for (int i = 0; i < 2 * s->n; i++)
		y[i] = (double)wide->y[i];
}

static struct hand_state by_signs(const struct hand_system *s, real h)
{
	struct hand_state now;
	hand_start(s, &now);
	hand_until(s, &now, SECONDS, h);
	return now;
}

static bool at_step(const struct hand_system *s, unsigned seed, int step, const struct run *fine, const double *y,
	double size)
{
	const struct variant *of = variant_of(TABLE, KIND "%u_%d", seed, step);
	struct run r = run_new(of);
	struct hand_state sign;
	double found[MOST_STATES], by_sign[MOST_STATES];
	run_until(&r, SECONDS);
	run_state(&r, found);
	const double off = apart(s, found, y, size);
	sums.worst = worse(sums.worst, off);
		const bool state_good =
			close_to(off, 0, tolerance, KIND " %u, h = %g: end state, h = 0.005", seed, steps[step]);
        const bool count_good = close_to((double)of->crossed(r.state), (double)fine->of->crossed(fine->state), 0,
		KIND " %u, h = %g: crossings", seed, steps[step]);
		const bool status_good =
			close_to(of->model->status(r.state), 0, 0, KIND " %u, h = %g: status", seed, steps[step]);
		sums.states[step] += !state_good;
	sums.counts[step] += !count_good;
	sign = by_signs(s, steps[step]);
	narrow(s, &sign, by_sign);
	sums.sign_states[step] += !(apart(s, by_sign, y, size) <= tolerance);
	sums.sign_counts[step] += sign.crossings != (long)of->crossed(r.state);
	run_free(&r);
	return state_good && count_good && status_good;
}

static void one(unsigned seed)
{
	const struct hand_system s = *KIND == 'r' ? random_system(seed) : adversarial_system(seed);
	struct run fine = run_new(variant_of(TABLE, KIND "%u_4", seed));
	double y[MOST_STATES], expected[MOST_STATES];
	run_until(&fine, SECONDS);
	run_state(&fine, y);
	const long count = (long)fine.of->crossed(fine.state);
	struct hand_state truth;
	hand_start(&s, &truth);
	hand_reference(&s, &truth, SECONDS);
	const double size = sizes(&s, truth.y);
	narrow(&s, &truth, expected);
		bool good =
            close_to(apart(&s, y, expected, size), 0, tolerance, KIND " %u, h = 0.005: end state by hand", seed);
        good = close_to((double)count, (double)truth.crossings, 0, KIND " %u, h = 0.005: crossings by hand", seed) &&
			   good;
		sums.worst_by_hand = worse(sums.worst_by_hand, apart(&s, y, expected, size));
	sums.crossings += count;
	sums.systems++;
	for (int step = 0; step < STEPS; step++)
		good = at_step(&s, seed, step, &fine, y, size) && good;
	ok(good, KIND " %u: %d masses, %d stops, %ld crossings", seed, s.n, s.stops, count);
	run_free(&fine);
}

int main(void)
{
	setvbuf(stdout, NULL, _IOLBF, 0);
	for (unsigned seed = FIRST; seed < FIRST + COUNT; seed++)
		one(seed);
	note(KIND ": %d systems, %ld crossings in %d time units; end states off by at most %.2g at long steps, %.2g by "
	    "hand", sums.systems, sums.crossings,
	     SECONDS, sums.worst, sums.worst_by_hand);
	for (int step = 0; step < STEPS; step++)
            note("h = %-3g here: %d wrong states, %d wrong counts; signs at the ends of steps: %d wrong states, %d "
				 "wrong "
				 "counts",
                 steps[step], sums.states[step], sums.counts[step], sums.sign_states[step], sums.sign_counts[step]);
		return tap_end();
}
