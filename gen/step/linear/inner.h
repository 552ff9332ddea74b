/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of step/linear have from one another, and nobody else. */
#ifndef PLGEN_STEP_LINEAR_INNER_H
#define PLGEN_STEP_LINEAR_INNER_H

#include "forms.h"
#include "images.h"

/* ---- refresh.c: functions of loads every so many steps, tables between ---- */

void leave_out_refresh(struct step *step, const char *why);

/* ---- stepform.c: a linear step as direct, delta or kick-drift-kick ---- */

/* The step is built again in another form; where forms are tried in turn, this one is refused. */
_Noreturn void leave_form(struct step *step, const char *why);

/* ---- large.c: a large step by its independent blocks ---- */

void find_groups(struct program *program, const struct step *step);     /* and what they cost */

/* ---- modal.c: a step of modes instead of states ---- */

struct modal *modal_of(const struct step *step);             /* NULL: a number is not decided */

/* Where the response of this number to a state or load of `system` is kept for who asks again: NULL at first, and for
 * another system than before. Of many states none is. */
struct response **response_kept(struct resolvent *r, const struct linear *system, int number);
struct spectrum *resolvent_spectrum(const struct resolvent *r);                /* of B(s) */
/* A response to this less what swings with the excitation alone; NULL: poles of B swing so, too */
struct response *transient_of(const struct resolvent *r, const struct response *whole, const struct excitation *e);

/* ---- loads.c: loads, inputs and held terms as excitations of a step ---- */

/* Phi_ij, held terms included */
struct response *response_of_state(struct resolvent *r, const struct linear *system, int i, int j);
struct response *response_of_load(struct resolvent *r, const struct linear *system, int segment, int i, int load,
				  int column);
struct response *response_of_phi_weight(struct resolvent *r, const struct linear *system, int i, int force_column,
				    const struct phi_weight_part *part, mpq_srcptr h);
/* what an output is after tau: from these states alone; from a load state 1, and these states (NULL: 0), in the first
 * segment of time; of an input u = value + slope tau, from rest */
struct response *output_of_states(struct resolvent *r, const struct output *output, const mpq_t *initial);
struct response *output_of_load(struct resolvent *r, const struct linear *system, const struct output *output, int load,
				int column, const mpq_t *initial);

/* ---- numbers.c: a number of a step before it is rounded ---- */

struct coefficient;

enum { FIRST_PRECISION = 128 };     /* doubled while a number is not decided */

/* Sums of responses at a time, or combinations of entries of e^{A tau} */
struct entry {                      /* weight e^{A tau}[row][column] */
	struct taylor *taylor;
	int column;
	mpq_t weight;
};
struct number {
	int count;
	const struct started *list; /* responses, each from its own start to t */
	mpq_srcptr t;
	const struct entry *entry;  /* or, if not NULL, entries of one row */
	int row;
	mpq_srcptr scale;           /* of the sum, then */
	mpq_srcptr less;            /* is subtracted; NULL: 1 and 0 */
};

/* In so many bits; false: that is beyond the method's limits */
bool enclose_number(const struct number *n, int precision, mpfi_ptr sum);
/* Once, correctly, and in two words where wanted; false: not decided, *isolated says whether the poles were */
bool round_number(const struct number *n, bool two_words, int limit, struct coefficient *c, bool *isolated);

_Noreturn void undecided(struct place at, const char *what, bool isolated);
/* Refuses what is beyond the range of the target, with the pole that it comes from. list: responses, `count` of them */
void check_range(const struct model *model, const struct coefficient *c, int count, const struct started *list,
		 const char *what);

/* ---- resolvent.c ---- */

/* B(s) = det P, as many as its degree + 1 */
void characteristic_polynomial(const struct resolvent *r, mpq_t *coefficient);
const struct poly *resolvent_determinant(const struct resolvent *r);           /* B(s) times the scales of the rows */

#endif
