#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# retune.sh BUILD: what NAME_retune costs for two masses undamped, damped and driven, at small and large |pole| h,
# beside GSL's matrix exponential.
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo "tunable params, gcc -O2:"
for real in double float; do
	[ $real = float ] && option=-DREAL_FLOAT || option=-DREAL_DOUBLE
	for case in scs:0:m2,k2 sdcs:0.5:k2,c1 sdcsf:0.5:k2,c1; do
		name=${case%%:*} tunable=${case##*:} damping=${case#*:}
		{ cat "models/$name.spec"; echo; echo "tunable $tunable"; } >"$work/$name.spec"
		# the form in which a retuned step is taken
		"$build/plgen" --fast --real $real --form delta --prefix tuned -o "$work/tuned_pl.c" "$work/$name.spec"
		# shellcheck disable=SC2046
		gcc -std=gnu11 -O2 $option -Iruntime -I"$work" bench/retune.c "$work/tuned_pl.c" runtime/*.c \
			$(pkg-config --cflags --libs gsl) -o "$work/retune"
		"$work/retune" $name "${damping%:*}" 0.01 0.05 0.3 3
	done
done
