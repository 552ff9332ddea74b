#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# texts.sh OUTPUT FILE ...: the files as C strings in a list of names and texts; of scripts and styles, which pages
# contain, lines without their indentation and, but for the first, without comments. The scripts after load.js stand
# there as one, script.gz, compressed and in base64. A page's policy names its scripts and its style by their sums
# (SHA-256 in base64), which are texts too: load.sum, script.sum, style.sum.
set -eu
output=$1
shift

# text FILE: what is kept of it
text() {
	case $1 in
		*.js | *.css) sed '2,${/^ *\/\*.*\*\/$/d; /^ *\/\*/,/\*\/$/d;}; s/^ *//' "$1" ;;
		*) expand -i -t 4 "$1" ;;       # as emitted C is indented
	esac
}

# sum: of what is read
sum() {
	sha256sum | cut -c 1-64 | sed 's/../0x& /g' | while read -r bytes; do
		for byte in $bytes; do
			# shellcheck disable=SC2059
			printf "\\$(printf %o "$byte")"
		done
	done | base64
}

# script FILE ...
script() {
	for file in "$@"; do
		case $file in */load.js) ;; *.js) text "$file" ;; esac
	done
}

{
	echo '/* made by texts.sh */'
	echo 'static const struct { const char *name, *text; } texts[] = {'
	for file in "$@"; do
		case $file in
			*/load.js) echo "{ \"load.sum\", \"$(text "$file" | sum)\" }," ;;
			*.css) echo "{ \"style.sum\", \"$(text "$file" | sum)\" }," ;;
			*.js) continue ;;
		esac
		echo "{ \"${file##*/}\","
		text "$file" | sed 's/[\\"]/\\&/g; s/^/"/; s/$/\\n"/'
		echo '},'
	done
	echo "{ \"script.sum\", \"$(script "$@" | sum)\" }, { \"script.gz\","
	script "$@" | gzip -9n | base64 | sed 's/.*/"&"/'
	echo '}'
	echo '};'
} >"$output"
