#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# matrix.sh ROOT: who is cheapest of given times, as worked out by hand.
set -u
root=$1
here=$root/tests/charts/matrix
work=$(mktemp -d "${TMPDIR:-/tmp}/matrix.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
charts=$root/bench/charts
awk -f "$charts/csv.awk" -f "$charts/matrix.awk" "$here/precision.csv" >"$work/matrix.csv" 2>"$work/said"
if diff "$work/matrix.csv" "$here/expect.csv" >>"$work/said"; then
    echo "ok 1 - cheapest of ours and of the peers at each error, and how many times"
else
    echo "not ok 1 - cheapest of ours and of the peers at each error, and how many times"
    sed 's/^/# /' "$work/said"
fi
awk -f "$charts/csv.awk" -f "$charts/matrix_table.awk" "$work/matrix.csv" >"$work/table"
cells=$(grep -o '<td class=[a-z]*><b>[^<]*' "$work/table" | sed 's/<td class=//;s/><b>/ /' | tr '\n' ';')
expected='good 2 times;bad DOP853 ahead;bad only a peer;none nobody;good only ours;good only ours;good only ours;'
if [ "$cells" = "${expected}good only ours;" ]; then
    echo "ok 2 - the same as a table"
else
    echo "not ok 2 - the same as a table"
    echo "# found    $cells"
    echo "# expected ${expected}good only ours;"
fi
echo 1..2
