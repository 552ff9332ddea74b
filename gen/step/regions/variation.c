/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of the tables of regions by params. The model is built twice more, with the param a little larger and a
 * little smaller, and the numbers of both are exact: half of their difference is the derivative but for 2^-160 of it,
 * and rounded once. Where one of the two is no model, as beyond a restitution of 1, the model itself is in its place,
 * and that is 2^-80. */
#include "guards.h"
#include "inner.h"
#include "model/contacts/contacts.h"
#include "model/tunable/elsewhere.h"

enum { APART = 80, LOST = 40 };     /* the param moves by 2^-80; what is smaller than 2^-40 of that is no change */

/* ---- the model elsewhere ---- */

struct elsewhere_once {
	const struct model *model;
	const char *name;
	mpq_srcptr value;
	const struct model *found;
};

static void build_once(void *context)
{
	struct elsewhere_once *s = context;
	struct request request = s->model->request;
	request.again.varied = s->name;
	request.again.value = s->value;
	struct spec *spec = parse_spec(s->model->spec->source);
	spec->units.adopted = true;             /* units have been looked at */
	s->found = model_build(spec, &request);
	if (!s->found)
		abandon();
}

static const struct model *model_at(const struct model *model, const char *name, mpq_srcptr value)
{
	struct elsewhere_once s = { .model = model, .name = name, .value = value };
	return silent_guard(build_once, &s) ? s.found : NULL;
}

static bool same_shape(const struct linear *a, const struct linear *b)
{
	bool same = a->states == b->states && a->loads == b->loads && a->segments == b->segments;
	for (int l = 0; l < a->loads && same; l++)
		same = a->load[l].powers == b->load[l].powers && a->load[l].columns == b->load[l].columns;
	return same;
}

static bool same_regions(const struct switching *a, const struct switching *b)
{
	bool same = a->functions == b->functions && a->segments == b->segments && a->regions == b->regions &&
		    a->systems == b->systems && a->impacts == b->impacts && a->parts == b->parts;
	for (int e = 0; e < a->functions && same; e++)
		same = a->function[e].breaks == b->function[e].breaks;
	for (int r = 0; r < a->regions && same && a->region; r++)
		same = a->region[r].possible == b->region[r].possible &&
		       (!a->region[r].possible || a->region[r].system == b->region[r].system);
	for (int p = 0; p < a->parts && same; p++)
		same = same_shape(&a->part[p].model->system, &b->part[p].model->system) &&
		       same_regions(a->part[p].model->switching, b->part[p].model->switching);
	return same;
}

static bool same_model(const struct model *a, const struct model *b)
{
	return b && same_shape(&a->system, &b->system) && !a->switching == !b->switching &&
	       (!a->switching || same_regions(a->switching, b->switching));
}

static struct varied_model vary(const struct model *model, const struct sensitivity *by)
{
	struct varied_model v = { .more = model, .less = model };
	RATIONAL apart = ZERO, value = ZERO;
	mpq_init(v.apart);
	if (by->symbol->kind != SYMBOL_PARAM)
		return v;
	param_value(by->symbol, value);
	mpq_abs(apart, value);
	if (mpq_sgn(apart) == 0)
		mpq_set_ui(apart, 1, 1);
	mpq_div_2exp(apart, apart, APART);
	for (int side = 0; side < 2; side++) {
		mpq_t *there = rationals(1);
		(side ? mpq_sub : mpq_add)(*there, value, apart);
		const struct model *found = model_at(model, by->symbol->name, *there);
		if (!same_model(model, found))
			continue;
		*(side ? &v.less : &v.more) = found;
		mpq_add(v.apart, v.apart, apart);
	}
	if (mpq_sgn(v.apart) == 0)
		error(by->at, NULL, "no derivative is by '%s' here: with another value of it the model has other "
		      "regions, other events or other loads", by->name);
	if (!mpq_equal(v.more->h, v.less->h))
		error(by->at, "--step gives the step another way", "the step follows from '%s'", by->name);
	return v;
}

struct varied_model *varied_models(const struct step *step, const struct model *model)
{
	const struct derivatives *d = step->derivatives;
	struct varied_model *v = ARRAY(struct varied_model, (size_t)d->columns);
	for (int i = 0; i < d->columns; i++)
		v[i] = vary(model, &d->column[i]);
	return v;
}

static bool is_below(mpq_srcptr number, mpq_srcptr size)
{
	RATIONAL sum = ZERO;
	mpq_add(sum, number, size);
	return mpq_sgn(sum) > 0 && mpq_cmp(number, size) < 0;
}

static bool find_change(const struct varied_model *v, mpq_srcptr more, mpq_srcptr less, mpq_ptr change)
{
	RATIONAL size = ZERO;
	mpq_set_ui(change, 0, 1);
	if (mpq_equal(more, less))
		return false;
	mpq_sub(change, more, less);
	mpq_abs(size, more);
	mpq_div_2exp(size, size, APART + LOST);
	if (mpq_sgn(more) != 0 && mpq_sgn(less) != 0 && is_below(change, size))
		mpq_set_ui(change, 0, 1);
	else
		mpq_div(change, change, v->apart);
	return mpq_sgn(change) != 0;
}

double varied_number(const struct varied_model *v, mpq_srcptr more, mpq_srcptr less)
{
	RATIONAL change = ZERO;
	return find_change(v, more, less, change) ? round_rational(change) : 0;
}

/* ---- a part's tables ---- */

static const struct model *part_of(const struct model *model, int part)
{
	return part < 0 ? model : model->switching->part[part].model;
}

static struct listing listing_of(const struct step *step, const struct model *model)
{
	return list_rows(model, &step->layout, step->shown->model->system.segments);
}

struct reader {                     /* of one column the rows there and there */
	const struct varied_model *v;
	struct listing more, less;
	struct variation *to;
};

static void add_entry(struct variation *to, int row, int column, double value)
{
	if (value != 0)
		*MORE(to->entry, to->entries) = (struct varied_entry){ row, column, value };
}

static int place_of(const struct listing *l, enum retuned_kind kind, int of, int index)
{
	for (int i = 0; i < l->rows; i++)
		if (l->row[i].kind == kind && l->row[i].of == of && l->row[i].index == index)
			return i;
	abandon();
}

/* sign: 1 or -1 of the row as it is listed */
static void add_row_of(struct reader *r, int row, enum retuned_kind kind, int of, int index, double sign)
{
	const int size = r->more.x->size, from = place_of(&r->more, kind, of, index) * size;
	for (int j = 0; j < size; j++)
		add_entry(r->to, row, j,
			  sign * varied_number(r->v, r->more.entry[from + j], r->less.entry[from + j]));
}

static void add_break(struct reader *r, int row, int function, int breakpoint, double sign)
{
	const int size = r->more.x->size, from = place_of(&r->more, RETUNED_BREAK, function, breakpoint) * size;
	add_entry(r->to, row, size, sign * varied_number(r->v, r->more.entry[from], r->less.entry[from]));
}

static void end_block(struct variation *to)
{
	ENLARGE(to->first, (size_t)to->blocks + 2);
	to->first[++to->blocks] = to->entries;
}

static void add_functions(struct reader *r, const struct switching *s)
{
	for (int segment = 0; segment < s->segments; segment++)
		for (int e = 0; e < s->functions; e++)
			add_row_of(r, segment * s->functions + e, RETUNED_FUNCTION, segment, e, 1);
	end_block(r->to);
	for (int e = 0, place = 0; e < s->functions; e++)
		for (int k = 0; k < s->function[e].breaks; k++)
			add_break(r, place++, e, k, 1);
	end_block(r->to);
}

static void add_guards(struct reader *r, const struct switching *s, const struct guards *g)
{
	for (int region = 0; g && region < s->regions; region++)
		for (int k = g->first[region]; k < g->first[region + 1]; k++) {
			const struct guard *guard = &g->guard[k];
			const double sign = guard->upward ? 1 : -1;
			if (guard->release >= 0) {
				add_row_of(r, k, RETUNED_RELEASE, region, guard->release, 1);
				continue;
			}
			add_row_of(r, k, RETUNED_FUNCTION, segment_of_region(s, region), guard->function, sign);
			add_break(r, k, guard->function, guard->breakpoint, sign);
		}
	end_block(r->to);
	for (int k = 0; g && k < g->assignments; k++)
		add_row_of(r, k, g->assignment[k].kind, g->assignment[k].of, g->assignment[k].index, 1);
	end_block(r->to);
}

static void add_changes(struct reader *r, const struct model *more, const struct model *less)
{
	for (int k = 0; k + 1 < more->system.segments; k++)
		add_entry(r->to, k, r->more.x->size,
			  varied_number(r->v, more->system.change[k], less->system.change[k]));
	end_block(r->to);
}

/* Of e^{A h}, size x size (Van Loan 1978): it stands in the lower rows of that of [A, 0; A_p, A].  false: unknown */
static bool add_step(struct reader *r, const struct listing *own, int branch, double *over)
{
	const int n = own->x->size, from = place_of(own, RETUNED_SYSTEM, branch, 0) * n,
		  more = place_of(&r->more, RETUNED_SYSTEM, branch, 0) * n,
		  less = place_of(&r->less, RETUNED_SYSTEM, branch, 0) * n;
	mpq_t *Z = rationals((size_t)(4 * n * n));
	INTERVAL value = OVER_BITS(320);
	bool any = false;
	for (int i = 0; i < n * n; i++) {
		const int cell = i / n * 2 * n + i % n;
		mpq_set(Z[cell], own->entry[from + i]);
		mpq_set(Z[cell + 2 * n * n + n], own->entry[from + i]);
		any |= find_change(r->v, r->more.entry[more + i], r->less.entry[less + i], Z[cell + 2 * n * n]);
	}
	struct taylor *t = any ? taylor_of(2 * n, Z, own->model->h) : NULL;
	if (any && !taylor_enclose(t, 256))
		return false;
	for (int i = 0; i < n * n && any; i++) {
		taylor_entry(t, n + i / n, i % n, value);
		over[i] = mpfi_get_d(value);
	}
	return true;
}

/* Tables of all columns and matrices, unless they would be large; rows of a matrix stand one after the other */
static double *steps_of(const struct step *step, int part)
{
	const struct derivatives *d = step->shown->derivatives;
	const int cells = step->layout.size * step->layout.size;
	const struct listing own = listing_of(step, step->model);
	if (d->columns * step->branches > LIMIT_TUNED_NUMBERS / cells)
		return NULL;
	double *over = ARRAY(double, (size_t)(d->columns * step->branches * cells)), *to = over;
	for (int p = 0; p < d->columns; p++) {
		const struct varied_model *v = &d->varied[p];
		struct reader r = { v, listing_of(step, part_of(v->more, part)),
				    listing_of(step, part_of(v->less, part)), NULL };
		for (int k = 0; k < step->branches; k++, to += cells)
			if (!add_step(&r, &own, k, to))
				return NULL;
	}
	return over;
}

struct variation variation_of(const struct step *step, int part, const struct guards *g)
{
	const struct derivatives *d = step->shown->derivatives;
	const struct switching *s = step->model->switching;
	struct variation to = { .first = ARRAY(int, 1) };
	for (int p = 0; p < d->columns; p++) {
		const struct varied_model *v = &d->varied[p];
		struct reader r = { v, listing_of(step, part_of(v->more, part)),
				    listing_of(step, part_of(v->less, part)), &to };
		for (int k = 0; k < step->branches; k++) {
			for (int i = 0; i < step->layout.size; i++)
				add_row_of(&r, i, RETUNED_SYSTEM, k, i, 1);
			end_block(&to);
		}
		add_functions(&r, s);
		add_guards(&r, s, g);
		add_changes(&r, v->more, v->less);
	}
	to.over = steps_of(step, part);
	return to;
}

void vary_start(const struct step *step, int column, double *value)
{
	const struct varied_model *v = &step->derivatives->varied[column];
	const struct sensitivity *by = &step->derivatives->column[column];
	const struct linear *system = &step->model->system;
	for (int i = 0; i < system->states; i++) {
		const struct symbol *coord = step->model->frame.coord[system->coord[i]];
		const int component = coord->length ? system->coord[i] - coord->index + 1 : 0;
		value[i] = varied_number(v, v->more->initial[i], v->less->initial[i]);
		if (by->symbol == coord && by->component == component && by->primes == (i >= step->model->n))
			value[i] = 1;
	}
}

/* ---- outputs ---- */

static mpq_t *output_row(const struct model *model, const struct layout *x, int output, int segment)
{
	mpq_t *row = rationals((size_t)x->size);
	row_of_output(x, &model->system, &model->output[output], model->system.segments, segment, row);
	return row;
}

struct variation variation_of_outputs(const struct step *step, const struct layout *x)
{
	struct variation to = { .first = ARRAY(int, 1) };
	for (int p = 0; p < step->derivatives->columns; p++)
		for (int segment = 0; segment < step->model->system.segments; segment++) {
			const struct varied_model *v = &step->derivatives->varied[p];
			for (int o = 0; o < step->model->outputs; o++) {
				mpq_t *more = output_row(v->more, x, o, segment);
				mpq_t *less = output_row(v->less, x, o, segment);
				for (int j = 0; j < x->size; j++)
					add_entry(&to, o, j, varied_number(v, more[j], less[j]));
			}
			end_block(&to);
		}
	return to;
}
