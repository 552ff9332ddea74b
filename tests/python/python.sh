#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# plgen.py: runs, params, copies and messages beside plmain.c; its state space beside SciPy.
#
#     python.sh PLGEN SOURCE_ROOT
here=$(cd "${0%/*}" && pwd) || exit 99
python=
for one in python3 /usr/bin/python3; do         # the distribution's may not be the first in PATH
	[ -n "$python" ] || ! "$one" -c 'import numpy' 2>/dev/null || python=$one
done
. "$here/begin.sh"
if [ -z "$python" ]; then
	skip python 'no python3-numpy'
	tap_end
fi
prepare
PYTHONPATH=$root/host/python PYTHONDONTWRITEBYTECODE=1 "$python" -W error "$here/told.py" "$root" >told 2>&1 || cat told
grep -v '^good\|^bad\|^skip' told >log
while read -r how name; do
	case $how in
		good) result 0 "$name" ;;
		bad) result 1 "$name" ;;
		skip) skip "${name%%: *}" "${name#*: }" ;;
	esac
done <told
[ "$(tail -n 1 told)" = 'end' ]
result $? 'the script came to its end'

# What a status means is said in the same words everywhere.
sed -n 's/.*fprintf(stderr, " \(\(the\|what\|a\) [^%"]*\).*/\1/p' "$root/runtime/host/plmain.c" >words
: >log
[ "$(wc -l <words)" -eq "$(grep -c 'if (status & PL_' "$root/runtime/host/plmain.c")" ] || cp words log
while read -r words; do
	for file in python/plgen.py octave/plgen_model.m; do
		grep -q "$words" "$root/host/$file" || echo "$file: no '$words'" >>log
	done
done <words
[ -s words ] && [ ! -s log ]
result $? "a status of $(wc -l <words) kinds is told as plmain.c does"
tap_end
