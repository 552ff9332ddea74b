#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What is compiled, when, and where it is kept.
#
#     cache.sh PLRUN PLGEN SOURCE_ROOT
. "${0%/*}/begin.sh"
# The runtime without what is most of its code, which none of these models needs
cp -r "$root/runtime" runtime
for name in guards guards_compensated guards_d events crossings crossings_compensated crossings_d region event_split \
	crossings_compensated_d guards_compensated_d peak dense; do
	rm runtime/$name.c runtime/${name}f.c
done
PLGEN_RUNTIME=$work/runtime
export PLGEN_RUNTIME
compiler=$(command -v tcc || command -v gcc || command -v cc)
mkdir 'a folder with blanks' tools
cat >'tools/my cc' <<X
#!/bin/sh
echo run >>"$work/compiled"
exec "$compiler" "\$@"
X
chmod +x 'tools/my cc'
cp 'tools/my cc' tools/cc
: >compiled
compiled() { wc -l <"$work/compiled" | tr -d ' '; }

run "$models/scs.spec" 0.1 >plain.csv
cp "$models/scs.spec" 'a folder with blanks/my scs.spec'
XDG_CACHE_HOME=$work/'a folder with blanks/ca che'
CC=$work/'tools/my cc'
export XDG_CACHE_HOME CC
run 'a folder with blanks/my scs.spec' 0.1 -o 'a folder with blanks/o ut.csv'
same plain.csv 'a folder with blanks/o ut.csv' 'blanks in every path'
before=$(compiled)
[ "$before" -eq 2 ]
result $? 'the runtime once, and the model'
run 'a folder with blanks/my scs.spec' 0.2 >out.csv && [ "$(compiled)" -eq "$before" ]
result $? 'what is in the cache is not compiled again'
run "$models/scs.spec" 0.2 -D k2=70 >out.csv && [ "$(compiled)" -eq $((before + 1)) ]
result $? 'another param is another model'
run "$models/oscillator.spec" 1 --input "$root/LICENSE" >out.csv
cat >free.spec <<'X'
model swing
param k = 4, c = 0.1
tunable k
coord x
x'' + c*x' + k*x = 0
init x = 1
step 0.1
X
run free.spec 1 >out.csv
before=$(compiled)
run free.spec 1 -D k=9 >tuned.csv && [ "$(compiled)" -eq "$before" ] && ! cmp -s out.csv tuned.csv
result $? 'a tunable param is changed without compiling'
run free.spec 1 -D k=9 -D c=0 >both.csv && [ "$(compiled)" -eq $((before + 1)) ]
awk -F, 'NR > 1 { d = $2 - cos(3 * $1); if (d * d > 1e-26) bad = 1 } END { exit bad || NR != 12 }' both.csv
result $? 'a tunable one and another: cos 3 t within 1e-13'
CFLAGS='-O0 -g' run free.spec 1 >out.csv && [ "$(compiled)" -eq $((before + 3)) ]
result $? 'other flags compile anew'

for file in "$XDG_CACHE_HOME"/plgen/scs-*.so; do : >"$file"; done
run "$models/scs.spec" 0.1 >out.csv
same plain.csv out.csv 'an object that a crash has cut off is made anew'

rm -rf "$XDG_CACHE_HOME"
for i in 1 2 3; do "$plrun" "$models/scs.spec" 0.1 >"par$i.csv" 2>>log & done
wait
cmp plain.csv par1.csv >>log && cmp plain.csv par2.csv >>log && cmp plain.csv par3.csv >>log
result $? 'three at a time in an empty cache'
! ls -d "$XDG_CACHE_HOME"/plgen/making.* >/dev/null 2>&1
result $? 'nothing else stays there'

mkdir -p "$XDG_CACHE_HOME/plgen/making.old" "$XDG_CACHE_HOME/plgen/making.new"
: >"$XDG_CACHE_HOME/plgen/making.old/model.c"
touch -d '3 days ago' "$XDG_CACHE_HOME/plgen/making.old"
CC="$work/tools/cc -pipe"
run "$models/scs.spec" 0.1 >out.csv
same plain.csv out.csv 'a compiler of two words'
[ ! -d "$XDG_CACHE_HOME/plgen/making.old" ] && [ -d "$XDG_CACHE_HOME/plgen/making.new" ]
result $? 'what a killed run has left goes after a day'
CC=none-such run "$models/scs.spec" 0.1 >out.csv
[ $? -eq 1 ] && grep -q "there is no compiler 'none-such'; CC names another" said
result $? 'no compiler'
CC=false run "$models/scs.spec" 0.1 >out.csv
[ $? -eq 1 ] && grep -q "the compiler 'false' could not make a program of the model" said
result $? 'a compiler that fails'
unset CC
(PLGEN=none-such; run "$models/scs.spec" 0.1 >out.csv; [ $? -eq 1 ] && grep -q "cannot run 'none-such'" said)
result $? 'no plgen'
mkdir beside && ln -s "$PLGEN" beside/plgen && cp "$plrun" beside/plrun
(unset PLGEN; PATH=/usr/bin:/bin
	beside/plrun "$models/scs.spec" 0.1 >out.csv 2>log)
same plain.csv out.csv 'plgen beside plrun'
cp "$work/tools/my cc" tools/linker && sed -i '$s/.*/exec gcc "$@"/' tools/linker
# of what stands beside plrun: the library, and what is compiled for its run
archive() {
	rm -rf "$XDG_CACHE_HOME"
	before=$(compiled)
	(unset PLGEN PLGEN_RUNTIME CFLAGS; CC=$work/tools/linker beside/plrun "$models/scs.spec" 0.1 >out.csv 2>>log) &&
		[ "$(compiled)" -eq $((before + $1)) ] && cmp plain.csv out.csv >>log 2>&1
}
mkdir -p objects && (cd objects && for c in ../runtime/*.c; do gcc -fPIC -c -I../runtime "$c"; done &&
	ar rc ../beside/libplrt.a ./*.o)
archive 1
result $? 'a runtime that is compiled beforehand is linked'
touch runtime/phases.c
archive 2
result $? '... not where it is older than its sources'
: >beside/libplrt.a
archive 3
result $? '... and compiled where it does not link'
rm beside/libplrt.a

cp -r runtime later && sed -i 's/PL_MODEL_VERSION = [0-9]*/PL_MODEL_VERSION = 99/' later/plrt.h
PLGEN_RUNTIME=$work/later run "$models/scs.spec" 0.1 >out.csv
[ $? -eq 1 ] && grep -q 'its descriptor has version 99, and this plrun reads version [0-9]*$' said && [ ! -s out.csv ]
result $? 'a descriptor of another version'
if [ "$(id -u)" != 0 ]; then
	mkdir sealed && chmod a-w sealed
	XDG_CACHE_HOME=$work/sealed run "$models/scs.spec" 0.1 >out.csv
	[ $? -eq 1 ] && grep -q 'cannot make the folder' said
	result $? 'a cache that cannot be written'
else
	XDG_CACHE_HOME=/dev/null/x run "$models/scs.spec" 0.1 >out.csv
	[ $? -eq 1 ] && grep -q "cannot make the folder '/dev/null" said
	result $? 'a cache that cannot be written'
fi
tap_end
