#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# coefficients.sh PLGEN DRAWN_SERIES SOURCE FIRST COUNT: for COUNT seeds the series that the generated code makes of
# random equations, beside the coefficients that drawn_series finds by Cauchy's integral.
drawn_series=$(realpath "$2")
root=$3
first=$4
many=$5
. "${0%/*}/../plgen.sh"

# made SEED: the program `compare`, and its order
made() {
	defines=
	"$drawn_series" spec "$1" >drawn.spec && timeout 600 "$plgen" -o drawn_pl.c drawn.spec || return 1
	if grep -q "^input" drawn.spec; then
		defines=-DDRIVEN
	fi
	if grep -q "Rigid-body modes" drawn_pl.c; then
		defines="$defines -DRELATIVE"
	fi
	# shellcheck disable=SC2086
	$run_cc $defines -I. -I"$root/runtime" "$root/tests/taylor/compare_series.c" \
		drawn_pl.c "$archive" -lm -o compare &&
		order=$(./compare order)
}

for seed in $(seeds "$first" "$many"); do
	words=
	if made "$seed" >log 2>&1; then
		"$drawn_series" truth "$seed" "$order" >truth && ./compare <truth >log 2>&1
		good=$?
		words=$(tail -n 1 log)
	else
		good=1
	fi
	result $good "seed $seed: $words"
done
tap_end
