#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# sweep.sh BUILD: the gear pair of models/gear1.spec over the frequency of its force, up and down: gear1_sweep.csv and
# gear1_sweep.svg in BUILD/bench. Parameters as in the spec; they are chosen, the source's did not survive.
set -e
build=$1
out=$build/bench
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
: >"$work/all.c"
models='' etas='' count=0
for eta in $(awk 'BEGIN { for (k = 25; k <= 110; k++) print k / 100 }'); do
	name=gear_$count
	"$build/plgen" --fast --prefix "$name" --step 0.05 -D eta="$eta" -D zeta=0.02 -D fa=0.06 models/gear1.spec \
		>>"$work/all.c"
	models="$models&${name}_model, " etas="$etas$eta, " count=$((count + 1))
done
cat >>"$work/all.c" <<EOT
const pl_model *const sweep_models[] = {$models};
const double sweep_eta[] = {$etas};
const int sweep_count = $count;
EOT
gcc -O1 -Iruntime bench/sweep.c "$work/all.c" runtime/*.c -o "$work/sweep"
"$work/sweep" >"$out/gear1_sweep.csv"
sh bench/charts/picture.sh gear1_sweep "$out" "$out"
echo "$out/gear1_sweep.svg"
