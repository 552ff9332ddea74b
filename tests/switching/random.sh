#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
#     random.sh PLGEN RANDOM_SPECS KIND FIRST COUNT NAME_variants.c NAME_variants.h [STEPS]
#
# COUNT random systems, each at the STEPS, or 0.5, 1, 2, 4 and a hundredth of the shortest, as variants.sh makes them.
set -eu
plgen=$1
specs=$2
kind=$3
first=$4
count=$5
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d "${TMPDIR:-/tmp}/random.XXXXXX")
trap 'rm -rf "$folder"' EXIT
trap 'exit 99' HUP INT TERM
seed=$first
: >"$folder/list"
while [ "$seed" -lt $((first + count)) ]; do
    "$specs" "$kind" "$seed" >"$folder/$kind$seed.spec"
    echo "$kind$seed ${8:-0.5,1,2,4,0.005}" >>"$folder/list"
    seed=$((seed + 1))
done
"$here/variants.sh" "$plgen" "$folder/list" "$6" "$7" "$folder"
