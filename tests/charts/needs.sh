#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# needs.sh BUILD ROOT: what was tried for needs, of five scenes: the choice is the cheapest below the line.
set -u
build=$1 root=$2
work=$(mktemp -d "${TMPDIR:-/tmp}/needs.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$root" || exit 99
LC_ALL=C
export LC_ALL
sh bench/charts/needs.sh "$build/plgen" "$work" "$work" >"$work/log" 2>&1 || {
    sed 's/^/# /' "$work/log"
    echo "Bail out! no table"
    exit 99
}
awk -f bench/charts/csv.awk -f tests/charts/needs.awk "$work/needs.csv"
