#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# archive.sh BOARD SOURCE_ROOT OUT.a [linear]: the runtime for a board, or what linear models need of it, once for all
# tests that run there; empty where there is no compiler for it, without which they are skipped.
set -eu
firmware=$(cd "${0%/*}" && pwd)
. "$firmware/boards.sh"
optimize_less "$1"
board "$1"
root=$2
out=$(realpath "$3")
rm -f "$out"
if ! boards_installed; then
    ar rcD "$out"
    exit 0
fi
work=$(mktemp -d "${TMPDIR:-/tmp}/firmware.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
kept=${4:-all}
set --
for file in "$root"/runtime/*.c; do
    case $kept/${file##*/} in linear/guards* | linear/crossings* | linear/event*) continue ;; esac
    set -- "$@" "$file"
done
# shellcheck disable=SC2086
$arm-gcc $optimize $cpu -I"$root/runtime" -c "$@"
$arm-ar rcD "$out" ./*.o
