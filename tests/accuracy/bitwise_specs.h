/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BITWISE_SPECS_H
#define BITWISE_SPECS_H

#include <stddef.h>

/* Models in which naive closed forms break down: resonance, repeated and nearly repeated poles, pole 0, growth,
 * stiffness. */
struct bitwise_spec {
	const char *name, *text;
	enum {
		PLAIN,
		CRITICAL,               /* one coordinate with Phi_22 = 0 at the step as written */
		EXACT                   /* A is nilpotent: every number is rational */
	} kind;
};
extern const struct bitwise_spec bitwise_specs[];
extern const size_t bitwise_spec_count;

#endif
