#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# output NAME = peak(x) against values between steps (peaks.c), and where it cannot be.
#
#     peaks.sh PLGEN SOURCE_ROOT
set -u
plgen=$1
root=$2
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
case $root in /*) ;; *) root=$PWD/$root ;; esac
here=$root/tests/peaks
. "$root/tests/run_cc.sh"
. "$root/tests/tap.sh"
runtime_archive "$root/runtime"

# finds SPEC FLAGS OPTION ...
finds() {
    spec=$1
    flags=$2
    shift 2
    {
        "$plgen" --prefix m "$@" -o m.c "$here/$spec.spec" &&
            $run_cc -I"$root/runtime" -c m.c -o m.o &&
            $run_cc $flags -I"$root/runtime" -I. "$here/peaks.c" m.o "$archive" -lm -o m && ./m
    } >log 2>&1
    result $? "$spec${*:+ $*}: the largest values between steps"
}

finds peaks ''
# what is tuned finds values between steps by a matrix of two words
finds tuned "-DTUNED $([ -n "${LONG:-}" ] || echo -DSTEPS=150)"
if [ -n "${LONG:-}" ]; then
    finds peaks '' --step 0.01
    finds peaks '' --step 0.2
    finds tuned -DTUNED --step 0.16
fi

# refused TEXT EQUATION OUTPUT OPTION ...
refused() {
    text=$1
    printf "model a\\ncoord x, z\\ninit x = 1\\nz' + z = 0\\n%s\\noutput q = %s\\nstep 0.1\\n" "$2" "$3" >refused.spec
    shift 3
    "$plgen" "$@" refused.spec >out 2>log
    [ $? -eq 1 ] && [ ! -s out ] && grep -q "error: $text" log
    result $? "refused: $text"
}

refused 'peak stands alone: output NAME = peak(EXPR)' "x'' + x = 0" 'peak(x)*2'
refused "expected '(': peak(x) is the largest |x| so far, found 'x'" "x'' + x = 0" 'peak x'
here="the peak of 'q' cannot be found here"
refused "$here: it is not linear" "x'' + x = 0" 'peak(x*z)'
refused "$here: the model is piecewise linear" "x'' + abs(x) = 0" 'peak(x)'
refused "$here: the model has a leftover" "x'' + x^3 = 0" 'peak(x)'
refused "$here: loads change" "x'' + x = t < 1 ? t : 0" 'peak(x)'
refused "the peak of 'q' has no closed form" "x'' + x = cos(t)" 'peak(x)' --solution 1
tap_end
