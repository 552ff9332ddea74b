#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Messages: what is wrong with a command line, a record, a table of params; to the last letter.
#
#     errors.sh PLRUN PLGEN SOURCE_ROOT
. "${0%/*}/begin.sh"
cat >in.spec <<'X'
model in
coord x
input road, push
x'' + x = road + push
step 0.1
X
cat >swing.spec <<'X'
model swing
param k = 4
coord x
tunable k
x'' + k*x = 0
init x = 1
step 0.1
X
cat >hard.spec <<'X'
model hard
coord x
x'' - x - x^3 = 0
init x = 10
step 0.1
scheme etdrk4
X
: >empty.csv

# refuses NAME STATUS EXPECTED OPTIONS...: nothing on standard output, and this on the other
refuses() {
	name=$1 wanted=$2 expected=$3
	shift 3
	chosen "$name" || return 0
	: >log
	run "$@" >out </dev/null
	status=$?
	printf '%s\n' "$expected" >expected
	[ $status -eq "$wanted" ] || echo "exit status $status" >>log
	diff expected said >>log 2>&1
	[ ! -s out ] || echo 'it has written rows' >>log
	[ ! -s log ]
	result $? "$name"
}
usage='note: plrun --help lists the options'

# ---- the command line ----
refuses 'no spec' 2 "plrun: error: no spec is given
$usage"
refuses 'no time' 2 "plrun: error: when does it end? plrun MODEL.spec T, in seconds
$usage" swing.spec
refuses 'a time that is none' 2 "plrun: error: T: expected a time in seconds, finite and not negative, found '10s'
$usage" swing.spec 10s
refuses 'a negative time' 2 "plrun: error: --until: expected a time in seconds, finite and not negative, found '-1'
$usage" swing.spec --until -1
refuses 'two times' 2 "plrun: error: surplus argument '2': the time of the end is given
$usage" swing.spec 1 2
refuses 'two times, by option' 2 "plrun: error: the time of the end is given twice
$usage" swing.spec 1 --until 2
refuses 'two specs' 2 "plrun: error: one spec at a time: surplus argument 'in.spec'
$usage" swing.spec in.spec
refuses 'an unknown option' 2 "plrun: error: unknown option '--colour'
$usage" swing.spec 1 --colour
refuses 'an option without its value' 2 "plrun: error: option --input needs a value: FILE.csv
$usage" swing.spec 1 --input
refuses 'a value of none' 2 "plrun: error: --peak takes no value, found 'x'
$usage" swing.spec 1 --sweep s.csv --peak=x
refuses 'a column without a header' 2 "plrun: error: --column takes NAME=HEADER, found 'road'
$usage" in.spec --column road
refuses 'a param twice' 2 "plrun: error: 'k' is given twice
$usage" swing.spec 1 -D k=1 -D k=2
refuses 'jobs' 2 "plrun: error: --jobs takes a number from 1 to 4096, found '0'
$usage" swing.spec 1 --sweep s.csv --jobs 0
refuses 'a device of one run' 2 "plrun: error: --device goes with --sweep
$usage" swing.spec 1 --device
refuses 'jobs of one run' 2 "plrun: error: --jobs goes with --sweep
$usage" swing.spec 1 --jobs 2
refuses 'a picture of a sweep' 2 "plrun: error: --plot draws a sweep over one range, or two, or its --histories
$usage" swing.spec 1 --sweep s.csv --plot
refuses 'statistics of a sweep' 2 "plrun: error: --stats is of one run; a line of a sweep has them of its own
$usage" swing.spec 1 --sweep s.csv --stats
refuses 'a sweep in binary' 2 "plrun: error: --raw is for the rows of one run: --sweep has none
$usage" swing.spec 1 --sweep s.csv --raw
refuses 'a picture of nothing' 2 "plrun: error: --dark is of a picture: --plot FILE draws it
$usage" swing.spec 1 --dark
refuses 'the size of a window' 2 "plrun: error: --size is of a picture in a file: --plot FILE.svg
$usage" swing.spec 1 --size 400x300 --plot
for size in 400 400x 10x400 x3 400x1e9; do
	refuses "a size of $size" 2 "plrun: error: --size takes WIDTHxHEIGHT, each from 20 to 10000, found '$size'
$usage" swing.spec 1 --plot a.svg --size $size
done
refuses 'axes that are none' 2 "plrun: error: --log takes x, y or xy, found 'yx'
$usage" swing.spec 1 --plot a.svg --log yx
refuses 'a paper in the dark' 2 "plrun: error: --paper is light, and --dark is not
$usage" swing.spec 1 --plot a.svg --paper --dark
refuses 'a title with commands' 2 "plrun: error: --title: the title of the picture has a control character in it
$usage" swing.spec 1 --plot a.svg --title "$(printf 'a\nb')"
form="note: z,acc are two panels, z+zf two curves in one, x:x' is x' over x"
refuses 'what is not there to be shown' 2 "<command line>:1:3: error: no output or state is named 'xx'
x,xx
  ^
note: did you mean 'x'?" swing.spec 1 --show x,xx
refuses 'nothing like it' 2 "<command line>:1:1: error: no output or state is named 'speed'
speed
^
note: there are x, x'" swing.spec 1 --show speed
refuses 'a panel without a curve' 2 "<command line>:1:3: error: expected the name of an output or a state
x+
  ^
$form" swing.spec 1 --show x+
refuses 'one over another over a third' 2 "<command line>:1:5: error: expected ',' or '+', found ':'
x:x':x
    ^
$form" swing.spec 1 --show "x:x':x"
refuses 'too many curves' 2 "<command line>:1:16: error: a panel has at most 8 curves
x+x+x+x+x+x+x+x+x
               ^
note: a comma begins another panel" swing.spec 1 --show x+x+x+x+x+x+x+x+x
refuses 'histories of one run' 2 "plrun: error: --histories is a picture of a sweep: it goes with --sweep and --plot
$usage" swing.spec 1 --plot a.svg --histories
refuses 'histories of many runs' 2 'plrun: error: --histories draws at most 8 runs, and these are 9' \
	swing.spec 1 --sweep k=1:2:9 --plot a.svg --histories
refuses 'histories of two outputs in a panel' 2 \
	'plrun: error: --histories: a panel shows one output of all runs; a comma begins another' \
	swing.spec 1 --sweep k=1:2:3 --plot a.svg --histories --show "x+x'"
refuses 'one over another in a sweep' 2 "plrun: error: --show: one output over another is a picture of one run" \
	swing.spec 1 --sweep k=1:2:3 --show "x:x'" --plot a.svg
form='--psd takes WINDOW[:STEPS[:PERCENT]], found'
refuses 'a window that is none' 2 "plrun: error: $form 'hat': windows are hann, hamming, blackman, flattop, boxcar
$usage" swing.spec 1 --psd=hat
refuses 'a segment of 1000 steps' 2 "plrun: error: $form 'hann:1000': a segment is a power of two of steps, from 16 to \
1048576
$usage" swing.spec 1 --psd hann:1000
refuses 'an overlap of all' 2 "plrun: error: $form 'hann:64:100': segments overlap by 0 to 95 percent
$usage" swing.spec 1 --psd hann:64:100
refuses 'a segment longer than the run' 1 "plrun: error: --psd: a segment of 64 steps is longer than the run, which \
has 11 rows" swing.spec 1 --psd hann:64
refuses 'densities of rows that are apart' 2 "plrun: error: --psd takes every step: rows that are further apart would \
fold high frequencies onto low ones
$usage" swing.spec 1 --psd --every 0.2
refuses 'densities of a run that ends early' 1 "$(run hard.spec 10 2>&1 >out; cat said)" hard.spec 10 --psd hann:64
refuses 'a page with a time' 2 "plrun: error: a time does not go with --page: a page has its controls
$usage" swing.spec 1 --page a.html
refuses 'densities of a sweep' 2 "plrun: error: --psd and --sweep: one at a time
$usage" swing.spec 1 --psd --sweep k=1:2:3
refuses 'a chart with a param' 2 "plrun: error: --chart takes the spec, T, --every and -o FOLDER alone, found -D
$usage" --chart swing.spec 1 -D k=2
refuses 'a chart with an option of plgen' 2 "plrun: error: --chart takes the spec, T, --every and -o FOLDER alone, \
found --scheme=taylor
$usage" --chart swing.spec 1 --scheme taylor
refuses 'a chart of standard input' 2 "plrun: error: --chart reads the spec many times: it has to be a file
$usage" --chart - 1
refuses 'a chart of nothing' 1 'chart: no file none.spec' --chart none.spec 1
for range in k= k=1 k=1:2 k=1:b:3 k=1:2:3:lin k=1:2:3:log:4; do
	form="--sweep takes FILE.csv or NAME=FROM:TO:COUNT[:log]"
	refuses "a sweep over $range" 2 "plrun: error: $form, found '$range'
$usage" swing.spec 1 --sweep "$range"
done
refuses 'a range of one value' 2 "plrun: error: --sweep k=1:2:1: a range has 2 to 10000000 values
$usage" swing.spec 1 --sweep k=1:2:1
refuses 'a range of half a value' 2 "plrun: error: --sweep k=1:2:2.5: a range has 2 to 10000000 values
$usage" swing.spec 1 --sweep k=1:2:2.5
refuses 'a range of nothing' 2 "plrun: error: --sweep k=1:1:3: a range ends elsewhere than it begins
$usage" swing.spec 1 --sweep k=1:1:3
refuses 'a logarithmic range through 0' 2 "plrun: error: --sweep k=-1:2:3:log: a logarithmic range is above 0
$usage" swing.spec 1 --sweep k=-1:2:3:log
refuses 'ranges of too many runs' 2 "plrun: error: --sweep: more than 10000000 runs
$usage" swing.spec 1 --sweep k=1:2:10000 --sweep step=1:2:10000
refuses 'a range and a file' 2 "plrun: error: --sweep: one file, or ranges
$usage" swing.spec 1 --sweep k=1:2:3 --sweep s.csv
refuses 'two files' 2 "plrun: error: --sweep: one file, or ranges
$usage" swing.spec 1 --sweep s.csv --sweep s.csv
refuses 'a picture of another kind' 2 "plrun: error: --plot draws .svg, .png or .pdf, found 'a.jpg'
$usage" swing.spec 1 --plot a.jpg
refuses 'rows apart by no whole steps' 2 "plrun: error: --every takes a multiple of the step, 0.1 s, found 0.25
$usage" swing.spec 1 --every 0.25
refuses 'the input written over' 2 "plrun: error: 'r.csv' would be written over
$usage" in.spec --input r.csv -o r.csv
refuses 'the spec by another name' 2 "plrun: error: './swing.spec' would be written over
$usage" swing.spec 1 -o ./swing.spec
refuses 'the rows written over' 2 "plrun: error: 'a.svg' would be written over
$usage" swing.spec 1 -o a.svg --plot a.svg
refuses 'samples of no inputs' 2 "plrun: error: --input: the model 'swing' has no inputs
$usage" swing.spec --input empty.csv
refuses 'inputs without samples' 2 "plrun: error: the model 'in' has inputs: --input FILE.csv gives their samples
$usage" in.spec 1

# ---- plgen's own words ----
refuses 'an unknown param' 1 "<command line>:1:1: error: no param is named 'kk'
kk=1
^
note: did you mean 'k'?" swing.spec 1 -D kk=1
refuses 'a scheme' 1 "$("$PLGEN" --scheme rk4 swing.spec 2>&1)" swing.spec 1 --scheme rk4
refuses 'no such spec' 1 "$("$PLGEN" none.spec 2>&1)" none.spec 1
refuses 'values of a param that make no step' 1 \
	'swing: error: k = 1e+300: with these values the numbers of the step are not finite' swing.spec 1 -D k=1e300

# ---- records ----
# record NAME LINES EXPECTED [OPTIONS]
record() {
	name=$1 expected=$3
	printf '%b' "$2" >r.csv
	shift 3
	refuses "$name" 1 "$expected" in.spec --input r.csv "$@"
}
refuses 'no such record' 1 "plrun: error: cannot read 'none.csv': No such file or directory" in.spec --input none.csv
record 'an empty file' '' 'r.csv:1:1: error: expected rows of numbers, found the end of the file'
record 'names alone' 'road,push\n' 'r.csv:2:1: error: expected rows of numbers, found the end of the file'
record 'an input is missing' 'road,time\n1,2\n' "r.csv:1:1: error: no column is called 'push', as the input is
road,time
^
note: --column push=HEADER says which it is; there are 'road', 'time'"
record 'a column too many, named' 'road,wind,push\n1,2,3\n' \
	"r.csv:1:6: error: a column too many: no input is called 'wind'
road,wind,push
     ^
note: the inputs are road, push; with --column or --time other columns are passed over"
cat >units.spec <<'X'
model in
coord x "m"
input road "m", push "m"
param T = 1 "s"
T^2*x'' + x = road + push
step 0.1
X
printf 'push [m],road [mm]\n1,2\n' >units.csv
refuses 'another unit' 1 "units.csv:1:10: error: 'road' is in 'm', and this column in 'mm'
push [m],road [mm]
         ^
note: --column 'road=road [mm]' takes its numbers as they are" units.spec --input units.csv
record 'a column too many' 'push,road\n1,2\n1,2,3\n' 'r.csv:3:5: error: a column too many: the first line has 2
1,2,3
    ^'
record 'decimal commas between commas' 'push,road\n1,2,3,4\n' 'r.csv:2:5: error: a column too many: the first line has 2
1,2,3,4
    ^
note: numbers with a decimal comma go with ; between the columns'
record 'too few columns' 'push;road\n1;2\n1\n' 'r.csv:3:2: error: too few columns: the first line has 2, this one 1
1
 ^'
record 'no names, too few columns' '1\n2\n' 'r.csv:1:1: error: expected 2 columns, one for each input, found 1
note: a first line with names says which is which; the inputs are road, push'
record 'a gap' 'push;road\n1;2\n;2\n' 'r.csv:3:1: error: expected a number, found nothing: the row has a gap
;2
^'
tab=$(printf '\t')
record 'a gap at the end' 'push\troad\n1\t\n' "r.csv:2:3: error: expected a number, found nothing: the row has a gap
1$tab
 $tab^"
record 'an empty line' 'push,road\n1,2\n\n1,2\n' \
	'r.csv:3:1: error: a row is missing: the line is empty, and others follow it'
record 'text in a number' 'push,road\n1,2 mm\n' "r.csv:2:3: error: expected a finite number, found '2 mm'
1,2 mm
  ^"
record 'what is not finite' 'push,road\n1,nan\n' "r.csv:2:3: error: expected a finite number, found 'nan'
1,nan
  ^"
record 'too large' 'push,road\n1,1e999\n' "r.csv:2:3: error: expected a finite number, found '1e999'
1,1e999
  ^"
record 'marks of thousands' 'push;road\n1;1.234,5\n' "r.csv:2:3: error: expected a finite number, found '1.234,5'
1;1.234,5
  ^
note: a decimal comma goes with ; or tabs between the columns; thousands have no mark"
record 'a point after a comma' 'push;road\n1,5;1\n2.5;1\n' \
	'r.csv:3:1: error: numbers before have a decimal comma, and this one a point
2.5;1
^'
record 'an open quote' 'push,road\n1,"2\n' 'r.csv:2:3: error: this quote is not closed
1,"2
  ^'
record 'behind a quote' 'push,road\n1,"2"3\n' 'r.csv:2:6: error: expected a separator behind the quote
1,"2"3
     ^'
record 'one name twice' 'push,road,push\n1,2,3\n' "r.csv:1:11: error: two columns are called 'push'
push,road,push
          ^"
record 'a header that is not there' 'a,b\n1,2\n' "r.csv:1:1: error: --column: no column is called 'c'
a,b
^
note: its columns are 'a', 'b'" --column road=c
record 'times that fall' 't,push,road\n0,1,1\n0.2,1,1\n0.1,1,1\n' 'r.csv:4:1: error: times have to rise: 0.1 follows 0.2
0.1,1,1
^'
record 'times in other units' 'push,road,time [ms]\n1,2,3\n' \
	"r.csv:1:11: error: times are in seconds, and these are in 'ms'
push,road,time [ms]
          ^
note: --time 'time [ms]' takes it as seconds all the same"
record 'UTF-16' '\0377\0376a\0000' 'plrun: error: r.csv is UTF-16: save it as UTF-8'
record 'UTF-16 the other way' '\0376\0377\0000a' 'plrun: error: r.csv is UTF-16: save it as UTF-8'
record 'bytes that are 0' 'push,road\n1,\00002\n' 'r.csv:2:1: error: this is no text: it has bytes that are 0
1,?2
^
note: save it as text, UTF-8'
record 'a record that ends early' 'push,road\n1,2\n1,2\n' \
	'r.csv:3:1: error: too few samples: 5 steps take 5, to t = 0.4, and there are 2, to 0.1' 0.5
awk 'BEGIN { print "t,push,road"; for (k = 0; k < 90; k++) if (k < 20 || k > 40) print k / 10 ",1,2" }' >r.csv
run in.spec --input r.csv >out
[ "$(cat said)" = 'r.csv:22:1: warning: 2.2 s without a row, where others are 0.131 s apart
note: r.csv: rows 0.1 to 2.2 s apart, and the step is 0.1 s: resampled by ramps' ]
status=$?
cp said log
result $status 'rows that are missing, by their times'
record 'a time beyond all steps' 't,push,road\n0,1,2\n1e300,1,2\n' \
	'r.csv:3:1: error: the record is more than 2^53 steps long'
run in.spec 0.2 --input r.csv >out && [ "$(wc -l <out)" -eq 4 ]
result $? 'a time beyond all steps, and an end before it'
printf 'push,road\n1,2\n' >r.csv
refuses 'a column of no input' 2 "plrun: error: --column: the model has no input 'wind'; its inputs: road, push
$usage" in.spec --input r.csv --column wind=push

# ---- runs ----
printf "model still\ncoord x\nx'' + x = 0\nstep 0.1\n" >still.spec
run still.spec 0.2 >out
[ $? -eq 0 ] && [ "$(cat said)" = "note: nothing starts and nothing drives the model, so every state has stayed 0: \
give it an initial value (init x = 1) or a load" ]
status=$?
cat said >log
result $status 'a run in which nothing moves says so'
run hard.spec 10 >out
[ $? -eq 1 ] && [ "$(cat said)" = 'hard: error: t = 0.4: the step has left the finite numbers' ] && [ -s out ]
status=$?
cat said >log
result $status 'a run that leaves the finite numbers: the rows before it are written'
if [ -w /dev/full ]; then
	"$plrun" swing.spec 100 >/dev/full 2>said
	[ $? -eq 1 ] && grep -q 'error: cannot write the rows: No space left on device' said
	result $? 'a full disk'
fi

run swing.spec 0.5 -D k=9 >file.csv
cat swing.spec | run - 0.5 -D k=9 >pipe.csv
same file.csv pipe.csv 'a spec on standard input, with a param: it is read once'

# ---- sweeps ----
# table NAME LINES EXPECTED [OPTIONS]
table() {
	name=$1 expected=$3
	printf '%b' "$2" >s.csv
	shift 3
	refuses "$name" 1 "$expected" swing.spec 1 --sweep s.csv "$@"
}
table 'a sweep without names' '1\n2\n' 's.csv:1:1: error: expected a first line with the names of params'
table 'a sweep of an unknown param' 'k,m\n1,2\n' "s.csv:1:3: error: no param is named 'm'
k,m
  ^"
table 'a sweep with one param twice' 'k,k\n1,2\n' "s.csv:1:3: error: two columns are called 'k'
k,k
  ^"
table 'a sweep of a param that is given' 'k\n1\n' "s.csv:1:1: error: 'k' has a value on the command line, too
k
^" -D k=3
table 'a sweep with a gap' 'k;step\n1;0.1\n2;\n' 's.csv:3:3: error: expected a number, found nothing: the row has a gap
2;
  ^'
table 'a sweep with text' 'k\n1\nabc\n' "s.csv:3:1: error: expected a finite number, found 'abc'
abc
^"
table 'a sweep of nothing' 'k\n' 's.csv:2:1: error: expected rows of params, found the end of the file'
tap_end
