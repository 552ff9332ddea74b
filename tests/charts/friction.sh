#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# friction.sh BUILD ROOT: a mass that sticks and slips: the exact step and CVODE from event to event agree with the
# closed form, and find every phase; smoothing is of first order in eps. As TAP.
set -u
build=$1 root=$2
work=$(mktemp -d "${TMPDIR:-/tmp}/friction.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$root" || exit 99
LC_ALL=C
export LC_ALL
{
    sh bench/charts/variants.sh friction "$build/plgen" "$work" &&
        "$build/bench/charts/friction" "$work" "$work"
} >"$work/log" 2>&1 || {
    sed 's/^/# /' "$work/log"
    echo "Bail out! no table"
    exit 99
}
awk -f bench/charts/csv.awk -f tests/charts/friction.awk "$work/friction.csv"
