/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Every number that the generator finds, by poles and residues or by Taylor series, against the judge, bit for bit: the
 * transfer matrix, the load columns of every segment of time and the input columns of schemes exact and pl (both words
 * of each), the closed-form solution, and the models that --reduce makes.
 *
 *     bitwise [-n RANDOM] [-r REDUCED] [-e EVERY] [-s SEED] [-q] [-v] exponentials.txt MODEL.spec ...
 *
 * Shared with the generator: its parser and the matrices M, C, K and loads that it reads from a spec.  From there on
 * the judge has its own algebra: the augmented matrix A of y' = A y is made here.  Each case runs in a process of its
 * own, so that a crash or an endless loop is one failed case.
 */
#include "bitwise.h"
#include "bitwise_specs.h"

#include <time.h>
#include <unistd.h>

enum { LONGEST_CASE = 300, MISMATCHES_SHOWN = 10 };     /* seconds; lines */

static const char *const STEPS[] = { "1e-12", "1e-9", "1e-3", "0.01", "1", "1e3" };
enum { STEP_COUNT = sizeof STEPS / sizeof *STEPS };

/* With -q a model of so many states at three steps only: its own, the shortest and one in the middle */
enum { LARGE_STATES = 4, SHORTEST = 0, MIDDLE = 3 };

static bool verbose, quick;

/* ---- one case: what is compared now, and what went wrong so far ---- */

struct tried trial = { .spec = "", .scheme = "exact", .time = "none" };

void complain(const char *what, const char *message)
{
	if (trial.failed++ < MISMATCHES_SHOWN)
		printf("# scheme %s, time %s, %s: %s\n", trial.scheme, trial.time, what, message);
}

void compare(const char *what, double found, double expected)
{
	trial.compared++;
	if (memcmp(&found, &expected, sizeof found) != 0)
		complain(what, format("found %a = %.17g, expected %a = %.17g", found, found, expected, expected));
}

/* ---- one spec ---- */

static struct model *model_of(const char *text)
{
	static const struct request none;
	struct model *model = model_build(spec_of("spec", text), &none);
	if (!model)
		complain("spec", format("not accepted: %s", first_line(diagnostics())));
	return model;
}

static void try_model(struct model *model, bool both_roads)
{
	static const char *const schemes[] = { "exact", "pl" };
	mpq_t written;
	mpq_init(written);
	mpq_set(written, model->h);
	for (int pl = 0; pl < 2; pl++) {
		if (pl && model->n == 1)
			continue;                   /* nothing to hold: the same as exact */
		trial.scheme = schemes[pl];
		model->scheme = pl ? SCHEME_PL : SCHEME_EXACT;
		for (int k = -1; k < STEP_COUNT; k++) {
			if (quick && model->system.states >= LARGE_STATES && k >= 0 && k != SHORTEST && k != MIDDLE)
				continue;
			trial.time = k < 0 ? "as written" : STEPS[k];
			if (k >= 0)
				rational_parse(model->h, STEPS[k]);
			else
				mpq_set(model->h, written);
			compare_scheme(model, both_roads && k != STEP_COUNT - 1);
		}
		if (!pl)
			compare_solution(model, written);
	}
	mpq_set(model->h, written);
	mpq_clear(written);
}

static void try_spec(const char *text, bool both_roads)
{
	trial.spec = text;
	struct model *model = model_of(text);
	if (model)
		try_model(model, both_roads);
}

/* ---- --reduce ---- */

/* Rank of c, c A, c A^2, ... of all outputs, by elimination in rationals */
static size_t observable_rank(const struct model *model)
{
	const struct augmented a = augment(&model->system, 0, false, model->h);
	const size_t n = a.states, rows = n * (size_t)model->outputs;
	mpq_t *R = rationals(rows * n), factor;
	size_t rank = 0;
	mpq_init(factor);
	for (size_t o = 0; o < (size_t)model->outputs; o++)
		for (size_t k = 0; k < n; k++)
			for (size_t j = 0; j < n; j++) {
				mpq_t *cell = &R[(o * n + k) * n + j];
				if (k == 0)
					mpq_set(*cell, model->output[o].state[j]);
				for (size_t l = 0; l < n && k; l++)
					add_product(*cell, R[(o * n + k - 1) * n + l], a.A[l * a.size + j], false);
			}
	for (size_t j = 0; j < n; j++) {
		size_t pivot = rank;
		while (pivot < rows && mpq_sgn(R[pivot * n + j]) == 0)
			pivot++;
		if (pivot == rows)
			continue;
		for (size_t l = 0; l < n; l++)
			mpq_swap(R[pivot * n + l], R[rank * n + l]);
		for (size_t i = rank + 1; i < rows; i++) {
			mpq_div(factor, R[i * n + j], R[rank * n + j]);
			for (size_t l = j; l < n && mpq_sgn(factor); l++)
				add_product(R[i * n + l], factor, R[rank * n + l], true);
		}
		rank++;
	}
	mpq_clear(factor);
	return rank;
}

struct reduced_case {
	const struct model *full, *reduced;
};

/* Both are correctly rounded, so they are equal to the last bit. */
static void compare_outputs(void *context)
{
	static const unsigned long multiples[] = { 0, 1, 17, 60, 3000 };
	const struct reduced_case *r = context;
	struct resolvent *full = resolvent_of(&r->full->system), *reduced = resolvent_of(&r->reduced->system);
	mpq_t t;
	mpq_init(t);
	for (int o = 0; o < r->full->outputs; o++) {
		const char *name = r->full->output[o].name;
		struct started *f, *g;
		const int fs =
			responses_of_output(full, &r->full->system, (const mpq_t *)r->full->initial,
					&r->full->output[o], &f);
		const int gs = responses_of_output(reduced, &r->reduced->system, (const mpq_t *)r->reduced->initial,
										   &r->reduced->output[o], &g);
		for (size_t k = 0; k < sizeof multiples / sizeof *multiples; k++) {
			mpq_set_ui(t, multiples[k], 1);
			mpq_mul(t, t, r->full->h);
			trial.time = format("%lu h", multiples[k]);
			const double expected = started_value(fs, f, t, false, r->full->request.at.step, name).value;
			compare(name, started_value(gs, g, t, false, r->full->request.at.step, name).value, expected);
		}
	}
	mpq_clear(t);
}

/* The reduced model has the same outputs, as many states as are needed, and numbers as right as any model's. */
static void try_reduction(const char *text)
{
	trial.spec = text;
	struct model *full = model_of(text);
	if (!full)
		return;
	full->request.reduce = true;
	struct model *reduced = model_reduce(full);
	const size_t rank = observable_rank(full);
	trial.scheme = "exact (reduced)";
	trial.compared++;
	if ((size_t)reduced->system.states != rank)
		complain("states", format("found %d, expected %zu of %d", reduced->system.states, rank,
				full->system.states));
	if (rank == (size_t)full->system.states)
		complain("states", "nothing was hidden");
	if (!statement_guard(compare_outputs, &(struct reduced_case){ full, reduced }))
		complain("outputs", first_line(diagnostics()));
	trial.scheme = "exact (reduced)";
	trial.time = "as written";
	compare_scheme(reduced, false);
	compare_solution(reduced, reduced->h);
}

/* ---- matrices that are no vibration: (s I - A)^-1 entry by entry ---- */

struct matrix_case {
	char name[100];
	size_t n;
	mpq_t tau, *A;
	double *expected;
};

/* Rows times the least common denominator: what is in Z[s]. */
static struct polymat pencil(const struct matrix_case *c, mpz_t *row)
{
	const size_t n = c->n;
	struct polymat P = { (int)n, ARRAY(struct poly, n * n) };
	for (size_t i = 0; i < n; i++) {
		mpz_init_set_ui(row[i], 1);
		for (size_t j = 0; j < n; j++)
			mpz_lcm(row[i], row[i], mpq_denref(c->A[i * n + j]));
		for (size_t j = 0; j < n; j++) {
			struct poly *cell = &P.cell[i * n + j];
			*cell = poly_new(2);
			mpz_divexact(cell->c[0], row[i], mpq_denref(c->A[i * n + j]));
			mpz_mul(cell->c[0], cell->c[0], mpq_numref(c->A[i * n + j]));
			mpz_neg(cell->c[0], cell->c[0]);
			if (i == j)
				mpz_set(cell->c[1], row[i]);
			poly_trim(cell);
		}
	}
	return P;
}

static void compare_matrix(void *context)
{
	const struct matrix_case *c = context;
	const size_t n = c->n;
	mpz_t *row = ARRAY(mpz_t, n);
	struct polymat adj = { (int)n, ARRAY(struct poly, n * n) };
	struct poly det;
	struct augmented a = { .states = n, .size = n, .columns = n, .A = c->A, .X = rationals(n * n) };
	struct enclosures e = { .a = &a, .h = c->tau };
	mpq_t scale;
	mpq_init(scale);
	for (size_t i = 0; i < n; i++)
		mpq_set_ui(a.X[i * n + i], 1, 1);
	polymat_adjugate(pencil(c, row), &det, &adj);
	for (size_t i = 0; i < n; i++)
		for (size_t j = 0; j < n; j++) {
			const char *what = format("entry %zu, %zu", i, j);
			mpq_set_z(scale, row[j]);
			struct response *response = response_of(scale, adj.cell[i * n + j], det);
			const struct coefficient found = response_value(response, c->tau, true, (struct place){ 0 },
					what);
			compare(what, found.value, c->expected[i * n + j]);
			compare_low(what, &e, i, j, &found);
		}
}

static struct matrix_case *read_matrices(const char *path, size_t *count)
{
	struct matrix_case *all = NULL, c;
	FILE *f = fopen(path, "r");
	*count = 0;
	if (!f) {
		printf("Bail out! cannot read %s\n", path);
		exit(1);
	}
	for (int ch; (ch = getc(f)) == '#';)
		while (ch != '\n' && ch != EOF)
			ch = getc(f);
	while (fscanf(f, " %99[^\n]", c.name) == 1) {
		mpq_init(c.tau);
		int good = gmp_fscanf(f, "%zu %Qd", &c.n, c.tau) == 2;
		c.A = rationals(c.n * c.n);
		c.expected = ARRAY(double, c.n * c.n);
		for (size_t i = 0; i < c.n * c.n && good; i++)
			good = gmp_fscanf(f, "%Qd", c.A[i]) == 1;
		for (size_t i = 0; i < c.n * c.n && good; i++)
			good = fscanf(f, "%la", &c.expected[i]) == 1;
		if (!good) {
			printf("Bail out! %s: cannot read matrix %s\n", path, c.name);
			exit(1);
		}
		ENLARGE(all, *count + 1);
		all[(*count)++] = c;
	}
	fclose(f);
	return all;
}

static void try_matrix(struct matrix_case *c)
{
	trial.spec = "";
	trial.scheme = "matrix";
	trial.time = "as given";
	if (!statement_guard(compare_matrix, c))
		complain(c->name, first_line(diagnostics()));
}

/* ---- zero at one step only ---- */

/* Critically damped at w h = 1: Phi_22 = (1 - w h) e^{-w h} is 0 at this step and at no other. */
static void try_critical(const char *text)
{
	trial.spec = text;
	trial.scheme = "exact";
	trial.time = "as written, w h = 1";
	struct model *model = model_of(text);
	const struct step *step = model ? step_build(model) : NULL;
	if (!step || !step->branch->full->Phi[3].zero || step->branch->full->Phi[3].value != 0)
		complain("Phi_22", "not found to be zero");
	if (!step)
		return;
	rational_parse(model->h, "0.0100000000000000000000000000001");
	step = step_build(model);
	if (!step || step->branch->full->Phi[3].zero || !(step->branch->full->Phi[3].value < -3e-30))
		complain("Phi_22", "1e-31 beside its zero: found to be zero");
}

/* ---- rational at every step ---- */

/* A^k X = 0 from k = size on, so e^{A h} X is a finite sum. */
static mpq_t *nilpotent_exponential(const struct augmented *a, mpq_srcptr h)
{
	const size_t n = a->size, m = a->columns;
	mpq_t *sum = rationals(n * m), *term = rationals(n * m), factor;
	mpq_init(factor);
	for (size_t i = 0; i < n * m; i++) {
		mpq_set(sum[i], a->X[i]);
		mpq_set(term[i], a->X[i]);
	}
	for (unsigned long k = 1; k <= n; k++) {
		mpq_t *next = rationals(n * m);
		mpq_set_ui(factor, k, 1);
		mpq_div(factor, h, factor);
		for (size_t i = 0; i < n * m; i++) {
			for (size_t l = 0; l < n; l++)
				add_product(next[i], a->A[i / m * n + l], term[l * m + i % m], false);
			mpq_mul(next[i], next[i], factor);
			mpq_add(sum[i], sum[i], next[i]);
		}
		term = next;
	}
	for (size_t i = 0; i < n * m; i++)
		if (mpq_sgn(term[i]) != 0)
			complain("spec", "not nilpotent");
	mpq_clear(factor);
	return sum;
}

static void compare_exact(const char *what, struct response *response, mpq_srcptr h, mpq_srcptr expected)
{
	mpq_t found;
	mpq_init(found);
	trial.compared++;
	if (!response_exact(response, h, found))
		complain(what, "not found to be rational");
	else if (!mpq_equal(found, expected))
		complain(what, format("found %s, expected %s", exact_text(found), exact_text(expected)));
	mpq_clear(found);
}

static void compare_exact_row(const struct model *model, int segment, const struct augmented *a, const mpq_t *expected,
							  int i)
{
	const struct linear *system = &model->system;
	struct resolvent *resolvent = resolvent_of(system);
	const mpq_t *row = expected + (size_t)i * a->columns;
	size_t at = 0;
	for (int j = 0; j < system->states; j++, at++)
		compare_exact(entry_name(model, (size_t)i, at), response_of_state(resolvent, system, i, j), model->h,
				row[at]);
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, at++)
			compare_exact(entry_name(model, (size_t)i, at),
					response_of_load(resolvent, system, segment, i, l, k),
						  model->h, row[at]);
	for (int u = 0; u < system->inputs; u++)
		for (int k = 0; k <= system->input[u].hold; k++, at++)
			compare_exact(entry_name(model, (size_t)i, at),
					response_of_input(resolvent, system, i, u, k, model->h),
						  model->h, row[at]);
}

/* Every number of the step is the very rational, before it is rounded. */
static void try_exact(const char *text)
{
	trial.spec = text;
	trial.scheme = "exact";
	struct model *model = model_of(text);
	for (int k = 0; k < STEP_COUNT && model; k++) {
		trial.time = STEPS[k];
		rational_parse(model->h, STEPS[k]);
		for (int s = 0; s < model->system.segments; s++) {
			const struct augmented a = augment(&model->system, s, false, model->h);
			const mpq_t *expected = (const mpq_t *)nilpotent_exponential(&a, model->h);
			for (int i = 0; i < model->system.states; i++)
				compare_exact_row(model, s, &a, expected, i);
		}
	}
}

/* ---- the whole ---- */

struct job {
	void (*work)(void *context);
	void *context;
};

static bool try_case(void *context)
{
	const struct job *job = context;
	job->work(job->context);
	if (trial.failed)
		show_spec(trial.spec);
	if (trial.failed > MISMATCHES_SHOWN)
		printf("# %d failures in all\n", trial.failed);
	if (trial.compared == 0)
		puts("# nothing was compared");
	if (trial.beyond)
		printf("# times beyond the judge: %d\n", trial.beyond);
	if (verbose)
		printf("# %d numbers compared in %.2f s\n", trial.compared, (double)clock() / CLOCKS_PER_SEC);
	return !trial.failed && trial.compared > 0;
}

static void run(const char *name, void (*work)(void *), void *context)
{
	struct job job = { work, context };
	run_case(name, LONGEST_CASE, try_case, &job);
}

static void run_spec(void *text)
{
	try_spec(text, true);
}

static void run_critical(void *text)
{
	try_critical(text);
	try_spec(text, true);
}

static void run_exact(void *text)
{
	try_exact(text);
	try_spec(text, true);
}

static void run_matrix(void *c)
{
	try_matrix(c);
}

static void run_random(void *seed)
{
	try_spec(random_spec(*(uint64_t *)seed), false);
}

static void run_reduction(void *seed)
{
	try_reduction(random_symmetric_spec(*(uint64_t *)seed));
}

int main(int argc, char **argv)
{
	unsigned long random_count = 200, reduced_count = 100, every = 1, seed = 1;
	memory_open();
	take_options(argc, argv, (struct command_option[]){
		{ 'n', .number = &random_count }, { 'r', .number = &reduced_count }, { 'e', .number = &every },
		{ 's', .number = &seed }, { 'q', .on = &quick }, { 'v', .on = &verbose }, { 0 }
	});
	if (optind == argc) {
		fputs("usage: bitwise [-n RANDOM] [-r REDUCED] [-e EVERY] [-s SEED] [-q] [-v] exponentials.txt "
			  "MODEL.spec ...\n", stderr);
		return 2;
	}
	size_t matrices;
	struct matrix_case *matrix = read_matrices(argv[optind++], &matrices);
	printf("1..%zu\n", matrices + (size_t)(argc - optind) + (bitwise_spec_count + every - 1) / every
			+ random_count +
		   reduced_count);
	for (size_t i = 0; i < matrices; i++)
		run(format("matrix %s, tau = %s", matrix[i].name, exact_text(matrix[i].tau)), run_matrix, &matrix[i]);
	for (int i = optind; i < argc; i++)
		run(base_name(argv[i]), run_spec, read_text(argv[i]));
	static void (*const run_kind[])(void *) = { [PLAIN] = run_spec, [CRITICAL] = run_critical,
			[EXACT] = run_exact };
	for (size_t i = 0; i < bitwise_spec_count; i += every)
		run(bitwise_specs[i].name, run_kind[bitwise_specs[i].kind], (void *)bitwise_specs[i].text);
	for (unsigned long i = 0; i < random_count; i++) {
		uint64_t one = seed + i;
		run(format("random model %lu", seed + i), run_random, &one);
	}
	for (unsigned long i = 0; i < reduced_count; i++) {
		uint64_t one = seed + i;
		run(format("reduced random model %lu", seed + i), run_reduction, &one);
	}
	memory_close();
	return cases_failed() > 0;
}
