#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Independent parts of a piecewise-linear model: how large its C is, what is said of it, and the target float.
#
#     parts.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"
here=$root/tests/switching
awk -f "$root/tests/cases.awk" "$root/tests/switching/specs.cases" >names || exit 99

size=$("$plgen" five.spec | wc -c)
[ "$size" -gt 10000 ] && [ "$size" -le 102400 ] ||
	{ echo "$size bytes, 102400 at most expected" >log; false; }
result $? 'five stops: less than 100 KB of C'

# The number of a region is the sum of its parts' shares, each in 0 .. 242 once.
"$plgen" --explain=json five.spec >json 2>log
tr -d ' \n' <json | sed 's/.*"parts":\[//; s/"cost".*//; s/"coordinates"/\n&/g' |
	sed -n 's/.*"regions":\[\([^]]*\).*/\1/p' | sed 's/{"number":\([0-9]*\),"matrix":[0-9]*}/\1/g; s/,/ /g' >shares
awk '{ split("", next_sums); m = 0
	   for (i = 1; i <= NF; i++) for (s = 0; s < (NR == 1 ? 1 : n); s++) 
				next_sums[m++] = (NR == 1 ? 0 : sum[s]) + $i
	   for (s = 0; s < m; s++) sum[s] = next_sums[s]
	   n = m }
	 END { for (s = 0; s < n; s++) { if (seen[sum[s]]++) bad++; if (sum[s] < 0 || sum[s] > 242) bad++ }
		   if (n != 243 || bad) { print n " numbers of 243, " bad + 0 " of them wrong"; exit 1 } }' shares >log
result $? 'five stops: 243 numbers of regions, each once'

# coords PARTS WHAT: of the spec on standard input, the coordinates of each part
coords() {
	"$plgen" --explain=json - >json 2>log
	sed -n 's/.*"coordinates": \[\([^]]*\)\].*/\1;/p' json | tr -d '\n" ' >log
	echo >>log
	[ "$(cat log)" = "$1" ]
	result $? "$2"
}
stops="model m
coord x, y, z
input f
step 0.01
"
coords 'x;y;z;' 'a linear coordinate beside two stops: three parts' <<EOF
$stops
x'' + x + max(x - f, 0) = 0
y'' + y + max(y - f, 0) = 0
z'' + z = f
EOF
coords 'x,y;z;' 'an input with breakpoints in two equations: one part' <<EOF
$stops
x'' + x + max(f, 0) = 0
y'' + y - min(-2*f, 0) = 0
z'' + z = f
EOF
coords 'x,z;y;' 'brought together inside a stop that chooses another' <<EOF
$stops
x'' + x + max(max(x, 1) + (x > 3 ? z : 0), 2) = 0
y'' + y + max(y, 0) = 0
z'' + z = f
EOF
coords '' 'a body that is free: all regions together' <<EOF
$stops
x'' + 5*deadzone(x - y, -1, 1) = f
y'' - 5*deadzone(x - y, -1, 1) = 0
z'' + z + max(z, 0) = f
EOF
"$plgen" --explain drive_free.spec 2>&1 | grep -c 'independent parts' >log
[ "$(cat log)" = 0 ]
result $? 'a drive that is free as a whole: no word of parts'
printf '%s\n' "$stops" "x'' + 5*deadzone(x - y, -1, 1) = f" "y'' - 5*deadzone(x - y, -1, 1) = 0" \
	"z'' + z + max(z, 0) = f" | "$plgen" --explain - 2>&1 | grep 'independent parts' >log
[ "$(cat log)" = 'Rigid-body modes: 2 independent parts have their regions together.' ]
result $? 'a body that is free: it is said that regions are together'

# Each as one alone, in float: by the search
cat >float.c <<'EOF'
#include "parts.h"
#include "part_x.h"
#include "part_y.h"
#include <stdio.h>
int main(void)
{
	parts all;
	part_x x;
	part_y y;
	float most = 0;
	parts_init(&all);
	part_x_init(&x);
	part_y_init(&y);
	for (int k = 0; k < 3000; k++) {
		const float u[1] = { k % 40 < 20 ? 0.9f : -0.3f };
		float state[6], of_x[2], of_y[2], off[4];
		parts_step(&all, u);
		part_x_step(&x, u);
		part_y_step(&y, u);
		parts_get(&all, state);
		part_x_get(&x, of_x);
		part_y_get(&y, of_y);
		off[0] = state[0] - of_x[0];
		off[1] = state[3] - of_x[1];
		off[2] = state[1] - of_y[0];
		off[3] = state[4] - of_y[1];
		for (int i = 0; i < 4; i++) {
			const float size = off[i] < 0 ? -off[i] : off[i];
			if (!(size <= most))
				most = size;
		}
		if (parts_region(&all) != part_x_region(&x) + 2 * part_y_region(&y)) {
			printf("step %d: region %d\n", k, parts_region(&all));
			return 1;
		}
	}
	printf("# float, 3000 steps: off by %g at most, %d crossings\n", (double)most,
		   (int)parts_crossed(&all));
	if (!(most <= 1e-4f))
		printf("1e-4 at most expected\n");
	return !(most <= 1e-4f && parts_crossed(&all) == part_x_crossed(&x) + part_y_crossed(&y) &&
		 parts_crossed(&all) > 50 && parts_status(&all) == 0);
}
EOF
"$plgen" --real float -o parts.c parts.spec >log 2>&1 &&
	for one in x y; do
		[ $one = x ] && others=yz || others=xz
		sed "/of [$others]\$/d" parts.spec |
			"$plgen" --real float --prefix part_$one -o part_$one.c - || exit 99
	done >>log 2>&1 &&
	gcc -std=c99 -O1 -Wall -Wextra -Wconversion -Wdouble-promotion -Werror -I"$root/runtime" -I. float.c parts.c \
		part_x.c part_y.c "$archive" -o float >>log 2>&1 &&
	./float >>log 2>&1
result $? 'parts in float: each as one alone'
grep '^# ' log

# Events beyond the most of one part are not those of another, nor written behind its list.
cat >few_main.c <<'EOF'
#include "few.h"
#include "few_x.h"
#include "few_y.h"
#include <stdio.h>
int main(void)
{
	few all;
	few_x x;
	few_y y;
	int both = 0;
	few_init(&all);
	few_x_init(&x);
	few_y_init(&y);
	for (int k = 0; k < 200; k++) {
		pl_crossing list[FEW_MAX_EVENTS], alone[2][2];
		int count, of[2], seen[2] = {0, 0};
		few_step(&all);
		few_x_step(&x);
		few_y_step(&y);
		count = few_crossings(&all, list);
		of[0] = few_x_crossings(&x, alone[0]);
		of[1] = few_y_crossings(&y, alone[1]);
		both += of[0] == 2 && of[1] > 0;
		for (int i = 0; i < count && count == of[0] + of[1]; i++) {
			const int part = list[i].expression, at = seen[part]++;
			if (at >= of[part] || list[i].time != alone[part][at].time)
				seen[part] = 9;
		}
		if (seen[0] != of[0] || seen[1] != of[1]) {
			printf("step %d: %d listed, %d and %d alone\n", k, count, of[0], of[1]);
			return 1;
		}
	}
	printf("# events of both in %d steps\n", both);
	return !(both > 3 && few_status(&all) == few_x_status(&x) && few_status(&all) == PL_TOO_MANY_EVENTS);
}
EOF
cat >few.spec <<'EOF'
model few
coord x, y
init x = 1, y = 0.3
x'' + 0.01*x' + 9000*x + 2000*max(x, 0) = 0
y'' + 0.1*y' + 12*y + 30*max(y - 0.1, 0) = cos(2*t)
step 0.2
events at most 2 a step
EOF
{
	"$plgen" -o few.c few.spec &&
		sed '/^y/d; s/, y$//; s/, y = 0.3//' few.spec | "$plgen" --prefix few_x -o few_x.c - &&
		sed '/^x/d; s/coord x, y/coord y/; s/x = 1, //' few.spec | "$plgen" --prefix few_y -o few_y.c - &&
		$run_cc -I"$root/runtime" -I. few_main.c few.c few_x.c few_y.c "$archive" -o few && ./few
} >log 2>&1
result $? 'more events than a part may have: its own list alone'
grep '^# ' log

tap_end
