#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# spectrum.sh BUILD: spectra of a record by models/oscillator.spec, by gcc and clang, at -O2 and with the machine's own
# vectors; spectrum.csv and spectrum.svg in BUILD/bench.
set -e
build=$1
out=$build/bench
mkdir -p "$out"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for hold in first fifth seventh; do
	name=$hold
	[ $hold != first ] || name=ramp
	peak=s/x/x/
	[ $hold = first ] || peak='s/^output x$/output sd = peak(x)/'
	sed -e '/^output absolute/d' -e "s/hold first/hold $hold/" -e "$peak" models/oscillator.spec >"$work/$name.spec"
	"$build/plgen" --fast --batch --prefix $name -o "$work/${name}_pl.c" "$work/$name.spec"
done
for compiler in gcc clang; do
	command -v $compiler >/dev/null || continue
	for flags in -O2 '-O2 -march=native -mprefer-vector-width=512'; do
		# shellcheck disable=SC2086
		$compiler -std=gnu99 $flags -ffp-contract=off -Iruntime -I"$work" bench/spectrum.c \
			"$work"/*_pl.c runtime/*.c -lm -o "$work/spectrum"
		echo "$compiler $flags"
		"$work/spectrum" "$out/spectrum.csv"
	done
done
command -v gnuplot >/dev/null || exit 0
gnuplot <<PLOT
set terminal svg size 800,500 font 'sans,12' background 'white'
set output '$out/spectrum.svg'
set datafile separator ','
set logscale xy
set format y '10^{%T}'
set key bottom left
set xlabel 'period [s]'
set ylabel 'error of the largest displacement, relative'
set title '100 periods, 200 Hz record band-limited to 25 Hz, damping 5 %'
plot '$out/spectrum.csv' using 1:5 skip 1 with lines title 'ramps, peaks at samples (lfilter, Nigam and Jennings)', \\
	'' using 1:8 skip 1 with lines title 'plgen, hold fifth, peak(x)', \\
	'' using 1:9 skip 1 with lines title 'plgen, hold seventh, peak(x)'
PLOT
