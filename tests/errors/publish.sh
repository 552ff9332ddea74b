#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# publish.sh PLGEN SPEC: what reaches files and standard output, and what is left when it cannot. SPEC is a good model.
set -u
plgen=$(realpath "$1")
spec=$(realpath "$2")
runtime=$(cd "${0%/*}/../../runtime" && pwd) || exit 1
LC_ALL=C
export LC_ALL
work=$(mktemp -d) || exit 1
trap 'chmod -R u+w "$work"; rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
cd "$work" || exit 1
cp "$spec" model.spec
umask 022

number=0
failed=0
why=

result()        # NAME: `why` holds what is wrong
{
	number=$((number + 1))
	if [ -z "$why" ]; then
		echo "ok $number - $1"
	else
		failed=$((failed + 1))
		echo "not ok $number - $1"
		echo "$why" | tr '\001-\010\013-\037\177-\377' '?' | sed '/^$/d; s/^/# /'
	fi
	why=
}

skip()          # NAME REASON
{
	number=$((number + 1))
	echo "ok $number - $1 # SKIP $2"
}

wrong()
{
	why="$why
$1"
}

run()           # the command's output goes to out and err
{
	"$@" > "$work/out" 2> "$work/err" < /dev/null
	status=$?
}

need_status()
{
	[ "$status" -eq "$1" ] || wrong "exit status $status, expected $1; standard error: $(head -n 3 "$work/err")"
}

need_message()  # TEXT: a part of standard error, at the head of a line
{
	grep -q "^$1" "$work/err" || wrong "standard error has no '$1': $(head -n 3 "$work/err")"
}

need_silence()
{
	[ -s "$work/err" ] && wrong "standard error is not empty: $(head -n 3 "$work/err")"
}

need_text()     # FILE TEXT
{
	[ "$(cat "$1" 2>&1)" = "$2" ] || wrong "$1 is not as it was: $(head -n 2 "$1" 2>&1)"
}

need_same()     # A B
{
	cmp "$1" "$2" > "$work/cmp" 2>&1 || wrong "$1 and $2 differ: $(cat "$work/cmp")"
}

need_files()    # FOLDER LIST: nothing half-written, no temporaries
{
	found=$(ls -A "$1" | tr '\n' ' ')
	[ "$found" = "$2${2:+ }" ] || wrong "files in $1: $found, expected $2"
}

echo "1..41"

# ---- a full disk ----

full()          # NAME OPTIONS...
{
	name=$1
	shift
	if ! [ -c /dev/full ]; then
		skip "$name" "no /dev/full"
		return
	fi
	"$plgen" "$@" > /dev/full 2> "$work/err" < /dev/null
	status=$?
	need_status 1
	need_message 'standard output: error: cannot write: \|plgen: error: cannot write to standard output: '
	[ "$(wc -l < "$work/err")" -eq 1 ] || wrong "not told once: $(cat "$work/err")"
	result "$name"
}

full 'full disk: C' model.spec
full 'full disk: --header' --header model.spec
full 'full disk: --explain' --explain model.spec
full 'full disk: --explain=json' --explain=json model.spec
full 'full disk: --solution' --solution 1 model.spec
full 'full disk: --help' --help
full 'full disk: --version' --version

if [ -c /dev/full ]; then
	run "$plgen" --header -o /dev/full model.spec
	need_status 1
	need_message '/dev/full: error: cannot write: '
	result 'full disk: -o on a device'
	mkdir depfile
	echo before > depfile/m.c
	run "$plgen" -o depfile/m.c --depfile /dev/full model.spec
	need_status 1
	need_text depfile/m.c before
	need_files depfile m.c
	result 'full disk: --depfile; -o is left as it was'
else
	skip 'full disk: -o on a device' 'no /dev/full'
	skip 'full disk: --depfile; -o is left as it was' 'no /dev/full'
fi

# ---- files that cannot be written ----

run "$plgen" -o missing/m.c model.spec
need_status 1
need_message 'missing/m\.c: error: cannot write: '
[ -s out ] && wrong 'standard output is not empty'
[ -e missing ] && wrong 'a folder was made'
result '-o into a folder that is missing'

mkdir folder folder/m.c
run "$plgen" -o folder/m.c model.spec
need_status 1
need_message 'folder/m\.c: error: cannot write: '
need_files folder m.c
result '-o onto a folder'

touch file
run "$plgen" -o file/m.c model.spec
need_status 1
need_message 'file/m\.c: error: cannot write: '
result '-o into a file as if it were a folder'

mkdir blocked blocked/m.h
echo before > blocked/m.c
run "$plgen" -o blocked/m.c model.spec
need_status 1
need_message 'blocked/m\.h: error: cannot write: '
need_text blocked/m.c before
need_files blocked 'm.c m.h'
need_files blocked/m.h ''
result 'FILE.h cannot be written: FILE.c is left as it was'

mkdir fresh fresh/m.h
run "$plgen" -o fresh/m.c model.spec
need_status 1
need_files fresh m.h
result 'FILE.h cannot be written: no FILE.c is made'

mkdir dep
echo before > dep/m.c
run "$plgen" -o dep/m.c --depfile dep/missing/m.d model.spec
need_status 1
need_message 'dep/missing/m\.d: error: cannot write: '
need_text dep/m.c before
need_files dep m.c
result 'the depfile cannot be written: FILE.c is left as it was'

run "$plgen" --depfile missing/m.d model.spec
need_status 1
[ -s out ] && wrong 'standard output is not empty'
result 'the depfile cannot be written: standard output stays empty'

mkdir readonly
echo before > readonly/m.c
chmod a-w readonly
if touch readonly/probe 2> /dev/null; then
	rm -f readonly/probe
	skip '-o into a read-only folder' 'this user may write anywhere'
else
	run "$plgen" -o readonly/m.c model.spec
	need_status 1
	need_message 'readonly/m\.c: error: cannot write: '
	need_text readonly/m.c before
	result '-o into a read-only folder'
fi

# What the C or a rule of make could not name is refused before anything is written.
mkdir names
newline='
'
for name in 'a"b.c' 'a\b.c' "a${newline}b.c" "a	b.c"; do
	run "$plgen" -o "names/$name" model.spec
	need_status 2
	need_message 'plgen: error: -o: an #include cannot name this file: '
done
run "$plgen" -o names/a.c --depfile "names/a${newline}.d" model.spec
need_status 2
need_message 'plgen: error: --depfile: a rule of make cannot name a file with a control character in its path'
need_files names ''
mkdir 'names/"odd' && run "$plgen" -o "names/\"odd/it's.c" model.spec
need_status 0
"${CC:-cc}" -I "$runtime" -c -o names/odd.o "names/\"odd/it's.c" 2> "$work/err" || wrong "$(head -n 3 "$work/err")"
result 'names that an #include or a rule of make cannot have; a folder may have them'

# ---- files that can ----

mkdir plain
run "$plgen" -o plain/m.c model.spec
need_status 0
need_silence
[ -s out ] && wrong 'standard output is not empty'
need_files plain 'm.c m.h'
grep -q '^#include "m.h"' plain/m.c || wrong 'm.c does not include m.h'
result '-o writes FILE.c and FILE.h'

for file in m.c m.h; do
	mode=$(ls -l "plain/$file" | cut -c 1-10)
	[ "$mode" = -rw-r--r-- ] || wrong "$file: $mode, expected -rw-r--r--"
done
result 'a new file has the mode that umask leaves'

mkdir mode
echo before > mode/m.c
echo before > mode/m.h
chmod 640 mode/m.c
chmod 600 mode/m.h
run "$plgen" -o mode/m.c model.spec
need_status 0
[ "$(ls -l mode/m.c | cut -c 1-10)" = -rw-r----- ] || wrong "m.c: $(ls -l mode/m.c | cut -c 1-10), expected -rw-r-----"
[ "$(ls -l mode/m.h | cut -c 1-10)" = -rw------- ] || wrong "m.h: $(ls -l mode/m.h | cut -c 1-10), expected -rw-------"
need_same plain/m.c mode/m.c
result 'an existing file keeps its mode'

mkdir link link/real
echo before > link/real/m.c
ln -s real/m.c link/m.c
run "$plgen" -o link/m.c model.spec
need_status 0
[ -L link/m.c ] || wrong 'the link was replaced'
need_same plain/m.c link/real/m.c
result '-o through a link writes the file behind it'

mkdir dangling
ln -s target.c dangling/m.c
run "$plgen" -o dangling/m.c model.spec
need_status 0
[ -L dangling/m.c ] || wrong 'the link was replaced'
need_same plain/m.c dangling/m.c
result '-o through a link whose file is not there yet'

run "$plgen" -o /dev/null model.spec
need_status 2
run "$plgen" --header -o /dev/null model.spec
need_status 0
[ -c /dev/null ] || wrong '/dev/null was replaced'
result 'a device is written where it is'

mkfifo pipe
cat pipe > piped &
"$plgen" --header -o pipe model.spec 2> err < /dev/null
status=$?
wait
need_status 0
need_same plain/m.h piped
[ -p pipe ] || wrong 'the pipe was replaced'
result 'a pipe is written where it is'

mkdir 'a b'
cp model.spec 'a b/my #1 $model.spec'
run "$plgen" -o 'a b/m.c' 'a b/my #1 $model.spec'
need_status 0
need_files 'a b' 'm.c m.h my #1 $model.spec'
grep -q 'a b/' 'a b/m.c' && wrong 'the folder stands in the C'
result 'names with blanks'

run "$plgen" model.spec
need_status 0
mv out first
cp model.spec plain/model.spec
run "$plgen" plain/model.spec
need_status 0
need_same first out
result 'same bytes twice, and from another folder'

"$plgen" - < model.spec > out 2> err
status=$?
need_status 0
need_silence
sed 's/model\.spec/<stdin>/' first > renamed
need_same renamed out
result 'standard input with -'

printf 'model m\ncoord x\nx = q\nstep 1\n' | "$plgen" - > out 2> err
status=$?
need_status 1
need_message '<stdin>:3:5: error: '
[ -s out ] && wrong 'standard output is not empty'
result 'an error in standard input'

"$plgen" - < /dev/null > out 2> err
status=$?
need_status 1
need_message '<stdin>:1:1: error: '
result 'standard input that is empty'

# ---- depfiles ----

if command -v make > make.path 2>&1; then
	cat > dep.mk <<'MAKE'
all: made/m.c
made/m.c:
	@echo made >> made/log
	@"$(PLGEN)" -o made/m.c --depfile made/m.d model.spec
-include made/m.d
MAKE
	mkdir made
	make -f dep.mk "PLGEN=$plgen" > make.out 2>&1 || wrong "first make: $(head -n 3 make.out)"
	make -f dep.mk "PLGEN=$plgen" > make.out 2>&1 || wrong "second make: $(head -n 3 make.out)"
	[ "$(wc -l < made/log)" -eq 1 ] || wrong 'made again without a change'
	sleep 1
	touch model.spec
	make -f dep.mk "PLGEN=$plgen" > make.out 2>&1 || wrong "third make: $(head -n 3 make.out)"
	[ "$(wc -l < made/log)" -eq 2 ] || wrong 'not made again after a change of the spec'
	result 'make follows the depfile'

	run "$plgen" -o 'a b/m.c' --depfile odd.d 'a b/my #1 $model.spec'
	need_status 0
	make -n -d -f odd.d 'a b/m.c' > make.out 2>&1
	grep -q "Considering target file 'a b/my #1 \$model.spec'" make.out ||
		wrong "make reads other names: $(cat odd.d)"
	result 'blanks, # and $ in a depfile'
else
	skip 'make follows the depfile' 'no make'
	skip 'blanks, # and $ in a depfile' 'no make'
fi

run "$plgen" --depfile stdout.d model.spec
need_status 0
need_same first out
grep -q '^[^ ]*: model\.spec$' stdout.d || wrong "depfile: $(cat stdout.d)"
result '--depfile with C on standard output'

mkdir same
run "$plgen" -o same/m.c --depfile same/m.c model.spec
need_status 2
need_files same ''
run "$plgen" -o same/m.c --depfile same/m.h model.spec
need_status 2
need_files same ''
result '-o and --depfile onto one file are refused'

cp model.spec same/m.c
run "$plgen" -o same/m.c same/m.c
need_status 2
need_same model.spec same/m.c
result 'the spec is not written over'

mkdir alias
cp model.spec alias/q.c
( cd alias && "$plgen" -o ./q.c q.c ) > out 2> err
status=$?
need_status 2
need_message 'plgen: error: .*would be written over'
need_same model.spec alias/q.c
need_files alias q.c
result 'the spec is not written over under another name'

ln -s q.c alias/soft.c
ln alias/q.c alias/hard.c
for name in soft hard; do
	run "$plgen" -o "alias/$name.c" alias/q.c
	need_status 2
	need_message 'plgen: error: .*would be written over'
done
ln -s q.c alias/header.h
run "$plgen" -o alias/header.c alias/q.c
need_status 2
run "$plgen" --depfile alias/soft.c alias/q.c
need_status 2
need_same model.spec alias/q.c
need_files alias 'hard.c header.h q.c soft.c'
result 'nor through a link'

mkdir data
printf '%%%%MatrixMarket matrix array real general\n1 1\n4\n' > data/k.mtx
cp data/k.mtx kept.mtx
printf "model m\ncoord x\nmatrix K = \"k.mtx\"\nx'' + K*x = 0\nstep 0.1\n" > data/m.spec
ln -s k.mtx data/m.h
run "$plgen" -o data/m.c data/m.spec
need_status 1
need_message 'data/m\.h: error: the spec reads this file: it is not written over' 
need_same kept.mtx data/k.mtx
need_files data 'k.mtx m.h m.spec'
result 'a data file is not written over'

# ---- a pair that does not belong together ----

mkdir pair
run "$plgen" --step 0.011 -o pair/a.c model.spec
cp pair/a.c pair/first.c
length=$(wc -c < pair/a.h)
for step in 0.012 0.013 0.014 0.015 0.016 0.017; do     # up to a header of the same length
	run "$plgen" --step $step -o pair/a.c model.spec
	[ "$(wc -c < pair/a.h)" -ne "$length" ] || break
done
[ "$(wc -c < pair/a.h)" -eq "$length" ] || wrong 'no header has the length of the first'
cp pair/first.c pair/a.c
compiler=${CC:-cc}              # words: a compiler behind a cache
if command -v ${compiler%% *} > make.path 2>&1; then
	$compiler -fsyntax-only -I"$runtime" plain/m.c > out 2>&1 || wrong "a pair does not compile: $(head -n 3 out)"
	$compiler -fsyntax-only -I"$runtime" pair/a.c > out 2>&1 &&
		wrong 'C beside the header of another step compiles'
	grep -q 'were not made together' out || wrong "another message: $(head -n 3 out)"
	result 'C and header of two runs do not compile'
else
	skip 'C and header of two runs do not compile' 'no compiler'
fi

# ---- a signal while files are written ----

mkdir signal
mkfifo signal/m.d
"$plgen" -o signal/m.c --depfile signal/m.d model.spec > out 2> err &
child=$!
for turn in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
	[ "$(ls -A signal | wc -l)" -ge 3 ] && break
	sleep 0.5
done
[ "$(ls -A signal | wc -l)" -eq 3 ] || wrong "no temporaries to remove: $(ls -A signal)"
kill -TERM "$child"
wait "$child" 2> out
status=$?
need_status 143
need_files signal m.d
result 'a signal leaves no temporaries'

# ---- a reader that goes away ----

{ "$plgen" model.spec 2> err; echo $? > pipe.status; } | head -c 10 > first.bytes
[ "$(wc -c < first.bytes | tr -d ' ')" = 10 ] || wrong 'no output'
grep -q 'Sanitizer\|runtime error' err && wrong "$(head -n 3 err)"
result 'a reader that goes away'

[ "$failed" -eq 0 ]
