/* SPDX-License-Identifier: GPL-3.0-or-later */
/* apply: time of one product of a matrix with a vector, by the runtime and by a plain loop, in short samples that take
 * turns so that both meet the same machine; prints both medians and their ratio. */
#include "plrt.h"
#include "timing.h"

#include <stdio.h>
#include <stdlib.h>

enum { SAMPLES = 401, REPEATS = 200, LARGEST = 60 };

typedef void product(int rows, int columns, const double *table, const double *x, double *y);

/* What pl_multiply is measured against: one sum per row, each addition after the other */
static void plain(int rows, int columns, const double *table, const double *x, double *y)
{
	for (int i = 0; i < rows; i++, table += columns) {
		double sum = 0.0;
		for (int j = 0; j < columns; j++)
			sum += table[j] * x[j];
		y[i] = sum;
	}
}

/* Each product waits for the one before it, as the products of a step do. */
static double sample(product *multiply, int rows, int columns, const double *table, double *x, double *y)
{
	double start = nanoseconds();
	for (int k = 0; k < REPEATS; k++) {
		multiply(rows, columns, table, x, y);
		x[0] = 0.5 * y[rows - 1];
	}
	return (nanoseconds() - start) / REPEATS;
}

static void measure(int rows, int columns)
{
	static double table[LARGEST * LARGEST], x[LARGEST], y[LARGEST], runtime[SAMPLES], loop[SAMPLES];
	product *volatile of_loop = plain;              /* called, as the runtime's is */
	for (int i = 0; i < rows * columns; i++)
		table[i] = (double)(i * 7919 % 2003 - 1001) / (1001.0 * columns);
	for (int j = 0; j < columns; j++)
		x[j] = 1.0 / (j + 1);
	for (int k = 0; k < SAMPLES; k++) {
		runtime[k] = sample(pl_multiply, rows, columns, table, x, y);
		loop[k] = sample(of_loop, rows, columns, table, x, y);
	}
	double a = median(runtime), b = median(loop);
	printf("%2d x %2d: pl_multiply %7.1f ns (%.3f ns a multiplication), plain loop %7.1f ns, ratio %.2f\n", rows,
	       columns, a, a / (rows * columns), b, a / b);
}

int main(void)
{
	measure(30, 30);
	measure(30, 15);
	measure(60, 60);
	measure(4, 4);
	measure(4, 2);
	return 0;
}
