#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# program.sh PLGEN ROOT [CASE]: the text of --explain=program. A case is a line of cases.list that begins with ===: its
# last word is the spec, from the root of the sources; what is said stands behind it. And the assignments of linear
# steps, done as they are printed, come to where the closed form is.
set -u
plgen=$(realpath "$1") || exit 99
root=$(cd "$2" && pwd) || exit 99
only=${3:-}
. "$root/tests/tap.sh"
. "$root/tests/cases.sh"

cases=$root/tests/program/cases.list
sed -n 's/^=== //p' "$cases" >names
while read -r name options; do
	if [ -n "$only" ] && [ "$only" != "$name" ]; then
		continue
	fi
	awk -v name="$name" '/^=== / { on = $2 == name; next } on' "$cases" >expected
	spec=${options##* }
	# shellcheck disable=SC2086
	"$plgen" --explain=program ${options%"$spec"} "$(path_of "$spec")" >found 2>complaint </dev/null
	status=$?
	diff -U 1 expected found >log || status=1
	result $status "$name"
done <names

# steps SPEC N [OPTION ...]: the states after N steps done as the program says, against the closed form's. States may be
# named with primes; of loads only the constant 1 is known here.
steps() {
	spec=$1
	shift
	number=$1
	shift
	"$plgen" --explain=program "$@" "$root/$spec" >text 2>complaint || return 1
	h=$(sed -n '1s/.*h = \([^ ]*\) s$/\1/p' text)
	end=$(awk -v h="$h" -v n="$number" 'BEGIN { printf "%.12g", h * n }')
	"$plgen" --solution "$end" "$root/$spec" >solution 2>complaint || return 1
	awk -f "$root/tests/program/steps.awk" -v steps="$number" solution text >log
}

if [ -z "$only" ]; then
	steps models/scs.spec 200
	result $? 'kicks and drifts of scs, in order, for 200 steps'
	steps models/scs.spec 200 --form delta
	result $? 'increments of scs for 200 steps'
	steps models/scs.spec 200 --form direct
	result $? 'Phi of scs for 200 steps'
	steps models/quarter_car.spec 500
	result $? 'increments of quarter_car, with a constant load, for 500 steps'
fi
tap_end
