#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# table.sh NAME BUILD ROOT: the table of a chart, made anew, against what is known of it (NAME.awk). As TAP.
# friction: a mass that sticks and slips; the exact step and CVODE from event to event agree with the closed form, and
# find every phase; smoothing is of first order in eps.
# less: models with less in them; the whole ones are without error, by a closed form; errors fall; meshes converge as
# theirs should.
# needs: what was tried for needs, of five scenes; the choice is the cheapest below the line.
# structural: the time integrators of structural dynamics, a case a number; the frame under its record: errors as other
# programs of the formulas have them, and the record byte for byte.
set -u
name=$1 build=$2 root=$3
work=$(mktemp -d "${TMPDIR:-/tmp}/$name.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$root" || exit 99
LC_ALL=C
export LC_ALL

# charted NAME [PROGRAM]: its variants, and what its program makes of them
charted() {
	sh bench/charts/variants.sh "$1" "$build/plgen" "$work/variants" ${2:+"$2"} &&
		"$build/bench/charts/$1" "$work/variants" "$work"
}

tables=$work/$name.csv
case $name in
	friction) charted friction ;;
	less) charted less "$build/bench/charts/less" ;;
	needs) sh bench/charts/needs.sh "$build/plgen" "$work" "$work" ;;
	structural)
		tables="$work/integrators_check.csv $work/frame.csv"
		"$build/bench/charts/integrators" --quick "$work"         # its status: what stands in the table
		charted frame ;;
esac >"$work/log" 2>&1
status=$?
# Words
# shellcheck disable=SC2086
ls $tables >>"$work/log" 2>&1 && { [ $status -eq 0 ] || [ "$name" = structural ]; } || {
	sed 's/^/# /' "$work/log"
	echo "Bail out! exit status $status"
	exit 99
}
[ "$name" != structural ] || cksum <"$work/frame_record.csv" >"$work/cksum"
# shellcheck disable=SC2086
awk -v record="$(cat "$work/cksum" 2>/dev/null)" -f bench/charts/csv.awk -f "tests/charts/$name.awk" $tables
