/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a model does (lines "t ..." and "o ..." of drive.c, standard input) against CVODE on its equations, written here
 * by hand, or against a closed form from event to event:
 *     judge MODEL WITHIN[%] UNTIL START LOAD
 * initial values times START, loads times LOAD. Prints the largest difference of the output and what is allowed. */
#include "../cvode.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct equations {
	const char *name;
	int states;
	double start[3];
	void (*slopes)(double t, const double *y, double load, double *dydt);
	double (*output)(double t, const double *y, double load);
	double (*closed)(double t, double times); /* in the place of both; or NULL */
	enum { LOAD, HELD, RAMP } drive; /* the load is the input of drive.c, held for a step or straight through it */
};

static double first(double t, const double *y, double load)
{
	(void)t, (void)load;
	return y[0];
}

static void pendulum(double t, const double *y, double load, double *dydt)
{
	(void)t, (void)load;
	dydt[0] = y[1];
	dydt[1] = -sin(y[0]);
}

static void duffing(double t, const double *y, double load, double *dydt)
{
	dydt[0] = y[1];
	dydt[1] = load * 0.5 * cos(1.4 * t) - 0.2 * y[1] - y[0] - y[0] * y[0] * y[0];
}

static double acceleration(double t, const double *y, double load)
{
	double dydt[2];
	duffing(t, y, load, dydt);
	return dydt[1];
}

static void clearance(double t, const double *y, double load, double *dydt)
{
	const double gap = 0.3, past = y[0] > gap ? y[0] - gap : y[0] < -gap ? y[0] + gap : 0;
	dydt[0] = y[1];
	dydt[1] = load * 0.8 * cos(1.3 * t) - 0.1 * y[1] - 5 * past;
}

static void lorenz(double t, const double *y, double load, double *dydt)
{
	(void)t, (void)load;
	dydt[0] = 10 * (y[1] - y[0]);
	dydt[1] = y[0] * (28 - y[2]) - y[1];
	dydt[2] = y[0] * y[1] - 8.0 / 3 * y[2];
}

static void mathieu(double t, const double *y, double load, double *dydt)
{
	dydt[0] = y[1];
	dydt[1] = load * (t < 4 ? sin(3 * t) : 0) - 0.05 * y[1] - (1 + 0.3 * cos(2.1 * t)) * y[0];
}

static void driven(double t, const double *y, double u, double *dydt)
{
	(void)t;
	dydt[0] = y[1];
	dydt[1] = u - 0.3 * y[1] - 4 * y[0] - y[0] * y[0] * y[0];
}

static void pushed(double t, const double *y, double u, double *dydt)
{
	(void)t;
	dydt[0] = y[1];
	dydt[1] = u - 0.3 * y[1] - 4 * y[0] - 9 * fmax(y[0] - 0.05, 0);
}

static void plain(double t, const double *y, double u, double *dydt)
{
	(void)t;
	dydt[0] = y[1];
	dydt[1] = u - 0.3 * y[1] - 4 * y[0];
}

static double pushed_back(double t, const double *y, double u)
{
	double dydt[2];
	driven(t, y, u, dydt);
	return dydt[1];
}

static double energy(double t, const double *y, double u)
{
	(void)t, (void)u;
	return 0.5 * y[1] * y[1] + 2 * y[0] * y[0];
}

static void gravity_pendulum(double t, const double *y, double load, double *dydt)
{
	(void)t, (void)load;
	dydt[0] = y[1];
	dydt[1] = -9.81 * sin(y[0]);
}

static double across(double t, const double *y, double load)
{
	(void)t, (void)load;
	return sin(y[0]);
}

/* A ball from a height of 1: each bounce leaves 0.8 of the speed. */
static double bounces(double t, double times)
{
	const double g = 9.81, fall = sqrt(2 * times / g);
	double v = 0.8 * g * fall;
	if (t < fall)
		return times - g * t * t / 2;
	for (t -= fall; t > 2 * v / g; v *= 0.8)
		t -= 2 * v / g;
	return v * t - g * t * t / 2;
}

/* A mass on a spring with friction 0.1: half cosines about 0.1 and -0.1, until it sticks. */
static double rubs(double t, double times)
{
	const double half = 3.14159265358979324;
	double x = times, about = 0.1;
	for (; t >= half && fabs(x) > 0.1; t -= half) {
		x = 2 * about - x;
		about = -about;
	}
	return fabs(x) > 0.1 ? about + (x - about) * cos(t) : x;
}

static const struct equations all[] = {
	{"pendulum", 2, {1.0472, 0}, pendulum, first, NULL, LOAD},
	{"duffing", 2, {1, 0}, duffing, first, NULL, LOAD},
	{"shaken", 2, {1, 0}, duffing, acceleration, NULL, LOAD},
	{"clearance", 2, {0.2, 0}, clearance, first, NULL, LOAD},
	{"lorenz", 3, {1, 1, 20}, lorenz, first, NULL, LOAD},
	{"mathieu", 2, {0.5, 0}, mathieu, first, NULL, LOAD},
	{"driven", 2, {0.1, 0}, driven, first, NULL, HELD},
	{"pushed", 2, {0.1, 0}, pushed, first, NULL, HELD},
	{"ramped", 2, {0.1, 0}, driven, pushed_back, NULL, RAMP},
	{"rod", 2, {1.5707963267948966, 0}, gravity_pendulum, across, NULL, LOAD},
	{"bounces", 2, {1, 0}, pendulum, first, bounces, LOAD},
	{"rubs", 2, {1, 0}, pendulum, first, rubs, LOAD},
	{"plain", 2, {0.1, 0}, plain, energy, NULL, HELD},
};

struct solving { const struct equations *of; double load, slope, since; };

/* u, and beside a ramp a fifth of u' */
static double load_at(const struct solving *s, double t)
{
	return s->load + s->slope * (t - s->since) + 0.2 * s->slope;
}

/* Over the step that ends now, by the sample of drive.c; a ramp begins with the one before, the first with 0 */
static void sample(struct solving *s, long n, double t, double now)
{
	const double u = (double)(n * 7 % 11 - 5) / 8;
	s->load = s->of->drive == HELD ? u : s->load + s->slope * (t - s->since);
	s->slope = (u - s->load) / (now - t);
	s->since = t;
}

static int slopes(realtype t, N_Vector y, N_Vector dydt, void *from)
{
	const struct solving *s = from;
	s->of->slopes(t, N_VGetArrayPointer(y), load_at(s, t), N_VGetArrayPointer(dydt));
	return 0;
}

struct found { double worst, largest; long samples; };

/* The solver to each time that is read, beside what the model has there */
static struct found compare(struct solving *s, double until, double times)
{
	struct found found = {0, 0, 0};
	double now = 0, out;
	double start[sizeof s->of->start / sizeof *s->of->start];
	struct cvode c;
	realtype t = 0;
	for (int i = 0; i < s->of->states; i++)
		start[i] = s->of->start[i] * times;
	bool good = cvode_open(&c, CV_BDF, s->of->states, start, slopes, s, 1e-12, 1e-13, NULL);
	for (char line[4096]; good && fgets(line, sizeof line, stdin);) {
		if (line[0] == 't')
			now = strtod(line + 1, NULL);
		if (line[0] != 'o' || now > until * (1 + 1e-12))
			continue;
		out = strtod(line + 1, NULL);
		if (s->of->drive != LOAD) {
			sample(s, found.samples, t, now);
			good = CVodeReInit(c.memory, t, c.y) == CV_SUCCESS;
		}
		good = good && (s->of->closed || CVode(c.memory, now, c.y, &t, CV_NORMAL) >= 0);
		const double exact = s->of->closed ? s->of->closed(now, times)
					   : s->of->output(now, N_VGetArrayPointer(c.y), load_at(s, now));
		const double error = fabs(out - exact);
		found.worst = error <= found.worst ? found.worst : error;
		found.largest = fmax(found.largest, fabs(exact));
		found.samples++;
	}
	cvode_close(&c);
	found.samples = good ? found.samples : 0;
	return found;
}

int main(int argc, char **argv)
{
	struct solving s = {NULL, argc > 5 ? atof(argv[5]) : 1, 0, 0};
	for (size_t i = 0; argc > 5 && i < sizeof all / sizeof *all; i++)
		if (strcmp(all[i].name, argv[1]) == 0)
			s.of = &all[i];
	if (!s.of)
		return 2;
	s.load = s.of->drive == RAMP ? 0 : s.load;
	const struct found found = compare(&s, atof(argv[3]), atof(argv[4]));
	const double within = atof(argv[2]) * (strchr(argv[2], '%') ? found.largest / 100 : 1);
	printf("off by %.3g at most in %ld samples, %.3g is needed\n", found.worst, found.samples, within);
	return !(found.samples > 0 && found.worst <= within);
}
