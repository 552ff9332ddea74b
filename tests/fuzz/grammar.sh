#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# grammar.sh PLGEN GRAMMAR ARCHIVE_GCC SOURCE FIRST COUNT [CORPUS]: every third spec of the file CORPUS, with CASE,
# MERGE=1 or LONG=1 in the environment every one, then the specs that GRAMMAR, `grammar` or `scenes`, makes of COUNT
# seeds from FIRST on, STRIDE apart, as TAP: a line for each spec of the corpus, and for each block of seeds.
# What is emitted is compiled to be run, every sixth with all warnings as errors and sanitizers; with MERGE=1 or LONG=1
# all have sanitizers, by gcc and clang in turn; and drive.c holds it against other roads. A spec may be refused only
# with a message of refusals.list.
set -u
plgen=$(realpath "$1")
grammar=$(realpath "$2")
folder=$(dirname "$(realpath "$3")")
source=$(realpath "$4")
first=$5
stride=${STRIDE:-1}
past=$((first + $6 * stride))
corpus=${7:-}
[ -z "$corpus" ] || corpus=$(realpath "$corpus")
keep=${KEEP:-}
[ -z "$keep" ] || keep=$(realpath "$keep")
. "$source/tests/tap.sh"
. "$source/tests/fuzz/batch.sh"
merging || every=6
block=25
made=0
refused=0

# keep_it ID NAME SPEC: what went wrong, into the log; the spec, where KEEP wants it
keep_it() {
	{
		echo "$2, options '$(head_of "$3" options)':"
		cat "$1.wrong"
	} >>log
	[ -z "$keep" ] || cp "$3" "$keep/$2.spec"
}

# run_all IDS: the programs of ID.spec, c_ID of the corpus.  What is beyond a bound by steps of a fixed order is made
# again with one by eighths beside it
run_all() {
	late=
	for id in $1; do
		[ -f "$id.cc" ] || continue
		batch_run "$id"
		! batch_coarse "$id" "${id#c_}.spec" || late="$late $id"
	done
	[ -n "$late" ] || return
	eighths=yes
	batch_new
	for id in $late; do
		batch_add "$id" "${id#c_}.spec"
	done
	eighths=
	batch_build
	for id in $late; do
		batch_run "$id"
	done
}

cp -R "$source/tests/fuzz/corpus/parts" .
# the corpus, in one batch
if [ -n "$corpus" ]; then
	batch_new
	awk -f "$source/tests/cases.awk" "$corpus" >names
	merging || [ -n "${CASE:-}" ] || { awk 'NR % 3 == 1' names >half && mv half names; }
	names=$(cat names)
	for name in $names; do
		batch_add "c_$name" "$name.spec"
	done
	batch_build
	run_all "$(sed 's/^/c_/' names)"
	for name in $names; do
		: >log
		id=c_$name
		if [ -f "$id.cc" ]; then
			words=$(cut -d : -f 2- "$id.ran" 2>>log)
		else
			words=' refused, with a reason'
		fi
		if [ -s "$id.wrong" ]; then
			keep_it "$id" "$name" "$name.spec"
			result 1 "$name"
		else
			result 0 "$name:$words"
		fi
	done
fi

seed=$first
while [ "$seed" -lt "$past" ]; do
	end=$((seed + block * stride))
	[ "$end" -gt "$past" ] && end=$past
	from=$seed
	bad=0
	: >log
	rm -f s*.* ws*.* ts*.*
	batch_new
	while [ "$seed" -lt "$end" ]; do
		id=s$seed
		"$grammar" "$seed" "$id.spec" "$id.again.c" || exit 99
		batch_add "$id" "$id.spec"
		case $said in
			made) made=$((made + 1)) ;;
			refused) refused=$((refused + 1)) ;;
		esac
		seed=$((seed + stride))
	done
	batch_build
	run_all "$(seq -f 's%.0f' "$from" "$stride" $((end - 1)))"
	seed=$from
	while [ "$seed" -lt "$end" ]; do
		id=s$seed
		if [ -s "$id.wrong" ]; then
			bad=$((bad + 1))
			keep_it "$id" "$seed" "$id.spec"
		fi
		seed=$((seed + stride))
	done
	result "$bad" "seeds $from to $((end - 1))"
done
echo "# $made models made, $refused specs refused with a reason"
tap_end
