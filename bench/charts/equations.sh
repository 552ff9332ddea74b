#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# equations.sh PLGEN HEADER EACH SPEC...: the equations of smooth models as plgen prints them, NAME_rhs and the slopes
# of scheme radau, as functions that a peer compiles together with its stepper, as plgen's step is: what a user of that
# method writes by hand. Each file that includes HEADER has its own copies. A peer is instantiated for every name of
# EQUATIONS, and goes through NAME_rhs for a problem that is not in it; EACH includes a stepper once a model
# (instances.h). tests/charts/peers.c holds the derivatives against differences; truth.c has the equations by hand.
#
#     NAME_slopes(t, y, f)           f = y' at y = n coordinates, n velocities
#     NAME_jacobian(t, y, Jq, Jv)    derivatives of the accelerations, n x n, row-major
set -e
plgen=$1 header=$2 each=$3
shift 3
{
	cat <<-EOT
	/* Printed by equations.sh. NUMBER: double, or what includes this has defined; EXACTLY: a constant of it */
	#ifndef EQUATIONS_H
	#define EQUATIONS_H
	#include <math.h>
	#ifndef INLINE
	#define INLINE static inline __attribute__((always_inline))
	#endif
	#ifndef NUMBER
	#define NUMBER double
	#define EXACTLY(x) (x)
	#else
	#include <tgmath.h>
	#define EXACTLY(x) x##L
	#endif
	EOT
	for spec; do
		name=$(basename "$spec" .spec)
		"$plgen" --scheme radau --tolerance 1e-6 --rhs --prefix "$name" "$spec" 2>/dev/null |
			awk -v name="$name" -f "${0%/*}/equations.awk"
	done
	echo '/* name, coordinates; and those whose accelerations depend on time and coordinates alone */'
	for list in EQUATIONS:OF EQUATIONS_WITHOUT_VELOCITY:ALONE; do
		printf '#define %s(X)' "${list%:*}"
		for spec; do printf ' %s_%s(X)' "${list#*:}" "$(basename "$spec" .spec)"; done
		echo
	done
	echo '#endif'
} >"$header"
for spec; do printf '#define MODEL %s\n#include "instances.h"\n' "$(basename "$spec" .spec)"; done >"$each"
