#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What tests compile only to run it, by tcc (run_cc.sh), has the bits that other compilers give: CSV of models.list by
# tcc, gcc and clang, not optimised, are the same bytes. In `make check` every fifth, with LONG=1 all.
#
#     compilers.sh PLGEN SOURCE_ROOT
set -u
plgen=$1
root=$2
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
case $root in /*) ;; *) root=$PWD/$root ;; esac
. "$root/tests/tap.sh"
runtime_archive "$root/runtime"
if ! command -v tcc >log 2>&1; then
	skip 'tcc, gcc and clang' 'tcc is not installed'
	tap_end
fi

# A record for the inputs of model.c, if there are any
record() {
	columns=$(sed -n 's/^enum { MADE_STATES = [0-9]*, MADE_INPUTS = \([0-9]*\),.*/\1/p' model.c |
		head -n 1)
	awk -v columns="${columns:-0}" 'BEGIN { for (k = 0; k <= 3000 && columns > 0; k++)
		for (i = 1; i <= columns; i++)
			printf "%.5g%s", 0.02 * sin((0.2 + i / 10) * k) + 0.01, i < columns ? "," : "\n" }'
}

# rows NAME COMPILER ...: NAME.csv
rows() {
	name=$1
	shift
	"$@" -w -I"$root/runtime" $real -DMODEL=made "$root/runtime/host/plmain.c" model.c "$archive" -lm -o "$name" \
		>>log 2>&1 && "./$name" "$end" <record.csv >"$name.csv" 2>>log
	[ "$(wc -l <"$name.csv" 2>>log || echo 0)" -gt 50 ]
}

place=0
grep -v '^#' "$root/tests/run/models.list" >list
while read -r spec options; do
	place=$((place + 1))
	[ -n "${LONG:-}" ] || [ $((place % 5)) -eq 1 ] || continue
	chosen "$spec $options" || continue
	: >log
	real=
	case $options in *float*) real=-DFLOAT ;; esac
	# shellcheck disable=SC2086
	"$plgen" --prefix made $options "$root/$spec" >model.c 2>said || cat said >log
	end=$(sed -n 's/^#define MADE_H \([0-9.e-]*\).*/\1/p' model.c | head -n 1 |
		awk '{ printf "%.17g", 200.5 * $1 }')
	record >record.csv
	rows by_tcc tcc && rows by_gcc gcc -std=gnu11 -O0 -ffp-contract=off &&
		rows by_clang clang -std=gnu11 -O0 -ffp-contract=off &&
		cmp by_tcc.csv by_gcc.csv >>log 2>&1 && cmp by_tcc.csv by_clang.csv >>log 2>&1
	result $? "$spec${options:+ $options}: the same bytes by tcc, gcc and clang"
done <list
tap_end
