#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# texts.sh OUTPUT FILE ...: the files as C strings in a list of names and texts; of scripts and styles, which pages
# contain, lines without their indentation and, but for the first, without comments.
set -eu
output=$1
shift
{
	echo '/* made by texts.sh */'
	echo 'static const struct { const char *name, *text; } texts[] = {'
	for file in "$@"; do
		echo "{ \"${file##*/}\","
		case $file in
			*.js | *.css) less='2,${/^ *\/\*.*\*\/$/d; /^ *\/\*/,/\*\/$/d;}; s/^ *//' ;;
			*) less= ;;
		esac
		sed "$less"'; s/[\\"]/\\&/g; s/^/"/; s/$/\\n"/' "$file"
		echo '},'
	done
	echo '};'
} >"$output"
