/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stages of Dormand and Prince 5(4), J. Computational and Applied Mathematics 6 (1980) 19; Hairer, Norsett, Wanner,
 * Solving Ordinary Differential Equations I, table II.5.2, written plainly. Who includes it names DORMAND_SLOPES(of, t,
 * y, f), the slopes f of what `of`, a DORMAND_TYPE, is about. */

/* From y, with the slope k[0] there, to x of order 5, whose slope is k[6] */
static inline void dormand_stages(DORMAND_TYPE *of, int size, double t, double h, const double *restrict y,
								  double *const k[7], double *restrict x)
{
	double *restrict k1 = k[0], *restrict k2 = k[1], *restrict k3 = k[2], *restrict k4 = k[3], *restrict k5 = k[4],
		*restrict k6 = k[5];
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (1.0 / 5.0 * k1[i]);
	DORMAND_SLOPES(of, t + h * (1.0 / 5.0), x, k2);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (3.0 / 40.0 * k1[i] + 9.0 / 40.0 * k2[i]);
	DORMAND_SLOPES(of, t + h * (3.0 / 10.0), x, k3);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i] + 32.0 / 9.0 * k3[i]);
	DORMAND_SLOPES(of, t + h * (4.0 / 5.0), x, k4);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (19372.0 / 6561.0 * k1[i] - 25360.0 / 2187.0 * k2[i] + 64448.0 / 6561.0 * k3[i] -
		                   212.0 / 729.0 * k4[i]);
	DORMAND_SLOPES(of, t + h * (8.0 / 9.0), x, k5);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (9017.0 / 3168.0 * k1[i] - 355.0 / 33.0 * k2[i] + 46732.0 / 5247.0 * k3[i] +
		                   49.0 / 176.0 * k4[i] - 5103.0 / 18656.0 * k5[i]);
	DORMAND_SLOPES(of, t + h, x, k6);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (35.0 / 384.0 * k1[i] + 500.0 / 1113.0 * k3[i] + 125.0 / 192.0 * k4[i] -
		                   2187.0 / 6784.0 * k5[i] + 11.0 / 84.0 * k6[i]);
	DORMAND_SLOPES(of, t + h, x, k[6]);
}

/* Entry i of what the step of order 4 has less */
static inline double dormand_error(double h, double *const k[7], int i)
{
	return h * (71.0 / 57600.0 * k[0][i] - 71.0 / 16695.0 * k[2][i] + 71.0 / 1920.0 * k[3][i] -
	            17253.0 / 339200.0 * k[4][i] + 22.0 / 525.0 * k[5][i] - 1.0 / 40.0 * k[6][i]);
}

/* At the part x of a step of h, of fourth order, from the stages that there are: II.6; the same as that of ode45 */
static inline void dormand_inside(int size, double h, double x, const double *y, double *const k[7], double *result)
{
	const double part = h * x, b1 = part * (1.0 + x * (-183.0 / 64.0 + x * (37.0 / 12.0 - x * (145.0 / 128.0)))),
		b3 = part * x * (1500.0 / 371.0 + x * (-1000.0 / 159.0 + x * (1000.0 / 371.0))),
		b4 = part * x * (-125.0 / 32.0 + x * (125.0 / 12.0 - x * (375.0 / 64.0))),
		b5 = part * x * (9477.0 / 3392.0 + x * (-729.0 / 106.0 + x * (25515.0 / 6784.0))),
		b6 = part * x * (-11.0 / 7.0 + x * (11.0 / 3.0 - x * (55.0 / 28.0))),
		b7 = part * x * (3.0 / 2.0 + x * (-4.0 + x * (5.0 / 2.0)));
	for (int i = 0; i < size; i++)
		result[i] = y[i] + (b1 * k[0][i] + b3 * k[2][i] + b4 * k[3][i] + b5 * k[4][i] + b6 * k[5][i] +
		                    b7 * k[6][i]);
}
