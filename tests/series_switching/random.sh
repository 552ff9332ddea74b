#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
#     random.sh PLGEN RANDOM_SPECS VARIANTS FIRST COUNT NAME_variants.c NAME_variants.h [stiff]
#
# COUNT random systems, as VARIANTS makes them: each at two steps, or by radau and by auto.
set -eu
plgen=$1
specs=$2
variants=$3
first=$4
count=$5
folder=$(mktemp -d "${TMPDIR:-/tmp}/random.XXXXXX")
trap 'rm -rf "$folder"' EXIT
trap 'exit 99' HUP INT TERM
seed=$first
: >"$folder/list"
while [ "$seed" -lt $((first + count)) ]; do
    "$specs" random "$seed" >"$folder/random$seed.spec"
    if [ $# -gt 7 ]; then
        echo "random$seed 1/4 as=random${seed}radau --scheme radau --tolerance 1e-11" >>"$folder/list"
        echo "random$seed 1/4 as=random${seed}auto --scheme auto --tolerance 1e-11" >>"$folder/list"
    else
        echo "random$seed 1/4,1/32 --tolerance 1e-13" >>"$folder/list"
    fi
    seed=$((seed + 1))
done
"$variants" "$plgen" "$folder/list" "$6" "$7" "$folder"
