/* SPDX-License-Identifier: GPL-3.0-or-later */
/* load_specs FIRST LAST [SEED]: writes FIRST.spec ... into the working directory, each a random model with loads t^k
 * e^{a t} cos(w t + p), k up to 4, |w h| from 1e-3 to 30: springs and dampers in a chain, some of them free, undamped,
 * with a coordinate of first order, an input, initial values or loads that change their formula. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static uint64_t state;

static uint64_t next_random(void)
{
	state ^= state << 13;
	state ^= state >> 7;
	state ^= state << 17;
	return state;
}

static int below(int n)
{
	return (int)(next_random() >> 33) % n;
}

static double between(double low, double high)
{
	return low + (high - low) * (double)(next_random() >> 11) * 0x1p-53;
}

static double scale(double low, double high)
{
	return low * pow(high / low, between(0.0, 1.0));
}

static void write_load(FILE *to, double h)
{
	const int power = below(5);
	fprintf(to, "%.3g", between(0.5, 2.0));
	if (power > 0)
		fprintf(to, "*t^%d", power);
	if (below(3) == 0)
		fprintf(to, "*exp(%.3g*t)", between(-2e-3, 2e-3) / h);
	if (below(8) > 0)
		fprintf(to, "*cos(%.4g*t + %.2g)", scale(1e-3, 30.0) / h, between(0.0, 3.0));
}

static void write_model(FILE *to, int number)
{
	const int n = 1 + below(4), grounded = below(5) > 0, damped = below(4) > 0, loaded = below(n),
			lag = below(6) == 0,
		input = below(6) == 0;
	const double h = scale(1e-3, 0.1), stiffness = pow(scale(1e-2, 1.0) / h, 2.0);
	int i;
	fprintf(to, "model m%d\ncoord x1", number);
	for (i = 2; i <= n + lag; i++)
		fprintf(to, ", x%d", i);
	fprintf(to, "\n%s", input ? "input u\n" : "");
	for (i = 1; i <= n; i++) {
		fprintf(to, "%.3g*x%d''", scale(0.3, 3.0), i);
		if (damped)
			fprintf(to, " + %.3g*x%d'", 0.05 * sqrt(stiffness) * between(0.1, 1.0), i);
		if (grounded && i == 1)
			fprintf(to, " + %.3g*x1", stiffness * between(0.1, 1.0));
		if (i > 1)
			fprintf(to, " + %.3g*(x%d - x%d)", stiffness, i, i - 1);
		if (i < n)
			fprintf(to, " + %.3g*(x%d - x%d)", stiffness, i, i + 1);
		fprintf(to, " = %s", input && i == n ? "u + " : "");
		if (i - 1 == loaded && below(5) == 0) {
			fprintf(to, "(t < %.3g ? ", 300.7 * h);
			write_load(to, h);
			fputs(" : ", to);
			write_load(to, h);
			fputs(")", to);
		} else if (i - 1 == loaded) {
			write_load(to, h);
		}
		if (i - 1 == loaded && below(3) == 0) {
			fputs(" + ", to);
			write_load(to, h);
		}
		fputs(i - 1 == loaded ? "\n" : "0\n", to);
	}
	if (lag)
		fprintf(to, "x%d' + %.3g*x%d = x%d\n", n + 1, 0.3 * sqrt(stiffness), n + 1, n);
	if (below(3) == 0)
		fprintf(to, "init x1 = %.3g\n", 1.0 / stiffness);
	fprintf(to, "step %.4g\n", h);
}

int main(int argc, char **argv)
{
	int k;
	if (argc < 3)
		return 2;
	state = 0x9E3779B97F4A7C15 * (argc > 3 ? strtoull(argv[3], NULL, 10) : 1);
	for (k = 0; k < 10; k++)
		next_random();
	for (k = atoi(argv[1]); k <= atoi(argv[2]); k++) {
		char name[32];
		FILE *to;
		snprintf(name, sizeof name, "%d.spec", k);
		to = fopen(name, "w");
		if (!to)
			return 1;
		write_model(to, k);
		fclose(to);
	}
	return 0;
}
