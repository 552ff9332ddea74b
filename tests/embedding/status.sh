#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# NAME_status of linear models, in every form: what <math.h> says of the state that NAME_get gives; nothing in NAME_step
# knows of it.
#
#     status.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"

cat >look.c <<'EOF'
#include "linear_pl.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#ifdef FLOAT
typedef float real;
typedef pl_modelf descriptor;
#else
typedef double real;
typedef pl_model descriptor;
#endif

enum { N = LINEAR_STATES };
static int bad;
static const real no_samples[LINEAR_INPUTS + 1];

/* Status against the states, each of them looked at by isfinite */
static int look(const linear *s, const char *when, int k)
{
	const descriptor *m = &linear_model;
	real y[N];
	int i, expected = 0;
	linear_get(s, y);
	for (i = 0; i < N; i++)
		if (!isfinite(y[i]))
			expected = PL_NOT_FINITE;
	if ((linear_status(s) != expected || m->status(s) != expected) && bad++ < 5)
		printf("%s %d: found %d, the descriptor %d, expected %d\n", when, k, linear_status(s),
			m->status(s), expected);
	return expected;
}

int main(void)
{
	const descriptor *m = &linear_model;
	const real odd[3] = {(real)INFINITY, (real)-INFINITY, (real)NAN};
	static linear s, saved;
	real y[N];
	int i, k, left = -1;
	m->init(&s);
	look(&s, "after init", 0);
	for (k = 0; k < 500; k++) {
		m->step(&s, LINEAR_INPUTS ? no_samples : NULL);
		look(&s, "after step", k);
	}
	for (i = 0; i < 3 * N; i++) {
		memset(y, 0, sizeof y);
		y[i / 3] = odd[i % 3];
		m->set(&s, 1, y);
		if (look(&s, "set with one that is not finite", i) != PL_NOT_FINITE)
			bad = 1;
		saved = s;
		m->init(&s);
		look(&s, "init again", i);
		look(&saved, "the copy", i);
	}
#ifdef COMPENSATED
	for (i = 0; i < N; i++) {
		m->init(&s);
		s.low[i] = (real)NAN;
		if (linear_status(&s) != PL_NOT_FINITE && bad++ < 5)
			printf("low[%d] not a number: found %d, expected %d\n", i, linear_status(&s), PL_NOT_FINITE);
	}
#endif
	/* out of range step by step, where the model grows */
	for (i = 0; i < N; i++)
		y[i] = (real)(sizeof(real) == 4 ? 3e38 : 1e308) / (real)(i + 2);
	m->set(&s, 0, y);
	for (k = 0; k < 200 && left < 0; k++) {
		m->step(&s, LINEAR_INPUTS ? no_samples : NULL);
		if (look(&s, "growing, step", k) != 0)
			left = k;
	}
	printf("left the finite numbers at step %d\n", left);
#ifdef GROWS
	bad |= left < 0;
#endif
	return bad != 0;
}
EOF

printf "model linear\ncoord x, y\ninit x = 1\nx'' - 9*x + y = 0\n" >grows.spec
printf "y'' + 0.1*y' + 4*y - x = cos(t)\nstep 0.1\n" >>grows.spec

# looks TITLE SPEC FLAGS OPTIONS: in double and float
looks() {
	title=$1
	spec=$2
	flags=$3
	shift 3
	for real in double float; do
		own=
		[ $real = double ] || own=-DFLOAT
		# shellcheck disable=SC2086
		"$plgen" --prefix linear --real $real "$@" -o linear_pl.c "$spec" 2>log &&
			$run_cc $flags $own -I"$root/runtime" look.c linear_pl.c "$archive" -lm \
				-o look >>log 2>&1 &&
				./look >>log
		result $? "$title, $real: status is what the state says"
		sed -n '/^void linear_step/,/^}/p; /^static void linear_plain_step/,/^}/p' linear_pl.c >log
		[ -s log ] && ! grep -q 'status\|not_finite' log
		result $? "$title, $real: a step does nothing for it"
	done
}
looks 'delta' grows.spec -DGROWS --form delta
looks 'direct' grows.spec -DGROWS --form direct
looks 'delta, compensated' grows.spec '-DGROWS -DCOMPENSATED' --form delta --accuracy compensated
looks 'kick, drift, kick' "$root/models/scs.spec" ''
looks 'kick, drift, kick, compensated' "$root/models/scs.spec" -DCOMPENSATED --accuracy compensated
looks 'masses in the state' "$(path_of tests/forms/equal_held.spec)" ''
looks 'momentum kept' "$(path_of tests/forms/loose.spec)" ''
looks 'momentum kept, compensated' "$(path_of tests/forms/loose.spec)" -DCOMPENSATED --accuracy compensated
looks 'more than 16 states' "$(path_of tests/forms/large.spec)" ''
looks 'tunable' "$(path_of tests/tunable/held.spec)" ''
looks 'ramps, changing loads' "$(path_of tests/emitted/linear/switched.spec)" ''

# ---- a run ends where it shows ----

: >log
"$plgen" grows.spec >grows.c 2>>log && \
	$run_cc -I"$root/runtime" -DMODEL=linear "$root/runtime/host/plmain.c" grows.c "$archive" \
		-o run >>log 2>&1
./run 400 >out.csv 2>said
status=$?
cat said >>log
[ $status -eq 1 ] && grep -q '^linear: error: t = [0-9.]*: the step has left the finite numbers$' said &&
	[ "$(wc -l <out.csv)" -gt 2000 ] && ! grep -q -i -e nan -e inf out.csv
result $? 'plmain: a linear model that grows ends there, the rows before it written'

tap_end
