#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every output of every third model in models/, with MERGE=1 every one, in double and, every third, with LONG=1 each,
# in float, has the digits that runtime/host/plmain.c prints; t is the decimal k h.
#
#     same.sh PLRUN PLGEN SOURCE_ROOT
. "${0%/*}/begin.sh"
. "$root/tests/run_cc.sh"
steps=60
place=0
runtime_archive "$root/runtime"

# The inputs of model_pl.c and samples, as plmain reads them
record() {
	sed -n 's/.*_input_names\[\] = {\(.*\)};/\1/p' model_pl.c | tr -d '" ' >names
	[ -s names ] || return 0
	cat names
	awk -v n=$((steps + 9)) -v columns="$(tr ',' '\n' <names | wc -l)" 'BEGIN { for (k = 0; k < n; k++)
		for (i = 1; i <= columns; i++)
			printf "%.5g%s", 0.02 * sin((0.2 + i / 10) * k) + 0.01, i < columns ? "," : "\n" }'
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
	spec=$1 real=$2 params=${3-}
	name=$(basename "$spec" .spec)
	: >log
	[ -f "$spec" ] || exit 99
	h=$(sed -n 's/^step  *\([0-9.]*\).*/\1/p' "$spec")
	end=$(awk -v h="$h" -v n=$steps 'BEGIN { print n * h }')
	case $real in
		double) define= ;;
		float) define=-DFLOAT ;;
	esac
	if ! "$PLGEN" --fast --real "$real" "$spec" >model_pl.c 2>refusal; then
		! run --real "$real" "$spec" "$end" >out 2>&1 && cmp refusal said >>log
		result $? "$name $real: refused, with plgen's words"
		return
	fi
	record >record.csv
	model=$(sed -n 's/^extern const pl_modelf\{0,1\} \(.*\)_model;/\1/p' model_pl.c)
	# shellcheck disable=SC2086
	$run_cc $define -I"$root/runtime" -DMODEL="$model" "$root/runtime/host/plmain.c" model_pl.c "$archive" -lm \
		-o main 2>>log &&
		./main "$end" $params <record.csv >main.csv 2>>log
	set -- "$spec" "$end" --real "$real"
	[ ! -s record.csv ] || set -- "$@" --input record.csv
	# shellcheck disable=SC2086
	for param in $params; do
		set -- "$@" -D "$param"
	done
	run "$@" >run.csv && compare "$h"
	result $? "$name $real${params:+ $params}"
}

for spec in "$models"/*.spec; do
	one_of 3 || continue
	chosen "$(basename "$spec" .spec)" || continue
	place=$((place + 1))
	one_model "$spec" double
	[ -z "${LONG:-}" ] && [ $((place % 3)) -ne 0 ] || one_model "$spec" float
done

one_model "$models/oscillator.spec" double 'w=17 zeta=0.3'
one_model "$models/oscillator.spec" float 'w=17 zeta=0.3'

# Kinds that no model there is
cp "$root/tests/holds/chain.spec" chain.spec
cat >kinds.spec <<'X'
model kinds
coord x, y
input u, v hold first
x'' + 0.3*x' + 4*x + y = u + exp(-t)*cos(3*t)
y'' + 0.1*y' + 9*y + x = v
output x, worst = peak(y)
step 0.1
X
sed '/^coord/s/$/\nscheme radau\nsubsteps 2000/; s/4\*x/4*x^3/; /^output/d' kinds.spec >radau.spec
sed 's/scheme radau/scheme auto/' radau.spec >auto.spec
sed 's/scheme radau/scheme taylor 12/; /substeps/d' radau.spec >taylor.spec
for name in etdrk2 pl nc3; do
	sed "s/scheme radau/scheme $name/; /substeps/d" radau.spec >$name.spec
done
for kind in chain kinds radau auto taylor etdrk2 pl nc3; do
	one_model $kind.spec double
	one_model $kind.spec float
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
