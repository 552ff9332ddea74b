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

/* Where the target makes tables anew, it has no other values of params that are not tunable: of these what is about
 * loads may vary, and initial values. */
static void check_loads_alone(const struct varied_model *v, const struct sensitivity *by, const struct layout *x)
{
	const struct listing more = list_rows(v->more, x, v->more->system.segments),
			     less = list_rows(v->less, x, v->less->system.segments);
	bool same = more.rows == less.rows;
	for (int i = 0; i < more.rows && same; i++)
		for (int j = 0; j < x->size && same; j++)
			same = (more.row[i].kind == RETUNED_SYSTEM && more.row[i].index >= v->more->system.states) ||
			       mpq_equal(more.entry[i * x->size + j], less.entry[i * x->size + j]);
	if (!same)
		error(by->at, format("tunable %s", by->name), "beside tunable params a sensitivity of regions is by "
		      "tunable ones: '%s' stands in numbers that the target makes anew", by->name);
}

static struct varied_model vary(const struct model *model, const struct sensitivity *by)
{
	struct varied_model v = { .more = model, .less = model };
	RATIONAL apart = ZERO, value = ZERO;
	mpq_init(v.apart);
	if (by->symbol->kind != SYMBOL_PARAM || by->symbol->tuning.number)
		return v;
	if (by->symbol->tuning.tuned)
		error(by->at, NULL, "'%s' is made of tunable params: a sensitivity is by these", by->name);
	param_value(by->symbol, value);
	mpq_abs(apart, value);
	if (mpq_sgn(apart) == 0)
		mpq_set_ui(apart, 1, 1);
	mpq_div_2exp(apart, apart, APART);
	for (int side = 0; side < 2; side++) {
		mpq_t *there = rationals(1);
		(side ? mpq_sub : mpq_add)(*there, value, apart);
		const struct model *found = model_at(model, by->symbol->name, *there);
		if (!same_model(!model->params.retuned ? model : side ? v.more : found, found))
			continue;                   /* equal systems of what is retuned are one, here alone */
		*(side ? &v.less : &v.more) = found;
		mpq_add(v.apart, v.apart, apart);
	}
	if (mpq_sgn(v.apart) == 0)
		error(by->at, NULL, "no derivative is by '%s' here: with another value of it the model has other "
		      "regions, other events or other loads", by->name);
	if (!mpq_equal(v.more->h, v.less->h))
		error(by->at, "--step gives the step another way", "the step follows from '%s'", by->name);
	if (model->params.retuned)
		check_loads_alone(&v, by, &model->params.retuned->x);
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

int tunable_of_column(const struct step *step, int column)
{
	const struct symbol *by = step->shown->derivatives->column[column].symbol;
	return by->kind == SYMBOL_PARAM ? by->tuning.number - 1 : NONE;
}

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
	const struct tuning *retuned;
	struct rates *rates;        /* where it is by a tunable param */
};

static void add_entry(struct variation *to, int row, int column, double value)
{
	if (value != 0)
		*MORE(to->entry, to->entries) = (struct varied_entry){ row, column, value, { .number = NONE } };
}

static int place_of(const struct listing *l, enum retuned_kind kind, int of, int index)
{
	for (int i = 0; i < l->rows; i++)
		if (l->row[i].kind == kind && l->row[i].of == of && l->row[i].index == index)
			return i;
	abandon();
}

/* ---- that the target makes anew: the slopes of the numbers of a record ---- */

struct rates { mpq_t value, slope; bool varies; };

static void rate_part(const struct rates *all, const struct traced_part *part, struct rates *to)
{
	mpq_init(to->value);
	mpq_init(to->slope);
	to->varies = part->number >= 0 && all[part->number].varies;
	mpq_set(to->value, part->number >= 0 ? all[part->number].value : part->constant);
	if (part->number >= 0)
		mpq_set(to->slope, all[part->number].slope);
	if (part->negative) {
		mpq_neg(to->value, to->value);
		mpq_neg(to->slope, to->slope);
	}
}

static void operate(enum traced_op op, const struct rates *a, const struct rates *b, struct rates *to)
{
	RATIONAL other = ZERO;
	if (op == TRACED_SUM) {
		mpq_add(to->value, a->value, b->value);
		mpq_add(to->slope, a->slope, b->slope);
		return;
	}
	if (op == TRACED_PRODUCT) {
		mpq_mul(to->value, a->value, b->value);
		mpq_mul(to->slope, a->slope, b->value);
		mpq_mul(other, a->value, b->slope);
		mpq_add(to->slope, to->slope, other);
		return;
	}
	if (mpq_sgn(b->value) == 0)
		abandon();
	mpq_div(to->value, a->value, b->value);
	mpq_mul(other, to->value, b->slope);
	mpq_sub(to->slope, a->slope, other);
	mpq_div(to->slope, to->slope, b->value);
}

/* What is given: a param, or what follows from some */
static void rate_given(const struct step *step, int column, const struct traced *n, struct rates *to)
{
	const struct tuning *t = step->model->params.retuned;
	const struct derivatives *d = step->shown->derivatives;
	struct symbol *symbol = t->param[n->a.number].symbol;
	mpq_set(to->value, t->nominal[n->a.number]);
	to->varies = n->a.number == tunable_of_column(step, column);
	mpq_set_si(to->slope, to->varies, 1);
	if (symbol->tuning.derived) {
		struct collector collector = { .scheme = "exact" };
		struct node *slope = slope_by_param(step->model->spec, &d->column[column], symbol->value);
		to->varies = !is_zero_node(slope);
		collect_constant(&collector, slope, to->slope);
	}
	if (n->a.negative) {
		mpq_neg(to->value, to->value);
		mpq_neg(to->slope, to->slope);
	}
}

/* At the spec's values, by a tunable param */
static struct rates *rates_by(const struct step *step, int column)
{
	const struct tuning *t = step->model->params.retuned;
	struct rates *all = ARRAY(struct rates, (size_t)t->numbers + 1);
	for (int i = 0; i < t->numbers; i++) {
		const struct traced *n = &t->number[i];
		mpq_init(all[i].value);
		mpq_init(all[i].slope);
		if (n->op == TRACED_GIVEN) {
			rate_given(step, column, n, &all[i]);
			continue;
		}
		struct rates a = { .varies = false }, b = a;
		rate_part(all, &n->a, &a);
		rate_part(all, &n->b, &b);
		all[i].varies = a.varies || b.varies;
		operate(n->op, &a, &b, &all[i]);
	}
	return all;
}

static void add_made(struct reader *r, const struct tuned_entry *entry, int row, int column, double sign)
{
	const struct traced_part *made = &entry->value;
	if (made->number < 0 || !r->rates[made->number].varies)
		return;
	const bool negative = made->negative != (sign < 0);
	const double slope = round_rational(r->rates[made->number].slope);
	*MORE(r->to->entry, r->to->entries) = (struct varied_entry){ row, column, negative ? -slope : slope,
								     { made->number, negative, NULL } };
}

/* column: NONE: as it is */
static void add_retuned(struct reader *r, int row, enum retuned_kind kind, int of, int index, int column, double sign)
{
	const struct tuned_equations *from = kind == RETUNED_SYSTEM ? &r->retuned->system[of] : &r->retuned->all;
	const int place = kind == RETUNED_SYSTEM ? index : retuned_place(r->retuned, kind, of, index);
	for (int i = 0; i < from->entries && r->rates; i++)
		if (from->entry[i].row == place)
			add_made(r, &from->entry[i], row, column < 0 ? from->entry[i].column : column, sign);
	if (r->rates || kind != RETUNED_SYSTEM || index < r->v->more->system.states)
		return;
	/* Loads are the same in all systems of a segment of time. */
	const int size = r->more.x->size, at = place_of(&r->more, kind, 0, index) * size;
	for (int j = 0; j < size; j++)
		add_entry(r->to, row, j, varied_number(r->v, r->more.entry[at + j], r->less.entry[at + j]));
}

/* ---- rows ---- */

/* sign: 1 or -1 of the row as it is listed */
static void add_row_of(struct reader *r, int row, enum retuned_kind kind, int of, int index, double sign)
{
	if (r->retuned) {
		add_retuned(r, row, kind, of, index, NONE, sign);
		return;
	}
	const int size = r->more.x->size, from = place_of(&r->more, kind, of, index) * size;
	for (int j = 0; j < size; j++)
		add_entry(r->to, row, j,
			  sign * varied_number(r->v, r->more.entry[from + j], r->less.entry[from + j]));
}

static void add_break(struct reader *r, int row, int function, int breakpoint, double sign)
{
	if (r->retuned) {
		add_retuned(r, row, RETUNED_BREAK, function, breakpoint, r->more.x->size, sign);
		return;
	}
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

/* What A of a linear system varies by: where the target makes it anew, of the numbers that it makes.  false: nothing */
static bool read_change(const struct reader *r, const int *block, int branch, mpq_t *change)
{
	const int n = r->more.x->size, from = place_of(&r->more, RETUNED_SYSTEM, branch, 0) * n,
		  less = place_of(&r->less, RETUNED_SYSTEM, branch, 0) * n;
	bool any = false;
	if (!r->retuned) {
		for (int i = 0; i < n * n; i++)
			any |= find_change(r->v, r->more.entry[from + i], r->less.entry[less + i], change[i]);
		return any;
	}
	for (int k = block[0]; k < block[1]; k++, any = true)
		mpq_set_d(change[r->to->entry[k].row * n + r->to->entry[k].column], r->to->entry[k].value);
	return any;
}

/* Of e^{A h}, size x size (Van Loan 1978): it stands in the lower rows of that of [A, 0; A_p, A].  false: unknown */
static bool add_step(const struct reader *r, const struct listing *own, const int *block, int branch, double *over)
{
	const int n = own->x->size, from = place_of(own, RETUNED_SYSTEM, branch, 0) * n;
	mpq_t *Z = rationals((size_t)(4 * n * n)), *change = rationals((size_t)(n * n));
	INTERVAL value = OVER_BITS(320);
	const bool any = read_change(r, block, branch, change);
	for (int i = 0; i < n * n; i++) {
		const int cell = i / n * 2 * n + i % n;
		mpq_set(Z[cell], own->entry[from + i]);
		mpq_set(Z[cell + 2 * n * n + n], own->entry[from + i]);
		mpq_set(Z[cell + 2 * n * n], change[i]);
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
static double *steps_of(const struct step *step, int part, struct variation *to)
{
	const struct derivatives *d = step->shown->derivatives;
	const int cells = step->layout.size * step->layout.size;
	const struct listing own = listing_of(step, step->model);
	if (d->columns * step->branches > LIMIT_TUNED_NUMBERS / cells)
		return NULL;
	double *over = ARRAY(double, (size_t)(d->columns * step->branches * cells)), *at = over;
	for (int p = 0; p < d->columns; p++) {
		const struct varied_model *v = &d->varied[p];
		const struct reader r = { v, listing_of(step, part_of(v->more, part)),
					  listing_of(step, part_of(v->less, part)), to, step->model->params.retuned,
					  NULL };
		for (int k = 0; k < step->branches; k++, at += cells)
			if (!add_step(&r, &own, to->first + p * (step->branches + VARIED_TABLES) + k, k, at))
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
				    listing_of(step, part_of(v->less, part)), &to, step->model->params.retuned,
				    NULL };
		if (r.retuned && tunable_of_column(step, p) >= 0)
			r.rates = rates_by(step, p);
		for (int k = 0; k < step->branches; k++) {
			for (int i = 0; i < step->layout.size; i++)
				add_row_of(&r, i, RETUNED_SYSTEM, k, i, 1);
			end_block(&to);
		}
		add_functions(&r, s);
		add_guards(&r, s, g);
		add_changes(&r, v->more, v->less);
	}
	to.over = steps_of(step, part, &to);
	return to;
}

/* Of the states as written */
void vary_start(const struct step *step, int column, double *value)
{
	const struct model *written = step->model->relative ? step->model->written : step->model;
	const struct sensitivity *by = &step->derivatives->column[column];
	const struct varied_model v = written == step->model ? step->derivatives->varied[column] : vary(written, by);
	for (int i = 0; i < written->system.states; i++) {
		const int at = written->system.coord[i];
		const struct symbol *coord = written->frame.coord[at];
		const int component = coord->length ? at - coord->index + 1 : 0;
		value[i] = varied_number(&v, v.more->initial[i], v.less->initial[i]);
		if (by->symbol == coord && by->component == component && by->primes == (i >= written->n))
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
				if (step->model->output[o].slopes)
					continue;
				mpq_t *more = output_row(v->more, x, o, segment);
				mpq_t *less = output_row(v->less, x, o, segment);
				for (int j = 0; j < x->size; j++)
					add_entry(&to, o, j, varied_number(v, more[j], less[j]));
			}
			end_block(&to);
		}
	return to;
}
