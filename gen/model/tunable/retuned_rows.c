/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All numbers of a model that params may change, row by row over x, in one order for all values of params: what of them
 * changes is found by comparing such lists. Highest derivatives, outputs of linear models, what regions have. */
#include "inner.h"
#include "model/contacts/contacts.h"

/* ---- of any model ---- */

void row_of_output(const struct layout *x, const struct linear *system, const struct output *output, int segments,
		   int segment, mpq_t *row)
{
	for (int i = 0; i < system->states; i++)
		mpq_set(row[i], output->state[i]);
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns && x->load[l] >= 0; k++)
			for (int s = 0; s < x->segments; s++)
				mpq_set(row[x->load[l] + s * x->loads + k],
					output->load[l][k * segments + (x->segments > 1 ? s : segment)]);
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k <= system->input[i].hold && k < 2; k++)
			mpq_set(row[x->input[i] + k], output->input[k][i]);
}

/* ---- a list of them ---- */

static mpq_t *add_row(struct listing *l, enum retuned_kind kind, int of, int index)
{
	size_t size = (size_t)l->x->size, cells = (size_t)l->rows * size;
	ENLARGE(l->row, (size_t)l->rows + 1);
	ENLARGE(l->entry, cells + size);
	for (size_t j = 0; j < size; j++)
		mpq_init(l->entry[cells + j]);
	l->row[l->rows++] = (struct retuned_row){ .kind = kind, .of = of, .index = index, .place = -1 };
	return l->entry + cells;
}

static void add_number(struct listing *l, enum retuned_kind kind, int of, int index, mpq_srcptr value)
{
	mpq_set(add_row(l, kind, of, index)[0], value);
}

static void list_output(struct listing *l, enum retuned_kind kind, int of, int index, const struct output *row,
			int segment)
{
	mpq_t *entry = add_row(l, kind, of, index);
	row_of_output(l->x, &l->model->system, row, l->segments, segment, entry);
}

static void list_system(struct listing *l, int index)
{
	const struct linear *system = l->model->switching ? &l->model->switching->system[index] : &l->model->system;
	const int first = l->rows, size = l->x->size;
	RATIONALS *A = augmented_matrix(l->x, system, 0);
	for (int i = 0; i < size; i++)
		add_row(l, RETUNED_SYSTEM, index, i);
	for (int i = 0; i < size * size; i++)
		mpq_swap(l->entry[first * size + i], A[i]);
}

static void list_linear(struct listing *l)
{
	for (int o = 0; o < l->model->outputs; o++)
		list_output(l, RETUNED_OUTPUT, 0, o, &l->model->output[o], 0);
}

/* ---- of regions ---- */

static void list_switching_functions(struct listing *l)
{
	const struct switching *s = l->model->switching;
	for (int segment = 0; segment < s->segments; segment++)
		for (int e = 0; e < s->functions; e++)
			list_output(l, RETUNED_FUNCTION, segment, e, s->function[e].row, segment);
	for (int e = 0; e < s->functions; e++)
		for (int k = 0; k < s->function[e].breaks; k++)
			add_number(l, RETUNED_BREAK, e, k, s->function[e].at[k]);
}

static void list_region(struct listing *l, int index)
{
	const struct switching *s = l->model->switching;
	const struct region *region = &s->region[index];
	for (int k = 0; k < region->holds; k++)
		list_output(l, RETUNED_HOLD, index, k, region->hold[k].row, 0);
	for (int k = 0; k < region->releases; k++)
		list_output(l, RETUNED_RELEASE, index, k, region->release[k].row, 0);
	for (int k = 0; k < s->transmitted_forces && region->friction_force; k++)
		if (region->friction_force[k])
			list_output(l, RETUNED_FRICTION, index, k, region->friction_force[k], 0);
}

static void list_jumps(struct listing *l, int index, enum retuned_kind kind, const struct impact_law *impact_law,
		       const struct jump *jump)
{
	for (int k = 0; k < impact_law->jumps; k++)
		list_output(l, kind, index, k, jump[k].row, 0);
}

/* One of them in a segment of time; the number of both is `index` */
static void list_impact(struct listing *l, int index)
{
	const struct switching *s = l->model->switching;
	const struct impact *impact = &s->impact[index % s->impacts];
	const struct impact_law *impact_law = &impact->in[index / s->impacts];
	list_jumps(l, index, RETUNED_JUMP, impact_law, impact_law->jump);
	if (impact->bounces) {
		list_jumps(l, index, RETUNED_STILL, impact_law, impact_law->still);
		list_output(l, RETUNED_SPEED, index, 0, impact_law->speed_row, 0);
		mpq_t *back = add_row(l, RETUNED_BACK, index, 0);
		for (int j = 0; j < l->model->n; j++)
			mpq_mul(back[j], impact_law->direction[j], impact_law->factor);
		add_number(l, RETUNED_RESTITUTION, index, 0, impact_law->restitution);
		add_number(l, RETUNED_LEAST, index, 0, impact_law->gap);
	}
}

/* What has to stay above or below 0; breakpoints their order */
static void list_signs(struct listing *l)
{
	const struct switching *s = l->model->switching;
	int count = 0;
	RATIONAL difference = ZERO;
	for (int e = 0; e < s->functions; e++)
		for (int k = 1; k < s->function[e].breaks; k++) {
			mpq_sub(difference, s->function[e].at[k], s->function[e].at[k - 1]);
			if (mpq_sgn(difference) != 0)
				add_number(l, RETUNED_SIGN, count++, 0, difference);
		}
	for (int i = 0; i < s->signs; i++)
		add_number(l, s->sign[i].least ? RETUNED_LEAST : RETUNED_SIGN, count++, 1, s->sign[i].number);
}

static void list_regions(struct listing *l)
{
	const struct switching *s = l->model->switching;
	list_switching_functions(l);
	for (int r = 0; r < s->regions; r++)
		if (s->region[r].possible)
			list_region(l, r);
	for (int i = 0; i < s->segments * s->impacts; i++)
		list_impact(l, i);
	list_signs(l);
}

struct listing list_rows(const struct model *model, const struct layout *x, int segments)
{
	const int systems = model->switching ? model->switching->systems : 1;
	struct listing l = { .model = model, .x = x, .segments = segments };
	for (int k = 0; k < systems; k++)
		list_system(&l, k);
	(model->switching ? list_regions : list_linear)(&l);
	return l;
}
