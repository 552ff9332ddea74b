#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What the MISRA C 2012 addon of cppcheck finds in generated code and in the runtime, whose headers with algorithms are
# read where models include them: of each rule no more than doc/firmware/misra.csv has, and no rule that is not
# there. A case for each file, once it has been read, and for each rule.
#
#     misra.sh PLGEN SOURCE_ROOT
#     misra.sh PLGEN SOURCE_ROOT --table      prints what that table says, a rule a line: rule, in the models, in the
#                                             runtime
set -u
plgen=$(realpath "$1")
root=$(cd "$2" && pwd) || exit 99
mode=${3-}
. "$root/tests/tap.sh"
. "$root/tests/cases.sh"
if ! command -v cppcheck >/dev/null 2>&1; then
	skip 'MISRA C' 'cppcheck is not installed'
	tap_end
fi

# make NAME SPEC OPTIONS
make() {
	name=$1
	spec=$2
	shift 2
	"$plgen" --prefix "$name" "$@" -o "$name.c" "$(path_of "$spec")" 2>>log || exit 99
}
make linear models/sdcsf.spec --fast
make single models/sdcsf.spec --real float
make series models/pendulum.spec
make regions models/quarter_car_bumps.spec
make tunables tests/tunable/changes.spec
make operators models/beam4.spec --scheme etdrk4

# look PLACES FILES: adds what is found, FILE:LINE:COLUMN RULE; a case for each file, in which some is
# As gcc reads them: of itself cppcheck takes a dozen sets of macros, of which those of the runtime have files.
look() {
	places=$1
	shift
	for file; do
		cppcheck --quiet -D__GNUC__=12 --addon=misra --std=c99 -I"$root/runtime" \
			--template='{file}:{line}:{column} {id}' "$file" >said 2>&1
		cat said >>"$places"
		grep -q 'misra-c2012' said
		found=$?
		cp said log
		[ "$mode" = --table ] || result $found "${places#in_}: ${file##*/} is read"
	done
}
: >in_models
: >in_runtime
look in_models ./*.c
# cppcheck writes beside what it reads
cp -r "$root/runtime" runtime_copy
look in_runtime runtime_copy/*.c

# rules PLACES: rule and count, each place once
rules() {
	sort -u "$1" | sed -n 's/.*misra-c2012-\([0-9.]*\)$/\1/p' | sort | uniq -c | awk '{ print $2, $1 }'
}
cat in_models in_runtime | sed "s,^$root/runtime/,runtime_copy/," >places
grep -v '^runtime_copy/' places >of_models
grep '^runtime_copy/' places >of_runtime
rules of_models >models
rules of_runtime >runtime
awk 'FILENAME == "models" { models[$1] = $2; rule[$1] } FILENAME == "runtime" { runtime[$1] = $2; rule[$1] }
	END { for (r in rule) print r, models[r] + 0, runtime[r] + 0 }' models runtime |
	sort -t . -k 1,1n -k 2,2n >found
if [ "$mode" = --table ]; then
	cat found
	exit 0
fi

# The table: rule,kind,in the models,in the runtime,why
awk -F, 'NR > 1 { print $1, $3 + 0, $4 + 0 }' "$root/doc/firmware/misra.csv" >allowed
while read -r rule models runtime; do
	most=$(awk -v rule="$rule" '$1 "" == rule "" { print $2, $3 }' allowed)
	echo "rule $rule: $models, $runtime, in the table ${most:-nothing}" >log
	[ -n "$most" ] && [ "$models" -le "${most% *}" ] && [ "$runtime" -le "${most#* }" ]
	result $? "rule $rule, $models and $runtime times, not more than doc/firmware/misra.csv says"
done <found
[ "$(wc -l <found)" -gt 15 ] || result 1 "only $(wc -l <found) rules were found"
tap_end
