/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives through impacts and friction against differences of whole runs in quadruple precision, which know no
 * saltation: a chain of masses with a stop, dry friction, a clearance and a load, by Taylor series from event to event.
 *
 *     events_judge spec SEED             a random spec; odd seeds are not piecewise linear
 *     events_judge graze SEED            one whose stop is just reached
 *     events_judge judge SEED <NUMBERS   what its C computes
 *
 * NUMBERS are what derivatives.c prints after 150 steps. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { END = 150 };                     /* steps of 1/50 */

typedef __float128 real;

/* ---- a random model ---- */

enum { MOST = 3, ORDER = 20, EVENTS = 100 };
enum { K, C, F, W, M, E, G, R, D, X, B, PARAMS }; /* stiffness, damping, load, mass, stop, friction, clearance; cubic */
static const char letter[] = "kcFwmegRdxb";

struct system {
	int n, stop, rubs, clears;      /* masses; which mass meets a stop, rubs, has a clearance */
	int beside, pairs;              /* the stop is against the next mass; so the friction */
	real p[PARAMS];
};

static unsigned long state;

static int drawn(int from, int to)
{
	state = state * 6364136223846793005ul + 1442695040888963407ul;
	return from + (int)((state >> 33) % (unsigned long)(to - from + 1));
}

static struct system system_of(unsigned long seed)
{
	static const int low[PARAMS] = { 4000, 50, 1000, 1000, 500, 400, 50, 50, 20, -300, 500 };
	static const int high[PARAMS] = { 20000, 300, 4000, 3000, 2000, 900, 250, 500, 200, 0, 9000 };
	struct system s = { 0 };
	state = seed * 7919 + 1;
	for (int i = 0; i < 9; i++)
		drawn(0, 1);
	s.n = drawn(1 + (seed % 2 == 0), MOST);
	s.stop = drawn(0, s.n - 1);
	s.beside = s.stop + 1 < s.n && drawn(0, 1);
	s.rubs = drawn(0, s.n - 1);
	s.pairs = s.rubs + 1 < s.n && drawn(0, 1);
	s.clears = drawn(0, s.n - 1);
	if (s.rubs == s.stop && s.pairs == s.beside && seed % 2 == 0) { /* no region could hold both */
		s.rubs = (s.rubs + 1) % s.n;
		s.pairs = 0;
	}
	for (int i = 0; i < PARAMS; i++)
		s.p[i] = (real)drawn(low[i], high[i]) / 1000;
	if (seed % 2 == 0)
		s.p[B] = 0;
	return s;
}

static void print_number(real value)
{
	char digit[40];
	int k = 0;
	printf(value < 0 ? "-" : "");
	value = value < 0 ? -value : value;
	printf("%ld.", (long)value);
	for (value -= (real)(long)value; k < 32; k++) {
		value *= 10;
		digit[k] = (char)('0' + (int)value);
		value -= (real)(int)value;
	}
	while (k > 1 && digit[k - 1] == '0')
		k--;
	printf("%.*s", k, digit);
}

static void print_force(const char *text, int i, int from, int pair)
{
	if (i == from || (pair && i == from + 1)) {
		printf(i == from ? " + " : " - ");
		printf(text, from, from + 1);
	}
}

static void print_spec(const struct system *s, unsigned long seed)
{
	printf("model r\nparam ");
	for (int i = 0; i < PARAMS; i++) {
		printf("%s%c = ", i ? ", " : "", letter[i]);
		print_number(s->p[i]);
	}
	printf("\ncoord x0");
	for (int i = 1; i < s->n; i++)
		printf(", x%d", i);
	printf("\ninit x0 = x\nsensitivity k, c, F, w, m, e, g, R, d, x%s\n", s->p[B] > 0 ? ", b" : "");
	for (int i = 0; i < s->n; i++) {
		printf("m*%d*x%d'' + c*x%d' + k*x%d", i + 1, i, i, i);
		if (s->p[B] > 0)
			printf(" + b*x%d^3", i);
		if (i > 0)
			printf(" + 3*k*(x%d - x%d)", i, i - 1);
		if (i + 1 < s->n)
			printf(" + 3*k*(x%d - x%d)", i, i + 1);
		if (i == s->clears)
			printf(" + 20*deadzone(x%d, -d, d)", i);
		print_force(s->pairs ? "friction(x%d' - x%d', R)" : "friction(x%d', R)", i, s->rubs, s->pairs);
		printf(" = %s\n", i == 0 ? "F*cos(w*t)" : "0");
	}
	printf("stop between x%d, ", s->stop);
	printf(s->beside ? "x%d" : "ground", s->stop + 1);
	printf(" at g restitution e\nstep 0.02\n");
	if (s->p[B] > 0)
		printf("scheme %s\ntolerance 1e-13\n", seed % 8 == 7 ? "radau" : "taylor");
	printf("output x0, x0'");
	for (int i = 1; i < s->n; i++)
		printf(", x%d, x%d'", i, i);
	printf("\n");
}

/* ---- a run ---- */

struct motion {
	const struct system *s;
	real t, x[MOST][ORDER + 2], v[MOST][ORDER + 2]; /* series from t; [0]: the state */
	real square[MOST][ORDER + 2];           /* of x */
	real load[ORDER + 2], needs[ORDER + 2]; /* the load; the friction that holds */
	int slides, zone;               /* 1, -1, or 0: it sticks; of the clearance */
	char trace[EVENTS];             /* what happened */
	int events, last;               /* last: the event that it begins behind; GUARDS: none */
};

static real mass(const struct motion *m, int i)
{
	return m->s->p[M] * (i + 1);
}

static void expand_load(struct motion *m)
{
	const real w = m->s->p[W], x = w * m->t;
	real term = 1, c = 0, s = 0;
	for (int k = 0; k < 90; k++) {          /* cos and sin of up to some ten */
		real *to = k % 2 ? &s : &c;
		*to += k % 4 < 2 ? term : -term;
		term *= x / (k + 1);
	}
	term = m->s->p[F];
	for (int k = 0; k <= ORDER; k++) {
		const real part = k % 4 == 0 ? c : k % 4 == 1 ? -s : k % 4 == 2 ? -c : s;
		m->load[k] = term * part;
		term *= w / (k + 1);
	}
}

/* The k-th coefficient of the force on a mass without friction */
static real force(struct motion *m, int i, int k)
{
	const struct system *s = m->s;
	const real *x = m->x[i];
	real sum = -s->p[K] * x[k] - s->p[C] * m->v[i][k] + (i == 0 ? m->load[k] : 0);
	m->square[i][k] = 0;
	for (int a = 0; a <= k && s->p[B] > 0; a++)
		m->square[i][k] += x[a] * x[k - a];
	for (int a = 0; a <= k && s->p[B] > 0; a++)
		sum -= s->p[B] * m->square[i][a] * x[k - a];
	if (i > 0)
		sum -= 3 * s->p[K] * (x[k] - m->x[i - 1][k]);
	if (i + 1 < s->n)
		sum -= 3 * s->p[K] * (x[k] - m->x[i + 1][k]);
	if (i == s->clears && m->zone)
		sum -= 20 * (x[k] - (k == 0 ? m->zone * s->p[D] : 0));
	return sum;
}

static void expand(struct motion *m)
{
	const struct system *s = m->s;
	const int a = s->rubs, b = s->rubs + 1;
	expand_load(m);
	for (int k = 0; k <= ORDER; k++) {
		real f[MOST];
		for (int i = 0; i < s->n; i++)
			f[i] = force(m, i, k);
		const real per = 1 / mass(m, a) + (s->pairs ? 1 / mass(m, b) : 0);
		m->needs[k] = (f[a] / mass(m, a) - (s->pairs ? f[b] / mass(m, b) : 0)) / per;
		const real friction = m->slides == 0 ? m->needs[k] : k == 0 ? m->slides * s->p[R] : 0;
		f[a] -= friction;
		if (s->pairs)
			f[b] += friction;
		for (int i = 0; i < s->n; i++) {
			m->x[i][k + 1] = m->v[i][k] / (k + 1);
			m->v[i][k + 1] = f[i] / mass(m, i) / (k + 1);
		}
	}
}

static real at(const real *c, real h)
{
	real sum = 0;
	for (int k = ORDER; k >= 0; k--)
		sum = sum * h + c[k];
	return sum;
}

/* What may happen: it rises through 0 there */
enum { HITS, SLIPS, LETS_UP, LETS_DOWN, ENTERS_UP, ENTERS_DOWN, GUARDS };

static real guard(const struct motion *m, int which, real h)
{
	const struct system *s = m->s;
	const int i = s->stop, r = s->rubs;
	switch (which) {
	case HITS:
		return at(m->x[i], h) - (s->beside ? at(m->x[i + 1], h) : 0) - s->p[G];
	case SLIPS:
		return m->slides == 0 ? -1 : -m->slides * (at(m->v[r], h) - (s->pairs ? at(m->v[r + 1], h) : 0));
	case LETS_UP:
	case LETS_DOWN:
		return m->slides ? -1 : (which == LETS_UP ? 1 : -1) * at(m->needs, h) - s->p[R];
	default: {
		const real x = at(m->x[s->clears], h), way = which == ENTERS_UP ? 1 : -1;
		return m->zone == 0 ? way * x - s->p[D] : m->zone == way ? s->p[D] - way * x : -1;
	}
	}
}

static real size_of(real value)
{
	return value < 0 ? -value : value;
}

/* By how much a series moves at most until h */
static real swing(const real *c, real h)
{
	real sum = 0;
	for (int k = ORDER; k > 0; k--)
		sum = (sum + size_of(c[k])) * h;
	return sum;
}

static int may_rise(const struct motion *m, int which, real h)
{
	const struct system *s = m->s;
	const real by = which == HITS ? swing(m->x[s->stop], h) + (s->beside ? swing(m->x[s->stop + 1], h) : 0)
		: which == SLIPS ? swing(m->v[s->rubs], h) + (s->pairs ? swing(m->v[s->rubs + 1], h) : 0)
		: which == LETS_UP || which == LETS_DOWN ? swing(m->needs, h) : swing(m->x[s->clears], h);
	return guard(m, which, 0) + by > -1e-25Q;
}

static real root(const struct motion *m, int which, real low, real high)
{
	for (int i = 0; i < 130; i++) {
		const real middle = (low + high) / 2;
		*(guard(m, which, middle) > 0 ? &high : &low) = middle;
	}
	return high;
}

/* The first event within h, which becomes less; GUARDS: none */
static int first_event(const struct motion *m, real *h)
{
	enum { LOOKS = 16 };
	int first = GUARDS;
	for (int which = 0; which < GUARDS; which++) {
		const real end = *h;
		real before = 0;
		for (int k = 1; k <= LOOKS && (k > 1 || may_rise(m, which, end)); k++) {
			const real now = end * k / LOOKS;
			const int known = before == 0 && which == m->last;
			if (guard(m, which, now) > 0 && !(known && guard(m, which, now / 1024) > 0)) {
				const real low = known ? now / 1024 : before;
				*h = root(m, which, low, now);
				first = which;
				break;
			}
			before = now;
		}
	}
	return first;
}

static void note(struct motion *m, int what)
{
	if (m->events < EVENTS - 1)
		m->trace[m->events++] = (char)('a' + what);
}

static void strike(struct motion *m)
{
	const struct system *s = m->s;
	const int i = s->stop;
	const real speed = m->v[i][0] - (s->beside ? m->v[i + 1][0] : 0);
	const real impulse = (1 + s->p[E]) * speed / (1 / mass(m, i) + (s->beside ? 1 / mass(m, i + 1) : 0));
	m->v[i][0] -= impulse / mass(m, i);
	if (s->beside)
		m->v[i + 1][0] += impulse / mass(m, i + 1);
}

/* Sticks or slips where its velocity is 0 or becomes so by an impact */
static void choose_sliding(struct motion *m)
{
	const struct system *s = m->s;
	expand(m);
	m->slides = m->needs[0] > s->p[R] ? 1 : m->needs[0] < -s->p[R] ? -1 : 0;
}

static void happen(struct motion *m, int what)
{
	const struct system *s = m->s;
	const int r = s->rubs;
	note(m, what);
	if (what == HITS) {
		strike(m);
		const real v = m->v[r][0] - (s->pairs ? m->v[r + 1][0] : 0);
		if (m->slides == 0 ? v * v > 1e-50Q : m->slides * v < 0)
			m->slides = v > 0 ? 1 : -1;
	} else if (what == SLIPS) {
		if (s->pairs) {
			const real a = mass(m, r), b = mass(m, r + 1);
			m->v[r][0] = m->v[r + 1][0] = (a * m->v[r][0] + b * m->v[r + 1][0]) / (a + b);
		} else {
			m->v[r][0] = 0;
		}
		choose_sliding(m);
	} else if (what == LETS_UP || what == LETS_DOWN) {
		m->slides = what == LETS_UP ? 1 : -1;
	} else {
		m->zone = m->zone ? 0 : what == ENTERS_UP ? 1 : -1;
	}
}

static void go_on(struct motion *m, real h)
{
	for (int i = 0; i < m->s->n; i++) {
		const real x = at(m->x[i], h), v = at(m->v[i], h);
		m->x[i][0] = x;
		m->v[i][0] = v;
	}
	m->t += h;
}

static struct motion begun(const struct system *s)
{
	struct motion m = { .s = s, .last = GUARDS };
	m.x[0][0] = s->p[X];
	m.zone = s->clears != 0 ? 0 : m.x[0][0] > s->p[D] ? 1 : m.x[0][0] < -s->p[D] ? -1 : 0;
	choose_sliding(&m);
	return m;
}

/* Until `end`, or as many events as there is room for */
static void follow(struct motion *m, real end)
{
	while (m->t < end && m->events < EVENTS - 1) {
		real h = (real)1 / 50;
		h = m->t + h < end ? h : end - m->t;
		expand(m);
		const real whole = h;
		const int what = first_event(m, &h);
		go_on(m, h);
		if (what == GUARDS && h >= whole * 0.999Q && m->t > end - 1e-25Q)
			m->t = end;
		m->last = what;
		if (what != GUARDS)
			happen(m, what);
	}
}

static struct motion run(const struct system *s, real end)
{
	struct motion m = begun(s);
	follow(&m, end);
	return m;
}

/* ---- judging ---- */

/* Differences of runs whose p-th param is so much more and less */
static void differ_over(const struct system *s, int p, real apart, real found[2 * MOST])
{
	const real end = (real)END / 50;
	struct system more = *s, less = *s;
	more.p[p] += apart;
	less.p[p] -= apart;
	const struct motion a = run(&more, end), b = run(&less, end);
	if (strcmp(a.trace, b.trace) != 0)
		printf("# %c: events are in another order\n", letter[p]);
	for (int i = 0; i < 2 * s->n; i++)
		found[i] = ((i % 2 ? a.v : a.x)[i / 2][0] - (i % 2 ? b.v : b.x)[i / 2][0]) / (2 * apart);
}

/* A mass at rest on a breakpoint passes it after a time that is the root of how far it is moved: so is the error of
 * differences, which two of them leave out. */
static void differ(const struct system *s, int p, real found[2 * MOST])
{
	real wide[2 * MOST];
	const int rests = s->clears == 0 && s->p[X] == -s->p[D];
	differ_over(s, p, rests ? 1e-16Q : 1e-10Q, found);
	if (!rests)
		return;
	differ_over(s, p, 4e-16Q, wide);
	for (int i = 0; i < 2 * s->n; i++)
		found[i] = 2 * found[i] - wide[i];
}

static int judge(unsigned long seed)
{
	struct system s = system_of(seed);
	const struct motion own = run(&s, (real)END / 50);
	double J[2 * MOST][PARAMS], y[2 * MOST], worst = 0, off = 0;
	const int params = PARAMS - (s.p[B] == 0);
	unsigned doubt;
	int status, bad = 0;
	if (own.events == EVENTS - 1)
		return 77;                      /* impacts without an end */
	if (scanf("%u %d", &doubt, &status) != 2)
		return 2;
	for (int i = 0; i < 2 * s.n; i++) {
		if (scanf("%lf", &y[i]) != 1)
			return 2;
		for (int p = 0; p < params; p++)
			if (scanf("%lf", &J[i][p]) != 1)
				return 2;
		off = fmax(off, (double)size_of(y[i] - (i % 2 ? own.v : own.x)[i / 2][0]));
	}
	for (int p = 0; p < params; p++) {
		real found[2 * MOST], size = 0;
		differ(&s, p, found);
		for (int i = 0; i < 2 * s.n; i++)
			size = size_of(found[i]) > size ? size_of(found[i]) : size;
		for (int i = 0; i < 2 * s.n; i++) {
			const double error = (double)(size_of(J[i][p] - found[i]) / (size + 1e-3Q));
			worst = fmax(worst, error);
			if (!(error <= 1e-10) && !(s.p[B] > 0 && error <= 1e-8)) {
				printf("# d%c%d/d%c: %.17g, not %.17g within 1e-10 of %g\n", i % 2 ? 'v' : 'x', i / 2,
				       letter[p], J[i][p], (double)found[i], (double)size);
				bad = 1;
			}
		}
	}
	printf("# seed %lu: %s; states off by %.1e, derivatives by %.1e; doubt %u, status %d\n", seed, own.trace, off,
	       worst, doubt, status);
	if (doubt)
		printf("reported\n");
	return bad && !doubt;
}

/* The stop where the mass turns for the first time, and a little off */
static struct system grazing(unsigned long seed)
{
	static const real off[] = { 0, 1e-16Q, -1e-16Q, 3e-15Q, -3e-15Q, 1e-13Q, -1e-13Q, 1e-12Q, -1e-12Q, 4e-12Q };
	struct system s = system_of(seed);
	for (; s.rubs == s.stop || (s.pairs && s.rubs + 1 == s.stop) || s.beside; s = system_of(seed))
		seed += 1000;                   /* friction would stop it there for a while */
	s.p[G] = 100;
	real low = 0, high = 0;
	struct motion m = begun(&s), from = m;  /* from: at `low`, as it first was */
	for (int k = 2; k < END * 2 - 2 && high == 0; k++) {
		follow(&m, (real)k / 100);
		const real v = m.v[s.stop][0] - (s.beside ? m.v[s.stop + 1][0] : 0);
		const real x = m.x[s.stop][0] - (s.beside ? m.x[s.stop + 1][0] : 0);
		if (v > 0 && x > 0.01Q) {
			low = (real)k / 100;
			from = m;
		} else if (low > 0) {
			high = (real)k / 100;
		}
	}
	for (int i = 0; i < 110 && low > 0; i++) {
		const real middle = (low + high) / 2;
		m = from;
		follow(&m, middle);
		*(m.v[s.stop][0] - (s.beside ? m.v[s.stop + 1][0] : 0) > 0 ? &low : &high) = middle;
	}
	s.p[G] = m.x[s.stop][0] - (s.beside ? m.x[s.stop + 1][0] : 0) + off[seed / 2 % 10];
	return low == 0 ? grazing(seed + 1000) : s;
}

int main(int argc, char **argv)
{
	const unsigned long seed = argc > 2 ? strtoul(argv[2], NULL, 10) : 0;
	if (argc == 3 && strcmp(argv[1], "spec") == 0) {
		const struct system s = system_of(seed);
		print_spec(&s, seed);
		return 0;
	}
	if (argc == 3 && strcmp(argv[1], "graze") == 0) {
		const struct system s = grazing(seed);
		print_spec(&s, seed);
		return 0;
	}
	return argc == 3 && strcmp(argv[1], "judge") == 0 ? judge(seed) : 2;
}
