#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# rows.sh PLGEN: where needs choose the step, the rows of --solution are as far apart as the steps of the C, which its
# header says; t of row k is k times that.
plgen=$(realpath "$1")
. "${0%/*}/../tap.sh"

# apart NAME EQUATION STATEMENT OPTION...
apart() {
	name=$1
	printf 'model apart\ncoord x\ninit x = 1\n%s\noutput x\n%s\n' "$2" "$3" >apart.spec
	shift 3
	h=$("$plgen" "$@" --header apart.spec 2>log | sed -n 's/^#define APART_H \([0-9.e-]*\)f\{0,1\} .*/\1/p')
	"$plgen" "$@" --solution "20*($h)" apart.spec 2>>log | grep -v '^#' | awk -F, -v h="$h" 'NR > 1 {
		off = $1 - (NR - 2) * h
		if (!(off <= 1e-9 * h * NR && off >= -1e-9 * h * NR))
			print "row", NR - 2, "at", $1, "h", h
	} END { print NR - 1 " rows" }' >>log
	[ -n "$h" ] && grep -q '^21 rows' log && ! grep -q '^row' log
	result $? "rows of --solution are steps of the C, h = $h: $name"
}
apart 'a certified need' "x'' + 0.1*x' + 4*x = cos(t)" 'need x within 1e-4 until 50'
apart 'a fast load' "x'' + 0.1*x' + 4*x = cos(40*t)" 'need x within 1e-6 until 7'
apart 'a certified need, float' "x'' + 0.1*x' + 4*x = cos(3*t)" 'need x within 1e-4 until 50' --real float
apart 'a measured need' "x'' + 0.1*x' + 4*max(x, -0.5) = cos(t)" 'need x within 1e-4 until 50'
apart 'a step that is written' "x'' + 0.1*x' + 4*x = cos(t)" 'need x within 1e-4 until 50
step 0.03'
apart 'a step on the command line' "x'' + 0.1*x' + 4*x = cos(t)" 'need x within 1e-4 until 50' --step 0.07

printf 'model apart\ncoord x\nx%s + x = cos(t)\nneed x within 1e-40 until 50\n' "''" >apart.spec
"$plgen" --solution 1 apart.spec >out 2>log
[ $? -eq 1 ] && [ ! -s out ] && grep -q 'error: the needs choose no step: the need cannot be met' log
result $? 'a need that cannot be met has no rows'

printf '%s\n' 'model swings' 'coord x, z' 'init x = 0.3, z = -0.4' "energy T = (x'^2 + z'^2)/2, V = 9.81*z" \
	'constraint rod: x^2 + z^2 = 0.25' 'need z within 1e-9 until 2' >swings.spec
"$plgen" swings.spec 2>log | grep -q 'where x, z are each 10 % more or less'
result $? "starts beside the spec's are on the constraint, as the spec's is"
tap_end
