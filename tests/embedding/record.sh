#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Recorded inputs through runtime/host/plmain.c: row k is the sample at t = k h.  Against the closed form of the same
# model with the record written into its equations, as a table in time for a ramp and as a change of formula at every
# sample for an input that is held.  And what plmain says.
#
#     record.sh PLGEN SOURCE_ROOT
root=$2
. "${0%/*}/../plgen.sh"
plmain=$root/runtime/host/plmain.c
for real in double float; do
    ${CC:-cc} -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror $([ $real = double ] || echo -DFLOAT) \
		-I"$root/runtime" -DMODEL=rec -c "$plmain" -o plmain.o >log 2>&1
	result $? "plmain.c in $real compiles without a warning"
done

# driver FILE.c NAME PROGRAM [FLAGS]
driver() {
	# shellcheck disable=SC2086
	$run_cc ${4-} -I"$root/runtime" -DMODEL="$2" "$plmain" "$1" "$archive" -lm -o "$3" >>log 2>&1
}

# 41 samples of two inputs, 0.05 s apart, neither 0 at the start
awk 'BEGIN { print "u,v"; for (k = 0; k <= 40; k++) printf "%d,%d\n", (k * 37 + 11) % 23 - 8,
	(k * 53 + 5) % 29 - 20 }' >rows.csv

# as_load COLUMN RAMP: the record as an expression of t
as_load() {
	awk -F, -v column="$1" -v ramp="$2" 'NR > 1 { u[n++] = $column }
        END { if (ramp) { printf "table(t"; for (k = 0; k < n; k++) printf "; %d/20, %d", k, u[k]; printf ")" }
              else { for (k = 0; k < n - 1; k++) printf "(t < %d/20 ? %d : ", k + 1, u[k]; printf "%d", u[n - 1];
				  for (k = 0; k < n - 1; k++) printf ")" } }' rows.csv
}

# spec DECLARATION OUTPUTS [SLOPES]
spec() {
	printf 'model rec\ncoord x, y\n%b\ninit x = 0.5\n' "$1"
	printf "2*x'' + 0.4*x' + 30*x - 5*y = 3*u + 0.7*v%s\ny'' + 0.2*y' + 12*y - 5*x = v - u\n" "${3-}"
	printf 'output x, y%s\nstep 0.05\n' "$2"
}

# near FOUND EXPECTED BOUND: each column within BOUND of its largest value
near() {
	awk -F, -v bound="$3" '
		FNR == NR { rows = FNR; for (i = 1; i <= NF; i++) { e[FNR, i] = $i; v = $i < 0 ? -$i : +$i;
			if (FNR > 1 && v > most[i]) most[i] = v } columns = NF; next }
		FNR == 1 { next }
		{ if (NF != columns) { print "row " FNR ": found " NF " columns, expected " columns; bad = 1 }
		  for (i = 1; i <= NF; i++) { d = $i - e[FNR, i]; if (d < 0) d = -d
			  if (!(d <= bound * most[i]) && shown++ < 5) {
                  print "row " FNR " column " i ": found " $i ", expected " e[FNR, i] ", tolerance " bound * most[i];
				  bad = 1 } } last = FNR }
		END { if (last != rows || rows < 42) { print "rows: found " last ", expected " rows ", 42 or more";
			bad = 1 } exit bad ? 1 : 0 }' "$2" "$1" >>log 2>&1
}

# form TITLE STATEMENTS RAMP_U RAMP_V COLUMNS
form() {
	outputs=
	slopes=
	[ "$3" = 0 ] || outputs="$outputs, a = 2*u" slopes="$slopes + 0.3*u'"
	[ "$4" = 0 ] || outputs="$outputs, b = v - x"
	spec "$2" "$outputs" "$slopes" >rec.spec
	# the slope of a table, by hand
	by_slope=$slopes
	if [ -n "$slopes" ]; then
		by_slope=$(awk -F, 'NR > 1 { u[n++] = $1 } END { printf " + 0.3*";
			for (k = 0; k < n - 2; k++) printf "(t < %d/20 ? %d : ", k + 1, 20 * (u[k + 1] - u[k])
			printf "%d", 20 * (u[n - 1] - u[n - 2]); for (k = 0; k < n - 2; k++) printf ")" }' rows.csv)
	fi
	{ spec "let u = $(as_load 1 "$3")\nlet v = $(as_load 2 "$4")" "$outputs" "$by_slope"; } >closed.spec
	: >log
	"$plgen" --solution 2 closed.spec >expected.csv 2>>log
	result $? "$1: the record as loads"
	for real in double float; do
		bound=1e-13
		flags=
		[ $real = double ] || bound=2e-6 flags=-DFLOAT
		for options in '' '--accuracy compensated'; do
			: >log
			# shellcheck disable=SC2086
			"$plgen" --real $real $options rec.spec >rec.c 2>>log && driver rec.c rec rec "$flags" &&
				./rec 2 <rows.csv >found.csv 2>>log && near found.csv expected.csv $bound
			result $? "$1, $real${options:+, compensated}: 40 steps of the record are its closed form \
within $bound of the largest value"
		done
	done
	"$plgen" --header rec.spec >log && grep -q "rec_Gamma\[REC_STATES\]\[$5\];" log
	result $? "$1: Gamma has $5 columns"
	sed 's/^step/tunable k\nstep/; s/^coord/param k = 30\ncoord/; s/30\*x/k*x/' rec.spec >tuned.spec
	: >log
	"$plgen" tuned.spec >rec.c 2>>log && driver rec.c rec rec && ./rec 2 <rows.csv >found.csv 2>>log &&
		near found.csv expected.csv 1e-13
	result $? "$1, tunable: the same"
}

form 'input u, v hold first' 'input u, v hold first' 1 1 4
form 'input u hold first, v' 'input u hold first, v' 1 0 3
form 'input u hold first, v hold first' 'input u hold first, v hold first' 1 1 4
form 'a statement for each' 'input u\ninput v hold first' 0 1 3
form 'input u, v' 'input u, v' 0 0 2

# ---- a record that ends early ----

# says TITLE STATUS PATTERN ROWS: of ./rec 2 with so many lines of rows.csv; and so many rows of output
says() {
	head -n "$4" rows.csv | ./rec 2 >found.csv 2>log
	status=$?
	[ $status -eq "$2" ] && { [ -z "$3" ] && [ ! -s log ] || grep -q -e "${3:-.}" log; } &&
		[ "$(wc -l <found.csv)" -eq "$5" ]
	status=$?
	echo "$(wc -l <found.csv) lines, expected $5; expected '$3'" >>log
	result $status "$1"
}
spec 'input u, v' '' >rec.spec
: >log
"$plgen" rec.spec >rec.c && driver rec.c rec rec
says 'held: 40 rows are enough for 40 steps' 0 '' 41 42
says 'held: the row that is missing' 1 'too few samples: expected row 39, of t = 1.95, found the end of the file' 40 41
says 'held: how many it takes' 1 '^note: 40 steps take rows 0 to 39$' 1 2
spec 'input u, v hold first' '' >rec.spec
: >log
"$plgen" rec.spec >rec.c && driver rec.c rec rec
says 'ramps: 41 rows are enough for 40 steps' 0 '' 42 42
says 'ramps: the row that is missing' 1 'too few samples: expected row 40, of t = 2, found the end of the file' 41 41
says 'ramps: how many it takes' 1 '^note: 40 steps take rows 0 to 40: a ramp starts at row 0' 41 41
says 'ramps: not even the first' 1 'expected row 0, of t = 0, found' 1 0

# ---- where the state is before the first step ----

# In contact from the start on, and so not crossed into: as the same model with the sample as a param.
for model in 'touch\ncoord x\ninput u hold first' 'fixed\nparam u = -1\ncoord x'; do
    printf "model %b\nx'' + 0.2*x' + 4*x + 10*max(x - u, 0) = 0\noutput x\nstep 0.05\n" "$model" >"${model%%\\*}.spec"
done
cat >touch.c <<'EOF'
#include "touch_pl.h"
#include "fixed_pl.h"
#include <stdio.h>
int main(void)
{
    const double u[1] = {-1};
    touch s;
    fixed f;
    int k, bad = 0;
    touch_init(&s);
    touch_model.hold(&s, u);
    fixed_init(&f);
    for (k = 0; k < 200; k++) {
        const double d = s.y[0] - f.y[0];
        if (touch_crossed(&s) != fixed_crossed(&f) || !(d < 1e-12 && d > -1e-12)) {
            printf("step %d: crossed %d, x = %.17g; expected %d, %.17g\n", k, (int)touch_crossed(&s), s.y[0],
                (int)fixed_crossed(&f), f.y[0]);
            bad = 1;
            break;
        }
        touch_step(&s, u);
        fixed_step(&f);
    }
    printf("%d crossings\n", (int)fixed_crossed(&f));
    return bad || fixed_crossed(&f) == 0;
}
EOF
"$plgen" -o touch_pl.c touch.spec 2>log && "$plgen" -o fixed_pl.c fixed.spec 2>>log &&
	$run_cc -I"$root/runtime" touch.c touch_pl.c fixed_pl.c "$archive" -o touch >>log 2>&1 && ./touch >>log
result $? 'piecewise linear: held before the first step, the sample decides the region, and nothing is crossed'

# ---- the other type; times ----

printf "model two\nparam k = 4\ntunable k\ncoord x\ninit x = 1\nx'' + k*x = 0\nstep 0.01\n" >two.spec
: >log
mkdir later && cp "$root"/runtime/*.h later && sed -i 's/PL_MODEL_VERSION = [0-9]*/PL_MODEL_VERSION = 99/' later/plrt.h
"$plgen" two.spec >two.c && $run_cc -Ilater -c two.c -o later.o 2>>log &&
	$run_cc -I"$root/runtime" -DMODEL=two "$plmain" later.o "$archive" -lm -o later_two 2>>log &&
	./later_two 1 >found.csv 2>said
[ $? -eq 2 ] && [ ! -s found.csv ] && grep -q 'whose descriptors have version 99, and plmain.c with one of version' said
result $? 'a model compiled with a plrt.h of another version: told'
for real in double float; do
	other=-DFLOAT
	is=with
	[ $real = double ] || other= is=without
	: >log
	"$plgen" --real $real two.spec >two.c && driver two.c two two "$other" && ./two 1 >found.csv 2>said
	status=$?
	cat said >>log
	[ $status -eq 2 ] && [ ! -s found.csv ] &&
		grep -q "^two: error: plmain.c was compiled $is -DFLOAT, and the model is in $real$" said &&
		grep -q 'note: -DFLOAT is for' said
	result $? "plmain compiled $is -DFLOAT, a model in $real: told"
	sed '/tunable/d' two.spec >fixed.spec       # its time is k/100, not k times what h was rounded to
	own=-DFLOAT
	[ $real = float ] || own=
	"$plgen" --real $real fixed.spec >two.c && driver two.c two two "$own" && ./two 2 >found.csv 2>>log
	awk -F, 'NR > 1 { t = NR - 2; want = int(t / 100); rest = t % 100
		if (rest) { want = want "." (rest < 10 ? "0" rest : rest); sub(/0$/, "", want) }
		if ($1 != want && shown++ < 5) print "row " NR ": found " $1 ", expected " want } END {
			if (NR != 202) print NR " lines, expected 202" }' found.csv >log
	[ ! -s log ]
	result $? "times of $real in as few digits as read back the same"
done

tap_end
