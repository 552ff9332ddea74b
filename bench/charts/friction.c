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
 *
 * Truth: sliding in closed form, in long double, its ends by bisection. Errors are of x, over its largest value.
 * A method sticks at an output where |x'| is at most 3 eps, or rounding where nothing is smoothed, for two outputs or
 * more one after the other. Missed: none of the outputs in a true phase, two or more, sticks. False: a phase of a
 * method that meets no true one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "charts.h"

enum { UNITS = 2400, MOST_PHASES = 1000, MOST_STEPS = 10000000, ROUNDS = 41, FEW = 7 };
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

enum kind { EXACT, ROOTS, SMOOTH, STEPS };
struct way {
	const char *name;
	enum kind kind;
	int lmm;
	double setting;                 /* step [s], relative tolerance, or eps [m/s] */
	const struct truth_of_friction *truth;
	long evaluations;
	/* generated */
	void *state;
	const pl_model *model;
	/* equations; sign 0: it sticks */
	double eps, sign;
	SUNContext context;
	N_Vector y, tolerances;
	SUNMatrix matrix;
	SUNLinearSolver linear;
	SUNNonlinearSolver fixed_point;
	void *memory;
};

static int slope(realtype t, N_Vector y, N_Vector dydt, void *of)
{
	struct way *way = of;
	const double *at = NV_DATA_S(y);
	double *f = NV_DATA_S(dydt);
	const double rub = hold * (way->eps > 0 ? tanh(at[1] / way->eps) : way->sign);
	const bool sticks = way->eps == 0 && way->sign == 0;
	way->evaluations++;
	f[0] = sticks ? 0 : at[1];
	f[1] = sticks ? 0 : (push(t, at[0]) - rub) / mass;
	return 0;
}

/* Of BDF's iteration */
static int jacobian(realtype t, N_Vector y, N_Vector fy, SUNMatrix J, void *of, N_Vector a, N_Vector b, N_Vector c)
{
	const struct way *way = of;
	const double flat = way->eps > 0 ? 1 / cosh(fmin(fabs(NV_Ith_S(y, 1)) / way->eps, 300)) : 0;
	const bool sticks = way->eps == 0 && way->sign == 0;
	(void)t, (void)fy, (void)a, (void)b, (void)c;
	SM_ELEMENT_D(J, 0, 0) = 0;
	SM_ELEMENT_D(J, 0, 1) = sticks ? 0 : 1;
	SM_ELEMENT_D(J, 1, 0) = sticks ? 0 : -spring / mass;
	SM_ELEMENT_D(J, 1, 1) = way->eps > 0 ? -hold / (mass * way->eps) * flat * flat : 0;
	return 0;
}

/* What ends a phase */
static int ends(realtype t, N_Vector y, realtype *g, void *of)
{
	const struct way *way = of;
	const double force = push(t, NV_Ith_S(y, 0));
	g[0] = way->sign == 0 ? force - hold : NV_Ith_S(y, 1);
	g[1] = way->sign == 0 ? force + hold : 1;
	return 0;
}

static void silent(int code, const char *module, const char *function, char *message, void *of)
{
	(void)code, (void)module, (void)function, (void)message, (void)of;
}

static bool cvode_make(struct way *way)
{
	const double tolerance = way->kind == ROOTS ? way->setting : fmax(1e-10, way->setting / 100);
	if (SUNContext_Create(NULL, &way->context) != 0)
		return false;
	way->y = N_VNew_Serial(2, way->context);
	way->tolerances = N_VNew_Serial(2, way->context);
	way->memory = CVodeCreate(way->lmm, way->context);
	N_VConst(0, way->y);
	NV_Ith_S(way->tolerances, 0) = tolerance * way->truth->peak;
	NV_Ith_S(way->tolerances, 1) = tolerance * way->truth->fastest;
	if (CVodeSetErrHandlerFn(way->memory, silent, NULL) || CVodeInit(way->memory, slope, 0, way->y) ||
	    CVodeSVtolerances(way->memory, tolerance, way->tolerances) || CVodeSetUserData(way->memory, way) ||
	    CVodeSetMaxNumSteps(way->memory, MOST_STEPS) ||
	    (way->kind == ROOTS && CVodeRootInit(way->memory, 2, ends)))
		return false;
	if (way->lmm == CV_ADAMS) {
		way->fixed_point = SUNNonlinSol_FixedPoint(way->y, 0, way->context);
		return CVodeSetNonlinearSolver(way->memory, way->fixed_point) == 0;
	}
	way->matrix = SUNDenseMatrix(2, 2, way->context);
	way->linear = SUNLinSol_Dense(way->y, way->matrix, way->context);
	return CVodeSetLinearSolver(way->memory, way->linear, way->matrix) == 0 &&
	       CVodeSetJacFn(way->memory, jacobian) == 0;
}

/* Slip ends in stick where friction holds, else in slip the other way */
static void next_phase(struct way *way, double t)
{
	double *y = NV_DATA_S(way->y);
	const double force = push(t, y[0]);
	const bool sticks = way->sign != 0 && fabs(force) <= hold;
	y[1] = 0;
	way->sign = sticks ? 0 : force > 0 ? 1 : -1;
}

/* rows: x, x' at the end of each unit, or NULL */
static bool cvode_pass(struct way *way, double *rows)
{
	double t = 0;
	N_VConst(0, way->y);
	way->sign = 1;
	way->eps = way->kind == SMOOTH ? way->setting : 0;
	if (CVodeReInit(way->memory, 0, way->y) != 0)
		return false;
	for (int k = 0; k < UNITS; k++) {
		const double end = (k + 1) * unit;
		for (int said = CV_ROOT_RETURN; said == CV_ROOT_RETURN && t < end;) {
			said = CVode(way->memory, end, way->y, &t, CV_NORMAL);
			if (said < 0)
				return false;
			if (said != CV_ROOT_RETURN)
				break;
			next_phase(way, t);
			if (CVodeReInit(way->memory, t, way->y) != 0)
				return false;
		}
		if (rows)
			memcpy(rows + 2 * k, NV_DATA_S(way->y), 2 * sizeof *rows);
	}
	return true;
}

static void rk4_slope(const struct way *way, double t, const double *y, double *f)
{
	f[0] = y[1];
	f[1] = (push(t, y[0]) - hold * tanh(y[1] / way->eps)) / mass;
}

/* The step: m eps/F, the time of what is smoothed, or an output's */
static bool rk4_pass(struct way *way, double *rows)
{
	way->eps = way->setting;
	const int steps = (int)ceil(unit * hold / (mass * way->eps));
	const double h = unit / steps;
	double y[2] = { 0, 0 };
	for (int k = 0; k < UNITS; k++) {
		for (int i = 0; i < steps; i++) {
			const double t = k * unit + i * h;
			double f[4][2], z[2];
			rk4_slope(way, t, y, f[0]);
			for (int stage = 1; stage < 4; stage++) {
				const double part = stage == 3 ? h : h / 2;
				for (int j = 0; j < 2; j++)
					z[j] = y[j] + part * f[stage - 1][j];
				rk4_slope(way, t + part, z, f[stage]);
			}
			for (int j = 0; j < 2; j++)
				y[j] += h / 6 * (f[0][j] + 2 * f[1][j] + 2 * f[2][j] + f[3][j]);
		}
		way->evaluations += 4 * steps;
		if (rows)
			memcpy(rows + 2 * k, y, sizeof y);
	}
	return true;
}

static bool exact_pass(struct way *way, double *rows)
{
	const size_t steps = (size_t)lround(unit / way->setting);
	double y[2];
	way->model->init(way->state);
	for (int k = 0; k < UNITS; k++) {
		way->model->run(way->state, steps, NULL, NULL);
		way->model->get(way->state, y);
		if (rows)
			memcpy(rows + 2 * k, y, sizeof y);
	}
	return true;
}

static bool pass(struct way *way, double *rows)
{
	way->evaluations = 0;
	return way->kind == EXACT ? exact_pass(way, rows) : way->kind == STEPS ? rk4_pass(way, rows)
		: cvode_pass(way, rows);
}

static void way_open(struct way *way, const char *variants)
{
	char file[40];
	if (way->kind == ROOTS || way->kind == SMOOTH) {
		if (!cvode_make(way))
			exit(1);
		return;
	}
	if (way->kind == STEPS)
		return;
	snprintf(file, sizeof file, "friction-%ld", lround(unit / way->setting));
	way->model = variant_model(variants, file);
	way->state = calloc(1, way->model->size);
}

static void way_close(struct way *way)
{
	if (way->memory)
		CVodeFree(&way->memory);
	if (way->fixed_point)
		SUNNonlinSolFree(way->fixed_point);
	if (way->linear)
		SUNLinSolFree(way->linear);
	if (way->matrix)
		SUNMatDestroy(way->matrix);
	if (way->y)
		N_VDestroy(way->y);
	if (way->tolerances)
		N_VDestroy(way->tolerances);
	if (way->context)
		SUNContext_Free(&way->context);
	free(way->state);
}

/* ---- what they get wrong ---- */

struct found { bool failed; double largest, at_end; int missed, phases, falsely; };

static struct found compare(struct way *way)
{
	static double rows[2 * UNITS];
	const struct truth_of_friction *truth = way->truth;
	static bool sticks[UNITS + 2];
	struct found found = { .failed = !pass(way, rows) };
	const double still = way->kind == EXACT || way->kind == ROOTS ? 1e-12 * truth->fastest : 3 * way->setting;
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

static void list(struct ways *ways, const struct truth_of_friction *truth)
{
	static const struct { const char *name; enum kind kind; int lmm, first, last; } ladder[] = {
		{ "CVODE Adams, roots", ROOTS, CV_ADAMS, 3, 11 }, { "CVODE BDF, roots", ROOTS, CV_BDF, 3, 9 },
		{ "tanh, CVODE BDF", SMOOTH, CV_BDF, 1, 6 }, { "tanh, CVODE Adams", SMOOTH, CV_ADAMS, 1, 4 },
		{ "tanh, RK4", STEPS, 0, 1, 4 },
	};
	for (int parts = 1; parts <= 5; parts += 4)
		ways->way[ways->count++] = (struct way){ .name = "exact", .setting = unit / parts, .truth = truth };
	for (size_t i = 0; i < sizeof ladder / sizeof *ladder; i++)
		for (int e = ladder[i].first; e <= ladder[i].last; e++)
			ways->way[ways->count++] = (struct way){ .name = ladder[i].name, .kind = ladder[i].kind,
				.lmm = ladder[i].lmm, .setting = pow(10, -e), .truth = truth };
}

static const char *const setting_is[] = { "step_s", "rtol", "eps_m_per_s", "eps_m_per_s" };

static void errors(struct ways *ways, const char *folder)
{
	FILE *csv = table_open(folder, "friction.csv", "method,setting_kind,setting,largest,at_end,phases,missed,"
	                                               "false,true_phases,evaluations_per_s");
	for (int i = 0; i < ways->count; i++) {
		struct way *way = &ways->way[i];
		const struct found found = compare(way);
		fprintf(csv, "\"%s\",%s,%g,", way->name, setting_is[way->kind], way->setting);
		if (found.failed)
			fprintf(csv, "failed,failed,,,,");
		else
			fprintf(csv, "%.4g,%.4g,%d,%d,%d,", found.largest, found.at_end, found.phases, found.missed,
			        found.falsely);
		fprintf(csv, "%d,", way->truth->seen);
		if (way->kind != EXACT)
			fprintf(csv, "%.4g", (double)way->evaluations / (UNITS * unit));
		fprintf(csv, "\n");
	}
	fclose(csv);
}

static const double dear = 1e6;         /* ns a simulated second: a few passes do */

/* What the process has used: others may take its place */
static double own_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* Passes that take turns */
static void times(struct ways *ways, const char *folder)
{
	static double ns[MOST_WAYS][ROUNDS];
	FILE *csv = table_open(folder, "friction_times.csv", "method,setting_kind,setting,largest,ns_min,ns_median,"
	                                                     "ns_max,ns_min_over_exact");
	static int count[MOST_WAYS];
	for (int round = 0; round < ROUNDS; round++)
		for (int i = 0; i < ways->count; i++) {
			if (round >= FEW && ns[i][0] > dear)
				continue;
			const double begin = own_ns();
			pass(&ways->way[i], NULL);
			ns[i][count[i]++] = (own_ns() - begin) / (UNITS * unit);
		}
	double exact = 0;
	for (int i = 0; i < ways->count; i++) {
		struct way *way = &ways->way[i];
		const struct samples time = sample_summary(count[i], ns[i]);
		const struct found found = compare(way);
		exact = i == 0 ? time.min : exact;
		fprintf(csv, "\"%s\",%s,%g,%.4g,%.4g,%.4g,%.4g,%.4g\n", way->name, setting_is[way->kind], way->setting,
		        found.failed ? NAN : found.largest, time.min, time.median, time.max, time.min / exact);
	}
	fclose(csv);
}

int main(int argc, char **argv)
{
	static struct ways ways;
	static struct truth_of_friction truth;
	const bool timed = flags_of(argc, &argv, "--times", 2, 2, "friction [--times] VARIANTS OUTDIR");
	say_progress("friction: %s", timed ? "times" : "errors");
	find_truth(&truth);
	list(&ways, &truth);
	for (int i = 0; i < ways.count; i++)
		way_open(&ways.way[i], argv[0]);
	(timed ? times : errors)(&ways, argv[1]);
	for (int i = 0; i < ways.count; i++)
		way_close(&ways.way[i]);
	return 0;
}
