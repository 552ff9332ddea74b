#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# frame.sh PLGEN VARIANTS: the variants of the program frame. Run at the top of the source tree.
set -e
plgen=$1 variants=$2
mkdir -p "$variants"
for parts in 1 2 4; do
	sh bench/charts/variant.sh "$plgen" "$variants/frame-$parts.so" models/frame.spec --step 1/50/$parts
done
