/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * friction VARIANTS OUTDIR          OUTDIR/friction.csv: errors, stick phases, evaluations; no times
 * friction --times VARIANTS OUTDIR  OUTDIR/friction_times.csv: the same errors with times
 *
 * Stick-slip by the ways that people take: a mass on a spring under two harmonic forces, held by dry friction,
 *     m x'' + k x + F sgn x' = P cos w t + Q cos u t,     stuck while |P cos w t + Q cos u t - k x| <= F.
 *
 *   exact               the step that plgen generates of specs/friction.spec
 *   CVODE ..., roots    from event to event: its root finding, a state machine of stick and slip, CVodeReInit
 *   tanh, ...           F tanh(x'/eps) instead, by CVODE and RK4; their own setting goes with eps
 *   Moreau and Jean     time stepping: the theta method with theta = 1/2, whose impulse of friction is projected onto
 *                       -h F .. h F so that velocity and friction at the end of a step agree; no events are sought.
 *                       As fast as can be written: factors are made once, loads turn by a product in each step.
 *
 * Truth: sliding in closed form, in long double, its ends by bisection. Errors are of x, over its largest value.
 * A method sticks at an output where |x'| is at most 3 eps, or rounding where nothing is smoothed, for two outputs or
 * more one after the other. Missed: none of the outputs in a true phase, two or more, sticks. False: a phase of a
 * method that meets no true one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sundials.h"

enum { UNITS = 2400, MOST_PHASES = 1000 };
static const double mass = 2, spring = 50, hold = 4, P = 10, w = 1.5, Q = 3, u = 4.1, unit = 0.05;

/* What acts but friction */
static double push(double t, double x)
{
	return P * cos(w * t) + Q * cos(u * t) - spring * x;
}

/* ---- what is true ---- */

struct truth_of_friction {
	double x[UNITS], peak, fastest;
	int phases, seen;               /* seen: with two outputs or more in them */
	double from[MOST_PHASES], to[MOST_PHASES];
};

/* Sliding: x = forced + sign * -F/k + a cos w0 (t - begin) + b sin w0 (t - begin) */
struct slide { long double begin, sign, a, b; };

static const long double w0 = 5;        /* sqrt(k/m) */

static long double forced(long double t, bool rate)
{
	const long double X = P / (spring - mass * (long double)w * w), Y = Q / (spring - mass * (long double)u * u);
	return rate ? -X * w * sinl(w * t) - Y * u * sinl(u * t) : X * cosl(w * t) + Y * cosl(u * t);
}

static long double wide_push(long double t, long double x)
{
	return P * cosl(w * t) + Q * cosl(u * t) - spring * x;
}

static struct slide slide_of(long double t, long double x, long double sign)
{
	return (struct slide){ t, sign, x - forced(t, false) + sign * hold / spring, -forced(t, true) / w0 };
}

static long double slide_at(const struct slide *s, long double t, bool rate)
{
	const long double c = cosl(w0 * (t - s->begin)), n = sinl(w0 * (t - s->begin));
	return forced(t, rate) + (rate ? w0 * (s->b * c - s->a * n) : s->a * c + s->b * n - s->sign * hold / spring);
}

/* Above 0 until the phase that began at `s` ends; x: where it sticks */
static long double left(const struct slide *s, bool sticks, long double x, long double t)
{
	return sticks ? hold - fabsl(wide_push(t, x)) : s->sign * slide_at(s, t, true);
}

static void find_truth(struct truth_of_friction *truth)
{
	const long double look = 1 / 1024.0L, end = UNITS * (long double)unit;
	long double t = 0, x = 0;
	bool sticks = false;
	struct slide s = slide_of(0, 0, 1);
	int next = 1;
	memset(truth, 0, sizeof *truth);
	while (t < end) {
		long double low = t + look, high = low;
		while (high < end + 1 && left(&s, sticks, x, high) > 0)
			low = high, high += look;
		for (int halving = 0; halving < 64; halving++) {
			const long double middle = (low + high) / 2;
			*(left(&s, sticks, x, middle) > 0 ? &low : &high) = middle;
		}
		for (; next <= UNITS && next * (long double)unit <= high; next++) {
			const long double at = next * (long double)unit, here = sticks ? x : slide_at(&s, at, false);
			truth->x[next - 1] = (double)here;
			truth->peak = fmax(truth->peak, fabs((double)here));
			if (!sticks)
				truth->fastest = fmax(truth->fastest, fabs((double)slide_at(&s, at, true)));
		}
		x = sticks ? x : slide_at(&s, high, false);
		t = high;
		if (sticks) {
			const int p = truth->phases++;
			truth->to[p] = (double)fminl(t, end);
			truth->seen += floor(truth->to[p] / unit) - ceil(truth->from[p] / unit) >= 1;
		}
		sticks = !sticks && fabsl(wide_push(t, x)) <= hold;
		if (sticks && t < end)
			truth->from[truth->phases] = (double)t;
		else if (!sticks)
			s = slide_of(t, x, wide_push(t, x) > 0 ? 1 : -1);
	}
}

/* ---- ways ---- */

enum how { EXACT, ROOTS, SMOOTH, STEPS, PROJECTED };
struct way {
	const char *name;
	enum how how;
	const struct method *method;
	double setting;                 /* step [s], relative tolerance, or eps [m/s] */
	double eps, sign;               /* eps 0: from phase to phase; sign 0: it sticks */
	struct problem problem;
	struct run *run;
};

static void slope_of(const void *of, double t, const double *y, double *f)
{
	const struct way *way = of;
	const double rub = hold * (way->eps > 0 ? tanh(y[1] / way->eps) : way->sign);
	const bool sticks = way->eps == 0 && way->sign == 0;
	f[0] = sticks ? 0 : y[1];
	f[1] = sticks ? 0 : (push(t, y[0]) - rub) / mass;
}

/* Of BDF's iteration */
static void jacobian(const struct problem *p, double t, const double *y, double *Jq, double *Jv)
{
	const struct way *way = p->of;
	const double flat = way->eps > 0 ? 1 / cosh(fmin(fabs(y[1]) / way->eps, 300)) : 0;
	(void)t;
	*Jq = way->eps == 0 && way->sign == 0 ? 0 : -spring / mass;
	*Jv = way->eps > 0 ? -hold / (mass * way->eps) * flat * flat : 0;
}

static struct way *way_of(const struct adaptive *a)
{
	return (struct way *)a->run.problem->of;
}

/* What ends a phase */
static int ends(realtype t, N_Vector y, realtype *g, void *of)
{
	const double force = push(t, NV_Ith_S(y, 0)), sign = way_of(of)->sign;
	g[0] = sign == 0 ? force - hold : NV_Ith_S(y, 1);
	g[1] = sign == 0 ? force + hold : 1;
	return 0;
}

/* Slip ends in stick where friction holds, else in slip the other way */
static void next_phase(struct sundials *s, double t, const int *found)
{
	struct way *way = way_of(&s->adaptive);
	double *y = NV_DATA_S(s->y);
	const double force = push(t, y[0]);
	const bool sticks = way->sign != 0 && fabs(force) <= hold;
	(void)found;
	y[1] = 0;
	way->sign = sticks ? 0 : force > 0 ? 1 : -1;
}

static bool phases_make(struct adaptive *a)
{
	struct sundials *s = (struct sundials *)a;
	s->roots = 2;
	s->distance = ends;
	s->crossed = next_phase;
	return cvode_make(a);
}

static bool phases_begin(struct adaptive *a, double t, const double *y)
{
	way_of(a)->sign = 1;
	return cvode_begin(a, t, y);
}

static const struct solver phases = {
	.bytes = sizeof(struct sundials), .make = phases_make, .begin = phases_begin, .reach = roots_reach,
	.looks_ahead = true, .discard = cvode_discard,
};
static const struct kind adams = {.method = BY_TOLERANCE("CVODE Adams, roots", 0, ""), .solver = &phases,
								  .formula = CV_ADAMS};
static const struct kind bdf = {.method = BY_TOLERANCE("CVODE BDF, roots", 0, ""), .solver = &phases,
								.formula = CV_BDF};
static const struct method exact = {.name = "exact", .family = OURS};

/* ---- time stepping ---- */

struct stepping {
	struct run run;
	int steps;                      /* in a unit */
	double h, x, v, c[2], s[2];     /* c, s: of the two loads, what they add to v in the step that follows */
};

/* m (v+ - v) = h (mean load - k (x + x+)/2) + p,  x+ = x + h (v + v+)/2,  p in -h F sgn v+ */
static double mass_over(double h)
{
	return mass + h * h * spring / 4;
}

static void stepping_restart(struct run *run)
{
	struct stepping *m = (struct stepping *)run;
	const double rate[] = { w, u }, size[] = { P, Q };
	m->x = m->v = 0;
	run->asked = 0;
	for (int i = 0; i < 2; i++) {
		const double half = rate[i] * m->h / 2, mean = size[i] * cos(half) * m->h / mass_over(m->h);
		m->c[i] = mean * cos(half);
		m->s[i] = mean * sin(half);
	}
}

static bool stepping_advance(struct run *run, int units, double *rows)
{
	struct stepping *m = (struct stepping *)run;
	const double h = m->h, over = mass_over(h), keep = 2 * mass / over - 1, pull = h * spring / over;
	const double most = h * hold / over, cw = cos(w * h), sw = sin(w * h), cu = cos(u * h), su = sin(u * h);
	double x = m->x, v = m->v, c0 = m->c[0], s0 = m->s[0], c1 = m->c[1], s1 = m->s[1];
	for (int k = 0; k < units; k++) {
		for (int i = 0; i < m->steps; i++) {
			const double next0 = c0 * cw - s0 * sw, next1 = c1 * cu - s1 * su;
			const double alone = keep * v + (c0 + c1 - pull * x);
			const double then = alone - fmin(fmax(alone, -most), most);
			s0 = s0 * cw + c0 * sw;
			s1 = s1 * cu + c1 * su;
			c0 = next0;
			c1 = next1;
			x += h / 2 * (v + then);
			v = then;
		}
		if (rows) {
			rows[2 * k] = x;
			rows[2 * k + 1] = v;
		}
	}
	run->asked += (long)units * m->steps;
	*m = (struct stepping){ m->run, m->steps, h, x, v, { c0, c1 }, { s0, s1 } };
	return isfinite(x);
}

static void stepping_close(struct run *run)
{
	free(run);
}

static struct run *stepping_open(const struct method *method, const struct problem *problem, double setting)
{
	struct stepping *m = room_for(1, sizeof *m);
	m->run = (struct run){ .method = method, .problem = problem, .setting = setting, .restart = stepping_restart,
	                       .advance = stepping_advance, .evaluations = run_evaluations, .close = stepping_close };
	m->steps = steps_of(problem, setting);
	m->h = problem->unit / m->steps;
	stepping_restart(&m->run);
	return &m->run;
}

static const struct method moreau_jean = {.name = "Moreau and Jean", .family = FIXED, .order = 1,
										  .open = stepping_open};

/* Smoothing's step: m eps/F, the time of what is smoothed, or an output's; its tolerance: a hundredth of eps */
static void way_open(struct way *way, const char *variants, const struct truth_of_friction *truth)
{
	static const double start[2];
	way->problem = (struct problem){.name = "friction", .n = 1, .rhs_of = slope_of, .of = way, .jacobian = jacobian,
	                                .start = start, .unit = unit, .units = UNITS, .scale_q = truth->peak,
	                                .scale_v = truth->fastest};
	way->eps = way->how == SMOOTH || way->how == STEPS ? way->setting : 0;
	const double setting = way->how == SMOOTH  ? fmax(1e-10, way->eps / 100)
	                       : way->how == STEPS ? unit / ceil(unit * hold / (mass * way->eps)) : way->setting;
	const char *file = text("%s/friction-%ld.so", variants, lround(unit / way->setting));
	way->run = way->how == EXACT ? generated_open(way->method, &way->problem, file)
		: way->method->open(way->method, &way->problem, setting);
	if (!way->run)
		leave(way->name, "cannot be opened");
}

/* ---- what they get wrong ---- */

struct found { bool failed; double largest, at_end; int missed, phases, falsely; };

static struct found compare(struct way *way, const struct truth_of_friction *truth)
{
	static double rows[2 * UNITS];
	static bool sticks[UNITS + 2];
	way->run->restart(way->run);
	struct found found = { .failed = !way->run->advance(way->run, UNITS, rows) };
	const double still = way->how == SMOOTH || way->how == STEPS ? 3 * way->setting : 1e-12 * truth->fastest;
	for (int k = 0; k < UNITS; k++) {
		const double error = fabs(rows[2 * k] - truth->x[k]) / truth->peak;
		if (!(error <= found.largest))
			found.largest = error;
		found.at_end = error;
		sticks[k + 1] = fabs(rows[2 * k + 1]) <= still;
	}
	for (int k = 1; k <= UNITS; k++)        /* one alone passes through 0 */
		if (sticks[k] && !sticks[k - 1] && !sticks[k + 1])
			sticks[k] = false;
	for (int p = 0; p < truth->phases; p++) {
		const int first = (int)ceil(truth->from[p] / unit), last = (int)floor(truth->to[p] / unit);
		bool seen = last - first < 1;
		for (int k = first; k <= last; k++)
			seen = seen || sticks[k];
		found.missed += !seen;
	}
	for (int k = 1, begin = 0; k <= UNITS + 1; k++) {
		if (k <= UNITS && sticks[k]) {
			begin = begin ? begin : k;
			continue;
		}
		bool true_one = false;
		for (int p = 0; begin && p < truth->phases; p++)
			true_one = true_one || (begin * unit <= truth->to[p] && (k - 1) * unit >= truth->from[p]);
		found.phases += begin != 0;
		found.falsely += begin != 0 && !true_one;
		begin = 0;
	}
	return found;
}

/* ---- the list ---- */

enum { MOST_WAYS = 64 };
struct ways { int count; struct way way[MOST_WAYS]; };

static void list(struct ways *ways)
{
	static const struct { const char *name, *method; enum how how; int first, last; } ladder[] = {
		{ "CVODE Adams, roots", NULL, ROOTS, 3, 11 }, { "CVODE BDF, roots", NULL, ROOTS, 3, 9 },
		{ "tanh, CVODE BDF", "CVODE BDF", SMOOTH, 1, 6 }, { "tanh, CVODE Adams", "CVODE Adams", SMOOTH, 1, 4 },
		{ "tanh, RK4", "RK4", STEPS, 1, 4 },
	};
	for (int parts = 1; parts <= 5; parts += 4)
		ways->way[ways->count++] = (struct way){ .name = "exact", .method = &exact, .setting = unit / parts };
	for (int parts = 1; parts <= 16384; parts *= 4)
		ways->way[ways->count++] = (struct way){ .name = moreau_jean.name, .method = &moreau_jean,
			.how = PROJECTED, .setting = unit / parts };
	for (size_t i = 0; i < sizeof ladder / sizeof *ladder; i++)
		for (int e = ladder[i].first; e <= ladder[i].last; e++)
			ways->way[ways->count++] = (struct way){ .name = ladder[i].name, .how = ladder[i].how,
				.setting = pow(10, -e), .method = ladder[i].method ? method_find(ladder[i].method)
					: i == 0 ? &adams.method : &bdf.method };
}

static const char *const setting_is[] = { "step_s", "rtol", "eps_m_per_s", "eps_m_per_s", "step_s" };

static void errors(struct ways *ways, const struct truth_of_friction *truth, const char *folder)
{
	FILE *csv = table_open(folder, "friction.csv", "method,setting_kind,setting,largest,at_end,phases,missed,"
	                                               "false,true_phases,evaluations_per_s");
	for (struct way *way = ways->way; way < ways->way + ways->count; way++) {
		const struct found found = compare(way, truth);
		fprintf(csv, "\"%s\",%s,%g,", way->name, setting_is[way->how], way->setting);
		if (found.failed)
			fprintf(csv, "failed,failed,,,,");
		else
			fprintf(csv, "%.4g,%.4g,%d,%d,%d,", found.largest, found.at_end, found.phases, found.missed,
			        found.falsely);
		fprintf(csv, "%d,", truth->seen);
		if (way->how != EXACT)
			fprintf(csv, "%.4g", (double)way->run->evaluations(way->run) / (UNITS * unit));
		fprintf(csv, "\n");
	}
	table_close(csv, "friction.csv");
}

/* Of a simulated second */
static void times(struct ways *ways, const struct truth_of_friction *truth, const char *folder)
{
	struct run *run[MOST_WAYS];
	struct samples ns[MOST_WAYS];
	FILE *csv = table_open(folder, "friction_times.csv", "method,setting_kind,setting,largest,ns_min,ns_median,"
	                                                     "ns_max,ns_min_over_exact");
	for (int i = 0; i < ways->count; i++)
		run[i] = ways->way[i].run;
	sample_runs(ways->count, run, 5, ns);
	for (int i = 0; i < ways->count; i++) {
		struct way *way = &ways->way[i];
		const struct found found = compare(way, truth);
		fprintf(csv, "\"%s\",%s,%g,%.4g,%.4g,%.4g,%.4g,%.4g\n", way->name, setting_is[way->how], way->setting,
		        found.failed ? NAN : found.largest, ns[i].min / unit, ns[i].median / unit, ns[i].max / unit,
		        ns[i].min / ns[0].min);
	}
	table_close(csv, "friction_times.csv");
}

int main(int argc, char **argv)
{
	static struct ways ways;
	static struct truth_of_friction truth;
	const bool timed = flags_of(argc, &argv, "--times", 2, 2, "friction [--times] VARIANTS OUTDIR");
	say_progress("friction: %s", timed ? "times" : "errors");
	find_truth(&truth);
	list(&ways);
	for (int i = 0; i < ways.count; i++)
		way_open(&ways.way[i], argv[0], &truth);
	(timed ? times : errors)(&ways, &truth, argv[1]);
	for (int i = 0; i < ways.count; i++)
		ways.way[i].run->close(ways.way[i].run);
	return 0;
}
