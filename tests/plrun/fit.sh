#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Fits of params and initial values to records that awk makes of the closed form of a damped oscillator, with noise of
# known seeds; errors of the values against awk's own normal equations, with differences of the closed form.
#
#     fit.sh PLRUN PLGEN SOURCE_ROOT
. "${0%/*}/begin.sh"
cat >ring.spec <<'X'
model ring
param m = 2, k = 40, c = 0.5
coord x
init x = 0.02
m*x'' + c*x' + k*x = 0
output x, v = x'
step 0.02
X
# x and v of m = 2, k = 50, c = 0.8 from x0 = 0.025 at t; noise(size): normal, by twelve equal ones
cat >closed.awk <<'X'
function motion(t, k, c, x0,   g, w) {
	g = c / 4; w = sqrt(k / 2 - g * g)
	speed = -x0 * (w + g * g / w) * exp(-g * t) * sin(w * t)
	return x0 * exp(-g * t) * (cos(w * t) + g / w * sin(w * t))
}
function noise(size,   j, sum) {
	for (j = 0; j < 12; j++) { seed = (seed * 69069 + 12345) % 4294967296; sum += seed / 4294967296 }
	return size * (sum - 6)
}
X
cat closed.awk - >record.awk <<'X'
BEGIN {
	print "t,x,v"
	for (i = 0; i < rows; i++) {
		x = motion(i * every, 50, 0.8, 0.025); v = speed
		if (seed) { x += noise(1e-4); v += noise(1e-3) }
		printf "%.17g,%.17g,%.17g\n", i * every, x, v
	}
}
X
# record SEED EVERY ROWS: with noise, of seed 0 without
record() { awk -v seed="$1" -v every="$2" -v rows="$3" -f record.awk; }
# What the same awk finds of the values that were found: the step of its normal equations and the standard errors
cat >normal.awk <<'X'
BEGIN { OFMT = CONVFMT = "%.17g" }
FNR == NR { if (FNR > 1) { value[FNR - 1] = $2; error[FNR - 1] = $3 }; next }
FNR > 1 {
	for (p = 0; p <= 3; p++) {
		for (q = 1; q <= 3; q++) at[q] = value[q]
		h = 1e-5 * value[p]
		if (p) at[p] += h
		up = motion($1, at[1], at[2], at[3])
		if (p) at[p] -= 2 * h
		down = motion($1, at[1], at[2], at[3])
		J[p] = p ? (up - down) / (2 * h) : up - $2
	}
	for (p = 0; p <= 3; p++) for (q = 0; q <= 3; q++) N[p, q] += J[p] * J[q]
	n++
}
END {                           # [N | I] to [I | N^-1], by elimination
	for (p = 1; p <= 3; p++) for (q = 1; q <= 3; q++) { A[p, q] = N[p, q]; I[p, q] = p == q }
	for (p = 1; p <= 3; p++) {
		d = A[p, p]
		for (q = 1; q <= 3; q++) { A[p, q] /= d; I[p, q] /= d }
		for (r = 1; r <= 3; r++) if (r != p) {
			f = A[r, p]
			for (q = 1; q <= 3; q++) { A[r, q] -= f * A[p, q]; I[r, q] -= f * I[p, q] }
		}
	}
	for (p = 1; p <= 3; p++) {
		for (step = q = 0; q <= 3; q++) if (q) step -= I[p, q] * N[q, 0]
		own = sqrt(N[0, 0] / (n - 3) * I[p, p])
		printf "%d: %g, error %g, own %g; own step %g errors\n", p, value[p], error[p], own, step / own
		bad = bad || (error[p] / own - 1)^2 > 1e-6 || (step / own)^2 > 4e-6
	}
	exit bad || n < 100
}
X
record 7 0.02 201 | cut -d, -f 1,2 >record.csv
: >log
cat closed.awk normal.awk >own.awk
run ring.spec --fit k,c,x record.csv >table && awk -F, -f own.awk table record.csv >>log
result $? 'values and standard errors are those of the normal equations, within 2e-3 and 5e-4 of an error'
evaluations=$(sed -n 's/^note: \([0-9]*\) evaluations.*/\1/p' said)
cat said >>log
[ "${evaluations:-99}" -lt 12 ]
result $? "in $evaluations evaluations"
awk -F, 'NR == 2 { k = $2; e = $3; from = $4; to = $5; if ($6 != 1 || NF != 8) bad = 1 }
	END { print from, to, k, e; exit bad || NR != 4 || (from - k + 1.972 * e)^2 > 1e-4 * e^2 ||
		(to - k - 1.972 * e)^2 > 1e-4 * e^2 }' table >>log
result $? 'its 95 % are 1.972 standard errors to both sides: 198 degrees of freedom'

# Initial values alone need no compiler: many records
: >log
for seed in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30; do
	record $((seed * 7919)) 0.02 60 >many.csv
	run ring.spec --fit "x,x'" -D k=50 -D c=0.8 many.csv --sigma x=1e-4 --sigma v=1e-3 || break
done | awk -F, '$1 == "x(0)" || $1 == "x'\''(0)" { n++; true = $1 == "x(0)" ? 0.025 : 0; off = ($2 - true) / $3
		squares += off^2; inside += $4 < true && true < $5 }
	END { print inside " of " n " intervals, rms of the errors " sqrt(squares / n)
		exit n != 60 || inside < 52 || inside == n || squares / n < 0.56 || squares / n > 1.56 }' >>log
result $? "$(cat log)"

# Two thirds of the rows, of them some empty and some nan, off the grid of the steps: the same values but for the cubic
: >log
record 3 0.03 100 >between.csv
awk -F, 'BEGIN { OFS = "," } NR % 7 == 0 { $2 = "" } NR % 11 == 0 { $3 = "nan" } { print }' between.csv >missing.csv
for step in 0.02 0.002; do
	run ring.spec --fit k,c,x missing.csv --sigma x=1e-4 --sigma v=1e-3 --step $step >table$step || cat said >>log
done
grep -q 'note: x: 86 samples and 14 missing' said
result $? 'missing samples are counted'
paste -d, table0.02 table0.002 | awk -F, 'NR > 1 { off = ($2 - $10) / $3; print $1, $2, $10, off
	bad = bad || off * off > 1e-4 } END { exit bad || NR != 4 }' >>log
result $? 'samples between steps: within 1e-2 of an error of those at steps'

# Two records, each from where it starts; without noise
record 0 0.02 100 | cut -d, -f 1,2 >exact.csv
awk -F, 'NR == 1 { print; next } NR > 21 { printf "%.17g,%s\n", $1 - 0.4, $2 }' exact.csv >exact_later.csv
: >log
run ring.spec --fit "k,c,x,x'" exact.csv exact_later.csv >table || cat said >>log
{ printf '50\n0.8\n0.025\n'; record 0 0.02 21 | awk -F, 'END { print $2 "\n0\n" $3 }'; } >wanted
tail -n +2 table | cut -d, -f 1,2 | paste -d, - wanted | awk -F, '{ off = $2 - $3; print; bad = bad || off^2 > 1e-18 }
	END { exit bad || NR != 6 }' >>log
result $? 'two records without noise: params, and initial values of each, within 1e-9'

run ring.spec 0.5 >own.csv && run ring.spec --fit k,c,x own.csv >table && ! grep -i nan table >log
result $? 'a record that the model itself has made: errors of 0, and correlations as of any other'

sed '/^output/s/x,/x "mm",/; /^coord/s/$/ "m"/' ring.spec >units.spec
run units.spec 0.5 --units -D k=50 >own.csv && sed '1s/ \[[^]]*\]//g' own.csv >plain.csv
run units.spec --fit k,c own.csv >found && run units.spec --fit k,c plain.csv >expected
grep -q '^t,x \[mm\]' own.csv && cmp found expected >log 2>&1 &&
	awk -F, '$1 == "k" { off = $2 / 50 - 1; n++ } END { print off; exit !(n == 1 && off^2 < 1e-24) }' found >>log
result $? 'a record whose columns have units, as --units writes it'

# Through seven impacts, of which each moves with every param; and a model that is retuned
cat >struck.spec <<'X'
model struck
param e = 0.7, w = 2.2, gap = 0.15, F = 1, c = 0.05
coord x
x'' + c*x' + x = F*cos(w*t)
stop between x, ground at gap restitution e
output x
step 0.02
X
: >log
run struck.spec 20 --every 0.1 >struck.csv && [ "$(run struck.spec 20 --stats | sed -n 's/^x,.*,//p')" = 7 ] &&
	run struck.spec --fit e,gap,F,c -D e=0.75 -D gap=0.16 -D F=1.05 -D c=0.07 struck.csv >table || cat said >>log
awk -F, '{ print $1, $2 } NR > 1 { want = $1 == "e" ? 0.7 : $1 == "gap" ? 0.15 : $1 == "F" ? 1 : 0.05
	bad = bad || ($2 / want - 1)^2 > 1e-18 } END { exit bad || NR != 5 }' table >>log
result $? 'params of impacts, within 1e-9, from 7 % off'
sed 's/^coord/tunable k in [20, 80], c\n&/' ring.spec >tuned.spec
: >log
run ring.spec --fit k,c,x record.csv | cut -d, -f 1-3 >apart
run tuned.spec --fit k,c,x record.csv | cut -d, -f 1-3 | paste -d, - apart >both
! grep -q compiled said && awk -F, 'NR > 1 { off = ($2 - $5) / $3; print; bad = bad || off * off > 1e-6 }
	END { exit bad || NR != 4 }' both >>log
result $? 'tunable params, retuned: the same values within 1e-3 of an error, and nothing is compiled'
run ring.spec --fit k=30:45,c,x record.csv >table
awk -F, '$1 == "k" { exit !($2 == 45 && $3 == "") }' table && grep -q 'k has come to the end of its range, 45' said
result $? 'a range holds, and is said'
run ring.spec --fit k,c,x record.csv --profile >profile
sed -n 's/.*k: by its profile 95 % are \(.*\) to \(.*\)/\1,\2/p' said >both
run ring.spec --fit k,c,x record.csv | awk -F, '$1 == "k" { print $4 "," $5 "," $3 }' | paste -d, both - |
	awk -F, '{ print; a = ($1 - $3) / $5; b = ($2 - $4) / $5 }
		END { exit NR != 1 || NF != 5 || a * a > 4e-4 || b * b > 4e-4 }' >>log
result $? 'the interval of a profile is that of the table within 2e-2 of an error'

cat >twice.spec <<'X'
model twice
param k = 5, a = 9, idle = 1
coord x
init x = 0.02
2*x'' + 0.8*x' + k*a*x + idle*0 = 0
step 0.02
X
# The start of the record is that of the spec's value: runs with other values of a tunable param start there too.
cat >let.spec <<'X'
model let_go
param k = 4
coord x
init x = 1/k
x'' + 0.2*x' + k*x = 0
tunable k in [1, 9]
step 0.1
X
run let.spec 2 | awk -F, '{ print $1 "," $2 }' >let.csv
run let.spec -D k=3 --fit k let.csv >out && awk -F, -v n="$(sed -n 's/.* \([0-9]*\) evaluations.*/\1/p' said)" \
	'$1 == "k" { print $2, n, "expected: 4 to 1e-12, at most 8"; off = $2 - 4
		exit !(off < 1e-12 && off > -1e-12 && n != "" && n <= 8) }' out >log
result $? 'a tunable param that the initial values read'

# says NAME TEXT ARGUMENTS: exit status 1 or 2, nothing on standard output, and a line of this
says() {
	name=$1 wanted=$2
	shift 2
	: >log
	run "$@" >out
	status=$?
	cat said >>log
	[ $status -ge 1 ] && [ $status -le 2 ] && [ ! -s out ] && grep -qF -e "$wanted" said
	result $? "$name"
}
says 'a direction that the record does not determine' 'a change of k by +1 % and a by -1 % at once' \
	twice.spec --fit k,a,x record.csv
says 'a param on which nothing depends' 'does not determine idle: nothing that was measured' \
	twice.spec --fit k,idle record.csv
sed '9s/,.*/,one/' record.csv >word.csv
says 'a cell that is no number' "word.csv:9:21: error: expected a finite number, found 'one'" ring.spec --fit k word.csv
sed 1s/x/y/ record.csv >names.csv
says 'no column of an output' 'names.csv:1:1: error: no column is called as an output is' ring.spec --fit k names.csv
sed 1d record.csv >bare.csv
says 'no names' 'bare.csv:1:1: error: expected a first line with the names of outputs' ring.spec --fit k bare.csv
says 'a name that is unknown' "error: unknown name 'q'" ring.spec --fit k,q record.csv
says 'fewer samples than values' '2 samples up to T, and 3 values are looked for' ring.spec 0.03 --fit k,c,x record.csv
says 'a start outside of its range' 'k starts at 40, outside of its range, 50 to 60' ring.spec --fit k=50:60 record.csv
says 'no record' '--fit: which record?' ring.spec --fit k
says 'a sweep beside' '--fit and --sweep: one at a time' ring.spec --fit k record.csv --sweep c=1:2:2
says 'sigma without a fit' '--sigma goes with --fit' ring.spec 1 --sigma x=1
tap_end
