#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The package plgen: runs, params, copies and messages beside plmain.c; its state space beside SciPy.
#
#     python.sh PLGEN SOURCE_ROOT [wheel]         wheel: installed by pip into an environment of its own, and run there
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
if [ "${3:-}" = wheel ]; then
	if ! "$python" -c 'import setuptools, pip, venv, wheel' 2>log; then
		skip wheel 'no python3-pip, python3-venv, python3-setuptools or python3-wheel'
		tap_end
	fi
	mkdir -p tree/host empty "an environment" && cp -R "$root/runtime" "$root/meson.build" "$root/LICENSE" tree/ &&
		cp -R "$root/host/python" tree/host/ &&
		"$python" -m venv --system-site-packages --without-pip "an environment" >log 2>&1 &&
		PLGEN_BUILD=${PLGEN%/*} "an environment/bin/python" -m pip install --no-build-isolation --no-index \
			--no-deps tree/host/python >log 2>&1
	result $? 'pip installs it without a network'
	rm -rf tree
	: >held.csv
	runtime_archive "$root/runtime"
	rows alone "$root/models/sdcsf.spec" 5 --
	unset PLGEN PLGEN_RUNTIME
	cp "$root/models/sdcsf.spec" empty/ || exit 99
	cat >see.py <<-'X'
		import os
		import numpy as np
		import plgen
		m = plgen.Model('sdcsf.spec')
		rows = np.fromfile('../alone.rows').reshape(-1, len(m.outputs) + 1)
		print(np.array_equal(m.run(500), rows[:, 1:]), 'environment' in plgen.__file__)
		print(plgen._code.find_plgen()[-15:], os.path.exists(plgen.__file__.replace('__init__.py', 'py.typed')))
	X
	(cd empty && "../an environment/bin/python" -W error ../see.py) >seen 2>&1
	printf 'True True\nplgen/bin/plgen True\n' | diff - seen >log
	result $? 'a model runs from an empty folder, with the rows of plmain.c, by the plgen and the runtime inside'
	"an environment/bin/plrun" empty/sdcsf.spec 1 >rows.csv 2>log && [ "$(wc -l <rows.csv)" -eq 102 ] &&
		"an environment/bin/plgen" empty/sdcsf.spec >made.c 2>>log && [ -s made.c ]
	result $? 'the commands plgen and plrun of the environment'
	if command -v mypy >/dev/null 2>&1; then
		(cd "$root/host/python" &&
			mypy --check-untyped-defs --ignore-missing-imports --cache-dir "$work/types" plgen) >log 2>&1
		result $? 'its types agree'
	else
		skip types 'mypy is not installed'
	fi
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
sed -n 's/.*fprintf(stderr, " \(\(the\|what\|no\|a\) [^%"]*\).*/\1/p' "$root/runtime/host/plmain.c" >words
: >log
[ "$(wc -l <words)" -eq "$(grep -c 'if (status & PL_' "$root/runtime/host/plmain.c")" ] || cp words log
while read -r words; do
	for file in python/plgen/_code.py octave/plgen_model.m; do
		grep -q "$words" "$root/host/$file" || echo "$file: no '$words'" >>log
	done
done <words
[ -s words ] && [ ! -s log ]
result $? "a status of $(wc -l <words) kinds is told as plmain.c does"
tap_end
