#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# texts.sh OUTPUT FILE ...: the files as C strings in a list of names and texts; of scripts and styles, which pages
# contain, lines without their indentation and, but for the first, without comments. A page's policy names its script
# and its style by their sums (SHA-256 in base64), which are texts too: script.sum, of all scripts in order, style.sum.
set -eu
output=$1
shift

# text FILE: what is kept of it
text() {
	case $1 in
		*.js | *.css) sed '2,${/^ *\/\*.*\*\/$/d; /^ *\/\*/,/\*\/$/d;}; s/^ *//' "$1" ;;
		*) cat "$1" ;;
	esac
}

# sum ENDING FILE ...: of the texts of files with that ending
sum() {
	ending=$1
	shift
	for file in "$@"; do
		[ "${file##*.}" != "$ending" ] || text "$file"
	done | sha256sum | cut -c 1-64 | sed 's/../0x& /g' | while read -r bytes; do
		for byte in $bytes; do
			# shellcheck disable=SC2059
			printf "\\$(printf %o "$byte")"
		done
	done | base64
}

{
	echo '/* made by texts.sh */'
	echo 'static const struct { const char *name, *text; } texts[] = {'
	for file in "$@"; do
		echo "{ \"${file##*/}\","
		text "$file" | sed 's/[\\"]/\\&/g; s/^/"/; s/$/\\n"/'
		echo '},'
	done
	echo "{ \"script.sum\", \"$(sum js "$@")\" }, { \"style.sum\", \"$(sum css "$@")\" }"
	echo '};'
} >"$output"
