#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The models of linear.cases: what plgen emits needs nothing but the runtime, and runs, with samples on standard input
# too; names that the emitted C might use itself.
#
#     linear.sh specs|names PLGEN LINEAR_INPUTS SOURCE_ROOT
#
# With LONG=1 each file compiles without a warning, as C99 and as C++17 (without, ../warnings asks that).
#
# The compilers are those of GCCS and CLANGS (default: gcc g++, clang clang++); what is not installed is skipped.
part=$1
shift
inputs=$(realpath "$2")
root=$3
. "${0%/*}/../compilers.sh"
. "${0%/*}/../plgen.sh"

languages >compilers

installed() {
	command -v "$1" >/dev/null 2>&1
}

# Nothing, or of a model that grows that it does
says_what_it_is() {
	case $m in
		growing) [ "$(grep -c ': warning: ' log)" -eq 2 ] &&
			[ "$(grep -c ': warning: an unstable pole' log)" -eq 2 ] ;;
		*) [ ! -s log ] ;;
	esac
}

# compiles FILE.c NAME: with LONG=1 as C and as C++, by gcc and by clang, as one result
compiles() {
	long || return 0
	status=0
	: >log
	while read -r compiler options; do
		installed "$compiler" || continue
		# shellcheck disable=SC2046,SC2086
		$compiler $warnings -I"$root/runtime" -fsyntax-only $(ahead "$compiler" "$1") $options "$1" \
			>>log 2>&1 || status=1
	done <compilers
	result $status "$2"
}

# only_runtime OBJECT: does it name anything but pl_*, memcpy, memset, and what tcc has for assignments and conversions?
only_runtime() {
	"$nm" -u "$1" | awk '{ print $NF }' |
		grep -v -E '^(pl_[a-z_]*|mem(cpy|set|move)|__(float|fix)un[a-z]*|_GLOBAL_OFFSET_TABLE_)$' >>log
	[ ! -s log ]
}

# same_columns FOUND.csv EXPECTED.csv
same_columns() {
	awk -F, -f "$root/tests/emitted/columns.awk" "$2" "$1" >>log 2>&1
}

driver() {          # driver FILE NAME PROGRAM [LIBRARIES]: an object, or C, with LONG=1 in the compiler's own dialect
	case $1 in *.c)
		if ! long; then
			$run_cc -I"$root/runtime" "-DMODEL=$2" "$root/runtime/host/plmain.c" "$1" "$archive" ${4-} \
				-o "$3" >>log 2>&1
			return
		fi ;;
	esac
	main_of "$2" >>log 2>&1
	# shellcheck disable=SC2086
	${CC:-cc} -I"$root/runtime" $main "$1" "$archive" ${4-} -o "$3" >>log 2>&1
}

# ---- every spec ----

turn=0
every_spec() {
mkdir specs && awk -v into=specs/ -f "$root/tests/cases.awk" "$root/tests/emitted/linear.cases" >names
for m in $(cat names); do
	spec=specs/$m.spec
	inputs_of=$(sed -n 's/^input //p' "$spec")
	for kind in plain rhs reduce; do
		# without outputs there is nothing to reduce
		[ $kind = reduce ] && ! grep -q '^output' "$spec" && continue
		case $kind in
			plain) options= ;;
			*) options=--$kind ;;
		esac
		mkdir -p "$kind"
		"$plgen" $options "$spec" >"$kind/$m.std.c" 2>log && "$plgen" $options -o "$kind/$m.c" "$spec" 2>>log &&
			says_what_it_is &&
			"$plgen" $options --header "$spec" | cmp - "$kind/$m.h" >>log 2>&1
		status=$?
		result $status "$m, $kind: plgen writes it to standard output and to files, and says nothing"
		[ $status -eq 0 ] || continue
		if [ $kind = rhs ]; then
			compiles "$kind/$m.std.c" "$m, $kind: standard output compiles"
			continue
		fi
		compiles "$kind/$m.c" "$m, $kind: FILE.c with FILE.h compiles"
		printf '#include "%s.h"\n#include "%s.h"\n%s *unused;\n' "$m" "$m" "$m" >"$kind/twice.c"
		[ $kind = reduce ] || compiles "$kind/twice.c" "$m, $kind: the header stands alone, twice"
		status=0
		: >log
		# one of six in turn by a compiler that is told so, the others to be run; with LONG=1 by each
		turn=$((turn + 1))
		told="$warnings -ffreestanding"
		if long; then
			sed 's/$/ -O1/' compilers >some
		elif [ $((turn % 6)) -eq 0 ]; then
			sed '1{s/$/ -O0/;q;}' compilers >some
		else
			told=
			echo "$run_cc" >some
		fi
		while read -r compiler options; do
			installed "$compiler" || continue
			# shellcheck disable=SC2086
			$compiler $told -I"$root/runtime" $options -c "$kind/$m.std.c" -o nm.o >>log 2>&1 &&
				only_runtime nm.o || status=1
		done <some
		result $status "$m, $kind: standard output compiles, freestanding, needs the runtime, memcpy, memset"
		object=nm.o
		! long && [ -n "$told" ] || object=$kind/$m.std.c    # with LONG=1 that is of C++
		if [ -z "$inputs_of" ]; then
			: >log
			[ -s "$m.csv" ] || "$plgen" --solution 10 "$spec" >"$m.csv" 2>>log
			driver "$object" "$m" one && ./one 10 >found.csv 2>>log && same_columns found.csv "$m.csv"
			result $? "$m, $kind: the driver's 10 s agree with --solution of the whole model"
		else
			: >log
			driver "$object" "$m" one && "$inputs" samples 501 >samples.csv &&
				./one 10 <samples.csv >found.csv 2>>log &&
				"$inputs" expected "$m" 500 >expected.csv
			status=$?
			if [ $status -eq 0 ] && [ $kind = plain ]; then
				cmp found.csv expected.csv >>log 2>&1
				status=$?
			elif [ $status -eq 0 ]; then
				same_columns found.csv expected.csv
				status=$?
			fi
			result $status "$m, $kind: the driver reads samples and writes what step gives"
			sed 1d samples.csv | ./one 10 2>>log | cmp - found.csv >>log 2>&1
			result $? "$m, $kind: the same without the line of names"
			head -n 300 samples.csv | ./one 10 >/dev/null 2>log
			[ $? -eq 1 ] && grep -q 'too few samples' log
			result $? "$m, $kind: too few samples are refused"
		fi
	done
done

# What --reduce leaves.
grep -q 'REDUCED_STATES = 2,' reduce/reduced.h && grep -q 'REDUCED_STATES = 4,' plain/reduced.h
result $? "--reduce leaves 2 of the 4 states of equal masses, seen through their sum"
}

# ---- names ----

# right FILE.spec NAME TITLE: it compiles, and what its driver says is what --solution says
right() {
	: >log
	"$plgen" --rhs "$1" >collide.c 2>log
	status=$?
	result $status "$3: plgen takes it"
	[ $status -eq 0 ] || return
	compiles collide.c "$3: compiles"
	: >log
	"$plgen" --solution 1 "$1" >expected.csv 2>>log && driver collide.c "$2" m -lm && ./m 1 >found.csv 2>>log &&
		same_columns found.csv expected.csv
	result $? "$3: runs right"
}

every_name() {
# six at a time as coordinates, and as inputs
while read -r a b c d e f; do
	names="$a $b $c $d $e $f"
	cat >names.spec <<EOF
model any
coord x1, $a, $b, $c, $d, $e, $f
init x1 = 1, $a = 0.5, $b = 0.25, $c' = 1
x1'' + 0.1*x1' + 4*x1 - $a = (t < 0.305 ? 1 : cos(2*t))*exp(-t/5) + t^2
$a'' + 5*$a - x1 = sin(3*t)*t
$b' + $b = $a'
$c'' + 3*$c + $c' = exp(0.1*t)
$d'' + 7*$d - $c = t < 0.6 ? 1 : 2
$e' + 2*$e = $d
$f'' + $f = $e'
output a_ = x1 + (t < 0.305 ? t : 0), b_ = $a'', c_ = $b + $c', d_ = $d + $e, e_ = $f''
step 0.01
EOF
	right names.spec any "coordinates $names"
	cat >names.spec <<EOF
model any
coord x1, zz
init x1 = 1
input $a, $b, $c
input $d hold first, $e hold first, $f hold first
let sum_of = 2*$a
x1'' + 0.1*x1' + 4*x1 - zz = sum_of + $b + $d' + $e + (t < 0.305 ? 1 : cos(2*t))*exp(-t/5)
zz'' + 5*zz - x1 = $a - $c + $f + $e'
output a_ = x1'' + $a, b_ = zz'' + $d
step 0.01
EOF
	"$plgen" --rhs names.spec >collide.c 2>log
	status=$?
	result $status "inputs $names: plgen takes them"
	[ $status -eq 0 ] && compiles collide.c "inputs $names: compiles"
	sed "s/\\b$a\\b/n1/g; s/\\b$b\\b/n2/g; s/\\b$c\\b/n3/g; s/\\b$d\\b/n4/g; s/\\b$e\\b/n5/g; s/\\b$f\\b/n6/g" \
		names.spec >neutral.spec
	"$inputs" samples 303 | sed 1d | paste -d, - - - >samples.csv
	: >log
	"$plgen" neutral.spec >neutral.c 2>>log && driver collide.c any m -lm && driver neutral.c any n &&
		./m 1 <samples.csv >found.csv 2>>log &&
		./n 1 <samples.csv >expected.csv 2>>log && cmp found.csv expected.csv >>log 2>&1
	result $? "inputs $names: runs as with other names"
done <<'EOF'
load0 load1 load2 load3 load4 growth
growth_step growth_rate factor segment change x1_dot
direct done series A y t0
k u pass plain_step use_segment phase
pl_envelope load_slope load_factor s tau out
n i j h z dydt
Gamma slope hold_u before load residual
EOF

for name in s u t0; do
	printf "model any\ncoord x\ninput %s, w hold first\nx'' + 4*x = %s + w\noutput x, b = x'' + %s\nstep 0.01\n" \
		$name $name $name >names.spec
	"$plgen" --rhs names.spec >collide.c 2>log
	result $? "input $name: plgen takes it"
	compiles collide.c "input $name: compiles"
done

cat >names.spec <<'EOF'
model any
matrix M = [2, 0.5; 0.5, 1], K = [30, -10; -10, 20]
coord q[2], q1, q_1, q2, q1_dot
init q[1] = 1, q1 = 0.5
M*q'' + K*q = [1; 0]*cos(2*t)
q1'' + 9*q1 = q[1]
q_1'' + 8*q_1 = q[2]'
q2'' + 7*q2 = q1
q1_dot' + q1_dot = q1'
step 0.01
EOF
right names.spec any 'a vector q beside q1, q_1, q2 and q1_dot'

cat >names.spec <<'EOF'
model mixed
coord a, b, c
init a = 0.2, c' = 1
mass 2 at a
mass 1.5 at b
spring 40 between a, b
spring 25 between a, ground
c'' + 0.2*c' + 30*c - 30*b = 0
step 0.01
EOF
"$plgen" names.spec >mixed.c 2>log
result $? 'a sketch beside an equation that names a sketched coordinate'
}

case $part in
	specs) every_spec ;;
	names) every_name ;;
	*) exit 99 ;;
esac

tap_end
