#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# needs.sh PLGEN VARIANTS FOLDER: what was tried for a need, of five scenes, as FOLDER/needs.csv: an alternative a line,
# by --explain=json; no times. Run at the top of the source tree.
set -e
plgen=$1 variants=$2 folder=$3
mkdir -p "$variants/needs"
cp models/inertia.spec "$variants/needs"
scene() {
	cat >"$variants/needs/$1.spec"
	"$plgen" --explain=json "$variants/needs/$1.spec" 2>/dev/null | awk -v scene="$1" -f bench/charts/needs.awk
}
{
	echo scene,unit,real,accuracy,form,modes,statics,scheme,step,tolerance,cost,error_over_need,neighbours,taken
	awk -f tests/needs/beam.awk | scene beam
	scene building <bench/charts/specs/needs_building.spec
	{ cat models/drivetrain.spec; echo 'need drive within 0.1 % until 3'; } | scene drivetrain
	{ cat models/quarter_car.spec; echo 'need comfort within 1e-2 until 10'; } | scene quarter_car
	{ grep -v '^[so]' models/pendulum.spec; echo 'need x within 1e-4 until 50'; } | scene pendulum
} >"$folder/needs.csv.new"
mv "$folder/needs.csv.new" "$folder/needs.csv"
