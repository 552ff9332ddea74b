#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# fading.sh PLGEN FADING SOURCE: friction whose forces are formulas of time, which fall to 0 and below one another:
# beside closed forms from event to event (fading.c), in regions and by series, at steps short and long; and such forces
# of sliders without mass. $CC compiles, $PLRT is the runtime.
fading=$(realpath "$2")
root=$3
. "${0%/*}/../plgen.sh"
cat >drive.c <<'END'
#include "m.h"
#include <stdio.h>
#include <stdlib.h>
int main(int count, char **argument)
{
	m s;
	m_init(&s);
	for (long k = count > 1 ? atol(argument[1]) : 0; k > 0; k--)
		m_step(&s);
	printf("%.17g %.17g %d\n", (double)s.y[0], (double)s.y[1], m_status(&s));
	return 0;
}
END

# run NAME TOLERANCE STEPS H OPTION...: of $equation beside $truth
run() {
	name=$1 tolerance=$2 steps=$3 h=$4
	shift 4
	printf 'model m\ncoord x\n%s\ninit x = %s\n' "$equation" "$x" >m.spec
	"$plgen" "$@" --step "$h" m.spec -o m.c >log 2>&1 &&
		$run_cc -I. -I"$root/runtime" -o drive drive.c m.c "$archive" -lm >>log 2>&1 &&
		{ "$fading" $numbers "$x" "$steps" "$h"; ./drive "$steps"; } >both &&
		awk -v most="$tolerance" 'NR == 1 { x = $1; v = $2 }
			NR == 2 { good = ($1 - x)^2 + ($2 - v)^2 <= most^2 && $3 == 0 }
			END { exit !good }' both
	good=$?
	cp both log
	result "$good" "$name, h = $h $*"
}

# friction NAME F0 F1 S0 S1 C W X
friction() {
	chosen "$1" || return
	x=$8
	numbers="$2 $3 $4 $5 $6 $7"
	equation="x'' + x + friction(x', $2 + ($3)*t, $4 + ($5)*t) = $6*cos($7*t)"
	run "$1" 1e-12 150 0.1
	run "$1" 1e-12 40 0.37
	run "$1" 2e-5 150 0.1 --real float
	run "$1" 1e-10 150 0.1 --scheme taylor --tolerance 1e-13
	run "$1" 1e-10 40 0.37 --scheme 'taylor 24'
}

friction rises 0.2 0.06 0.3 0.06 1.4 0.7 1
friction fades 0.3 -0.05 0.3 -0.05 0.5 0.6 1
friction 'holds less' 0.3 0 0.5 -0.04 0.5 0.7 1
friction 'fades, holds less' 0.4 -0.03 0.6 -0.06 0.6 0.4 0.3
friction 'comes to hold more' 0.3 0.02 0.1 0.06 1.1 0.7 1

# A slider without mass, held up to FORCE, of t or the state, with a damper beside it: after a second by the midpoint
# rule in 40,000 steps
slider() {
	chosen "slider, $1" || return
	cat >m.spec <<-END
		model m
		coord x, z
		init x = 1
		x'' + 10*x + 5*(x - z) = 0
		friction(z', $1) + 0.3*z' = 5*(x - z)
	END
	awk 'function rate(t, x, z) { g = 5*(x - z); f = '"$1"'; return g > f ? (g - f)/0.3 : g < -f ? (g + f)/0.3 : 0 }
		BEGIN { h = 1/40000; x = 1
			for (k = 0; k < 40000; k++) {
				t = k*h; X = x + h/2*v; V = v - h/2*(10*x + 5*(x - z)); Z = z + h/2*rate(t, x, z)
				v -= h*(10*X + 5*(X - Z)); z += h*rate(t + h/2, X, Z); x += h*V
			}
			printf "%.12g %.12g\n", x, z }' >truth
	for h in 0.01 0.1; do
		"$plgen" --step $h m.spec -o m.c >log 2>&1 &&
			$run_cc -I. -I"$root/runtime" -o drive drive.c m.c "$archive" -lm >>log 2>&1 &&
			./drive "$(echo $h | awk '{ print 1/$1 }')" >found &&
			cat truth found >>log && paste -d' ' truth found |
			awk '{ exit !(($1 - $3)^2 + ($2 - $4)^2 <= 1e-16 && $5 == 0) }'
		result $? "slider, $1, h = $h"
	done
}
slider '2 + cos(3*t)'
slider '2 + x'
tap_end
