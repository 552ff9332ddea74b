#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# phase.sh PLGEN SOURCE REAL: frequencies that change while a model runs, in every scheme that takes tunable params;
# phase.c says what is compared. Every third of the programs is sanitized, with LONG=1 in the environment all.
root=$2
real=$3
. "${0%/*}/../../plgen.sh"
float=''
[ "$real" = double ] || float=-DREAL_FLOAT
sanitizing="${CC:-cc} -std=c11 -O0 -fsanitize=undefined -fno-sanitize-recover"
# without what stops anyway at the address where it goes, which takes half of the time to compile
long || sanitizing="$sanitizing -fno-sanitize=null,alignment,object-size,pointer-overflow"
turn=0

# drive MODEL TOLERANCE SCHEME: of double; float has its own digits
drive() {
	tolerance=$2
	[ "$real" = double ] || tolerance=$(echo "$2" | awk '{ print $1 < 2e-5 ? "2e-5f" : $1 "f" }')
	turn=$((turn + 1))
	compile=$run_cc
	{ ! long && [ $((turn % 3)) -ne 1 ]; } || compile=$sanitizing
	# shellcheck disable=SC2086
	"$plgen" --real "$real" ${3:+--scheme "$3"} -o phase_pl.c "$root/tests/tunable/phase/$1.spec" >log 2>&1 &&
		$compile $float -DTOLERANCE="$tolerance" -I. -I"$root/runtime" -I"$root/tests/emitted" -o phase \
			"$root/tests/tunable/phase/phase.c" phase_pl.c "$root/tests/emitted/tap.c" "$archive" -lm \
			>>log 2>&1 &&
		./phase >>log 2>&1
	status=$?
	grep '^not ok' log | sed 's/^/# /'
	result $status "$real, $1 ${3:-exact}"
}

drive linear 1e-12 ''
drive regions 1e-12 ''
drive series 2e-8 taylor
drive series 2e-8 radau
drive series 1e-6 etdrk4
drive series 1e-8 etdam6
drive series 1e-10 etdcol
if [ "$real" = double ]; then
	drive series 1e-12 'taylor 12'
	drive series 1e-12 'taylor 12 over 3'
	drive series 2e-8 auto
	drive series 5e-2 etd1
	drive series 1e-3 etdrk2
	drive series 1e-6 nc2
	drive series 1e-6 nc3
	drive series 1e-6 dq4
	drive series 1e-6 bm3
	drive series 1e-6 etdam4
fi
tap_end
