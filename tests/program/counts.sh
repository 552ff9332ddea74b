#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The operations that --explain and the banner name are those that the C takes: it counts them itself, compiled as C++
# with a number that counts (bench/limits). Functions of loads take integers too, which are not counted there.
#
#     counts.sh PLGEN SOURCE_ROOT
set -u
plgen=$(realpath "$1")
root=$2
. "${0%/*}/../tap.sh"

limits=$root/bench/limits
counted() {
	g++ -x c++ -w -O0 -include "$limits/counted.h" -I"$root/runtime" "$@"
}

if ! command -v g++ >/dev/null 2>&1; then
	skip 'operations counted' 'g++ is not installed'
	tap_end
fi
for file in series power apply phases peak retune until crossings; do
	counted -c "$root/runtime/$file.c" -o "$file.o" >>log 2>&1
done

# stated FILE.spec OPTIONS: multiplications and additions of a step, peaks looked for
stated() {
	"$plgen" --explain=json "$@" 2>>log | tr -d '\n' |
		sed -e 's/.*"cost"//' -e 's/"\(board\|worst\)": {[^}]*}//g' -e 's/"\(loads\|rows\)": [^}]*}//g' \
			-e 's/[^0-9]\{1,\}/ /g' |
		awk '{ print $1 + $3, $2 + $4 }'
}

# taken NAME FILE.spec OPTIONS: those that its C takes
taken() {
	name=$1
	shift
	"$plgen" "$@" >model.c 2>>log &&
		counted -DMODEL="$name" "$limits/count.cpp" model.c -x none series.o power.o apply.o phases.o peak.o \
			retune.o until.o crossings.o -o operations >>log 2>&1 && ./operations 1 1 -1 | tee -a log |
		sed -n 's/^step \([0-9.]* [0-9.]*\) 0 0 .*/\1/p'
}

# agree WORDS: stated and taken do
agree() {
	{ echo "taken    $(cat found)"; echo "expected $(cat expected)"; } >>log
	[ -s expected ] && cmp -s found expected
	result $? "$1"
}

models='scs quarter_car'
[ -z "${LONG:-}" ] || models='scs sdcs scs_weak linear2dof quarter_car'
for model in $models; do
	: >log
	stated "$root/models/$model.spec" >expected
	taken "$model" "$root/models/$model.spec" >found
	agree "$model: a step takes the operations that --explain says"
done

# Damped: after the first steps no value passes its peak.
cat >held.spec <<'SPEC'
model m
param k = 30, c = 0.4
coord x1, x2
input u, v
init x1 = 1
x1'' + c*(2*x1' - x2') + k*(2*x1 - x2) = u + 3*v
x2'' + c*(2*x2' - x1') + k*(2*x2 - x1) = v
output worst = peak(x1 - x2), x2, a = peak(x1''), b = peak(x1 + 0.5*v)
step 0.01
SPEC
sed 's/^coord/tunable k\n&/' held.spec >tuned.spec
for model in held tuned; do
	: >log
	stated $model.spec >expected
	taken m $model.spec >found
	agree "$model: the same where peaks are looked for"
done

# Of regions what is stated is the most that a step takes which is clear of all breakpoints, functions of loads counted.
cat >clear.spec <<'SPEC'
model m
coord x
x'' + 0.1*x' + deadzone(x, -1, 1)/9 + x = 0.1 + 0.05*cos(0.8*t)
step 0.1
SPEC
: >log
{ stated clear.spec; taken m clear.spec; } | tr '\n' ' ' >counts
cat counts >>log
awk '{ exit NF != 4 || $3 > $1 || $4 > $2 || $3 < $1 - 12 || $4 < $2 - 14 }' counts
result $? 'regions: a step that is clear takes at most what is stated, and little less'

# The functions of a load are evaluated for the step, for the look, and for the outputs, so what is not counted of them
# is missing three times; in the model without peaks once.
sed 's/= u + 3\*v/= cos(5*t)/; s/= v$/= 0/; s/ + 0.5\*v//; /^input/d' held.spec >loaded.spec
sed 's/peak//' loaded.spec | sed 's/peak//g' >seen.spec
: >log
for model in loaded seen; do
	stated --anchors 1 $model.spec
	taken m --anchors 1 $model.spec
done | tr '\n' ' ' >counts
cat counts >>log
awk '{ exit NF != 8 || $1 == $3 || ($1 - $3 - 3*($5 - $7))^2 + ($2 - $4 - 3*($6 - $8))^2 > 1e-6 }' counts
result $? 'a load: the same, what is not counted of its functions apart'
tap_end
