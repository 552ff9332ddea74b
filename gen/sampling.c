/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How long a step is where a spec with needs says nothing of it. A linear step is exact however long it is, so what
 * counts is what its samples show: two in the shortest period of the loads and of the modes that are kept, as Nyquist
 * and Shannon ask for; and a hundred until the first need ends. And the steps of a motion that ends at a given time. */
#include "command.h"
#include "step/linear/images.h"

#include <limits.h>
#include <math.h>

enum { SAMPLES = 100, SAMPLES_OF_PERIOD = 2 };

const char *round_step(double h)
{
	static const int digits[] = { 5, 2, 1 };
	int power = (int)floor(log10(h * (1 + 1e-12)));
	const double lead = h / pow(10, power) * (1 + 1e-12);
	int digit = 1;
	for (int i = 0; i < 3; i++)
		if (digits[i] <= lead) {
			digit = digits[i];
			break;
		}
	return power < 0 && power >= -4	  ? format("%.*f", -power, digit * pow(10, power))
	       : power >= 0 && power <= 6 ? format("%.0f", digit * pow(10, power))
					  : format("%de%d", digit, power);
}

const char *first_step(const struct model *stepped)
{
	double end = HUGE_VAL;
	for (int i = 0; i < stepped->needs.requirements; i++)
		if (mpq_sgn(stepped->needs.requirement[i].until) > 0)
			end = fmin(end, mpq_get_d(stepped->needs.requirement[i].until));
	return round_step(end / SAMPLES);
}

/* [s]; infinite: nothing oscillates */
static double shortest_period(const struct step *step)
{
	const struct linear *system = &step->model->system;
	struct pole_report *pole;
	double fastest = 0;
	const int poles = poles_of(step->model, step->written, &pole);
	for (int i = 0; i < poles; i++)
		fastest = fmax(fastest, fabs(mpfr_get_d(pole[i].im, MPFR_RNDN)));
	for (int l = 0; l < system->loads; l++)
		if (load_acts(system, &system->load[l]))
			fastest = fmax(fastest, fabs(mpq_get_d(system->load[l].forcing->w)));
	return 2 * 3.14159265358979 / fastest;
}

const char *shorter_step(const struct step *taken)
{
	const double longest = shortest_period(taken) / SAMPLES_OF_PERIOD;
	return mpq_get_d(taken->model->h) > longest ? round_step(longest) : NULL;
}

long divide_motion(struct request *request, mpq_srcptr h, mpq_srcptr end)
{
	RATIONAL steps = ZERO;
	INTEGER count = INTEGER_ZERO;
	if (mpq_sgn(h) == 0)            /* that there is none is said where the model is made */
		return 0;
	mpq_div(steps, end, h);
	mpz_cdiv_q(count, mpq_numref(steps), mpq_denref(steps));
	if (mpz_sgn(count) == 0)
		return 0;
	mpq_set_z(steps, count);
	mpq_div(steps, end, steps);
	request->step = exact_text(steps);
	return mpz_fits_slong_p(count) ? mpz_get_si(count) : LONG_MAX;
}

struct request request_of_motion(const struct request *given)
{
	struct request request = *given;
	request.solution = request.reduce = request.single = request.selftest = request.many.batch = false;
	request.fast = request.phasors = false;
	request.modes = request.linear.where = NULL;
	request.rows = 0;
	return request;
}
