#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# through.sh PLGEN TRUTH FOLLOW.AWK SOURCE STOPS FRICTIONS IMPACTS CHANGES FIRST COUNT
#
# COUNT random scenes from seed FIRST on with at most so many contacts of each kind, and changes of the loads: every
# event and the end of --solution against the same scene by a Taylor series of 191 bits; and NAME_selftest of each
# scene, in double and in float, small. $CC compiles, $PLRT is the runtime.
truth=$(realpath "$2")
follow=$(realpath "$3")
root=$4
kinds="$5 $6 $7 $8 0"
first=$9
. "${0%/*}/../plgen.sh"
shift 9
many=$1

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
		value=$(selftest_of scene.spec $real)
		echo "# NAME_selftest in $real: $value" >log
		[ "$value" = none ] || awk -v v="$value" 'BEGIN { exit !(v != "" && v + 0 == v && v < 1000) }'
		result $? "$name: selftest in $real"
	done
done
echo "# $decides of $many scenes decide"
tap_end
