#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What the MISRA C 2012 addon of cppcheck finds in generated code and in the runtime: of each rule no more than
# doc/misra.md has in its table, and no rule that is not there.
#
#     misra.sh PLGEN SOURCE_ROOT [--table]
#
# --table: prints the rows for that page, a rule a line: rule, in the models, in the runtime.
set -u
plgen=$1
root=$(cd "$2" && pwd) || exit 99
table=${3:-}
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
. "$root/tests/tap.sh"
if ! command -v cppcheck >/dev/null 2>&1; then
	skip 'MISRA C' 'cppcheck is not installed'
	tap_end
fi

# make NAME SPEC OPTIONS
make() {
	name=$1
	spec=$2
	shift 2
	"$plgen" --prefix "$name" "$@" -o "$name.c" "$root/$spec" 2>>log || exit 99
}
make linear models/sdcsf.spec
make single models/sdcsf.spec --real float
make series models/pendulum.spec
make regions models/quarter_car_bumps.spec
make tunables tests/tunable/changes.spec
make operators models/beam4.spec --scheme etdrk4

# look FILES: places and rules, each once
look() {
	for file; do
		cppcheck --quiet --addon=misra --std=c99 -I"$root/runtime" \
			--template='{file}:{line}:{column} {id}' "$file" 2>&1
	done | sort -u
}
look ./*.c | grep -v '/plrt\.h:' >in_models
# cppcheck writes beside what it reads
cp -r "$root/runtime" runtime_copy
look runtime_copy/*.c | sed "s,^$root/runtime/,runtime_copy/," | sort -u | grep -v '/lanes\.h:' >in_runtime

# rules PLACES: rule and count
rules() {
	sed -n 's/.*misra-c2012-\([0-9.]*\)$/\1/p' "$1" | sort | uniq -c | awk '{ print $2, $1 }'
}
rules in_models >models
rules in_runtime >runtime
awk 'FILENAME == "models" { models[$1] = $2; rule[$1] } FILENAME == "runtime" { runtime[$1] = $2; rule[$1] }
	END { for (r in rule) print r, models[r] + 0, runtime[r] + 0 }' models runtime |
	sort -t . -k 1,1n -k 2,2n >found
if [ "$table" = --table ]; then
	cat found
	exit 0
fi

# The page: | 15.6 | advisory | before, after in the models | in the runtime | why |
awk -F'|' '$2 ~ /^ [0-9]+\.[0-9]+ $/ { split($4, m, ","); gsub(/ /, "", $2); print $2, m[2] + 0, $5 + 0 }' \
	"$root/doc/misra.md" >allowed
: >log
awk 'FILENAME == "allowed" { models[$1] = $2; runtime[$1] = $3; known[$1]; next }
	!($1 in known) { print "rule " $1 " is not on the page: " $2 " in the models, " $3 " in the runtime"; next }
	$2 > models[$1] { print "rule " $1 ": " $2 " in the models, on the page " models[$1] }
	$3 > runtime[$1] { print "rule " $1 ": " $3 " in the runtime, on the page " runtime[$1] }' allowed found >log
[ "$(wc -l <found)" -gt 15 ] || echo "only $(wc -l <found) rules were found" >>log
[ ! -s log ]
result $? "MISRA C 2012: $(wc -l <found) rules, each no more often than doc/misra.md says"
tap_end
