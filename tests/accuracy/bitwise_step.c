/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of one step: the augmented matrix, its exponential, both parts of the load and input columns. */
#include "bitwise.h"

#include <float.h>
#include <math.h>

/* ---- the augmented matrix ---- */

static size_t input_states(const struct linear *system)
{
	size_t count = 0;
	for (int u = 0; u < system->inputs; u++)
		count += system->input[u].hold ? 2 : 1;
	return count;
}

/* A held input is u' = 0; a ramp from u0 to u1 is u0 (u - slope/h) + u1 slope/h. */
static void fill_inputs(const struct linear *system, mpq_srcptr h, const struct augmented *a)
{
	size_t at = a->size - a->inputs, column = a->columns - a->inputs;
	for (int u = 0; u < system->inputs; u++) {
		mpq_set_ui(a->X[at * a->columns + column], 1, 1);
		if (system->input[u].hold) {
			mpq_set_ui(a->A[at * a->size + at + 1], 1, 1);
			mpq_inv(a->X[(at + 1) * a->columns + column + 1], h);
			mpq_neg(a->X[(at + 1) * a->columns + column], a->X[(at + 1) * a->columns + column + 1]);
		}
		at += system->input[u].hold ? 2 : 1;
		column += system->input[u].hold ? 2 : 1;
	}
}

static void fill_dynamics(const struct linear *system, int segment, bool pl, const struct augmented *a)
{
	const size_t n = (size_t)system->n, states = a->states;
	size_t width;
	mpq_t *R = highest_rows(system, system->K, system->C, segment, 0, NULL, &width);
	if (!R)
		complain("masses", "the matrix of highest derivatives is singular");
	for (size_t i = 0; R && i < n; i++) {
		const bool second = system->velocity[i] >= 0;
		mpq_t *row = a->A + (second ? (size_t)system->velocity[i] : i) * a->size;
		const mpq_t *right = (const mpq_t *)R + i * width;
		if (second)
			mpq_set_ui(a->A[i * a->size + (size_t)system->velocity[i]], 1, 1);
		for (size_t j = 0; j < states; j++)
			mpq_neg(row[(pl && (size_t)system->coord[j] != i ? states : 0) + j], right[j]);
		for (size_t j = 0; j < a->loads; j++)
			mpq_set(row[a->first_load + j], right[states + j]);
		size_t at = a->first_load + a->loads;
		right += states + a->loads;
		for (int u = 0; u < system->inputs; u++)
			for (int k = 0; k <= system->input[u].hold; k++)
				mpq_set(row[at++], right[2 * u + k]);
	}
}

/* Scheme pl: after division by the masses, the terms of other coordinates act through a constant copy of the state. */
struct augmented augment(const struct linear *system, int segment, bool pl, mpq_srcptr h)
{
	const size_t states = (size_t)system->states, copies = pl ? states : 0;
	struct augmented a = { .states = states, .loads = (size_t)load_columns(system),
			.inputs = input_states(system) };
	a.first_load = states + copies;
	a.size = a.first_load + a.loads + a.inputs;
	a.columns = states + a.loads + a.inputs;
	a.A = rationals(a.size * a.size);
	a.X = rationals(a.size * a.columns);
	fill_dynamics(system, segment, pl, &a);
	for (size_t at = a.first_load, l = 0; l < (size_t)system->loads; at += (size_t)system->load[l++].columns)
		fill_load_states(&system->load[l], a.size, a.A + at * a.size + at);
	for (size_t j = 0; j < states + a.loads; j++) {
		mpq_set_ui(a.X[(j < states ? j : j + copies) * a.columns + j], 1, 1);
		if (j < copies)
			mpq_set_ui(a.X[(states + j) * a.columns + j], 1, 1);
	}
	fill_inputs(system, h, &a);
	return a;
}

/* ---- zero at every tau: (A^k X)_ij = 0 for k < size (Cayley and Hamilton), modulo a prime of 61 bits ---- */

static bool *always_zero(const struct augmented *a)
{
	const size_t n = a->size, m = a->columns;
	uint64_t *A = ARRAY(uint64_t, n * n), *v = ARRAY(uint64_t, n * m), *next = ARRAY(uint64_t, n * m);
	bool *zero = ARRAY(bool, n * m);
	for (size_t i = 0; i < n * n; i++)
		A[i] = residue(a->A[i]);
	for (size_t i = 0; i < n * m; i++) {
		v[i] = residue(a->X[i]);
		zero[i] = true;
	}
	for (size_t k = 0; k < n; k++) {
		for (size_t i = 0; i < n * m; i++) {
			zero[i] = zero[i] && v[i] == 0;
			next[i] = 0;
			for (size_t l = 0; l < n; l++)
				next[i] = (next[i] + times(A[i / m * n + l], v[l * m + i % m])) % PRIME;
		}
		uint64_t *swap = v;
		v = next;
		next = swap;
	}
	return zero;
}

/* ---- second words ---- */

static const evaluator_enclosure *enclosure(struct enclosures *e, int level)
{
	if (!e->level[level]) {
		e->level[level] = NEW(evaluator_enclosure);
		evaluator_enclosure_init(e->level[level], e->a->size);
		e->given_up[level] = evaluator_enclose((const mpq_t *)e->a->A, e->h, 512ul << level,
				e->level[level]) != 0;
	}
	return e->given_up[level] ? NULL : e->level[level];
}

bool rounded(mpfi_ptr x, double *d)
{
	const double high = mpfr_get_d(&x->right, MPFR_RNDN);
	*d = mpfr_get_d(&x->left, MPFR_RNDN);
	if (*d != high)
		return false;
	if (*d == 0)
		*d = 0;                         /* no sign */
	return true;
}

/* (e^{A h} X)_ij - subtract, rounded: true if this enclosure decides it. */
static bool rounded_difference(const struct augmented *a, const evaluator_enclosure *E, size_t i, size_t j,
							   double subtract, double *d)
{
	mpfi_t sum;
	size_t bits = mpz_sizeinbase(E->radius, 2);
	for (size_t l = 0; l < a->size; l++)
		if (mpz_sizeinbase(E->mid[i * a->size + l], 2) > bits)
			bits = mpz_sizeinbase(E->mid[i * a->size + l], 2);
	mpfi_init2(sum, (mpfr_prec_t)bits + 64);
	mpfi_set_ui(sum, 0);
	for (size_t l = 0; l < a->size; l++)
		if (mpq_sgn(a->X[l * a->columns + j]) != 0)
			add_entry(sum, E, i * a->size + l, a->X[l * a->columns + j]);
	mpfi_sub_d(sum, sum, subtract);
	const bool decided = rounded(sum, d);
	mpfi_clear(sum);
	return decided;
}

void compare_low(const char *what, struct enclosures *e, size_t i, size_t j, const struct coefficient *found)
{
	double low;
	for (int level = 0; level < LEVELS; level++) {
		const evaluator_enclosure *E = enclosure(e, level);
		if (E && rounded_difference(e->a, E, i, j, found->value, &low)) {
			compare(format("second word of %s", what), found->low, low);
			return;
		}
	}
	complain(what, "the judge cannot decide the second word");
}

/* ---- one step ---- */

const char *entry_name(const struct model *model, size_t i, size_t j)
{
	if (j < (size_t)model->system.states)
		return format("factor of %s in %s", model->names.state[j], model->names.state[i]);
	return format("factor of load or input column %zu in %s", j - (size_t)model->system.states,
			model->names.state[i]);
}

/* A factor of a state below the range of full precision leaves the step where another of its row is 2^100 times as
 * large. */
static bool is_lost(const double *row, size_t states, size_t j)
{
	double largest = 0;
	for (size_t k = 0; k < states; k++)
		largest = fmax(largest, fabs(row[k]));
	return j < states && fabs(row[j]) < DBL_MIN && fabs(row[j]) < 0x1p-100 * largest;
}

/* A flag says 0 at this tau: 0 at every tau, or lost, or the judge finds nothing there with 4096 bits. */
static void compare_flag(const char *what, struct enclosures *e, size_t i, size_t j, const struct coefficient *found,
						 bool always, bool lost)
{
	double value;
	if (always && !found->zero)
		complain(what, "zero at every step, and not marked so");
	if (always || lost || !found->zero)
		return;
	const evaluator_enclosure *E = enclosure(e, 3);
	if (E && rounded_difference(e->a, E, i, j, 0, &value) && value != 0)
		complain(what, "marked as zero, but it is not");
}

static const struct coefficient *found_entry(const struct table *table, int segment, size_t i, size_t j)
{
	const size_t states = (size_t)table->states, loads = (size_t)table->columns;
	if (j < states)
		return &table->Phi[i * states + j];
	if (j < states + loads)
		return &table->load[((size_t)segment * states + i) * loads + j - states];
	return &table->input[i * (size_t)table->inputs + j - states - loads];
}

/* The states and the inputs have the same factors in every segment. */
static void compare_step(const struct model *model, int segment, const struct augmented *a, const struct table *table,
						 const double *expected)
{
	struct enclosures e = { .a = a, .h = model->h };
	const bool *always = always_zero(a);
	if ((size_t)table->states != a->states || (size_t)table->columns != a->loads ||
		(size_t)table->inputs != a->inputs) {
		complain("table", "wrong size");
		return;
	}
	for (size_t i = 0; i < a->states; i++)
		for (size_t j = segment ? a->states : 0; j < (segment ? a->states + a->loads : a->columns); j++) {
			const char *what = entry_name(model, i, j);
			const struct coefficient *c = found_entry(table, segment, i, j);
			compare(what, c->value, expected[i * a->columns + j]);
			compare_low(what, &e, i, j, c);
			compare_flag(what, &e, i, j, c, always[i * a->columns + j],
						 is_lost(expected + i * a->columns, a->states, j));
		}
	for (int level = 0; level < LEVELS; level++)
		if (e.level[level])
			evaluator_enclosure_clear(e.level[level]);
}

/* One entry of e^{A h} by Taylor series, against what residues found */
static void compare_road(struct taylor *taylor, int i, int j, const char *what, double expected)
{
	double value = 0;
	mpfi_t x;
	mpq_t exact;
	mpq_init(exact);
	mpfi_init(x);
	bool decided = taylor_exact(taylor, i, j, exact);
	if (decided)
		value = round_rational(exact);
	for (int precision = 256; precision <= 4096 && !decided && taylor_enclose(taylor, precision); precision *= 2) {
		taylor_entry(taylor, i, j, x);
		decided = rounded(x, &value);
	}
	if (decided)
		compare(format("by Taylor series, %s", what), value, expected);
	mpfi_clear(x);
	mpq_clear(exact);
}

/* Small models come by residues, large ones by Taylor series: here the small ones by the second road too. */
static void compare_roads(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	const struct layout *layout = &step->layout;
	const int n = system->states, columns = step->branch->full->columns;
	if (n > LIMIT_RESIDUE_STATES || system->heldK)
		return;
	struct taylor *taylor = taylor_of(layout->size, (const mpq_t *)augmented_matrix(layout, system, 0),
			step->model->h);
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++)
			compare_road(taylor, i, j, entry_name(step->model, (size_t)i, (size_t)j),
						 step->branch->full->Phi[i * n + j].value);
		for (int l = 0, column = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++, column++)
				if (layout->load[l] >= 0)
					compare_road(taylor, i, layout->load[l] + k,
								 entry_name(step->model, (size_t)i,
										(size_t)(n + column)),
								 step->branch->full->load[i * columns + column].value);
	}
}

/* A refused step is right if a factor is out of range, and if that is what was said. */
static void compare_refusal(bool overflow)
{
	const char *said = diagnostics();
	trial.compared++;
	if (!overflow || !strstr(said, "is beyond the range of double"))
		complain("step refused", first_line(said));
}

void compare_scheme(const struct model *model, bool both_roads)
{
	const struct step *step = step_build(model);
	bool overflow = false;
	for (int s = 0; s < model->system.segments; s++) {
		const struct augmented a = augment(&model->system, s, model->scheme == SCHEME_PL, model->h);
		double *expected = ARRAY(double, a.size * a.columns);
		const int undecided =
			evaluator_round(a.size, (const mpq_t *)a.A, model->h, a.columns, (const mpq_t *)a.X, 0,
					expected);
		for (size_t i = 0; i < a.states * a.columns; i++)
			overflow = overflow || isinf(expected[i]);
		if (step && undecided)
			complain(format("entry %d of %zu x %zu", -1 - undecided, a.size, a.columns),
					"the judge cannot decide");
		else if (step)
			compare_step(model, s, &a, step->branch->full, expected);
	}
	if (!step)
		compare_refusal(overflow);
	else if (both_roads)
		compare_roads(step);
}
