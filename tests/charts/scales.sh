#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# scales.sh BUILD SCALES ROOT [--quick]: the scales of every model and hard case of the charts, over their whole
# histories or those of the quick run, held by the program scales. Not by a quick run: vanderpol_stiffer, of which it
# takes longer to know what is true than of all others.
set -e
build=$(realpath "$1") program=$(realpath "$2") root=$3 quick=${4:-}
charts=$build/bench/charts
work=$(mktemp -d "${TMPDIR:-/tmp}/scales.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$root"
mkdir "$work/hard"
# Lines of two fields: the models themselves
"$charts/precision" --list | awk -v to="$work/" 'NF == 2 { print to $1, $2 }' |
    xargs -P "${JOBS:-2}" -L 1 bench/charts/variant.sh "$build/plgen"
CHARTS_PROBLEMS=1 sh bench/charts/variants.sh hard "$build/plgen" "$work/hard" "$charts/hard"
names=
expected=25
[ -z "$quick" ] || { names=$("$charts/precision" --names | grep -v '^vanderpol_stiffer$') expected=24; }
{
    # shellcheck disable=SC2086
    "$charts/precision" --scales $quick "$work" $names && "$charts/hard" --scales $quick "$work/hard"
} >"$work/scales" 2>"$work/said" || { status=$?; sed 's/^/# /' "$work/said"; exit $status; }
models=$(awk 'END { print NR }' "$work/scales")
[ "$models" -eq $((expected + 12)) ] || {
    echo "Bail out! $models models and cases, expected $expected and 12"
    exit 1
}
"$program" <"$work/scales"
