#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# `range`: the status of a model says at the end of which step a state that NAME_get gives is outside, and from then
# on; in each kind of step, by NAME_step and by NAME_run.
#
#     ranges.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"

cat >look.c <<'EOF'
#include "plrt.h"
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
enum { MOST_STATES = 64, STEPS = 400 };

static int outside(const void *s)
{
    real y[MOST_STATES];
    the_model.get(s, y);
    return y[STATE] < (real)LOW || y[STATE] > (real)HIGH;
}

int main(void)
{
    static const real samples[4 * STEPS];
    const descriptor *m = &the_model;
    void *s = malloc(m->size), *run = malloc(m->size);
    real y[MOST_STATES];
    int k, left = 0, bad = 0;
    m->init(s);
    for (k = 1; k <= STEPS; k++) {
        m->step(s, samples);
        left = left ? left : outside(s) ? k : 0;
        if ((m->status(s) & PL_LEFT_RANGE) != (left ? PL_LEFT_RANGE : 0) && bad++ < 3)
            printf("step %d: status %d, outside since step %d\n", k, m->status(s), left);
    }
    if (left < 2)
        printf("it has left its range at step %d\n", left);
    for (k = left - 1; left > 1 && k <= left; k++) {
        m->init(run);
        m->run(run, (size_t)k, samples, NULL);
        if ((m->status(run) & PL_LEFT_RANGE) != (k < left ? 0 : PL_LEFT_RANGE) && bad++ < 5)
            printf("run of %d steps: status %d\n", k, m->status(run));
    }
    m->get(s, y);
    y[STATE] = (real)(0.5 * (LOW + HIGH));
    m->set(s, 0, y);
    if (m->status(s) != 0 && bad++ < 6)
        printf("status %d after set\n", m->status(s));
    return bad != 0 || left < 2;
}
EOF

# looks NAME STATE LOW HIGH [OPTIONS]: of one.spec; its state of this number is to leave LOW .. HIGH
looks() {
	name=$1
	flags="-DSTATE=$2 -DLOW=$3 -DHIGH=$4"
	shift 4
	case "$*" in *float*) flags="$flags -DFLOAT" ;; esac
	# shellcheck disable=SC2086
	"$plgen" --prefix the "$@" one.spec >one.c 2>log &&
		$run_cc $flags -I"$root/runtime" look.c one.c "$archive" -lm -o look 2>>log && timeout 60 ./look >>log
	result $? "$name: the step that leaves the range"
}

spec() {
	{ echo 'model m'; cat; } >one.spec
}

linear() {
	spec <<EOF
param most = 0.4
coord x, y
init x = 1, y' = 0.3
x'' + 0.02*x' + 4*x - y = cos(t)
y'' + 3*y - x = 0
step 0.05
range x' in [-2, 3*most], y in [-9, 9]
$1
EOF
}
for form in auto direct delta modal; do
	linear ''
	looks "linear, $form" 2 -2 1.2 --form $form
done
looks 'linear, compensated' 2 -2 1.2 --accuracy compensated
looks 'linear, in float' 2 -2 1.2 --real float
looks 'linear, another param' 2 -2 0.9 -D most=0.3
for scheme in pl etdrk4 nc3 bm3 taylor 'taylor 8' radau etdam4; do
	linear ''
	looks "linear, $scheme" 2 -2 1.2 --scheme "$scheme"
done
spec <<'EOF'
param k = 4
tunable k
coord x
init x = 1
input u hold first
x'' + 0.02*x' + k*x = u + (t < 1 ? 2*t : 2)
step 0.05
range x in [-0.2, 1.05]
EOF
looks 'linear, tunable, a load that changes' 0 -0.2 1.05
spec <<'EOF'
coord x, y
init x' = 1
x'' + x - y = 0
y'' + y - x = 0.1
step 0.05
range y in [-1, 2]
EOF
looks 'moving as a whole' 1 -1 2
spec <<'EOF'
coord q[20]
init q[1] = 1
matrix K = "K.mtx"
q'' + K*q = 0
step 0.05
range q[3] in [-0.1, 0.2], q' in [-5, 5]
EOF
{
	echo '%%MatrixMarket matrix coordinate real symmetric'
	echo '20 20 39'
	i=1
	while [ $i -le 20 ]; do
		echo "$i $i 2"
		[ $i = 1 ] || echo "$i $((i - 1)) -1"
		i=$((i + 1))
	done
} >K.mtx
looks 'many states' 2 -0.1 0.2

spec <<'EOF'
coord x, y
init x = 1
x'' + 0.1*x' + x + 10*max(x - 0.5, 0) = cos(t)
y'' + y + friction(y', 0.1) = sin(t)
step 0.05
range y in [-0.2, 0.7]
EOF
looks 'regions, parts' 1 -0.2 0.7
spec <<'EOF'
coord x
init x = 1
x'' + 0.1*x' + x + 10*max(x - 0.5, 0) = cos(t)
step 0.05
range x' in [-1, 0.9]
EOF
looks 'regions' 1 -1 0.9
curved() {
	spec <<EOF
coord x
init x = 1
x'' + 0.1*x' + x^3 + 10*max(x - 0.5, 0) = cos(t)
step 0.05
range x' in [-1, 0.9]
scheme $1
EOF
}
for scheme in taylor 'taylor 8' radau auto etdrk2; do
	curved "$scheme"
	looks "from crossing to crossing, $scheme" 1 -1 0.9
done
spec <<'EOF'
coord x
init x = 1
x'' + 0.1*x' + x^3 = 0
step 0.05
scheme taylor 6 over 3
range x in [-0.6, 1.1]
EOF
looks 'a series over several steps' 0 -0.6 1.1
sed -i '/^scheme/s/.*/scheme etdam4/' one.spec
looks 'forces of past steps' 0 -0.6 1.1
spec <<'EOF'
coord x
init x = 1
input u
x'' + x = u(t - 0.03) + x*u
step 0.05
scheme taylor
range x in [-0.6, 1.1]
EOF
looks 'an input some time ago' 0 -0.6 1.1

# ---- a part of a scene, and what the commands say ----

cat >part.spec <<'EOF'
model part
coord x
init x = 1
x'' + 4*x = 0
step 0.01
range x in [-0.5, 1]
EOF
cat >one.spec <<'EOF'
model m
use "part.spec" as a
use "part.spec" as b with x = 0.25
output a.x, b.x
step 0.05
EOF
looks 'a part' 0 -0.5 1
echo 'range a.x in [-2, 2], b.x in [-0.1, 1]' >>one.spec
looks 'given again by the scene' 1 -0.1 1

tap_end
