#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# joint_through.sh PLGEN SPECS TRUTH COMPARE.AWK SOURCE FIRST COUNT: random joints with sliders without mass from seed
# FIRST on: every event and the end of --solution beside the same joint in long double; and NAME_selftest, in double and
# in float, small. $CC compiles, $PLRT is the runtime.
plgen=$(realpath "$1")
specs=$(realpath "$2")
truth=$(realpath "$3")
compare=$(realpath "$4")
source=$(realpath "$5")
first=$6
many=$7
. "$source/tests/run_cc.sh"
. "$source/tests/tap.sh"
runtime_archive "$source/runtime"

# tested REAL: what NAME_selftest returns; "none": it is refused by name
tested() {
	if ! "$plgen" --real "$1" --prefix joint --selftest joint.spec -o joint.c 2>log; then
		grep -q 'finds no start\|the step has' log && echo none
		return
	fi
	{
		printf '#include "joint.h"\n#include <stdio.h>\n'
		printf 'int main(void) { printf("%%g\\n", (double)joint_selftest()); }\n'
	} >main.c
	$run_cc -I. -I"$source/runtime" -o tested main.c joint.c "$archive" -lm >log 2>&1 && ./tested
}

told=0
for seed in $(seeds "$first" "$many"); do
	name="joint $seed"
	if chosen "$name"; then
		"$specs" joint "$seed" >joint.spec
		"$truth" "$seed" 6 >found.txt
		if "$plgen" --solution 6 joint.spec >solution.csv 2>log; then
			told=$((told + 1))
			awk -f "$compare" joint.spec found.txt solution.csv >log
		else
			grep -q 'it is not known' log
		fi
		result $? "$name: events and end"
		for real in double float; do
			value=$(tested $real)
			echo "# NAME_selftest in $real: $value" >log
			[ "$value" = none ] || awk -v v="$value" 'BEGIN { exit !(v != "" && v + 0 == v && v < 1000) }'
			result $? "$name: selftest in $real"
		done
	fi
done
# what is not known is rare
[ -n "${CASE:-}" ] || { echo "$told joints told" >log; [ $((told * 10)) -ge $(($7 * 8)) ]; result $? "most are told"; }
tap_end
