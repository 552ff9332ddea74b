#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# growth.sh BUILD: time to generate against the number of coordinates, for chains of damped masses, for dense matrices
# of 17-digit numbers and for oscillators that do not influence each other; a table, and growth.csv and growth.svg in
# BUILD/bench.
set -e
build=$1
out=$build/bench
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo 'int main(void) { return 0; }' >"$work/empty.c"
${CC:-cc} -O2 "$work/empty.c" -o "$work/empty"

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
measure() {
	"$3" "$2" >"$work/$1.spec"
	"$build/bench/clock" 5 "$work/empty" -- "$build/plgen" "$work/$1.spec" |
		awk -v kind="$1" -v n="$2" '/^plgen/ {
			for (i = 1; i <= NF; i++) if ($i == "median") print kind "," n "," $(i + 1) }'
}
{
	echo 'model,coordinates,milliseconds'
	for n in 1 2 4 6 7 8 12 15 20 30 40; do measure chain $n chain; done
	for n in 1 2 4 6 7 8 12 15 20 30; do measure dense $n dense; done
	for n in 1 2 4 8 15 30 60 125 250; do measure oscillators $n oscillators; done
} | tee "$out/growth.csv" | column -s, -t 2>/dev/null || cat "$out/growth.csv"
gnuplot <<EOT
set terminal svg size 720,480 font 'sans-serif,13' background rgb 'white'
set output '$out/growth.svg'
set datafile separator ','
set logscale xy
set title 'plgen: time to generate (median of 5)'
set xlabel 'coordinates'
set ylabel 'time [ms]'
set grid lc rgb '#dddddd'
set key left top
plot '$out/growth.csv' using (strcol(1) eq 'chain' ? \$2 : 1/0):3 with linespoints pt 7 lc rgb '#0b5fa5' title \
	'chain of damped masses', \
     '' using (strcol(1) eq 'dense' ? \$2 : 1/0):3 with linespoints pt 4 dt 2 lc rgb '#c4501b' title \
     	'dense matrices of 17 digits', \
     '' using (strcol(1) eq 'oscillators' ? \$2 : 1/0):3 with linespoints pt 6 dt 3 lc rgb '#2a7d2a' title \
     	'oscillators apart'
EOT
echo "$out/growth.svg"
