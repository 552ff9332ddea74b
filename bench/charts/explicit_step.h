/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of RK4, Heun's method and velocity Verlet, for the peers with a fixed step. Who includes it names
 * EXPLICIT_SLOPES(of, t, y, f), the slopes f of what `of`, an EXPLICIT_TYPE, is about, and EXPLICIT_MOST, entries of a
 * state at most. state: `size` entries, of verlet coordinates, then velocities, and behind them the accelerations that
 * it keeps from one step to the next. EXPLICIT_UNROLLED: size is a constant, and loops over entries are unrolled. */
#ifdef EXPLICIT_UNROLLED
#define EACH(count) _Pragma("GCC unroll 4") for (int m = 0; m < (count); m++)
#else
#define EACH(count) for (int m = 0; m < (count); m++)
#endif

/* k1: the slope at the start */
INLINE void rk4_from(const int size, EXPLICIT_TYPE *of, double t, double h, double *state, const double *k1)
{
	const double half = 0.5 * h, sixth = h / 6.0;
	double k2[EXPLICIT_MOST], k3[EXPLICIT_MOST], k4[EXPLICIT_MOST], x[EXPLICIT_MOST];
	EACH(size)
		x[m] = state[m] + half * k1[m];
	EXPLICIT_SLOPES(of, t + half, x, k2);
	EACH(size)
		x[m] = state[m] + half * k2[m];
	EXPLICIT_SLOPES(of, t + half, x, k3);
	EACH(size)
		x[m] = state[m] + h * k3[m];
	EXPLICIT_SLOPES(of, t + h, x, k4);
	EACH(size)
		state[m] += sixth * (k1[m] + 2.0 * (k2[m] + k3[m]) + k4[m]);
}

INLINE void rk4_step(const int size, EXPLICIT_TYPE *of, double t, double h, double *state)
{
	double k1[EXPLICIT_MOST];
	EXPLICIT_SLOPES(of, t, state, k1);
	rk4_from(size, of, t, h, state, k1);
}

INLINE void heun_step(const int size, EXPLICIT_TYPE *of, double t, double h, double *state)
{
	double k1[EXPLICIT_MOST], k2[EXPLICIT_MOST], x[EXPLICIT_MOST];
	EXPLICIT_SLOPES(of, t, state, k1);
	EACH(size)
		x[m] = state[m] + h * k1[m];
	EXPLICIT_SLOPES(of, t + h, x, k2);
	EACH(size)
		state[m] += 0.5 * h * (k1[m] + k2[m]);
}

/* Velocity Verlet: the accelerations are those at t. Forces that depend on velocity see v + h a, which is of second
 * order */
INLINE void verlet_step(const int size, EXPLICIT_TYPE *of, double t, double h, double *state)
{
	const int n = size / 2;
	double *q = state, *v = state + n, *a = state + size, x[EXPLICIT_MOST], f[EXPLICIT_MOST];
	EACH(n) {
		x[m] = q[m] + h * (v[m] + 0.5 * h * a[m]);
		x[n + m] = v[m] + h * a[m];
	}
	EXPLICIT_SLOPES(of, t + h, x, f);
	EACH(n) {
		q[m] = x[m];
		v[m] += 0.5 * h * (a[m] + f[n + m]);
		a[m] = f[n + m];
	}
}
