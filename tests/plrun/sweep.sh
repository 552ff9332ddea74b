#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A line of a sweep is what the rows of a run with these params come to; its bytes do not depend on how many work at it,
# nor on interruptions.
#
#     sweep.sh PLRUN PLGEN SOURCE_ROOT
. "${0%/*}/begin.sh"
. "$root/tests/cases.sh"
cat >car.spec <<'X'
model car
param m = 300, k = 18000, c = 1200, mw = 30, kt = 150000
tunable k, c
coord body, wheel
input road hold first
m*body'' + c*(body' - wheel') + k*(body - wheel) = 0
mw*wheel'' - c*(body' - wheel') - k*(body - wheel) + kt*(wheel - road) = 0
output body, comfort = body''
step 0.002
X
awk 'BEGIN { print "road"
	for (k = 0; k <= 2000; k++) printf "%.6f\n", 0.01 * sin(k * 0.02) + 0.004 * sin(k * 0.11) }' >road.csv
awk 'BEGIN { print "k,c,m"
	for (i = 0; i < 24; i++) print 10000 + 1000 * i "," 800 + 100 * (i % 5) "," 250 + 50 * (i % 3) }' >params.csv
sed -i '11s/.*/20000,900,0/; 15s/.*/-1e9,900,300/' params.csv

run car.spec --input road.csv --sweep params.csv --peak --jobs 1 >one.csv
[ $? -eq 1 ] && [ "$(wc -l <one.csv)" -eq 25 ]
result $? 'a line for each row; status 1, as some fail'
cp said log
grep -q '^10,20000,900,0,,,,,,,failed: ' one.csv && grep -q '^14,-1e9,900,300,,,,,,,"*failed: ' one.csv &&
	[ "$(grep -c ',ok$' one.csv)" -eq 22 ] && grep -q '2 of 24 runs failed' said
result $? 'failed rows are marked, the others go on'
[ "$(head -n 1 one.csv)" = 'run,k,c,m,final body,final comfort,rms body,rms comfort,peak body,peak comfort,status' ]
result $? 'names of the columns'

# lines against the rows of single runs, added up here: last values to the letter, sums within 1e-13
for row in 3 12 24; do
	line=$(sed -n "$((row + 1))p" params.csv)
	k=${line%%,*} rest=${line#*,}
	c=${rest%%,*} m=${rest#*,}
	run car.spec --input road.csv -D "k=$k" -D "c=$c" -D "m=$m" >rows.csv
	: >log
	sed -n "$((row + 1))p" one.csv | cat - rows.csv | awk -F, '
		function off(a, b) { d = (a - b) / b; return d * d > 1e-26 }
		NR == 1 { for (i = 1; i <= NF; i++) want[i] = $i; next }
		NR > 2 { for (i = 2; i <= 3; i++) { last[i] = $i; sum[i] += $i * $i; v = $i < 0 ? -$i : $i
			if (v > top[i]) top[i] = v } }
		END { for (i = 2; i <= 3; i++) {
			if (last[i] != want[i + 3]) { print "final", want[i + 3], last[i]; bad = 1 }
			rms = sqrt(sum[i] / (NR - 2))
			if (off(want[i + 5], rms)) { print "rms", want[i + 5], rms; bad = 1 }
			if (off(want[i + 7], top[i])) { print "peak", want[i + 7], top[i]; bad = 1 } }
			exit bad || NR != 2003 }' >>log
	result $? "line $row is the run with its params"
done

# ---- side by side: each has the digits of its run alone, --stats ----
cat >forced.spec <<'X'
model forced
param k = 100, c = 0.4
tunable k, c
coord x, y
input u hold first
x'' + c*(2*x' - y') + k*(2*x - y) = cos(5*t) + u
y'' + c*(y' - x') + k*(y - x) = 0
init x = 0.01
output x, acc = y'', thrust = k*x + u, worst = peak(k*y)
step 0.01
X
sed '1s/.*/u/' road.csv >u.csv
sed -e 's/, worst = .*//' -e "s/^y''.*= 0$/& + 0.1*sin(y)/" -e 's/^step/scheme taylor 6\n&/' forced.spec >sine.spec
# A param that switching functions read is of each instance.
sed -e 's/, worst = .*//' -e 's/k\*(\|k\*x/100&/; s/100k/100/; s/^tunable.*/tunable k/' \
	-e "s/ = cos/ + 300*deadzone(x - 0.0001*k, -0.01, 0.01)&/" forced.spec >gap.spec
# alone K OPTIONS: the line of a run with k = K
alone() {
	value=$1
	shift
	run "$spec" 15 --input u.csv "$@" -D "k=$value" --stats | awk -F, -v value="$value" '
		NR > 1 { final = final "," $2; rms = rms "," $4; peak = peak "," $7 }
		END { print value final rms peak ",ok" }'
}
for options in '--real double' '--real float' '--show thrust,x' '--show x,y' '--show y,x' '--math own'; do
	case $options in
		'--math own') spec=sine.spec ;;
		'--show y,x') spec=gap.spec ;;
		*) spec=forced.spec ;;
	esac
	# shellcheck disable=SC2086
	run $spec 15 --input u.csv $options --sweep k=80:120:41 --peak --jobs 1 | cut -d, -f 2- >lanes.csv
	for value in 80 91 99 120; do
		# shellcheck disable=SC2086
		alone $value $options
	done >expected
	grep '^80,\|^91,\|^99,\|^120,' lanes.csv >found
	same expected found "side by side, $spec $options"
done

# ---- on a device: the same bytes; what it does not take is named ----
export POCL_CACHE_DIR="$PWD"
printf 'c,k\n' >grid.csv
awk 'BEGIN { for (i = 0; i < 24; i++) print 0.1 * (i % 2 + 1) "," 80 + i }' >>grid.csv
sed -e 's/, worst = .*//' -e 's/^tunable.*/tunable k/' forced.spec >device.spec
for options in '--jobs 1' '--show thrust,x'; do
	# shellcheck disable=SC2086
	run device.spec 15 --input u.csv $options --sweep grid.csv --peak >host.csv
	# shellcheck disable=SC2086
	run device.spec 15 --input u.csv $options --sweep grid.csv --peak --device >device.csv
	same host.csv device.csv "on a device, $options"
	if grep -q 'without OpenCL\|OpenCL has no device' said; then
		skip 'on a device: all runs are' 'OpenCL: ocl-icd-opencl-dev, pocl-opencl-icd'
	else
		cp said log
		[ ! -s said ]
		result $? 'on a device: all runs are'
	fi
done
run forced.spec 15 --input u.csv --sweep k=80:90:3 --device --real float >device.csv
cp said log
grep -q '^note: --device: 3 of 3 runs were on the host, the first of them run 1: .*squares of a model in float' said
result $? 'a model that no device takes is named'
run forced.spec 15 --input u.csv --sweep k=80:90:3 --peak >host.csv
run forced.spec 15 --input u.csv --jobs 1 --sweep k=80:90:3 --peak --device >device.csv
same host.csv device.csv 'on a device, whole steps'
cp said log
! grep -q -- --device said || grep -q 'without OpenCL\|OpenCL has no device' said
result $? 'on a device, whole steps: all runs are'
for size in 1 1e160 1e-160; do
	printf 'model large\nparam k = 4\ntunable k\ncoord x\ninit x = %s\n%s\nstep 0.1\n' $size "x'' + k*x = 0" \
		>large.spec
	run large.spec 15 --sweep k=1:4:4 --device | awk -F, -v size=$size '{ print $5 / size, $NF }' OFMT=%.12g
done >log
awk 'NR % 5 != 1 { if (NR < 6) rms[NR % 5] = $1; else if ($1 != rms[NR % 5]) bad = 1; if ($2 != "ok") bad = 1 }
	END { exit bad || NR != 15 || !(rms[2] > 0.6 && rms[2] < 0.8) }' log
result $? 'squares that no double has'

# ---- ranges: as the table of their values ----
printf 'k,m\n12000,250\n12000,300\n12000,350\n16000,250\n16000,300\n16000,350\n20000,250\n20000,300\n20000,350\n' \
	>grid.csv
run car.spec --input road.csv --sweep grid.csv --peak >table.csv
run car.spec --input road.csv --sweep k=12e3:2e4:3 --sweep m=250:350:3 --peak >ranges.csv
same table.csv ranges.csv 'two ranges, the second of which changes faster'
for c in 0.1 0.2 0.3; do printf '9e4,%s\n9e3,%s\n9e2,%s\n' $c $c $c; done | sed '1s/^/k,c\n/' >grid.csv
run car.spec --input road.csv --sweep grid.csv >table.csv
run car.spec --input road.csv --sweep c=0.1:0.3:3 --sweep k=9e4:9e2:3:log >ranges.csv
awk -F, -v OFS=, 'NR > 1 { print $1, $2 + 0, $3, $4, $5, $6, $7, $8 }' table.csv >expected
awk -F, -v OFS=, 'NR > 1 { print $1, $3, $2, $4, $5, $6, $7, $8 }' ranges.csv >found
same expected found 'values in 15 digits, in equal ratios downwards'
run car.spec --input road.csv --sweep k=12e3:2e4:3 --plot range.svg >ranges.csv
{ xmllint --noout range.svg && [ "$(grep -c 'final' range.svg)" -ge 2 ] && grep -q '>body<' range.svg; } >log 2>&1
result $? 'a picture over one range'
run car.spec --input road.csv --sweep k=12e3:2e4:3 --sweep m=250:350:3 --peak --plot map.svg >ranges.csv
{ xmllint --noout map.svg && grep -q 'peak of comfort' map.svg && grep -q 'polygon' map.svg; } >log 2>&1
result $? 'a map over two ranges'

# ---- params that are not tunable, of more rows than are compiled: closed forms, and the compiled model ----
cat >loose.spec <<'X'
model loose
param k = 4, m = 1
coord x
m*x'' + k*x = 0
init x = 1
step 0.1
X
# closed FILE START: x(5) of each k is START cos(5 sqrt k) within 1e-12
closed() {
	awk -F, -v start="$2" 'NR > 1 { want = (start ? start : $2 / 4) * cos(5 * sqrt($2)); d = $3 - want
		if (d * d > 1e-24 || $NF != "ok") { print $0, want; bad = 1 } } END { exit bad || NR != 11 }' "$1" >>log
}
rm -rf "$XDG_CACHE_HOME"
run loose.spec 5 --sweep k=1:10:10 --jobs 1 >loose.csv && closed loose.csv 1
result $? 'made tunable: cos(5 sqrt(k)) within 1e-12'
[ "$(ls "$XDG_CACHE_HOME"/plgen/loose-*.so | wc -l)" -eq 2 ]
result $? '... and compiled once more, not ten times'
sed 's/^init x = 1/init x = k\/4/' loose.spec >start.spec
run start.spec 5 --sweep k=1:10:10 --jobs 1 >start.csv && closed start.csv 0
result $? 'an initial value that reads the param is that of the row'
run loose.spec 5 --sweep step=0.1:0.3:3 >steps.csv
grep -q '^note: T = 5 is no multiple of the step of 1 of 3 runs, .* run 3 at t = 4.8$' said &&
	awk -F, 'NR == 4 { d = $3 - cos(9.6); exit d * d > 1e-24 }' steps.csv
result $? 'where a run ends whose step T is no multiple of, and its last value there'
run loose.spec 5 --sweep m=0:9:10 --jobs 1 >mass.csv
echo 'm
0' >zero.csv
run loose.spec 5 --sweep zero.csv | sed 1d >expected
sed -n 2p mass.csv >found
same expected found 'a value that the tunable model does not take is one of a model of its own'

# ---- units: values of params are in their own, tunable or not ----
cat >fixed.spec <<'X'
model units
param m = 2 "kg", k = 18 "kN/m", c = 20 "N s/m", L = 25 "mm"
coord x "m"
m*x'' + c*x' + k*(x - L) = 0
output x "mm", f = k*x "kN", a = x''
step 1 "ms"
X
sed 's/^coord/tunable k, L\n&/' fixed.spec >tuned.spec
run fixed.spec 0.1 -D k=20 --sweep L=10:40:4 --units >fixed.csv
run tuned.spec 0.1 -D k=20 --sweep L=10:40:4 --units >tuned.csv
run tuned.spec 0.1 -D k=20 -D L=40 >rows.csv
cat fixed.csv tuned.csv >log
paste -d, fixed.csv tuned.csv | awk -F, '
	NR == 1 { head = $0; next }
	{ for (i = 1; i <= 8; i++) { d = $i - $(i + 9); if (d * d > 1e-24 * $i * $i) bad = 1 } last = $3 }
	END { names = "run,L,final x [mm],final f [kN],final a [m/s^2],rms x [mm],rms f [kN],rms a [m/s^2],status"
		exit bad || NR != 5 || head != names "," names || !(last > 50 && last < 70) }' &&
	[ "$(tail -n 1 rows.csv | cut -d, -f 2)" = "$(tail -n 1 tuned.csv | cut -d, -f 3)" ]
result $? 'params in their own units, tunable or not; names with units'
sed 's/k, L$/k in [9 "kN\/m", 20 "kN\/m"]/' tuned.spec >bound.spec
run bound.spec 0.1 --sweep k=18:22:2 >log
grep -q ',failed: k = 22: outside of the range that the spec gives$' log
result $? 'a value outside of its range is named'

# ---- statistics of one run, against those of its rows ----
run car.spec --input road.csv >rows.csv
run car.spec --input road.csv --stats >stats.csv
cat rows.csv stats.csv | awk -F, '
	function off(a, b) { return (a - b) * (a - b) > 1e-24 * (b * b + 1e-30) }
	/^output/ { stats = 1; next }
	!stats && NR > 1 { n++; for (i = 2; i <= 3; i++) {
		v = $i < 0 ? -$i : $i; last[i] = $i; sum[i] += $i; sq[i] += $i * $i
		if (n == 1 || $i < low[i]) low[i] = $i; if (n == 1 || $i > top[i]) top[i] = $i
		if (n == 1 || v > peak[i]) { peak[i] = v; at[i] = $1 } } }
	stats { i = ++lines + 1
		print $0; print last[i], sum[i] / n, sqrt(sq[i] / n), low[i], top[i], peak[i], at[i]
		bad = bad || $1 != (i == 2 ? "body" : "comfort") || $2 != last[i] || off($3, sum[i] / n) ||
			off($4, sqrt(sq[i] / n)) || $5 != low[i] || $6 != top[i] || $7 != peak[i] || $8 != at[i] }
	END { exit bad || n != 2001 || lines != 2 }' >log
result $? 'statistics of a run are those of its rows'
run "$models/bouncing_ball.spec" 3 >rows.csv
run "$models/bouncing_ball.spec" 3 --stats >stats.csv
# an impact turns the velocity upwards between two rows
awk -F, 'NR == 1 { for (i = 2; i <= NF; i++) if ($i == "x\047") v = i; next }
	NR > 2 && last < 0 && $v > 0 { turns++ } { last = $v } END { print turns + 0 }' rows.csv >expected
{ head -n 1 stats.csv; cat stats.csv expected; } >log
head -n 1 stats.csv | grep -q ',crossings$' && [ "$(sed -n 2p stats.csv | sed 's/.*,//')" = "$(cat expected)" ] &&
	[ "$(cat expected)" -gt 2 ]
result $? 'statistics of a run: impacts'

run car.spec --input road.csv --sweep params.csv --peak --jobs 2 >two.csv
same one.csv two.csv 'jobs 1 and 2'
run car.spec --input road.csv --sweep params.csv --peak --jobs 2 -o file.csv
same one.csv file.csv 'into a file'

# The process pid, once 50 lines are in the journal
kill_in_the_middle() {
	while [ "$(cat "$XDG_CACHE_HOME"/plgen/sweep-* 2>/dev/null | wc -l)" -lt 100 ] && kill -0 $pid 2>/dev/null; do
		sleep 0.02
	done
	kill -9 $pid
	wait $pid 2>/dev/null
}

# killed when some lines are done, and gone on with
awk 'BEGIN { print "k"; for (i = 0; i < 400; i++) print 10000 + 50 * i }' >many.csv
awk 'BEGIN { print "road"; for (k = 0; k <= 10000; k++) printf "%.6f\n", 0.01 * sin(k * 0.02) }' >long.csv
run car.spec --input long.csv --sweep many.csv --progress >whole.csv
cp said log
grep -q '^plrun: [0-9]* of 400 runs' said && ! grep -v '^plrun: [0-9]* of 400 runs\(, [0-9]* s left\)*$' said >>log
result $? '--progress: how many runs are done, without a terminal'
: >log
"$plrun" car.spec --input long.csv --sweep many.csv >part.csv 2>>log &
pid=$!
kill_in_the_middle
done=$(wc -l <part.csv)
[ "$done" -lt 401 ] && [ "$done" -gt 0 ]
result $? 'killed in the middle'
# an entry whose line is not the one that was written, and half of one
printf '399 00112233445566778899aabbccddeeff 11\n400,1,2,ok\n398 0123' >>"$(ls "$XDG_CACHE_HOME"/plgen/sweep-*)"
run car.spec --input long.csv --sweep many.csv --resume >resumed.csv
cp said log
same whole.csv resumed.csv 'resumed: the same bytes'
awk '/runs are done/ { exit !($2 >= 50 && $2 < 400 && $4 == 400) }' said
result $? 'what was done was not done again'
! ls "$XDG_CACHE_HOME"/plgen/sweep-* >/dev/null 2>&1
result $? 'nothing stays of a sweep that is done'
run car.spec --input long.csv --sweep many.csv --resume >resumed.csv
same whole.csv resumed.csv 'resumed where nothing is there'

# step as a param: of a tunable model by retuning, else by plgen; float; no inputs
printf 'step;w\n0,01;4\n0,02;5\n' >steps.csv
run "$models/sdcsf.spec" 1 --sweep steps.csv >steps_out.csv
run "$models/sdcsf.spec" 1 --step 0.02 -D w=5 | tail -n 1 | cut -d, -f 2- >last
[ "$(sed -n 3p steps_out.csv | cut -d, -f 4-7)" = "$(cat last)" ]
result $? 'another step, decimal commas'
run "$models/sdcsf.spec" 1 --sweep steps.csv --real float >float_out.csv
run "$models/sdcsf.spec" 1 --real float -D w=4 | tail -n 1 | cut -d, -f 2- >last
[ "$(sed -n 2p float_out.csv | cut -d, -f 4-7)" = "$(cat last)" ]
result $? 'float'

# events NAME SPEC VALUES PARAM=VALUE OPTION ...: its VALUES last values, as in a run with that param
events() {
	title=$1 spec=$2 values=$3 param=$4
	shift 4
	printf '%s\n%s\n' "${param%=*}" "${param#*=}" >events.csv
	run "$spec" --sweep events.csv "$@" >swept.csv && run "$spec" -D "$param" "$@" >rows.csv &&
		tail -n 1 rows.csv | cut -d, -f 2- >last
	[ -s last ] && [ "$(sed -n 2p swept.csv | cut -d, -f "3-$((2 + values))")" = "$(cat last)" ]
	result $? "$title"
	rm -f last
}
events 'friction' "$models/stick_slip.spec" 3 F=3 --until 3
events 'impacts' "$models/bouncing_ball.spec" 2 e=0.5 --until 3
awk 'BEGIN { print "u"; for (i = 0; i < 40; i++) print i % 7 }' >held.csv
events 'delays' "$(path_of tests/delays/echo.spec)" 3 d=0.35 --input held.csv

# two processes, where there is an mpirun and plrun takes part
mpi='mpirun --allow-run-as-root --oversubscribe -n 2'
if ! command -v mpirun >/dev/null; then
	skip 'MPI: 2 processes and 1' 'no mpirun'
elif $mpi "$plrun" car.spec --input road.csv --sweep params.csv --peak >mpi.csv 2>log; [ -s mpi.csv ] ||
	! grep -q 'built without MPI' log; then
	same one.csv mpi.csv 'MPI: 2 processes and 1'
	$mpi "$plrun" car.spec --input road.csv --sweep params.csv --peak --device >mpi.csv 2>log
	same one.csv mpi.csv 'MPI: 2 processes on a device'
	"$plrun" car.spec --input long.csv --sweep many.csv >part.csv 2>log &
	pid=$!
	kill_in_the_middle
	$mpi "$plrun" car.spec --input long.csv --sweep many.csv --resume >mpi.csv 2>log
	same whole.csv mpi.csv 'MPI: resumed'
	$mpi "$plrun" "$models/sdcsf.spec" 1 >mpi.csv 2>log
	[ ! -s mpi.csv ] && grep -q 'several processes share out a sweep, and nothing else' log
	result $? 'MPI: one run is refused'
else
	skip 'MPI: 2 processes and 1' 'plrun is built without MPI'
fi
tap_end
