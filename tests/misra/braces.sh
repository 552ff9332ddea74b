#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# braces.sh PLGEN SOURCE_ROOT: in generated code and in the runtime every body of an if, an else or a loop has braces.
set -u
plgen=$(realpath "$1")
root=$(cd "$2" && pwd) || exit 99
. "$root/tests/tap.sh"
. "$root/tests/cases.sh"
look="$root/tests/misra/braces.py"
if ! command -v python3 >/dev/null 2>&1; then
	skip 'braces' 'python3 is not installed'
	tap_end
fi

printf 'void f(int a)\n{\n    if (a > (1)) {  /* for */\n        a = 0;\n    } else\n        a = 1;\n}\n' >bare.c
python "$look" bare.c >log 2>&1
[ $? -eq 1 ] && grep -q '^bare.c: else a = 1;' log && grep -q '^1 bodies' log
result $? 'a body without is noticed'

# make NAME SPEC OPTIONS
make() {
	name=$1
	spec=$2
	shift 2
	"$plgen" --prefix "$name" "$@" -o "$name.c" "$(path_of "$spec")" 2>said ||
		{ cat said && echo "$name is not made"; } >>log
}
: >log
for spec in "$root"/models/*.spec; do
	name=${spec##*/}
	make "${name%.spec}_x" "models/$name"
done
for spec in sdcsf oscillator tuned_floor gear1; do
	make ${spec}_fast_x models/$spec.spec --fast
done
for spec in sdcsf quarter_car_bumps pendulum; do
	make ${spec}_rhs models/$spec.spec --rhs
done
for spec in sdcsf beam4 oscillator quarter_car_bumps gear1 pendulum; do
	make ${spec}_float models/$spec.spec --real float
done
for spec in sdcsf oscillator; do
	make ${spec}_batch models/$spec.spec --batch
done
for spec in sdcsf gear1 pendulum oscillator quarter_car_bumps; do
	make ${spec}_bundle_x models/$spec.spec --bundle
done
make tuned_x tests/tunable/changes.spec
make selftest_x models/sdcsf.spec --selftest
[ ! -s log ] && python "$look" ./*_x.c ./*_rhs.c ./*_float.c ./*_batch.c >log 2>&1
result $? "generated code: $(tail -n 1 log)"
bodies=$(sed -n '$s/ bodies.*//p' log)
python "$look" "$root"/runtime/*.[ch] "$root"/runtime/fmi/*.[ch] >log 2>&1
result $? "the runtime: $(tail -n 1 log)"
shared=$(sed -n '$s/ bodies.*//p' log)
[ "${bodies:-0}" -gt 500 ] && [ "${shared:-0}" -gt 800 ]
result $? 'and there are many of both'
tap_end
