#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# friction.sh PLGEN VARIANTS: the variants of the program friction. Run at the top of the source tree.
set -e
plgen=$1 variants=$2
mkdir -p "$variants"
for parts in 1 5; do
	CHARTS_RHS= sh bench/charts/variant.sh "$plgen" "$variants/friction-$parts.so" \
		bench/charts/specs/friction.spec --step 1/20/$parts
done
