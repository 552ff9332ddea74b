/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dry friction beside closed forms, derived here, in long double: free decay, a mass on a belt with static friction
 * above kinetic and with friction that falls, a slider on a shaken table, a harmonic force. */
#include "drive.h"
#include "closed_variants.h"
#include "tap.h"

#include <math.h>

typedef long double wide;

enum { MOST = 512 };
static const wide pi = 3.141592653589793238462643383279502884L;
static double time[MOST];
static pl_crossing crossing[MOST];

/* Runs to about `seconds`; how many crossings */
static int run_for(struct run *r, double seconds)
{
	return run_crossings(r, seconds, MOST, time, crossing);
}

/* ---- free decay ---- */

static void free_decay(int step)
{
	struct run r = run_new(variant_of(closed_table, "free_%d", step));
	double y[2], out[2];
	int count = run_for(&r, 10), halves = 0;
	wide x = 0.77L, w = 10, worst = 0;
	while (fabsl(100 * x) > 3) {            /* each half cycle: to the other side of -+F/k */
		x = -(x > 0 ? x - 0.06L : x + 0.06L);
		halves++;
		wide t = halves * pi / w;
		bool last = fabsl(100 * x) <= 3;
		int at = 2 * (halves - 1);
		worst = fmaxl(worst, fabsl(time[at] - t));
		if (!last)
			worst = fmaxl(worst, fabsl(time[at + 1] - t));
	}
	run_state(&r, y);
	r.of->model->out(r.state, out);
	is_close(out[1], (double)(-100 * x), 1e-12, "free decay %d: an output reads what friction holds", step);
	ok(count == 2 * halves - 1, "free decay %d: %d crossings, expected %d", step, count, 2 * halves - 1);
	is_close((double)worst, 0, 1e-13, "free decay %d: times of half cycles", step);
	is_close(y[0], (double)x, 1e-14, "free decay %d: where it stops", step);
	double before = y[0];
	for (int i = 0; i < 1000; i++)
		run_step(&r, NULL);
	run_state(&r, y);
	ok(y[0] == before && y[1] == 0, "free decay %d: it keeps its place to the last bit", step);
	run_free(&r);
}

/* ---- a belt ---- */

/* A cycle: slipping for `slip` seconds, sticking for `stick`, from a release at `release` on */
static void compare_cycles(const char *what, int step, int count, wide release, wide slip, wide stick)
{
	wide worst = 0;
	int cycles = 0;
	for (int i = 0; i + 1 < count; i += 2, cycles++) {
		wide begin = release + cycles * (slip + stick);
		worst = fmaxl(worst, fmaxl(fabsl(time[i] - begin), fabsl(time[i + 1] - begin - slip)));
	}
	ok(cycles > 10, "%s %d: %d cycles", what, step, cycles);
	is_close((double)worst, 0, 2e-12, "%s %d: times of release and of sticking", what, step);
}

/* It starts at rest on the spring: slips first, so that the cycle begins at its first release. */
static void belt(int step)
{
	struct run r = run_new(variant_of(closed_table, "stick_slip_%d", step));
	wide k = 60, w = sqrtl(k / 1.5L), v = 0.2L, above = (5.0L - 2) / k, turn;
	double start[2] = { 5.0 / 60 - 0.1, 0.2 };      /* with the belt, half a second before its release */
	run_set(&r, start);
	int count = run_for(&r, 20);
	turn = 2 * pi - 2 * atanl(above * w / v);       /* cos - above w/v sin = 1 */
	compare_cycles("belt", step, count, (5 / k - (wide)start[0]) / v, turn / w, 2 * above / v);
	run_free(&r);
}

/* Slipping from x = F/k with the belt's velocity: x'' - 2 d x' + k x = F - slope v, d = slope/2, growing */
static void stribeck(int step)
{
	struct run r = run_new(variant_of(closed_table, "stribeck_%d", step));
	wide k = 100, F = 4, v = 0.3L, d = 0.6L, w = sqrtl(k - d * d), rest = (F - 2 * d * v) / k;
	wide a = F / k - rest, b = (v - d * a) / w, low = pi / w, high = 2 * pi / w;
	double start[2] = { 4.0 / 100 - 0.03, 0.3 };
	for (int i = 0; i < 100; i++) {         /* the velocity comes back to the belt's */
		wide t = (low + high) / 2, slope = expl(d * t) * ((d * a + w * b) * cosl(w * t) +
								  (d * b - w * a) * sinl(w * t));
		if (slope < v)
			low = t;
		else
			high = t;
	}
	wide end = rest + expl(d * low) * (a * cosl(w * low) + b * sinl(w * low));
	run_set(&r, start);
	int count = run_for(&r, 20);
	compare_cycles("friction that falls", step, count, (F / k - (wide)start[0]) / v, low, (F / k - end) / v);
	run_free(&r);
}

/* ---- a brake ---- */

/* The same history at two steps; in the end all stands, and the brakes carry what the slope pulls. */
static void brake(void)
{
	double y[2][4], out[4], off = 0;
	for (int step = 0; step < 2; step++) {
		struct run r = run_new(variant_of(closed_table, "brake_%d", step));
		run_until(&r, 20);
		run_state(&r, y[step]);
		r.of->model->out(r.state, out);
		is_close(out[3], 1400 * 9.81 * 0.05, 1e-8, "brake %d: what the brakes carry", step);
		ok(y[step][2] == 0 && y[step][3] == 0, "brake %d: all stands", step);
		run_free(&r);
	}
	for (int i = 0; i < 4; i++)
		off = worse(off, fabs(y[0][i] - y[1][i]));
	is_close(off, 0, 1e-10, "brake: steps far apart");
}

/* ---- a shaken table ---- */

static void shaken(int step)
{
	struct run r = run_new(variant_of(closed_table, "table_%d", step));
	const pl_model *model = r.of->model;
	wide a = 0.05L, w = 12, mg = 0.3L * 9.81L, worst = 0, fast = mg * pi / (2 * w);
	/* w t where the table is as fast and slows down: the slider then slides on */
	wide phase = acosl(fast / (a * w));
	double begin = (double)(phase / w), start[2] = { 0, (double)fast };
	model->set(r.state, begin, start);
	int count = 0, half = 0;
	bool order = true;
	for (int i = 0; i < (int)lround(5 / model->h); i++) {
		pl_crossing now[MOST_EVENTS];
		double t = model->time(r.state);
		run_step(&r, NULL);
		int found = r.of->crossings(r.state, now);
		for (int k = 0; k < found; k++, count++) {
			half = count / 2 + 1;
			worst = fmaxl(worst, fabsl(t + now[k].time - begin - half * pi / w));
			order = order && now[k].upward == (half % 2 == 0);
		}
	}
	ok(count >= 36 && order, "shaken table %d: two crossings in each of %d half cycles", step, half);
	is_close((double)worst, 0, 2e-12, "shaken table %d: times", step);
	run_free(&r);
}

/* a w^2 below mu g: it sticks for ever; just above: it slides where a w^2 sin w t comes to mu g */
static void carried(int step)
{
	struct run still = run_new(variant_of(closed_table, "table_still_%d", step));
	double y[2];
	wide worst = 0;
	int count = run_for(&still, 10);
	run_state(&still, y);
	worst = fabsl(y[1] - 0.02L * 12 * cosl(120.0L));
	ok(count == 0, "carried along %d: no crossing, found %d", step, count);
	is_close((double)worst, 0, 1e-15, "carried along %d: its velocity is the table's", step);
	is_close(y[0], (double)(0.02L * sinl(120.0L)), 1e-13, "carried along %d: its place", step);
	run_free(&still);
	struct run just = run_new(variant_of(closed_table, "table_just_%d", step));
	count = run_for(&just, 1);
	ok(count > 0, "just not carried %d", step);
	is_close(time[0], (double)(asinl(0.3L * 9.81L / (0.0205L * 144)) / 12), 1e-13, "just not carried %d: release",
		 step);
	run_free(&just);
}

/* ---- a harmonic force ---- */

/* Sliding without a stop, from the largest x at the phase of the load to the smallest half a cycle later:
 * x = X cos(w t + phase) + F/k (1 - cos w0 t) + X r sin(phase) sin w0 t, so that X r sin(phase) = -F/k tan(pi/2r)
 * and the amplitude is X cos(phase): Den Hartog's */
static void sliding(int step)
{
	struct run r = run_new(variant_of(closed_table, "harmonic_%d", step));
	const pl_model *model = r.of->model;
	wide k = 50, w0 = 5, w = 3.5L, ratio = w / w0, F = 3, P = 10, X = P / k / (1 - ratio * ratio), worst = 0;
	wide sine = -F / k * tanl(pi / (2 * ratio)) / (X * ratio), phase = asinl(sine), size = X * cosl(phase);
	wide U = sinl(pi / ratio) / (ratio * (1 + cosl(pi / ratio))), V = 1 / (1 - ratio * ratio);
	double begin = (double)((phase + 2 * pi) / w), start[2] = { (double)size, 0 }, y[2];
	is_close((double)(size * k / P), (double)sqrtl(V * V - F / P * (F / P) * U * U), 1e-15,
		 "Den Hartog's amplitude %d: the published formula", step);
	model->set(r.state, begin, start);
	int count = 0, half = 0;
	for (int i = 0; i < (int)lround(40 / model->h); i++) {
		pl_crossing now[MOST_EVENTS];
		double t = model->time(r.state);
		run_step(&r, NULL);
		int found = r.of->crossings(r.state, now);
		for (int j = 0; j < found; j++, count++) {
			half = count / 2 + 1;
			worst = fmaxl(worst, fabsl(t + now[j].time - begin - half * pi / w));
		}
	}
	ok(count > 80 && count % 2 == 0, "Den Hartog %d: two crossings in each of %d half cycles, found %d", step, half,
	   count);
	is_close((double)worst, 0, 2e-12, "Den Hartog %d: times", step);
	run_until(&r, 40);
	run_state(&r, y);
	wide t = model->time(r.state) - (wide)begin, into = fmodl(t, 2 * pi / w), sign = into < pi / w ? 1 : -1;
	into = into < pi / w ? into : into - pi / w;
	wide x = sign * (X * cosl(w * into + phase) + F / k * (1 - cosl(w0 * into)) +
			 X * ratio * sinl(phase) * sinl(w0 * into));
	is_close(y[0], (double)x, 1e-12, "Den Hartog %d: state", step);
	run_free(&r);
}

/* From rest at -x0, released where P cos(w t) + k x0 comes to F, on to where it stops */
struct slide { wide begin, end, x; };

static struct slide slide_from(wide x0)
{
	wide k = 50, w0 = 5, w = 1.5L, F = 6, P = 10, X = P / k / (1 - w * w / (w0 * w0));
	struct slide s = { -acosl((F - k * x0) / P) / w, 0, 0 };
	wide a = -x0 - X * cosl(w * s.begin) + F / k, b = X * w * sinl(w * s.begin) / w0, low = 1e-3L, high = low;
	do
		high += 1e-3L;
	while (w0 * (b * cosl(w0 * high) - a * sinl(w0 * high)) - X * w * sinl(w * (s.begin + high)) > 0);
	low = high - 1e-3L;
	for (int i = 0; i < 100; i++) {
		wide t = (low + high) / 2;
		if (w0 * (b * cosl(w0 * t) - a * sinl(w0 * t)) - X * w * sinl(w * (s.begin + t)) > 0)
			low = t;
		else
			high = t;
	}
	s.end = s.begin + low;
	s.x = X * cosl(w * s.end) - F / k + a * cosl(w0 * low) + b * sinl(w0 * low);
	return s;
}

/* Hong and Liu's two stops a cycle: the slide from -x0 ends at x0. */
static void stopping(int step)
{
	struct run r = run_new(variant_of(closed_table, "harmonic_stops_%d", step));
	const pl_model *model = r.of->model;
	wide low = 0, high = 0.16L, w = 1.5L, worst = 0;
	for (int i = 0; i < 100; i++) {
		wide x0 = (low + high) / 2;
		if (slide_from(x0).x > x0)
			low = x0;
		else
			high = x0;
	}
	struct slide s = slide_from(low);
	wide shift = 2 * pi / w;
	double begin = (double)(s.begin + shift - 0.01L), start[2] = { (double)-low, 0 };
	model->set(r.state, begin, start);
	int count = 0;
	for (int i = 0; i < (int)lround(40 / model->h); i++) {
		pl_crossing now[MOST_EVENTS];
		double t = model->time(r.state);
		run_step(&r, NULL);
		int found = r.of->crossings(r.state, now);
		for (int j = 0; j < found; j++, count++)
			worst = fmaxl(worst, fabsl(t + now[j].time - shift - count / 2 * pi / w -
						   (count % 2 ? s.end : s.begin)));
	}
	int cycles = (int)(40 * w / (2 * pi));
	ok(count >= 4 * cycles && count <= 4 * cycles + 4 && s.end < s.begin + pi / w,
	   "two stops a cycle %d: %d crossings in %d cycles", step, count, cycles);
	is_close((double)worst, 0, 5e-12, "two stops a cycle %d: times", step);
	run_free(&r);
}

/* ---- a conveyor ---- */

/* At rest on it for a second, then it goes on at once: the block slides until it is as fast. */
static void conveyor(int step)
{
	struct run r = run_new(variant_of(closed_table, "conveyor_%d", step));
	wide fast = 0.3L, slope = 1.5L, off = 0;
	double y[2], h = r.of->model->h;
	for (int i = 0; i < (int)lround(2 / h); i++) {
		wide t = (i + 1) * (wide)h - 1;
		double u = i < (int)lround(1 / h) ? 0 : 0.3;
		run_step(&r, &u);
		run_state(&r, y);
		off = fmaxl(off, fabsl(y[1] - (t < 0 ? 0 : fminl(fast, slope * t))));
	}
	is_close((double)off, 0, 1e-14, "conveyor %d: how fast the block is", step);
	is_close(y[0], (double)(fast - fast * fast / (2 * slope)), 1e-14, "conveyor %d: where it is after 2 s", step);
	run_free(&r);
}

/* ---- energy ---- */

static wide energy(const double *y)
{
	wide x = y[0], z = y[1], deep = z > 0.3L ? z - 0.3L : 0;
	wide moving = 2 * (wide)y[2] * y[2] + (wide)y[3] * y[3];
	return (moving + 80 * (x - z) * (x - z) + 10 * z * z + 200 * deep * deep) / 2;
}

static void energies(int step)
{
	struct run r = run_new(variant_of(closed_table, "pads_%d", step));
	double y[4];
	run_state(&r, y);
	wide first = energy(y), last = first, most = 0;
	for (int i = 0; i < (int)lround(20 / r.of->model->h); i++) {
		run_step(&r, NULL);
		run_state(&r, y);
		wide now = energy(y);
		most = fmaxl(most, now - last);
		last = now;
	}
	ok(r.of->crossed(r.state) > 20 && last < first / 2, "pads %d: %u crossings, energy from %.3Lg to %.3Lg", step,
	   (unsigned)r.of->crossed(r.state), first, last);
	is_close((double)(most / first), 0, 1e-15, "pads %d: the energy never grows", step);
	run_free(&r);
}

int main(void)
{
	for (int step = 0; step < 3; step++) {
		free_decay(step);
		belt(step);
	}
	for (int step = 0; step < 2; step++) {
		stribeck(step);
		shaken(step);
		carried(step);
		sliding(step);
		stopping(step);
		conveyor(step);
		energies(step);
	}
	brake();
	return tap_end();
}
