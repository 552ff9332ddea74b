/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What acts during a step, as excitations. A load t^k e^{at} cos(wt+p) seen from the step's start t_n is, by the
 * binomial theorem and the addition theorem, a sum over its load states z = t_n^j e^{a t_n} cos or sin(w t_n + p), j <=
 * k: one column per load state. A sampled input is a constant, or a ramp from one sample to the next. */
#include "inner.h"

/* How much of load state `to` after tau comes from load state `from`, as factors of tau^m cos and tau^m sin:
 * t^k cos(..+wτ) from t_n^j: binomial(k, j) tau^{k-j}; cos(θ+wτ) = cos θ cos wτ - sin θ sin wτ, sin likewise. */
struct transition {
	int m;                      /* -1: nothing */
	long cosine, sine;          /* before the binomial factor */
	uint64_t binomial;
};

static struct transition transition_of(const struct load *load, int to, int from)
{
	int trig = oscillates(load->forcing) ? 2 : 1, k = to / trig, j = from / trig;
	bool to_sine = to % trig, from_sine = from % trig;
	struct transition t = { k - j, to_sine == from_sine, to_sine == from_sine ? 0 : to_sine ? 1 : -1, 1 };
	for (int i = 0; i < k - j; i++)         /* small: powers of loads are limited */
		t.binomial = t.binomial * (uint64_t)(k - i) / (uint64_t)(i + 1);
	return t;
}

static void add_scaled(mpq_ptr sum, mpq_srcptr q, long factor, uint64_t binomial)
{
	RATIONAL scaled = RATIO(factor, 1), multiple = RATIO((long)binomial, 1);
	mpq_mul(scaled, scaled, multiple);
	mpq_mul(scaled, scaled, q);
	mpq_add(sum, sum, scaled);
}

/* e += weight * (the load's force and direct factors in one segment, as they follow from load state `from` = 1) */
static void add_load(struct excitation *e, const struct linear *system, int segment, const struct load *load,
		     const mpq_t *direct, int from, mpq_srcptr weight)
{
	RATIONAL value = ZERO;
	for (int to = 0; to < load->columns; to++) {
		struct transition t = transition_of(load, to, from);
		if (t.m < 0)
			continue;
		for (int i = 0; i < system->n; i++) {
			mpq_mul(value, load->force[to][segment * system->n + i], weight);
			add_scaled(e->force[(2 * t.m) * system->n + i], value, t.cosine, t.binomial);
			add_scaled(e->force[(2 * t.m + 1) * system->n + i], value, t.sine, t.binomial);
		}
		if (direct) {
			mpq_mul(value, direct[to * system->segments + segment], weight);
			add_scaled(e->direct[2 * t.m], value, t.cosine, t.binomial);
			add_scaled(e->direct[2 * t.m + 1], value, t.sine, t.binomial);
		}
	}
}

static const mpq_t *unit(int count, int index)
{
	mpq_t *e = rationals(count);
	mpq_set_ui(e[index], 1, 1);
	return e;
}

/* A held term is a constant force -heldK q_j(0) or -heldC v_j(0). */
struct response *response_of_state(struct resolvent *r, const struct linear *system, int i, int j)
{
	struct response **kept = response_kept(r, system, i * system->states + j);
	if (*kept)
		return *kept;
	const mpq_t *held = j < system->n ? system->heldK : system->heldC;
	int n = system->n, c = system->coord[j];
	struct excitation constant = excitation_new(n, NULL, NULL, 1);
	for (int k = 0; k < n && held; k++)
		mpq_neg(constant.force[k], held[k * n + c]);
	const bool any = !rationals_zero((size_t)n, constant.force);
	return *kept = image_of(r, &(struct question){ unit(system->states, j), any, &constant,
						       unit(system->states, i) });
}

struct response *response_of_load(struct resolvent *r, const struct linear *system, int segment, int i, int l,
				  int column)
{
	const struct load *load = &system->load[l];
	int place = system->states + segment * load_columns(system) + column_of_load(system, l) + column;
	struct response **kept = response_kept(r, system, place * system->states + i);
	if (*kept)
		return *kept;
	struct excitation e = excitation_new(system->n, load->forcing->a, load->forcing->w, load->powers);
	RATIONAL one = RATIO(1, 1);
	add_load(&e, system, segment, load, NULL, column, one);
	return *kept = image_of(r, &(struct question){ NULL, 1, &e, unit(system->states, i) });
}

/* The factor of s^power in the polynomial of a sample */
static void power_weight(int hold, int power, int sample, mpq_srcptr h, mpq_ptr weight)
{
	sample_weight(hold, power, sample, weight);
	for (int k = 0; k < power; k++)
		mpq_div(weight, weight, h);
}

/* Held: u. Else the polynomial through the samples, and u' its derivative; a column is one sample's share. */
struct response *response_of_input(struct resolvent *r, const struct linear *system, int i, int index, int column,
				   mpq_srcptr h)
{
	const struct input *input = &system->input[index];
	int n = system->n;
	struct excitation e = excitation_new(n, NULL, NULL, input->hold + 1);
	RATIONAL weight = ZERO, part = ZERO;
	for (int m = 0; m <= input->hold; m++) {
		power_weight(input->hold, m, column, h, weight);
		for (int k = 0; k < n; k++)
			mpq_mul(e.force[2 * m * n + k], input->force[0][k], weight);
		if (m == input->hold)
			continue;
		power_weight(input->hold, m + 1, column, h, weight);
		mpq_set_si(part, m + 1, 1);
		mpq_mul(weight, weight, part);
		for (int k = 0; k < n; k++) {
			mpq_mul(part, input->force[1][k], weight);
			mpq_add(e.force[2 * m * n + k], e.force[2 * m * n + k], part);
		}
	}
	return image_of(r, &(struct question){ NULL, 1, &e, unit(system->states, i) });
}

mpq_t *impulse_of_force_column(const struct linear *system, int force_column)
{
	RATIONALS *inverse = inverse_of_leading(system);
	return slopes_by_force(system, inverse, system->force_column[force_column]);
}

/* sum power[m] (s/h)^m as a force, and an impulse at the start */
struct response *response_of_phi_weight(struct resolvent *r, const struct linear *system, int i, int force_column,
				    const struct phi_weight_part *part, mpq_srcptr h)
{
	int n = system->n;
	struct excitation e = excitation_new(n, NULL, NULL, part->powers);
	mpq_t *start = impulse_of_force_column(system, force_column);
	RATIONAL scale = ZERO;
	for (int m = 0; m < part->powers; m++) {
		mpq_set(scale, part->power[m]);
		for (int k = 0; k < m; k++)
			mpq_div(scale, scale, h);
		for (int k = 0; k < n; k++)
			mpq_mul(e.force[2 * m * n + k], system->force_column[force_column][k], scale);
	}
	for (int k = 0; k < system->states; k++)
		mpq_mul(start[k], start[k], part->impulse);
	return image_of(r, &(struct question){ start, part->powers > 0, &e, unit(system->states, i) });
}

/* e^{a tau} times a cosine or a sine, by their factors */
static struct response *response_of_turn(const struct forcing *forcing, long cosine, long sine)
{
	for (struct kept_response *k = *forcing->kept; k; k = k->next)
		if (k->cosine == cosine && k->sine == sine)
			return k->response;
	struct linear scalar = first_order_system(1, rationals(1));
	struct excitation e = excitation_new(1, forcing->a, forcing->w, 1);
	mpq_set_si(e.direct[0], cosine, 1);
	mpq_set_si(e.direct[1], sine, 1);
	struct question question = { NULL, 1, &e, rationals(1) };
	struct kept_response *first = NEW(struct kept_response);
	*first = (struct kept_response){ cosine, sine, image_of(resolvent_of(&scalar), &question), *forcing->kept };
	*forcing->kept = first;
	return first->response;
}

struct response *response_of_load_state(const struct load *load, int to, int from, mpq_srcptr tau)
{
	const struct transition t = transition_of(load, to, from);
	RATIONAL factor = RATIO((long)t.binomial, 1);
	for (int k = 0; k < t.m; k++)
		mpq_mul(factor, factor, tau);
	return response_scaled(response_of_turn(load->forcing, t.m < 0 ? 0 : t.cosine, t.m < 0 ? 0 : t.sine), factor);
}

/* z = t^j e^{a t} cos or sin(w t + p); the functions are irrational unless their argument is 0, then rationals of 256
 * bits. */
void load_state(const struct load *load, int column, mpq_srcptr t, mpq_ptr z)
{
	struct place nowhere = { 0 };
	const struct forcing *forcing = load->forcing;
	bool turns = oscillates(forcing);
	RATIONAL factor = ZERO;
	mpq_mul(factor, forcing->a, t);
	constant_function(nowhere, FN_EXP, factor, z);
	for (int k = 0; k < (turns ? column / 2 : column); k++)
		mpq_mul(z, z, t);
	if (turns) {
		mpq_mul(factor, forcing->w, t);
		mpq_add(factor, factor, forcing->p);
		constant_function(nowhere, column % 2 ? FN_SIN : FN_COS, factor, factor);
		mpq_mul(z, z, factor);
	}
}

/* ---- an output after some time, from what there is at its start ---- */

struct output state_as_output(const struct linear *system, int state)
{
	struct output output = { 0 };
	output_rows(system, 0, &output);
	mpq_set_ui(output.state[state], 1, 1);
	return output;
}

struct response *output_of_states(struct resolvent *r, const struct output *output, const mpq_t *initial)
{
	return image_of(r, &(struct question){ initial, 0, NULL, output->state });
}

/* Of the first segment of time, the load's own part in the output included */
struct response *output_of_load(struct resolvent *r, const struct linear *system, const struct output *output, int l,
				int column, const mpq_t *initial)
{
	const struct load *load = &system->load[l];
	struct excitation e = excitation_new(system->n, load->forcing->a, load->forcing->w, load->powers);
	RATIONAL one = RATIO(1, 1);
	add_load(&e, system, 0, load, output->load[l], column, one);
	return image_of(r, &(struct question){ initial, 1, &e, output->state });
}

/* u = value + slope tau, u' = slope: its force, and its own part in the output */
struct response *output_of_input(struct resolvent *r, const struct linear *system, const struct output *output,
				 int index, mpq_srcptr value, mpq_srcptr slope)
{
	const struct input *input = &system->input[index];
	int n = system->n;
	struct excitation e = excitation_new(n, NULL, NULL, 2);
	for (int k = 0; k < n; k++) {
		mpq_mul(e.force[k], input->force[0][k], value);
		mpq_mul(e.force[2 * n + k], input->force[0][k], slope);
		if (input->hold)
			rational_addmul(e.force[k], input->force[1][k], slope);
	}
	mpq_mul(e.direct[0], output->input[0][index], value);
	rational_addmul(e.direct[0], output->input[1][index], slope);
	mpq_mul(e.direct[2], output->input[0][index], slope);
	return image_of(r, &(struct question){ NULL, 1, &e, output->state });
}

/* What one load of a segment from time t on does, times `sign` */
static void add_load_from(struct excitation *e, const struct linear *system, const struct output *output, int l,
			  int segment, mpq_srcptr t, int sign)
{
	RATIONAL z = ZERO;
	for (int column = 0; column < system->load[l].columns; column++) {
		load_state(&system->load[l], column, t, z);
		if (sign < 0)
			mpq_neg(z, z);
		if (mpq_sgn(z) != 0)
			add_load(e, system, segment, &system->load[l], output->load[l], column, z);
	}
}

static bool acts(const struct linear *system, const struct output *output, int l, int segment)
{
	const struct load *load = &system->load[l];
	bool any = false;
	for (int column = 0; column < load->columns && !any; column++)
		any = !rationals_zero((size_t)system->n, load->force[column] + segment * system->n) ||
		      (output->load[l] && mpq_sgn(output->load[l][column * system->segments + segment]) != 0);
	return any;
}

/* From when on it does not act any more, first of all; NULL: it acts in this segment and in all behind it */
static mpq_srcptr end_of_load(const struct linear *system, const struct output *output, int l, int segment)
{
	while (segment < system->segments && acts(system, output, l, segment))
		segment++;
	return segment < system->segments && segment > 0 ? system->change[segment - 1] : NULL;
}

struct starts {                     /* what an output is a sum of */
	int count;
	struct started *list;
};

static struct started *add_start(struct starts *s, struct response *response, mpq_srcptr start)
{
	struct started *added = MORE(s->list, s->count);
	*added = (struct started){ .response = response };
	mpq_init(added->start);
	mpq_set(added->start, start);
	return added;
}

/* What changes where a segment begins; a load that ends is by itself, what lasts in one response with the start. */
static void add_changes(struct resolvent *r, const struct linear *system, const mpq_t *initial,
			const struct output *output, int segment, bool first, struct starts *to)
{
	mpq_srcptr start = first ? rationals(1)[0] : system->change[segment - 1];
	struct excitation *e = ARRAY(struct excitation, system->loads);
	const mpq_t *none = rationals(system->states);
	for (int l = 0; l < system->loads; l++) {
		const struct load *load = &system->load[l];
		mpq_srcptr end = end_of_load(system, output, l, segment);
		e[l] = excitation_new(system->n, load->forcing->a, load->forcing->w, load->powers);
		add_load_from(&e[l], system, output, l, segment, start, 1);
		if (!first)
			add_load_from(&e[l], system, output, l, segment - 1, start, -1);
		if (!end)
			continue;
		struct started *alone =
			add_start(to, image_of(r, &(struct question){ none, 1, &e[l], output->state }), start);
		alone->transient = transient_of(r, alone->response, &e[l]);
		alone->end = end;
		e[l] = excitation_new(system->n, load->forcing->a, load->forcing->w, load->powers);
	}
	const struct question lasting = { first ? initial : none, system->loads, e, output->state };
	add_start(to, image_of(r, &lasting), start);
}

/* From the start with the loads of the segment that holds t = 0; then at each change the difference of the loads. */
int responses_of_output(struct resolvent *r, const struct linear *system, const mpq_t *initial,
			const struct output *output, struct started **list)
{
	struct starts all = { 0 };
	int first = 0;
	while (first < system->segments - 1 && mpq_sgn(system->change[first]) <= 0)
		first++;
	for (int s = first; s < system->segments; s++)
		add_changes(r, system, initial, output, s, s == first, &all);
	*list = all.list;
	return all.count;
}
