#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# less.sh BUILD ROOT: models with less in them: the whole ones are without error, by a closed form; errors fall; meshes
# converge as theirs should.
set -u
build=$1 root=$2
work=$(mktemp -d "${TMPDIR:-/tmp}/less.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$root" || exit 99
LC_ALL=C
export LC_ALL
{
    sh bench/charts/variants.sh less "$build/plgen" "$work" "$build/bench/charts/less" &&
        "$build/bench/charts/less" "$work" "$work"
} >"$work/log" 2>&1 || {
    sed 's/^/# /' "$work/log"
    echo "Bail out! no table"
    exit 99
}
awk -f bench/charts/csv.awk -f tests/charts/less.awk "$work/less.csv"
