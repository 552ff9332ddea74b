#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# combinations.sh PLGEN COVERING ARCHIVE_GCC SOURCE: the first 54 rows of the covering array are made and agree
# with other roads, every fourth set that gen/model/capability.def refuses is refused with its message, with MERGE=1 or
# LONG=1 in the environment all rows and all sets, as TAP; and doc/combinations.md is what comes out of these. Of the C
# every 18th row has sanitizers, with MERGE=1 every sixth; with LONG=1 all have, optimised.
#     combinations.sh PLGEN COVERING ARCHIVE_GCC SOURCE --pairs     prints the pairs that plgen refuses
#     combinations.sh PLGEN COVERING ARCHIVE_GCC SOURCE --table     prints doc/combinations.md
set -u
plgen=$(realpath "$1")
covering=$(realpath "$2")
folder=$(dirname "$(realpath "$3")")
source=$(realpath "$4")
list=$source/tests/combinations/capabilities.list
. "$source/tests/tap.sh"
. "$source/tests/fuzz/batch.sh"
cp "$source/tests/combinations/chain7.mtx" .
awk 'NR == 2 { print "3 3 5" } NR < 2 || (NR > 2 && NR < 8)' chain7.mtx >chain3.mtx
cat >part.spec <<-END             # for rows with 'parts'
	model part
	param m = 1.5, k = 4
	input pull
	coord x
	output speed = x'
	m*x'' + k*x = pull
END
tab=$(printf '\t')

# words_of ID ROW: what there is to say against ID.spec, made or not; nothing if all of the row is there
words_of() {
	heads_of "$1.spec"
	make_c "$1" "$1.spec" "$given"
	status=$?
	if [ $status -ne 0 ]; then
		sed -n '/: error: ./{s/.*: error: //;h;}
			${g;/./p;}' "$1.said"
		[ $status -eq 1 ] || echo "status $status"
		return
	fi
	for function in at jump; do
		case " $2 " in
			*" $function "*)
				grep -q "_$function(" "$1.h" && continue
				reason=$(grep -m 1 -e "There is no $1_$function" \
					-e "There is no $1_core_$function" "$1.c" |
					sed "s/^ \* //; s/$1_core_/NAME_/; s/$1_/NAME_/")
				echo "${reason:-no NAME_$function, without a reason}" ;;
		esac
	done
}

# is_program ID: --explain=program prints ID.spec as the program that its C has, by its first line and its operations
is_program() {
	# shellcheck disable=SC2046
	"$plgen" --explain=program --prefix "$1" $(head_of "$1.spec" options) "$1.spec" >program \
		2>"$1.said" || head -n 3 "$1.said" >>"$1.wrong"
	kind=$(sed -n "1s/^Program of a step of $1\(_core\)\{0,1\}: \([a-z]*\).*/\2/p" program)
	case $kind:$class in
		linear:\ linear|regions:\ piecewise|regions:\ sticking|with:*) ;;
		*) echo "the program is of kind '$kind'" >>"$1.wrong" ;;
	esac
	cost=$(sed -n 's/^Cost: \([0-9]* multiplications, [0-9]* additions\),.*/\1/p' program)
	grep -q -F -e ": $cost" -e ": at most $cost" "$1.c" ||
		echo "its cost is not that of the comment in the C: $(grep '^Cost' program)" >>"$1.wrong"
}

# stands_aside ID: of ID.spec, made, whose options stand aside: the C is that without them, but for its banner and what
# pairs it with its header
stands_aside() {
	less=$(sed -n 's/^ \* \(.*\) stands aside: .*/\1/p' "$1.c")
	[ -n "$less" ] || return
	options=" $(head_of "$1.spec" options) "
	cp "$1.spec" plain.spec
	while read -r option; do
		options=$(printf '%s\n' "$options" | sed "s/ $option / /")
		sed "/^scheme/s/ $option\$//" plain.spec >less.spec && mv less.spec plain.spec
	done <<-END
		$less
	END
	sed '1,/^ \*\//d; /_PAIR/d' "$1.c" >with.text
	make_c "$1" plain.spec "$options"
	sed '1,/^ \*\//d; /_PAIR/d' "$1.c" | cmp -s - with.text ||
		echo "not the C of what has not: $less" | tr '\n' ' ' >>"$1.wrong"
}

if [ "${5:-}" = --table ]; then
	"$covering" table "$list"
	exit
fi
if [ "${5:-}" = --pairs ]; then
	"$covering" pairs "$list" | while read -r row; do
		# shellcheck disable=SC2086
		"$covering" spec p.spec $row
		words=$(words_of p "$row")
		[ -z "$words" ] || printf '%s\t%s\n' "$row" "$words"
	done
	exit
fi

every=18
! merging || every=6
batch_new
number=0
"$covering" rows "$list" >rows || exit 99
merging || { head -n 54 rows >first && mv first rows; }         # each has fewer sets that are new than the one before
while read -r row; do
	number=$((number + 1))
	# shellcheck disable=SC2086
	"$covering" spec "r$number.spec" $row || exit 99
	batch_add "r$number" "r$number.spec"
	[ "$said" != made ] || ! one_of 9 || is_program "r$number"
	[ "$said" = refused ] && cp "r$number.said" "r$number.wrong"
	[ "$said" != made ] || ! one_of 3 || stands_aside "r$number"
	for function in at jump; do
		case " $row " in
			*" $function "*)
				[ "$said" != made ] || grep -q "_$function(" "r$number.h" ||
					echo "there is no NAME_$function" >"r$number.wrong" ;;
		esac
	done
done <rows
batch_build
number=0
while read -r row; do
	number=$((number + 1))
	[ -s "r$number.wrong" ] || batch_run "r$number"
	cp "r$number.wrong" log
	if [ -s log ]; then
		sed 's/^/    /' "r$number.spec" >>log
		result 1 "$row"
	else
		result 0 "$row:$(cut -d : -f 2- "r$number.ran")"
	fi
done <rows

"$covering" refused "$list" >refused || exit 99
number=0
while IFS="$tab" read -r row reason; do
	number=$((number + 1))
	one_of 4 || continue
	# shellcheck disable=SC2086
	"$covering" spec p.spec $row || exit 99
	words=$(words_of p "$row")
	printf '%s\nexpected: %s\n' "$words" "$reason" >log
	# what a message puts in for %d and %s may be anything
	pattern=$(printf '%s' "$reason" | sed 's/[][*?\\]/\\&/g; s/%[ds]/*/g')
	# shellcheck disable=SC2254
	case $words in *$pattern*) good=0 ;; *) good=1 ;; esac
	result $good "$row is refused"
done <refused

"$covering" table "$list" | diff - "$source/doc/combinations.md" >log 2>&1
result $? 'doc/combinations.md is the table of these'
tap_end
