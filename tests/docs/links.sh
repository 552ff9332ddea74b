#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What the pages name is there: files and headings that they link to, targets of the Makefile, and what makes a figure
# of the README. As TAP.
#
#     links.sh SOURCE_ROOT BUILD_ROOT
set -u
root=$(realpath "$1")
build=$(realpath "$2")
. "${0%/*}/../tap.sh"

# The anchors of a page: of headings as GitHub makes them, of HTML the ids
cat >anchors.awk <<'END'
{
	if ($0 ~ /^```/)
		inside = !inside
	if (!inside && $0 ~ /^#+ /) {
		anchor = tolower($0)
		sub(/^#+ */, "", anchor)
		gsub(/[^a-z0-9 _-]/, "", anchor)
		gsub(/ /, "-", anchor)
		print anchor
	}
	for (rest = $0; match(rest, / id="[^"]*"/); rest = substr(rest, RSTART + RLENGTH))
		print substr(rest, RSTART + 5, RLENGTH - 6)
}
END

# links PAGE: TARGET of each [..](TARGET), one a line
links() {
	awk '/^```/ { inside = !inside }
		!inside { for (rest = $0; match(rest, /\]\([^)]*\)/); rest = substr(rest, RSTART + RLENGTH))
			print substr(rest, RSTART + 2, RLENGTH - 3) }' "$1"
}

# follow PAGE: what its links miss goes to `log`
follow() {
	links "$root/$1" >targets
	while read -r target; do
		file=${target%%#*}
		path=$root/$1
		[ -z "$file" ] || path=$(dirname "$path")/$file
		case $target in
			http*) continue ;;
			*'#'*)
				[ -f "$path" ] && awk -f anchors.awk "$path" | grep -qx -e "${target#*#}" ||
					echo "$1: no heading for $target" >>log ;;
			*) [ -e "$path" ] || echo "$1: no file $target" >>log ;;
		esac
	done <targets
}

# A name in code, `make X`: of the target X
made() {
	sed -n 's/^\([a-z][a-z -]*\):.*/\1/p' "$root/Makefile" | tr ' ' '\n' | sort -u >there
	grep -o '`make [a-z][a-z-]*`' "$root/$1" | sed 's/`make \(.*\)`/\1/' | sort -u | comm -23 - there |
		sed "s,.*,$1: no target & in the Makefile," >>log
}

for page in README.md $(cd "$root" && ls doc/*.md); do
	: >log
	follow "$page"
	[ ! -s log ]
	result $? "$page: $(wc -l <targets) links lead somewhere"
	: >log
	made "$page"
	[ ! -s log ]
	result $? "$page: targets of make are there"
done

# The gallery has every model, its picture and tests that there are
tr ',' '\n' <"$build/meson-info/intro-tests.json" | sed -n 's/.*"name": "\([^"]*\)".*/\1/p' | sort -u >tests
: >log
for spec in "$root"/models/*.spec; do
	name=$(basename "$spec" .spec)
	picture=$root/doc/gallery/$name.svg
	grep -qF "![$name](gallery/$name.svg)" "$root/doc/gallery.md" || echo "$name is not in doc/gallery.md" >>log
	if [ ! -f "$picture" ] || ! grep -q '<path' "$picture"; then
		echo "$name: no picture" >>log
	elif [ "$(wc -c <"$picture")" -gt 61440 ]; then
		echo "$name: the picture is larger than 60 KiB" >>log
	fi
done
for picture in "$root"/doc/gallery/*; do
	case $picture in
		*/pages_*.webp)
			grep -qF "](gallery/${picture##*/})" "$root/doc/page.md" || echo "$picture: in no page" >>log
			continue ;;
	esac
	[ -f "$root/models/$(basename "$picture" .svg).spec" ] || echo "$picture: of no model" >>log
done
sed -n '/^## /,$p' "$root/doc/gallery.md" | grep -o '`[a-z0-9_]*`' | tr -d '`' | sort -u >named
comm -23 named tests | sed 's/$/ is no test/' >>log
[ "$(wc -l <named)" -gt 15 ] && [ ! -s log ]
result $? "doc/gallery.md: $(ls "$root"/models/*.spec | wc -l) models, $(wc -l <named) tests"

# The last column of the table of figures: `make X`, a program of the build with its arguments, or a test.
sed -n '/^## Figures/,$s/^|.*| `\([^`]*\)` |$/\1/p' "$root/README.md" >figures
: >log
while read -r first rest; do
	case $first in
		make) continue ;;
		build/*) grep -q -e "build ${first#build/}:" "$build/build.ninja" ;;
		*) grep -qx -e "$first" tests ;;
	esac || echo "nothing makes this figure: $first $rest" >>log
done <figures
[ "$(grep -c . figures)" -ge 10 ] || echo 'the table of figures is not found' >>log
[ ! -s log ]
result $? "$(wc -l <figures) figures of the README have what makes them"

[ "$(wc -l <"$root/README.md")" -le 100 ] && ! tr -d '\200-\277' <"$root/README.md" | grep -n '.\{111\}' >log
result $? 'README.md: at most 100 lines of at most 110 columns'
tap_end
