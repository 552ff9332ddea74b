#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# NAME_batch of some models against NAME_step of each instance alone (batch.c): the same bits. And what --batch refuses.
#
#     batch.sh PLGEN SOURCE_ROOT
#
# LONG=1: of more models, as vectors of what this machine has too, and by clang; there products may be contracted.
set -u
plgen=$1
root=$2
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
case $root in /*) ;; *) root=$PWD/$root ;; esac
here=$root/tests/batch
. "$root/tests/tap.sh"
runtime_archive "$root/runtime"
warnings='-Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wdouble-promotion -Werror'

# agrees UNITS COMPILER FLAGS SPEC OPTION ...: of one model, built so
agrees() {
    units=$1
    compiler=$2
    flags=$3
    spec=$4
    shift 4
    chosen "$spec $* $compiler $flags" || return 0
    what="-DHAS_INPUTS=1"
    {
        "$plgen" --batch --prefix m "$@" -o m.c "$root/$spec" &&
            { ! grep -q 'M_INPUTS = 0' m.h || what=-DHAS_INPUTS=0; } &&
            { ! grep -q M_BATCH_FACTORS m.h || what="$what -DTUNED"; } &&
            { ! grep -q '^#define PL_FLOAT_ONLY' m.h || what="$what -DREAL_FLOAT"; } &&
            $compiler -std=c99 $flags $warnings -I"$root/runtime" -c m.c -o m.o &&
            $compiler -std=c99 $flags $what -I"$root/runtime" -I. "$here/batch.c" m.o "$archive" -lm -o m &&
            ./m "$units"
    } >log 2>&1
    result $? "$spec${*:+ $*}, $compiler $flags"
}

# refuses SPEC TEXT: with a message that has this
refuses() {
    "$plgen" --batch "$root/$1" >out 2>log
    status=$?
    [ $status -eq 1 ] && [ ! -s out ] && grep -q "batch cannot step many instances of this model: $2" log
    result $? "$1 is refused: $2"
}

while read -r spec options; do
    [ -n "$spec" ] || continue
    case $spec in
        # Extremes are found from the same numbers, A of the spec's in one of them, with another peak to pass.
        *peaks* | */free.spec | */loaded.spec | */record.spec) bits=300 ;;
        *) bits=0 ;;
    esac
    # shellcheck disable=SC2086
    agrees $bits "${CC:-cc}" -O0 "$spec" $options
    [ -n "${LONG:-}" ] || continue
    for compiler in "${CC:-cc}" clang; do
        # shellcheck disable=SC2086
        agrees 300 "$compiler" '-O2 -march=native' "$spec" $options
        # shellcheck disable=SC2086
        agrees $bits "$compiler" '-O2 -ffp-contract=off' "$spec" $options
    done
done <<END
models/oscillator.spec
models/sdcsf.spec --form delta --accuracy compensated --real float
tests/forms/masses.spec
tests/batch/forced.spec --anchors 1
tests/peaks/tuned.spec
tests/batch/free.spec
tests/batch/loaded.spec --anchors 1
tests/batch/record.spec
${LONG:+tests/relative/drive.spec
models/oscillator.spec --real float
models/sdcsf.spec --form delta --accuracy compensated --anchors 1
tests/tunable/sensor.spec
tests/tunable/pair.spec --form direct
tests/tunable/cart.spec --real float
tests/forms/damped_ramped.spec
tests/relative/train.spec
models/quarter_car.spec --real float
models/scs.spec --accuracy compensated
models/tuned_floor.spec --anchors 1
tests/peaks/peaks.spec
tests/holds/tuned.spec}
END

refuses models/two_masses.spec 'where an instance crosses a breakpoint is a matter of its own'
refuses models/pendulum.spec 'what is left over is not linear in the state'
refuses tests/tunable/changes.spec 'its loads change their formula inside a step'
refuses tests/tunable/sweep.spec 'each instance would have loads of its own frequency'
refuses tests/relative/row.spec 'beyond 16 states a step loops over its tables'
refuses tests/forms/carried.spec 'its states are kept as differences: declare outputs'
sed 's/0.2\*u)/0.2*held)/' "$root/tests/peaks/peaks.spec" >"$work/jumps.spec"
root=$work refuses jumps.spec 'output pa is the peak of what jumps with the samples'
tap_end
