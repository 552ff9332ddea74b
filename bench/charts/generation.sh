#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# generation.sh [--quick] BUILD FOLDER: what generating costs. Run at the top of the source tree,
# after precision.
#
# FOLDER/generation.csv: for each model of FOLDER/precision_raw.csv the time of plgen and of cc -O2 -c on what it wrote,
# whole processes in turn with an empty one (bench/clock.c); minimum, median and maximum in milliseconds, as measured:
# the empty one's stand beside them.
set -e
runs=7
if [ "$1" = --quick ]; then
	runs=3
	shift
fi
[ -z "${CHARTS_ONCE:-}" ] || runs=1
build=$1 folder=$2
compiler=${CC:-cc}              # words: a compiler behind a cache
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
echo 'int main(void) { return 0; }' >"$work/empty.c"
$compiler -O2 "$work/empty.c" -o "$work/empty"

# measure COMMAND...: minimum,median,maximum,median of the empty program
measure() {
	"$build/bench/clock" $runs "$work/empty" -- "$@" 2>/dev/null |
		sed 's/.* min *\([0-9.]*\) *median *\([0-9.]*\) *max *\([0-9.]*\) ms/\1,\2,\3/' |
		awk -F, 'NR == 1 { printf "%s,", $0 } NR == 2 { print $2 }'
}

columns=model,bytes_of_C,generate_ms_min,generate_ms_median,generate_ms_max
columns=$columns,compile_ms_min,compile_ms_median,compile_ms_max,empty_ms_median,samples
echo "$columns" >"$folder/generation.csv"
awk -F, 'NR > 1 && !seen[$1]++ { print $1 }' "$folder/precision_raw.csv" >"$work/models"
while read -r model; do
	echo "generation: $model" >&2
	spec=bench/charts/specs/$model.spec
	[ -f "$spec" ] || spec=models/$model.spec
	"$build/plgen" "$spec" 2>/dev/null >"$work/$model.c"
	generate=$(measure "$build/plgen" "$spec")
	compile=$(measure $compiler -O2 -Iruntime -c "$work/$model.c" -o "$work/$model.o")
	if [ -z "$generate" ] || [ -z "$compile" ]; then
		echo "generation.sh: $model: no time" >&2
		exit 1
	fi
	echo "$model,$(wc -c <"$work/$model.c"),${generate%,*},$compile,$runs" >>"$folder/generation.csv"
done <"$work/models"
