#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# draw.sh FOLDER [--png]: pictures and pages from the tables in FOLDER, where nothing is measured: what pictures and
# pages need of the large tables that programs wrote (NAME_raw.csv, which doc/charts does not keep), what follows from
# the tables (matrix.csv, break_even_raw.csv, precision_check.csv), every picture whose tables are there, and the pages.
# Run at the top of the source tree.
set -e
folder=$1 png=$2
charts=bench/charts
LC_ALL=C.UTF-8                      # for gnuplot, whose labels have Greek letters
export LC_ALL
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

# derive TABLE TABLES SECTION [OPTION...]: TABLE by SECTION of tables.txt of others, if they are there
derive() {
	table=$1 from=$2 section=$3
	shift 3
	for name in $from; do
		[ -f "$folder/$name" ] || return 0
	done
	# Words
	# shellcheck disable=SC2086
	(cd "$folder" && exec sh "$here/table.sh" "$section" "$@" $from) >"$work/$table"
	mv "$work/$table" "$folder/$table"
}
here=$PWD/$charts

derive precision.csv precision_raw.csv fold -v lists=setting,largest,ns_median \
	-v by=model,method,family,setting_kind,unit_s,history_s
derive precision.csv precision.csv thin
derive precision.csv precision.csv digits -v to=3 -v only=largest,ns_median
derive precision_methods.csv precision_raw.csv once -v columns_of=method,family,setting_kind,settings
derive energy.csv energy_raw.csv fold -v by=case,method,family,real,step_s -v lists=steps,largest
derive hard.csv hard_raw.csv once -v columns_of=case,method,family,setting_kind,setting,error,word
derive hard_methods.csv hard_raw.csv once -v columns_of=method,family,settings
derive stability_map.csv stability_map_raw.csv classes -v bounds='-0.9 -0.5 -0.1 -0.01 -1e-12 1e-12 0.01 0.1 1 10'
derive operator_map.csv operator_map_raw.csv classes -v bounds='-0.9 -0.5 -0.1 -0.001 -1e-6 1e-6 0.001 0.1 1 10'
derive pl_map.csv pl_map_raw.csv classes -v bounds='-0.9 -0.5 -0.1 -0.001 0 1e-6 0.001 0.1 1 10'
derive plmap.csv plmap_raw.csv ratios
derive matrix.csv precision.csv matrix
derive break_even_raw.csv 'generation.csv precision.csv' after
derive precision_check.csv precision_raw.csv within
derive frame_history.csv frame_history.csv fold -v by=method -v lists=t_s,roof_mm
derive integrators.csv integrators.csv fold -v by=method \
	-v lists=h_over_T,spectral_radius,period_elongation_percent,amplitude_decay_percent_per_period
derive operator_boundary.csv operator_boundary.csv fold -v by=method -v lists=wh,across
derive papers_beam_tip.csv papers_beam_tip.csv fold -v by=h_s,operator -v lists=t_s,largest_tip_in_last_second_m
derive quality.csv quality.csv fold -v by=method \
	-v lists=h_over_T,period_elongation_percent,amplitude_decay_percent_per_period,algorithmic_damping_ratio
derive sensitivities.csv sensitivities.csv fold -v by=model,method,family -v lists=error,thousand_instructions
derive stability_boundary.csv stability_boundary.csv fold -v by=method,branch -v lists=wh,zeta
for name in energy integrators operator_boundary papers_beam_tip quality; do
	derive $name.csv $name.csv digits -v to=3
done
for name in convergence frame_history gear1_sweep integrators_check needs; do
	derive $name.csv $name.csv digits -v to=4
done
for name in hard_methods headline_integrators headline_equal_step; do
	derive $name.csv "precision_methods.csv $name.csv" unlike
done
for name in energy:steps frame_history:t_s hard hard_methods headline_confluence headline_equal_step \
	headline_integrators integrators:h_over_T largest_step:criterion operator_map papers_beam_tip:t_s plmap \
	precision quality:h_over_T stability_map; do
	derive ${name%:*}.csv ${name%:*}.csv same -v in_column="${name#*:}"
done

mkdir "$work/pictures"
# shellcheck disable=SC2016
sh $charts/picture.sh --list "$folder" | FOLDER=$folder WORK=$work xargs -P "${JOBS:-2}" -L 1 \
	sh -c 'name=$1; shift; exec sh bench/charts/picture.sh "$name" "$FOLDER" "$WORK/pictures" "$@"' picture

# Text and axes turn light where the reader's style is dark; areas keep their colours
for picture in "$work"/pictures/*.svg; do
	awk -f bench/svg.awk "$picture" >"$work/small" &&
		awk -v css=$charts/style.css -f $charts/dark.awk "$work/small" >"$work/picture"
	mv "$work/picture" "$folder/$(basename "$picture")"
done
[ -z "$png" ] || cp "$work"/pictures/*.png "$folder"
sh $charts/page.sh "$folder"
