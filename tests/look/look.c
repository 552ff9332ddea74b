/* SPDX-License-Identifier: GPL-3.0-or-later */
/* look MODEL JSON CSV: what --explain=json and --response tell of a model's linear part, by another road. MODEL names
 * the forces of each input and load, and the outputs, as a reader of the spec writes them down; M, C and K come from
 * the JSON. Transfer functions are dense complex solutions of (M s^2 + C s + K) x = f(s) in long double: on the
 * imaginary axis against the CSV, at 0 against static gains, at each zero against 0. Shapes are put into the equations.
 * A of the state space follows from M, C and K, Phi and the held B from their Taylor series, transfer functions from A,
 * B, C, D. */
#include "../emitted/tap.h"
#include "../emitted/worse.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 8, CELLS = 256 };
typedef long double complex number;

/* ---- the files ---- */

static char *text_of(const char *path)
{
	FILE *f = fopen(path, "rb");
	char *text = calloc(1, 1 << 22);
	if (!f || !text || fread(text, 1, (1 << 22) - 1, f) == 0)
		exit(99);
	fclose(f);
	return text;
}

/* Numbers behind a key, up to the bracket that closes the first; how many, or -1: it is not there */
static int numbers_at(const char *text, const char *key, double *value)
{
	int count = 0, depth = 0;
	const char *at = text ? strstr(text, key) : NULL;
	if (!at)
		return -1;
	for (at = strchr(at, '['); *at; at++) {
		char *end;
		if (*at == '[')
			depth++;
		else if (*at == ']' && --depth == 0)
			break;
		else if ((*at == '-' || (*at >= '0' && *at <= '9')) && count < CELLS) {
			value[count++] = strtod(at, &end);
			at = end - 1;
		}
	}
	return count;
}

static double number_at(const char *text, const char *key)
{
	const char *at = strstr(text, key);
	return at ? strtod(at + strlen(key), NULL) : NAN;
}

/* ---- the model ---- */

struct truth {
	const char *name;
	int n, drives, outputs;
	void (*force)(int drive, number s, number *f);
	number (*output)(int output, int drive, number s, const number *x);
};

static void car_force(int drive, number s, number *f)
{
	f[0] = drive == 1 ? 20 : 0;
	f[1] = drive == 0 ? 180000 + 150 * s : 0;
}

static number car_output(int output, int drive, number s, const number *x)
{
	number road = drive == 0;
	switch (output) {
	case 0: return x[0];
	case 1: return x[1] - x[0];
	case 2: return s * s * x[0];
	default: return (180000 + 150 * s) * (road - x[1]);
	}
}

static void held_force(int drive, number s, number *f)
{
	(void)s;
	f[0] = drive == 0 ? 3 : 0;
	f[1] = drive == 0 ? 1 : -2;
}

static number held_output(int output, int drive, number s, const number *x)
{
	return output == 0 ? x[0] : output == 1 ? 40 * (x[1] - x[0]) + (drive == 1) : s * x[0];
}

static void sdcsf_force(int drive, number s, number *f)
{
	(void)drive;
	(void)s;
	f[0] = 1;
	f[1] = 0;
}

static number sdcsf_output(int output, int drive, number s, const number *x)
{
	(void)drive;
	return (output > 1 ? s : 1) * x[output % 2];
}

static const struct truth truths[] = {
	{ "car", 2, 2, 4, car_force, car_output },
	{ "held", 2, 2, 3, held_force, held_output },
	{ "sdcsf", 2, 1, 4, sdcsf_force, sdcsf_output },
};

static const struct truth *truth;
static double M[CELLS], C[CELLS], K[CELLS];

/* a x = b by elimination with partial pivoting; b becomes x */
static void solve(int n, number a[MOST][MOST], number *b)
{
	for (int k = 0; k < n; k++) {
		int best = k;
		for (int i = k; i < n; i++)
			best = cabsl(a[i][k]) > cabsl(a[best][k]) ? i : best;
		for (int j = 0; j < n; j++) {
			number kept = a[k][j];
			a[k][j] = a[best][j];
			a[best][j] = kept;
		}
		number kept = b[k];
		b[k] = b[best];
		b[best] = kept;
		for (int i = 0; i < n; i++) {
			number factor = a[i][k] / a[k][k];
			if (i == k)
				continue;
			for (int j = k; j < n; j++)
				a[i][j] -= factor * a[k][j];
			b[i] -= factor * b[k];
		}
	}
	for (int k = 0; k < n; k++)
		b[k] /= a[k][k];
}

static void fill_P(number s, number P[MOST][MOST])
{
	int n = truth->n;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			P[i][j] = M[i * n + j] * s * s + C[i * n + j] * s + K[i * n + j];
}

/* H(s); *size: about what its terms are of */
static number transfer(int output, int drive, number s, long double *size)
{
	number P[MOST][MOST], x[MOST], one[MOST];
	fill_P(s, P);
	truth->force(drive, s, x);
	solve(truth->n, P, x);
	if (size) {
		*size = 0;
		for (int i = 0; i < truth->n; i++) {
			memset(one, 0, sizeof one);
			one[i] = x[i];
			*size += cabsl(truth->output(output, 99, s, one));
		}
		memset(one, 0, sizeof one);
		*size += cabsl(truth->output(output, drive, s, one));
	}
	return truth->output(output, drive, s, x);
}

static void check(const char *what, double worst, double most, int count, int expected)
{
	if (count != expected)
		printf("# %s: %d values, expected %d\n", what, count, expected);
	if (!(worst <= most))
		printf("# %s: %.3g, at most %.3g\n", what, worst, most);
	ok(count == expected && worst <= most, "%s", what);
}

/* ---- frequency responses ---- */


static void check_response(const char *csv)
{
	double size = 0, angle = 0, jump = 0, last[MOST * MOST] = { 0 };
	int rows = 0;
	for (const char *line = strchr(csv, '\n') + 1; *line; rows++) {
		char *end;
		double f = strtod(line, &end);
		int k = 0;
		for (; *end == ','; k++) {
			double found = strtod(end + 1, &end), phase = strtod(end + 1, &end);
			number s = (number)I * 6.28318530717958647692528676656L * f;
			number H = transfer(k % truth->outputs, k / truth->outputs, s, NULL);
			double off = phase - (double)(cargl(H) * 360 / 6.28318530717958647692528676656L);
			size = worse(size, fabs(found / (double)cabsl(H) - 1));
			angle = worse(angle, fabs(off - 360 * rint(off / 360)));
			jump = rows ? worse(jump, fabs(phase - last[k])) : 0;
			last[k] = phase;
		}
		if (k != truth->drives * truth->outputs)
			size = NAN;
		line = strchr(end, '\n') + 1;
	}
	check("magnitudes against solutions of (K + jwC - w^2 M) x = f", size, 1e-15, rows, 400);
	check("phases against the same [deg]", angle, 1e-12, rows, 400);
	check("phases go on from row to row [deg]", jump, 120, rows, 400);
}

/* ---- gains, zeros ---- */

static void check_zeros(const char *json)
{
	double gains = 0, values = 0, zero[CELLS];
	int count = 0, told = 0;
	const char *at = strstr(json, "\"zeros\": ["), *end = strstr(json, "\"ss\": ");
	for (at = strstr(at, "{\"output\""); at && at < end; at = strstr(at + 1, "{\"output\""), count++) {
		int output = count % truth->outputs, drive = count / truth->outputs;
		long double size;
		double gain = number_at(at, "\"static_gain\": ");
		number H = transfer(output, drive, 0, &size);
		gains = worse(gains, fabs(gain - (double)creall(H)) / (double)(size > 0 ? size : 1));
		int numbers = numbers_at(at, "\"zeros\"", zero);
		for (int i = 0; i + 2 < numbers; i += 3, told++) {
			number z = zero[i] + zero[i + 1] * (number)I,
					beside = z + 0.01L * (cabsl(z) + 1) * (1 + (number)I);
			values = worse(values, (double)(cabsl(transfer(output, drive, z, NULL)) /
											cabsl(transfer(output, drive,
											beside, NULL))));
		}
	}
	check("static gains against K x = f", gains, 1e-15, count, truth->drives * truth->outputs);
	check("outputs at their zeros, beside those near them", values, 1e-12, told > 0, 1);
}

/* ---- shapes ---- */

static void check_shapes(const char *json)
{
	double residual = 0, largest = 0, re[CELLS], im[CELLS];
	int n = truth->n, count = 0;
	const char *at = strstr(json, "\"shapes\": ["), *end = strstr(json, "\"zeros\": [");
	for (at = strstr(at, "{\"pole\""); at && at < end; at = strstr(at + 1, "{\"pole\""), count++) {
		number P[MOST][MOST], p = number_at(at, "\"re\": ") + number_at(at, "\"im\": ") * (number)I;
		const char *vector = strchr(at, '}');
		if (numbers_at(vector, "\"re\"", re) != n || numbers_at(vector, "\"im\"", im) != n)
			residual = NAN;
		fill_P(p, P);
		double most = 0;
		for (int i = 0; i < n; i++) {
			number sum = 0;
			long double size = 0;
			for (int j = 0; j < n; j++) {
				sum += P[i][j] * (re[j] + im[j] * (number)I);
				size += fabsl((long double)K[i * n + j]) + cabsl(p) * fabsl((long double)C[i * n + j]) +
						cabsl(p * p) * fabsl((long double)M[i * n + j]);
			}
			residual = worse(residual, (double)(cabsl(sum) / size));
			most = worse(most, hypot(re[i], im[i]));
		}
		largest = worse(largest, fabs(most - 1));
	}
	check("shapes put into the equations", residual, 1e-15, count, n);
	check("their largest entries are 1", largest, 1e-15, count, n);
}

/* ---- state space ---- */

struct space {
	int states, drives, outputs;
	double A[CELLS], B[CELLS], C[CELLS], D[CELLS], slopeB[CELLS], slopeD[CELLS];
};

static bool read_space(const char *json, struct space *s)
{
	const char *at = strstr(json, "\"ss\": ");
	int n = s->states;
	memset(s->slopeB, 0, sizeof s->slopeB);
	memset(s->slopeD, 0, sizeof s->slopeD);
	const char *slope = strstr(at, "\"B_slope\"");
	if (slope)
		(void)numbers_at(slope, "\"B_slope\"", s->slopeB), (void)numbers_at(slope, "\"D_slope\"", s->slopeD);
	return numbers_at(at, "\"A\"", s->A) == n * n && numbers_at(at, "\"B\"", s->B) == n * s->drives &&
		   numbers_at(at, "\"C\"", s->C) == s->outputs * n &&
				numbers_at(at, "\"D\"", s->D) == s->outputs * s->drives;
}

/* C (s - A)^-1 (B + s B') + D + s D' against the equations, at some s */
static void check_space(const char *json)
{
	struct space s = { .states = 2 * truth->n, .drives = truth->drives, .outputs = truth->outputs };
	bool there = read_space(json, &s);
	double worst = 0;
	int count = 0;
	for (int k = 1; k <= 20; k++)
		for (int d = 0; d < s.drives; d++) {
			number at = -0.3L * k + 2.7L * k * (number)I, a[MOST][MOST], x[MOST];
			for (int i = 0; i < s.states; i++) {
				x[i] = s.B[i * s.drives + d] + at * s.slopeB[i * s.drives + d];
				for (int j = 0; j < s.states; j++)
					a[i][j] = (i == j ? at : 0) - s.A[i * s.states + j];
			}
			solve(s.states, a, x);
			for (int o = 0; o < s.outputs; o++, count++) {
				long double size;
				number sum = s.D[o * s.drives + d] + at * s.slopeD[o * s.drives + d];
				number H = transfer(o, d, at, &size);
				for (int j = 0; j < s.states; j++)
					sum += s.C[o * s.states + j] * x[j];
				worst = worse(worst, (double)(cabsl(sum - H) / size));
			}
		}
	check("state space against the equations", worst, 1e-13, there ? count : -1, 20 * s.drives * s.outputs);
}

/* e^{A h} and its integral times B by Taylor series */
static void check_discrete(const char *json)
{
	struct space s = { .states = 2 * truth->n, .drives = truth->drives, .outputs = truth->outputs };
	const char *at = strstr(json, "\"discrete\": ");
	double Phi[CELLS], Gamma[CELLS], table[CELLS], worst = 0, h = number_at(json, "\"step\": ");
	long double term[MOST][MOST] = { { 0 } }, power[MOST][MOST] = { { 0 } }, whole[MOST][MOST] = { { 0 } };
	int n = s.states, m = n + s.drives;
	bool there = read_space(json, &s) && numbers_at(at, "\"A\"", Phi) == n * n &&
				 numbers_at(at, "\"B\"", Gamma) == n * s.drives &&
						numbers_at(json, "\"Phi\"", table) == n * n;
	for (int i = 0; i < m; i++)
		term[i][i] = whole[i][i] = 1;
	for (int k = 1; k < 60; k++) {
		memset(power, 0, sizeof power);
		for (int i = 0; i < n; i++)
			for (int j = 0; j < m; j++)
				for (int l = 0; l < m; l++) {
					long double a = l < n ? s.A[i * n + l] : s.B[i * s.drives + l - n];
					power[i][j] += a * term[l][j] * h / k;
				}
		memcpy(term, power, sizeof term);
		for (int i = 0; i < m; i++)
			for (int j = 0; j < m; j++)
				whole[i][j] += term[i][j];
	}
	for (int i = 0; there && i < n; i++)
		for (int j = 0; j < m; j++) {
			double value = j < n ? Phi[i * n + j] : Gamma[i * s.drives + j - n];
			worst = worse(worst, fabs(value - (double)whole[i][j]) / fabs((double)whole[i][j]));
			if (j < n)
				worst = worse(worst, fabs(value - table[i * n + j]) / fabs(value));
		}
	check("discrete state space against Taylor series, and Phi", worst, 1e-15, there, 1);
}

int main(int argc, char **argv)
{
	if (argc != 4)
		return 99;
	for (size_t i = 0; i < sizeof truths / sizeof *truths; i++)
		if (strcmp(truths[i].name, argv[1]) == 0)
			truth = &truths[i];
	char *json = text_of(argv[2]), *csv = text_of(argv[3]);
	int n = truth ? truth->n : -1;
	if (numbers_at(json, "\"M\"", M) != n * n || numbers_at(json, "\"C\"", C) != n * n ||
		numbers_at(json, "\"K\"", K) != n * n)
		return 99;
	check_response(csv);
	check_zeros(json);
	check_shapes(json);
	check_space(json);
	if (strcmp(argv[1], "car") != 0)
		check_discrete(json);
	free(json);
	free(csv);
	return tap_end();
}
