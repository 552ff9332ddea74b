/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far an output of the emitted program may be off the exact solution, at any sample up to some time.
 *
 * An error made at one step reaches the output m steps later through row Phi^m, row being what the output reads. With
 * the rounding of a step at most d, from the order of its operations and from how large its operands become, the
 * output is off by at most sum over m < N of |row Phi^m| d, the rounding of constants included: FiXiF's and Volkova's
 * worst-case gain (ARITH 2015). States are bounded as they are computed, errors counted: a bound of the state that the
 * errors that follow from it do not pass. */
#include "inner.h"
#include "step/linear/forms.h"

#include <math.h>

#define WORK 4e8                    /* products of powers of a step */

/* ---- what one step rounds ---- */

int levels(int terms)
{
	int levels = 0;
	while (1 << levels < terms)
		levels++;
	return levels;
}

/* Of a load state relative to its amplitude: cos and sin, a growth, t and its products; the phase, which is kept in
 * 64 bits for float, in 128 for double, is off by one of its last for each step */
static double load_error(const struct errors *e, int column)
{
	const struct forcing_of_column *p = &e->step_map->forcing[column];
	const double phase = ldexp((double)(e->steps + 1) * 7, 1 - phase_bits(e->step));
	return (2 + 3 * (p->a != 0) + 4 * p->power) * e->unit + phase;
}

struct operand_bound { double size, error; };

static struct operand_bound bound_of_operand(const struct errors *e, const struct operand *operand)
{
	switch (operand->kind) {
	case OPERAND_STATE: return (struct operand_bound){ e->size[operand->index], e->err[operand->index] };
	case OPERAND_LOAD: {
		const double size = e->step_map->amplitude[operand->index];
		return (struct operand_bound){ size, size * load_error(e, operand->index) };
	}
	default: return (struct operand_bound){ e->step_map->most[operand->index], 0 };
	}
}

/* Of a load with refreshes the factor is rotated: of cosine and sine together */
static double size_of_factor(const struct errors *e, const struct assignment *a, const struct product *p)
{
	const struct table *table = e->step->branch->full;
	int first;
	if (p->operand.kind != OPERAND_LOAD)
		return fabs(p->factor->value);
	const struct load *load =
		&e->step->branch->system.load[load_of_column(&e->step->branch->system, p->operand.index, &first)];
	const int partner = oscillates(load->forcing) ? first + ((p->operand.index - first) ^ 1) : p->operand.index;
	return hypot(table->load[a->target * table->columns + p->operand.index].value,
		     table->load[a->target * table->columns + partner].value);
}

static void reckon(const struct errors *e, const struct assignment *a, const double *full)
{
	const struct program *program = e->step->program;
	const int roundings = 2 + (program->loops ? a->terms + 4 : levels(a->terms)) + 3 * program->compensated;
	double size = 0, error = 0;
	for (int i = 0; i < a->terms; i++) {
		const double factor = size_of_factor(e, a, &a->term[i]) * (1 + 1e-6);
		const struct operand_bound b = bound_of_operand(e, &a->term[i].operand);
		size += factor * b.size;
		error += factor * b.error;
	}
	error += roundings * e->unit * size + (a->terms + 4) * e->tiny;
	double value = full[a->target];
	if (program->in_order)
		value = e->size[a->target] + size;
	if (a->added)
		error += e->err[a->target] + (program->compensated || a->carried
						      ? 4 * e->unit * (size + 2 * e->unit * value)
						      : e->unit * value);
	e->size[a->target] = value;
	e->err[a->target] = error;
}

static void reckon_list(struct errors *e, const double *size, double *error)
{
	const struct program *program = e->step->program;
	const int n = e->step_map->n;
	double *old[2] = { ARRAY(double, n), ARRAY(double, n) };
	e->size = old[0];
	e->err = old[1];
	for (int i = 0; i < program->assignments; i++) {
		const struct assignment *a = &program->assignment[i];
		for (int j = 0; j < n && (i == 0 || !program->in_order); j++) {
			e->size[j] = size[j];
			e->err[j] = 0;
		}
		reckon(e, a, size);
		error[a->target] = e->err[a->target];
	}
}

static double modal_drive(const struct errors *e, int i, int *terms)
{
	const struct modal *modal = e->step->modal;
	double sum = 0;
	*terms = 0;
	for (int c = 0; c < modal->loads; c++)
		if (modal->load[i * modal->loads + c] != 0) {
			sum += fabs(modal->load[i * modal->loads + c]) * e->step_map->amplitude[c] *
			       (1 + load_error(e, c) / e->unit);
			(*terms)++;
		}
	for (int c = 0; c < modal->inputs; c++)
		if (modal->input[i * modal->inputs + c] != 0) {
			sum += fabs(modal->input[i * modal->inputs + c]) * e->step_map->most[c];
			(*terms)++;
		}
	return sum;
}

static void reckon_modes(const struct errors *e, const double *size, double *error)
{
	const struct modal *modal = e->step->modal;
	const int pairs = modal->pairs;
	for (int i = 0; i < modal->states; i++) {
		int terms;
		const double drive = modal_drive(e, i, &terms);
		double own = fabs(modal->turn[i]) * size[i];
		if (i < 2 * pairs) {
			const int re = i < pairs ? i : i - pairs, im = re + pairs, other = i < pairs ? im : re;
			own = fabs(modal->turn[re]) * size[i] + fabs(modal->turn[im]) * size[other];
		}
		error[i] = e->unit * (1 + 1e-6) * ((terms ? 4 : 3) * own + (3 + levels(terms)) * drive) +
			   (terms + 4) * e->tiny;
	}
}

/* The state at the start is rounded, or made of modes. */
static void reckon_start(const struct errors *e, double *error)
{
	const struct step_map *k = e->step_map;
	const struct modal *modal = e->step->modal;
	for (int i = 0; i < k->n; i++) {
		double size = fabs(k->start[i]) * k->scale[i] * (kept_mass(e->step, i) != 1 ? 3 : 1);
		for (int c = 0; c < k->columns && e->step->forced; c++)
			if (is_load_forced(e->step, c))
				size += fabs(mpq_get_d(e->step->forced->exact[i * k->columns + c]) *
					     load_value(&k->forcing[c], 0)) *
					(8 + levels(k->columns));
		for (int j = 0; j < k->n && modal; j++)
			size += fabs(modal->to[i * k->n + j] * mpq_get_d(e->step->model->initial[j])) * (k->n / 8 + 6);
		error[i] = e->unit * size + e->tiny;
	}
}

/* What reading the output rounds */
static double reckon_output(const struct errors *e, const double *size)
{
	const struct step_map *k = e->step_map;
	const struct linear *system = &e->step->branch->system;
	double sum = 0, error = 0;
	int terms = 0;
	for (int i = 0; i < k->n; i++) {
		terms += k->row[i] != 0;
		sum += fabs(k->row[i]) / k->scale[i] * size[i];
	}
	for (int c = 0; c < k->columns; c++) {
		terms += k->direct[c] != 0;
		sum += fabs(k->direct[c]) * k->amplitude[c];
		error += fabs(k->direct[c]) * k->amplitude[c] * load_error(e, c);
		for (int i = 0; i < k->n && is_load_forced(e->step, c); i++)
			error += fabs(k->row[i]) / k->scale[i] * k->amplitude[c] * e->unit *
				 fabs(mpq_get_d(e->step->forced->exact[i * k->columns + c])) *
				 (12 + levels(k->columns));
	}
	for (int i = 0, c = 0; i < system->inputs; c += system->input[i++].hold + 1) {
		const double slope = 2 * k->most[c] / mpq_get_d(e->step->model->h);
		terms += (k->feed[0][i] != 0) + (k->feed[1][i] != 0);
		sum += fabs(k->feed[0][i]) * k->most[c] + 4 * fabs(k->feed[1][i]) * slope;
	}
	return error + sum * e->unit * (4 + levels(terms) + (e->step->modal ? k->n / 8 + 5 : 0)) +
	       (terms + 4) * e->tiny;
}

/* ---- the whole ---- */

/* How far states are off: what steps add, and what becomes of the start */
static void spread_errors(const struct step_map *k, const struct spread *s, const double *each, const double *first,
			  double *error)
{
	for (int i = 0; i < k->n; i++) {
		error[i] = 0;
		for (int j = 0; j < k->n; j++)
			error[i] += k->scale[i] / k->scale[j] *
				    (s->sum[i * k->n + j] * each[j] + s->most[i * k->n + j] * first[j]);
	}
}

/* Sizes of the states as computed, and what a step of such sizes rounds; false: errors outgrow the state */
static bool converge(struct errors *e, const struct spread *s, double *size, double *each, const double *first)
{
	enum { TRIES = 12 };
	const struct step_map *k = e->step_map;
	double *error = ARRAY(double, k->n);
	for (int i = 0; i < k->n; i++)
		size[i] = k->size[i] * k->scale[i];
	for (int tries = 0; tries < TRIES; tries++) {
		bool holds = true;
		for (int i = 0; i < k->n; i++)
			each[i] = 0;
		if (e->step->modal)
			reckon_modes(e, size, each);
		else
			reckon_list(e, size, each);
		spread_errors(k, s, each, first, error);
		for (int i = 0; i < k->n; i++) {
			const double needed = k->size[i] * k->scale[i] + error[i];
			holds = holds && needed <= size[i];
			if (!(needed <= size[i]))
				size[i] = k->size[i] * k->scale[i] + 2 * error[i];
			if (!isfinite(size[i]))
				return false;
		}
		if (holds)
			return true;
	}
	return false;
}

static void add_up(struct errors *e, const struct spread *spread, struct certificate *found)
{
	const struct step_map *k = e->step_map;
	const size_t n = (size_t)k->n;
	double *each = ARRAY(double, n), *first = ARRAY(double, n), *size = ARRAY(double, n), *sum = ARRAY(double, n),
	       *most = ARRAY(double, n);
	reckon_start(e, first);
	if (!converge(e, spread, size, each, first)) {
		found->why = "rounding outgrows the state";
		return;
	}
	reach_of_row(spread, k->Phi, k->row, false, sum, most);
	found->rounding = reckon_output(e, size);
	for (int i = 0; i < k->n; i++)
		found->rounding += (sum[i] * each[i] + most[i] * first[i]) / k->scale[i];
	found->known = isfinite(found->rounding);
}

const char *certificate_objection(const struct errors *e)
{
	const struct linear *system = &e->step->branch->system;
	if (system->states > LIMIT_NEED_STATES)
		return format("it is built for up to %d states", LIMIT_NEED_STATES);
	if (loads_change(system))
		return "loads change their formula in time, and until then the run is too long to be walked through";
	const double powers = 2 * sqrt((double)e->steps) * pow(system->states, 3);
	if (e->steps < 0 || powers > WORK)
		return "there are too many samples until then";
	return NULL;
}

long samples_until(const struct requirement *r, mpq_srcptr h)
{
	RATIONAL steps = ZERO;
	INTEGER last = INTEGER_ZERO;
	mpq_div(steps, r->until, h);
	mpz_fdiv_q(last, mpq_numref(steps), mpq_denref(steps));
	const long count = mpz_fits_slong_p(last) ? mpz_get_si(last) : -1;
	return count;
}

double error_reported(const struct certificate *c)
{
	return c->walked ? c->error : c->rounding + c->dropped;
}

double needed_error(const struct requirement *r, double largest)
{
	return mpq_get_d(r->bound) * (r->need->percent ? largest : 1);
}

struct errors errors_of(const struct step *step, const struct requirement *r)
{
	const bool single = step->model->request.single;
	return (struct errors){ .step = step,
				.r = r,
				.steps = samples_until(r, step->model->h),
				.unit = single ? 0x1p-24 : 0x1p-53,
				.tiny = single ? 0x1p-116 : 0x1p-896 };     /* of what a flush sets to 0 */
}

double largest_of_output(const struct step *exact, const struct requirement *r)
{
	const struct errors e = errors_of(exact, r);
	if (certificate_objection(&e))
		return 0;
	struct step_map *k = step_map_of(&e, exact);
	const struct spread spread = spread_of(k->n, k->Phi, e.steps + 1);
	return spread.known ? extent_of_step_map(exact, e.steps, &spread, k).lower : 0;
}

struct certificate certificate_of(const struct step *step, const struct step *exact, const struct requirement *r)
{
	struct errors e = errors_of(step, r);
	struct certificate found = { .why = certificate_objection(&e) };
	if (found.why)
		return found;
	struct step_map *k = step_map_of(&e, exact);
	const struct spread spread = spread_of(k->n, k->Phi, e.steps + 1);
	if (!spread.known) {
		found.why = "powers of its step grow beyond what double tells";
		return found;
	}
	e.step_map = k;
	extent_of_step_map(step, e.steps, &spread, k);
	add_up(&e, &spread, &found);
	return found;
}
