#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# precision.sh PLGEN PRECISION OUTDIR [--quick] [MODEL...]: the variants, the table OUTDIR/precision.csv, how its times
# agree (precision_check.csv), who is cheapest (matrix.csv), and its pictures. Run at the top of the source tree.
set -e
plgen=$1 program=$2 out=$3
shift 3
variants=$out/variants
mkdir -p "$variants"
"$program" --list "$@" |
	xargs -P2 -L1 sh -c 'plgen=$1 folder=$2 file=$3; shift 3
		exec sh bench/charts/variant.sh "$plgen" "$folder/$file" "$@"' make "$plgen" "$variants"
quick=
if [ "$1" = --quick ]; then
	quick=--quick
	shift
fi
"$program" $quick "$variants" "$out/precision.csv" "$@"
awk -f bench/charts/csv.awk -f bench/charts/precision_check.awk "$out/precision.csv" >"$out/precision_check.csv"
awk -f bench/charts/csv.awk -f bench/charts/matrix.awk "$out/precision.csv" >"$out/matrix.csv"
gnuplot -c bench/charts/precision.gp "$out/precision.csv" "$out"
