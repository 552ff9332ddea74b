#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# joint_through.sh PLGEN SPECS TRUTH COMPARE.AWK SOURCE FIRST COUNT: random joints with sliders without mass from seed
# FIRST on: every event and the end of --solution beside the same joint in long double; and NAME_selftest, in double and
# in float, small. $CC compiles, $PLRT is the runtime.
specs=$(realpath "$2")
truth=$(realpath "$3")
compare=$(realpath "$4")
root=$5
first=$6
many=$7
. "${0%/*}/../plgen.sh"

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
			value=$(selftest_of joint.spec $real)
			echo "# NAME_selftest in $real: $value" >log
			[ "$value" = none ] || awk -v v="$value" 'BEGIN { exit !(v != "" && v + 0 == v && v < 1000) }'
			result $? "$name: selftest in $real"
		done
	fi
done
# what is not known is rare
[ -n "${CASE:-}" ] || { echo "$told joints told" >log; [ $((told * 10)) -ge $(($7 * 8)) ]; result $? "most are told"; }
tap_end
