#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# picture.sh NAME FOLDER OUTDIR [narrow]: the picture NAME, a section of pictures.gp or maps.gp, of the tables in
# FOLDER: OUTDIR/NAME.svg and .png, or more of that name; narrow: for a screen of 400 pixels, NAME_narrow.svg alone.
# picture.sh --list FOLDER: NAME, and `NAME narrow` where there is that, of the pictures whose tables are there.
set -e
here=$(dirname "$(realpath "$0")")
if [ "$1" = --list ]; then
	sed -n 's/^=== \([^:]*\): \(.*\)/\1 \2/p' "$here/pictures.gp" "$here/maps.gp" | while read -r name tables; do
		for table in ${tables%narrow}; do
			[ -f "$2/$table" ] || continue 2
		done
		echo "$name"
		[ "$tables" = "${tables%narrow}" ] || echo "$name narrow"
	done
	exit 0
fi
table=$(sed -n "s/^=== $1: \([^ ]*\).*/\1/p" "$here/pictures.gp" "$here/maps.gp")
{
	echo "here = '$here'; folder = '$2'; out = '$3'; narrow = 0${4:+1}; name = '$1'; csv = folder.'/$table'"
	echo "load here.'/style.gp'"
	awk -v head="$1:" '$1 == "===" { on = $2 == head; next } on' "$here/pictures.gp" "$here/maps.gp"
} | gnuplot
