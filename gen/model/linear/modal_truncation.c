/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The model of some of its modes: their coordinates are its states, and what the others would follow at once stays as
 * rows from loads and inputs into outputs (static correction: Craig and Kurdila 2006, 11.4, for loads at their own
 * frequencies). Numbers of modes are dyadic rationals of a precision, and exact from here on. */
#include "inner.h"
#include "model/building.h"
#include "model/checks.h"

/* ---- the states of a model of modes ---- */

struct selection {
	struct modes *modes;
	const bool *of;             /* per mode */
	int states, coords;
	int *first;                 /* per mode: its first state, or coordinate; -1: it is none of these */
};

/* States z of a mode: coordinates first, then velocities, of all modes */
static int place_of(const struct selection *s, int mode, int i)
{
	const struct mode *m = &s->modes->mode[mode];
	return !m->moves || i < m->columns ? s->first[mode] + i : s->coords + s->first[mode] + i - m->columns;
}

static bool select_modes(struct selection *s)
{
	const struct modes *modes = s->modes;
	s->first = ARRAY(int, modes->count + 1);
	for (int i = 0; i < modes->count; i++) {
		const struct mode *mode = &modes->mode[i];
		s->first[i] = s->of[i] ? s->coords : -1;
		if (!s->of[i])
			continue;
		if (!mode_refine(s->modes, i))
			return false;
		s->coords += mode->moves ? mode->columns : mode->states;
		s->states += mode->states;
	}
	return true;
}

static struct linear shape_of(const struct selection *s)
{
	const bool moves = s->states > s->coords;
	struct linear shape = { .n = s->coords, .states = s->states, .segments = 1,
				.velocity = ARRAY(int, s->coords), .coord = ARRAY(int, s->states) };
	for (int i = 0; i < s->coords; i++) {
		shape.velocity[i] = moves ? s->coords + i : -1;
		shape.coord[i] = i;
		if (moves)
			shape.coord[s->coords + i] = i;
	}
	return linear_like(&shape);
}

static void fill_block(const struct selection *s, int index, struct linear *system)
{
	const struct mode *mode = &s->modes->mode[index];
	const int c = mode->moves ? mode->columns : mode->states, k = mode->states, n = s->coords;
	for (int i = 0; i < c; i++)
		for (int j = 0; j < c; j++) {
			const int cell = (s->first[index] + i) * n + s->first[index] + j;
			const mpq_t *row = mode->block + (mode->moves ? c + i : i) * k;
			mpq_neg(system->K[cell], row[j]);
			if (mode->moves)
				mpq_neg(system->C[cell], row[c + j]);
			if (i == j)
				mpq_set_ui((mode->moves ? system->M : system->C)[cell], 1, 1);
		}
}

/* ---- what drives them ---- */

/* left column: what drives z */
static void drive(const struct modes *modes, const struct mode *mode, const mpq_t *column, mpq_t *b)
{
	const int states = modes->model->system.states;
	rational_product(mode->states, states, 1, mode->left, column, b);
}

struct projecting { const struct selection *s; const mpq_t *inverse; };

static void project_force(const void *context, const mpq_t *force, mpq_t *to)
{
	const struct projecting *p = context;
	const struct selection *s = p->s;
	const struct modes *modes = s->modes;
	RATIONALS *slopes = slopes_by_force(&modes->model->system, p->inverse, force);
	for (int i = 0; i < modes->count; i++) {
		const struct mode *mode = &modes->mode[i];
		if (!s->of[i])
			continue;
		RATIONALS *b = rationals(mode->states);
		drive(modes, mode, slopes, b);
		const int from = mode->moves ? mode->columns : 0;
		for (int j = from; j < mode->states; j++)
			mpq_set(to[s->first[i] + j - from], b[j]);
	}
}

/* ---- what the others follow at once ---- */

struct following {
	const struct modes *modes;
	const mpq_t *inverse;
	const struct mode *mode;
	mpq_t **c;                  /* per output: its row over z */
	struct output *output;      /* gets c P */
	bool minus;                 /* less c P instead */
};

static void add_rows(const struct following *f, int output, const mpq_t *x, mpq_ptr to)
{
	RATIONALS *sum = rationals(1);
	rational_product(1, f->mode->states, 1, f->c[output], x, sum);
	(f->minus ? mpq_sub : mpq_add)(to, to, sum[0]);
}

static mpq_srcptr frequency_of(const struct load *load)
{
	return oscillates(load->forcing) ? load->forcing->w : NULL;
}

static void follow_load(const struct following *f, int l, int segment)
{
	const struct linear *system = &f->modes->model->system;
	const struct load *load = &system->load[l];
	const int k = f->mode->states;
	const size_t cells = (size_t)load->columns * (size_t)k;
	RATIONALS *x = rationals(cells);
	const mpq_t *inverse = shifted_inverse(k, f->mode->block, load->forcing->a, frequency_of(load));
	for (int c = 0; c < load->columns && inverse; c++) {
		RATIONALS *slopes = slopes_by_force(system, f->inverse, load->force[c] + segment * system->n);
		drive(f->modes, f->mode, slopes, x + c * k);
	}
	if (!inverse)
		return;
	solve_forced(k, inverse, load, x);
	for (int o = 0; o < f->modes->model->outputs; o++)
		for (int c = 0; c < load->columns; c++)
			add_rows(f, o, x + c * k, f->output[o].load[l][c * system->segments + segment]);
}

/* -T^-1 B */
static void follow_input(const struct following *f, int input)
{
	const struct linear *system = &f->modes->model->system;
	const int k = f->mode->states;
	RATIONALS *b = rationals(k), *x = rationals(k);
	RATIONAL zero = ZERO;
	const mpq_t *inverse = shifted_inverse(k, f->mode->block, zero, NULL);
	for (int order = 0; order < 2 && inverse; order++) {
		RATIONALS *slopes = slopes_by_force(system, f->inverse, system->input[input].force[order]);
		drive(f->modes, f->mode, slopes, b);
		rational_product(k, k, 1, inverse, b, x);
		for (int o = 0; o < f->modes->model->outputs; o++)
			add_rows(f, o, x, f->output[o].input[order][input]);
	}
}

static mpq_t *row_over(const struct modes *modes, const struct mode *mode, const struct output *output)
{
	mpq_t *c = rationals(mode->states);
	rational_product(1, modes->model->system.states, mode->states, output->state, mode->right, c);
	return c;
}

/* The outputs get what this mode follows loads and inputs by; false: it was not found */
static bool follow(struct modes *modes, int index, const mpq_t *inverse, struct output *output, bool minus)
{
	const struct model *model = modes->model;
	struct following f = { .modes = modes, .inverse = inverse, .mode = &modes->mode[index], .output = output,
			       .minus = minus };
	bool any = false;
	if (!mode_refine(modes, index))
		return false;
	f.c = ARRAY(mpq_t *, model->outputs);
	for (int o = 0; o < model->outputs; o++) {
		f.c[o] = row_over(modes, f.mode, &model->output[o]);
		any = any || !rationals_zero((size_t)f.mode->states, f.c[o]);
	}
	for (int l = 0; l < model->system.loads && any; l++)
		for (int s = 0; s < model->system.segments; s++)
			follow_load(&f, l, s);
	for (int i = 0; i < model->system.inputs && any; i++)
		follow_input(&f, i);
	return true;
}

/* ---- the model ---- */

/* Rows over the states of the selection; of loads and inputs as they are, or 0 */
static struct output *rows_over(const struct selection *s, bool direct)
{
	const struct model *model = s->modes->model;
	const struct linear *system = &model->system;
	struct output *output = ARRAY(struct output, model->outputs);
	for (int o = 0; o < model->outputs; o++) {
		const struct output *of = &model->output[o];
		output[o] = *of;
		output[o].state = rationals(s->states);
		for (int i = 0; i < s->modes->count; i++) {
			if (!s->of[i])
				continue;
			RATIONALS *c = row_over(s->modes, &s->modes->mode[i], of);
			for (int j = 0; j < s->modes->mode[i].states; j++)
				mpq_swap(output[o].state[place_of(s, i, j)], c[j]);
		}
		output[o].load = ARRAY(mpq_t *, system->loads);
		for (int l = 0; l < system->loads; l++) {
			const size_t cells = (size_t)(system->load[l].columns * system->segments);
			output[o].load[l] = direct ? rationals_copied(cells, of->load[l]) : rationals(cells);
		}
		for (int k = 0; k < 2; k++)
			output[o].input[k] = direct ? rationals_copied(system->inputs, of->input[k])
				       : rationals(system->inputs);
	}
	return output;
}

/* mode3, mode3'; of a pair of poles that are not of a coordinate mode3_re, mode3_im; of several mode3a, mode3b */
static const char *state_name(const struct mode *mode, int i)
{
	const int c = mode->moves ? mode->columns : mode->states;
	const char *prime = i < c ? "" : "'";
	if (!mode->moves && mode->states == 2 && mode->rigid)
		return format("mode%d%s", mode->number, i ? "'" : "");
	if (!mode->moves && mode->states == 2 && mode->weight == 1)
		return format("mode%d_%s", mode->number, i ? "im" : "re");
	if (c == 1)
		return format("mode%d%s", mode->number, prime);
	return format("mode%d_%d%s", mode->number, i % c + 1, prime);
}

/* left y: exactly, of the rounded numbers of left */
static void project_start(const struct selection *s, mpq_t *initial)
{
	const struct model *model = s->modes->model;
	for (int i = 0; i < s->modes->count; i++) {
		const struct mode *mode = &s->modes->mode[i];
		if (!s->of[i])
			continue;
		RATIONALS *z = rationals(mode->states);
		drive(s->modes, mode, model->initial, z);
		for (int j = 0; j < mode->states; j++)
			mpq_swap(initial[place_of(s, i, j)], z[j]);
	}
}

/* Matrices between the states of the model and those of the selection: z = to y, and y = from z of what is kept */
static struct modal_truncation *modal_truncation_of(const struct selection *s, bool static_correction)
{
	const int states = s->modes->model->system.states, n = s->states;
	struct modal_truncation *of = NEW(struct modal_truncation);
	*of = (struct modal_truncation){ .modes = s->modes, .kept = s->of, .static_correction = static_correction };
	of->to = rationals((size_t)n * (size_t)states);
	of->from = rationals((size_t)n * (size_t)states);
	for (int i = 0; i < s->modes->count; i++) {
		const struct mode *mode = &s->modes->mode[i];
		for (int j = 0; s->of[i] && j < mode->states; j++)
			for (int k = 0; k < states; k++) {
				const int at = place_of(s, i, j);
				mpq_set(of->to[at * states + k], mode->left[j * states + k]);
				mpq_set(of->from[k * n + at], mode->right[k * mode->states + j]);
			}
	}
	return of;
}

/* `direct`: what outputs read of loads and inputs at once comes with them. */
static struct model *model_of(const struct selection *s, bool direct, bool static_correction)
{
	const struct model *model = s->modes->model;
	struct model *shorter = NEW(struct model);
	*shorter = *model;
	shorter->n = s->coords;
	shorter->system = shape_of(s);
	shorter->names.state = ARRAY(const char *, s->states);
	shorter->initial = rationals(s->states);
	for (int i = 0; i < s->modes->count; i++) {
		for (int j = 0; s->of[i] && j < s->modes->mode[i].states; j++)
			shorter->names.state[place_of(s, i, j)] = state_name(&s->modes->mode[i], j);
		if (s->of[i])
			fill_block(s, i, &shorter->system);
	}
	shorter->names.coord = shorter->names.state;
	take_forces(&shorter->system, &model->system, s->coords, project_force,
		    &(struct projecting){ s, inverse_of_leading(&model->system) });
	project_start(s, shorter->initial);
	shorter->equations.highest = ARRAY(struct output *, s->coords);
	shorter->output = rows_over(s, direct);
	shorter->reduction.truncated = modal_truncation_of(s, static_correction);
	shorter->reduction.place = ARRAY(int, model->system.states);
	for (int i = 0; i < model->system.states; i++)
		shorter->reduction.place[i] = -1;       /* no written state is a state */
	return shorter;
}

static bool follow_dropped(struct modes *modes, const bool *kept, struct output *output, bool minus)
{
	RATIONALS *inverse = inverse_of_leading(&modes->model->system);
	bool good = true;
	for (int i = 0; i < modes->count && good; i++)
		good = kept[i] || follow(modes, i, inverse, output, minus);
	return good;
}

struct model *modes_kept(struct modes *modes, const bool *kept, bool static_correction)
{
	struct selection s = { .modes = modes, .of = kept };
	if (!select_modes(&s) || s.states == 0)
		return NULL;
	struct model *shorter = model_of(&s, true, static_correction);
	if (static_correction && !follow_dropped(modes, kept, shorter->output, false))
		return NULL;
	return shorter;
}

struct model *modes_dropped(struct modes *modes, const bool *kept, bool static_correction)
{
	bool *dropped = ARRAY(bool, modes->count);
	struct selection s = { .modes = modes, .of = dropped };
	for (int i = 0; i < modes->count; i++)
		dropped[i] = !kept[i];
	if (!select_modes(&s) || s.states == 0)
		return NULL;
	struct model *error = model_of(&s, false, false);
	if (static_correction && !follow_dropped(modes, kept, error->output, true))
		return NULL;
	return error;
}

double truncation_of_modes(const struct modes *modes, const bool *kept, bool static_correction, int output)
{
	double sum = 0;
	for (int i = 0; i < modes->count; i++)
		if (!kept[i])
			sum += static_correction ? modes->mode[i].transient[output] : modes->mode[i].size[output];
	return sum * (1 + 1e-9);        /* for the rounding of all that */
}

/* ---- the statement ---- */

static void put_modes(struct modes *modes, bool *kept, const struct wanted_modes *wanted)
{
	const int *order = modes_by_share(modes);
	int count = 0, rigid = 0;
	for (int i = 0; i < modes->count; i++) {
		const struct mode *mode = &modes->mode[i];
		rigid += mode->rigid && mode->seen ? mode->weight : 0;
	}
	if (rigid > wanted->number[0])
		error(wanted->at, "a rigid-body mode is never dropped where an output sees it",
		      "%d rigid mode%s seen by the outputs: no fewer can be kept", rigid,
		      rigid > 1 ? "s are" : " is");
	for (int i = 0; i < modes->count && count < wanted->number[0]; i++) {
		const struct mode *mode = &modes->mode[order[i]];
		kept[order[i]] = mode->seen;
		count += mode->seen ? mode->weight : 0;
	}
}

/* The mode that has this number */
static int mode_of_number(const struct modes *modes, int number)
{
	for (int i = 0; i < modes->count; i++)
		if (number < modes->mode[i].number + modes->mode[i].weight)
			return i;
	return -1;
}

static int modes_in(const struct modes *modes)
{
	const struct mode *last = &modes->mode[modes->count - 1];
	return last->number + last->weight - 1;
}

static void put_listed(struct modes *modes, bool *kept, const struct wanted_modes *wanted)
{
	for (int i = 0; i < wanted->count; i++) {
		const int index = mode_of_number(modes, wanted->number[i]);
		if (index < 0)
			error(wanted->at, NULL, "there is no mode %d: the model has %d", wanted->number[i],
			      modes_in(modes));
		kept[index] = true;
	}
	for (int i = 0; i < modes->count; i++)
		if (modes->mode[i].rigid && modes->mode[i].seen && !kept[i])
			error(wanted->at, "a rigid-body mode is never dropped where an output sees it",
			      "mode %d is rigid and seen by an output: it has to be kept", modes->mode[i].number);
}

/* The statement `modes`, or --modes in its place */
void evaluate_modes(void *context)
{
	struct building *b = context;
	struct wanted_modes *wanted = &b->model->modes;
	struct mode_list list = b->spec->modes;
	if (b->request->modes)
		list = parse_mode_list(b->spec, source_argument(b->request->modes));
	if (!list.at.source)
		abandon();
	if (b->spec->states.ranges > 0)
		error(b->spec->states.range[0].at, NULL, "'modes' leaves no states as written, of which a range is");
	*wanted = (struct wanted_modes){ list.at, list.count, ARRAY(int, list.count), list.each,
					 !list.without_static };
	for (int i = 0; i < list.count; i++) {
		wanted->number[i] = whole_number(b, list.number[i], 1, LIMIT_STATES,
						 list.each ? "the number of a mode" : "a count of modes");
		for (int j = 0; j < i; j++)
			if (wanted->number[j] == wanted->number[i])
				error(list.number[i]->start, NULL, "mode %d is in the list already", wanted->number[i]);
	}
}

struct truncated { struct model *model, *shorter; };

static void truncate_modes(void *context)
{
	struct truncated *s = context;
	const struct wanted_modes *wanted = &s->model->modes;
	const char *why;
	struct modes *modes = modes_of(s->model, &why);
	if (!modes)
		error(wanted->at, NULL, "modes cannot be left out: %s", why);
	if (!wanted->each && wanted->number[0] > modes_in(modes))
		error(wanted->at, NULL, "%d modes cannot be kept: the model has %d", wanted->number[0],
		      modes_in(modes));
	bool *kept = ARRAY(bool, modes->count);
	(wanted->each ? put_listed : put_modes)(modes, kept, wanted);
	bool any = false;
	for (int i = 0; i < modes->count; i++)
		any = any || kept[i];
	if (!any)
		error(wanted->at, NULL, "nothing would be left: no output sees a mode that anything reaches");
	s->shorter = modes_kept(modes, kept, wanted->static_correction);
	if (!s->shorter)
		error(wanted->at, NULL, "modes cannot be left out: two poles are too close for double precision");
}

struct model *model_truncate(struct model *model)
{
	struct truncated s = { model, NULL };
	if (!model->modes.at.source)
		return model;
	return statement_guard(truncate_modes, &s) ? s.shorter : NULL;
}
