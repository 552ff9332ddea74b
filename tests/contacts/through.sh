#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# through.sh PLGEN TRUTH FOLLOW.AWK SOURCE STOPS FRICTIONS IMPACTS CHANGES FIRST COUNT
#
# COUNT random scenes from seed FIRST on with at most so many contacts of each kind, and changes of the loads: every
# event and the end of --solution against the same scene by a Taylor series of 191 bits; and NAME_selftest of each
# scene, in double and in float, small. $CC compiles, $PLRT is the runtime.
plgen=$(realpath "$1")
truth=$(realpath "$2")
follow=$(realpath "$3")
source=$(realpath "$4")
kinds="$5 $6 $7 $8 0"
shift 8
first=$1
many=$2
. "$source/tests/run_cc.sh"
. "$source/tests/tap.sh"

# tested REAL: what NAME_selftest returns; "none": it is refused by name
tested() {
	if ! "$plgen" --real "$1" --selftest scene.spec -o scene.c 2>log; then
		grep -q 'finds no start\|the step has' log && echo none
		return
	fi
	{
		printf '#include "scene.h"\n#include <stdio.h>\n'
		printf 'int main(void) { printf("%%g\\n", (double)scene_selftest()); }\n'
	} >main.c
	$run_cc -I. -I"$source/runtime" -o tested main.c scene.c $PLRT -lm >log 2>&1 && ./tested
}

decides=0
for seed in $(seeds $first $many); do
	name="$(echo "$kinds" | tr ' ' '_')_$seed"
	if ! chosen "$name" || ! $truth $kinds $seed 4 400 23 scene.spec found.txt; then
		continue
	fi
	decides=$((decides + 1))
	"$plgen" --solution 4 scene.spec >solution.csv 2>log && awk -f "$follow" scene.spec found.txt solution.csv >>log
	result $? "$name: events and end"
	for real in double float; do
		value=$(tested $real)
		echo "# NAME_selftest in $real: $value" >log
		[ "$value" = none ] || awk -v v="$value" 'BEGIN { exit !(v != "" && v + 0 == v && v < 1000) }'
		result $? "$name: selftest in $real"
	done
done
echo "# $decides of $many scenes decide"
tap_end
