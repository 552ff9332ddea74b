#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# charts.sh BUILD FOLDER [--quick]: all charts and the page FOLDER/index.html. Run at the top of the source tree;
# progress on standard error. What measures no time runs first, in two queues side by side; what measures time runs
# alone.
set -e
build=$1 folder=$2 quick=
[ "$3" != --quick ] || quick=--quick
charts=bench/charts
programs=$build/bench/charts
plgen=$build/plgen
variants=$folder/variants
begin=$(date +%s)
LC_ALL=C.UTF-8                      # for gnuplot, whose titles have Greek letters
export LC_ALL
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

draw() {
	gnuplot -c "$charts/$1.gp" "$2" "$folder"
}

# ---- what measures no time ----

convergence() {
	say 'convergence of pl and exact in N'
	sh $charts/convergence.sh $quick "$plgen" "$variants"
	"$programs/convergence" $quick "$variants" "$folder"
	draw convergence "$folder/convergence.csv"
}

plmap() {
	say 'pl against RK4 over step and coupling'
	sh $charts/plmap.sh $quick "$plgen" "$variants"
	"$programs/plmap" $quick "$variants" "$folder"
	draw plmap "$folder/plmap.csv"
}

energy() {
	say 'energy and momentum in long runs'
	sh $charts/energy.sh "$plgen" "$variants"
	"$programs/energy" $quick "$variants" "$folder"
	draw energy "$folder/energy.csv"
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
	draw integrators "$folder"
	draw frame "$folder"
}

less() {
	say 'what modelling less saves'
	sh $charts/less.sh "$plgen" "$programs/less" "$variants"
	"$programs/less" "$variants" "$folder"
	draw less "$folder"
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
	draw papers_times "$folder/papers_times.csv"
	draw papers_beam_tip "$folder/papers_beam_tip.csv"
}

generation() {
	say 'what generating costs'
	sh $charts/generation.sh $quick "$build" "$folder"
	draw generation "$folder/break_even.csv"
}

limits() {
	say 'how near to the machine'
	sh bench/limits/limits.sh $quick "$build" "$folder" >&2
	draw limits "$folder/limits.csv"
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
say 'the page'
sh $charts/page.sh "$build" "$folder" "make charts${quick:+-quick}"
say "done: $folder/index.html"
