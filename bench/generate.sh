#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# generate.sh BUILD: what generating costs, as medians of many whole processes, each beside an empty program.
build=$1
runs=50
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo 'int main(void) { return 0; }' >"$work/empty.c"
${CC:-cc} -O2 "$work/empty.c" -o "$work/empty"
"$build/bench/clock" "$runs" "$work/empty" -- "$build/plgen" models/sdcsf.spec
"$build/bench/clock" "$runs" "$work/empty" -- "$build/plgen" models/tuned_floor.spec
"$build/bench/clock" 5 "$work/empty" -- "$build/plgen" --solution 30 models/sdcsf.spec
"$build/bench/clock" 5 "$work/empty" -- "$build/plgen" --solution 30 models/quarter_car.spec
"$build/bench/clock" 5 "$work/empty" -- "$build/plgen" models/beam15.spec
"$build/bench/clock" 5 "$work/empty" -- "$build/plgen" --scheme etd1 models/beam4.spec
