/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params that change the matrices of regions: stiffness, damping, mass, restitution. What a held input can be,
 * a gap or a force, stays one (params.c); the others are factors, numbers of the model. Like tune.c this builds the
 * model anew at exact values, close to the spec's, where breakpoints keep their order and factors their sign, and finds
 * every number of the regions as a sum of products of powers. What decided on the way which region is which has to keep
 * its sign on the target. */
#include "model/model.h"

/* ---- the model at other values ---- */

struct search {
	struct model *model;
	const struct request *request;
	struct retuned *r;
	struct tuning *t;
	struct listing own;         /* of the spec's values, without signs */
	struct model *found;
	mpq_t *values;
	int points;
	mpq_t **point;
	struct listing *seen;
	int *merged;                /* per system: the first that is equal for all values */
};

static void build_there(void *context)
{
	struct search *s = context;
	struct request request = *s->request;
	request.tunable = (const mpq_t *)s->values;
	request.factor = s->r->factor;
	s->found = model_build(parse_spec(s->model->spec->source), &request);
	if (!s->found)
		abandon();
}

static bool same_load(const struct load *a, const struct load *b)
{
	return a->columns == b->columns && mpq_equal(a->wave->a, b->wave->a) && mpq_equal(a->wave->w, b->wave->w) &&
	       mpq_equal(a->wave->p, b->wave->p);
}

static bool same_loads(const struct model *model, const struct model *other)
{
	const struct linear *a = &model->system, *b = &other->system;
	bool same = a->loads == b->loads && a->segments == b->segments;
	for (int l = 0; l < a->loads && same; l++)
		same = same_load(&a->load[l], &b->load[l]);
	for (int s = 0; s < a->segments - 1 && same; s++)
		same = mpq_equal(a->change[s], b->change[s]);
	return same;
}

static bool same_region(const struct region *a, const struct region *b)
{
	bool same = a->possible == b->possible && a->holds == b->holds && a->releases == b->releases &&
		    (!a->possible || a->system == b->system);
	for (int k = 0; k < a->holds && same; k++)
		same = a->hold[k].state == b->hold[k].state;
	return same;
}

static bool same_impact(const struct impact *whole, const struct impact *other, int segment)
{
	const struct strike *a = &whole->in[segment], *b = &other->in[segment];
	bool same = whole->bounces == other->bounces && a->jumps == b->jumps && a->upward == b->upward &&
		    a->expression == b->expression;
	for (int k = 0; k < a->jumps && same; k++)
		same = a->jump[k].state == b->jump[k].state;
	return same;
}

static bool same_regions(const struct model *model, const struct model *other)
{
	const struct switching *a = model->switching, *b = other->switching;
	if (!b || a->expressions != b->expressions || a->segments != b->segments || a->regions != b->regions ||
	    a->systems != b->systems || a->impacts != b->impacts || a->frictions != b->frictions)
		return false;
	bool same = true;
	for (int e = 0; e < a->expressions; e++)
		same = same && a->expression[e].breaks == b->expression[e].breaks;
	for (int e = 0; e < a->expressions && same; e++)
		for (int k = 1; k < a->expression[e].breaks; k++)
			same = same && is_stick(&a->expression[e], k) == is_stick(&b->expression[e], k);
	for (int r = 0; r < a->regions && same; r++)
		same = same_region(&a->region[r], &b->region[r]);
	for (int i = 0; i < a->segments * a->impacts && same; i++)
		same = same_impact(&a->impact[i % a->impacts], &b->impact[i % a->impacts], i / a->impacts);
	return same;
}

static bool same_shape(const struct model *model, const struct model *other)
{
	return same_loads(model, other) && same_regions(model, other);
}

/* With no system merged yet */
static const struct model *pattern(const struct search *s)
{
	return s->points > 0 ? s->seen[0].model : s->model;
}

/* The param that alone makes the model another one; else the first factor */
static const struct tunable *suspect(struct search *s)
{
	int first = -1;
	for (int k = 0; k < s->t->params; k++) {
		if (!s->r->factor[k])
			continue;
		first = first < 0 ? k : first;
		s->values = rationals((size_t)s->t->params);
		for (int i = 0; i < s->t->params; i++)
			mpq_set(s->values[i], s->t->nominal[i]);
		mpq_set(s->values[k], scattered_near(s->t->params, 0, (const mpq_t *)s->t->nominal)[k]);
		if (silent_guard(build_there, s) && !same_shape(pattern(s), s->found))
			return &s->t->param[k];
	}
	return &s->t->param[first];
}

static _Noreturn void tell_shape(struct search *s)
{
	bool loads = !same_loads(pattern(s), s->found);
	const struct tunable *why = suspect(s);
	if (loads)
		error(why->at,
		      "a load is there only where its factor is not 0; its frequency, phase and growth are fixed",
		      "with another value of '%s' the model has other loads", why->symbol->name);
	error(why->at, "what is equal at the spec's values has to stay equal: breakpoints, factors, forces",
	      "with another value of '%s' the model has other regions", why->symbol->name);
}

static const struct listing *look(struct search *s, const mpq_t *values)
{
	struct tuning *t = s->t;
	for (int i = 0; i < s->points; i++) {
		bool same = true;
		for (int k = 0; k < t->params; k++)
			same = same && mpq_equal(s->point[i][k], values[k]);
		if (same)
			return &s->seen[i];
	}
	s->values = rationals((size_t)t->params);
	for (int k = 0; k < t->params; k++)
		mpq_set(s->values[k], values[k]);
	if (!silent_guard(build_there, s))
		error(t->param[0].at, NULL, "with other values of the tunable params this is no model");
	if (!same_shape(pattern(s), s->found))
		tell_shape(s);
	struct listing new = list_rows(s->found, &t->x, true);
	if (s->points > 0 && new.rows != s->seen[0].rows)
		tell_shape(s);
	ENLARGE(s->point, (size_t)s->points + 1);
	ENLARGE(s->seen, (size_t)s->points + 1);
	s->point[s->points] = s->values;
	s->seen[s->points] = new;
	return &s->seen[s->points++];
}

/* ---- which rows change, which systems are equal ---- */

static const mpq_t *entries_at(const struct search *s, int point, int row)
{
	return (const mpq_t *)s->seen[point].entry + row * s->t->x.size;
}

static bool same_entries(const mpq_t *a, const mpq_t *b, int count)
{
	bool same = true;
	for (int j = 0; j < count && same; j++)
		same = mpq_equal(a[j], b[j]);
	return same;
}

static bool row_changes(const struct search *s, int row)
{
	bool same = true;
	for (int i = 1; i < s->points && same; i++)
		same = same_entries(entries_at(s, i, row), entries_at(s, 0, row), s->t->x.size);
	return !same;
}

static bool systems_agree(const struct search *s, int a, int b)
{
	const struct switching *w = s->model->switching;
	int n = s->model->n, size = s->t->x.size;
	bool same = w->system_segment[a] == w->system_segment[b] &&
		    same_entries((const mpq_t *)s->own.entry + a * n * size,
				 (const mpq_t *)s->own.entry + b * n * size, n * size);
	for (int i = 0; i < s->points && same; i++)
		same = same_entries(entries_at(s, i, a * n), entries_at(s, i, b * n), n * size);
	return same;
}

/* Systems come first among the rows, n of each. */
static void merge_systems(struct search *s)
{
	struct switching *w = s->model->switching;
	int kept = 0, *number = ARRAY(int, (size_t)w->systems);
	s->merged = ARRAY(int, (size_t)w->systems);
	for (int k = 0; k < w->systems; k++) {
		s->merged[k] = k;
		for (int i = 0; i < k && s->merged[k] == k; i++)
			if (s->merged[i] == i && systems_agree(s, i, k))
				s->merged[k] = i;
		number[k] = s->merged[k] == k ? kept : number[s->merged[k]];
		if (s->merged[k] != k)
			continue;
		w->system[kept] = w->system[k];
		w->system_segment[kept++] = w->system_segment[k];
	}
	for (int r = 0; r < w->regions; r++)
		if (w->region[r].possible)
			w->region[r].system = number[w->region[r].system];
	for (int i = 0; i < s->own.rows; i++)
		if (s->r->row[i].kind <= RETUNED_W)
			s->r->row[i].of = s->merged[s->r->row[i].of] == s->r->row[i].of
						  ? number[s->r->row[i].of]
						  : -1;
	w->systems = kept;
}

/* ---- terms ---- */

struct entry {
	struct search *search;
	int row, column;
};

static mpq_srcptr entry_at(void *context, const mpq_t *values)
{
	const struct entry *e = context;
	const struct listing *l = look(e->search, values);
	return l->entry[e->row * e->search->t->x.size + e->column];
}

static bool fit_entry(struct search *s, int row, int column, struct fit *f)
{
	*f = (struct fit){ .params = s->t->params, .near = (const mpq_t *)s->t->nominal, .value = entry_at,
			   .context = &(struct entry){ s, row, column } };
	return fit_value(f);
}

/* Row `row` of the numbers as row `to` from column `from` on, up to `columns` of them, `sign` times */
static void fit_row(struct search *s, struct tuning *t, int row, int to, int from, int columns, int sign)
{
	struct fit *f = NEW(struct fit);
	for (int j = 0; j < columns; j++) {
		if (fit_entry(s, row, j, f)) {
			int first = t->terms;
			add_tuned_terms(t, f, to, from + j);
			for (int i = first; i < t->terms && sign < 0; i++)
				mpq_neg(t->term[i].factor, t->term[i].factor);
			continue;
		}
		const struct tunable *why = &s->t->param[f->culprit < 0 ? 0 : f->culprit];
		error(why->at,
		      format("sums and products, and quotients by single terms, up to the power %d of each and %d of "
			     "them in an entry, are recomputed on the target; only masses in equations may be sums",
			     FIT_DEGREE, LIMIT_MONOMIALS),
		      "the regions depend on '%s' in a way that cannot be recomputed on the target",
		      why->symbol->name);
	}
}

static bool fits(struct search *s, int row)
{
	struct fit *f = NEW(struct fit);
	bool fit = true;
	for (int j = 0; j < s->t->x.size && fit; j++)
		fit = fit_entry(s, row, j, f);
	discard(f);
	return fit;
}

/* Is the row one of a system: its slopes, and what reads them? */
static bool is_of_system(const struct search *s, int row, int system)
{
	const struct retuned_row *r = &s->r->row[row];
	if (r->kind == RETUNED_SLOPE)
		return r->of == system;
	return (r->kind == RETUNED_RELEASE || r->kind == RETUNED_GRIP) &&
	       s->model->switching->region[r->of].system == system;
}

/* Slopes have theirs elsewhere; of others they follow */
static int row_apart(const struct search *s, int row, bool W)
{
	const struct retuned_row *of = &s->r->row[row];
	if (of->kind != RETUNED_SLOPE)
		return row + (W ? 1 : 2);
	int i = 0;
	while (s->r->row[i].kind != (W ? RETUNED_W : RETUNED_R) || s->r->row[i].of != of->of ||
	       s->r->row[i].index != of->index)
		i++;
	return i;
}

/* W a = R x, and what reads a: b - F a = G x */
static void add_block(struct search *s, int system)
{
	int n = s->model->n, size = s->t->x.size;
	struct tuning *t = NEW(struct tuning);
	*t = *s->model->held;
	t->x = s->t->x;
	t->solves = true;
	ENLARGE(s->r->block, (size_t)s->r->blocks + 1);
	s->r->block[s->r->blocks++] = (struct retuned_block){ t, s->t->rows };
	for (int i = 0; i < s->r->rows; i++) {
		struct retuned_row *row = &s->r->row[i];
		if (!is_of_system(s, i, system))
			continue;
		bool slope = row->kind == RETUNED_SLOPE;
		fit_row(s, t, row_apart(s, i, false), t->rows, 0, size, 1);
		fit_row(s, t, row_apart(s, i, true), t->rows, size, n, slope ? 1 : -1);
		if (!slope)
			add_tuned_unit(t, t->rows, size + t->rows);
		row->place = s->t->rows++;
		t->rows++;
	}
}

static bool is_of_jumps(enum retuned_kind kind)
{
	return kind == RETUNED_JUMP || kind == RETUNED_STILL || kind == RETUNED_BACK;
}

/* Of a stop's impact: its answer, a sum of parts that masses divide, divides them. */
static bool add_divided(struct search *s, int row)
{
	struct retuned_row *r = &s->r->row[row];
	int answer = row;
	if (!is_of_jumps(r->kind) || fits(s, row))
		return false;
	while (s->r->row[answer].kind != RETUNED_ANSWER || s->r->row[answer].of != r->of)
		answer--;
	struct tuning *t = NEW(struct tuning);
	*t = *s->model->held;
	t->x = s->t->x;
	t->solves = true;
	t->rows = 1;
	ENLARGE(s->r->block, (size_t)s->r->blocks + 1);
	s->r->block[s->r->blocks++] = (struct retuned_block){ t, s->t->rows };
	r->place = s->t->rows++;
	fit_row(s, t, row + 1, 0, 0, t->x.size, 1);
	fit_row(s, t, answer, 0, t->x.size, 1, 1);
	return true;
}

static void place_row(struct search *s, int row)
{
	if (add_divided(s, row))
		return;
	struct retuned_row *r = &s->r->row[row];
	r->place = s->t->rows++;
	r->positive = mpq_sgn(entries_at(s, 0, row)[0]) > 0;
	fit_row(s, s->t, row, r->place, 0, s->t->x.size, 1);
}

/* All rows of a system or none */
static void fit_system(struct search *s, int system)
{
	bool changes = false, direct = true;
	for (int i = 0; i < s->r->rows; i++)
		if (is_of_system(s, i, system))
			changes = changes || row_changes(s, i);
	for (int i = 0; i < s->r->rows && changes; i++)
		if (is_of_system(s, i, system))
			direct = direct && fits(s, i);
	if (!direct) {
		add_block(s, system);
		return;
	}
	for (int i = 0; i < s->r->rows && changes; i++)
		if (is_of_system(s, i, system))
			place_row(s, i);
}

static void fit_rows(struct search *s)
{
	for (int k = 0; k < s->model->switching->systems; k++)
		fit_system(s, k);
	for (int i = 0; i < s->r->rows; i++) {
		enum retuned_kind kind = s->r->row[i].kind;
		bool apart = kind <= RETUNED_W || kind == RETUNED_TIMES || kind == RETUNED_ANSWER ||
			     (kind >= RETUNED_RELEASE && kind <= RETUNED_GRIP_W);
		if (!apart && row_changes(s, i))
			place_row(s, i);
	}
}

/* ---- what is refused ---- */

static bool reads_moving(const struct node *node)
{
	if (node->kind == NODE_TIME)
		return true;
	if (node->kind == NODE_NAME &&
	    (node->symbol->kind == SYMBOL_COORD || node->symbol->kind == SYMBOL_INPUT ||
	     (node->symbol->kind == SYMBOL_LET && node->symbol->value && reads_moving(node->symbol->value))))
		return true;
	for (int i = 0; i < node->children; i++)
		if (reads_moving(node->child[i]))
			return true;
	return false;
}

static const struct node *first_factor(const struct node *node)
{
	if (node->kind == NODE_NAME) {
		const struct symbol *s = node->symbol;
		return s->factor || (s->tuned && s->value && first_factor(s->value)) ? node : NULL;
	}
	for (int i = 0; i < node->children; i++) {
		const struct node *found = first_factor(node->child[i]);
		if (found)
			return found;
	}
	return NULL;
}

/* A function of params alone is decided, or rounded, when plgen runs; of what moves its sign is one of the signs. */
static void check_node(const struct node *node)
{
	if (node->kind == NODE_NAME && node->symbol->tuned && node->symbol->value && !node->symbol->tuning_checked) {
		node->symbol->tuning_checked = true;
		check_node(node->symbol->value);
	}
	bool decides = node->kind == NODE_CALL || node->kind == NODE_COMPARE;
	for (int i = 0; i < node->children; i++) {
		const struct node *name = decides ? first_factor(node->child[i]) : NULL;
		if (name && !reads_moving(node))
			error(name->at, "sums, products and quotients of tunables are recomputed on the target",
			      "'%s' is tunable, or made of what is, and stands inside %s", name->symbol->name,
			      node->kind == NODE_CALL ? format("%s()", function_name(node->function))
						      : "a comparison");
		check_node(node->child[i]);
	}
}

static void check_outputs(const struct model *model)
{
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		const struct form *form = output->form ? output->form : output->left;
		struct reads reads = reads_of(model, form != NULL, &form);
		for (int k = 0; k < model->n; k++)
			if (reads.highest[k])
				error(output->value->start, "the program has the masses and forces to divide",
				      "output '%s' reads a highest derivative, which tunable params change",
				      output->name);
	}
}

static void check_model(const struct model *model)
{
	const struct spec *spec = model->spec;
	for (int i = 0; i < spec->equations; i++) {
		check_node(spec->equation[i].left);
		check_node(spec->equation[i].right);
	}
	for (int i = 0; i < spec->elements; i++)
		check_node(spec->element[i].value);
	check_outputs(model);
	if (model->switching->sliders > 0)
		error(spec->tunable[0].at, "a small mass slides with its own inertia",
		      "tunable params beside what slides without mass are not built yet");
	if (model->system.states > LIMIT_UNROLLED_STATES)
		error(spec->tunable[0].at, "gaps and forces alone may be tunable with any number of states",
		      "tunable params of regions are built for up to %d states: the model has %d",
		      LIMIT_UNROLLED_STATES, model->system.states);
}

/* An instance has A and e^{A d} of each */
static void check_size(const struct search *s)
{
	int numbers = 2 * s->model->switching->systems * s->t->x.size * s->t->x.size;
	if (numbers > LIMIT_TUNED_NUMBERS)
		error(s->t->param[0].at, "fewer breakpoints, or gaps and forces alone",
		      "tunable params of regions are built for up to %d numbers of their matrices in an instance: "
		      "%d systems of %d take %d",
		      LIMIT_TUNED_NUMBERS, s->model->switching->systems, s->t->x.size, numbers);
}

static void warn_of_idle(const struct search *s)
{
	for (int k = 0; k < s->t->params; k++) {
		bool used = !s->r->factor[k];
		for (int b = -1; b < s->r->blocks; b++) {
			const struct tuning *t = b < 0 ? s->t : s->r->block[b].tuning;
			for (int m = 0; m < t->monomials; m++)
				used = used || t->monomial[m].param == k;
		}
		if (!used && !s->model->relative)
			say_warning(s->t->param[k].at, NULL, "tunable '%s' changes nothing that the target recomputes",
				    s->t->param[k].symbol->name);
	}
}

static void find(void *context)
{
	struct search *s = context;
	struct tuning *t = s->t;
	check_model(s->model);
	bool *all = ARRAY(bool, (size_t)s->model->system.loads + 1);
	for (int l = 0; l < s->model->system.loads; l++)
		all[l] = true;
	t->x = layout_with(&s->model->system, 0, all);
	s->own = list_rows(s->model, &t->x, false);
	for (int i = 0; i < FIT_POINTS; i++)
		look(s, (const mpq_t *)scattered_near(t->params, i, (const mpq_t *)t->nominal));
	s->r->other = s->found;
	s->r->rows = s->seen[0].rows;
	s->r->row = s->seen[0].row;
	merge_systems(s);
	check_size(s);
	fit_rows(s);
	warn_of_idle(s);
}

/* model->retuned; false: it was said why not */
static bool find_retuning(struct model *model, const struct request *request)
{
	struct retuned *r = NEW(struct retuned);
	struct tuning *t = NEW(struct tuning);
	struct search s = { .model = model, .request = request, .r = r, .t = t };
	*t = *model->held;
	r->factor = model->factor;
	r->tuning = t;
	model->retuned = r;
	return statement_guard(find, &s);
}

int retuned_place(const struct retuned *r, enum retuned_kind kind, int of, int index)
{
	for (int i = 0; i < r->rows; i++)
		if (r->row[i].kind == kind && r->row[i].of == of && r->row[i].index == index)
			return r->row[i].place;
	return -1;
}

/* What is solved reads all that any of its equations reads. */
bool retuned_reads(const struct retuned *r, int place, int column)
{
	const struct tuning *t = r->tuning;
	bool solved = false, reads = false;
	for (int b = 0; b < r->blocks; b++)
		if (place >= r->block[b].place && place < r->block[b].place + r->block[b].tuning->rows) {
			t = r->block[b].tuning;
			solved = true;
		}
	for (int i = 0; i < t->terms; i++)
		reads = reads || (t->term[i].column == column && (solved || t->term[i].row == place));
	return reads;
}

bool find_all_tuning(struct model *model, const struct request *request)
{
	return find_tuning(model, request) && (!model->factor || find_retuning(model, request));
}
