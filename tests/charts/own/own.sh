#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# own.sh BUILD ROOT [SPEC...]: the chart of any spec, on these, or all models, or with STRIDE=N in the environment each
# N-th: errors and orders, never times; and what it refuses, with the reason.
set -u
build=$1 root=$2
shift 2
here=$root/tests/charts/own
. "$root/tests/tap.sh"
# what bounces or sticks is refused: below. Words: names of files
# shellcheck disable=SC2046
[ $# -gt 0 ] || set -- $(cd "$root" && grep -Le '^when' -e restitution -e '[^a-z]friction(' models/*.spec |
	awk -v by="${STRIDE:-1}" 'NR % by == 0')

chart() {
	(cd "$root" && exec sh bench/charts/own/own.sh -q "$build/plgen" "$@") >log 2>&1
}

for spec; do
	name=$(basename "$spec" .spec)
	chart "$spec" "$work"
	result $? "$name: charted"
	awk -v name="$name" -f "$root/bench/charts/csv.awk" -f "$here/own.awk" "$name.csv" >log 2>&1
	result $? "$name: errors and orders of plgen's steps and of peers"
	{
		grep -q '</svg>' "$name.svg" && grep -q -e '<use ' "$name.svg" || echo "the picture is not whole"
		[ "$(grep -c '^error below 1e-[0-9]*:' "$name.txt")" = 4 ] || cat "$name.txt"
	} >log 2>&1
	[ ! -s log ]
	result $? "$name: a picture, and a verdict for each wanted error"
done

# refused NAME STATUS TEXT ARGUMENT...: that text is said
refused() {
	what=$1 text=$2
	shift 2
	chart "$@"
	[ $? -eq 1 ] && grep -qF -e "$text" log
	result $? "refused: $what"
}
printf '%s\n' 'model unknown' 'coord x' "x'' + x = z" 'step 0.1' >unknown.spec
printf '%s\n' 'model third' 'coord x' 'input u hold third' "x'' + x = u" 'step 0.1' >third.spec
refused 'what plgen refuses, in its words' "unknown.spec:3:11: error: unknown name 'z'" "$PWD/unknown.spec" "$work"
refused 'inputs joined by cubics' 'inputs that are joined by polynomials of higher degree' "$PWD/third.spec" "$work"
refused 'what bounces' 'what bounces is not charted' models/bouncing_ball.spec "$work"
refused 'what sticks' 'has no formula for friction' models/stick_slip.spec "$work"
refused 'no such file' 'no file nothing.spec' nothing.spec "$work"
refused 'no output before the end' 'are 0 outputs' models/pendulum.spec "$work" 0.01
refused 'a time that is none' 'error:' models/pendulum.spec "$work" 1 x

tap_end
