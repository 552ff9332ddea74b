#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# rows.sh BUILD: what a million rows cost with runtime/host/plmain.c: as CSV, with --raw, and with a record of inputs of
# 17 digits each; a sweep of 1000 rows, beside a loop over NAME_step. Whole processes, their output thrown away.
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$build/plgen" --fast -o "$work/sdcsf_pl.c" models/sdcsf.spec
gcc -O2 -Iruntime runtime/host/plmain.c "$work/sdcsf_pl.c" runtime/*.c -DMODEL=sdcsf -o "$work/sdcsf"
printf "model driven\ncoord x\ninput u hold first\nx'' + 0.2*x' + 40*x = u\nstep 0.001\noutput x\n" >"$work/driven.spec"
"$build/plgen" --fast -o "$work/driven_pl.c" "$work/driven.spec"
gcc -O2 -Iruntime runtime/host/plmain.c "$work/driven_pl.c" runtime/*.c -DMODEL=driven -o "$work/driven"
awk 'BEGIN { srand(1); for (k = 0; k <= 1000000; k++) printf "%.17g\n", rand() - 0.5 }' >"$work/record.csv"

# least NAME COMMAND ...: of five runs, in time of the processor
least() {
	name=$1
	shift
	for run in 1 2 3 4 5; do
		sh -c '"$@" >/dev/null; times' sh "$@" | tail -n 1
	done | tr 'ms' '  ' | awk -v name="$name" '
		{ t = 60 * $1 + $2 + 60 * $3 + $4; if (NR == 1 || t < least) least = t }
		END { printf "    %-44s %5.2f s\n", name, least }'
}

echo 'a million rows of plmain, gcc -O2:'
least 'sdcsf, t and four outputs, as CSV' "$work/sdcsf" 10000
least 'the same, --raw' "$work/sdcsf" 10000 --raw
least 'one input of 17 digits, two columns, as CSV' sh -c 'exec "$0" 1000 <"$1"' "$work/driven" "$work/record.csv"
least 'the same, --raw' sh -c 'exec "$0" 1000 --raw <"$1"' "$work/driven" "$work/record.csv"

# The values of a sweep's line, by NAME_step and NAME_out of each row
cat >"$work/loop.c" <<END
#include <math.h>
#include <stdio.h>
#include "swept_pl.h"
int main(void)
{
	for (int row = 0; row < 1000; row++) {
		const double c1[] = { 0.4 + 0.2 * row / 999 };
		double out[SWEPT_OUTPUTS], squares[SWEPT_OUTPUTS] = { 0 };
		swept_coeffs c;
		swept s;
		swept_init(&s);
		if (swept_retune(&c, c1, SWEPT_H) != 0)
			return 1;
		swept_use(&s, &c);
		for (long k = 1; k <= 100000; k++) {
			swept_step(&s);
			swept_out(&s, out);
			for (int i = 0; i < SWEPT_OUTPUTS; i++)
				squares[i] += out[i] * out[i];
		}
		for (int i = 0; i < SWEPT_OUTPUTS; i++)
			printf("%.17g,%.17g\\n", out[i], sqrt(squares[i] / 100001));
	}
	return 0;
}
END
echo 'a sweep of 1000 rows of 100,000 steps, four outputs:'
for model in sdcs sdcsf; do
	"$build/plgen" --fast --tunable c1 --prefix swept -o "$work/swept_pl.c" models/$model.spec
	gcc -O2 -Iruntime -I"$work" "$work/loop.c" "$work/swept_pl.c" runtime/*.c -lm -o "$work/loop"
	least "$model, plrun --sweep --jobs 1" "$build/plrun" models/$model.spec 1000 --sweep c1=0.4:0.6:1000 --jobs 1
	least 'the same by NAME_step and NAME_out' "$work/loop"
done
