#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The runtime for models in float uses no double: no instruction for one in what compilers make of it for x86-64.
#
#     no_double.sh RUNTIME COMPILER ...
#
# A compiler that is not installed, or is for another machine, is skipped.
set -u
runtime=$(realpath "$1")
shift
. "${0%/*}/../tap.sh"

arithmetic='(add|sub|mul|div|max|min|sqrt|u?comi|and|andn|xor|f?n?m(add|sub)[0-9]*|cmp[a-z]*)'
conversion='cvt[a-z0-9]*[sp]d[a-z0-9]*'
stack='f(ld|ild|st|stp|add|mul|div|sub)[a-z]*'

# doubles COMPILER LEVEL PIECE: are there instructions for doubles in runtime/PIECE.c?  They are in log.
doubles() {
    "$1" -std=c99 "$2" -c "$runtime/$3.c" -o piece.o 2>log || return 0
    objdump -d piece.o | grep -w -E "v?($arithmetic[sp]d|$conversion)|$stack" >log
}

for compiler; do
    case $(command -v "$compiler" >/dev/null 2>&1 && command -v objdump >/dev/null 2>&1 && "$compiler" -dumpmachine) in
        x86_64*) ;;
        *)
            skip "$compiler" 'not installed, or not for x86-64'
            continue
            ;;
    esac
    # -O2 by each, of the others one; with LONG=1 all
    levels='-O0 -O2'
    case $compiler in *clang*) levels='-O2 -Os' ;; esac
    [ -z "${LONG:-}" ] || levels='-O0 -O2 -Os'
    for level in $levels; do
        for piece in phases envelope series power until apply crossings retune rate root dense; do
            ! doubles "$compiler" "$level" "${piece}f"
            result $? "${piece}f.c, $compiler $level"
        done
    done
    doubles "$compiler" -O2 series
    result $? "series.c, $compiler: those of doubles are found"
done
tap_end
