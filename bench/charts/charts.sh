#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# charts.sh BUILD FOLDER [--quick]: all tables, and of them pictures and pages, FOLDER/index.html. Run at the top of the
# source tree; progress on standard error. What measures no time runs first, in two queues side by side; what measures
# time runs alone; draw.sh then makes of the tables what is looked at.
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

# ---- what measures no time ----

convergence() {
	say 'convergence of pl and exact in N'
	sh $charts/convergence.sh $quick "$plgen" "$variants"
	"$programs/convergence" $quick "$variants" "$folder"
}

plmap() {
	say 'pl against RK4 over step and coupling'
	sh $charts/plmap.sh $quick "$plgen" "$variants"
	"$programs/plmap" $quick "$variants" "$folder"
}

energy() {
	say 'energy and momentum in long runs'
	sh $charts/energy.sh "$plgen" "$variants"
	"$programs/energy" $quick "$variants" "$folder"
}

hard() {
	say 'hard cases'
	sh $charts/hard.sh "$plgen" "$variants"
	"$programs/hard" $quick "$variants" "$folder"
}

stability() {
	say 'stability, quality, largest steps'
	sh $charts/stability.sh $quick "$plgen" "$programs" "$folder"
}

structural() {
	say 'time integrators of structural dynamics, a frame under a record'
	sh $charts/frame.sh "$plgen" "$variants"
	"$programs/integrators" $quick "$folder"
	"$programs/frame" "$variants" "$folder"
}

less() {
	say 'what modelling less saves'
	sh $charts/less.sh "$plgen" "$programs/less" "$variants"
	"$programs/less" "$variants" "$folder"
}

# ---- what does ----

precision() {
	say 'work and precision'
	sh $charts/precision.sh "$plgen" "$programs/precision" "$folder" $quick
}

headline() {
	say 'the two comparisons that lead the page'
	sh $charts/headline.sh "$plgen" "$programs/headline" "$folder" $quick
}

papers() {
	say 'what the papers found'
	sh $charts/papers.sh $quick "$plgen" "$variants"
	"$programs/papers" $quick "$variants" "$folder"
}

generation() {
	say 'what generating costs'
	sh $charts/generation.sh $quick "$build" "$folder"
}

limits() {
	say 'how near to the machine'
	sh bench/limits/limits.sh $quick "$build" "$folder" >&2
}

# A list with && would go on after a failure inside a function
(energy; convergence; plmap; structural) &
first=$!
(hard; stability; less) &
second=$!
wait $first
wait $second
precision
generation
headline
papers
limits
say 'pictures and pages'
sh $charts/machine.sh "$build" "make charts${quick:+-quick}" >"$folder/machine.csv"
sh $charts/draw.sh "$folder" --png
say "done: $folder/index.html"
