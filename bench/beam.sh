#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# beam.sh BUILD: time of a step of the rotating beam (15 coordinates) by each scheme, per multiplication of its
# operation count, beside a plain matrix-vector loop; and the time to generate it.
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo "rotating beam, 15 coordinates, gcc -O2:"
for case in beam4:etd1 beam4:etdrk2 beam4:etdrk4 beam4:bm3 beam15:etdrk4; do
	spec=models/${case%:*}.spec scheme=${case#*:}
	"$build/plgen" --fast --scheme "$scheme" --prefix beam --explain=json "$spec" 2>/dev/null >"$work/beam.json"
	count=$(sed -n 's/.*"cost": {"multiplications": \([0-9]*\).*/\1/p' "$work/beam.json")
	"$build/plgen" --fast --scheme "$scheme" --prefix beam "$spec" 2>/dev/null >"$work/beam_pl.c"
	gcc -std=c11 -O2 -D_POSIX_C_SOURCE=199309L -DMULTIPLICATIONS="$count" -Iruntime bench/beam.c "$work/beam_pl.c" \
		runtime/*.c -lm -o "$work/beam"
	"$work/beam" "$case"
done
echo "to generate it:"
for case in beam4:etd1 beam4:etdrk4 beam4:bm3 beam15:etdrk4; do
	"$build/bench/clock" 5 /bin/true -- "$build/plgen" --scheme "${case#*:}" "models/${case%:*}.spec" 2>/dev/null |
		sed -n 1p
done
