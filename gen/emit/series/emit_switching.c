/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formulas that the state chooses: what a model keeps of them, and where a series ends that goes on with others. */
#include "series.h"
#include "emit/text.h"
#include "model/contacts/contacts.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "step/contacts/series_contacts.h"

static const struct expansion *expansion(const struct emitter *e)
{
	return e->step->taylor.switching;
}

/* ---- the header ---- */

void emit_switching_types(const struct emitter *e)
{
	if (!has_switching(e))
		return;
	say(e, "typedef struct $n_contact {  /* by which formulas the model goes, and what it has crossed */\n"
	       "    uint64_t total;       /* crossings since init or set */\n"
	       "    int crossings;        /* in the last step */\n"
	       "    int placed;           /* 0: a state was set, its intervals are not known%s */\n"
	       "%s%s%s"
	       "    int interval[%d];      /* of each switching function */\n"
	       "    pl_crossing last;     /* which the state may not have left behind; expression -1: none */\n"
	       "    pl_crossing crossing[$N_MAX_EVENTS];  /* of the last step */\n"
	       "} $n_contact;\n\n",
	    meets_contacts(e) && e->step->collocation ? "; 2: they may be others"
	    : e->step->taylor.expansion || !e->step->collocation ? ""
		: "; below 0: nor where that goes which is on a breakpoint",
	    meets_contacts(e) ? "    int rested;           /* contacts by infinitely many bounces, since then */\n"
	    : "",
	    !meets_contacts(e) || !e->step->collocation
		? "" : "    pl_chain chain;       /* impacts that follow each other */\n",
	    moves_derivatives(e) ? "    pl_doubt doubt;       /* of derivatives, in the last step */\n" : "",
	    expansion(e)->functions);
}

void emit_switching_members(const struct emitter *e)
{
	say(e, "    $n_contact contact;   /* intervals, crossings */\n");
}

void emit_crossing_declarations(const struct emitter *e)
{
	if (!has_switching(e) || regions_of_series(expansion(e)))
		say(e, "int    $n_region(const $n *s);           "
		       "/* its number: an interval of each switching function */\n");
	say(e, "uint64_t $n_crossed(const $n *s);        /* breakpoints crossed since init or set */\n"
	       "int    $n_crossings(const $n *s, pl_crossing crossing[$N_MAX_EVENTS]);  "
	       "/* those of the last step, by time; how many */\n");
	if (has_bounces(e->model))
		say(e, "int    $n_rested(const $n *s);           "
		       "/* contacts that came to rest since then, after infinitely many bounces */\n");
}

void emit_switching_declarations(const struct emitter *e)
{
	if (has_switching(e))
		emit_crossing_declarations(e);
}

/* ---- tables ---- */

void emit_switching_tables(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	int *column = ARRAY(int, (size_t)x->functions), *breaks = ARRAY(int, (size_t)x->functions), all = 0;
	for (int i = 0; i < x->functions; i++) {
		column[i] = x->function[i].column;
		all += breaks[i] = x->function[i].breaks;
	}
	double *at = ARRAY(double, (size_t)all + 1), *to = at;
	for (int i = 0; i < x->functions; i++) {
		mpq_t *rising = rising_breakpoints(&x->function[i]);
		for (int k = 0; k < breaks[i]; k++)
			*to++ = round_rational(rising[k]);
	}
	say(e, "\n/* Of the switching functions: breakpoints, in a series the column of each */\n");
	emit_int_list(e, "breaks", x->functions, breaks);
	emit_array(e, NULL, "breakpoint", 1, &all, at, NULL);
	if (!e->step->taylor.expansion)
		return;
	emit_int_list(e, "column", x->functions, column);
	say(e, "static const pl_series_switching $n_series_switching = {%d, $c, %d, $n_column, $n_breaks, "
	       "$n_breakpoint};\n", x->functions, x->order);
}

void emit_switching_macros(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	say_macro(e, "CHANGES", integer_text(most_changes(x)));
	say_macro(e, "MAX_EVENTS", spell(e, "$N_MAX_EVENTS"));
	say_macro(e, "REGIONS", integer_text(regions_of_series(x) > 0));
	say_macro(e, "BOUNCES", integer_text(has_bounces(e->model)));
	if (meets_contacts(e))
		say_macro(e, "HELD", integer_text(x->contacts->holds));
}

void emit_passing_table(const struct emitter *e, int order)
{
	const int count = expansion(e)->functions;
	say(e, "\n/* Of polynomials of each */\n");
	emit_int_list(e, "each", count, numbers_up_to(count));
	say(e, "static const pl_series_switching $n_passing = {%d, %d, %d, $n_each, $n_breaks, $n_breakpoint};\n",
	    count,
	    terms_of_events(e), order);
}
