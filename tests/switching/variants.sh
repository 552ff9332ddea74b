#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# variants.sh PLGEN LIST NAME_variants.c NAME_variants.h FOLDER ...: variants of piecewise-linear models as
# ../remainder/variants.sh makes them, of lists whose lines have no schemes, `NAME STEPS [OPTION ...]`.
set -eu
list=$2
lists=$(mktemp -d "${TMPDIR:-/tmp}/variants.XXXXXX")
trap 'rm -rf "$lists"' EXIT
trap 'exit 99' HUP INT TERM
sed '/^#/!s/^[^ ][^ ]* /&- /' "$list" >"$lists/${list##*/}"
plgen=$1
shift 2
regions=1 "${0%/*}/../remainder/variants.sh" "$plgen" "$lists/${list##*/}" "$@"
