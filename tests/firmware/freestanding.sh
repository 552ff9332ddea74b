#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What plgen emits, and the runtime, as a firmware project builds them: without a warning; calling nothing but the
# runtime, libgcc, memcpy and memset (and <math.h> where the model itself has such a function); no variable that
# outlives a call, no array of variable length, no recursion, a stack that is known when it is compiled; in float no
# double.
#
#     freestanding.sh BOARD SOURCE_ROOT MODELS_double.c MODELS_float.c ...
#
# LONG=1 in the environment: optimised as firmware is built, and all of the runtime for each board; without it for M4F
# only what is of float.
set -u
name=$1
root=$2
shift 2
firmware=$root/tests/firmware
. "$firmware/boards.sh"
if ! command -v $arm-gcc >/dev/null 2>&1; then
	echo "1..0 # SKIP no $arm-gcc"
	exit 0
fi
board "$name"
optimize_less
from=$PWD
. "${0%/*}/../tap.sh"

# shellcheck disable=SC2086
library() {         # library FILE: what it defines
	$arm-nm --defined-only "$($arm-gcc $cpu -print-file-name="$1")" 2>/dev/null | awk 'NF == 3 && $2 ~ /[TWR]/ {
		print $3 }'
}
{ library libgcc.a; echo memcpy; echo memset; } >"$work/allowed"
{ library libm.a; cat "$work/allowed"; } >"$work/allowed_math"

export CCACHE_DISABLE=1         # it does not keep .ci
warnings='-Wall -Wextra -Wpedantic -Wconversion -Wvla -Werror'
# builds SOURCE NAME REAL
builds() {
	promotion=
	[ "$3" = double ] || promotion='-Wdouble-promotion -DREAL_FLOAT'
	# shellcheck disable=SC2086
	(cd "$work" &&
        $arm-gcc $optimize -ffreestanding -nostdlib $warnings $promotion $cpu -fstack-usage -fcallgraph-info=su \
		-I"$root/runtime" -I"$firmware" \
		-c "$1" -o "$2.o") >"$work/log" 2>&1
	result $? "$name: $2 builds without a warning"
    # The calls as written, which are the same for every board: optimization makes loops of some that are recursive.
	# Those of float are those of double, but for the runtime, whose text is another: of models with LONG=1.
	# shellcheck disable=SC2086
	[ "$name" != m0 ] ||
		{ [ -z "${LONG:-}" ] && [ "$3" = float ] && [ "${1%/*}" != "$root/runtime" ]; } || (cd "$work" &&
        $arm-gcc -std=c99 -O0 -w $cpu ${promotion#* } -fcallgraph-info -I"$root/runtime" -I"$firmware" -S "$1" \
		-o "$2.written.s")
	[ -f "$work/$2.o" ] || return
	list=$work/allowed
	! grep -q '^#include <math.h>' "$1" || list=${list}_math
	$arm-nm "$work/$2.o" >"$work/symbols"
	$arm-objdump -h -d "$work/$2.o" >"$work/code"
	{
		awk 'FILENAME == ARGV[1] { allowed[$1]; next }
			 $1 == "U" && $2 !~ /^pl_/ && !($2 in allowed) { print "calls " $2 }
			 $(NF - 1) ~ /^[CcDdBbGgSs]$/ { print "variable " $NF }' "$list" "$work/symbols"
        awk '$2 ~ /^\.(data|bss|tdata|tbss)/ && $3 !~ /^0+$/ { print "variables in " $2 ", bytes: 0x" $3 }' "$work/code"
		grep -v -P '\tstatic$' "$work/$2.su"
		case $2 in
            # these call the model, which makes its series anew, or says its forces: of that the stack is its own; or
			# they ask for a region's matrix, where a model keeps some, so that others need no region.c
			events | eventsf | cut | cutf | crossings* | guards*) ;;
			*) grep -o 'sourcename: "[^"]*" targetname: "__indirect_call"' "$work/$2.ci" ;;
		esac
		if [ "$3" = float ]; then
			grep -E ' U __aeabi_(c?d|[a-z]*2d)' "$work/symbols"
			grep -F .f64 "$work/code"
		fi
	} >"$work/log"
	[ ! -s "$work/log" ]
    result $? "$name: $2: calls what it may, keeps no variables, stack known$([ "$3" = double ] || echo ', no double')"
}

for f in "$root"/runtime/*.c; do
	f=${f##*/}
	f=${f%.c}
	case $f in *f) [ -f "$root/runtime/${f%f}.c" ] && real=float || real=double ;; *) real=double ;; esac
	[ -z "${LONG:-}" ] && [ "$name" != m0 ] && [ $real = double ] || builds "$root/runtime/$f.c" "$f" $real
done
for source; do
	case $source in /*) ;; *) source=$from/$source ;; esac
	model=${source##*/}
	model=${model%.c}
	builds "$source" "$model" "${model##*_}"
done

# The calls of all objects together are a graph without a cycle: tsort names one where it is, except a function that
# calls itself.
cat "$work"/*.ci | sed -n 's/^edge: { sourcename: "\([^"]*\)" targetname: "\([^"]*\)".*/\1 \2/p' |
	sort -u >"$work/calls"
tsort "$work/calls" 2>"$work/log" >/dev/null
awk '$1 == $2 { print "recursive: " $1 }' "$work/calls" >>"$work/log"
[ ! -s "$work/log" ] && [ -s "$work/calls" ]
result $? "$name: $(wc -l <"$work/calls") calls, none of them recursive"

tap_end
