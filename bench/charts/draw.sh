#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# draw.sh FOLDER [--png]: pictures and pages from the tables in FOLDER, where nothing is measured: what follows from the
# tables (matrix.csv, break_even.csv, precision_check.csv), every picture whose tables are there, and the pages. Run at
# the top of the source tree. A picture NAME.gp of tables that are not told here is drawn of NAME.csv.
set -e
folder=$1 png=$2
charts=bench/charts
LC_ALL=C.UTF-8                      # for gnuplot, whose labels have Greek letters
export LC_ALL
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

# derive PROGRAM TABLE FROM...: TABLE by PROGRAM.awk
derive() {
	program=$1 table=$2
	shift 2
	for from; do
		[ -f "$folder/$from" ] || return 0
	done
	(cd "$folder" && exec awk -f "$csv" -f "$here/$program.awk" "$@") >"$work/$table"
	mv "$work/$table" "$folder/$table"
}
here=$PWD/$charts
csv=$here/csv.awk
derive matrix matrix.csv precision.csv
derive break_even break_even.csv generation.csv precision.csv
if sed -n 1p "$folder/precision.csv" 2>/dev/null | grep -q ns_pass; then
	derive precision_check precision_check.csv precision.csv
fi

# tables_of NAME: what NAME.gp draws
tables_of() {
	case $1 in
		convergence) echo convergence.csv convergence_orders.csv ;;
		friction) echo friction.csv friction_times.csv ;;
		generation) echo break_even.csv ;;
		headline) echo headline_integrators.csv headline_equal_step.csv headline_confluence.csv ;;
		operator_map) echo operator_map.csv pl_map.csv operator_boundary.csv ;;
		stability) echo stability_map.csv stability_boundary.csv ;;
		*) echo "$1.csv" ;;
	esac
}

mkdir "$work/pictures"
for file in "$charts"/*.gp; do
	name=$(basename "$file" .gp)
	for table in $(tables_of "$name"); do
		[ -f "$folder/$table" ] || continue 2
	done
	echo "$file"
	! grep -q '^here.*narrow = ARG3' "$file" || echo "$file narrow"
done >"$work/jobs"
# shellcheck disable=SC2016
FOLDER=$folder WORK=$work xargs -P "${JOBS:-2}" -L 1 \
	sh -c 'exec gnuplot -c "$0" "$FOLDER" "$WORK/pictures" "$@" </dev/null' <"$work/jobs"

# Text and axes turn light where the reader's style is dark; areas keep their colours
for picture in "$work"/pictures/*.svg; do
	awk -f $charts/dark.awk "$picture" >"$work/picture" && mv "$work/picture" "$folder/$(basename "$picture")"
done
[ -z "$png" ] || cp "$work"/pictures/*.png "$folder"
sh $charts/page.sh "$folder"
