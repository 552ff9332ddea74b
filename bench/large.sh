#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# large.sh BUILD [MASSES]: a step of models of 80 states, or twice MASSES, with a load and an input, beside a loop by
# hand and, where OpenBLAS is installed, its dgemv. On an AVX-512 Xeon of 3 GHz 40 masses should take 1.3 us at -O2 and
# 0.5 with -march=native and no more than dgemv, three outputs of them 100 and 35 ns.
set -e
build=$1
masses=${2:-40}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# spec NAME LAST: masses in a row; or, each for itself, oscillators under an input
spec() {
	awk -v name="$1" -v last="$2" -v n="$masses" 'BEGIN {
		for (i = 1; i <= n; i++) list = list (i > 1 ? ", " : "") "x" i
		print "model " name "\ncoord " list "\ninit x1 = 1\ninput a"
		for (i = 1; i <= n; i++) {
			text = "x" i "\47\47 + " 0.1 * i "*x" i "\47 + " 30 + 10 * i "*x" i " = -a"
			if (name != "oscillators") {
				text = "x" i "\47\47 + 0.2*x" i "\47 + 200*x" i
				if (i > 1) text = text " - 0.05*x" (i - 1) "\47 - 100*x" (i - 1)
				if (i < n) text = text " - 0.05*x" (i + 1) "\47 - 100*x" (i + 1)
				text = text (i > 1 ? " = 0" : " = a + cos(3*t)")
			}
			print text
		}
		print last "\nstep 0.01"
	}' >"$work/$1.spec"
	"$build/plgen" --fast "$work/$1.spec" -o "$work/$1_pl.c"
}
spec masses ''
spec outputs "output x1, x$((masses / 2)), x$masses"
spec oscillators ''
blas=
echo 'void dgemv_(void); int main(void) { dgemv_(); return 0; }' >"$work/blas.c"
# shellcheck disable=SC2086
if gcc "$work/blas.c" ${LDFLAGS:-} -lopenblas -o "$work/blas" 2>"$work/log"; then
	blas='-DDGEMV -lopenblas'
else
	echo "OpenBLAS is not there (libopenblas-dev): no dgemv"
fi
for compiler in gcc clang; do
	for flags in -O2 '-O2 -march=native'; do
		# shellcheck disable=SC2086
		$compiler -std=gnu11 $flags -Iruntime -I"$work" bench/large.c "$work"/*_pl.c runtime/*.c ${LDFLAGS:-} \
			$blas -o "$work/large"
		OPENBLAS_NUM_THREADS=1 "$work/large" "$compiler $flags, $masses coordinates"
	done
done
