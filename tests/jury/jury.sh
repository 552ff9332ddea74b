#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# jury.sh PLGEN PLRUN SOURCE: cases that others have published, with their digits, as TAP. A case stands in
# TOPIC.cases: its name behind `===`, its spec, a line `---`, and of these lines
#
#     case TEXT                   what it is
#     source TEXT                 who published the digits, and where
#     options WORDS               for plgen and plrun
#     without SCHEME: REASON      a scheme that is not run
#     short REASON                why a run may reach fewer digits than are published
#     at T                        from here on values at this time, a multiple of the step:
#     OUTPUT VALUE [within X]     with as many digits as are published; within: what the source says of its error
#     hertz N VALUE, rad N VALUE  the N-th natural frequency, in Hz or rad/s
#     refused TEXT                instead of all values: plgen's message about the spec
#     merge                       only with MERGE=1 or LONG=1: it takes long
#     long                        only with LONG=1
#
# Each scheme makes its C, which is compiled and run; plrun runs what plgen chooses by itself, with the same rows. All
# published digits are reached, or where a case says why not, as many as doc/jury.md says.
#
#     jury.sh PLGEN PLRUN SOURCE --page       prints doc/jury.md
set -u
PLGEN=$(realpath "$1")
plrun=$(realpath "$2")
root=$(realpath "$3")
mode=${4-}
export PLGEN
. "$root/tests/tap.sh"
. "$root/tests/compilers.sh"
. "$root/tests/run_cc.sh"
XDG_CACHE_HOME=$work/cache
export XDG_CACHE_HOME
# With LONG=1 plrun compiles as a user has it.
if ! long; then
	CC=${run_cc%% *}
	CFLAGS=${run_cc#* }
	export CC CFLAGS
fi
page=$root/doc/jury.md
runtime_archive "$root/runtime"

# Each case as files: NAME.spec, beside its matrices, and NAME.jury with what follows its spec
here=$work/cases
mkdir cases && ln -s "$root"/tests/jury/*.mtx cases || exit 99
awk -v into=cases/ -v rest=jury -f "$root/tests/cases.awk" "$root"/tests/jury/*.cases >names || exit 99

# key NAME WORD: what stands behind the word in NAME.jury
key() {
	while read -r word rest; do
		[ "$word" != "$2" ] || printf '%s\n' "$rest"
	done <"$here/$1.jury"
}

# has NAME WORD...: whether a line begins with one of the words
has() {
	name=$1
	shift
	while read -r word rest; do
		case " $* " in *" $word "*) return 0 ;; esac
	done <"$here/$name.jury"
	return 1
}

# link NAME: to the file in which it stands
awk '/^=== / { sub(/.*\//, "", FILENAME); print $2, FILENAME }' "$root"/tests/jury/*.cases >topics
link() {
	while read -r name topic; do
		[ "$name" != "$1" ] || echo "[$1](../tests/jury/$topic)"
	done <topics
}

# run_c NAME SCHEME: rows_SCHEME.csv of the compiled C, or status 2 where plgen refuses the scheme
run_c() {
	# shellcheck disable=SC2086
	"$PLGEN" --fast --scheme "$2" --prefix judged $options "$here/$1.spec" >judged.c 2>log || return 2
	[ -e plmain.o ] || $run_cc -I"$root/runtime" -DMODEL=judged -c "$root/runtime/host/plmain.c" -o plmain.o ||
		return 1
	$run_cc -I"$root/runtime" plmain.o judged.c "$archive" -lm -o judged >>log 2>&1 &&
		./judged "$end" >"rows_$2.csv" 2>>log
}

# fewest_of FILE: `PUBLISHED REACHED` of what judge.awk has written: the fewest digits published, and `all` where each
# value has all of its own, else the fewest; values that are not reached in full to `log`
fewest_of() {
	awk 'NR == 1 || $3 < published { published = $3 }
		$4 < ($3 < 15 ? $3 : 15) && (!short++ || $4 < fewest) { fewest = $4 }
		$4 < 15 && $4 < $3 {
			print "t = " $1 ": " $2 " = " $6 ", published " $5 ": " $4 " of " $3 " digits" >>"log"
		}
		END { print published + 0, NR == 0 ? 0 : short ? fewest : "all" }' "$1"
}

# end_of NAME: the last time at which it has values
end_of() {
	awk '$1 == "at" && (!any++ || $2 + 0 > last + 0) { last = $2 } END { print last }' "$here/$1.jury"
}

# stated NAME SCHEME: what the page says of the case
awk -F '|' 'match($2, /^\[[^]]*\]\(/) {
	gsub(/ /, "")
	print substr($2, 2, RLENGTH - 3), $5, $6, $7, $8
}' "$page" >page_cells
stated() {
	# shellcheck disable=SC2034
	while read -r name exact taylor radau auto; do
		[ "$name" != "$1" ] || eval "echo \$$2"
	done <page_cells
}

# kept STATED FOUND: whether as much is reached as is stated
kept() {
	case $1:$2 in
		-:-|all:all) return 0 ;;
		*:all) [ "$1" != - ] && [ -n "$1" ] ;;
		[0-9]*:[0-9]*) [ "$2" -ge "$1" ] ;;
		*) return 1 ;;
	esac
}

# one_scheme NAME SCHEME: sets `cell`, the digits reached or `-`, and `published`
one_scheme() {
	cell=-
	: >log
	case $(key "$1" without) in *"$2: "*) return ;; esac
	run_c "$1" "$2"
	case $? in
		0) ;;
		2) return ;;
		*) echo "its C does not run to the end" >>log; cell=0; return ;;
	esac
	awk -v spare="$spare" -f "$root/tests/jury/judge.awk" "$here/$1.jury" "rows_$2.csv" >judged.txt
	# shellcheck disable=SC2046
	set -- "$1" "$2" $(fewest_of judged.txt)
	published=$3
	cell=$4
}

# poles_of NAME: its natural frequencies against those published
poles_of() {
	# shellcheck disable=SC2086
	"$PLGEN" --explain=json $options "$here/$1.spec" 2>log |
		awk '/"poles": \[/ { inside = 1 }
			inside && match($0, /"im": [-0-9.e+]*/) { im = substr($0, RSTART + 6, RLENGTH - 6) + 0
				sub(/.*"multiplicity": /, "")
				for (k = 0; im > 0 && k < $0 + 0; k++) printf "%.17g\n", im }
			/\],$/ { inside = 0 }' | sort -g >poles
	cell=-
	awk -v poles=poles -v spare="$spare" -f "$root/tests/jury/judge.awk" "$here/$1.jury" >judged.txt
	# shellcheck disable=SC2046
	set -- "$1" $(fewest_of judged.txt)
	published=$2
	cell=$3
}

# by_plrun NAME: plrun by itself has the rows of the C of the scheme that plgen chooses
by_plrun() {
	# shellcheck disable=SC2086
	scheme=$("$PLGEN" --fast $options "$here/$1.spec" 2>/dev/null | sed -n 's/^ \* Scheme \([a-z]*\).*/\1/p')
	# shellcheck disable=SC2086
	"$plrun" $options "$here/$1.spec" "$end" >plrun.csv 2>log || return 1
	[ -s "rows_$scheme.csv" ] || run_c "$1" "$scheme" || return 1
	cut -d , -f 2- plrun.csv >plrun_outputs
	cut -d , -f 2- "rows_$scheme.csv" | cmp - plrun_outputs >>log 2>&1
}

# refusal NAME: what plgen says of it
refusal() {
	"$PLGEN" "$here/$1.spec" 2>&1 >/dev/null | sed -n 's/.*: error: //p' | head -n 1
}

# try NAME: its lines as TAP; sets `options` and `end` of the case
try() {
	rm -f rows_*.csv
	if [ -n "$(key "$1" refused)" ]; then
		refusal "$1" >log
		echo "expected: $(key "$1" refused)" >>log
		[ "$(head -n 1 log)" = "$(key "$1" refused)" ]
		result $? "$1 is refused"
		return
	fi
	options=$(key "$1" options)
	end=$(end_of "$1")
	published=
	line=
	for scheme in exact taylor radau auto; do
		cell=-
		if ! has "$1" hertz rad; then
			one_scheme "$1" $scheme
		elif [ $scheme = exact ]; then
			poles_of "$1"
		fi
		line="$line|$cell"
		told "$1" $scheme
	done
	echo "$published$line" >"cells_$1"
	[ "$mode" = --page ] || has "$1" hertz rad && return
	by_plrun "$1"
	result $? "$1: plrun has the rows of the C"
}

# told NAME SCHEME: `cell` against the page and what the case asks for
told() {
	want=$(stated "$1" "$2")
	[ "$cell" != - ] || [ "$want" != - ] || return 0
	echo "the page says '$want', found '$cell'" >>log
	kept "$want" "$cell" && { [ "$cell" = all ] || [ -n "$(key "$1" short)" ]; }
	result $? "$1 by $2: $cell of $published digits"
}

cases() {
	for file in "$here"/*.jury; do
		file=${file##*/}
		echo "${file%.jury}"
	done
}

# row NAME NUMBER_OF_SOURCE: its line of the table; digits of what was not run as the page has them
row() {
	[ -s "cells_$1" ] || grep -F -e "|[$1](" "$page" | cut -d '|' -f 4-8 >"cells_$1"
	printf '|%s|%s|%s|\n' "$(link "$1")" "$2" "$(cat "cells_$1")"
}

# source_number NAME
source_number() {
	grep -n -x -F -e "$(key "$1" source)" sources | cut -d : -f 1
}

print_page() {
	for name in $(cases); do
		key "$name" source
	done | LC_ALL=C sort -u >sources
	cat <<'END'
# Published cases

You want to see plgen reproduce values that others have published. Each case was entered from its source before it was
run; a name links to the file that says what the case is, with its spec and the values. The test `jury` makes C by each
scheme, runs it, and compares the digits reached with this page, which `tests/jury/jury.sh` prints; `plrun` gives the
same rows.

- **published**: the fewest digits of a value of that case.
- **exact, taylor, radau, auto**: `all` where every value has every published digit within half a unit of the last (of
  at most 15, which a double holds); else the fewest digits of a value, with the reason below. `-`: refused or not run.

|case|source|published|exact|taylor|radau|auto|
|---|---|---|---|---|---|---|
END
	for name in $(cases); do
		[ -n "$(key "$name" refused)" ] || row "$name" "$(source_number "$name")"
	done
	printf '\n## Where fewer digits are reached, or a scheme is not run\n\n'
	for name in $(cases); do
		key "$name" short | sed "s/^/$name	/"
		key "$name" without | sed "s/^\\([a-z]*\\): /$name without \\1	/"
	done >short
	cut -f 2- short | awk '!said[$0]++' | while IFS= read -r reason; do
		awk -F '\t' -v reason="$reason" '$2 == reason { printf "%s%s", n++ ? ", " : "- ", $1 }
			END { print ": " reason }' short | fold_item
	done
	printf '\n## What cannot be written today\n\n'
	for name in $(cases); do
		words=$(key "$name" refused)
		[ -z "$words" ] || printf '%s\n' "- $(link "$name"), $(key "$name" case), source\
 $(source_number "$name"): \`$words\`" | fold_item
	done
	printf '\n## Sources\n\n'
	awk '{ print NR ". " $0 }' sources | while IFS= read -r line; do
		echo "$line" | fold_item
	done
}

# a list item as lines of at most 118 columns, the others indented
fold_item() {
	fold -s -w 116 | sed '2,$s/^/  /; s/ *$//'
}

# words_alone FILE: the page without the digits, which `told` compares
words_alone() {
	sed 's/^\(|\[.*cases)|[0-9]*|\).*/\1/' "$1"
}

spare=1
[ "$mode" != --page ] || spare=2
for name in $(cases); do
	chosen "$name" || continue
	[ "$mode" = --page ] || long || ! has "$name" long || continue
	[ "$mode" = --page ] || merging || ! has "$name" merge || continue
	[ "$mode" = --page ] || one_of 2 || continue
	try "$name" >>tried
done
print_page >page
if [ "$mode" = --page ]; then
	cat page
	exit
fi
cat tried
words_alone "$page" >page_words
words_alone page | diff - page_words >log
result $? 'doc/jury.md is what these cases make, but for the digits'
tap_end
