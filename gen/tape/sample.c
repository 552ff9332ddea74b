/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms as numbers at points, in MPFR at any precision: what only looks at a model needs no exact value. A number is
 * found once for all times, once a time, or once a point, as what it reads changes. */
#include "tape/tape.h"

enum change { NEVER, IN_TIME, AT_POINTS, CHANGES };

struct kept { const struct form *form; tape_ref ref; };

struct sample {
	void (*leaf)(void *context, const struct basis *basis, mpfr_ptr value);
	void *context;
	mpfr_t t;
	mpfr_prec_t precision;
	long work;
	struct tape_forms *forms;
	int kept, room;             /* forms so far, in an open hash table */
	struct kept *table;
	int nodes;                  /* those with room */
	mpfr_t *value;
	enum change *change;
	unsigned *found, now[CHANGES]; /* when a value was found; never, times, points so far */
};

/* ---- forms to nodes ---- */

static tape_ref leaf(struct tape *t, const void *context, const struct basis *basis)
{
	(void)context;
	if (basis->kind == BASIS_FORCING)
		return tape_forcing(t, basis);
	return tape_operand(t, basis->kind == BASIS_COORD ? TAPE_COORD : TAPE_INPUT, basis->index, basis->order);
}

static tape_ref friction(struct tape *t, const void *context, const struct atom *atom)
{
	(void)t;
	return tape_form(((const struct sample *)context)->forms, atom->operand[0]);
}

struct sample *sample_new(int precision, void (*of_leaf)(void *context, const struct basis *basis, mpfr_ptr value),
			  void *context)
{
	struct sample *s = NEW(struct sample);
	*s = (struct sample){ .leaf = of_leaf, .context = context, .precision = precision, .room = 1,
			      .now = { 1, 1, 1 } };
	s->table = ARRAY(struct kept, 1);
	s->forms = tape_forms_new(tape_new(), (struct tape_reader){ leaf, NULL, friction, s, false, true }, 0, NULL,
				  0, NULL);
	mpfr_init2(s->t, precision);
	return s;
}

static struct kept *place_of(const struct sample *s, const struct form *form)
{
	size_t mask = (size_t)s->room - 1, at = ((uintptr_t)form / 16 * 2654435761u >> 7) & mask;
	while (s->table[at].form && s->table[at].form != form)
		at = (at + 1) & mask;
	return &s->table[at];
}

static void make_room(struct sample *s)
{
	SCRATCH struct kept *old = s->table;
	int room = s->room;
	s->room *= 4;
	s->table = ARRAY(struct kept, s->room);
	for (int i = 0; i < room; i++)
		if (old[i].form)
			*place_of(s, old[i].form) = old[i];
}

static enum change change_of(const struct sample *s, const struct tape_node *n)
{
	const tape_ref ref[3] = { n->a, n->b, n->c };
	enum change change = n->op == TAPE_TIME				       ? IN_TIME
			     : n->op == TAPE_COORD || n->op == TAPE_INPUT      ? AT_POINTS
									       : NEVER;
	for (int k = 0; k < 3; k++)
		if (ref[k] != TAPE_NONE && s->change[ref[k]] > change)
			change = s->change[ref[k]];
	return change;
}

static tape_ref ref_of(struct sample *s, const struct form *form)
{
	struct tape *t = tape_of_forms(s->forms);
	struct kept *kept = place_of(s, form);
	if (kept->form)
		return kept->ref;
	tape_count_form(s->forms, form);
	*kept = (struct kept){ form, tape_form(s->forms, form) };
	tape_ref ref = kept->ref;
	ENLARGE(s->value, (size_t)tape_length(t));
	ENLARGE(s->change, (size_t)tape_length(t));
	ENLARGE(s->found, (size_t)tape_length(t));
	for (; s->nodes < tape_length(t); s->nodes++) {
		mpfr_init2(s->value[s->nodes], s->precision);
		s->change[s->nodes] = change_of(s, tape_node(t, s->nodes));
		s->found[s->nodes] = 0;
	}
	if (2 * ++s->kept >= s->room)
		make_room(s);
	return ref;
}

/* ---- values ---- */

static void operand(const void *context, const struct tape_node *n, mpfr_ptr value)
{
	const struct sample *s = context;
	struct basis basis = { .kind = n->op == TAPE_COORD ? BASIS_COORD : BASIS_INPUT, .index = n->index,
			       .order = n->part };
	if (n->op == TAPE_TIME)
		mpfr_set(value, s->t, MPFR_RNDN);
	else if (n->op == TAPE_COORD || n->op == TAPE_INPUT)
		s->leaf(s->context, &basis, value);
	else
		mpfr_set_nan(value);
}

/* Of a choice only what is taken is asked for */
static void find(struct sample *s, tape_ref ref)
{
	const struct tape_node *n = tape_node(tape_of_forms(s->forms), ref);
	const struct tape_values from = { operand, s };
	unsigned now = s->now[s->change[ref]];
	if (s->found[ref] == now)
		return;
	s->found[ref] = now;
	s->work += n->op >= TAPE_NEG && n->op != TAPE_ADD;
	if (n->a != TAPE_NONE)
		find(s, n->a);
	if (n->op == TAPE_SELECT && !mpfr_nan_p(s->value[n->a]))
		find(s, mpfr_zero_p(s->value[n->a]) ? n->c : n->b);
	else if (n->op != TAPE_SELECT && n->b != TAPE_NONE)
		find(s, n->b);
	tape_node_mpfr(n, &from, s->value, s->value[ref]);
}

long sample_work(const struct sample *s)
{
	return s->work;
}

void sample_at(struct sample *s, mpfr_srcptr t)
{
	s->now[IN_TIME] += !mpfr_equal_p(s->t, t);
	s->now[AT_POINTS]++;
	mpfr_set(s->t, t, MPFR_RNDN);
}

void sample_form(struct sample *s, const struct form *form, mpfr_ptr value)
{
	tape_ref ref = ref_of(s, form);
	find(s, ref);
	mpfr_set(value, s->value[ref], MPFR_RNDN);
}
