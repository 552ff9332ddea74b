#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# rows.sh PLGEN SOURCE_ROOT: NAME_run in blocks of rows against NAME_step, for every number of steps from none to three
# blocks and one: models and forms of the step in double and float, as two programs.
root=$2
. "${0%/*}/../plgen.sh"

# Loads far above the poles, whose forced part the state is kept without; and over differences
cat >forced.spec <<'EOF'
model forced
coord x, y
init x = 1e-3
x'' + 0.1*x' + 30*x - 10*y = 30*t^2*cos(900*t) + exp(-t)
y'' + 0.1*y' + 30*y - 10*x = -40*cos(960*t)
output x, y, a = x''
step 0.01
EOF
cat >loose.spec <<'EOF'
model loose
coord x0, x1, x2
init x1 = 0.1, x2 = -0.2, x0' = 1
2*x0'' + 120*(x0 - x1) = 0
0.5*x1'' + 120*(x1 - x0) + 10*(x1 - x2) = 30*t^2*cos(900*t)
x2'' + 10*(x2 - x1) = -40*cos(960*t)
output o = x2 - x1, p = x2, v = x1'
step 0.01
EOF
# What may move as a whole: kept as a difference and a centre
cat >rigid.spec <<'EOF'
model rigid
coord a, b
input u
init a = 1000, a' = 3
2*a'' + 5*(a' - b') + 70*(a - b) = u
3*b'' + 5*(b' - a') + 70*(b - a) = 0
output stretch = a - b, v = b', a
step 0.02
EOF
# Nothing but what adds up, and an output that is in the place of its input
cat >sum.spec <<'EOF'
model sum
coord x, v
input u hold first
x' = v
v' = u
output y = x + 0.25*u + 0.5*u'
step 0.125
EOF

: >list
# NAME ROWS SPEC OPTIONS: ROWS: what the table should have; 0: none
while read -r name rows spec options; do
	case $spec in
		models/*) file=$root/$spec ;;
		linear/*) file=$(path_of "tests/emitted/$spec") ;;
		forms/*) file=$(path_of "tests/$spec") ;;
        *) file=$spec ;;
	esac
	# shellcheck disable=SC2086
	"$plgen" --fast $options --prefix "$name" "$file" >"$name.c" 2>log || { result 1 "$name is written"; continue; }
	type=double
	case $options in *float*) type=float ;; esac
	echo "$name $rows $type" >>list
	found=$(sed -n 's/^enum { [A-Z0-9_]*_ROWS = \([0-9]*\) }.*/\1/p' "$name.c")
	echo "found ${found:-0} rows, expected $rows" >log
	[ "${found:-0}" = "$rows" ]
	result $? "$name: $rows rows in a block"
done <<'EOF'
sdcs 32 models/sdcs.spec
sdcs_direct 32 models/sdcs.spec --form direct
sdcs_two 32 models/sdcs.spec --accuracy compensated
scs 12 models/scs.spec
scs_two 12 models/scs.spec --accuracy compensated
scs_delta 20 models/scs.spec --form delta --rows 20
masses 4 forms/masses.spec --rows 4
sdcsf 64 models/sdcsf.spec
sdcsf_two 7 models/sdcsf.spec --accuracy compensated --rows 7
tuned_floor 8 models/tuned_floor.spec --rows 8
forced 16 forced.spec --rows 16
loose 8 loose.spec --rows 8
forced_two 8 forced.spec --accuracy compensated --rows 8
growing 16 linear/growing.spec --rows 16
product 8 linear/product.spec --rows 8
ramps 8 linear/ramps.spec --rows 8
resonance 8 linear/resonance.spec --rows 8
maxwell 9 linear/maxwell.spec --rows 9
vector3 8 linear/vector3.spec --rows 8
reduced 8 linear/reduced.spec --reduce --rows 8
held2 5 linear/held2.spec --rows 5
ramped2 6 linear/ramped2.spec --rows 6
ramped2_two 8 linear/ramped2.spec --accuracy compensated --rows 8
first2 8 linear/first2.spec --rows 8
rigid 8 rigid.spec --rows 8
sum 4 sum.spec
changing 0 linear/switched.spec
by_steps 0 models/sdcs.spec --rows 1
f_sdcs 0 models/sdcs.spec --real float
f_sdcsf 16 models/sdcsf.spec --real float --rows 16
f_scs 8 models/scs.spec --real float --rows 8
f_ramps 8 linear/ramps.spec --real float --rows 8
f_first2 8 linear/first2.spec --real float --rows 8
EOF

for type in double float; do
	# All in one file: a compiler that starts once
	awk -v type=$type '$3 == type { print $1 ".c" }' list | xargs cat >"$type.c"
	awk -v type=$type '$3 == type { print "X(" $1 ", " $2 ")" }' list >"models_$type.h"
	[ $type = double ] && real= || real=-DREAL_FLOAT
	# shellcheck disable=SC2086
	$run_cc $real "-DMODELS=\"models_$type.h\"" "-DCODE=\"$type.c\"" -I. -I"$root/runtime" \
		"$root/tests/emitted/rows.c" "$archive" -lm -o "rows_$type" >log 2>&1
	result $? "$type: compiles"
	: >log
	./"rows_$type" >found 2>&1
	status=$?
	while IFS= read -r line; do
		case $line in
			'ok '*) : >log; result 0 "${line#ok }" ;;
			'not ok '*) result 1 "${line#not ok }"; : >log ;;
            *) echo "$line" >>log ;;
		esac
	done <found
	grep -q '^ok all' found && [ $status -eq 0 ]
	result $? "$type: the program came to its end"
done
# Without options none of these tables: the small form; what needs least operations, and batches, keep the phasors.
: >log
"$plgen" "$root/models/sdcsf.spec" >small.c 2>log
lines=$(wc -l <small.c)
echo "$lines lines, expected 270 at most; tables:" >log
! grep -e '_ROWS = ' -e '_turned\[' -e ' since;' small.c >>log && [ "$lines" -gt 100 ] && [ "$lines" -le 270 ]
result $? 'sdcsf without options: no rows, no phasors'
# phasors WORDS SPEC [OPTION ...]: its struct has those of the last refresh
phasors() {
	words=$1 spec=$2
	shift 2
	"$plgen" "$@" "$spec" >kind.c 2>log && grep -q ' since; ' kind.c
	result $? "$words: rotated phasors"
}
for option in --fast --batch --refresh=8; do
	phasors "sdcsf $option" "$root/models/sdcsf.spec" $option
done
{ cat "$root/models/sdcsf.spec"; echo 'need x1 within 1e-11 until 1'; } >needed.spec
phasors 'a need' needed.spec
"$plgen" --refresh 8 "$root/models/sdcsf.spec" >new.c 2>log &&
	"$plgen" --anchors 8 "$root/models/sdcsf.spec" >old.c 2>>log && cmp new.c old.c >>log 2>&1 && [ ! -s log ]
result $? '--anchors: another name of --refresh, and nothing is said'

# Blocks are loops that become vectors: at -O3 gcc leaves them as they are, written out they would be 1.4 times as long.
# instructions OPTION: of what NAME_run consists of, by gcc with vectors of 256 bits
instructions() {
	gcc -std=c99 "$1" -march=x86-64-v3 -I"$root/runtime" -S -o - driven.c 2>>log | awk '
		/^driven_(rows|block|run)(\.[a-z.0-9]*)?:/ { inside = 1 }
		inside && /^\t[a-z]/ { count++ }
		/^\t\.size/ { inside = 0 }
		END { print count + 0 }'
}
printf '%s\n' 'model driven' 'input u hold first' 'coord x, y' "x'' + 0.1*x' + 2*x - y = u" \
	"y'' + 0.2*y' + 3*y - x = 0" "output x, y, x', x''" 'step 0.1' >driven.spec
: >log
"$plgen" --fast -o driven.c driven.spec 2>>log
if gcc -march=x86-64-v3 -E -x c /dev/null >/dev/null 2>&1 && ! gcc --version | grep -q clang; then
	small=$(instructions -O2) large=$(instructions -O3)
	echo "$small instructions at -O2, $large at -O3, at most 1.1 times as many" >>log
	[ "$small" -gt 50 ] && [ $((10 * large)) -le $((11 * small)) ]
	result $? 'rows of ramps: at -O3 the same loops as at -O2'
else
	skip 'rows of ramps: at -O3 the same loops as at -O2' 'there is no gcc for x86-64'
fi
tap_end
