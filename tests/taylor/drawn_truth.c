/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Taylor coefficients of drawn equations, by Cauchy's integrals. */
#include "drawn_series.h"

/* ---- the truth ---- */

static mpfr_t series[RUNS][MOST_ORDER + 2][STATES], slope[COORDS];
static double growth;

static void angle_between(mpc_t z, const struct node *n)
{
	mpc_t y, part;
	bool turned = fabs(node[n->b].value) < fabs(node[n->a].value);
	double from = turned ? (node[n->a].value > 0 ? M_PI_2 : -M_PI_2)
						 : node[n->b].value > 0 ? 0 : node[n->a].value >= 0 ? M_PI : -M_PI;
	mpc_init2(y, BITS);
	mpc_init2(part, BITS);
	mpc_div(y, node[turned ? n->b : n->a].z, node[turned ? n->a : n->b].z, MPC_RNDNN);
	mpc_atan(z, y, MPC_RNDNN);
	if (turned)
		mpc_neg(z, z, MPC_RNDNN);
	mpfr_const_pi(mpc_realref(part), MPFR_RNDN);
	mpfr_mul_d(mpc_realref(part), mpc_realref(part), round(2 * from / M_PI) / 2, MPFR_RNDN);
	mpfr_add(mpc_realref(z), mpc_realref(z), mpc_realref(part), MPFR_RNDN);
	mpc_clear(y);
	mpc_clear(part);
}

static void raise_to(mpc_t z, const struct node *n)
{
	const struct node *b = &node[n->b];
	if (b->kind == NUMBER && floor(b->value) == b->value) {
		mpc_pow_si(z, node[n->a].z, (long)b->value, MPC_RNDNN);
		return;
	}
	mpc_log(z, node[n->a].z, MPC_RNDNN);
	mpc_mul(z, z, b->z, MPC_RNDNN);
	mpc_exp(z, z, MPC_RNDNN);
}

static void evaluate(struct node *n, mpc_srcptr time, mpc_t y[STATES])
{
	mpc_ptr a = n->a >= 0 ? node[n->a].z : NULL, b = n->b >= 0 && n->kind > STATE ? node[n->b].z : NULL;
	switch (n->kind) {
	case NUMBER: mpc_set_d(n->z, n->value, MPC_RNDNN); break;
	case TIME: mpc_set(n->z, time, MPC_RNDNN); break;
	case STATE: mpc_set(n->z, y[n->b], MPC_RNDNN); break;
	case PIECES: mpc_set(n->z, a, MPC_RNDNN); break;
	case CHOICE: mpc_set(n->z, n->holds ? a : b, MPC_RNDNN); break;
	case INPUT:
		mpc_set_d(n->z, n->value, MPC_RNDNN);
		if (n->b == 1) {                /* all of few bits */
			mpc_t change;
			mpc_init2(change, BITS);
			mpc_set_d(change, start_time, MPC_RNDNN);
			mpc_sub(change, time, change, MPC_RNDNN);
			mpfr_mul_d(mpc_realref(change), mpc_realref(change), (sample[1][1] - sample[1][0]) / h,
					MPFR_RNDN);
			mpfr_mul_d(mpc_imagref(change), mpc_imagref(change), (sample[1][1] - sample[1][0]) / h,
					MPFR_RNDN);
			mpc_add(n->z, n->z, change, MPC_RNDNN);
			mpc_clear(change);
		}
		break;
	case ADD: mpc_add(n->z, a, b, MPC_RNDNN); break;
	case SUBTRACT: mpc_sub(n->z, a, b, MPC_RNDNN); break;
	case MULTIPLY: mpc_mul(n->z, a, b, MPC_RNDNN); break;
	case DIVIDE: mpc_div(n->z, a, b, MPC_RNDNN); break;
	case POWER: raise_to(n->z, n); break;
	case ATAN2: angle_between(n->z, n); break;
	case SQRT: mpc_sqrt(n->z, a, MPC_RNDNN); break;
	case EXP: mpc_exp(n->z, a, MPC_RNDNN); break;
	case LOG: mpc_log(n->z, a, MPC_RNDNN); break;
	case SIN: mpc_sin(n->z, a, MPC_RNDNN); break;
	case COS: mpc_cos(n->z, a, MPC_RNDNN); break;
	case TAN: mpc_tan(n->z, a, MPC_RNDNN); break;
	case ASIN: mpc_asin(n->z, a, MPC_RNDNN); break;
	case ACOS: mpc_acos(n->z, a, MPC_RNDNN); break;
	case ATAN: mpc_atan(n->z, a, MPC_RNDNN); break;
	case SINH: mpc_sinh(n->z, a, MPC_RNDNN); break;
	case COSH: mpc_cosh(n->z, a, MPC_RNDNN); break;
	case TANH: mpc_tanh(n->z, a, MPC_RNDNN); break;
	default: abort();
	}
}

/* plus 2^-53 (d0 v0 + d1 v1 tau + d2 v2 tau^2 + ...), 1/2 <= |d| <= 1, v the sizes of its own coefficients */
static void round_once(struct node *n, mpc_srcptr tau, int order)
{
	mpc_t sum;
	mpc_init2(sum, BITS);
	mpc_set_ui(sum, 0, MPC_RNDNN);
	for (int k = order; k >= 0; k--) {
		mpc_mul(sum, sum, tau, MPC_RNDNN);
		mpfr_add_d(mpc_realref(sum), mpc_realref(sum), n->rounding[k], MPFR_RNDN);
	}
	mpc_mul_2si(sum, sum, -53, MPC_RNDNN);
	mpc_add(n->z, n->z, sum, MPC_RNDNN);
	mpc_clear(sum);
}

/* The right sides at h tau after the start, where the series has terms up to `known` */
static void right_sides(int run, mpc_srcptr tau, int known)
{
	mpc_t y[STATES], time;
	mpc_init2(time, BITS);
	mpc_mul_2si(time, tau, (long)log2(h), MPC_RNDNN);
	mpfr_add_d(mpc_realref(time), mpc_realref(time), start_time, MPFR_RNDN);
	for (int i = 0; i < STATES; i++) {
		mpc_init2(y[i], BITS);
		mpc_set_ui(y[i], 0, MPC_RNDNN);
		for (int k = known; k >= 0; k--) {
			mpc_mul(y[i], y[i], tau, MPC_RNDNN);
			mpfr_add(mpc_realref(y[i]), mpc_realref(y[i]), series[run][k][i], MPFR_RNDN);
		}
	}
	for (int i = 0; i < nodes; i++) {
		if (!node[i].used)
			continue;
		evaluate(&node[i], time, y);
		if (run > 0 && node[i].kind >= ADD)
			round_once(&node[i], tau, known);
	}
	for (int i = 0; i < STATES; i++)
		mpc_clear(y[i]);
	mpc_clear(time);
}

static void circle_point(mpc_t tau, int p, int N)
{
	mpfr_t angle;
	mpfr_init2(angle, BITS);
	mpfr_const_pi(angle, MPFR_RNDN);
	mpfr_mul_si(angle, angle, 2 * p, MPFR_RNDN);
	mpfr_div_si(angle, angle, N, MPFR_RNDN);
	mpfr_sin_cos(mpc_imagref(tau), mpc_realref(tau), angle, MPFR_RNDN);
	mpfr_clear(angle);
}

/* sum += what point p of N adds to the k-th coefficient of a real series, which is z there: points lie in pairs.
 * turn: the point to the power -k */
static void add_point(mpfr_t sum, mpc_srcptr z, mpc_srcptr turn, int k, int p, int N)
{
	mpfr_t part;
	mpfr_init2(part, BITS);
	mpfr_fmms(part, mpc_realref(z), mpc_realref(turn), mpc_imagref(z), mpc_imagref(turn), MPFR_RNDN);
	mpfr_mul_2si(part, part, RADIUS * k + (p == 0 || p == N / 2 ? 0 : 1), MPFR_RNDN);
	mpfr_div_si(part, part, N, MPFR_RNDN);
	mpfr_add(sum, sum, part, MPFR_RNDN);
	mpfr_clear(part);
}

static int points_for(int k) { return k < 4 ? 8 : k + 4 + k % 2; }

/* slope[i]: the k-th coefficient of each right side */
static void coefficients_of_slopes(int run, int k)
{
	int N = points_for(k);
	mpc_t tau, point, turn;
	mpc_init2(tau, BITS);
	mpc_init2(point, BITS);
	mpc_init2(turn, BITS);
	for (int i = 0; i < COORDS; i++)
		mpfr_set_ui(slope[i], 0, MPFR_RNDN);
	for (int p = 0; p <= N / 2; p++) {
		circle_point(point, p, N);
		mpc_mul_2si(tau, point, -RADIUS, MPC_RNDNN);
		mpc_pow_si(turn, point, -k, MPC_RNDNN);
		right_sides(run, tau, k);
		for (int i = 0; i < COORDS; i++)
			add_point(slope[i], node[root[i]].z, turn, k, p, N);
	}
	mpc_clear(tau);
	mpc_clear(point);
	mpc_clear(turn);
}

/* Of each operation its coefficients up to k, or if that is more what the one before grows to, times random numbers */
static void draw_rounding(int k)
{
	int N = points_for(k);
	mpc_t tau, point, turn[MOST_ORDER];
	static mpfr_t sum[MOST_NODES][MOST_ORDER];
	mpc_init2(tau, BITS);
	mpc_init2(point, BITS);
	for (int j = 0; j <= k; j++) {
		mpc_init2(turn[j], BITS);
		for (int i = 0; i < nodes; i++) {
			mpfr_init2(sum[i][j], BITS);
			mpfr_set_ui(sum[i][j], 0, MPFR_RNDN);
		}
	}
	for (int p = 0; p <= N / 2; p++) {
		circle_point(point, p, N);
		mpc_mul_2si(tau, point, -RADIUS, MPC_RNDNN);
		for (int j = 0; j <= k; j++)
			mpc_pow_si(turn[j], point, -j, MPC_RNDNN);
		right_sides(0, tau, k);
		for (int i = 0; i < nodes; i++)
			for (int j = 0; j <= k && node[i].used && node[i].kind >= ADD; j++)
				add_point(sum[i][j], node[i].z, turn[j], j, p, N);
	}
	for (int i = 0; i < nodes; i++) {
		double size = 0;
		for (int j = 0; j <= k; j++) {
			size = fmax(size * growth, fabs(mpfr_get_d(sum[i][j], MPFR_RNDN)));
			node[i].rounding[j] = size * (below(2) ? 1 : -1) * (1 + below(1001) / 1000.0) / 2;
			mpfr_clear(sum[i][j]);
		}
	}
	for (int j = 0; j <= k; j++)
		mpc_clear(turn[j]);
	mpc_clear(tau);
	mpc_clear(point);
}

/* By the masses of a pair of coordinates: Cramer */
static void solve_masses(void)
{
	mpfr_t det, first, second, part;
	mpfr_inits2(BITS, det, first, second, part, NULL);
	for (int i = 0; i < COORDS; i += 2) {
		const double m[2][2] = { { mass[i][0], mass[i][1] }, { mass[i + 1][1], mass[i + 1][0] } };
		mpfr_set_d(det, m[0][0] * m[1][1] - m[0][1] * m[1][0], MPFR_RNDN);      /* exact: few bits */
		mpfr_mul_d(first, slope[i], m[1][1], MPFR_RNDN);
		mpfr_mul_d(part, slope[i + 1], m[0][1], MPFR_RNDN);
		mpfr_sub(first, first, part, MPFR_RNDN);
		mpfr_mul_d(second, slope[i + 1], m[0][0], MPFR_RNDN);
		mpfr_mul_d(part, slope[i], m[1][0], MPFR_RNDN);
		mpfr_sub(second, second, part, MPFR_RNDN);
		mpfr_div(slope[i], first, det, MPFR_RNDN);
		mpfr_div(slope[i + 1], second, det, MPFR_RNDN);
	}
	mpfr_clears(det, first, second, part, NULL);
}

static void expand(int run, int order)
{
	for (int i = 0; i < STATES; i++)
		mpfr_set_d(series[run][0][i], initial[i], MPFR_RNDN);
	for (int k = 0; k < order; k++) {
		coefficients_of_slopes(run, k);
		solve_masses();
		for (int i = 0; i < STATES; i++) {
			mpfr_ptr next = series[run][k + 1][i];
			mpfr_mul_d(next, i >= COORDS ? slope[i - COORDS] : i < SECOND ? series[run][k][COORDS + i]
					: slope[i], h,
				MPFR_RNDN);
			mpfr_div_si(next, next, k + 1, MPFR_RNDN);
		}
	}
}

static void print_truth(int order)
{
	printf("start %a\n", start_time);
	for (int i = 0; i < INPUTS && driven; i++)
		printf("%a %a\n", sample[i][0], sample[i][1]);
	for (int i = 0; i < STATES; i++)
		printf("%s %a\n", state_name(i), initial[i]);
	mpfr_t difference;
	mpfr_init2(difference, BITS);
	for (int k = 0; k <= order; k++)
		for (int i = 0; i < STATES; i++) {
			/* what aliases stays below */
			double unit = fmax(fabs(mpfr_get_d(series[0][k][i], MPFR_RNDN)), ldexp(pow(growth, k), -40));
			for (int run = 1; run < RUNS; run++) {
				mpfr_sub(difference, series[run][k][i], series[0][k][i], MPFR_RNDN);
				unit = fmax(unit, ldexp(fabs(mpfr_get_d(difference, MPFR_RNDN)), 53));
			}
			printf("%s %d %.17g %.3g\n", state_name(i), k, mpfr_get_d(series[0][k][i], MPFR_RNDN), unit);
		}
	mpfr_clear(difference);
}

void make_truth(int order)
{
	for (int run = 0; run < RUNS; run++)
		for (int k = 0; k <= order; k++)
			for (int i = 0; i < STATES; i++)
				mpfr_init2(series[run][k][i], BITS);
	for (int i = 0; i < COORDS; i++)
		mpfr_init2(slope[i], BITS);
	for (int i = 0; i < nodes; i++)
		mpc_init2(node[i].z, BITS);
	expand(0, order);
	for (int k = 1; k <= order; k++)
		for (int i = 0; i < STATES; i++) {
			double size = fabs(mpfr_get_d(series[0][k][i], MPFR_RNDN)) / fmax(1, fabs(initial[i]));
			growth = fmax(growth, pow(size, 1.0 / k));
		}
	for (int run = 1; run < RUNS; run++) {
		draw_rounding(order - 1);
		expand(run, order);
	}
	print_truth(order);
}
