#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# output NAME = peak(x) against values between steps (peaks.c), and where it cannot be.
#
#     peaks.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"
here=$root/tests/peaks

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
finds tuned "-DTUNED $([ -n "${LONG:-}" ] || echo -DSTEPS=75)"
if [ -n "${LONG:-}" ]; then
    finds peaks '' --step 0.01
    finds peaks '' --step 0.2
    finds tuned -DTUNED --step 0.16
fi

# by_values WORDS FORCE_ON_X FORCE_ON_Y STIFFNESS OPTION ...: of a model without inputs
by_values() {
    what=$1
    {
        printf 'model m\ncoord x, y\ninit x = 0.02, y'"'"' = -1\n'
        printf "x'' + 0.3*x' + %s*x - 20*y = %s\ny'' + 0.5*y' + 40*y - 20*x = %s\n" "$4" "$2" "$3"
        printf "output px = peak(x), py = peak(y - 0.3*x), pv = peak(x'), pw = peak(y')\n"
        printf "output x, dy = y - 0.3*x, vx = x', vy = y'\nstep 0.05\n"
    } >values.spec
    shift 4
    {
        "$plgen" --prefix m "$@" -o m.c values.spec &&
            $run_cc -I"$root/runtime" -c m.c -o m.o &&
            $run_cc -DPLAIN -DSTEPS=300 -I"$root/runtime" -I. "$here/peaks.c" m.o "$archive" -lm -o m && ./m
    } >log 2>&1
    result $? "$what${*:+, $*}: the largest values between steps"
}

by_values 'loads that change' '(t < 3.02 ? 20*cos(11*t) : 30*sin(17*t))' '(t < 9.013 ? t : 9)' 90
by_values 'moves as a whole' '20*y - 20*x + 2*sin(7*t)' '20*x - 40*y - 20*x + 20*x - 20*(y - x)*0' 0
by_values regions '-300*max(x - 0.01, 0) + 5*cos(9*t)' 0 90
by_values cubic '-9000*x^3 + 5*cos(9*t)' 0 90
by_values cubic '-9000*x^3 + 5*cos(9*t)' 0 90 --scheme radau
by_values cubic '-90*x^3 + 5*cos(9*t)' 0 90 --scheme etd1
# tops that rise by a thousandth, of steps whose ends are below the one before
by_values 'swells slowly' '0.32*x'"'"' - 20*y - x^3' '0.53*y'"'"' - 20*x - 0.1*y^3' 90
by_values kinks '-20*abs(x)*x'"'"' + 5*cos(9*t)' 0 90 --scheme etdrk4
by_values 'stiffness that moves' '5*cos(9*t) - 9*cos(2*t)*x' 0 90 --scheme etdam5

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
refused "$here: the largest |pole| times h is above 8" "x'' + 1e4*x = 0" 'peak(x)'
refused "the peak of 'q' has no closed form" "x'' + x = cos(t)" 'peak(x)' --solution 1
tap_end
