#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# headline.sh PLGEN HEADLINE OUTDIR [--find] [--quick]: the tables OUTDIR/headline_*.csv. With --find the variants and
# what is no time: the settings, in OUTDIR/variants/headline, and the last table; then without the two of times.
# Run at the top of the source tree.
set -e
plgen=$1 program=$2 out=$3
shift 3
variants=$out/variants/headline
mkdir -p "$variants"
[ "${1:-}" != --find ] || "$program" --list |
	xargs -P "${JOBS:-2}" -L1 sh -c 'plgen=$1 folder=$2 file=$3; shift 3
		exec sh bench/charts/variant.sh "$plgen" "$folder/$file" "$@"' make "$plgen" "$variants"
"$program" "$@" "$variants" "$out"
