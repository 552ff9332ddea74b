# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=sh disable=SC2154
# Sourced before tap.sh by tests that ask compilers about what plgen emits, most of them only with LONG=1 in the
# environment (`make check-long`); `make check` asks for warnings in tests/warnings.

warnings='-Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Werror'

# languages [OPTIONS [OPTIONS]]: a line each, the compilers of GCCS and CLANGS as C and as C++ with options of each
languages() {
	for pair in "${GCCS:-gcc g++}" "${CLANGS:-clang clang++}"; do
		echo "${pair% *} -std=c99 ${1-}"
		echo "${pair#* } -std=c++17 -x c++ ${2-}"
	done
}

# by_each NAME ARGUMENT ...: with LONG=1 a result for each line of `compilers`, that it says nothing
by_each() {
	long || return 0
	what=$1
	shift
	while read -r compiler options; do
		if ! command -v "$compiler" >/dev/null 2>&1; then
			skip "$what, $compiler" "$compiler is not installed"
			continue
		fi
		# shellcheck disable=SC2086
		"$compiler" $warnings -I"$root/runtime" $options "$@" >log 2>&1
		result $? "$what, $compiler: not a warning"
	done <compilers
}

# list_compilers: a line each, with options, of which by_turns chooses
list_compilers() {
	echo 'gcc -std=c99 -O1 -c -o object.o'
	echo 'g++ -std=c++17 -fsyntax-only -x c++'
	echo 'clang -std=c99 -fsyntax-only'
	echo 'clang++ -std=c++17 -fsyntax-only -x c++'
}

# ahead COMPILER FILE: an option that has C++ take <math.h>, most of its work, from one precompiled copy. Only where
# FILE includes it: no other may see its names.
ahead() {
	case $1 in
		*++*) ;;
		*) return 0 ;;
	esac
	grep -q '^#include <math\.h>' "$2" || return 0
	if [ ! -e "$work/ahead/${1##*/}.h" ]; then
		mkdir -p "$work/ahead"
		echo '#include <math.h>' >"$work/ahead/${1##*/}.h"
		"$1" -std=c++17 -x c++-header "$work/ahead/${1##*/}.h" -o "$work/ahead/${1##*/}.h.gch"
	fi
	echo "-include $work/ahead/${1##*/}.h"
}

# without_code COMPILER: options that warn as long as that takes; gcc says of some things that they are unused only
# when it writes something, of which what a later optimiser reads takes a third of the time of code
without_code() {
	case $1 in
		*clang*) echo '-fsyntax-only' ;;
		*) echo '-O0 -flto -fno-fat-lto-objects -S -o /dev/null' ;;
	esac
}

# by_turns FILE: of its lines, gcc, g++, clang, clang++, one, gcc twice as often as another; with LONG all. Five turns,
# so that none meets always the same in a loop of two, three or four.
turn=0
by_turns() {
	turn=$((turn % 5 + 1))
	if long; then
		cat "$1"
	else
		sed -n "$(echo 1 4 1 3 2 | cut -d ' ' -f $turn)p" "$1"
	fi
}

# third NUMBER WORD ...: every third word, the first of them that with this number from 0; with LONG all
third() {
	from=$1
	shift
	long && from=
	for word; do
		[ -n "$from" ] && [ $((from % 3)) -ne 0 ] || echo "$word"
		[ -z "$from" ] || from=$((from + 2))
	done
}
