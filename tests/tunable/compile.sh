#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What plgen emits for models with tunable params, for double and for float, in the forms delta and direct: the same
# bytes twice; no double in floats; no libm, no allocation, nothing but the runtime called; with LONG=1 it compiles
# without a warning, as C99 and as C++17 (without, ../warnings asks that).  And runtime/host/plmain.c: NAME=VALUE
# arguments, and what is said of bad ones.
#
#     compile.sh PLGEN SOURCE_ROOT MODEL.spec ...
#
# The compilers are those of GCCS and CLANGS (default: gcc g++, clang clang++); what is not installed is skipped.
root=$2
specs=$(shift 2; realpath -s "$@" | tr '\n' ' ')
. "${0%/*}/../compilers.sh"
. "${0%/*}/../plgen.sh"

languages '-ffreestanding -O' -fsyntax-only >compilers

# compiles NAME FILE.c ...: each becomes an object, whose names are looked at; with LONG=1 by each compiler, without a
# warning
compiles() {
	what=$1
	shift
	if ! long; then
		$run_cc -I"$root/runtime" -c "$@" >log 2>&1 && [ ! -s log ]
		result $? "$what: compiles"
		return
	fi
	by_each "$what" -c "$@"
}

# calls_only_the_runtime OF_PARAMS OBJECT ...: what they call beyond their own, and the functions that their specs have
# of params: of the runtime, and memcpy or memset, which a compiler makes of assignments, as tcc makes memmove, and
# calls of its own library of conversions
calls_only_the_runtime() {
	of_params=$1
	shift
	nm -u "$@" >names 2>&1
	awk '!/:$/ { print $NF }' names | grep -v -e '^pl_' -e '^memcpy$' -e '^memset$' -e '^_GLOBAL_OFFSET_TABLE_$' \
		-e '^__stack_chk_fail$' -e '^memmove$' -e '^__floatun[sd]i[sd]f$' -e '^$' -e "$of_params" >log
	[ -s names ] && [ ! -s log ]
}

number=0
for real in double float; do
	for form in delta direct; do
		files=
		said=0
		for spec in $specs; do
			name=$(basename "$spec" .spec)
			"$plgen" --real $real --form $form "$spec" >"${name}_$real$form.c" 2>>said || said=1
			files="$files ${name}_$real$form.c"
		done
		# each of them twice in one of three forms, with LONG=1 in all
		number=$((number + 1))
		# shellcheck disable=SC2046,SC2086
		for spec in $(third $number $specs); do
			name=$(basename "$spec" .spec)
			"$plgen" --real $real --form $form "$spec" 2>>said |
				cmp - "${name}_$real$form.c" >>said 2>&1 || said=1
		done
		cp said log
		[ $said -eq 0 ] && [ ! -s said ]
		result $? "$real, $form: plgen says nothing, and the same twice"
		# shellcheck disable=SC2086
		compiles "$real, $form" $files
		# shellcheck disable=SC2046,SC2086
		calls_only_the_runtime '^$' $(printf '%s\n' $files | sed '/^derived/d; s/c$/o/') &&
			calls_only_the_runtime '^\(atan\|cos\|exp\|pow\|sin\|sqrt\)f\{0,1\}$' derived_$real$form.o
		result $? "$real, $form: calls nothing but the runtime"
		[ $real = double ] && continue
		# shellcheck disable=SC2086
		grep -n -w double $files | grep -v '/\*.*double' >log
		[ ! -s log ]
		result $? "$real, $form: no double in the text"
	done
done

# -o: header and C apart
for spec in $specs; do
	name=$(basename "$spec" .spec)
	"$plgen" -o "$name.c" "$spec" >log 2>&1 &&
		$run_cc -I"$root/runtime" -c "$name.c" -o apart.o >>log 2>&1
	result $? "$name: -o writes C and header"
done

# ---- the driver for hosts ----

# shellcheck disable=SC2086
for real in double float; do
	define=
	suffix=
	[ $real = float ] && define=-DFLOAT suffix=f
	for name in pair held; do
		for other in '' plain; do
			spec=$(echo "$specs" | tr ' ' '\n' | grep "/$name.spec\$")
			if [ -n "$other" ]; then
				there=$(sed -n 's/^#there //p' "$spec")
				grep -v '^tunable' "$spec" >"there_$name.spec"
				"$plgen" --real $real --form delta $there "there_$name.spec" >drive.c 2>log
			else
				"$plgen" --real $real "$spec" >drive.c 2>log
			fi
			$run_cc $define -DMODEL=$name -I"$root/runtime" "$root/runtime/host/plmain.c" drive.c \
				"$archive" -lm \
				-o "run_$name$suffix$other" >>log 2>&1
			result $? "plmain of $name, $real${other:+, with the values as -D}"
		done
	done
done

# as_arguments NAME: the values of `#there` as NAME=VALUE
as_arguments() {
	sed -n 's/^#there //p' "$(echo "$specs" | tr ' ' '\n' | grep "/$1.spec\$")" |
		sed -e 's/-D //g' -e 's/--step /step=/' | tr ' ' '\n' |
		awk -F= '{ n = split($2, part, "/"); printf "%s=%.17g ", $1, n == 2 ? part[1] / part[2] : $2 }'
}

# near FOUND EXPECTED BOUND: CSV of the same shape, each column within BOUND of its largest
near() {
	awk -F, -v bound="$3" 'NR == FNR { for (i = 1; i <= NF; i++) { cell[FNR, i] = $i;
		if (FNR > 1 && $i * $i > most[i] * most[i]) most[i] = $i } rows = FNR; columns = NF; next }
		FNR == 1 { if ($0 == "" || NF != columns) { print "another header"; bad = 1 } next }
		{ for (i = 1; i <= NF; i++) { off = $i - cell[FNR, i]; if (off < 0) off = -off;
			if (!(off <= bound * (most[i] < 0 ? -most[i] : most[i])))
			  { if (shown++ < 5) printf "line %d, column %d: found %s, expected %s\n", FNR, i,
				cell[FNR, i], $i;
				  bad = 1 } } last = FNR }
		END { if (last != rows || rows < 20) { printf "%d lines, expected %d\n", rows, last;
			bad = 1 } exit bad }' "$1" "$2"
}

awk 'BEGIN { print "u,floor"; for (i = 0; i < 400; i++) printf "%.6f,%.6f\n", (i * 37 % 101) / 50 - 1,
	(i * 53 % 89) / 44 - 1 }' >samples.csv
for real in double float; do
	suffix=
	bound=1e-13
	[ $real = float ] && suffix=f bound=1e-4
	for name in pair held; do
		# shellcheck disable=SC2046
		./run_$name$suffix 1 $(as_arguments $name) <samples.csv >found.csv 2>log &&
			./run_$name${suffix}plain 1 <samples.csv >expected.csv 2>>log &&
			near found.csv expected.csv $bound >>log
		result $? "plmain: $name with NAME=VALUE as code made with these values, $real"
	done
done
./run_pair 0.5 >plain.csv 2>log && ./run_pair 0.5 m1=1 step=0.0078125 >given.csv 2>>log &&
	near given.csv plain.csv 1e-13 >>log
result $? 'plmain: the values that it has'

# refused MESSAGE STATUS ARGUMENT ...: the first line of standard error; nothing on standard output
refused() {
	message=$1
	wanted=$2
	shift 2
	./run_pair "$@" >out.csv 2>log </dev/null
	status=$?
	line=$(head -n 1 log)
	good=0
	[ "$line" = "$message" ] && [ $status -eq "$wanted" ] && [ ! -s out.csv ] || good=1
	echo "found $status: $line; expected $wanted: $message" >>log
	result $good "plmain: $*"
}
expected='expected NAME=VALUE, a tunable param or step, and a number, found'
refused "pair: error: $expected 'q=3'" 2 1 q=3
refused "pair: error: $expected 'k1'" 2 1 k1
refused "pair: error: $expected 'k1='" 2 1 k1=
refused "pair: error: $expected 'k1=x'" 2 1 k1=x
refused "pair: error: $expected 'k1=3x'" 2 1 k1=3x
refused "pair: error: $expected 'k=3'" 2 1 k=3
refused "pair: error: $expected '=3'" 2 1 k1=3 =3
refused "pair: error: $expected 'steps=3'" 2 1 steps=3
refused 'pair: error: the step is not above 0' 1 1 step=0
refused 'pair: error: the step is not above 0' 1 1 step=-1
refused 'pair: error: the step is not above 0' 1 1 step=nan
refused 'pair: error: with these values the numbers of the step are not finite' 1 1 step=inf
refused 'pair: error: with these values the numbers of the step are not finite' 1 1 k1=inf
refused 'pair: error: with these values the numbers of the step are not finite' 1 1 k1=nan
refused 'pair: error: with these values the mass matrix has no inverse' 1 1 m1=0
./run_pair >out.csv 2>log
status=$?
[ $status -eq 2 ] && [ ! -s out.csv ] && grep -q '^usage: .* T \[NAME=VALUE \.\.\.\] > out.csv$' log &&
	grep -q '^    k1=100$' log && grep -q '^    step=0.0078125$' log
result $? 'plmain: usage lists the params and the step with their values'
./run_heldplain 1 m=3 <samples.csv >out.csv 2>log
status=$?
[ $status -eq 2 ] && [ ! -s out.csv ] && grep -q "found 'm=3'\$" log
result $? 'plmain: NAME=VALUE where nothing is tunable'

tap_end
