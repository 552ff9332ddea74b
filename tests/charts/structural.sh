#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# structural.sh BUILD ROOT: the time integrators of structural dynamics against what is known of them, a case a number;
# the frame under its record: errors as other programs of the formulas have them, and the record byte for byte.
set -u
build=$1 root=$2
work=$(mktemp -d "${TMPDIR:-/tmp}/structural.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$root" || exit 99
LC_ALL=C
export LC_ALL
"$build/bench/charts/integrators" --quick "$work" >"$work/log" 2>&1       # its status: what stands in the table
{
    sh bench/charts/variants.sh frame "$build/plgen" "$work/variants" &&
        "$build/bench/charts/frame" "$work/variants" "$work"
} >>"$work/log" 2>&1
status=$?
[ -f "$work/integrators_check.csv" ] && [ -f "$work/frame.csv" ] || {
    sed 's/^/# /' "$work/log"
    echo "Bail out! exit status $status"
    exit 99
}
cksum <"$work/frame_record.csv" >"$work/cksum"
awk -v record="$(cat "$work/cksum")" -f bench/charts/csv.awk -f tests/charts/structural.awk \
    "$work/integrators_check.csv" "$work/frame.csv"
