#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What is installed: all of it, under the prefix that is asked for, without a word of where it was built.
#
#     files.sh BUILD SOURCE_ROOT
set -u
build=$(cd "$1" && pwd) || exit 99
root=$(cd "$2" && pwd) || exit 99
. "${0%/*}/../tap.sh"
. "$root/tests/run_cc.sh"
. "$root/tests/install/stage.sh"

: >log
for file in bin/plgen bin/plrun share/man/man1/plgen.1 share/man/man1/plrun.1 share/plgen/models/sdcsf.spec \
	share/plgen/runtime/host/plmain.c share/plgen/parts/road_iso8608.spec \
	share/plgen/vscode/package.json share/vim/vimfiles/syntax/plgen.vim \
	share/bash-completion/completions/plgen share/bash-completion/completions/plrun \
	share/zsh/site-functions/_plgen share/doc/plgen/spec.md share/doc/plgen/contacts.md \
	share/doc/plgen/schemes.md share/doc/plgen/api.md share/doc/plgen/install.md share/doc/plgen/LICENSE; do
	[ -s "$prefix/$file" ] || echo "$file is missing" >>log
done
for file in libplrt.a pkgconfig/plgen.pc cmake/plgen/plgenConfig.cmake cmake/plgen/plgenConfigVersion.cmake; do
	[ -s "$libdir/$file" ] || echo "$file is missing" >>log
done
[ ! -s log ]
result $? 'commands, pages, library, models and packages'
diff -r "$source/models" "$prefix/share/plgen/models" >log &&
	diff -r "$source/runtime" "$prefix/share/plgen/runtime" >>log
result $? 'runtime and models are those of the sources, and all'

grep -r -l -e "$source" -e "$work" "$prefix" >found
sed "s,$prefix/,,; s,^.*libplrt.a,libplrt.a," found | grep -v -x bin/plrun >log
[ ! -s log ]
result $? 'nothing that is installed names the folder of the sources, or its place before it was moved'

# Found from the program itself, and by the environment
: >log
[ "$(plgen --runtime-dir)" = "$(realpath "$prefix/share/plgen/runtime")" ] || plgen --runtime-dir >>log 2>&1
ln -s "$prefix/bin/plgen" "$work/linked"
[ "$("$work/linked" --runtime-dir)" = "$(plgen --runtime-dir)" ] || echo 'not through a link' >>log
[ "$(PLGEN_RUNTIME=$source/runtime plgen --runtime-dir)" = "$(realpath "$source/runtime")" ] ||
	echo 'not what PLGEN_RUNTIME names' >>log
[ ! -s log ]
result $? '--runtime-dir: from the program, through a link, by the environment'
mv "$prefix/share/plgen/runtime" "$prefix/share/plgen/away"
plgen --runtime-dir >out 2>log
status=$?
if [ -f /usr/local/share/plgen/runtime/plrt.h ]; then
	skip '--runtime-dir: without a runtime' 'one is installed in /usr/local'
else
	[ $status -eq 1 ] && [ ! -s out ] && grep -q 'PLGEN_RUNTIME names its folder' log
	result $? '--runtime-dir: without a runtime it says what names one'
fi
mv "$prefix/share/plgen/away" "$prefix/share/plgen/runtime"

# The same bytes wherever it is
"$build/plgen" --bundle "$source/models/sdcsf.spec" >built.c 2>log
plgen --bundle "$prefix/share/plgen/models/sdcsf.spec" >moved.c 2>>log
cmp built.c moved.c >>log 2>&1 && [ -s built.c ]
result $? 'a bundle has the same bytes from the build and from what is installed'
CC=${run_cc%% *} XDG_CACHE_HOME=$work/cache plrun "$prefix/share/plgen/models/scs.spec" 1 >out 2>log &&
	[ "$(wc -l <out)" -gt 10 ]
result $? 'plrun runs'

# A chart of any model, by the sources of other solvers that are installed; without a word of the source tree
mkdir elsewhere bare
cat >'elsewhere/my own.spec' <<'END'
model own
coord x "mm"
init x = 10 "mm"
(2 "kg")*x'' + (20 "N s/m")*x' + (18 "kN/m")*x = 0
step 1 "ms"
END
if command -v gnuplot >/dev/null; then
	(cd elsewhere && CHARTS_OPTIMIZE=-O0 plrun --chart 'my own.spec' 0.2 -o 'a chart') >out 2>log
	[ $? -eq 0 ] && [ "$(grep -c '^error below 1e-[0-9]*: ' out)" -eq 4 ] &&
		grep -q '</svg>' 'elsewhere/a chart/own.svg'
	result $? 'plrun --chart: a picture and a verdict for each wanted error'
	for method in exact DOP853 RADAU5 RADAU9 'GSL rk8pd' 'CVODE BDF'; do
		awk -F, -v method="\"$method\"" '$1 == method && $6 == "ok" && $5 < (method ~ /exact/ ? 1e-13 : 1e-2) {
			good++ } END { exit !good }' 'elsewhere/a chart/own.csv' || echo "$method: no row is near"
	done >log
	[ ! -s log ]
	result $? 'plrun --chart: the solvers of the charts'
else
	skip 'plrun --chart' 'no gnuplot'
fi
printf '#!/bin/sh\nexit 1\n' >bare/cc
chmod +x bare/cc
CC=$PWD/bare/cc plrun --chart 'elsewhere/my own.spec' 1 >out 2>log
[ $? -eq 1 ] && [ ! -s out ] && grep -q '^chart: not installed: gcc libsundials-dev libgsl-dev' log
result $? 'plrun --chart: what is not installed is named'
mv "$prefix/share/plgen/charts" "$prefix/share/plgen/away"
plrun --chart 'elsewhere/my own.spec' 1 >out 2>log
[ $? -eq 1 ] && grep -q 'own.sh. is not there: install plgen with its charts' log
result $? 'plrun --chart: without the charts it says so'
mv "$prefix/share/plgen/away" "$prefix/share/plgen/charts"
tap_end
