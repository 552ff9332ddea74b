#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# No line of what people read and write is longer than 120 columns, in characters, a tab as up to 8. As TAP, a case a
# folder; all that is kept is below 12 MB, so that no table of megabytes comes back; and pages stay short.
#
#     lines.sh SOURCE_ROOT
#
# Not looked at: what programs write (doc/charts, doc/gallery, doc/combinations.md, *.csv) or read as data
# (*.list, *.mtx, *.txt of tests), and cases of tests/errors and tests/fuzz, where a line may be what is tested.
set -u
root=$(realpath "$1")
. "${0%/*}/../tap.sh"

# Those lines, as FILE:LINE: COLUMNS; a character is a byte that continues no other
cat >long.awk <<'END'
{
	gsub(/[\200-\277]/, "")
	count = split($0, part, "\t")
	width = 0
	for (i = 1; i <= count; i++)
		width += length(part[i]) + (i < count ? 8 - (width + length(part[i])) % 8 : 0)
	if (width > 120)
		print substr(FILENAME, length(root) + 2) ":" FNR ": " width " columns"
}
END

# look NAME FOLDER TESTS_OF_FIND ...
look() {
	name=$1
	folder=$2
	shift 2
	find "$root/$folder" -type f "$@" | sort >files
	tr '\n' '\0' <files | xargs -0 awk -v root="$root" -f long.awk >log || echo 'not all was read' >>log
	[ -s files ] && [ ! -s log ]
	result $? "$name: $(wc -l <files) files, $(wc -l <log) lines over 120 columns"
}

code='-name *.c -o -name *.h -o -name *.in -o -name *.sh -o -name *.awk -o -name *.gp -o -name *.build -o -name *.ld'
set -f
look gen gen
look host host
look runtime runtime
look share share
look bench bench ! -name '*.list' ! -name '*.csv'
# shellcheck disable=SC2086
look tests tests '(' $code ')'
look specs tests '(' -name '*.spec' -o -name specs.cases -o -name orders.cases ')' ! -path '*/tests/fuzz/*'
look doc doc ! -path '*/doc/charts/*' ! -path '*/doc/gallery/*' ! -name '*.csv' ! -name combinations.md
look top . -maxdepth 1 '(' -name '*.md' -o -name Makefile -o -name meson.build ')'
name='what git keeps is below 12000000 bytes'
git -C "$root" ls-files -z >files 2>log
if [ -s files ]; then
	(cd "$root" && xargs -0 cat) <files | wc -c >bytes
	[ "$(cat bytes)" -lt 12000000 ]
	result $? "$name: $(cat bytes)"
	words=$(cd "$root" && git ls-files '*.md' '*.1' | xargs cat | tr -s ' \t\n' '\n' | grep -c '[A-Za-z0-9]')
	[ "$words" -gt 1000 ] && [ "$words" -le 40000 ] 2>log
	result $? "pages and man pages have at most 40000 words: $words"
else
	skip "$name" 'not a working copy of git'
fi
tap_end
