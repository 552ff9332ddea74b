#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# truths.sh PLGEN PROGRAM ROOT: the generated code of every smooth model of the charts, then that program (truths,
# peers) on it.
set -e
plgen=$(realpath "$1") program=$(realpath "$2") root=$3
work=$(mktemp -d "${TMPDIR:-/tmp}/truths.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$root"
{
    for name in pendulum vanderpol vanderpol_stiff quad2dof duffing mathieu beam4 beam15 gear1 gear2 gear3; do
        echo "$work/$name.so models/$name.spec"
    done
    for name in vanderpol_stiffer henon_heiles coupled_vanderpol double_pendulum rayleigh duffing_pair \
        spherical_pendulum; do
        echo "$work/$name.so bench/charts/specs/$name.spec"
    done
} | xargs -P "${JOBS:-2}" -L 1 bench/charts/variant.sh "$plgen"
"$program" "$work" 2>"$work/said" || { status=$?; sed 's/^/# /' "$work/said"; exit $status; }
