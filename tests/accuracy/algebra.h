/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The judge's own algebra, which shares nothing with the generator's: exact rows, load states, residues modulo a prime.
 */
#ifndef ALGEBRA_H
#define ALGEBRA_H

#include "model/model.h"
#include "evaluator.h"

struct load;

void add_product(mpq_ptr sum, mpq_srcptr a, mpq_srcptr b, bool subtract);   /* sum +- a b */
bool eliminate(size_t rows, size_t width, mpq_t *W); /* its left square part made the identity; false: it is singular */

/* The highest derivative of each coordinate as a row: over the states, without sign, by the operator K, C; the load
 * columns of a segment; u and u' of every input; `forces` columns, each a force on its row. A coordinate of first order
 * is solved for its derivative, whose factor stands in the system's C and is no part of an operator. NULL: singular */
mpq_t *highest_rows(const struct linear *system, const mpq_t *K, const mpq_t *C, int segment, int forces,
					const int *row, size_t *width);

/* z = t^k e^{at} cos(wt+p) and sin, or t^k e^{at} alone, into A (size a row): z' = a z + k (z of k - 1) -+ w (its
 * partner) */
void fill_load_states(const struct load *load, size_t size, mpq_t *A);

/* Modulo PRIME, of 61 bits: what is 0 at every tau is told by powers of A (Cayley and Hamilton) */
#define PRIME ((UINT64_C(1) << 61) - 1)
uint64_t times(uint64_t a, uint64_t b);
uint64_t residue(mpq_srcptr q);

void add_entry(mpfi_ptr x, const evaluator_enclosure *E, size_t entry, mpq_srcptr factor); /* x + (entry of E) factor */

#endif
