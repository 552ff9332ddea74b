#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A model may bear the name of anything that its C has locals for: no -Wshadow, and no other warning, as C99 and as
# C++17.
#
#     shadow.sh PLGEN SOURCE_ROOT
#
# Every third identifier in the C of a model, with LONG=1 every one, taken as the name of that model.  The compilers are
# those of GCCS and CLANGS (default: gcc g++, clang clang++), all four for the first model, for the others gcc's C and
# clang's C++, with LONG=1 all; what is not installed is skipped.  gcc's C is of every name, any other of every third,
# each of others, with LONG=1 of all.
root=$2
. "${0%/*}/../compilers.sh"
. "${0%/*}/../plgen.sh"

{
	gccs=${GCCS:-gcc g++}
	clangs=${CLANGS:-clang clang++}
	echo "${gccs% *} -std=c99"
	echo "${clangs#* } -std=c++17 -x c++"
	echo "${gccs#* } -std=c++17 -x c++"
	echo "${clangs% *} -std=c99"
} >compilers

number=0

# words FILE.c: the identifiers outside comments, strings and lines of the preprocessor, but for those that begin with
# the model's name, and functions of <math.h>
words() {
	awk '{ text = text $0 "\n" }
		 END { while ((i = index(text, "/*")) > 0) {
				   printf "%s", substr(text, 1, i - 1); text = substr(text, i + 2);
					   text = substr(text, index(text, "*/") + 2) }
			   printf "%s", text }' "$1" | sed -e 's/"[^"]*"//g' -e '/^#/d' | tr -c 'A-Za-z0-9_' '\n' |
				   grep '^[A-Za-z]' |
		grep -v -i -e '^v\{0,1\}neutral' -e '^pl_' \
			-e '^\(a\{0,1\}\(sin\|cos\|tan\)h\{0,1\}\|exp\|log\|sqrt\|fabs\|pow\|fmin\|fmax\|atan2\)f$' |
			sort -u
}

# shadows TITLE LEAST SPEC OPTIONS: under each name that plgen takes, of all of them at least so many
shadows() {
	title=$1
	least=$2
	spec=$3
	shift 3
	rm -f [a-zA-Z]*_named.c
	"$plgen" --prefix neutral "$@" "$spec" >neutral_named.c 2>log
	status=$?
	names=0
	number=$((number + 1))
	# shellcheck disable=SC2046
	third $((number % 3)) $(words neutral_named.c) >names
	long || least=$((least / 3))
	while read -r name; do
		if "$plgen" --prefix "$name" "$@" "$spec" >text 2>/dev/null; then
			mv text "${name}_named.c"
			names=$((names + 1))
		fi
	done <names
	echo "$names names" >>log
	[ $status -eq 0 ] && [ $names -ge "$least" ]
	result $? "$title: $least of these names or more may be its own"
	place=0
	while read -r compiler options; do
		place=$((place + 1))
		if ! command -v "$compiler" >/dev/null 2>&1; then
			skip "$title, $compiler" "$compiler is not installed"
			continue
		fi
		files=$(echo ./*_named.c)
		# shellcheck disable=SC2086
		[ $place -eq 1 ] || files=$(third $((number + place)) $files)
		# shellcheck disable=SC2046,SC2086
		"$compiler" $warnings -I"$root/runtime" -fsyntax-only $(ahead "$compiler" ./neutral_named.c) $options \
			$files >log 2>&1
		result $? "$title: under these names it compiles without a warning, $compiler"
	done <compilers
	long || { head -n 2 compilers >few && mv few compilers; }
}

shadows 'loads' 15 "$root/models/sdcsf.spec" --rhs --selftest
shadows 'inputs, changing loads, float' 18 "$(path_of tests/emitted/linear/switched.spec)" --real float
shadows 'regions' 20 "$root/models/quarter_car_bumps.spec"
shadows 'tunable' 25 "$(path_of tests/tunable/changes.spec)"
shadows 'a remainder of ramps, with nodes' 20 "$root/tests/remainder/ramped.spec" --rhs --scheme nc3

# ---- they do what the model does under another name ----

# runs NAME: what a model of this name says is NAME.csv
runs() {
	main_of "$1" -std=c99 2>>log
	# shellcheck disable=SC2086
	"$plgen" --prefix "$1" "$(path_of tests/emitted/linear/ramps.spec)" >ran.c 2>>log &&
		${CC:-cc} -std=c99 -I"$root/runtime" $main ran.c "$archive" -o ran 2>>log &&
		./ran 2 >"$1.csv" 2>>log || echo "$1" >>log
}
: >log
runs neutral
cp log neutral.log
for name in s y x i out tau; do
	cp neutral.log log
	runs $name
	cmp "$name.csv" neutral.csv >>log 2>&1 && [ ! -s log ]
	result $? "a model called $name runs as another"
done

tap_end
