#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Words that were given up for those of the field do not come back. As TAP, a case a word.
#
#     words.sh SOURCE_ROOT
#
# A word of the first list is no part of an identifier in gen, runtime and host (parts stand between underscores), nor
# of one that emitted text has, a word of a string with an underscore in it. Words of the second list, `_` between them,
# which have no ordinary meaning that is needed here, stand nowhere: neither in the code and its comments nor on the
# pages. Behind a word stands what is written instead, and files (patterns of paths, from `except` on) that may have it.
set -u
root=$(realpath "$1")
. "${0%/*}/../tap.sh"

cat >identifiers.list <<'END'
anchor refresh
anchored refreshed
anchors refresh
asked request
bank schedule
banks operators
channel force_column
channels force_columns
collide impact
cut split except runtime/host/digits.h
dear expensive
felt friction_force
gate guard
gates guard_rows
gathered folded except gen/step/linear/large.c
grip friction_force
holder constraint
holders constraints
lean tangent
losses truncation_errors
person text
push force_direction
road independent_method except gen/options.c
roads solvers
rubs has_dry_friction
scene assembly
shorten modal_truncation except gen/step/certify/passes.c
shortening modal_truncation
sketch network
speaker written_model
statics static_correction
stretch segment
strike impact
struck impact
survey participation
swift fast_path
tap sample
taps samples
tell report
told reported
unseen unobservable,_unresolved
wave forcing
waves forcings
END
cat >everywhere.list <<'END'
grips friction_forces
kept_less_its_forced_part particular_solution_subtracted
leftover remainder except gen/options.c
leftovers remainder
moves_as_a_whole rigid-body_mode
sag chord_error
stay_clear event-free
stays_clear event-free
sway cubic_error except doc/gallery.md
way_through verified_trajectory
END

# FILE:LINE: WORD of the files that are named, for the words of identifiers.list: comments go, then what is left of a
# string are its words with an underscore
cat >identifiers.awk <<'END'
FILENAME == list { given_up[$1] = 1; next }
FNR == 1 { comment = 0 }
{
	code = ""
	for (line = $0; line != ""; ) {
		if (comment) {
			comment = !(at = index(line, "*/"))
			line = at ? substr(line, at + 2) : ""
		} else if (!match(line, /"([^"\\]|\\.)*"|\/\*|\/\//)) {
			code = code " " line
			line = ""
		} else {
			code = code " " substr(line, 1, RSTART - 1)
			found = substr(line, RSTART, RLENGTH)
			line = substr(line, RSTART + RLENGTH)
			if (found == "//")
				line = ""
			else if (found == "/*")
				comment = 1
			else
				code = code " " joined(found)
		}
	}
	gsub(/[^A-Za-z0-9_]+/, " ", code)
	count = split(tolower(code), part, /[ _]+/)
	for (i = 1; i <= count; i++)
		if (part[i] in given_up)
			print substr(FILENAME, length(root) + 2) ":" FNR ": " part[i]
}

function joined(text, word, words, i, some)
{
	gsub(/\\[a-z]/, " ", text)
	gsub(/[^A-Za-z0-9_]+/, " ", text)
	words = split(text, word, " ")
	for (i = 1; i <= words; i++)
		some = some (word[i] ~ /_/ ? " " word[i] : "")
	return some
}
END
# The same for the words of everywhere.list, wherever they stand
cat >everywhere.awk <<'END'
FILENAME == list { given_up[$1] = 1; next }
{
	text = "_" tolower($0) "_"
	gsub(/[^a-z0-9]+/, "_", text)
	for (word in given_up)
		if (index(text, "_" word "_"))
			print substr(FILENAME, length(root) + 2) ":" FNR ": " word
}
END

# judge LIST FOUND: a case for each word of LIST, of which FOUND tells where it stands
judge() {
	while read -r word instead but; do
		grep " $word\$" "$2" >log
		set -f
		for file in ${but#except}; do
			grep -v "^$file:" log >less
			mv less log
		done
		set +f
		[ ! -s log ]
		result $? "$word: $(echo "$instead" | tr _ ' ') is written instead"
	done <"$1"
}

# search KIND FILE ...: where words of KIND.list stand in those files, to KIND.found
search() {
	kind=$1
	shift
	awk -v root="$root" -v list="$kind.list" -f "$kind.awk" "$kind.list" "$@" >"$kind.found" ||
		echo "not all was read: 0: $(head -n 1 "$kind.list" | cut -d ' ' -f 1)" >>"$kind.found"
}

find "$root/gen" "$root/runtime" "$root/host" -name '*.[ch]' | sort >code
find "$root/README.md" "$root/doc" -name '*.md' | sort >pages
# what finds nothing because it reads nothing is no test: each word of a file that has them all, in each of three places
{
	sed 's/ .*//; s/.*/int a_&_b;/' identifiers.list
	# shellcheck disable=SC2016
	sed 's/ .*//; s/.*/say("a $n_& b");/' identifiers.list
	sed 's/ .*//; s/.*/\/* & *\/ say("&");/' identifiers.list
} >sample.c
sed 's/ .*//; s/.*/ * the &, as it was/; s/_/ /g' everywhere.list >sample.md
search identifiers sample.c
search everywhere sample.md
[ "$(wc -l <identifiers.found)" -eq $((2 * $(wc -l <identifiers.list))) ] &&
	[ "$(wc -l <everywhere.found)" -eq "$(wc -l <everywhere.list)" ]
result $? 'each word is found where it stands in an identifier or in emitted text, not in a comment or a message'
# shellcheck disable=SC2046
search identifiers $(cat code)
# shellcheck disable=SC2046
search everywhere $(cat code pages)
judge identifiers.list identifiers.found
judge everywhere.list everywhere.found
tap_end
