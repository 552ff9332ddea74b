/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How entries of equations follow from tunable params: what was recorded of them, as operations that the target carries
 * out in two words. */
#include "inner.h"
#include "model/tunable/tuning.h"

static const char *two_words(struct coefficient number)
{
	return format("{%s, %s}", shortest(number.value), shortest(number.low));
}

/* Values of an array, some a line */
static const char *next_value(int number)
{
	return number == 0 ? "\n    " : number % 5 ? ", " : ",\n    ";
}

static void close_array(const struct emitter *e)
{
	say(e, "\n};\n");
}

/* ---- what is carried out ---- */

struct operation { const char *what; int a, b; };
struct made {                       /* of a number of the record */
	int number;                 /* as the target counts, */
	bool negative;              /* which has the other sign */
};
struct landing { int row, column; struct made made; };
struct entries {                    /* of all equations, one after the other */
	const struct tuning *tuning;
	int constants, operations, places;
	mpq_srcptr *constant;
	struct operation *operation;
	struct landing *place;
	struct made *made;          /* by the operations at hand */
};

static int constant_of(struct entries *x, mpq_srcptr value)
{
	int k = 0;
	while (k < x->constants && !mpq_equal(x->constant[k], value))
		k++;
	if (k == x->constants)
		*MORE(x->constant, x->constants) = value;
	return k;
}

static void list_constant(struct entries *x, const struct traced_part *part)
{
	if (part->number < 0)
		constant_of(x, part->constant);
}

static void list_constants(struct entries *x, const struct tuned_equations *all)
{
	const struct tuning *t = x->tuning;
	SCRATCH bool *live = numbers_behind(t, 1, &all);
	for (int i = 0; i < all->entries; i++)
		list_constant(x, &all->entry[i].value);
	for (int i = 0; i < t->numbers; i++)
		if (live[i] && t->number[i].op != TRACED_GIVEN) {
			list_constant(x, &t->number[i].a);
			list_constant(x, &t->number[i].b);
		}
}

static struct made made_of(struct entries *x, const struct traced_part *part)
{
	const int constant = part->number < 0 ? x->tuning->params + constant_of(x, part->constant) : 0;
	const struct made m = part->number < 0 ? (struct made){ constant, false } : x->made[part->number];
	return (struct made){ m.number, m.negative != part->negative };
}

/* first: of the operations at hand */
static struct made operate(struct entries *x, const struct traced *n, int first)
{
	const struct made a = made_of(x, &n->a), b = made_of(x, &n->b);
	const int number = x->tuning->params + x->constants + x->operations - first;
	const bool sum = n->op == TRACED_SUM, differ = a.negative != b.negative, rotated = sum && differ && a.negative;
	const char *what = n->op == TRACED_PRODUCT ? "PL_PRODUCT"
			   : !sum                  ? "PL_QUOTIENT"
			   : differ                ? "PL_DIFFERENCE"
						   : "PL_SUM";
	*MORE(x->operation, x->operations) =
		(struct operation){ what, rotated ? b.number : a.number, rotated ? a.number : b.number };
	return (struct made){ number, sum ? a.negative && b.negative : differ };
}

static void take_operations(struct entries *x, int count, const struct tuned_equations *const *list)
{
	const struct tuning *t = x->tuning;
	const int first = x->operations;
	SCRATCH bool *live = numbers_behind(t, count, list);
	for (int i = 0; i < t->numbers; i++) {
		const struct traced *n = &t->number[i];
		if (live[i])
			x->made[i] = n->op == TRACED_GIVEN ? (struct made){ n->a.number, n->a.negative }
							   : operate(x, n, first);
	}
}

static void take_places(struct entries *x, const struct tuned_equations *all)
{
	for (int i = 0; i < all->entries; i++) {
		const struct made m = made_of(x, &all->entry[i].value);
		*MORE(x->place, x->places) = (struct landing){ all->entry[i].row, all->entry[i].column, m };
	}
}

/* ---- as C ---- */

static void emit_constants(const struct emitter *e, const struct entries *x)
{
	if (x->constants == 0)
		return;
	say(e, "\nstatic const pl_two $n_constant[%d] = {", x->constants);
	for (int i = 0; i < x->constants; i++)
		say(e, "%s%s", next_value(i), two_words(equation_number(e->model, x->constant[i])));
	close_array(e);
}

static void emit_operations(const struct emitter *e, const struct entries *x)
{
	if (x->operations == 0)
		return;
	say(e, "\nstatic const pl_operation $n_operation[%d] = {"
	       "  /* formulas of params; their operands are %d params, %d constants, earlier results */",
	    x->operations, x->tuning->params, x->constants);
	for (int i = 0; i < x->operations; i++)
		say(e, "%s{%s, %d, %d}", next_value(i), x->operation[i].what, x->operation[i].a, x->operation[i].b);
	close_array(e);
}

static void emit_places(const struct emitter *e, const struct entries *x)
{
	if (x->places == 0)
		return;
	say(e, "\nstatic const pl_place $n_entries[%d] = {"
	       "  /* entries of A that are such results: row, column, number of the result, 1: negated */", x->places);
	for (int i = 0; i < x->places; i++)
		say(e, "%s{%d, %d, %d, %d}", next_value(i), x->place[i].row, x->place[i].column,
		    x->place[i].made.number, x->place[i].made.negative);
	close_array(e);
}

static const char *from(const struct emitter *e, const char *table, int first, int last)
{
	return last > first ? format("%s_%s + %d", e->name, table, first) : "NULL";
}

static const char *formulas_text(const struct emitter *e, const struct entries *x, int first)
{
	return format("{%d, %d, %d, %s, %s}", x->tuning->params, x->constants, x->operations - first,
		      from(e, "constant", 0, x->constants), from(e, "operation", first, x->operations));
}

static const char *entries_text(const struct emitter *e, struct entries *x, const struct tuned_equations *all)
{
	const int first = x->places;
	take_places(x, all);
	return format("{%d, %d, %d, %s}", all->rows, all->columns, x->places - first,
		      from(e, "entries", first, x->places));
}

void emit_equations(const struct emitter *e, const struct tuning *t, bool together, int count,
		    const struct tuned_equations *const *list, struct equations_text *text)
{
	struct entries x = { .tuning = t, .made = ARRAY(struct made, (size_t)t->numbers + 1) };
	for (int k = 0; k < count; k++)
		list_constants(&x, list[k]);    /* they come before what is made */
	for (int k = 0; k < count; k++) {
		const int first = x.operations;
		if (k == 0 || !together)
			take_operations(&x, together ? count : 1, list + k);
		text[k] = (struct equations_text){ formulas_text(e, &x, first), entries_text(e, &x, list[k]) };
	}
	if (t->params + x.constants + x.operations > LIMIT_FORMULAS)
		error(t->param[0].at, "fewer tunable params, or fewer equations that they stand in",
		      "what follows from tunable params takes %d numbers, of at most %d",
		      t->params + x.constants + x.operations, LIMIT_FORMULAS);
	emit_constants(e, &x);
	emit_operations(e, &x);
	emit_places(e, &x);
}
