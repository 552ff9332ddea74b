/* SPDX-License-Identifier: MIT-0 */
/* runtime/retune.c: increments against Taylor's series in MPFR. */
#include "runtime_retune.h"

/* BOUND: of an increment, in units in the last place of the largest entry.  FARTHEST: log2 of the largest |A| tau.
 * SMALLEST: below it underflow may take bits. */
enum { BITS = 400, LARGEST = 12, BOUND = 16 };
#ifdef REAL_IS_FLOAT
#define SMALLEST 0x1p-100
enum { FARTHEST = 12 };
#else
#define SMALLEST 0x1p-900
enum { FARTHEST = 20 };
#endif

typedef struct system {
	int size, states;
	pl_two A[LARGEST * LARGEST];
} system_of;

static pl_two *entry(system_of *s, int i, int j)
{
	return s->A + i * s->size + j;
}

static void clear(system_of *s, int states, int loads)
{
	int i;
	s->size = states + loads;
	s->states = states;
	for (i = 0; i < LARGEST * LARGEST; i++)
		s->A[i] = word_of(0.0);
}

static mpfr_t exact_A[LARGEST * LARGEST], exact_D[LARGEST * LARGEST], power[LARGEST * LARGEST], room[LARGEST * LARGEST],
	temporary;

/* room <- a b */
static void exact_product(int n, mpfr_t *a, mpfr_t *b)
{
	int i, j, k;
	for (i = 0; i < n; i++)
		for (j = 0; j < n; j++) {
			mpfr_set_zero(room[i * n + j], 1);
			for (k = 0; k < n; k++)
				if (!mpfr_zero_p(a[i * n + k]) && !mpfr_zero_p(b[k * n + j])) {
					mpfr_mul(temporary, a[i * n + k], b[k * n + j], MPFR_RNDN);
					mpfr_add(room[i * n + j], room[i * n + j], temporary, MPFR_RNDN);
				}
		}
}

/* exact_D <- e^{A tau} - I: the series on 2^-halvings of tau, term by term until they are small, then e^X itself
 * squared, all to BITS */
static void exact_increment(const system_of *s, real tau)
{
	const int n = s->size;
	double most = 0;
	int i, m, halvings = 0, small = 0;
	for (i = 0; i < n * n; i++) {
		set_two(exact_A[i], s->A[i]);
		mpfr_mul_d(exact_A[i], exact_A[i], tau, MPFR_RNDN);
		most = fmax(most, fabs(mpfr_get_d(exact_A[i], MPFR_RNDN)));
	}
	if (most > 0)
		halvings = ilogb(most * n) + 9;
	if (halvings < 0)
		halvings = 0;
	for (i = 0; i < n * n; i++) {
		mpfr_div_2si(exact_A[i], exact_A[i], halvings, MPFR_RNDN);
		mpfr_set(exact_D[i], exact_A[i], MPFR_RNDN);
		mpfr_set(power[i], exact_A[i], MPFR_RNDN);
	}
	for (m = 2; !small; m++) {
		exact_product(n, power, exact_A);
		small = m > n; /* what is reached in n steps has been */
		for (i = 0; i < n * n; i++) {
			mpfr_div_ui(power[i], room[i], (unsigned long)m, MPFR_RNDN);
			mpfr_add(exact_D[i], exact_D[i], power[i], MPFR_RNDN);
			if (!mpfr_zero_p(power[i]) && mpfr_get_exp(power[i]) > mpfr_get_exp(exact_D[i]) - BITS / 2 - 60)
				small = 0;
		}
	}
	for (i = 0; i < n; i++)
		mpfr_add_ui(exact_D[i * n + i], exact_D[i * n + i], 1, MPFR_RNDN);
	for (; halvings > 0; halvings--) {
		exact_product(n, exact_D, exact_D);
		for (i = 0; i < n * n; i++)
			mpfr_swap(exact_D[i], room[i]);
	}
	for (i = 0; i < n; i++)
		mpfr_sub_ui(exact_D[i * n + i], exact_D[i * n + i], 1, MPFR_RNDN);
}

static double worst; /* error of the family in units in the last place */

/* Columns from .. to - 1 of D against exact_D, in units in the last place of the largest of them. */
static void assert_columns(const system_of *s, real tau, const real *D, int from, int to, const char *family)
{
	double unit = 0;
	int i, j;
	for (i = 0; i < s->states; i++)
		for (j = from; j < to; j++)
			unit = fmax(unit, fabs(mpfr_get_d(exact_D[i * s->size + j], MPFR_RNDN)));
	unit = unit > 0 ? ldexp(REAL_EPSILON, unit > SMALLEST ? ilogb(unit) : ilogb(SMALLEST)) : 0;
	for (i = 0; i < s->states; i++)
		for (j = from; j < to; j++) {
			double off;
			mpfr_sub_d(temporary, exact_D[i * s->size + j], D[i * s->size + j], MPFR_RNDN);
			off = fabs(mpfr_get_d(temporary, MPFR_RNDN));
			if (unit > 0)
				worst = worse(worst, off / unit);
			if (!(off <= BOUND * unit)) {
				int row, column;
				for (row = 0; row < s->size; row++)
					for (column = 0; column < s->size; column++)
						if (s->A[row * s->size + column].hi != 0)
							print_message("# A[%d][%d] = %.17g + %.17g\n", row, column,
								s->A[row * s->size + column].hi,
										  s->A[row * s->size + column].lo);
				fail_msg(
			       "%s, %d states, size %d, tau = %.17g, D[%d][%d]: found %.17g, expected %.17g; off by %g "
					"units, bound %d",
					family, s->states, s->size, (double)tau, i, j, (double)D[i * s->size + j],
					mpfr_get_d(exact_D[i * s->size + j], MPFR_RNDN),
						unit > 0 ? off / unit : (double)INFINITY, BOUND);
			}
		}
}

static void assert_increment(const system_of *s, real tau, const char *family)
{
	pl_two in_two_words[LARGEST * LARGEST];
	real D[LARGEST * LARGEST];
	pl_two work[PL_INCREMENT_WORK(LARGEST)];
	const int status = pl_increment(s->size, s->states, s->A, tau, 1, in_two_words, work);
	int j, fits = 1;
	exact_increment(s, tau);
	for (j = 0; j < s->size * s->size; j++)
		fits &= mpfr_zero_p(exact_D[j]) || mpfr_get_exp(exact_D[j]) < REAL_EXPONENTS - 10;
	if (!fits && status == PL_NOT_FINITE)
		return;
	if (status != 0)
		fail_msg("%s, tau = %.17g: found status %d, expected 0", family, (double)tau, status);
	for (j = 0; j < s->states * s->size; j++)
		D[j] = in_two_words[j].hi;
	assert_columns(s, tau, D, 0, s->states, family);
	for (j = s->states; j < s->size; j++)
		assert_columns(s, tau, D, j, j + 1, family);
}

static void report(const char *family)
{
	print_message("# %s: off by %.2f units at most, bound %d\n", family, worst, BOUND);
	worst = 0;
}

/* One mass: x'' = -k/m x - c/m x'.  How fast it goes. */
static double one_mass(system_of *s, double m, double c, double k)
{
    *entry(s, 0, 1) = word_of(1.0);
    *entry(s, 1, 0) = about(-k / m);
    *entry(s, 1, 1) = about(-c / m);
	return fmax(sqrt(k / m), c / m);
}

/* Two masses: k1, c1 to the ground, k2, c2 between them */
static double two_masses(system_of *s, const double *m, const double *c, const double *k)
{
	double most = 0;
	int i;
	for (i = 0; i < 2; i++) {
		const double ks = k[1] + (i == 0 ? k[0] : 0), cs = c[1] + (i == 0 ? c[0] : 0);
        *entry(s, i, 2 + i) = word_of(1.0);
        *entry(s, 2 + i, i) = about(-ks / m[i]);
        *entry(s, 2 + i, 1 - i) = about(k[1] / m[i]);
        *entry(s, 2 + i, 2 + i) = about(-cs / m[i]);
        *entry(s, 2 + i, 3 - i) = about(c[1] / m[i]);
		most = fmax(most, fmax(sqrt(ks / m[i]), cs / m[i]));
	}
	return most;
}

/* A tau for |A| tau between 2^from and 2^to */
static real tau_of(double fastest, double from, double to)
{
	return (real)(exp2(between(from, to)) / fastest);
}

static double random_masses(system_of *s, int masses, double least_damping, double most_damping)
{
	double m[2], c[2], k[2];
	int i;
	for (i = 0; i < 2; i++) {
		m[i] = scattered(1e-3, 1e3);
		k[i] = scattered(1.0, 1e9);
		c[i] = most_damping == 0 ? 0 : 2 * sqrt(k[i] * m[i]) * scattered(least_damping, most_damping);
	}
	return masses == 1 ? one_mass(s, m[0], c[0], k[0]) : two_masses(s, m, c, k);
}

static void masses_without_loads(int count, double least_damping, double most_damping, double from, double to,
								 const char *family)
{
	int i;
	for (i = 0; i < samples(count); i++) {
		const int masses = 1 + (i % 4 != 0);
		system_of s;
		double fastest;
		clear(&s, 2 * masses, 0);
		fastest = random_masses(&s, masses, least_damping, most_damping);
		assert_increment(&s, tau_of(fastest, from, to), family);
	}
	report(family);
}

static void damped(void **state)
{
	(void)state;
	drawn = 1;
	masses_without_loads(600, 1e-4, 3.0, -20.0, -2.0, "damped, short");
	masses_without_loads(1000, 1e-4, 3.0, -2.0, 3.0, "damped, |A| tau about 1");
	masses_without_loads(500, 1e-4, 3.0, 3.0, FARTHEST, "damped, long");
}

static void undamped(void **state)
{
	(void)state;
	drawn = 2;
	masses_without_loads(300, 0, 0, -20.0, -2.0, "undamped, short");
	masses_without_loads(1000, 0, 0, -2.0, 3.0, "undamped, |A| tau about 1");
	masses_without_loads(500, 0, 0, 3.0, FARTHEST, "undamped, long");
}

/* c = 2 sqrt(k m) (1 + 10^-e): a double pole, and those close to one */
static void near_confluence(void **state)
{
	int i;
	(void)state;
	drawn = 3;
	for (i = 0; i < 400; i++) {
		const double m = scattered(1e-3, 1e3), w = i % 2 ? ldexp(1.0, below(20)) : scattered(1.0, 1e6),
					 gap = scattered(1e-16, 1e-10);
		const double exact = i % 4 == 3;
		double fastest;
		system_of s;
		clear(&s, 2, 0);
		fastest = one_mass(&s, m, 2 * m * w * (1 + (i % 8 < 4 ? gap : -gap)), m * w * w);
		if (exact) {
            *entry(&s, 1, 0) = word_of(-w * w);
            *entry(&s, 1, 1) = word_of(-2 * w);
		}
		assert_increment(&s, tau_of(fastest, i % 3 == 0 ? -10.0 : -2.0, i % 3 == 0 ? FARTHEST : 5.0),
						 "near confluence");
	}
	report("near confluence");
	for (i = 0; i < 200; i++) { /* two equal oscillators, nearly or not at all coupled, one way or both */
		const double w = scattered(1.0, 1e6), coupling = w * w * scattered(1e-16, 1e-2);
		system_of s;
		clear(&s, 4, 0);
        *entry(&s, 0, 2) = *entry(&s, 1, 3) = word_of(1.0);
        *entry(&s, 2, 0) = *entry(&s, 3, 1) = about(-w * w);
        *entry(&s, 2, 1) = about(coupling);
		if (i % 2)
            *entry(&s, 3, 0) = about(coupling * between(-1.0, 1.0));
		assert_increment(&s, tau_of(w, i % 3 == 0 ? -10.0 : -2.0, i % 3 == 0 ? FARTHEST : 5.0),
			"equal oscillators");
	}
	report("equal oscillators");
}

/* Poles near -10^6 and -10^-3, in one mass and in two that are coupled */
static void stiff(void **state)
{
	int i;
	(void)state;
	drawn = 4;
	for (i = 0; i < 300; i++) {
		const double fast = scattered(1e5, 1e7), slow = scattered(1e-4, 1e-2), unit = scattered(1e-6, 1e6);
		double m[2], c[2], k[2], fastest;
		system_of s;
		if (i % 3 == 0) { /* x' = -slow x + ..., y' = -fast y + ... */
			clear(&s, 2, 0);
            *entry(&s, 0, 0) = about(-slow);
            *entry(&s, 0, 1) = about(unit * between(-1.0, 1.0));
            *entry(&s, 1, 0) = about(slow / unit * between(-1.0, 1.0));
            *entry(&s, 1, 1) = about(-fast);
			fastest = fast;
		} else if (i % 3 == 1) {
			clear(&s, 2, 0);
			fastest = one_mass(&s, 1.0, fast + slow, fast * slow);
		} else {
			m[0] = 1;
			m[1] = scattered(1e-3, 1e3);
			c[0] = fast;
			c[1] = m[1] * slow;
			k[0] = fast * slow;
			k[1] = scattered(1e-3, 1e3);
			clear(&s, 4, 0);
			fastest = two_masses(&s, m, c, k);
		}
		assert_increment(&s, tau_of(fastest, -10.0, FARTHEST), "stiff");
	}
	report("stiff");
}

static void rigid_body(void **state)
{
	int i, j;
	(void)state;
	drawn = 5;
	for (i = 0; i < 200; i++) {
		const double m[2] = {scattered(1e-3, 1e3), scattered(1e-3, 1e3)};
		double c[2] = {0, i % 2 ? scattered(1e-3, 1e3) : 0}, k[2] = {0, scattered(1.0, 1e6)}, fastest;
		system_of s;
		clear(&s, 4, 0);
		fastest = two_masses(&s, m, c, k);
		assert_increment(&s, tau_of(fastest, -10.0, FARTHEST), "two free masses");
	}
	report("two free masses");
	for (i = 0; i < 200; i++) { /* integrators behind one another: x_j' = a x_{j + 1}, in any order; nilpotent */
		const int n = 2 + below(7);
		int order[LARGEST];
		system_of s;
		clear(&s, n, 0);
		for (j = 0; j < n; j++)
			order[j] = j;
		for (j = n - 1; j > 0; j--) {
			const int other = below(j + 1), swapped = order[j];
			order[j] = order[other];
			order[other] = swapped;
		}
		for (j = 0; j < n - 1; j++)
            *entry(&s, order[j], order[j + 1]) = i % 2 ? word_of(1.0) : about(scattered(0.1, 10.0));
		assert_increment(&s, (real)scattered(1e-3, 1e3), "nilpotent");
	}
	report("nilpotent");
	for (i = 0; i < 200; i++) { /* an oscillator that drives integrators */
		const int n = 2 + 1 + below(5);
		double fastest;
		system_of s;
		clear(&s, n, 0);
		fastest = one_mass(&s, 1.0, i % 2 ? between(0.0, 3.0) : 0.0, 1.0);
		for (j = 2; j < n; j++)
            *entry(&s, j, j - 1) = about(scattered(1.0, 1e3));
		assert_increment(&s, tau_of(fastest, -3.0, 5.0), "driven integrators");
	}
	report("driven integrators");
}

enum { CONSTANT, HARMONIC, MONOMIAL, EXPONENTIAL, RAMP, SEVERAL, LOADS };

/* Columns from `at` on carry a load that acts on the accelerations; how many they are, and how fast in *fastest. */
static int put_load(system_of *s, int load, int at, double own, double *fastest)
{
	const int masses = s->states / 2;
	double rate;
	int i, j, used = 1;
	switch (load) {
	case HARMONIC:
		rate = own * scattered(1e-3, 4.0);
        *entry(s, at, at + 1) = about(-rate);
        *entry(s, at + 1, at) = *entry(s, at, at + 1);
		entry(s, at + 1, at)->hi *= -1;
		entry(s, at + 1, at)->lo *= -1;
        *fastest = fmax(*fastest, rate);
		used = 2;
		break;
	case MONOMIAL: /* t^d, ..., t, 1: (t^j)' = j t^{j - 1} */
		used = 2 + below(5);
		for (j = 0; j < used - 1; j++)
            *entry(s, at + j, at + j + 1) = word_of(used - 1 - j);
		break;
	case EXPONENTIAL:
		rate = own * scattered(1e-3, 1.0);
        *entry(s, at, at) = about(below(4) ? -rate : rate * 1e-2);
        *fastest = fmax(*fastest, rate);
		break;
	case RAMP: /* u and u', by a spring and maybe a damper */
        *entry(s, at, at + 1) = word_of(1.0);
		used = 2;
		break;
	default:
		break;
	}
	for (i = 0; i < masses; i++)
		if (i == 0 || below(2)) {
            *entry(s, masses + i, at) = about(either(scattered(1e-3, 1e6)));
			if ((load == HARMONIC || load == RAMP) && below(2))
                *entry(s, masses + i, at + 1) = about(either(scattered(1e-3, 1e6)));
		}
	return used;
}

static void loads(void **state)
{
	static const char *const names[LOADS] = {"constant loads",    "harmonic loads", "powers of t",
											 "exponential loads", "ramps",
												"several loads"};
	int i, load;
	(void)state;
	drawn = 6;
	for (load = 0; load < LOADS; load++) {
		for (i = 0; i < samples(300); i++) {
			const int masses = 1 + below(2);
			const double from = i % 3 == 0 ? -20.0 : -2.0,
				to = i % 3 == 0 ? -2.0 : i % 3 == 1 ? 3.0 : FARTHEST;
			int used;
			double fastest, own;
			system_of s;
			clear(&s, 2 * masses, LARGEST - 2 * masses); /* the width comes first */
			s.size = 2 * masses + (load == CONSTANT || load == EXPONENTIAL ? 1
								   : load == MONOMIAL                      ? 6
								   : load == SEVERAL                       ? 6
														   : 2);
			own = fastest = random_masses(&s, masses, 1e-4, i % 4 == 0 ? 0 : 3.0);
			if (load == SEVERAL) {
				used = put_load(&s, HARMONIC, s.states, own, &fastest);
				used += put_load(&s, CONSTANT, s.states + used, own, &fastest);
				used += put_load(&s, EXPONENTIAL, s.states + used, own, &fastest);
				put_load(&s, RAMP, s.states + used, own, &fastest);
			} else
				put_load(&s, load, s.states, own, &fastest);
			assert_increment(&s, tau_of(fastest, from, to), names[load]);
		}
		report(names[load]);
	}
}

/* Masses on the ground by nothing, pushed by a power of t: columns far from the states */
static void far_columns(void **state)
{
	int i, j;
	(void)state;
	drawn = 7;
	for (i = 0; i < 300; i++) {
		const int length = 1 + below(9);
		double damping;
		system_of s;
		clear(&s, 2, length);
		damping = i % 3 ? between(0.0, 2.0) : 0;
		one_mass(&s, 1.0, damping, i % 3 == 1 ? between(0.0, 1.0) : 0);
        *entry(&s, 1, 2) = about(scattered(1e-3, 1e3));
		for (j = 0; j < length - 1; j++)
            *entry(&s, 2 + j, 3 + j) = word_of(length - 1 - j);
		assert_increment(&s, (real)scattered(1e-3, 4.0), "far columns");
	}
	report("far columns");
}

/* Two ways to a load's column that all but cancel at tau: what acts at once, and what comes by way of the other column
 */
static void cancelling_loads(void **state)
{
	int i, j;
	(void)state;
	drawn = 10;
	for (i = 0; i < 300; i++) {
		const int masses = below(3),
				/* masses 0: x' = -a x; all: to the next order of tau, else a tenth is left */
				  all = i % 3 == 0;
		double fastest, rate, force;
		real tau;
		system_of s;
		clear(&s, masses > 0 ? 2 * masses : 1, 2);
		if (masses > 0)
			fastest = random_masses(&s, masses, 1e-4, i % 2 ? 1.0 : 0.0);
		else {
			fastest = scattered(1.0, 1e6);
            *entry(&s, 0, 0) = about(-fastest);
		}
		rate = fastest * scattered(1e-3, 1.0);
		tau = tau_of(fastest, all ? -10.0 : -30.0, 1.0);
		force = scattered(1e-3, 1e3);
        *entry(&s, s.states, s.states + 1) = word_of(rate);
        *entry(&s, s.states + 1, s.states) = word_of(-rate);
		for (j = masses; j < s.states; j++) {
            *entry(&s, j, s.states) = about(force);
            *entry(&s, j, s.states + 1) = about(-force * rate * (double)tau / 2 * (all ? 1 : between(0.8, 0.9)));
		}
		assert_increment(&s, tau, "cancelling loads");
	}
	report("cancelling loads");
}

/* Matrices of no meaning, in units of no meaning */
static void random_matrices(void **state)
{
	int i, j, k;
	(void)state;
	drawn = 11;
	for (i = 0; i < 1000; i++) {
		const int states = 1 + below(4), others = below(3), n = states + others, dense = below(2);
		double unit[LARGEST];
		system_of s;
		clear(&s, states, others);
		for (j = 0; j < n; j++)
			unit[j] = scattered(1e-4, 1e4);
		for (j = 0; j < n; j++)
			for (k = j < states ? 0 : states; k < n; k++)
				if (dense || below(2))
                    *entry(&s, j, k) = about(either(scattered(1e-2, 1.0)) * unit[j] / unit[k]);
		assert_increment(&s, tau_of(1.0, -10.0, 5.0), "random matrices");
	}
	report("random matrices");
}

static void ends_of_the_range(void **state)
{
	static const real special[] = {(real)INFINITY, (real)-INFINITY, (real)NAN};
	pl_two work[PL_INCREMENT_WORK(4)];
	pl_two D[16];
	system_of s;
	int i, j;
	(void)state;
	clear(&s, 2, 2);
	one_mass(&s, 1.0, 0.1, 4.0);
    *entry(&s, 1, 2) = *entry(&s, 2, 3) = word_of(1.0);
	assert_status(pl_increment(4, 2, s.A, 0, 1, D, work), 0, "tau = 0");
	for (i = 0; i < 8; i++)
		if (D[i].hi != 0)
			fail_msg("tau = 0, entry %d: found %.17g, expected 0", i, (double)D[i].hi);
	for (i = 0; i < 3; i++) {
		assert_status(pl_increment(4, 2, s.A, special[i], 1, D, work), PL_NOT_FINITE, "tau not finite");
		for (j = 0; j < 4; j++) {
			const pl_two kept = *entry(&s, 1, j);
            *entry(&s, 1, j) = word_of(special[i]);
			assert_status(pl_increment(4, 2, s.A, (real)0x1p-10, 1, D, work), PL_NOT_FINITE,
				"A not finite");
			assert_status(pl_increment(4, 2, s.A, (real)0.5, 1, D, work), PL_NOT_FINITE, "A not finite");
			assert_status(pl_increment(4, 2, s.A, (real)100, 1, D, work), PL_NOT_FINITE, "A not finite");
            *entry(&s, 1, j) = kept;
		}
        *entry(&s, 2, 3) = word_of(special[i]);
		assert_status(pl_increment(4, 2, s.A, (real)0.5, 1, D, work), PL_NOT_FINITE, "a load not finite");
        *entry(&s, 2, 3) = word_of(1.0);
	}
	assert_status(pl_increment(4, 2, s.A, (real)1e20, 1, D, work), PL_NOT_FINITE, "a norm beyond what is taken");
	assert_status(pl_increment(4, 2, s.A, REAL_LARGE, 1, D, work), PL_NOT_FINITE, "a norm beyond what is taken");
    *entry(&s, 1, 1) = word_of(1.0);
	assert_status(pl_increment(4, 2, s.A, 20, 1, D, work), 0, "a growing state, a short time");
	assert_status(pl_increment(4, 2, s.A, 1e5, 1, D, work), PL_NOT_FINITE, "a growing state, a long time");
    *entry(&s, 1, 1) = word_of(0.0);
    *entry(&s, 2, 2) = word_of(1.0);
	assert_status(pl_increment(4, 2, s.A, 1e5, 1, D, work), PL_NOT_FINITE, "a growing load");
	clear(&s, 1, 0);
    *entry(&s, 0, 0) = word_of(-1e6);
	assert_status(pl_increment(1, 1, s.A, 1e3, 1, D, work), 0, "a state that decays at once");
	if (D[0].hi != -1)
		fail_msg("a state that decays at once: found %.17g, expected -1", (double)D[0].hi);
}

static void start(void)
{
	int i;
	for (i = 0; i < LARGEST * LARGEST; i++)
		mpfr_inits2(BITS, exact_A[i], exact_D[i], power[i], room[i], (mpfr_ptr)0);
	mpfr_init2(temporary, BITS);
}

static void end(void)
{
	int i;
	for (i = 0; i < LARGEST * LARGEST; i++)
		mpfr_clears(exact_A[i], exact_D[i], power[i], room[i], (mpfr_ptr)0);
	mpfr_clear(temporary);
}

ROOM_WITH(increments, start, end,
	cmocka_unit_test(damped),
	cmocka_unit_test(undamped),
	cmocka_unit_test(near_confluence),
	cmocka_unit_test(stiff),
	cmocka_unit_test(rigid_body),
	cmocka_unit_test(loads),
	cmocka_unit_test(far_columns),
	cmocka_unit_test(cancelling_loads),
	cmocka_unit_test(random_matrices),
	cmocka_unit_test(ends_of_the_range))
