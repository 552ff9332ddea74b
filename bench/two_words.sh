#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# two_words.sh BUILD: instructions of a step of piecewise-linear models, their crossings counted in, without and with
# --accuracy compensated, by valgrind's callgrind: of 30,000 steps less those of 10,000.
set -e
build=$1
root=$PWD
work=$(mktemp -d)
. tests/cases.sh
trap 'rm -rf "$work"' EXIT
cat >"$work/steps.c" <<'EOT'
#include "moving_pl.h"
#include <stdio.h>
#include <stdlib.h>
static moving s;
int main(int argc, char **argv)
{
    (void)argc;
    moving_init(&s);
    moving_run(&s, (size_t)atol(argv[1]), NULL);
    printf("%.4f\n", (double)moving_crossed(&s) / atof(argv[1]));
    return moving_status(&s);
}
EOT
# instructions STEPS
instructions() {
	valgrind --tool=callgrind --callgrind-out-file="$work/out" "$work/steps" "$1" 2>"$work/log" >"$work/crossed"
	sed -n 's/.*Collected : //p' "$work/log"
}
echo "instructions a step, gcc -O2; crossings a step; one word, two words, ratio:"
for case in tests/contacts/lasting_gap:0.01 tests/contacts/lasting_pair:0.013 models/bilinear:0.01 models/gear1:0.01 \
	models/gear1:0.1 models/gear2:0.1 models/gear3:0.01 models/impact_oscillator:0.01 models/stick_slip:0.01; do
	spec=$(cd "$work" && path_of "${case%:*}.spec")
	[ -f "$spec" ] || continue
	line=
	for accuracy in '' '--accuracy compensated'; do
		# shellcheck disable=SC2086
		"$build/plgen" --fast $accuracy --step "${case#*:}" --prefix moving -o "$work/moving_pl.c" "$spec" \
			2>/dev/null
		gcc -std=gnu11 -O2 -Iruntime -I"$work" "$work/steps.c" "$work/moving_pl.c" "$build/libplrt.a" \
			-o "$work/steps"
		few=$(instructions 10000)
		line="$line $((($(instructions 30000) - few) / 20000))"
	done
	# shellcheck disable=SC2086
	set -- $line
	echo "$case: $(cat "$work/crossed") crossings: $1, $2, $(echo "$2 $1" | awk '{ printf "%.2f", $1 / $2 }')"
done
