#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# plgen_model.m and plgen_mex.c in Octave, beside the rows of plmain.c.
#
#     octave.sh PLGEN SOURCE_ROOT
here=$(cd "${0%/*}" && pwd) || exit 99
. "$here/begin.sh"
CC=$cc_given            # mkoctfile links with what CC names
export CC
if ! command -v octave-cli >/dev/null 2>&1 || ! command -v mkoctfile >/dev/null 2>&1; then
	skip octave 'no octave, or no octave-dev'
	tap_end
fi
CFLAGS='-O2 -Wall -Wextra' mkoctfile --mex -I"$root/runtime" -o plgen_mex.mex \
	"$root/host/octave/plgen_mex.c" >log 2>&1 && ! [ -s log ]
result $? 'the MEX file compiles without warnings'
prepare
octave-cli --no-init-file --path "$root/host/octave" "$here/told.m" "$root" >told 2>&1 || cat told
grep -v '^good\|^bad\|^skip' told >log
while read -r how name; do
	case $how in
		good) result 0 "$name" ;;
		bad) result 1 "$name" ;;
		skip) skip "${name%%: *}" "${name#*: }" ;;
	esac
done <told
grep -q '^end$' told
result $? 'the script came to its end'
tap_end
