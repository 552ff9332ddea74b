#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Flags under which the arithmetic is not what it is written to be are refused by name, when code or runtime is
# compiled; where they do no harm they are not.
#
#     flags.sh PLGEN SOURCE_ROOT
#
# The compilers are gcc, g++, clang, clang++ and arm-none-eabi-gcc; what is not installed is skipped.  gcc sees every
# file, each other compiler every second by turns, with LONG=1 in the environment all.
set -u
plgen=$(realpath "$1")
root=$2
. "${0%/*}/../tap.sh"

"$plgen" "$root/models/sdcsf.spec" >double.c || exit 99
"$plgen" --real float "$root/models/sdcsf.spec" >float.c || exit 99
"$plgen" --form direct "$root/models/scs.spec" >direct.c || exit 99
"$plgen" --accuracy compensated "$root/models/scs.spec" >compensated.c || exit 99
"$plgen" --accuracy compensated --real float "$root/models/scs.spec" >compensatedf.c || exit 99
"$plgen" "$root/models/pendulum.spec" >remainder.c || exit 99
cp "$root"/runtime/*.c .
# All go through plrt.h; these stand for the others.
doubles='double.c phases.c until.c'
floats='float.c phasesf.c untilf.c'
two_words=until.c
two_wordsf=untilf.c
for file in *.c; do
	${CC:-cc} -std=c99 -I"$root/runtime" -MM "$file" 2>log | grep -q 'plrt\.h'
	result $? "$file goes through plrt.h"
done
grep -l 'include "two\.h"' "$root"/runtime/*.c | sed 's,.*/,,' | tr '\n' ' ' >log
[ "$(cat log)" = 'event_split.c functions.c power.c rate.c region.c retune.c until.c ' ]
result $? 'event_split.c, functions.c, power.c, rate.c, region.c, retune.c and until.c go through two.h'

# compile COMPILER FLAGS FILE ...: C++ as such; by clang, which refuses some flags only then, with code
compile() {
	case $1 in
		*++) language='-x c++ -std=c++17' ;;
		*) language=-std=c99 ;;
	esac
	case $1 in
		clang*) code=-c ;;
		*) code=-fsyntax-only ;;
	esac
	with=$1
	flags=$2
	shift 2
	# shellcheck disable=SC2086
	"$with" $language -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wno-ignored-optimization-argument $flags \
		-I"$root/runtime" $code "$@"
}

# chosen_files COMPILER FILES: sets `files` to those that it is to see
parity=0
chosen_files() {
	files=$2
	[ -z "${LONG:-}" ] && [ "$1" != gcc ] || return 0
	parity=$((1 - parity))
	place=$parity
	files=
	for file in $2; do
		place=$((1 - place))
		[ $place -eq 1 ] && [ "$2" != "$file" ] || files="$files $file"
	done
	files=${files# }
}

# refused COMPILER FLAGS WORDS FILES: none of the files compiles, and each is told why
refused() {
	if ! command -v "$1" >/dev/null 2>&1; then
		skip "$1 $2: refused" "$1 is not installed"
		return
	fi
	: >log
	chosen_files "$1" "$4"
	for file in $files; do
		if compile "$1" "$2" "$file" >said 2>&1; then
			echo "$file compiled" >>log
		elif ! grep -q -e "error.*$3" said; then
			echo "$file: no error that says $3:" >>log
			cat said >>log
		fi
	done
	[ ! -s log ]
	result $? "$1 $2: refused, with its name: $files"
}

# accepted COMPILER FLAGS FILES: all of them compile without a warning
accepted() {
	if ! command -v "$1" >/dev/null 2>&1; then
		skip "$1 $2: accepted" "$1 is not installed"
		return
	fi
	: >log
	chosen_files "$1" "$3"
	# shellcheck disable=SC2086
	compile "$1" "$2 -Werror" $files >>log 2>&1 || echo "they do not compile" >>log
	[ ! -s log ]
	result $? "$1 $2: accepted: $files"
}

for compiler in gcc g++ clang clang++ arm-none-eabi-gcc; do
	all="$doubles $floats"
	for flag in -ffast-math -Ofast; do
		refused $compiler "$flag" '-ffast-math' "$all direct.c"
	done
	refused $compiler '-O1 -funsafe-math-optimizations' '-funsafe-math-optimizations' "$all"
	refused $compiler '-O2 -fassociative-math -fno-signed-zeros -fno-trapping-math' '-fassociative-math' "$all"
	refused $compiler '-O2 -ffinite-math-only' '-ffinite-math-only' "$two_words $two_wordsf"
	for level in -O0 -Os '-O3 -ffp-contract=fast -fno-signed-zeros -fno-trapping-math -fno-math-errno'; do
		accepted $compiler "$level" "$all compensated.c"
	done
	accepted $compiler '-O2 -ffinite-math-only' 'double.c phasesf.c'
	refused $compiler -D_M_FP_FAST '/fp:fast' double.c
done
accepted gcc '-std=c11 -O2' "double.c float.c"

# What only gcc has; clang passes over it and leaves constants as they are
for compiler in gcc g++ arm-none-eabi-gcc; do
	refused $compiler '-O2 -freciprocal-math' '-freciprocal-math' "$doubles $floats"
	refused $compiler '-O2 -fsingle-precision-constant' 'fsingle.precision.constant' "$doubles remainder.c"
	accepted $compiler '-O2 -fsingle-precision-constant' "$floats compensatedf.c"
done
for compiler in clang clang++; do
	accepted $compiler '-O2 -fsingle-precision-constant' "$doubles $floats"
done
# gcc before 12 has no macro for -fassociative-math.
unseen='-U__ASSOCIATIVE_MATH__ -U__RECIPROCAL_MATH__'
for compiler in gcc g++; do
	refused $compiler \
		"-O2 -funsafe-math-optimizations $unseen -U__GNUC__ -D__GNUC__=11" \
		'funsafe.math.optimizations' \
		"$doubles $floats"
	accepted $compiler '-O2 -U__GNUC__ -D__GNUC__=11' "$doubles $floats"
done
# A compiler that has no static assertion: the name of an array says it.
refused gcc '-O2 -U__GNUC__ -fsingle-precision-constant' \
	'pl_refuses_fsingle_precision_constant_and_doubles_of_32_bits' "$doubles"
accepted gcc '-O2 -U__GNUC__' "$doubles $floats"

# A double of 32 bits: of models in float nothing is double.
${CC:-cc} -std=c11 -E -P -I"$root/runtime" double.c 2>log |
	sed 's/\<double\>/float/g; s/sizeof(1\.0)/sizeof(1.0f)/' >narrow.c
${CC:-cc} -std=c11 -w -c narrow.c -o out.o >said 2>&1
[ $? -ne 0 ] && grep -q 'error.*32 bits' said
status=$?
cat said >>log
result $status 'a double of 32 bits: refused'

# x87 keeps more bits than a double has.
for compiler in gcc clang; do
	x87='-O2 -m32 -mfpmath=387 -ffreestanding'
	sse='-O2 -m32 -msse2 -mfpmath=sse -ffreestanding'
	if ! command -v $compiler >/dev/null 2>&1 || ! compile $compiler "$x87" double.c >log 2>&1; then
		skip "$compiler $x87" 'it does not compile for x87'
		continue
	fi
	refused $compiler "$x87" 'bits of their type' "compensated.c compensatedf.c $two_words $two_wordsf"
	accepted $compiler "$x87" 'double.c float.c phases.c'
	accepted $compiler "$sse" "$doubles $floats compensated.c compensatedf.c"
done

tap_end
