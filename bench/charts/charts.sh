#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# charts.sh BUILD FOLDER [--quick]: all tables, and of them pictures and pages, FOLDER/index.html. Run at the top of the
# source tree; progress on standard error. What measures no time runs first, two jobs side by side (untimed.sh); what
# measures time runs alone; draw.sh then makes of the tables what is looked at.
set -e
build=$1 folder=$2 quick=
[ "$3" != --quick ] || quick=--quick
charts=bench/charts
programs=$build/bench/charts
plgen=$build/plgen
variants=$folder/variants
begin=$(date +%s)
# Only what an earlier run has made is removed
if [ -e "$folder" ] && ! [ -d "$folder/variants" ]; then
	echo "charts.sh: $folder is there, and not from here" >&2
	exit 1
fi
rm -rf "$folder"
mkdir -p "$variants"

say() {
	printf '[%4d s] %s\n' $(($(date +%s) - begin)) "$*" >&2
}

say 'what measures no time: untimed.sh'
sh $charts/untimed.sh "$build" "$folder" $quick
say 'work and precision'
sh $charts/precision.sh "$plgen" "$programs/precision" "$folder" $quick
say 'what generating costs'
sh $charts/generation.sh $quick "$build" "$folder"
say 'the two comparisons that lead the page'
"$programs/headline" $quick "$variants/headline" "$folder"
say 'times of what the papers compare'
"$programs/papers" $quick --times "$variants" "$folder"
say 'times of a mass that sticks and slips'
"$programs/friction" --times "$variants" "$folder"
say 'how near to the machine'
sh bench/limits/limits.sh $quick "$build" "$folder" >&2
say 'pictures and pages'
sh $charts/machine.sh "$build" "make charts${quick:+-quick}" >"$folder/machine.csv"
sh $charts/draw.sh "$folder" --png
say "done: $folder/index.html"
