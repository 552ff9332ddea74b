/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of fixed length for one right-hand side, compiled into them: included once a model by inlined.c (instances.h).
 * state: coordinates, velocities, and the accelerations that some methods keep from one step to the next. */
#define SIZE (2 * COORDINATES)
#define EACH _Pragma("GCC unroll 4") for (int m = 0; m < SIZE; m++)
#define EACH_COORDINATE _Pragma("GCC unroll 4") for (int m = 0; m < COORDINATES; m++)

/* k1: the slope at the start */
INLINE void INSTANCE(rk4_from)(double t, double h, double *state, const double *k1)
{
	const double half = 0.5 * h, sixth = h / 6.0;
	double k2[SIZE], k3[SIZE], k4[SIZE], x[SIZE];
	EACH
		x[m] = state[m] + half * k1[m];
	SLOPES(t + half, x, k2);
	EACH
		x[m] = state[m] + half * k2[m];
	SLOPES(t + half, x, k3);
	EACH
		x[m] = state[m] + h * k3[m];
	SLOPES(t + h, x, k4);
	EACH
		state[m] += sixth * (k1[m] + 2.0 * (k2[m] + k3[m]) + k4[m]);
}

INLINE void INSTANCE(rk4_step)(double t, double h, double *state)
{
	double k1[SIZE];
	SLOPES(t, state, k1);
	INSTANCE(rk4_from)(t, h, state, k1);
}

INLINE void INSTANCE(heun_step)(double t, double h, double *state)
{
	double k1[SIZE], k2[SIZE], x[SIZE];
	SLOPES(t, state, k1);
	EACH
		x[m] = state[m] + h * k1[m];
	SLOPES(t + h, x, k2);
	EACH
		state[m] += 0.5 * h * (k1[m] + k2[m]);
}

/* Velocity Verlet; forces of velocity see v + h a, as in fixed.c */
INLINE void INSTANCE(verlet_step)(double t, double h, double *state)
{
	double *q = state, *v = state + COORDINATES, *a = state + SIZE, x[SIZE], f[SIZE];
	EACH_COORDINATE {
		x[m] = q[m] + h * (v[m] + 0.5 * h * a[m]);
		x[COORDINATES + m] = v[m] + h * a[m];
	}
	SLOPES(t + h, x, f);
	EACH_COORDINATE {
		q[m] = x[m];
		v[m] += 0.5 * h * (a[m] + f[COORDINATES + m]);
		a[m] = f[COORDINATES + m];
	}
}

/* Kicks b h and drifts a h in turns, symmetric: a kick first and last, so that its force is kept */
INLINE void INSTANCE(turns)(double t, double h, double *state, int drifts, const double *drift, const double *kick)
{
	double *q = state, *v = state + COORDINATES, *a = state + SIZE, f[SIZE];
	_Pragma("GCC unroll 20") for (int i = 0; i < drifts; i++) {
		const double kick_now = kick[i <= drifts / 2 ? i : drifts - i];
		const double drift_now = drift[i <= drifts / 2 ? i : drifts - 1 - i];
		EACH_COORDINATE {
			v[m] += kick_now * h * a[m];
			q[m] += drift_now * h * v[m];
		}
		SLOPES(t, state, f);
		EACH_COORDINATE
			a[m] = f[COORDINATES + m];
	}
	EACH_COORDINATE
		v[m] += kick[0] * h * a[m];
}

INLINE void INSTANCE(blanes_moan_step)(double t, double h, double *state)
{
	INSTANCE(turns)(t, h, state, BLANES_MOAN, blanes_moan_drift, blanes_moan_kick);
}

INLINE void INSTANCE(kahan_li_step)(double t, double h, double *state)
{
	INSTANCE(turns)(t, h, state, KAHAN_LI, kahan_li_drift, kahan_li_kick);
}

/* A step over several units, with the slope that the next one begins with: RK4 */
INLINE void INSTANCE(rk4_long)(double t, double h, double *state)
{
	double k1[SIZE];
	EACH
		k1[m] = state[COORDINATES + m];
	INSTANCE(rk4_from)(t, h, state, k1);
	SLOPES(t + h, state, k1);
	EACH_COORDINATE
		state[SIZE + m] = k1[COORDINATES + m];
}

INLINE void INSTANCE(verlet_long)(double t, double h, double *state)
{
	INSTANCE(verlet_step)(t, h, state);
}

INLINE void INSTANCE(blanes_moan_long)(double t, double h, double *state)
{
	INSTANCE(blanes_moan_step)(t, h, state);
}

INLINE void INSTANCE(kahan_li_long)(double t, double h, double *state)
{
	INSTANCE(kahan_li_step)(t, h, state);
}

/* The coordinates' polynomial of degree 5 through both ends of a step, their velocities and accelerations, in the part
 * of the step */
INLINE void INSTANCE(join)(double h, const double *from, const double *to, double bend[][4])
{
	EACH_COORDINATE {
		const double v = h * from[COORDINATES + m], a = 0.5 * h * h * from[SIZE + m];
		const double end = to[m] - from[m] - v - a, end_v = h * to[COORDINATES + m] - v - 2.0 * a,
			end_a = h * h * to[SIZE + m] - 2.0 * a;
		bend[m][0] = a;
		bend[m][1] = 10.0 * end - 4.0 * end_v + 0.5 * end_a;
		bend[m][2] = -15.0 * end + 7.0 * end_v - end_a;
		bend[m][3] = 6.0 * end - 3.0 * end_v + 0.5 * end_a;
	}
}

INLINE void INSTANCE(join_at)(const struct inlined *r, double s, double *y)
{
	const double over = 1.0 / r->h;
	EACH_COORDINATE {
		const double *b = r->bend[m], v = r->h * r->from[COORDINATES + m];
		y[m] = r->from[m] + s * (v + s * (b[0] + s * (b[1] + s * (b[2] + s * b[3]))));
		y[COORDINATES + m] = over * (v + s * (2.0 * b[0] + s * (3.0 * b[1] + s * (4.0 * b[2] +
		                                                                          s * 5.0 * b[3]))));
	}
}

#define MARCH(METHOD) \
static void INSTANCE(METHOD)(double t0, double unit, int units, int steps, double h, double *state, double *rows) \
{ \
	double s[3 * COORDINATES]; \
	memcpy(s, state, sizeof s); \
	for (int u = 0; u < units; u++) { \
		const double t = t0 + u * unit; \
		for (int k = 0; k < steps; k++) \
			INSTANCE(METHOD##_step)(t + k * h, h, s); \
		for (int m = 0; m < SIZE && rows; m++) \
			rows[(ptrdiff_t)u * SIZE + m] = s[m]; \
	} \
	memcpy(state, s, sizeof s); \
}
/* A step of `span` units; rows inside it from its polynomial, at its end the state. `fraction` of the next unit if
 * units is 0 */
#define STRIDE(METHOD) \
static void INSTANCE(METHOD##_stride)(struct inlined *r, int units, double fraction, double *rows) \
{ \
	const double over = 1.0 / r->span; \
	for (int u = 0; u < units || (units == 0 && u == 0); u++) { \
		if (r->inside == 0) { \
			memcpy(r->from, r->state, sizeof r->from); \
			INSTANCE(METHOD##_long)((double)r->units * r->run.problem->unit, r->h, r->state); \
			INSTANCE(join)(r->h, r->from, r->state, r->bend); \
		} \
		if (units > 0) { \
			r->inside = r->inside + 1 == r->span ? 0 : r->inside + 1; \
			r->units++; \
		} \
		double *row = rows ? rows + (ptrdiff_t)u * SIZE : r->now; \
		if (units > 0 && r->inside == 0) \
			memcpy(row, r->state, SIZE * sizeof *row); \
		else \
			INSTANCE(join_at)(r, (r->inside + fraction) * over, row); \
		if (rows && u == units - 1) \
			memcpy(r->now, row, SIZE * sizeof *row); \
	} \
}
MARCH(rk4)
MARCH(heun)
MARCH(verlet)
MARCH(blanes_moan)
MARCH(kahan_li)
STRIDE(rk4)
STRIDE(verlet)
STRIDE(blanes_moan)
STRIDE(kahan_li)

#undef STRIDE
#undef MARCH
#undef SIZE
#undef EACH
#undef EACH_COORDINATE
#undef INSTANCE
#undef COORDINATES
#undef EXTENT
#undef SLOPES
#undef JACOBIAN
