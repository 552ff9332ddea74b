#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# generate.sh BUILD: what generating costs, as medians of many whole processes, each beside an empty program; and the
# milliseconds against the number of coordinates, for chains of damped masses, for dense matrices of 17-digit numbers
# and for oscillators that do not influence each other.
set -e
build=$1
runs=50
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo 'int main(void) { return 0; }' >"$work/empty.c"
${CC:-cc} -O2 "$work/empty.c" -o "$work/empty"
"$build/bench/clock" "$runs" "$work/empty" -- "$build/plgen" models/sdcsf.spec
"$build/bench/clock" "$runs" "$work/empty" -- "$build/plgen" models/tuned_floor.spec
"$build/bench/clock" 5 "$work/empty" -- "$build/plgen" --solution 30 models/sdcsf.spec
"$build/bench/clock" 5 "$work/empty" -- "$build/plgen" --solution 30 models/quarter_car.spec
"$build/bench/clock" 5 "$work/empty" -- "$build/plgen" models/beam15.spec
"$build/bench/clock" 5 "$work/empty" -- "$build/plgen" --scheme etd1 models/beam4.spec

chain() {
	awk -v n="$1" 'BEGIN {
		print "model chain"; printf "coord"
		for (i = 1; i <= n; i++) printf "%s x%d", (i > 1 ? "," : ""), i
		print "\ninit x1 = 1"
		for (i = 1; i <= n; i++) {
			to = (i > 1 ? "x" (i - 1) : "ground")
			printf "mass %.1f at x%d\nspring 100 between %s, x%d\ndamper 0.1 between %s, x%d\n", 1 + i / \
				10, i, to, i, to, i
		}
		print "step 0.01" }'
}
# Symmetric, diagonally dominant, from a small linear congruential generator: the same everywhere
dense() {
	for name in M C K; do
		awk -v n="$1" -v seed="$(printf '%d' "'$name")" 'BEGIN {
			x = seed
			for (i = 1; i <= n; i++) for (j = 1; j <= i; j++) {
				digits = ""
				for (k = 0; k < 4; k++) { x = (x * 1103 + 12345) % 65536; digits = digits \
					sprintf("%04d", x % 10000) }
				x = (x * 1103 + 12345) % 65536
				a[i, j] = a[j, i] = (i == j ? n : 0) "." digits x % 10
			}
			print "%%MatrixMarket matrix array real general"; print n, n
			for (j = 1; j <= n; j++) for (i = 1; i <= n; i++) print a[i, j] }' >"$work/$name.mtx"
	done
	printf 'model dense\nmatrix M = "M.mtx", C = "C.mtx", K = "K.mtx"\ncoord q[%d]\ninit q[1] = 1\n' "$1"
	printf "M*q'' + 0.01*C*q' + 100*K*q = 0\nstep 0.01\n"
}
oscillators() {
	awk -v n="$1" 'BEGIN {
		print "model oscillators"
		printf "coord x[%d]\n", n
		for (i = 1; i <= n; i++) printf "init x[%d] = 1/%d\n", i, i
		for (i = 1; i <= n; i++)
			printf "x[%d]\047\047 + 0.0%d*x[%d]\047 + %d*x[%d] = 0\n", i, i % 7 + 1, i, 10 + 3 * i, i
		print "step 0.01" }'
}
for case in chain:'1 2 4 6 7 8 12 15 20 30 40' dense:'1 2 4 6 7 8 12 15 20 30 60' \
	oscillators:'1 2 4 8 15 30 60 125 250'; do
	kind=${case%%:*}
	echo "$kind:"
	for n in ${case#*:}; do
		"$kind" "$n" >"$work/$kind.spec"
		"$build/bench/clock" 5 "$work/empty" -- "$build/plgen" "$work/$kind.spec" |
			awk -v n="$n" '/^plgen/ { sub(/.*median */, ""); printf "%6d %s\n", n, $1 }'
	done
done
