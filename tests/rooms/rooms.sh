#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# rooms.sh SOURCE_ROOT LIBRARY PLGEN: who may call whom in the generator, read from the objects of its library, from
# those that stand beside the program, and from its headers.
set -u
root=$(cd "$1" && pwd) || exit 99
listing=$(nm -A "$2" "$3".p/*.o)
. "$root/tests/tap.sh"
rooms='base math read collect tape model step report emit run fmu'
printf '%s\n' "$listing" >listing

# judge LISTING PATTERN NAME: no line of the pattern may come out
judge() {
	awk -v rooms="$rooms" -f "$root/tests/rooms/calls.awk" "$1" >found
	grep -E "$2" found | LC_ALL=C sort >log
	[ ! -s log ]
	result $? "$3"
}

# notices LISTING PATTERN NAME: one must
notices() {
	awk -v rooms="$rooms" -f "$root/tests/rooms/calls.awk" "$1" >found
	cp found log
	grep -qE "$2" found
	result $? "$3"
}

judge listing '^upwards|^nothing' 'no call from a room to a later one'
judge listing '^circle|^nothing' 'no circle of files'

# The test itself: calls that are not there, as nm would list them
{ cat listing; echo 'libgen.a:gen_math_poly.c.o:                 U emit_code'; } >upwards
notices upwards '^upwards: math/poly calls emit_code' 'a call upwards is noticed'
{ cat listing; echo 'libgen.a:gen_base_source.c.o:                 U lex_next'; } >circle
notices circle '^circle: read/lex calls|^circle: base/source calls' 'a circle of two files is noticed'

# A room's headers and files name headers of rooms before it and its own, and of the runtime (host).
before=''
: >log
for room in $rooms; do
	before="$before $room"
	[ -f "$root/gen/$room/$room.h" ] || echo "gen/$room/$room.h is missing" >>log
	files=$(find "$root/gen/$room" -name '*.[ch]')
	for header in $(sed -n 's/^#include "\([a-z_]*\)\/[a-z_/]*\.h".*/\1/p' $files | sort -u); do
		case " host $before " in
		*" $header "*) ;;
		*) echo "gen/$room includes a header of gen/$header" >>log ;;
		esac
	done
done
[ ! -s log ]
result $? 'no header of a later room'

# A folder of a room has what only its own files call in inner.h, which no other file of gen includes.
cp listing walled
(cd "$root" && grep -r '^#include "[a-z]*/[a-z]*/[a-z_]*\.h"' gen tests --include='*.[ch]') |
	sed 's|:#include "\([^"]*\)".*| \1|' >includes
: >included
for header in $(cd "$root/gen" && find . -mindepth 3 -name '*.h' | sed 's/^..//' | LC_ALL=C sort); do
	folder=${header%/*}
	awk -v header="$header" -v inside="gen/$folder/" '$2 == header && index($1, inside) != 1' includes >outside
	case $header in
	*/inner.h) grep '^gen/' outside >>included ;;
	*) [ ! -s outside ] || grep -o '\<[a-z_0-9]*(' "$root/gen/$header" |
		sed "s|^\(.*\)($|declares $folder $header \1|" >>walled ;;
	esac
done
judge walled '^wall' 'what a folder alone calls is private to it'
cp included log
[ ! -s included ]
result $? 'no inner header is included from outside'
{ cat walled; echo 'declares step/linear step/linear/forms.h leave_out_refresh'; } >wall
notices wall '^wall: step/linear/forms.h declares leave_out_refresh' 'what stands before the wall is noticed'

# Numbers are rounded before they are printed.
grep 'gen_emit_' listing | grep -E ' U (mpfr|mpfi)_' | sed 's/^.*gen_emit_/emit\//' >log
grep -q 'gen_emit_' listing && [ ! -s log ]
result $? 'emit refers to no name of MPFR or MPFI'
tap_end
