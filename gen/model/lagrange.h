/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equations of motion from energies. */
#ifndef PLGEN_MODEL_LAGRANGE_H
#define PLGEN_MODEL_LAGRANGE_H

struct building;
struct form;

/* Per coordinate: what the energies and the forces at points add to the left side of its equation [N, or N m] */
struct form **lagrange_terms(struct building *b);

#endif
