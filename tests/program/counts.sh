#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The operations that --explain and the banner name are those that the C takes: it counts them itself, compiled as C++
# with a number that counts (bench/limits). Models without loads, whose phases are not counted there.
#
#     counts.sh PLGEN SOURCE_ROOT
set -u
plgen=$1
root=$2
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
. "${0%/*}/../tap.sh"

limits=$root/bench/limits
counted() {
	g++ -x c++ -w -O0 -include "$limits/counted.h" -I"$root/runtime" "$@"
}

if ! command -v g++ >/dev/null 2>&1; then
	skip 'operations counted' 'g++ is not installed'
	tap_end
fi
for file in series power apply; do
	counted -c "$root/runtime/$file.c" -o "$file.o" >>log 2>&1
done

models='scs quarter_car'
[ -z "${LONG:-}" ] || models='scs sdcs scs_weak linear2dof quarter_car'
for model in $models; do
	: >log
	"$plgen" --explain=json "$root/models/$model.spec" 2>>log |
		sed -n 's/.*"cost": {"multiplications": \([0-9]*\), "additions": \([0-9]*\)}.*/step \1 \2/p' >expected
	"$plgen" "$root/models/$model.spec" >model.c 2>>log &&
		counted -DMODEL="$model" "$limits/count.cpp" model.c -x none series.o power.o apply.o -o operations \
			>>log 2>&1 && ./operations 1 1 -1 >found
	sed -n 's/^\(step [0-9]* [0-9]*\) 0 0 .*/\1/p' found >steps
	{ echo "found    $(cat found)"; echo "expected $(cat expected)"; } >>log
	[ -s expected ] && cmp -s steps expected
	result $? "$model: a step takes the operations that --explain says"
done
tap_end
