#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# beam_matrices as a command: what it refuses, and that it never leaves half a file.
#
#     command.sh BEAM_MATRICES
set -u
program=$(realpath "$1")
. "${0%/*}/../tap.sh"

# refuses STATUS WORD OPTIONS...: with this status, a message that has the word, and no file
refuses() {
    status=$1
    word=$2
    shift 2
    "$program" "$@" >log 2>&1
    found=$?
    [ $found -eq "$status" ] && grep -q -e "$word" log && [ -z "$(find . -name '*.mtx')" ]
    result $? "status $status and '$word': $*"
}

refuses 2 'whole number' -n 0
refuses 2 'whole number' -n 5x
refuses 2 'whole number' -n 99999999999999999999
refuses 2 'positive number' -L -1
refuses 2 'positive number' -S nan
refuses 2 'positive number' -I inf
refuses 2 'positive number' -r ''
refuses 2 'positive number' -E 1e999
refuses 2 'missing after -n' -n
refuses 2 'unknown option -q' -q 1
refuses 2 'unknown option -nn' -nn 1
refuses 2 'there is also b' a b
refuses 1 'range of double in M' -L 1e300
refuses 1 'range of double in K' -E 1e-200 -I 1e-200
refuses 1 'cannot write' nowhere/

# A full disk is seen.
if [ -w /dev/full ]; then
    ln -s /dev/full fullM.mtx
    "$program" full >log 2>&1
    [ $? -eq 1 ] && grep -q 'cannot write' log
    result $? 'a full disk'
    rm -f full*.mtx
fi

"$program" -n 1 one_ >log 2>&1 && [ "$(find . -name 'one_*.mtx' | wc -l)" -eq 6 ] && [ ! -s log ]
result $? 'one element: six files, nothing said'

tap_end
