#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What plgen emits in every form, for double and for float: float code names no double and does nothing with one; with
# LONG=1 it compiles without a warning, as C99 and as C++17 (without, ../warnings asks that).
#
#     compile.sh PLGEN SOURCE_ROOT VARIANTS_double.c VARIANTS_float.c
#
# The last two are what variants.sh makes, beside their headers: every linear model in every form.  The compilers are
# those of GCCS and CLANGS (default: gcc g++, clang clang++); what is not installed is skipped.
set -u
plgen=$(realpath "$1")
root=$2
double=$(realpath "$3")
float=$(realpath "$4")
remainder='pendulum duffing vanderpol beam4'
switching='gear1 two_masses quarter_car_bumps'
. "${0%/*}/../compilers.sh"
. "${0%/*}/../tap.sh"

languages -O1 -fsyntax-only >compilers

# compiles FILE.c NAME [OPTIONS]
compiles() {
	# shellcheck disable=SC2086
	by_each "$2" -I"$root/tests/forms" -I"${1%/*}" ${3-} -c "$1" -o out.o
}

without_comments() {
	awk '{ line = $0
		   for (;;) {
			   if (inside) { if (!(i = index(line, "*/"))) next; line = substr(line, i + 2); inside = 0 }
			   if (!(i = index(line, "/*"))) break
			   printf "%s", substr(line, 1, i - 1); line = substr(line, i + 2); inside = 1
		   }
		   print line }' "$1"
}

# no_double FILE.c NAME: no word double, no literal or function of that type
no_double() {
	without_comments "$1" | sed 's/"[^"]*"//g' >text
	{
		grep -n -w double text
		grep -n -E '(^|[^A-Za-z0-9_.])([0-9]+\.[0-9]*|\.[0-9]+)(e[-+]?[0-9]+)?([^0-9.ef]|$)' text
		grep -n -E '(^|[^A-Za-z0-9_.])[0-9]+e[-+]?[0-9]+([^0-9f]|$)' text
		functions='sin|cos|tan|exp|log|sqrt|fabs|sinh|cosh|tanh|asin|acos|atan|atan2|pow|fmin|fmax|copysign'
		grep -n -E "(^|[^A-Za-z0-9_])($functions) *\\(" text
	} >log
	[ ! -s log ]
	result $? "$2: no double in the text"
}

# no_double_instruction FILE.c NAME [OPTIONS]
no_double_instruction() {
	for compiler in "${GCCS:-gcc}" "${CLANGS:-clang}"; do
		compiler=${compiler% *}
		merging || [ "$compiler" = "${GCCS:-gcc}" ] || continue
		if ! command -v "$compiler" >/dev/null 2>&1 || ! command -v objdump >/dev/null 2>&1 ||
			[ "$(uname -m)" != x86_64 ]; then
			skip "$2, $compiler" 'no such compiler, no objdump, or another processor'
			continue
		fi
		long && level=-O2 || level=-O0          # without an optimiser no conversion goes unseen
		if [ "${1%/*}" = "$root/runtime" ] && [ "$compiler" = "${GCCS:-gcc}" ] && [ -n "${PLRT-}" ]; then
			ar p "$PLRT" "runtime_${1##*/}.o" >out.o 2>log  # as the build folder has it
		else
			# shellcheck disable=SC2086
			"$compiler" -std=c99 $level $warnings -I"$root/runtime" -I"$root/tests/forms" \
				-I"${1%/*}" ${3-} -c "$1" -o out.o >log 2>&1
		fi
		status=$?
		# an address before or behind it may read fadd
		[ $status -eq 0 ] && objdump -d out.o | sed 's/#.*//' | cut -f 3- >code
		sse='(add|sub|mul|div|sqrt|min|max|u?comi|round|cmp[a-z]*)[sp]d|cvt[a-z0-9]*[sp]d[a-z0-9]*'
		x87='f(ld|st|add|sub|mul|div|ild)[a-z]*'
		grep -E "^v?($sse|$x87)([[:space:]]|$)" code >>log
		grep -q -E '^v?([a-z]*[sp]s|movd)[[:space:]]' code || echo 'nothing of float either' >>log
		[ $status -eq 0 ] && [ ! -s log ]
		result $? "$2: no instruction of double, $compiler"
	done
}

# ---- linear models in every form ----

compiles "$double" 'linear models in double'
compiles "$float" 'linear models in float' -DREAL_FLOAT
no_double "$float" 'linear models in float'
no_double "${float%.c}.h" 'their declarations'
no_double_instruction "$float" 'linear models in float' -DREAL_FLOAT

# ---- what is complete in itself ----

for m in $remainder $switching; do
	"$plgen" --real float --rhs "$root/models/$m.spec" >"$m.c" 2>log
	result $? "$m: plgen takes it for float"
	compiles "$work/$m.c" "$m in float"
	no_double "$m.c" "$m in float"
	no_double_instruction "$work/$m.c" "$m in float"
	# shellcheck disable=SC2086
	"$plgen" --real float --rhs -o "apart_$m.c" "$root/models/$m.spec" >log 2>&1 &&
		"$plgen" --real float --rhs --header "$root/models/$m.spec" >"header.h" 2>>log &&
		cmp "apart_$m.h" header.h >>log 2>&1 && grep -q "^#include \"apart_$m.h\"\$" "apart_$m.c" &&
		${CC:-cc} -std=c99 $warnings -I"$root/runtime" -I. -fsyntax-only "apart_$m.c" >>log 2>&1
	result $? "$m in float: -o writes C and header, --header the same header"
done
for m in scs quarter_car; do
	for accuracy in '' '--accuracy compensated'; do
		# shellcheck disable=SC2086
		"$plgen" --real float $accuracy --rhs "$root/models/$m.spec" >"$m.c" 2>log
		compiles "$work/$m.c" "$m in float, standard output ${accuracy#* }" -ffreestanding
		no_double "$m.c" "$m in float, standard output ${accuracy#* }"
	done
done

# ---- the runtime for float ----

for f in "$root"/runtime/*f.c; do
	case ${f##*/} in
		phasesf.c | seriesf.c | powerf.c | untilf.c | envelopef.c | applyf.c | crossingsf.c | \
		rootf.c | densef.c)
			no_double_instruction "$f" "runtime ${f##*/}" ;;
	esac
done

# ---- --explain=json ----

# explained SPEC FORM ACCURACY REAL OPTION ...
explained() {
	spec=$1
	wanted="\"form\": \"$2\",\"accuracy\": \"$3\",\"real\": \"$4\","
	shift 4
	"$plgen" --explain=json "$@" "$root/models/$spec.spec" 2>log |
		sed -n 's/^  \("\(form\|accuracy\|real\)": .*\)/\1/p' | tr -d '\n' >found
	[ "$(cat found)" = "$wanted" ]
	status=$?
	echo "found $(cat found), expected $wanted" >log
	result $status "--explain=json of $spec $*: $wanted"
}
explained scs kick-drift-kick plain double
explained scs kick-drift-kick plain float --real float
explained scs kick-drift-kick compensated double --accuracy compensated
explained scs kick-drift-kick compensated float --accuracy compensated --real float
explained scs delta plain double --form delta
explained scs delta compensated double --form delta --accuracy compensated
explained scs direct plain float --form direct --real float
explained scs direct plain double --form auto --step 1                   # |p| h = 17
explained scs kick-drift-kick plain double --step 0.1443                 # 2.4994
explained scs direct plain double --step 0.1444                          # 2.5011
explained scs delta compensated double --step 0.1444 --accuracy compensated
explained sdcs delta plain double
explained sdcs delta plain double --step 0.0577                          # 0.9994
explained sdcs direct plain double --step 0.0578                         # 1.0011
explained sdcs delta compensated float --accuracy compensated --real float
explained sdcsf delta plain double
explained linear2dof delta plain double                                  # undamped, unequal masses, a load
explained scs direct plain double --scheme pl
explained scs delta plain double --scheme pl --form delta
explained duffing direct plain float --real float
explained gear1 direct plain float --real float

tap_end
