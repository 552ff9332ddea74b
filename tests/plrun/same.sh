#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every output of every model in models/, in double and float, has the digits that runtime/host/plmain.c prints; t is
# the decimal k h.
#
#     same.sh PLRUN PLGEN SOURCE_ROOT
. "${0%/*}/begin.sh"
steps=60
runtime_archive "$root/runtime"

# record_for SPEC: a line of names and samples, as plmain reads them
record_for() {
	sed -n 's/^input  *\([a-z_]*\) .*/\1/p' "$1" >names
	[ -s names ] || return 0
	cat names
	awk -v n=$((steps + 1)) 'BEGIN { for (k = 0; k < n; k++) printf "%.5g\n", 0.02 * sin(0.3 * k) + 0.01 }'
}

# t of plrun is k h by awk's decimals; the other columns are the same text
compare() {
	cut -d, -f 2- main.csv >main_outputs
	cut -d, -f 2- run.csv >run_outputs
	cmp main_outputs run_outputs >>log 2>&1 || return 1
	awk -F, -v h="$1" 'NR > 1 && $1 != sprintf("%.12g", (NR - 2) * h) { print "t", $1, (NR - 2) * h; bad = 1 }
		END { exit bad || NR != '$((steps + 2))' }' run.csv >>log
}

one_model() {
	spec=$1 real=$2
	name=$(basename "$spec" .spec)
	: >log
	h=$(sed -n 's/^step  *\([0-9.]*\).*/\1/p' "$spec")
	end=$(awk -v h="$h" -v n=$steps 'BEGIN { print n * h }')
	case $real in
		double) define= ;;
		float) define=-DFLOAT ;;
	esac
	record_for "$spec" >record.csv
	if ! "$PLGEN" --real "$real" "$spec" >model_pl.c 2>refusal; then
		! run --real "$real" "$spec" "$end" >out 2>&1 && cmp refusal said >>log
		result $? "$name $real: refused, with plgen's words"
		return
	fi
	model=$(sed -n 's/^const pl_modelf\{0,1\} \(.*\)_model = {/\1/p' model_pl.c)
	# shellcheck disable=SC2086
	${CC:-cc} -w -O0 -I"$root/runtime" "$root/runtime/host/plmain.c" model_pl.c "$archive" -DMODEL="$model" \
		$define -lm -o main 2>>log && ./main "$end" <record.csv >main.csv 2>>log
	if [ -s record.csv ]; then
		run "$spec" "$end" --real "$real" --input record.csv >run.csv
	else
		run "$spec" "$end" --real "$real" >run.csv
	fi && compare "$h"
	result $? "$name $real"
}

for spec in "$models"/*.spec; do
	chosen "$(basename "$spec" .spec)" || continue
	one_model "$spec" double
	one_model "$spec" float
done

# t where the step is no short decimal, is small, and where there are many: against python's decimals written here
cat >third.spec <<'X'
model third
coord x
x'' + x = 0
init x = 1
step 1/3
X
run third.spec 2 >third.csv
cut -d, -f 1 third.csv | tr '\n' ' ' >t
echo 't 0 0.3333333333333333 0.6666666666666666 1 1.3333333333333333 1.6666666666666665 2 ' >expected
tr '\n' ' ' <expected | sed 's/ $//' >expected_line
[ "$(cat t)" = "$(cat expected_line)" ]
result $? 'step 1/3: the digits of k h'
run "$models/scs.spec" 0.3 --step 0.1 | cut -d, -f 1 | tr '\n' ' ' >t
[ "$(cat t)" = 't 0 0.1 0.2 0.3 ' ]
result $? 'step 0.1: 0.3 is 0.3'
run "$models/scs.spec" 1e-05 --step 1e-6 --every 3e-6 | cut -d, -f 1 | tr '\n' ' ' >t
[ "$(cat t)" = 't 0 3e-06 6e-06 9e-06 ' ]
result $? 'step 1e-6, every third row'
tap_end
