/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equations of motion from energies. */
#ifndef PLGEN_MODEL_LAGRANGE_H
#define PLGEN_MODEL_LAGRANGE_H

struct building;
struct form;
struct segment_equations;

/* Per coordinate: what the energies, the forces at points and constraints add to the left side of its equation [N, or
 * N m]; the constraints into `s` */
struct form **lagrange_terms(struct building *b, struct segment_equations *s);

#endif
