#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# NAME_status of what is not linear: while a state is infinite or not a number, as <math.h> sees it, PL_NOT_FINITE is
# among the bits; from states that are not finite, and from finite ones that grow beyond the range, in each scheme.
# Series and collocations then stay at the last good state, which is finite. No step and no value between steps takes
# forever.
#
#     not_finite.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"

cat >look.c <<'EOF'
#include "plrt.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef FLOAT
typedef float real;
typedef pl_modelf descriptor;
#else
typedef double real;
typedef pl_model descriptor;
#endif

extern const descriptor the_model;
enum { MOST_STATES = 16 };

static int not_finite(const void *s)
{
	real y[MOST_STATES];
	int i, found = 0;
	the_model.get(s, y);
	for (i = 0; i < the_model.states; i++)
		found |= !isfinite(y[i]);
	return found;
}

/* State k is `value` at the start; 1 where something was not finite and the status silent, or the last good state not
 * kept */
static int silent(void *s, int k, real value)
{
	static const real samples[4] = {1, 1, 1, 1};
	const descriptor *m = &the_model;
	real y[MOST_STATES], between[MOST_STATES];
	int i, found = 0, bad = 0;
	m->init(s);
	m->get(s, y);
	y[k] = value;
	m->set(s, 0, y);
	for (i = 0; i < 6; i++) {
		found = not_finite(s);
		if (found && !(m->status(s) & PL_NOT_FINITE) && !bad++)
			printf("state %d = %g, step %d: status %d\n", k, (double)value, i, m->status(s));
		if (KEEPS && found && isfinite(value) && !bad++)
			printf("state %d = %g, step %d: a state is not finite\n", k, (double)value, i);
		if (m->at)
			m->at(s, m->inputs ? samples : NULL, m->h / 2, between);
		m->step(s, m->inputs ? samples : NULL);
	}
	return bad;
}

int main(void)
{
	const real odd[3] = {(real)INFINITY, (real)-INFINITY, (real)NAN};
	void *s = malloc(the_model.size);
	int bad = 0, k, i;
	for (k = 0; k < the_model.states; k += APART > 8 ? 5 : 1) {
		for (i = 0; i < 3; i++)
			bad += silent(s, k, odd[i]);
		for (i = 5; i < (sizeof(real) == 4 ? 38 : 308); i += (sizeof(real) == 4 ? 3 : 9) * APART)
			bad += silent(s, k, (real)pow(10, i)) + silent(s, k, (real)-pow(10, i));
	}
	free(s);
	return bad != 0;
}
EOF

# looks SCHEME REAL: of model.spec
looks() {
	[ "$2" = double ] && flag= || flag=-DFLOAT
	(cat model.spec; echo "scheme $1") >one.spec
	case $1 in taylor* | radau | auto) keeps=1 ;; *) keeps=0 ;; esac
	# shellcheck disable=SC2086
	"$plgen" --prefix the --real "$2" one.spec >one.c 2>log &&
		$run_cc $flag -DKEEPS=$keeps -DAPART=$apart -I"$root/runtime" look.c one.c "$archive" -lm \
			-o look 2>>log &&
		timeout 120 ./look >>log
	result $? "$title, $1, $2: what is not finite is told"
}

# each TITLE SCHEME ...: in both types; in `make check` by turns
turn=0
# powers of ten: with LONG=1 in the environment each ninth, of floats each third, else every second of these
apart=2
[ -z "${LONG:-}" ] || apart=1
usual=$apart
each() {
	title=$1
	shift
	for scheme; do
		for real in double float; do
			turn=$((turn + 1))
			[ -z "${LONG:-}" ] && [ $(((turn + turn / 2) % 2)) = 1 ] || looks "$scheme" $real
		done
	done
}

spec() {
	{ echo 'model m'; cat; echo 'step 0.01'; } >model.spec
}

spec <<'EOF'
coord x
init x = 1
x'' + x'^3 = 0
EOF
each 'drag' taylor 'taylor 8' 'taylor 6 over 3' radau auto etdrk4

spec <<'EOF'
coord x, y
init x = 1
x' + x^3 - y = 0
y' + y = t < 0.02 ? 1 : cos(t)
EOF
each 'of first order' taylor auto radau

spec <<'EOF'
coord x
init x = 1
x'' + 0.1*x' + x^3 + friction(x', 0.3) = cos(t)
stop between x, ground at 2 restitution 0.5
EOF
each 'friction and a stop' taylor 'taylor 8'

spec <<'EOF'
coord x
init x = 1
x'' + 0.1*x' + x^3 + 10*max(x - 0.5, 0) = cos(t)
EOF
each 'from crossing to crossing' taylor auto radau etdrk2

spec <<'EOF'
coord q[6]
init q[1] = 1
q[1]'' + q[1]^3 + (q[1] - q[2])^3 = 0
q[2]'' + q[2]^3 + (q[2] - q[1])^3 + (q[2] - q[3])^3 = 0
q[3]'' + q[3]^3 + (q[3] - q[2])^3 + (q[3] - q[4])^3 = 0
q[4]'' + q[4]^3 + (q[4] - q[3])^3 + (q[4] - q[5])^3 = 0
q[5]'' + q[5]^3 + (q[5] - q[4])^3 + (q[5] - q[6])^3 = 0
q[6]'' + q[6]^3 + (q[6] - q[5])^3 = 0
EOF
[ "${LONG:-}" ] || apart=16       # twelve states, and steps that are halved until they are given up
each 'a chain' auto
apart=$usual

spec <<'EOF'
param k = 2
tunable k
coord x, y
input u
init x = 1
x'' + k*(x - y)^3 = u
y'' + k*(y - x)^3 = 0
EOF
each 'tunable, moving as a whole' taylor
[ "${LONG:-}" ] || apart=12       # as above
each 'tunable, moving as a whole' auto
apart=$usual

spec <<'EOF'
coord x, y
init x = 1
x'' + x' + 4*x - y + x^3 = cos(t)
y'' + y - x = sin(t)
EOF
each 'normal modes' etdam4 etdcol

spec <<'EOF'
coord x, y
init x = 1
x'' + 0.1*x' + x + 10*max(x - 0.5, 0) = cos(t)
y'' + y + friction(y', 0.1) = 0
EOF
each 'regions, friction' exact

tap_end
