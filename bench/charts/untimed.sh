#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# untimed.sh BUILD FOLDER [--quick] [JOB...]: what measures no time, two jobs side by side: tables FOLDER/*.csv, the
# generated code and the errors of the models in FOLDER/variants. They are the same bytes whenever they are made
# (twice.sh). A JOB is one of the functions below, or errors_MODEL; by default all of them. Run at the top of the source
# tree; progress on standard error.
set -e
build=$1 folder=$2
shift 2
quick=
[ "${1:-}" != --quick ] || { quick=--quick; shift; }
charts=bench/charts
programs=$build/bench/charts
plgen=$build/plgen
variants=$folder/variants

convergence() {
	sh $charts/convergence.sh $quick "$plgen" "$variants"
	"$programs/convergence" $quick "$variants" "$folder"
}

# pl against RK4 over step and coupling
plmap() {
	sh $charts/plmap.sh $quick "$plgen" "$variants"
	"$programs/plmap" $quick "$variants" "$folder"
}

# and momentum, in long runs
energy() {
	sh $charts/energy.sh "$plgen" "$variants"
	"$programs/energy" $quick "$variants" "$folder"
}

hard() {
	sh $charts/hard.sh "$plgen" "$variants"
	"$programs/hard" $quick "$variants" "$folder"
}

# quality and largest steps too
stability() {
	sh $charts/stability.sh $quick "$plgen" "$programs" "$folder"
}

# time integrators of structural dynamics, a frame under a record
structural() {
	sh $charts/frame.sh "$plgen" "$variants"
	"$programs/integrators" $quick "$folder"
	"$programs/frame" "$variants" "$folder"
}

# what modelling less saves
less() {
	sh $charts/less.sh "$plgen" "$programs/less" "$variants"
	"$programs/less" "$variants" "$folder"
}

# a mass that sticks and slips
friction() {
	sh $charts/friction.sh "$plgen" "$variants"
	"$programs/friction" "$variants" "$folder"
}

# what was tried for needs
needs() {
	sh $charts/needs.sh "$plgen" "$variants" "$folder"
}

# what the papers found
papers() {
	sh $charts/papers.sh $quick "$plgen" "$variants"
	"$programs/papers" $quick "$variants" "$folder"
}

# settings of the comparisons that lead the page
headline() {
	sh $charts/headline.sh "$plgen" "$programs/headline" "$folder" --find $quick
}

mkdir -p "$variants"
if [ "${1:-}" = --job ]; then
	job=$2
	begin=$(date +%s)
	case $job in
		errors_*) sh $charts/precision.sh "$plgen" "$programs/precision" "$folder" $quick \
			--errors "${job#*_}" ;;
		*) $job ;;
	esac
	echo "[$job: $(($(date +%s) - begin)) s]" >&2
	exit 0
fi
if [ $# -eq 0 ]; then
	# What takes longest first, so that no job is left alone at the end
	models=$("$programs/precision" --names $quick)
	# Words
	# shellcheck disable=SC2046,SC2086
	set -- $(printf 'errors_%s\n' $models | grep beam) headline energy papers stability \
		$(printf 'errors_%s\n' $models | grep -v beam) hard less needs convergence plmap structural friction
fi
printf '%s\n' "$@" | xargs -P "${JOBS:-2}" -I '{}' sh $charts/untimed.sh "$build" "$folder" $quick --job '{}'
