#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Drives with gaps that turn freely, for 10^7 steps, in double and float.
#
#     turning.sh PLGEN SOURCE_ROOT
root=$2
warnings='-Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Werror'
. "${0%/*}/../plgen.sh"
here=$root/tests/switching
awk -f "$root/tests/cases.awk" "$root/tests/switching/specs.cases" >names || exit 99

# turns KIND SPEC WHAT
turns() {
    for real in double float; do
        [ $real = float ] && define=-DFLOAT || define=
        # shellcheck disable=SC2086
        "$plgen" --real $real -o model.c "$2" >log 2>&1 &&
            gcc -std=c99 -O0 $warnings $define -DKIND="$1" -I"$root/runtime" -I. "$here/turning.c" model.c "$archive" \
                -lm -o turning >>log 2>&1 &&
            ./turning >>log 2>&1
        result $? "$3, $real"
        grep '^# ' log
    done
}

turns 1 drive_free.spec 'a drive with a gap: torque and speed over 10^7 steps'
turns 2 three_free.spec 'three inertias with gaps: momentum over 2 10^5 steps'
turns 3 "$root/models/gear3.spec" 'gear3 turning at 100: its meshes as at rest, over 2 10^5 steps'

"$plgen" -o model.c drive_free.spec >log 2>&1 &&
    "$plgen" --prefix by_hand -o by_hand.c drive_by_hand.spec >>log 2>&1 &&
    gcc -std=c99 -O0 $warnings -I"$root/runtime" -I. "$here/turning_by_hand.c" model.c by_hand.c "$archive" -lm \
        -o by_hand >>log 2>&1 &&
    ./by_hand >>log 2>&1
result $? 'a drive with a gap: as in twist and mean by hand'
grep '^# ' log

tap_end
