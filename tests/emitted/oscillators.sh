#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Many oscillators that do not influence each other, up to the limit on states: generated, and their Phi and a step as
# closed forms have them, 0 between any two (oscillators.c).
#
#     oscillators.sh PLGEN SOURCE_ROOT COUNT
root=$2
many=$3
. "${0%/*}/../plgen.sh"

awk -v n="$many" 'BEGIN {
    print "model oscillators"
    printf "coord x[%d]\n", n
    for (i = 1; i <= n; i++) printf "init x[%d] = 1/%d\n", i, i
    for (i = 1; i <= n; i++) printf "x[%d]\047\047 + 0.0%d*x[%d]\047 + %d*x[%d] = 0\n", i, i % 7 + 1, i, 10 + 3 * i, i
    print "step 0.01"
}' >oscillators.spec
"$plgen" -o oscillators.c oscillators.spec >log 2>&1
result $? "$many oscillators are generated"
$run_cc -I. -I"$root/runtime" -o check "$root/tests/emitted/oscillators.c" oscillators.c "$archive" \
    -lm >log 2>&1 && ./check >log 2>&1
result $? "$many oscillators: each by itself, as its closed form"
tap_end
