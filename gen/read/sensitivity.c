/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives by params, by initial values and along inputs: which are asked for, and the equations that they follow.
 * A spec is joined by its derivative at fixed time: of each coordinate x one more, x_k, the derivative of each
 * equation, element, initial value and output. What x_k does is then what any coordinate does: exact where x is. */
#include "read/parser.h"

#include <string.h>

/* ---- the statement ---- */

static bool same_sensitivity(const struct sensitivity *a, const struct sensitivity *b)
{
	return a->symbol == b->symbol && a->component == b->component && a->primes == b->primes;
}

static void add_sensitivity(struct spec *spec, struct sensitivity s)
{
	for (int i = 0; i < spec->sensitivities; i++)
		if (same_sensitivity(&spec->sensitivity[i], &s))
			error(s.at, NULL, "%s stands in the list already", s.name);
	if (spec->sensitivities == LIMIT_SENSITIVITIES)
		error(s.at, "of some params: sensitivity k, c", "more derivatives than the limit of %d",
		      LIMIT_SENSITIVITIES);
	*MORE(spec->sensitivity, spec->sensitivities) = s;
}

/* Of a vector each component */
static void add_initials(struct spec *spec, struct sensitivity s)
{
	const int last = s.component || !s.symbol->length ? s.component : s.symbol->length;
	for (int i = s.symbol->length && !s.component ? 1 : s.component; i <= last; i++) {
		s.component = i;
		s.name = i ? format("%s[%d]%.*s", s.symbol->name, i, s.primes, "'")
			   : format("%s%.*s", s.symbol->name, s.primes, "'");
		add_sensitivity(spec, s);
	}
}

static bool reads_names(const struct node *node)
{
	bool found = node->kind == NODE_NAME || node->kind == NODE_FILE;
	for (int i = 0; i < node->children && !found; i++)
		found = reads_names(node->child[i]);
	return found;
}

/* Params that do not follow from others */
static void add_all(struct spec *spec, struct place at)
{
	bool any = false;
	for (struct symbol *s = spec->first; s; s = s->next) {
		any |= s->kind == SYMBOL_PARAM;
		if (s->kind == SYMBOL_PARAM && !s->broken && (s->tuning.number || !reads_names(s->value)))
			add_sensitivity(spec, (struct sensitivity){ at, s, 0, 0, s->name });
	}
	if (!any)
		error(at, "it lists those that stand before it", "there is no param here");
}

static void take_sensitivity(struct parser *p)
{
	if (p->token.kind != TOKEN_NAME || is_reserved(p->token.name))
		unexpected(p, "a param, a state or an input");
	struct token token = take(p);
	const struct node *name = resolve_name(p, token);
	struct sensitivity s = { token.at, name->symbol, name->component, name->primes, token.name };
	if (!name->symbol || name->kind != NODE_NAME ||
	    (name->symbol->kind != SYMBOL_PARAM && name->symbol->kind != SYMBOL_COORD &&
	     name->symbol->kind != SYMBOL_INPUT))
		error(token.at, "params have derivatives, states by their initial values, and inputs",
		      "no derivative is by %s '%s'", name->symbol ? symbol_kind(name->symbol) : "output", token.name);
	if (name->primes > (name->symbol->kind == SYMBOL_COORD))
		error(token.at, NULL, "%s has no initial value", text_between(token.at, p->end));
	if (name->symbol->kind == SYMBOL_INPUT && name->symbol->hold > 1)
		error(token.at, "held inputs and ramps have one",
		      "no derivative is built along '%s', which goes through further samples", token.name);
	if (name->symbol->kind == SYMBOL_COORD)
		add_initials(p->spec, s);
	else
		add_sensitivity(p->spec, s);
}

/* sensitivity: sensitivity ( all | NAME { ' } ) { , ... } */
void read_sensitivity(struct parser *p)
{
	do {
		if (p->token.kind == TOKEN_NAME && !find_symbol(p, "all") && strcmp(p->token.name, "all") == 0)
			add_all(p->spec, take(p).at);
		else
			take_sensitivity(p);
	} while (take_op(p, ","));
	expect_end(p);
}

bool parse_sensitivities(struct spec *spec, const struct source *source)
{
	spec->sensitivities = 0;
	spec->sensitivity = NULL;
	return parse_list(spec, source, read_sensitivity);
}

/* ---- where a formula jumps, and with it the derivatives ---- */

struct choosing {
	struct spec *spec;
	const struct sensitivity *by; /* `count` of them */
	int count;
	struct symbol *clock;         /* t as a coordinate, once it is asked for */
	bool *seen;                   /* per number of a symbol */
	bool watched;                 /* else what is chosen jumps in outputs alone */
};

static bool reads_time(const struct node *node)
{
	bool reads = node->kind == NODE_TIME || (node->kind == NODE_NAME && node->symbol->value &&
						 reads_time(node->symbol->value));
	for (int i = 0; i < node->children && !reads; i++)
		reads = reads_time(node->child[i]);
	return reads;
}

static bool follows_any(const struct choosing *c, const struct node *node)
{
	bool any = false;
	for (int i = 0; i < c->count && !any; i++)
		any = c->by[i].symbol->kind == SYMBOL_PARAM && follows_param(node, c->by[i].symbol);
	return any;
}

/* A coordinate with x' = rate */
static struct symbol *add_first_order(struct spec *spec, const char *name, struct place at, unsigned long rate)
{
	struct symbol *s = NEW(struct symbol);
	struct node *right = node_new(NODE_NUMBER, at);
	*s = (struct symbol){ .kind = SYMBOL_COORD, .name = name, .at = at, .used = true,
			      .index = spec->count.components++ };
	add_symbol(spec, s);
	spec->count.coords++;
	mpq_set_ui(right->number, rate, 1);
	*MORE(spec->equation, spec->equations) = (struct equation){ .at = at, .left = state_node(s, 0, 1),
								    .right = right };
	return s;
}

/* The same by the clock */
static struct node *clocked(struct choosing *c, struct node *node)
{
	if (!reads_time(node))
		return node;
	if (node->kind == NODE_NAME)
		return clocked(c, node->symbol->value);
	if (node->kind == NODE_TIME)
		return state_node(c->clock, 0, 0);
	struct node *made = NEW(struct node);
	*made = *node;
	made->children = made->depth = 0;
	made->timely = TIMELY_UNKNOWN;
	for (int i = 0; i < node->children; i++)
		add_child(made, clocked(c, node->child[i]), node->inverse[i], node->operator[i]);
	made->start = node->start;
	made->end = node->end;
	return made;
}

/* Met either way, as an impact is that changes nothing; before those that the spec has */
static void add_choice(struct choosing *c, struct node *test, bool timed)
{
	struct spec *spec = c->spec;
	for (int down = 0; down < 2; down++) {
		struct node *guard = node_new(NODE_COMPARE, test->at);
		guard->comparison = down ? CMP_LE : CMP_GE;
		add_child(guard, test->kind == NODE_COMPARE ? test->child[0] : test, false, test->at);
		add_child(guard, test->kind == NODE_COMPARE ? test->child[1] : node_new(NODE_NUMBER, test->at), false,
			  test->at);
		guard->start = test->start;
		guard->end = test->end;
		MORE(spec->when, spec->whens);
		memmove(spec->when + 1, spec->when, (size_t)(spec->whens - 1) * sizeof *spec->when);
		spec->when[0] = (struct when){ .at = test->start, .end = test->end, .guard = guard, .chosen = true,
					       .timed = timed };
	}
}

static void find_choices(struct choosing *c, struct node *node)
{
	const struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	const bool jumps = node->kind == NODE_CHOOSE || (node->kind == NODE_CALL && node->function == FN_SGN);
	if (s && s->kind == SYMBOL_LET && s->value && !c->seen[s->number]) {
		c->seen[s->number] = true;
		find_choices(c, s->value);
	}
	for (int i = 0; i < node->children; i++)
		find_choices(c, node->child[i]);
	if (!jumps)
		return;
	struct node **test = &node->child[0];
	const bool timed = !reads_states(*test) && reads_time(*test) && follows_any(c, *test);
	if (timed && !c->clock) /* so a time that moves with a param is met as a state's place is */
		c->clock = add_first_order(c->spec, "t_clock", (*test)->at, 1);
	if (timed)
		*test = clocked(c, *test);
	if (c->watched && reads_states(*test))
		add_choice(c, *test, timed);
}

static void watch_choices(struct spec *spec, int first, int count)
{
	struct choosing c = { .spec = spec, .by = spec->sensitivity + first, .count = count, .watched = true,
			      .seen = ARRAY(bool, (size_t)spec->count.symbols + 1) };
	for (int i = 0, equations = spec->equations; i < equations; i++) {
		find_choices(&c, spec->equation[i].left);
		find_choices(&c, spec->equation[i].right);
	}
	for (int i = 0; i < spec->elements; i++)
		if (spec->element[i].value)
			find_choices(&c, spec->element[i].value);
	for (int i = 0; i < spec->lagrange.energies; i++)
		find_choices(&c, spec->lagrange.energy[i].value);
	c.watched = false;
	for (struct symbol *s = spec->first; s; s = s->next)
		if (s->kind == SYMBOL_OUTPUT && !s->peak)
			find_choices(&c, s->value);
}

/* ---- the equations of the derivatives ---- */

struct varying {                    /* one derivative */
	struct spec *spec;
	const struct sensitivity *of;
	struct slope by;
	struct slope event;         /* of what is watched for events, which move in time */
	struct slope energy;        /* of energies: where forms are derived along the states, by the param alone */
	const char *suffix;         /* of its symbols: k, x_0 */
	int own, first;             /* components of coordinates: of the model, before those that are added */
};

static struct symbol *add_like(const struct varying *v, const struct symbol *like)
{
	struct symbol *s = NEW(struct symbol);
	*s = (struct symbol){ .kind = like->kind, .name = format("%s_%s", like->name, v->suffix), .at = like->at,
			      .statement = like->statement, .part = like->part, .length = like->length, .used = true,
			      .hold = like->hold };
	add_symbol(v->spec, s);
	return s;
}

static void add_moved(struct varying *v, int symbols)
{
	struct spec *spec = v->spec;
	for (struct symbol *s = spec->first; s && s->number <= symbols; s = s->next)
		if (s->kind == SYMBOL_COORD) {
			struct symbol *made = v->by.moved[s->number] = add_like(v, s);
			made->index = spec->count.components;
			spec->count.components += s->length ? s->length : 1;
			spec->count.coords++;
		} else if (s->kind == SYMBOL_MULTIPLIER) {
			v->by.moved[s->number] = add_like(v, s);
			v->by.moved[s->number]->index = spec->count.multipliers++;
		} else if (s->kind == SYMBOL_INPUT && s == v->of->symbol) {
			v->by.moved[s->number] = add_like(v, s);
			v->by.moved[s->number]->index = spec->count.inputs++;
		}
}

/* Whether what is watched for events, or the velocity of friction, depends on time itself */
static bool watches_time(const struct node *node, bool watched)
{
	const struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	bool any = watched && (node->kind == NODE_TIME || (s && s->kind == SYMBOL_INPUT));
	if (s && s->value && !any)
		any = watches_time(s->value, watched);
	for (int i = 0; i < node->children && !any; i++)
		any = watches_time(node->child[i], watched || (node->function == FN_FRICTION &&
							       node->kind == NODE_CALL && i == 0));
	return any;
}

static bool has_timed_events(const struct spec *spec)
{
	bool any = false;
	for (int i = 0; i < spec->whens && !any; i++) {
		any = watches_time(spec->when[i].guard, true);
		for (int k = 0; k < spec->when[i].jumps && !any; k++)
			any = watches_time(spec->when[i].jump[k].value, true);
	}
	for (int i = 0; i < spec->equations && !any; i++)
		any = watches_time(spec->equation[i].left, false) ||
		      (spec->equation[i].right && watches_time(spec->equation[i].right, false));
	for (int i = 0; i < spec->elements && !any; i++)
		any = spec->element[i].value && watches_time(spec->element[i].value, false);
	return any;
}

/* The derivative of t, which is 0 but at an event: a coordinate of first order that nothing moves */
static void add_time(struct varying *v)
{
	v->event.time = add_first_order(v->spec, format("t_%s", v->suffix), v->of->at, 0);
}

static void add_when(struct varying *v, struct when *when)
{
	struct when_slope made = { .jump = ARRAY(struct node *, (size_t)when->jumps + 1) };
	struct node *over = node_new(NODE_SUM, when->guard->at);
	for (int side = 0; side < 2; side++)
		add_child(over, when->guard->child[side], side, when->guard->at);
	over->start = when->guard->start;
	over->end = when->guard->end;
	made.guard = slope_by(over, v->event);
	made.restitution = when->restitution ? slope_by(when->restitution, v->by) : NULL;
	for (int i = 0; i < when->jumps; i++)
		made.jump[i] = slope_by(when->jump[i].value, v->event);
	*MORE(when->slope, when->slopes) = made;
}

static void add_equation(struct varying *v, struct equation e)
{
	e.left = slope_by(e.left, v->by);
	e.right = slope_by(e.right, v->by);
	*MORE(v->spec->equation, v->spec->equations) = e;
}

static struct node *moved_node(const struct varying *v, const struct node *node)
{
	return node ? state_node(v->by.moved[node->symbol->number], node->component, node->primes) : NULL;
}

static struct node *product_of(struct node *a, struct node *b)
{
	struct node *product = node_new(NODE_PRODUCT, a->at);
	add_child(product, a, false, a->at);
	add_child(product, b, false, a->at);
	return product;
}

/* -factor (from - to), their derivatives of that order */
static struct node *force_between(struct node *factor, const struct element *e, int order, bool reversed)
{
	struct node *sum = node_new(NODE_SUM, e->at);
	add_child(sum, state_node(e->from->symbol, e->from->component, order), !reversed, e->at);
	if (e->to)
		add_child(sum, state_node(e->to->symbol, e->to->component, order), reversed, e->at);
	return product_of(factor, sum);
}

/* The same element between the derivatives, and forces on them as its value changes */
static void add_element(struct varying *v, struct element e)
{
	const struct element own = e;
	struct node *change = e.kind == ELEMENT_ENERGY ? NULL : slope_by(e.value, v->by);
	const bool force = e.kind == ELEMENT_FORCE || e.kind == ELEMENT_FRICTION, energy = e.kind == ELEMENT_ENERGY;
	const int order = e.kind == ELEMENT_MASS ? 2 : e.kind == ELEMENT_DAMPER ? 1 : 0;
	e.from = moved_node(v, own.from);
	e.to = moved_node(v, own.to);
	if (force)
		e.value = change;
	*MORE(v->spec->element, v->spec->elements) = e;
	for (int end = 0; end < (own.to ? 2 : 1) && !force && !energy && !is_zero_node(change); end++) {
		struct element by = { .kind = ELEMENT_FORCE, .part = own.part, .at = own.at, .end = own.end };
		by.from = end ? e.to : e.from;
		by.value = force_between(change, &own, order, end);
		*MORE(v->spec->element, v->spec->elements) = by;
	}
}

/* Lagrange's equations of the derivative of L, by the coordinates themselves, are the derivatives of those of L. */
static void add_energy(struct varying *v, struct energy e)
{
	struct spec *spec = v->spec;
	const struct energy own = e;
	e.behind = v->first;
	e.own = v->own;
	e.value = slope_by(own.value, v->energy);
	e.of = own.multiplier;
	e.multiplier = e.of ? v->by.moved[e.of->number] : NULL;
	if (!is_zero_node(e.value))
		*MORE(spec->lagrange.energy, spec->lagrange.energies) = e;
	if (!own.point)
		return;
	e.value = own.value;
	e.point = slope_by(own.point, v->energy);
	if (!is_zero_node(e.point))
		*MORE(spec->lagrange.energy, spec->lagrange.energies) = e;
}

static void add_initial_node(struct varying *v, const struct initial *like, struct node *value)
{
	struct initial made = *like;
	made.coord = v->by.moved[like->coord->number];
	made.value = value;
	*MORE(v->spec->states.initial, v->spec->states.initials) = made;
}

static void add_initials_of(struct varying *v, int initials)
{
	const struct sensitivity *of = v->of;
	for (int i = 0; i < initials; i++) {
		const struct initial like = v->spec->states.initial[i];
		struct node *value = slope_by(like.value, v->by);
		/* beside constraints what is not named follows */
		if (!is_zero_node(value) || v->spec->count.multipliers > 0)
			add_initial_node(v, &like, value);
	}
	if (of->symbol->kind != SYMBOL_COORD)
		return;
	struct node *one = node_new(NODE_NUMBER, of->at);
	mpq_set_ui(one->number, 1, 1);
	add_initial_node(v, &(struct initial){ of->at, NULL, 0, of->symbol, of->primes, of->component, NULL }, one);
}

/* Of the shape of the output, whatever that of its derivative: with 0 times it */
static void add_outputs(struct varying *v, int symbols)
{
	for (struct symbol *s = v->spec->first; s && s->number <= symbols; s = s->next) {
		if (s->kind != SYMBOL_OUTPUT)
			continue;
		struct node *sum = node_new(NODE_SUM, s->value->at), *none = node_new(NODE_NUMBER, s->value->at);
		sum->start = s->value->start;
		add_child(sum, product_of(none, s->value), false, s->value->at);
		add_child(sum, slope_by(s->value, v->by), false, s->value->at);
		struct symbol *made = add_like(v, s);
		made->value = sum;
		made->index = v->spec->count.outputs++;
	}
}

/* The point of the operator moves too: with x_k at the derivative of its x the Jacobian's own follows. */
static void add_fixed(struct varying *v, int fixeds)
{
	struct spec *spec = v->spec;
	for (int i = 0; i < fixeds; i++) {
		struct fixed made = spec->operators.fixed[i];
		if (made.values != 1 || !made.symbol || made.symbol->kind != SYMBOL_COORD)
			continue;
		struct node *value = slope_by(made.value[0], v->by);
		made.symbol = v->by.moved[made.symbol->number];
		made.value = ARRAY(struct node *, 1);
		made.value[0] = value;
		*MORE(spec->operators.fixed, spec->operators.fixeds) = made;
	}
}

struct extent { int symbols, equations, elements, energies, initials, components, fixeds; bool timed; };

static void vary(struct varying *v, struct extent before)
{
	struct spec *spec = v->spec;
	v->by.moved = ARRAY(struct symbol *, (size_t)before.symbols + 1);
	v->by.known = ARRAY(struct node *, (size_t)before.symbols + 1);
	v->own = before.components;
	v->first = spec->count.components;
	add_moved(v, before.symbols);
	v->event = v->by;
	v->event.known = ARRAY(struct node *, (size_t)before.symbols + 1);
	if (before.timed)
		add_time(v);
	v->energy = v->by;
	if (spec->joined.along) {
		v->energy.moved = ARRAY(struct symbol *, (size_t)before.symbols + 1);
		v->energy.known = ARRAY(struct node *, (size_t)before.symbols + 1);
		if (v->of->symbol->kind == SYMBOL_INPUT)
			v->energy.moved[v->of->symbol->number] = v->by.moved[v->of->symbol->number];
	}
	v->by.event = &v->event;
	for (int i = 0; i < before.energies; i++)
		add_energy(v, spec->lagrange.energy[i]);
	for (int i = 0; i < before.equations; i++)
		add_equation(v, spec->equation[i]);
	for (int i = 0; i < before.elements; i++)
		add_element(v, spec->element[i]);
	for (int i = 0; i < spec->whens; i++)
		add_when(v, &spec->when[i]);
	add_initials_of(v, before.initials);
	add_fixed(v, before.fixeds);
	if (v->of->symbol->kind != SYMBOL_LET)
		add_outputs(v, before.symbols);
	if (spec->request.step && !is_zero_node(slope_by(spec->request.step, v->by)))
		error(v->of->at, "--step gives the step another way", "the step follows from '%s'", v->of->name);
}

/* x, q[2]' as x_0, q2_dot0 */
static const char *suffix_of(const struct sensitivity *s)
{
	const char *name = s->component ? format("%s%d", s->symbol->name, s->component) : s->symbol->name;
	return s->symbol->kind == SYMBOL_COORD ? format("%s%s_0", name, s->primes ? "_dot" : "") : name;
}

struct node *slope_by_param(const struct spec *spec, const struct sensitivity *by, struct node *node)
{
	struct slope slope = { .at = by->at, .kind = SLOPE_PARAM, .name = by->name };
	slope.param = by->symbol->kind == SYMBOL_PARAM ? by->symbol : NULL;
	slope.moved = ARRAY(struct symbol *, (size_t)spec->count.symbols + 1);
	slope.known = ARRAY(struct node *, (size_t)spec->count.symbols + 1);
	return slope_by(node, slope);
}

void add_derivatives(struct spec *spec, int first, int count, bool jumps, bool remainder, bool probe)
{
	struct symbol nothing = { .kind = SYMBOL_LET, .name = "by_nothing" };
	if (count == 0)
		return;
	if (jumps)
		watch_choices(spec, first, count);
	const struct extent before = { spec->count.symbols, spec->equations, spec->elements, spec->lagrange.energies,
				       spec->states.initials, spec->count.components, spec->operators.fixeds,
				       has_timed_events(spec) };
	spec->joined.columns = count;
	spec->joined.own = before.components;
	spec->joined.stride = before.components + before.timed;
	for (struct symbol *s = spec->first; s; s = s->next)
		s->peak = false;                      /* the model's own outputs say when they were largest */
	spec->joined.probe = probe;
	spec->joined.along = spec->lagrange.energies > 0 && spec->count.multipliers == 0 && spec->whens == 0 &&
			     !jumps && !remainder;
	for (int i = 0; i < spec->lagrange.energies; i++)
		spec->joined.along &= spec->lagrange.energy[i].kind != 'Q';        /* which may be friction */
	/* by nothing at all: any solution, if it does not start from 0 */
	const struct sensitivity none = { spec->sensitivity[first].at, &nothing, 0, 0, nothing.name };
	for (int i = first; i < first + count + probe; i++) {
		const struct sensitivity *s = i < first + count ? &spec->sensitivity[i] : &none;
		struct varying v = { .spec = spec, .of = s, .suffix = suffix_of(s) };
		v.by = (struct slope){ .at = s->at, .kind = SLOPE_PARAM, .name = s->name, .unexpanded = remainder };
		v.by.param = s->symbol->kind == SYMBOL_PARAM ? s->symbol : NULL;
		vary(&v, before);
	}
	spec->units.adopted = true;                   /* units have been looked at, */
	spec->states.ranges = 0;                      /* and what is said of states and outputs is of the model's own */
	spec->required.needs = 0;
}
