#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# untimed.sh BUILD FOLDER [--quick] [JOB...]: what measures no time, two jobs side by side: tables FOLDER/*.csv, the
# generated code and the errors of the models in FOLDER/variants. They are the same bytes whenever they are made
# (twice.sh). A JOB is one of those below, or errors_MODEL; by default all of them. Run at the top of the source tree;
# progress on standard error.
set -e
build=$1 folder=$2
shift 2
quick=
[ "${1:-}" != --quick ] || { quick=--quick; shift; }
charts=bench/charts
programs=$build/bench/charts
plgen=$build/plgen
variants=$folder/variants

# made TOPIC [FOLDER [PROGRAM]]: its variants
made() {
	sh $charts/variants.sh "$1" "$plgen" "${2:-$variants}" $quick ${3:+"$3"}
}

job() {
	case $1 in
		errors_*) sh $charts/precision.sh "$plgen" "$programs/precision" "$folder" $quick --errors "${1#*_}" ;;
		convergence | plmap | energy | hard | papers)
			made "$1" "$variants" "$programs/$1"
			"$programs/$1" $quick "$variants" "$folder" ;;
		friction | less)
			made "$1" "$variants" "$programs/$1"
			"$programs/$1" "$variants" "$folder" ;;
		# settings of the comparisons that lead the page
		headline)
			made headline "$variants/headline" "$programs/headline"
			"$programs/headline" --find $quick "$variants/headline" "$folder" ;;
		# what was tried for needs
		needs) sh $charts/needs.sh "$plgen" "$variants" "$folder" ;;
		# time integrators of structural dynamics, a frame under a record
		structural)
			made frame
			"$programs/frame" "$variants" "$folder"
			"$programs/integrators" $quick "$folder" ;;
		# largest steps too; the status is 1 where a boundary is not the known one
		stability)
			made stability "$variants/stability"
			bad=0
			for program in stability largest_step; do
				"$programs/$program" $quick "$folder" "$variants/stability" || bad=1
			done
			return $bad ;;
	esac
}

mkdir -p "$variants"
if [ "${1:-}" = --job ]; then
	begin=$(date +%s)
	job "$2"
	echo "[$2: $(($(date +%s) - begin)) s]" >&2
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
