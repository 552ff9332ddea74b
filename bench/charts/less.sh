#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# less.sh PLGEN LESS VARIANTS: the models of the program less, and what plgen counts for a step of each. Run at the top
# of the source tree.
set -e
plgen=$1 program=$2 variants=$3
mkdir -p "$variants"
"$program" --specs "$variants"
cut -f 1,6 "$variants/less.list" | CHARTS_OPTIMIZE=-O0 xargs -P "${JOBS:-2}" -L1 sh -c '
	plgen=$1 folder=$2 name=$3; shift 3
	"$plgen" "$@" "$folder/$name.spec" 2>/dev/null |
		sed -n "/^ \* One step of/{s/.* \([0-9]*\) multiplications.*/\1/p;q;}" >"$folder/$name.cost"
	exec sh bench/charts/variant.sh "$plgen" "$folder/$name.so" "$folder/$name.spec" "$@"' make "$plgen" "$variants"
