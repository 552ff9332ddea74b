#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# retuned.sh BUILD: time of a step of piecewise-linear models whose stiffness and gaps are tunable, beside the same
# model with the values written.
set -e
build=$1
root=$PWD
work=$(mktemp -d)
. tests/cases.sh
trap 'rm -rf "$work"' EXIT
echo "piecewise-linear models with tunable params, gcc -O2:"
for case in models/stop:0.001:m,k,ks models/stop:0.01:m,k,ks models/bilinear:0.01:m,k1,k2 models/gear1:0.01:zeta,b \
	models/gear1:0.1:zeta,b models/gear2:0.1:W,b tests/tunable/regions/coupled:0.01:; do
	file=${case%%:*} tunable=${case##*:} h=${case#*:}
	h=${h%:*}
	name=$(basename "$file")
	spec=$(cd "$work" && path_of "$file.spec")
	grep -v '^tunable' "$spec" >"$work/written.spec"
	if [ "$name" = gear2 ]; then        # a param in the place of each stiffness
		sed -e 's/^matrix W .*/param w = 1, c = 0.5\nmatrix W = [w, -c; -c, w]/' "$work/written.spec" \
			>"$work/spec"
		mv "$work/spec" "$work/written.spec"
		tunable=w,c,b
	fi
	{ cat "$work/written.spec"; echo; sed -n '/^tunable/p' "$spec"; } >"$work/retuned.spec"
	[ "$tunable" ] && echo "tunable $tunable" >>"$work/retuned.spec"
	"$build/plgen" --fast --step "$h" --prefix written -o "$work/written_pl.c" "$work/written.spec" 2>/dev/null
	"$build/plgen" --fast --step "$h" --prefix retuned -o "$work/retuned_pl.c" "$work/retuned.spec" 2>/dev/null
	gcc -std=gnu11 -O2 -Iruntime -Ibench -I"$work" bench/retuned.c "$work/written_pl.c" "$work/retuned_pl.c" \
		runtime/*.c -o "$work/retuned"
	"$work/retuned" "$name, h = $h"
done
