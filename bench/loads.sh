#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# loads.sh BUILD: what a cosine costs in a step of two masses: beside the step without it, and with the cosine evaluated
# in every step.
set -eu
plgen=$1/plgen
work=$(mktemp -d "${TMPDIR:-/tmp}/loads.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
sed 's/= F\*cos(w\*t)$/= 0/' models/sdcsf.spec >"$work/none.spec"
"$plgen" --fast --prefix none -o "$work/none.c" "$work/none.spec"
"$plgen" --fast --prefix anchored -o "$work/anchored.c" models/sdcsf.spec
"$plgen" --fast --prefix direct --refresh 1 -o "$work/direct.c" models/sdcsf.spec
for compiler in gcc clang; do
	command -v "$compiler" >"$work/found" || continue
	for options in -O2 '-O2 -march=native'; do
		echo "$compiler $options:"
		# shellcheck disable=SC2086
		"$compiler" -std=c99 $options -Iruntime -I"$work" bench/loads.c "$work/none.c" "$work/anchored.c" \
			"$work/direct.c" runtime/*.c -o "$work/loads"
		"$work/loads"
	done
done
