#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# large.sh PLGEN ROOT, the runtime's library in PLRT: models of more than 16 states. Independent blocks step as each
# of them does alone, bit for bit where the block is done alike; modes step as states do; where they cannot they stand
# aside.
set -u
plgen=$(realpath "$1") || exit 99
root=$(cd "$2" && pwd) || exit 99
library=$PLRT
. "$root/tests/run_cc.sh"
. "$root/tests/tap.sh"

# oscillators N: damped, each with a frequency of its own, all driven by one input
oscillators() {
	echo "model oscillators"
	awk -v n="$1" 'BEGIN {
		for (i = 1; i <= n; i++) list = list (i > 1 ? ", " : "") "x" i
		print "coord " list "\ninput a"
		for (i = 1; i <= n; i++)
			print "x" i "\47\47 + " 0.1 * i "*x" i "\47 + " 30 + 10 * i "*x" i " = -a"
		print "step 0.01"
	}'
}

# count N EXPECTED: multiplications of a step
count() {
	oscillators "$1" >o.spec
	"$plgen" o.spec 2>log | sed -n 's/.*: \([0-9]*\) multiplications, .*/\1/p' >found
	echo "found $(cat found), expected $2" >>log
	[ "$(cat found)" = "$2" ]
	result $? "$1 oscillators under one input take $2 multiplications"
}

# Equations of the parts: alike oscillators, a few masses, a chain; each numbered by the first argument's list.
alike() {
	for i in 1 2 3 4 5; do
		echo "x$i'' + 0.$i*x$i' + ${i}0*x$i = u + ${i}*cos(3*t)"
		echo "init x$i = 0.$i, x$i' = -1"
	done
}
few() {
	echo "r1'' + 0.3*r1' + 20*r1 - 8*r2 = cos(3*t)"
	echo "2*r2'' + 0.1*r2' + 30*r2 - 8*r1 - 3*r3' = u"
	echo "r3' + 4*r3 - r2 = 0.5"
	echo "init r1 = 1, r3 = -0.2"
}
chain() {
	for i in 1 2 3 4 5 6 7 8 9; do
		left=$([ $i -gt 1 ] && echo "- 30*c$((i - 1))")
		right=$([ $i -lt 9 ] && echo "- 30*c$((i + 1))")
		echo "c$i'' + 0.1*c$i' + 7$i*c$i $left $right = $([ $i = 4 ] && echo 'u + cos(3*t)' || echo 0)"
	done
	echo "init c9 = 2"
}

# part NAME COORDS EQUATIONS [OPTION ...]: NAME.c; all evaluate their loads at every step, as a large one does
part() {
	name=$1
	coords=$2
	{
		echo "model $name"
		echo "coord $coords"
		echo "input u hold first"
		shift 2
		while [ $# -gt 0 ] && [ "$1" != -- ]; do
			$1
			shift
		done
		echo "step 0.01"
	} >"$name.spec"
	[ $# -gt 0 ] && shift
	"$plgen" --anchors 1 "$@" "$name.spec" -o "$name.c" >>log 2>&1
}

# beside NAME STEPS TOLERANCE REST A PART ...: A stepped beside its parts
beside() {
	what=$1
	steps=$2
	tolerance=$3
	rest=$4
	a=$5
	shift 5
	list=
	files=$a.c
	for b in "$@"; do
		list="$list X($b)"
		files="$files $b.c"
	done
	real=${real:-double}
	model=pl_model$([ "$real" = float ] && echo f)
	# shellcheck disable=SC2086
	$run_cc -I"$root/runtime" -DWHOLE="$a" -DPARTS="$list" -DREAL="$real" -DMODEL="$model" \
		"$root/tests/large/compare.c" $files "$library" -lm -o compare >>log 2>&1 &&
		./compare "$steps" "$tolerance" "$rest" >>log 2>&1
	result $? "$what"
}

count 8 48
count 9 54
count 12 72
if [ -n "${LONG:-}" ]; then
	count 40 240
fi

: >log
all='x1, r1, x2, c9, c1, x3, r2, r3, c2, c3, x4, c4, c5, x5, c6, c7, c8'
part whole "$all" alike few chain && part oscillating 'x1, x2, x3, x4, x5' alike && part few 'r1, r2, r3' few &&
	part chained 'c9, c1, c2, c3, c4, c5, c6, c7, c8' chain
result $? 'a model of blocks of every kind, and each alone'
: >log
beside 'each block steps as alone, bit for bit; at and jump to rounding' 60 0 1e-12 whole oscillating few chained
grep '_step(whole \*s\|= r1 +' whole.c >log
grep -q 'whole_alike0_step(whole \*s' whole.c && grep -q 'whole_columns[0-9]_step(whole \*s' whole.c &&
	grep -q 's->y\[1\] = r1 +' whole.c
result $? 'blocks alike are one loop, a few rows are rows, a large block is columns'

# The same without samples, so that they can leap, under loads that change or not; loads are not summed in one order
for change in '' ' + (t < 0.333 ? 2 : 1 - t)'; do
	: >log
	parts='oscillating few chained'
	for name in whole $parts; do
		sed "/^input/d; s/= u/= 0.25/; s/u + cos/0.25 + cos/; s/^x2.*/&$change/; s/^c4.*/&$change/" \
			$name.spec >t.spec
		"$plgen" t.spec -o $name.c >>log 2>&1 || echo "$name is refused" >>log
	done
	beside "blocks that leap${change:+, across a change}" 60 1e-14 1e-12 whole $parts
done

# ---- modes ----

# modal NAME TOLERANCE REST [OPTION ...] <SPEC: 150 steps of modes beside those of states
modal() {
	what=$1
	tolerance=$2
	rest=$3
	shift 3
	cat >m.spec
	: >log
	"$plgen" --form modal --prefix modes "$@" m.spec -o modes.c >>log 2>&1 &&
		"$plgen" --form direct --prefix states "$@" m.spec -o states.c >>log 2>&1
	beside "modes: $what" 150 "$tolerance" "$rest" modes states
}

modal 'damped, gyroscopic, of first order, under samples, ramps and loads' 2e-13 2e-12 <<'END'
model m
coord x, y, z, q
input u, v hold first
init x = 1, y' = -2, q = 0.3
2*x'' + 0.3*x' - 1.5*y' + 40*x - 9*y = u + 3*cos(4*t)
y'' + 0.1*y' + 1.5*x' + 30*y - 9*x - 2*z = v + 0.5*v' + exp(-0.2*t)
z'' + 9*z' + 8*z - q = 2
q' + 3*q - x = u + exp(-0.5*t)*sin(2*t + 1)
output a = x - q, b = z' + 2*u, c = x'', d = x*z
step 0.02
END
modal 'undamped, in blocks, some of them symmetric' 2e-13 2e-12 <<'END'
model m
coord x[3], y, z
init x[1] = 1, y' = 3
x[1]'' + 20*x[1] - 10*x[2] = cos(3*t)
x[2]'' + 20*x[2] - 10*x[1] - 10*x[3] = 0
x[3]'' + 20*x[3] - 10*x[2] = cos(3*t)
y'' + 5*y - z = 0
z'' + 7*z - y = 1
output x[1], y
step 0.05
END
real=float
modal 'float' 4e-5 4e-5 --real float <<'END'
model m
coord x, y
input u
init x = 1
x'' + 0.3*x' + 40*x - 9*y = u
y'' + 0.1*y' + 30*y - 9*x = 0.5*cos(3*t)
output x
step 0.02
END
real=double

# aside SPEC WORDS: by name
aside() {
	printf '%s\n' 'model m' "$@" | sed '$d' >r.spec
	for words in "$@"; do :; done
	"$plgen" --form modal r.spec >/dev/null 2>log
	status=$?
	[ $status -eq 0 ] && grep -q "note: --form modal stands aside: $words" log
	result $? "modes stand aside: $words"
}

aside 'coord x' "x'' + 2*x' + x = 0" 'step 0.1' 'a pole is repeated'
aside 'coord x' "x'' + x = t*cos(2*t)" 'step 0.1' 'a load has a power of t'
aside 'coord x' "x'' + x = t < 1 ? 1 : 0" 'step 0.1' 'loads change their formula'
aside 'coord x' "x'' + x = cos(t)" 'step 0.1' 'two poles, or a pole and a load, are too close'

# A chain of nine masses is stepped by modes where three outputs are all that is wanted, else by its states.
row_of_masses() {
	awk -v n=9 -v outputs="$1" 'BEGIN {
		for (i = 1; i <= n; i++) list = list (i > 1 ? ", " : "") "x" i
		print "model row\ncoord " list "\ninit x1 = 1"
		for (i = 2; i <= n; i++) print "init x" i " = " 1 / i
		for (i = 1; i <= n; i++) {
			text = "x" i "\47\47 + 0.2*x" i "\47 + 200*x" i
			if (i > 1) text = text " - 100*x" (i - 1)
			if (i < n) text = text " - 100*x" (i + 1)
			print text " = 0"
		}
		print outputs "\nstep 0.01"
	}'
}
row_of_masses 'output x1, x5, x9' >row.spec
"$plgen" row.spec 2>log | grep 'form modal: 36 multiplications, 18 additions' >>log
result $? 'nine masses, three outputs: 36 multiplications'
row_of_masses '' | "$plgen" - 2>log | grep 'form delta: 324 multiplications' >>log
result $? 'nine masses, all states: 324 multiplications'
"$plgen" --prefix modes row.spec -o modes.c && "$plgen" --form delta --prefix states row.spec -o states.c
beside 'modes that the generator has chosen' 100 2e-12 2e-12 modes states

row_of_masses 'output x1' | sed "s/^x1'' .* = 0/&+ t/" | "$plgen" - 2>log |
	grep 'The form modal would be cheaper for so few outputs, but a load has a power of t\.' >>log
result $? 'why modes are not chosen is told'

# ---- rest ----

# at_rest NAME HOW REAL PAIRS [OPTION ...]: so many damped masses in a row, and as many free of damping beside others
at_rest() {
	what=$1
	how=$2
	real=$3
	pairs=$4
	shift 4
	for model in decaying mixed; do
		awk -v n="$pairs" -v model=$model 'BEGIN {
			for (i = 1; i <= n; i++) list = list (i > 1 ? ", " : "") "a" i (model == "mixed" ? ", b" i : "")
			print "model " model "\ncoord " list
			for (i = 1; i <= n; i++) {
				print "a" i "\47\47 + a" i "\47 + 90*a" i (i > 1 ? " - 20*a" (i - 1) : "") " = 0"
				if (model == "mixed") print "b" i "\47\47 + " 20 + i "*b" i " = 0"
			}
			print "step 0.01"
		}' >$model.spec
		"$plgen" --real "$real" "$@" $model.spec -o $model.c >>log 2>&1
	done
	# shellcheck disable=SC2086
	$run_cc -I"$root/runtime" -DREAL="$real" -DMODEL=pl_model$([ "$real" = float ] && echo f) \
		"$root/tests/large/rest.c" decaying.c mixed.c "$PLRT" -lm -o rest >>log 2>&1 && ./rest "$how" >>log 2>&1
	result $? "rest: $what"
}
: >log
at_rest 'steps of nine masses' step double 9 --form delta
at_rest 'steps of two, in float' step float 2 --form delta
tap_end
