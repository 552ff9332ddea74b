#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Needs beside tunable params, friction, impacts and a delayed input: the error that plgen tells, against closed forms.
# beside.sh PLGEN HERE RUNTIME; PLRT in the environment: the runtime as an archive
plgen=$1 here=$2 runtime=$3
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
. "$here/../tap.sh"
. "$here/../run_cc.sh"
# Beyond what rounding in this script adds
spare=1e-13

# built [FLAG...]: drawn.spec as a program, what is told of its need as `told` and `near`, of error over need elsewhere
built() {
	"$plgen" --explain=json drawn.spec >drawn.json 2>log && "$plgen" drawn.spec >drawn_pl.c 2>>log &&
		$run_cc "$@" -I. -I"$runtime" "$here/run.c" "$PLRT" -lm -o run >>log 2>&1
	sed -n 's/.*"taken": true.*"measured": \([^,]*\),.*"needed": \([^}]*\)}.*/\1 \2/p' drawn.json >told
	sed -n 's/.*"taken": true.*"neighbours": \([^,]*\),.*/\1/p' drawn.json >near
}

# judged NAME LEAST: of lines "got exact" the largest difference is at most what was told and at least LEAST of it
judged() {
	awk -v least="$2" -v spare=$spare 'NR == FNR { told = $1; needed = $2; next }
		{ e = $1 - $2; e = e < 0 ? -e : e; if (!(e <= worst)) worst = e }
		END {
			printf "# told %.6g, needed %.6g, found %.6g\n", told, needed, worst
			exit !(NR > 10 && worst <= told + spare && worst >= least * told - spare && told <= needed)
		}' told - >>log
	result $? "$1"
}

# ---- every end of the ranges, against the closed form of a model of these values ----

cat >drawn.spec <<-'END'
	model drawn
	param k = 4, c = 0.3
	tunable k in [2, 9], c in [0.1, 1]
	coord x
	init x = 1
	x'' + c*x' + k*x = cos(2*t)
	output x
	step 0.05
	need x within 1e-5 until 20
END
built -DTUNED=2
grep -v -e '^tunable' -e '^need' drawn.spec >fixed.spec
: >pairs
for k in 2 9; do
	for c in 0.1 1; do
		"$plgen" --solution 20 -D k=$k -D c=$c fixed.spec 2>>log | sed 1d | cut -d , -f 2 >exact
		./run "$(wc -l <exact)" $k $c | paste -d' ' - exact >>pairs
	done
done
# told is error over need, of neighbours too; of needs 1e-5
awk '{ print $1 * 1e-5, 1e-5 }' near >told
judged 'tunable params at all ends' 0.2 <pairs

# ---- a ball, until the sixth bounce ----

cat >drawn.spec <<-'END'
	model drawn
	coord x
	init x = 1
	x'' = -10
	stop between ground, x at 0 restitution 0.5
	output x
	step 0.02
	need x within 1e-5 until 1.25
END
built
./run 63 | awk -v OFMT=%.17g '{
	t = (NR - 1) * 0.02; rise = sqrt(20); begun = -rise / 10
	while (t > begun + rise / 5) { begun += rise / 5; rise /= 2 }
	print $1, rise * (t - begun) - 5 * (t - begun) ^ 2
}' >pairs
judged 'a ball that bounces' 0.99 <pairs

# ---- what slides until it sticks ----

cat >drawn.spec <<-'END'
	model drawn
	coord x
	init x' = 1
	x'' + friction(x', 0.3) = 0
	output x
	step 0.07
	need x within 1e-6 until 5
END
built
./run 72 | awk -v OFMT=%.17g '{ t = (NR - 1) * 0.07; t = t < 10/3 ? t : 10/3; print $1, t - 0.15 * t * t }' >pairs
judged 'a block that slides until it sticks' 0.99 <pairs

# ---- a delayed input, constant for t > 0 and 0 before ----

cat >drawn.spec <<-'END'
	model drawn
	coord x
	input u
	x' + 2*x = u(t - 0.25)
	output x
	step 0.1
	need x within 1e-6 until 4 for |u| <= 3
END
built -DINPUT=3
./run 41 | awk -v OFMT=%.17g '{ t = (NR - 1) * 0.1 - 0.25; print $1, (t > 0 ? 1.5 * (1 - exp(-2 * t)) : 0) }' >pairs
judged 'a delayed input' 0.01 <pairs
tap_end
