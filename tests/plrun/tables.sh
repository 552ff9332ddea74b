#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# One record in many writings gives one run.
#
#     tables.sh PLRUN PLGEN SOURCE_ROOT
. "${0%/*}/begin.sh"
cat >two.spec <<'X'
model two
coord x, y
input road hold first, push
10*x'' + 3*x' + 400*(x - y) = push
y'' + y' + 900*(y - road) + 40*(y - x) = 0
output x, y
step 0.01
X
awk 'BEGIN { for (k = 0; k <= 80; k++) printf "%.2f %.4f %.4f\n", k * 0.01, sin(0.2 * k), k % 7 - 3 }' >numbers

# written NAME FILE [OPTIONS]: the run of this file is the one of plain.csv
written() {
	name=$1 file=$2
	shift 2
	: >log
	run two.spec --input "$file" "$@" >out.csv || cat said >>log
	same plain_out.csv out.csv "$name"
}

(echo road,push; awk '{ print $2 "," $3 }' numbers) >plain.csv
run two.spec --input plain.csv >plain_out.csv
[ "$(wc -l <plain_out.csv)" -eq 82 ]
result $? 'a run to the end of the record'

run two.spec --input plain.csv --raw -o rows.bin && od -An -v -tf8 -w24 rows.bin >rows
sed '1d; y/,/ /' plain_out.csv | paste -d ' ' - rows |
	awk '$1 != $4 || $2 != $5 || $3 != $6 { print; bad = 1 } END { exit bad || NR != 81 }' >>log
result $? '--raw: the numbers that the rows have as text, read by od'
run two.spec --input plain.csv --real float --raw --every 0.03 --show y | od -An -v -tf8 -w16 >rows
run two.spec --input plain.csv --real float --every 0.03 --show y | sed '1d; y/,/ /' | paste -d ' ' - rows |
	awk '{ d = $2 - $4 } $1 != $3 || d * d > 1e-14 * $2 * $2 { print; bad = 1 } END { exit bad || NR != 27 }' >>log
result $? '... of a model in float as doubles'

cat >free.spec <<'X'
model swing
coord x
x'' + x = 0
init x = 1
step 0.001
X
run free.spec 100000 --every 5 >jumps.csv
awk -F, 'NR > 1 { d = $2 - cos($1); most = d * d > most ? d * d : most }
	END { print most; exit !(NR == 20002 && most < 1e-20) }' jumps.csv >>log
result $? '1e8 steps by jumps: cos t within 1e-10'
run free.spec 1001 --every 7 >jumps.csv
run free.spec 1001 --every 1 | awk 'NR == 1 || NR % 7 == 2' | paste -d, - jumps.csv |
	awk -F, 'NR > 1 { d = $2 - $5; bad += $1 != $4 || d * d > 1e-20 } END { exit bad || NR != 145 }'
result $? '... and the rows of steps'
sed "s/^x''.*/x'' = 1e9*x/; s/^step.*/step 0.01/" free.spec >grows.spec
run grows.spec 100 --every 50 >rows.csv
[ $? -eq 1 ] && cp said jumped && run grows.spec 100 >rows.csv
[ $? -eq 1 ] && grep -q 'has left the finite numbers' said && cmp said jumped >>log
result $? '... and the step at which a state leaves the finite numbers'

awk '{ print $2 "," $3 }' numbers >bare.csv
written 'no names: the order of the model' bare.csv
(echo push,road; awk '{ print $3 "," $2 }' numbers) >swapped.csv
written 'columns in another order' swapped.csv
(echo 'time;push;road'; awk '{ print $1 ";" $3 ";" $2 }' numbers | tr . ,) >semicolon.csv
written 'semicolons, decimal commas, times' semicolon.csv
(printf 'push\troad\tt\n'; awk '{ print $3 "\t" $2 "\t" $1 }' numbers) >tab.csv
written 'tabs, times' tab.csv
(echo '"push","time [s]","road"'; awk '{ print "\"" $3 "\",\"" $1 "\",\"" $2 "\"" }' numbers) >quoted.csv
written 'quotes' quoted.csv
(printf '\357\273\277# from a logger\r\n\r\nroad , push\r\n'
	awk '{ printf " %s ,%s\r\n", $2, $3 } NR == 2 { printf "# a pause\r\n" }' numbers
	printf '\r\n# the end\r\n\r\n') >dos.csv
written 'byte order mark, CRLF, comments, blanks, empty lines at the end' dos.csv
tr '\n' '\r' <plain.csv >cr.csv
written 'CR alone' cr.csv
(echo 'sep=;'; echo 'road;push'; awk '{ print $2 ";" $3 }' numbers) >sep.csv
written 'a line that names the separator' sep.csv
(echo '"CH ""1""",CH2,Zeit,CH7'; awk '{ print $2 "," $2 + 1 "," $1 "," $3 }' numbers) >logger.csv
written 'columns and times by name, others passed over' logger.csv --column 'road=CH "1"' --column push=CH7 \
	--time Zeit
grep -q "note: logger.csv: not read: 'CH2'" said
result $? '... and said'
(echo 't,road,push'; awk '{ print $1 + 12.5 "," $2 "," $3 }' numbers) >late.csv
written 'times that begin later' late.csv
grep -q 'its first row, of t = 12.5, is taken as t = 0' said
result $? '... and said'
(echo ',road,push'; awk '{ print NR - 1 "," $2 "," $3 }' numbers) >frame.csv
written 'row numbers without a name are passed over' frame.csv
(echo 'road;push;;'; awk '{ print $2 ";" $3 ";;" }' numbers) >trailing.csv
written 'empty columns at the end' trailing.csv
awk '{ print $2 "," $3 }' numbers | sed '1s/.*/01,-3/' >zero.csv
awk '{ print $2 "," $3 }' numbers | sed '1s/.*/1,-3/' >one.csv
run two.spec --input one.csv >one_out.csv
run two.spec --input zero.csv >out.csv
same one_out.csv out.csv 'a first number as 01'
printf '%s' "$(cat plain.csv)" >unended.csv
written 'no end of the last line' unended.csv
run two.spec --input - <plain.csv >out.csv
same plain_out.csv out.csv 'from standard input'
run --input plain.csv - <two.spec >out.csv
same plain_out.csv out.csv 'the spec from standard input'
run two.spec --input plain.csv -o file.csv >nothing && [ ! -s nothing ]
same plain_out.csv file.csv 'into a file'

# A step of 0.01 s as a float is off by 2e-8 of itself: times in the record are still those of steps.
(echo t,road,push; tr ' ' , <numbers) >timed.csv
run two.spec --real float --input plain.csv >plain_float.csv
run two.spec --real float --input timed.csv >out.csv
! grep resampled said >>log
result $? 'float: times of steps are no reason to resample'
same plain_float.csv out.csv 'float: with times and without'

# Ramps between rows 0.04 s apart are the record with three more rows in each gap; only the rounding of these differs.
awk 'NR % 4 == 1' numbers >coarse
(echo t,road,push; awk '{ print $1 "," $2 "," $3 }' coarse) >coarse.csv
awk 'NR == 1 { print "road,push" } NR > 1 { for (i = 0; i < 4; i++)
		printf "%.17g,%.17g\n", r + i / 4 * ($2 - r), p + i / 4 * ($3 - p) }
	{ r = $2; p = $3 } END { print r "," p }' coarse >between.csv
run two.spec 0.79 --input coarse.csv >coarse_out.csv
grep -q 'note: coarse.csv: a row every 0.04 s, and the step is 0.01 s: resampled by ramps' said
result $? 'resampling is said'
run two.spec 0.79 --input between.csv >between_out.csv
paste -d, coarse_out.csv between_out.csv | awk -F, 'NR > 1 { d = $2 - $5; e = $3 - $6
		if (d * d > 1e-28 || e * e > 1e-28) { print; bad = 1 } } END { exit bad || NR != 81 }' >>log
result $? 'resampled by ramps, within 1e-14'

# Row 0 of a ramp is t = 0: held at 1 from the start, it is the step 1 - cos w t and not a ramp from 0 over the first h
cat >ground.spec <<'X'
model floor_ramp
coord x
input u hold first
x'' + 4*x = 4*u
step 0.05
X
awk 'BEGIN { for (k = 0; k <= 100; k++) print 1 }' >ones.csv
run ground.spec --input ones.csv | awk -F, 'NR > 1 { d = $2 - (1 - cos(2 * $1)); if (d * d > 1e-26) {
		print $1, $2, 1 - cos(2 * $1); bad = 1 } } END { exit bad || NR != 102 }' >>log
result $? 'row 0 of a ramp is t = 0, within 1e-13 of 1 - cos'
tap_end
