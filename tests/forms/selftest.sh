#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# NAME_selftest: small as emitted, and not with any one constant of the step wrong.
#
#     selftest.sh PLGEN SOURCE_ROOT
#
# As emitted it is below 60 units in the last place; with the leading digit of one constant wrong it is above 300.
set -u
plgen=$1
root=$(cd "$2" && pwd) || exit 99
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
. "${0%/*}/../tap.sh"
compiler=${CC:-cc}
printf '#include "plrt.h"\n#include <stdio.h>\nREAL subject_selftest(void);\nint main(void)\n{\n    printf("%%g\\n", (double)subject_selftest());\n    return 0;\n}\n' >main.c
"$compiler" -O1 -c -I"$root/runtime" "$root"/runtime/*.c >log 2>&1 || { result 1 'the runtime compiles'; tap_end; }

# value FILE TYPE: what its self-test returns
value() {
	"$compiler" -O1 -I"$root/runtime" -DREAL="$2" "$1" main.c ./*.o -o program >log 2>&1 && ./program
}

# constants FILE: those of its step, each once, from 1e-5 on: what is smaller adds less than rounding to a step of float
constants() {
	sed -n '/^void subject_step/,/^}/p' "$1" | sed 's,/\*.*\*/,,' | grep -o -E '[0-9]\.[0-9]{4,}(e-?[0-9]+)?f?' | sort -u | awk '$1 + 0 >= 1e-5'
}

# Its first digit that is not 0 becomes another
damaged() {
	echo "$1" | sed -E 's/^(0\.0*)?[1-4]/\18/; t; s/^(0\.0*)?[5-9]/\13/'
}

for spec in models/scs models/sdcsf tests/forms/damped_ramped; do
	for options in "" "--real float" "--form direct"; do
		case $options in *float*) type=float ;; *) type=double ;; esac
		name="$(basename "$spec") ${options:-default}"
		# shellcheck disable=SC2086
		"$plgen" --prefix subject --selftest $options "$root/$spec.spec" >good.c 2>log || { result 1 "$name: plgen"; continue; }
		good=$(value good.c "$type")
		echo "returns $good, expected below 60" >log
		awk -v v="$good" 'BEGIN { exit !(v != "" && v + 0 < 60) }'
		result $? "$name: below 60 units in the last place"
		: >missed
		constants good.c >numbers
		while read -r number; do
			wrong=$(damaged "$number")
			awk -v from="$number" -v to="$wrong" '{ while (i = index($0, from)) { out = out substr($0, 1, i - 1) to; $0 = substr($0, i + length(from)) } print out $0; out = "" }' good.c >bad.c
			bad=$(value bad.c "$type")
			awk -v v="$bad" 'BEGIN { exit !(v != "" && !(v + 0 <= 300)) }' || echo "$number as $wrong: returns $bad, expected above 300" >>missed
		done <numbers
		[ -s numbers ] && [ ! -s missed ]
		status=$?
		cp missed log
		result $status "$name: each of $(wc -l <numbers) constants wrong is seen"
	done
done

# What --reduce leaves, of fewer states than coordinates and of more than 16 states
for spec in reduce_highest_good reduce_loops_good; do
	for type in double float; do
		rm -f reduced.c
		"$plgen" --prefix subject --selftest --reduce --real "$type" "$root/tests/errors/schemes/$spec.spec" >reduced.c 2>log
		value=$(value reduced.c "$type")
		[ -n "$value" ] && echo "returns $value, expected below 60" >log
		awk -v v="$value" 'BEGIN { exit !(v != "" && v + 0 < 60) }'
		result $? "$spec $type: below 60 units in the last place"
	done
done
tap_end
