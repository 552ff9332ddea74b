/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes, each made once; what they cost and read. */
#include "tape/tape.h"

#include <math.h>

struct tape {
	int nodes, room, outs;      /* room for nodes, a power of two, and as many buckets */
	struct tape_node *node;
	struct tape_out *out;
	int *next, *bucket;         /* nodes of one hash; first + 1, 0: none */
};

struct tape *tape_new(void)
{
	return NEW(struct tape);
}

int tape_length(const struct tape *t)
{
	return t->nodes;
}

const struct tape_node *tape_node(const struct tape *t, tape_ref ref)
{
	return &t->node[ref];
}

int tape_outs(const struct tape *t)
{
	return t->outs;
}

const struct tape_out *tape_out(const struct tape *t, int out)
{
	return &t->out[out];
}

/* ---- nodes ---- */

static bool is_alike(const struct tape_node *a, const struct tape_node *b)
{
	bool same = a->op == b->op && a->index == b->index && a->part == b->part && a->a == b->a && a->b == b->b &&
		    a->c == b->c;
	return same && (a->op != TAPE_CONSTANT || mpq_equal(a->value, b->value));
}

static unsigned hash_of(const struct tape_node *n)
{
	unsigned hash = (unsigned)n->op;
	const int word[] = { n->index, n->part, n->a, n->b, n->c };
	for (size_t i = 0; i < sizeof word / sizeof *word; i++)
		hash = (hash ^ hash >> 15 ^ (unsigned)word[i]) * 0x9e3779b1u;
	if (n->op == TAPE_CONSTANT)
		hash = (hash ^ (unsigned)mpz_get_ui(mpq_numref(n->value))) * 0x9e3779b1u +
		       (unsigned)mpz_get_ui(mpq_denref(n->value));
	return hash ^ hash >> 15;
}

static void into_bucket(struct tape *t, int node)
{
	int *bucket = &t->bucket[hash_of(&t->node[node]) % (unsigned)t->room];
	t->next[node] = *bucket;
	*bucket = node + 1;
}

static void make_room(struct tape *t)
{
	t->room = t->room ? 2 * t->room : 64;
	ENLARGE(t->node, (size_t)t->room);
	ENLARGE(t->next, (size_t)t->room);
	discard(t->bucket);
	t->bucket = ARRAY(int, t->room);
	for (int i = 0; i < t->nodes; i++)
		into_bucket(t, i);
}

static tape_ref enter(struct tape *t, struct tape_node n)
{
	if (t->nodes == t->room)
		make_room(t);
	for (int i = t->bucket[hash_of(&n) % (unsigned)t->room] - 1; i >= 0; i = t->next[i] - 1)
		if (is_alike(&t->node[i], &n))
			return i;
	t->node[t->nodes] = n;
	into_bucket(t, t->nodes);
	return t->nodes++;
}

tape_ref tape_constant(struct tape *t, mpq_srcptr value)
{
	mpq_t *own = NEW(mpq_t);
	mpq_init(*own);
	mpq_set(*own, value);
	return enter(t, (struct tape_node){ .op = TAPE_CONSTANT, .a = TAPE_NONE, .b = TAPE_NONE, .c = TAPE_NONE,
					    .value = *own });
}

tape_ref tape_number(struct tape *t, long value)
{
	RATIONAL exact = RATIO(value, 1);
	return tape_constant(t, exact);
}

tape_ref tape_double(struct tape *t, double value)
{
	RATIONAL exact = ZERO;
	if (!isfinite(value))
		error(working_at(), NULL, "a number of the equations is beyond the range of %s", target_name());
	mpq_set_d(exact, value);
	return tape_constant(t, exact);
}

tape_ref tape_pi(struct tape *t)
{
	RATIONAL pi = ZERO;
	constant_pi(pi);
	return tape_constant(t, pi);
}

static bool is_choice(enum tape_op op)
{
	return op == TAPE_ABOVE || op == TAPE_HELD || op == TAPE_TRUE || op == TAPE_FALSE || op == TAPE_NOT ||
	       (op >= TAPE_LESS && op <= TAPE_UNEQUAL);
}

tape_ref tape_operand(struct tape *t, enum tape_op kind, int index, int part)
{
	return enter(t, (struct tape_node){ .op = kind, .choice = is_choice(kind), .index = index, .part = part,
					    .a = TAPE_NONE, .b = TAPE_NONE, .c = TAPE_NONE });
}

static tape_ref make(struct tape *t, enum tape_op op, int index, tape_ref a, tape_ref b)
{
	return enter(t, (struct tape_node){ .op = op, .choice = is_choice(op), .index = index, .a = a, .b = b,
					    .c = TAPE_NONE });
}

tape_ref tape_unary(struct tape *t, enum tape_op op, tape_ref a)
{
	bool twice = (op == TAPE_NEG || op == TAPE_NOT) && t->node[a].op == op;
	if (op != TAPE_NEG || t->node[a].op != TAPE_CONSTANT)
		return twice ? t->node[a].a : make(t, op, 0, a, TAPE_NONE);
	RATIONAL negative = ZERO;
	mpq_neg(negative, t->node[a].value);
	return tape_constant(t, negative);
}

tape_ref tape_call(struct tape *t, enum function function, tape_ref a)
{
	return make(t, TAPE_CALL, (int)function, a, TAPE_NONE);
}

static bool is_one(const struct tape *t, tape_ref ref)
{
	return t->node[ref].op == TAPE_CONSTANT && mpq_cmp_ui(t->node[ref].value, 1, 1) == 0;
}

tape_ref tape_binary(struct tape *t, enum tape_op op, tape_ref a, tape_ref b)
{
	if (op == TAPE_MUL && (is_one(t, a) || is_one(t, b)))
		return is_one(t, a) ? b : a;
	return make(t, op, 0, a, b);
}

tape_ref tape_compare(struct tape *t, enum comparison comparison, tape_ref a, tape_ref b)
{
	static const enum tape_op op[] = { TAPE_LESS, TAPE_AT_MOST, TAPE_LESS, TAPE_AT_MOST, TAPE_EQUAL, TAPE_UNEQUAL };
	bool turned = comparison == CMP_GT || comparison == CMP_GE;
	return tape_binary(t, op[comparison], turned ? b : a, turned ? a : b);
}

tape_ref tape_select(struct tape *t, tape_ref condition, tape_ref a, tape_ref b)
{
	enum tape_op op = t->node[condition].op;
	if (a == b || op == TAPE_TRUE || op == TAPE_FALSE)
		return op == TAPE_FALSE ? b : a;
	return enter(t, (struct tape_node){ .op = TAPE_SELECT, .choice = t->node[a].choice, .a = condition, .b = a,
					    .c = b });
}

tape_ref tape_accumulate(struct tape *t, tape_ref a, tape_ref b, tape_ref c, int index, int part)
{
	return enter(t, (struct tape_node){ .op = TAPE_ACCUMULATE, .index = index, .part = part, .a = a, .b = b,
					    .c = c });
}

tape_ref tape_scaled(struct tape *t, double factor, tape_ref ref)
{
	if (ref == TAPE_NONE || factor == 1)
		return ref;
	return factor == -1 ? tape_unary(t, TAPE_NEG, ref) : tape_times_each(t, tape_double(t, factor), ref);
}

tape_ref tape_sum(struct tape *t, int terms, const tape_ref *term)
{
	if (terms <= 1)
		return terms ? term[0] : tape_number(t, 0);
	int half = (terms + 1) / 2;
	half += terms > 3 && half % 2;          /* pairs stay together */
	tape_ref left = tape_sum(t, half, term);
	return tape_binary(t, TAPE_ADD, left, tape_sum(t, terms - half, term + half));
}

tape_ref tape_power(struct tape *t, tape_ref a, unsigned n)
{
	if (n == 1)
		return a;
	if (n <= 3) {
		tape_ref square = tape_binary(t, TAPE_MUL, a, a);
		return n == 2 ? square : tape_binary(t, TAPE_MUL, square, a);
	}
	tape_ref half = tape_power(t, a, n / 2), square = tape_binary(t, TAPE_MUL, half, half);
	return n % 2 ? tape_binary(t, TAPE_MUL, square, a) : square;
}

tape_ref tape_table(struct tape *t, tape_ref x, int pieces, const struct straight *piece, const tape_ref *below)
{
	tape_ref value = TAPE_NONE;
	RATIONAL back = ZERO;
	for (int p = pieces - 1; p >= 0; p--) {
		mpq_neg(back, piece[p].x);
		tape_ref beyond = tape_binary(t, TAPE_ADD, x, tape_constant(t, back));
		tape_ref rise = tape_binary(t, TAPE_MUL, tape_constant(t, piece[p].slope), beyond);
		tape_ref own = tape_binary(t, TAPE_ADD, tape_constant(t, piece[p].y), rise);
		value = piece[p].end ? tape_select(t, below[p], own, value) : own;
	}
	return value;
}

bool tape_is_operand(const struct tape *t, tape_ref ref)
{
	return t->node[ref].op < TAPE_NEG;
}

tape_ref tape_times_each(struct tape *t, tape_ref before, tape_ref product)
{
	const struct tape_node n = t->node[product];
	if (n.op != TAPE_MUL || n.name)
		return tape_binary(t, TAPE_MUL, before, product);
	return tape_binary(t, TAPE_MUL, tape_times_each(t, before, n.a), n.b);
}

tape_ref tape_power_of_time(struct tape *t, int power)
{
	tape_ref time = tape_operand(t, TAPE_TIME, 0, 0), product = power ? time : TAPE_NONE;
	for (int k = 1; k < power; k++)
		product = tape_binary(t, TAPE_MUL, product, time);
	return product;
}

void tape_name(struct tape *t, tape_ref ref, const char *name)
{
	if (t->node[ref].op != TAPE_CONSTANT && !t->node[ref].name && !t->node[ref].choice)
		t->node[ref].name = name;
}

void tape_set(struct tape *t, const char *target, tape_ref ref, int indent, const char *note)
{
	*MORE(t->out, t->outs) = (struct tape_out){ target, note, ref, false, indent };
}

void tape_set_local(struct tape *t, const char *name, tape_ref ref)
{
	tape_set(t, name, ref, 0, NULL);
	t->out[t->outs - 1].local = true;
}

void tape_statement(struct tape *t, const char *line)
{
	tape_set(t, NULL, tape_number(t, 0), 0, line);
}

/* ---- what has to hold ---- */

static int operands_of(enum tape_op op)
{
	return op < TAPE_NEG ? 0 : op < TAPE_ADD ? 1 : op < TAPE_SELECT ? 2 : 3;
}

static const char *check_node(const struct tape *t, int i)
{
	const struct tape_node *n = &t->node[i];
	const tape_ref ref[3] = { n->a, n->b, n->c };
	for (int k = 0; k < 3; k++) {
		if (k >= operands_of(n->op)) {
			if (ref[k] != TAPE_NONE)
				return "a node reads more than its operation has operands";
			continue;
		}
		if (ref[k] < 0 || ref[k] >= i)
			return "a node reads what is not before it";
		bool wanted = n->op == TAPE_NOT || (n->op == TAPE_SELECT && (k == 0 || n->choice));
		if (t->node[ref[k]].choice != wanted)
			return "a condition is read as a number, or a number as a condition";
	}
	if ((n->op == TAPE_CONSTANT) != (n->value != NULL))
		return "a constant has no value, or something else has one";
	return NULL;
}

const char *tape_check(const struct tape *t)
{
	for (int i = 0; i < t->nodes; i++) {
		const char *broken = check_node(t, i);
		if (broken)
			return broken;
		for (int k = t->next[i] - 1; k >= 0; k = t->next[k] - 1)
			if (is_alike(&t->node[k], &t->node[i]))
				return "two nodes are alike";
	}
	for (int i = 0; i < t->outs; i++)
		if (t->out[i].ref < 0 || t->out[i].ref >= t->nodes || t->node[t->out[i].ref].choice)
			return "what is set is no number of the tape";
	return NULL;
}

/* ---- what is read, and what it costs ---- */

bool tape_is_cheap(const struct tape *t, tape_ref ref)
{
	const struct tape_node *n = &t->node[ref];
	return n->choice || n->op == TAPE_NEG || (n->op == TAPE_MUL && t->node[n->a].op == TAPE_CONSTANT);
}

int *tape_uses(const struct tape *t)
{
	int *uses = ARRAY(int, t->nodes + 1);
	for (int i = 0; i < t->outs; i++)
		uses[t->out[i].ref]++;
	for (int i = t->nodes - 1; i >= 0; i--) {
		const tape_ref ref[3] = { t->node[i].a, t->node[i].b, t->node[i].c };
		for (int k = 0; k < 3 && uses[i]; k++)
			if (ref[k] != TAPE_NONE)
				uses[ref[k]] += tape_is_cheap(t, i) && !t->node[i].name ? uses[i] : 1;
	}
	return uses;
}

bool tape_reads(const struct tape *t, enum tape_op kind, int index, int part)
{
	bool reads = false;
	SCRATCH int *uses = tape_uses(t);
	for (int i = 0; i < t->nodes && !reads; i++) {
		const struct tape_node *n = &t->node[i];
		reads = uses[i] && n->op == kind && (index < 0 || n->index == index) && (part < 0 || n->part == part);
	}
	return reads;
}

void tape_mark(const struct tape *t, enum tape_op kind, int part, bool *flag)
{
	SCRATCH int *uses = tape_uses(t);
	for (int i = 0; i < t->nodes; i++)
		if (uses[i] && t->node[i].op == kind && t->node[i].part == part)
			flag[t->node[i].index] = true;
}

struct tape_cost tape_cost(const struct tape *t)
{
	struct tape_cost cost = { 0 };
	SCRATCH int *uses = tape_uses(t);
	for (int i = 0; i < t->nodes; i++) {
		enum tape_op op = t->node[i].op;
		int times = tape_is_cheap(t, i) && !t->node[i].name ? uses[i] : uses[i] > 0;
		cost.multiplications += op == TAPE_MUL ? times : 0;
		cost.divisions += op == TAPE_DIV ? times : 0;
		cost.additions += op == TAPE_ADD ? times : 0;
		cost.calls += op == TAPE_CALL || op == TAPE_POWER || op == TAPE_ATAN2 ? times : 0;
		cost.accumulations += op == TAPE_ACCUMULATE ? times : 0;
	}
	return cost;
}
