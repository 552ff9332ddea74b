#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# retune_blocks.sh BUILD: instructions of NAME_retune where 0, 1, 2, 5 or all of ten independent blocks have other
# params, beside e^{A h} of the whole at once, and its work space; counted by callgrind, so on any machine alike.
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
{
	echo "model ten"
	awk 'BEGIN {
		for (i = 1; i <= 10; i++) {
			params = params (i > 1 ? ", " : "") "k" i
			values = values (i > 1 ? ", " : "") "k" i " = " 100 + i
			coords = coords (i > 1 ? ", " : "") "a" i ", b" i
		}
		print "param " values "\ntunable " params "\ncoord " coords "\noutput a1"
		for (i = 1; i <= 10; i++) {
			print "a" i "\47\47 + 0.5*a" i "\47 + k" i "*a" i " + 50*(a" i " - b" i ") = 0"
			print "b" i "\47\47 + 0.5*b" i "\47 + k" i "*b" i " + 50*(b" i " - a" i ") = 0"
		}
		print "step 0.01"
	}'
} >"$work/ten.spec"
# counted FUNCTION ARGUMENT: instructions in it
counted() {
	valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect="$1" "$work/ten" "$2" 2>&1 |
		sed -n 's/.*Collected : //p'
}
echo "ten independent blocks of four states, gcc -O2: thousands of instructions of a retune"
for real in double float; do
	[ $real = float ] && option=-DREAL_FLOAT || option=-DREAL_DOUBLE
	"$build/plgen" --fast --real $real -o "$work/ten_pl.c" "$work/ten.spec"
	gcc -std=gnu11 -O2 $option -Iruntime -I"$work" bench/retune_blocks.c "$work/ten_pl.c" runtime/*.c -o "$work/ten"
	for count in 0 1 2 5 10; do
		echo "    $real, $count of 10 blocks: $(($(counted ten_retune $count) / 1000))"
	done
	echo "    $real, all 40 states at once: $(($(counted whole -1) / 1000))"
	sed -n 's/.*It needs some \(.*\) of stack.*/    stack of it: some \1/p' "$work/ten_pl.c"
done
