#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Inputs that go through several samples: responses in closed form (holds.c); the driver of hosts, which has to read the
# record as far ahead; and where such an input cannot be.
#
#     holds.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"
here=$root/tests/holds

# follows SPEC FLAGS
follows() {
	{
		"$plgen" --prefix m -o m.c "$here/$1.spec" &&
			$run_cc -I"$root/runtime" -c m.c -o m.o &&
			$run_cc $2 -I"$root/runtime" -I. "$here/holds.c" m.o "$archive" -lm -o m && ./m
	} >log 2>&1
	result $? "$1: closed forms"
}

follows polynomials ''
follows tuned -DTUNED
follows chain -DCHAIN

# The record t^3 of an integrator: held, as a ramp, as a cubic, which gives t^4/4 exactly at each step.
cat >cubic.spec <<'END'
model cubic
coord x, y, z
input u hold third
input v hold first
input w
x' = u
y' = v
z' = w
step 1
END
echo 'u,v,w' >record
for t in 0 1 2 3 4 5 6; do echo "$((t * t * t)),$((t * t * t)),$((t * t * t))"; done >>record
{
	"$plgen" -o cubic_pl.c cubic.spec &&
		$run_cc -DMODEL=cubic -I"$root/runtime" "$root/runtime/host/plmain.c" cubic_pl.c "$archive" \
			-o cubic && ./cubic 5 <record >rows && awk -F, '
			function near(a, b) { return a - b < 1e-12 && b - a < 1e-12 }
			NR > 1 {
				t = $1; ramp += t ? (t^3 + (t - 1)^3)/2 : 0; held += t ? (t - 1)^3 : 0
                # t^3 from the first interval on: the sample before the record is 0, not -1: off by -1/24 there
				if (!near($2, t^4/4 - (t ? 1/24 : 0)) || !near($3, ramp) || !near($4, held)) {
                    print "at t = " t ": " $0 "; expected " t^4/4 - (t ? 1/24 : 0) ", " ramp ", " held; bad = 1 } }
			END { exit bad || NR != 7 }' rows
} >log 2>&1
result $? 'the driver reads ahead as far as each input has to'
head -n 7 record >short
./cubic 5 <short >rows 2>log
[ $? -eq 1 ] && grep -q 'expected row 6' log
result $? 'a record that ends early'

# refused TEXT SPEC OPTION ...
refused() {
	text=$1
	shift
	"$plgen" "$@" >out 2>log
	[ $? -eq 1 ] && [ ! -s out ] && grep -q "error: input 'u3\{0,1\}' cannot be hold third here: $text" log
	result $? "refused: $text"
}

refused 'powers of the step leave the range of float' "$here/polynomials.spec" --real float
sed 's/= u$/- x^3 = u/' cubic.spec >left.spec
refused 'the remainder reads held inputs and ramps' left.spec
sed 's/= u$/+ abs(x) = u/' cubic.spec >regions.spec
refused 'where a piecewise-linear model crosses a breakpoint' regions.spec
tap_end
