#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# switching.sh BUILD: time of a step of piecewise-linear models without a crossing and with one, beside the same model
# without stops.
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo "piecewise-linear models, gcc -O2:"
for case in stop:0.001 stop:0.01 bilinear:0.01 gear1:0.01 gear1:0.1 gear2:0.1 gear2:1 gear3:0.001 gear3:0.01; do
	name=${case%:*} h=${case#*:}
	# the same without stops: every piecewise-linear function is its argument
	sed -e 's/deadzone(\([a-z0-9]*\(\[1\]\)*\), -b[0-9]*, b[0-9]*)/\1/' -e 's/max(x, 0)/x/' \
		-e 's/(x > 0 ? k2\*x : k1\*x)/k1*x/' "models/$name.spec" >"$work/plain.spec"
	"$build/plgen" --fast --step "$h" --prefix plain -o "$work/plain_pl.c" "$work/plain.spec" 2>/dev/null
	"$build/plgen" --fast --step "$h" --prefix stops -o "$work/stops_pl.c" "models/$name.spec" 2>/dev/null
	cat >"$work/crossed.c" <<'EOT'
#include "stops_pl.h"
uint64_t crossed(const void *s);
uint64_t crossed(const void *s)
{
    return stops_crossed((const stops *)s);
}
EOT
	gcc -std=gnu11 -O2 -Iruntime -I"$work" bench/switching.c "$work/plain_pl.c" "$work/stops_pl.c" \
		"$work/crossed.c" runtime/*.c -o "$work/switching"
	"$work/switching" "$name"
done
