#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Regions whose matrices the target makes when it meets them: against tables of all of them, against a Taylor series of
# the equations as written, and whatever was kept before.
#
#     cached.sh PLGEN PLRUN SOURCE_ROOT
plrun=$(realpath "$2")
root=$3
. "${0%/*}/../plgen.sh"
CC=${run_cc%% *} CFLAGS=${run_cc#* }
export CC CFLAGS

# stops NAME NUMBER TERM [LINE ...]: a chain of masses, each with that term of X and its gap G, or with a slider Z
stops() {
	name=$1 number=$2 term=$3
	shift 3
	{
		awk -v name="$name" -v n="$number" -v term="$term" 'BEGIN {
			print "model " name "\nparam g = 0.01\ninput u"
			for (i = 1; i <= n; i++) {
				print "coord x" i "\ninit x" i "\047 = " (i % 2 ? 1 : -1) * (0.4 + 0.03 * i)
				sum = "800*x" i " + 1.2*x" i "\047"
				sum = sum (i > 1 ? " - 400*x" i - 1 " - 0.6*x" i - 1 "\047" : "")
				own = term
				if (gsub(/Z/, "z" i, own)) {
					print "coord z" i
					slides = slides "friction(z" i "\047, " 1 + i / 50 ") + 900*(z" i " - x" i ")" \
						" = 0\n"
				}
				gsub(/X/, "x" i, own)
				gsub(/G/, "(g*" 1 + i / 100 ")", own)
				of[i] = sum " + " own " = " (i == 1 ? "u" : i == 2 ? "(t < 0.213 ? 3*cos(7*t) : 1)" : 0)
			}
			for (i = 1; i <= n; i++)
				print "x" i "\047\047 + " (i < n ? "-400*x" i + 1 " - 0.6*x" i + 1 "\047 + " : "") of[i]
			printf "%sstep 0.01\n", slides }'
		printf '%s\n' "$@"
	} >"$name.spec"
}
awk 'BEGIN { print "t,u"; for (k = 0; k <= 100; k++) print k / 100 "," sin(k / 7) }' >u.csv

# run NAME TIME: its states, NAME.csv
run() {
	"$plrun" "$1.spec" "$2" --input u.csv >"$1.csv" 2>log
}

# near A B WITHIN WHAT: two runs, of each column the largest difference over the largest size
near() {
	awk -F, -v within="$3" 'FNR == 1 { file++; next }
		file == 1 { for (i = 2; i <= NF; i++) {
			a[FNR, i] = $i; s = $i < 0 ? -$i : $i; if (s > most[i]) most[i] = s } }
		file == 2 { rows++; for (i = 2; i <= NF; i++) { d = a[FNR, i] - $i; if (d < 0) d = -d; d /= most[i]
					if (!(d <= off)) off = d } }
		END { print "# off by " off ", " within " at most, in " rows " rows"
			exit !(rows > 20 && off <= within) }' \
		"$1.csv" "$2.csv" >log
	met=$?
	cat log
	result $met "$4"
}

one='5000*max(X - G, 0)' two='5000*deadzone(X, -g, G)' rubs="friction(X' - 0.1, 150*G, 170*G)" slides='900*(X - Z)'
# beside NUMBER TERM KEPT WHAT: with so many matrices kept, and with tables of all regions
beside() {
	stops tables "$1" "$2" && run tables 1
	stops few "$1" "$2" "regions cached $3" && run few 1
	near tables few 2e-13 "$4, $3 matrices kept: as by tables of all regions"
}
beside 5 "$one" 3 '5 stops'
! merging || beside 4 "$two" 4 '4 stops on both sides'
! merging || beside 4 "$rubs" 8 '4 masses on belts'
! merging || beside 4 "$slides" 8 '4 sliders without mass'
if merging; then
	stops many 12 "$rubs" && run many 0.3
	stops series 12 "$rubs" 'scheme taylor' 'tolerance 1e-14' && run series 0.3
	near many series 2e-12 '12 masses on belts: as by a Taylor series from event to event'
fi
stops many 12 "$one" && run many 0.5
stops series 12 "$one" 'scheme taylor' 'tolerance 1e-14' && run series 0.5
near many series 2e-12 '12 stops, by default: as by a Taylor series from crossing to crossing'
stops many 12 "$one" 'regions cached 2' && mv many.csv kept.csv && run many 0.5
[ -s kept.csv ] && cmp many.csv kept.csv >log
result $? 'the bits are the same whatever is kept'
# small TERM WHAT
small() {
	stops many 12 "$1" && size=$("$plgen" many.spec | wc -c)
	echo "$size bytes, 307200 at most expected" >log
	[ "$size" -gt 10000 ] && [ "$size" -le 307200 ]
	result $? "$2, 531441 regions: less than 300 KB of C"
}
small "$slides" '12 sliders'
small "$two" '12 stops on both sides'

# NAME_at meets regions, too, and their matrices take the places of others.
stops many 12 "$one" 'regions cached 2'
cat >between.c <<'END'
#include "many.h"
#include <stdio.h>
static many a, b;
int main(void)
{
	uint64_t met = 0;
	many_init(&a);
	many_init(&b);
	for (int k = 0; k < 60; k++) {
		const double u[1] = { k % 7 / 3.0 };
		double y[MANY_STATES], z[MANY_STATES];
		many_at(&a, u, 0.7 * MANY_H, y);
		many_step(&a, u);
		many_step(&b, u);
		many_get(&a, y);
		many_get(&b, z);
		for (int i = 0; i < MANY_STATES; i++)
			if (y[i] < z[i] || y[i] > z[i] || !(y[i] - y[i] == 0)) {
				printf("step %d, state %d: %.17g, %.17g expected\n", k, i, y[i], z[i]);
				return 1;
			}
		met = many_crossed(&a);
	}
	printf("%lu crossings\n", (unsigned long)met);
	return met < 10;
}
END
"$plgen" many.spec -o many.c >log 2>&1 &&
	$run_cc -I"$root/runtime" between.c many.c "$archive" -lm -o between >log 2>&1 && ./between >log
result $? 'NAME_at between steps changes none of their bits'

# The self-test of so many has states that the same steps came to.
printf '%s\n' '#include <stdio.h>' 'double many_selftest(void);' \
	'int main(void) { double off = many_selftest();' \
	'printf("%g, 10 at most expected\\n", off); return !(off <= 10); }' \
	>self.c
stops many 12 "$two"
"$plgen" --selftest -o many.c many.spec 2>log &&
	$run_cc -I"$root/runtime" self.c many.c "$archive" -lm -o self >>log 2>&1 && ./self >log
result $? '12 stops on both sides: the self-test'
tap_end
