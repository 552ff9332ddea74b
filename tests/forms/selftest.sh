#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# NAME_selftest: small as emitted, and not with any one constant of the step wrong.
#
#     selftest.sh PLGEN SOURCE_ROOT CASES
#
# As emitted it is below 60 units in the last place, of stop, which is followed through five crossings, below 100; with
# the leading digit of one constant wrong it is above 300.
root=$2
cases=$(realpath "$3")
here=$(cd "${0%/*}" && pwd) || exit 99
. "${0%/*}/../plgen.sh"

# subjects, then subject FILE ... and values: what the self-test of each file returns, a line each, from one program
subjects() {
	many=0
	echo '#include <stdio.h>' >subjects.c
	: >calls
}
subject() {
	many=$((many + 1))
	sed -e "s/subject/subject$many/g" -e "s/SUBJECT/SUBJECT$many/g" "$1" >>subjects.c
	printf '    printf("%%g\\n", (double)subject%d_selftest());\n' "$many" >>calls
}
values() {
	{ echo 'int main(void)'; echo '{'; cat calls; echo '    return 0;'; echo '}'; } >>subjects.c
	$run_cc -I"$root/runtime" subjects.c "$archive" -lm -o program >log 2>&1 && ./program
}

# constants FILE: those of its step, each once, from 1e-5 on: what is smaller adds less than rounding to a step of float
constants() {
	sed -n '/^void subject_step/,/^}/p' "$1" | sed 's,/\*.*\*/,,' | grep -o -E '[0-9]\.[0-9]{4,}(e-?[0-9]+)?f?' |
		sort -u |
		awk '$1 + 0 >= 1e-5'
}

# Its first digit that is not 0 becomes another
damaged() {
	echo "$1" | sed -E 's/^(0\.0*)?[1-4]/\18/; t; s/^(0\.0*)?[5-9]/\13/'
}

for spec in models/scs models/sdcsf tests/forms/damped_ramped; do
	for options in "" "--real float" "--form direct"; do
		name="$(basename "$spec") ${options:-default}"
		# shellcheck disable=SC2086
		"$plgen" --prefix subject --selftest $options "$(path_of "$spec.spec")" >good.c 2>log ||
			{ result 1 "$name: plgen"; continue; }
		subjects
		subject good.c
		good=$(values)
		echo "returns $good, expected below 60" >log
		awk -v v="$good" 'BEGIN { exit !(v != "" && v + 0 < 60) }'
		result $? "$name: below 60 units in the last place"
		constants good.c >numbers
		subjects
		: >changes
		while read -r number; do
			wrong=$(damaged "$number")
			echo "$number as $wrong" >>changes
			awk -v from="$number" -v to="$wrong" \
				'{ while (i = index($0, from)) { out = out substr($0, 1, i - 1) to;
				$0 = substr($0, i + length(from)) } print out $0; out = "" }' good.c >bad.c
			subject bad.c
		done <numbers
		values >returned && paste -d : changes returned |
			awk -F: '$2 == "" || $2 + 0 <= 300 { print $1 ": returns " $2 ", expected above 300" }' >log
		[ -s numbers ] && [ "$(wc -l <returned)" -eq "$many" ] && [ ! -s log ]
		status=$?
		result $status "$name: each of $(wc -l <numbers) constants wrong is seen"
	done
done

# seen MODEL WHAT FUNCTION CODE: with subject_told, of CODE, in the place of subject_FUNCTION
seen() {
	"$plgen" --prefix subject --selftest "$root/models/$1.spec" >good.c 2>log
	code=$4 awk -v name="$3" '/^#include "selftest.h"/ { print ENVIRON["code"]
		print "#define subject_" name " subject_told"; print; print "#undef subject_" name; next }
		{ print }' good.c >bad.c
	subjects
	subject good.c
	subject bad.c
	values >returned
	awk '{ v[NR] = $1 } END { print "returns", v[1], v[2] ", expected: below 100, above 300"
		exit !(NR == 2 && v[1] < 100 && (v[2] > 300 || v[2] == "inf")) }' returned >>log
	result $? "$1: $2"
}
seen stop 'crossings by a part of a step late are seen' crossings 'static int subject_told(const subject *s,
	pl_crossing *c) { int i, n = subject_crossings(s, c); for (i = 0; i < n; i++) c[i].time += 1e-9; return n; }'
seen stop 'that no crossing is told is seen' crossings 'static int subject_told(const subject *s, pl_crossing *c)
	{ (void)s; (void)c; return 0; }'
# the last of them
seen stop 'a crossing that is told twice is seen' crossings 'static int subject_told(const subject *s, pl_crossing *c)
	{ int n = subject_crossings(s, c); if (n == 1 && s->k > 722) c[n++] = c[0]; return n; }'
seen scs 'a jump of a step less is seen' jump 'static void subject_told(subject *s, uint64_t n)
	{ subject_jump(s, n - 1); }'
seen scs 'NAME_at at another time is seen' at 'static void subject_told(const subject *s, double tau, double *y)
	{ subject_at(s, 0.99 * tau, y); }'

# Where there is no closed form the same steps were made here, whose rounding others share but for contractions and
# libm; a step more, or one that is a little longer, is seen.
replayed() {
	spec=$1
	shift
	"$plgen" --prefix subject --selftest "$@" "$(path_of "$spec.spec")" >good.c 2>log ||
		{ result 1 "$spec $*"; return; }
	inputs=$(grep -q 'subject_step(subject \*s, ' good.c && echo ', u')
	awk -v inputs="$inputs" '/^#include "selftest.h"/ { given = inputs == "" ? "" : ", const double *u"
		print "static void subject_told(subject *s" given ") { subject_step(s" inputs ");"
		print "    if (subject_time(s) > 2.5*SUBJECT_H && subject_time(s) < 3.5*SUBJECT_H)"
		print "        subject_step(s" inputs "); }"
		print "#define subject_step subject_told"; print; print "#undef subject_step"; next }
		{ print }' good.c >bad.c
	subjects
	subject good.c
	subject bad.c
	values >returned
	awk '{ v[NR] = $1 } END { print "returns", v[1], v[2] ", expected: below 10, above 300"
		exit !(NR == 2 && v[1] < 10 && v[2] > 300) }' returned >>log
	result $? "$spec $*: as where it was made; a step more is seen"
}
replayed models/duffing --scheme taylor
replayed models/duffing --scheme radau
replayed models/robot_arm --scheme etdrk4
replayed models/bouncing_ball --scheme radau
replayed models/four_bar
replayed tests/delays/jumps
replayed tests/holds/polynomials
replayed tests/delays/stopped --scheme etdrk4

# By another scheme the states are the same, but for its error.
for scheme in taylor radau; do
	"$plgen" --prefix subject --selftest --scheme $scheme --tolerance 1e-13 "$root/models/duffing.spec" 2>log |
		sed -n '/subject_known_states\[/,/^}/p' | grep -o '[-0-9][-0-9.e]*[0-9]' >$scheme.states
done
paste taylor.states radau.states | awk '{ d = $1 - $2; d = d < 0 ? -d : d; worst = d > worst ? d : worst; n++ }
	END { printf "%d states, at most %g apart, expected 16, below 1e-10\n", n, worst
	      exit !(n == 16 && worst < 1e-10) }' >>log
result $? 'duffing: taylor and radau replay the same states'

# What --reduce leaves, of fewer states than coordinates and of more than 16 states
mkdir cases && "$cases" --write cases reduce_highest_good reduce_loops_good || exit 99
for spec in reduce_highest_good reduce_loops_good; do
	for type in double float; do
		rm -f reduced.c
		"$plgen" --prefix subject --selftest --reduce --real "$type" "cases/schemes/$spec/$spec.spec" \
			>reduced.c 2>log
		subjects
		subject reduced.c
		value=$(values)
		[ -n "$value" ] && echo "returns $value, expected below 60" >log
		awk -v v="$value" 'BEGIN { exit !(v != "" && v + 0 < 60) }'
		result $? "$spec $type: below 60 units in the last place"
	done
done

# Balls that bounce on each other without losses: steps are compared while the target can follow, whatever the masses
subjects
for masses in '7 3' '3 7' '2 1' '1 5' '1 1'; do
	for restitution in 1 0.9; do
		{
			echo 'model subject'
			echo 'coord a, b'
			echo 'init b = 1'
			echo "${masses% *}*a'' = -${masses% *}*9.81"
			echo "${masses#* }*b'' = -${masses#* }*9.81"
			echo "stop between ground, a at 0 restitution $restitution"
			echo "stop between a, b at 0 restitution $restitution"
			echo 'step 0.1'
		} >balls.spec
		"$plgen" --prefix subject --selftest balls.spec >balls.c 2>log && subject balls.c
	done
done
values >returned
awk '{ print "returns " $1 ", expected below 200"; bad = bad || !($1 + 0 < 200) } END { exit bad || NR != 10 }' \
	returned >log
result $? 'balls without losses, of ten masses and restitutions: below 200 units in the last place'

# What NAME_init leaves, where the copy of its table goes wrong (gcc 12 makes {1, 1, 1, 1} of {1, 1, 0, 0}); and that it
# is right where that compiler has wide constants
"$plgen" --prefix subject --selftest "$(path_of tests/forms/begun.spec)" >good.c 2>log
awk '/ subject_initial\[/ { sub("1.0, 0.0, 0.0", "1.0, 1.0, 1.0") } { print }' good.c >bad.c
cmp -s good.c bad.c && echo 'no table in NAME_init' >>log
subjects
subject good.c
subject bad.c
values | awk '{ v[NR] = $1 } END { print v[1], v[2], "expected: below 60, above 300"
                                  exit !(NR == 2 && v[1] < 60 && v[2] > 300) }' >log
result $? "a table of NAME_init that is copied wrongly is seen"
name="NAME_init with wide constants is right"
if grep -q -w avx512f /proc/cpuinfo 2>/dev/null; then
	for level in -O1 -O2 -O3 -Os; do
		subjects
		subject good.c
		echo "$level: returns $(run_cc="${CC:-cc} $level -mavx512f -ffp-contract=off -w" values)"
	done >levels
	awk '{ print $0 ", expected below 60"; bad = bad || $3 == "" || !($3 + 0 < 60) }
	     END { exit bad || NR != 4 }' levels >log
	result $? "$name"
else
	skip "$name" "no AVX-512 here"
fi
tap_end
