#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What tests compile only to run it, by tcc (run_cc.sh), has the bits that other compilers give: what the models of
# ../same/runs.list do by tcc, gcc and clang, not optimised, is the same to the byte. In `make check` every twentieth,
# with LONG=1 all. And what small processors have of their own.
#
#     compilers.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"
. "$root/tests/same/run.sh"
if ! command -v tcc >log 2>&1; then
	skip 'tcc, gcc and clang' 'tcc is not installed'
	tap_end
fi

# rows NAME COMPILER ...: NAME.csv
rows() {
	name=$1
	shift
	told_by "./$name" "$root/runtime" "$archive" "$@" >>log 2>&1 && "./$name" >"$name.csv" 2>>log
}

place=0
list_runs >list
while read -r run; do
	place=$((place + 1))
	[ -n "${LONG:-}" ] || [ $((place % 20)) -eq 1 ] || continue
	chosen "$run" || continue
	emit "$plgen" "$run" >log 2>&1 && rows by_tcc tcc && rows by_gcc gcc -std=gnu11 -O0 -ffp-contract=off &&
		rows by_clang clang -std=gnu11 -O0 -ffp-contract=off &&
		cmp by_tcc.csv by_gcc.csv >>log 2>&1 && cmp by_tcc.csv by_clang.csv >>log 2>&1
	result $? "$run: the same bytes by tcc, gcc and clang"
done <list

# Where code is to be small, or doubles are software, steps beside friction and impacts are seen to be clear by the
# runtime (pl_guards_step), elsewhere by the model's file.
for run in models/bouncing_ball.spec models/brake.spec models/impact_oscillator.spec tests/contacts/clatter.spec \
	tests/friction/leaning.spec; do
	chosen "$run small" || continue
	emit "$plgen" "$run" >log 2>&1 && rows large tcc && rows small tcc -D__OPTIMIZE_SIZE__ && [ -s small.csv ] &&
		grep -q 'pl_guards_step(' model.c && cmp large.csv small.csv >>log 2>&1
	result $? "$run small: the same bytes as large"
done

# takes RUN STEPS MOST: so many steps take at most so many instructions. Where bounds show one event of a contact in a
# step, there is no search: by searches they are half as many again.
takes() {
	chosen "$1 instructions" || return 0
	{ printf '#include "model.h"\nint main(void)\n{\n\tstatic made s;\n\tmade_init(&s);\n'
	  printf '\tfor (int k = 0; k < %s; k++)\n\t\tmade_step(&s);\n\treturn 0;\n}\n' "$2"; } >steps.c
	emit "$plgen" "$1" >log 2>&1 &&
		gcc -O2 -I"$root/runtime" -I. steps.c model.c "$archive" -lm -o steps >>log 2>&1 &&
		valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=made_step \
			./steps >>log 2>&1 &&
		awk -v most="$3" '/Collected/ { count = $NF } END { exit !(count > 0 && count <= most) }' log
	result $? "$1: $2 steps take at most $3 instructions"
}
if command -v valgrind >log 2>&1; then
	takes models/stick_slip.spec 2000 280000
	takes models/bouncing_ball.spec 2000 740000
else
	skip 'instructions of events' 'there is no valgrind'
fi
tap_end
