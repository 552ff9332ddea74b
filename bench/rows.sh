#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# rows.sh BUILD: what a million rows cost with runtime/host/plmain.c: as CSV, with --raw, and with a record of inputs of
# 17 digits each; whole processes, their output thrown away.
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$build/plgen" --fast -o "$work/sdcsf_pl.c" models/sdcsf.spec
gcc -O2 -Iruntime runtime/host/plmain.c "$work/sdcsf_pl.c" runtime/*.c -DMODEL=sdcsf -o "$work/sdcsf"
printf "model driven\ncoord x\ninput u hold first\nx'' + 0.2*x' + 40*x = u\nstep 0.001\noutput x\n" >"$work/driven.spec"
"$build/plgen" --fast -o "$work/driven_pl.c" "$work/driven.spec"
gcc -O2 -Iruntime runtime/host/plmain.c "$work/driven_pl.c" runtime/*.c -DMODEL=driven -o "$work/driven"
awk 'BEGIN { srand(1); for (k = 0; k <= 1000000; k++) printf "%.17g\n", rand() - 0.5 }' >"$work/record.csv"

# least NAME COMMAND ...: of five runs, in time of the processor
least() {
	name=$1
	shift
	for run in 1 2 3 4 5; do
		sh -c '"$@" >/dev/null; times' sh "$@" | tail -n 1
	done | tr 'ms' '  ' | awk -v name="$name" '
		{ t = 60 * $1 + $2 + 60 * $3 + $4; if (NR == 1 || t < least) least = t }
		END { printf "    %-44s %5.2f s\n", name, least }'
}

echo 'a million rows of plmain, gcc -O2:'
least 'sdcsf, t and four outputs, as CSV' "$work/sdcsf" 10000
least 'the same, --raw' "$work/sdcsf" 10000 --raw
least 'one input of 17 digits, two columns, as CSV' sh -c 'exec "$0" 1000 <"$1"' "$work/driven" "$work/record.csv"
least 'the same, --raw' sh -c 'exec "$0" 1000 --raw <"$1"' "$work/driven" "$work/record.csv"
