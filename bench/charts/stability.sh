#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# stability.sh [--quick] PLGEN PROGRAMS OUTDIR: where methods are stable, and how well they keep period and amplitude.
# Run at the top of the source tree; PROGRAMS has stability, quality, operator_map and largest_step.  tables
# go to OUTDIR; exit status 1 where a measured boundary is not the known one (OUTDIR/*_check.csv).
set -e
quick=
[ "$1" = --quick ] && quick=$1 && shift
plgen=$1 programs=$2 out=$3
variants=$out/variants/stability
charts=bench/charts
mkdir -p "$variants"
grep -v '^#' $charts/stability.variants | while read -r name spec options; do
	# shellcheck disable=SC2086
	sh $charts/variant.sh "$plgen" "$variants/$name.so" "$spec" $options
done
bad=0
"$programs/stability" $quick "$out" "$variants" || bad=1
"$programs/quality" $quick "$out" || bad=1
"$programs/operator_map" $quick "$out" "$variants" || bad=1
"$programs/largest_step" $quick "$out" "$variants" || bad=1
exit $bad
