#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs that are ended before their time: what is written is whole or as it was, and nothing that was started goes on.
#
#     ended.sh PLRUN PLGEN SOURCE_ROOT
. "${0%/*}/begin.sh"
cat >swing.spec <<'X'
model swing
coord x
x'' + 4*x = 0
init x = 1
step 0.1
X
run swing.spec 1 >whole.csv

# until_true COMMAND...: it holds at last
until_true() {
	tries=0
	until "$@"; do
		sleep 0.05
		tries=$((tries + 1))
		[ $tries -lt 2400 ] || return 1
	done
}

# ---- rows into a file ----
has_some() { [ -n "$(find out -name 'a.csv*' -size +8k)" ]; }
for signal in TERM KILL; do
	rm -rf out && mkdir out && echo 'as it was' >out/a.csv
	"$plrun" swing.spec 1e12 -o out/a.csv 2>said &
	pid=$!
	until_true has_some
	kill -s $signal $pid
	wait $pid 2>/dev/null
	status=$?
	left=$(ls out | tr '\n' ' ')
	echo "status $status, left: $left" >log
	[ $status -gt 128 ] && [ "$(cat out/a.csv)" = 'as it was' ] &&
		case $signal in KILL) true ;; *) [ "$left" = 'a.csv ' ] ;; esac
	result $? "-o FILE and SIG$signal: the file is as it was"
done
(umask 027 && run swing.spec 1 -o out/new.csv)
[ "$(stat -c %a out/new.csv)" = 640 ]
result $? '-o FILE: a new file has the mode of any other'
mkdir far && echo old >far/b.csv && chmod 604 far/b.csv && ln -s ../far/b.csv out/link.csv
run swing.spec 1 -o out/link.csv
[ -L out/link.csv ] && [ "$(stat -c %a far/b.csv)" = 604 ]
result $? '-o FILE: a link stays one, and a mode what it is'
same whole.csv far/b.csv '-o FILE: the file that a link names'
ln -s ../far/c.csv out/nowhere.csv && run swing.spec 1 -o out/nowhere.csv
same whole.csv far/c.csv '-o FILE: a link to what is not there yet'
mkfifo pipe
cat pipe >through.csv &
run swing.spec 1 -o pipe
wait
same whole.csv through.csv '-o FILE: a pipe'
cat >hard.spec <<'X'
model hard
coord x
x'' - x - x^3 = 0
init x = 10
step 0.1
scheme etdrk4
X
run hard.spec 10 >plain.csv
run hard.spec 10 -o out/hard.csv
[ $? -eq 1 ] && [ "$(wc -l <plain.csv)" -gt 2 ] && cmp plain.csv out/hard.csv
result $? '-o FILE: the rows before an error are there'

# ---- compilers ----
# A compiler that hangs, and what it has started: both hold the pipe `alive` open, whose reader sees them end.
cat >hanging <<X
#!/bin/sh
exec 9>"$work/alive"
sleep 200 &
: >"$work/started"
sleep 200
X
chmod +x hanging
mkfifo alive
CC=$work/hanging "$plrun" swing.spec 1 >rows.csv 2>said &
pid=$!
timeout 100 cat alive >ends 2>&1 &
reader=$!
until_true test -f started
kill -s TERM $pid
wait $pid
status=$?
wait $reader
ended=$?
echo "status $status, reader $ended, left: $(ls "$XDG_CACHE_HOME/plgen")" >log
[ $status -gt 128 ] && [ $ended -eq 0 ]
result $? 'a compiler ends with plrun, and what it has started'
! ls -d "$XDG_CACHE_HOME"/plgen/making.* >>log 2>&1
result $? 'the folder of its build goes'
tap_end
