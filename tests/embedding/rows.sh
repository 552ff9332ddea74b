#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What runtime/host/plmain.c writes: its rows against those of a program that steps the model itself, CSV read by the C
# library and --raw by the bytes; and that a row which cannot be written ends the run.
#
#     rows.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"

# Numbers of every size: a decaying mode, a large one, states that are 0
cat >rows.spec <<'EOF'
model rows
coord x, y
init x = 1, y = -3
x'' + 8*x' + 17*x = 0
y'' - y = 0
output x, large = 1e12*y, y', zero = 0*x
output small = 1e-250*x
step 0.1
EOF
sed 's/1e-250/1e-20/' rows.spec >rows_float.spec

# steps FILE.csv FILE.raw ROWS: every number of both, by its bits
cat >steps.c <<'EOF'
#include "rows_pl.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef FLOAT
typedef float real;
#define READ strtof
#else
typedef double real;
#define READ strtod
#endif

enum { COLUMNS = ROWS_OUTPUTS + 1 };

int main(int argc, char **argv)
{
	FILE *csv = fopen(argv[1], "r"), *raw = fopen(argv[2], "rb");
	const int count = argc > 3 ? atoi(argv[3]) : 0;
	char line[1000], *p = line;
	int bad = 0, most = 0, k, i;
	struct rows s;
	rows_init(&s);
	if (!csv || !raw || !fgets(line, sizeof line, csv) || strcmp(line, "t,x,large,y',zero,small\n") != 0)
		return 2;
	for (k = 0; k < count && bad < 5; k++) {
		real value[COLUMNS], read[COLUMNS];
		value[0] = rows_time(&s);
		rows_out(&s, value + 1);
		if (!fgets(line, sizeof line, csv) || fread(read, sizeof *read, COLUMNS, raw) != COLUMNS) {
			printf("row %d is missing\n", k);
			return 1;
		}
		for (i = 0, p = line; i < COLUMNS; i++) {
			char *const start = p;
			const real text = READ(p, &p);
			const real shown = value[i] == 0 ? 0 : value[i]; /* -0 is written as 0 */
			const char expected = i + 1 < COLUMNS ? ',' : '\n';
			if (p - start > most)
				most = (int)(p - start);
			if (memcmp(&text, &shown, sizeof text) != 0 || memcmp(&read[i], &value[i], sizeof text) != 0 ||
                *p++ != expected) {
				printf("row %d, column %d: CSV %.17g, raw %.17g, expected %.17g: %s", k, i,
					(double)text,
					(double)read[i], (double)value[i], line);
				bad++;
			}
		}
		rows_step(&s);
	}
	if (!bad && (fgets(line, sizeof line, csv) || fgetc(raw) != EOF)) {
		printf("more than %d rows\n", count);
		bad = 1;
	}
	printf("%d characters at most\n", most);
	return bad != 0;
}
EOF

for real in double float; do
	define=
	spec=rows.spec
	[ $real = double ] || define=-DFLOAT spec=rows_float.spec
	: >log
	# shellcheck disable=SC2086
	"$plgen" --real $real -o rows_pl.c $spec 2>>log &&
		$run_cc $define -I"$root/runtime" steps.c rows_pl.c "$archive" -o steps >>log 2>&1 &&
		$run_cc $define -DMODEL=rows -I"$root/runtime" "$root/runtime/host/plmain.c" rows_pl.c \
			"$archive" -o run >>log 2>&1 &&
		./run 20 >rows.csv 2>>log && ./run 20 --raw >rows.raw 2>>log && ./steps rows.csv rows.raw 201 >>log
	result $? "$real: 201 rows as CSV and --raw are those of the steps, bit by bit"
	: >log
	./run --raw 20 2>>log | cmp - rows.raw >>log 2>&1 && [ ! -s log ]
	result $? "$real: --raw before the time is the same"
done

# ---- what cannot be written ----

# full TITLE STATUS ARGUMENT ...: of a run onto a device that takes nothing
full() {
	title=$1
	shift
	./run "$@" >/dev/full 2>log
	status=$?
	echo "status $status, expected 1" >>log
	[ $status -eq 1 ] &&
		[ "$(head -n 1 log)" = 'rows: error: cannot write to standard output: No space left on device' ]
	result $? "nothing can be written: $title"
}
if [ -c /dev/full ]; then
	full 'one row, at the end' 0
	full 'while the run goes on' 20
	full 'binary' 20 --raw
	full 'binary, one row' --raw 0
else
	skip 'nothing can be written' 'there is no /dev/full'
fi
tap_end
