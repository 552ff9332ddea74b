#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# gallery.sh PLRUN FOLDER [PAGES]: a picture of each model in models/ into FOLDER, by `plrun --plot`: some hundred
# points, the same bytes each time; into PAGES a page of each that runs it, and an index with the pictures. Steps are
# those of a picture: a linear model is exact at any, a smooth one goes by its series.
set -eu
plrun=$1
folder=$2
pages=${3:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$folder" ${pages:+"$pages"}
cp models/building.spec "$work"                 # a part, beside the street that is made there

# NAME END STEP [SCHEME]
lengths='axle 2 0.005
beam15 17 0.01
beam4 17 0.01
bilinear 40 0.1
bouncing_ball 5 0.01
brake 8 0.02
building 20 0.05
drivetrain 2 0.005
cart_pole 6 0.02
chain 4 0.02
crane 20 0.05
double_pendulum 10 0.02
duffing 40 0.1 taylor
four_bar 2 0.01
frame 10 0.02
gear1 60 0.2
gear2 60 0.2
gear3 10 0.025
half_car 3 0.01
impact_oscillator 40 0.05
inertia 30 0.1
linear2dof 20 0.05
mathieu 60 0.2 taylor
oscillator 20 0.05
pendulum 20 0.05 taylor
quad2dof 60 0.2 taylor
quarter_car 3 0.01
quarter_car_bumps 3 0.01
robot_arm 1.5 0.01
rotor -
scs 5 0.0125
scs_weak 1 0.0025
sdcs 10 0.025
sdcsf 10 0.025
slider_crank 2 0.01
spherical_joint 2 0.01
stick_slip 10 0.025
stop 2 0.005
street 20 0.05
swing_arm 2.5 0.01
tuned_floor 10 0.02
two_masses 6 0.01
vanderpol 30 0.1 taylor
vanderpol_stiff 300 0.5 auto
wheel 10 0.05'

# record NAME END STEP: what its inputs get, as CSV with times
record() {
	case $1 in
		axle) columns=road,top ;;
		quarter_car_bumps) columns=road ;;
		oscillator) columns=ground_acc ;;
		building | frame | street) columns=quake ;;
		*) return ;;
	esac
	grep -q '^input' "models/$1.spec" || return 0
	awk -v columns=$columns -v end="$2" -v h="$3" 'BEGIN {
		pi = 3.14159265358979
		print "t," columns
		for (k = 0; k <= end / h + 0.5; k++) {
			t = k * h
			u = 2 * (t / 4) ^ 2 * exp(2 - t / 2) * (sin(9 * t) + 0.6 * sin(31 * t + 1))
			if (columns ~ /road/)
				u = t > 0.2 && t < 0.4 ? 0.1 * sin(pi * (t - 0.2) / 0.2) : 0
			printf "%.6g,%.9g%s\n", t, u, columns ~ /top/ ? ",0" : "" } }'
}

# Over its speed
campbell() {
	"${plrun%plrun}plgen" --plot campbell --sweep w=0:600 --orders 1,2 -o "$work/picture.svg" "$1" 2>"$work/said" ||
		{ cat "$work/said" >&2; exit 1; }
	awk -f bench/svg.awk "$work/picture.svg" >"$folder/$2.svg"
}

# page NAME: of the spec itself, with all of its outputs
page() {
	[ -n "$pages" ] || return 0
	"${plrun%plrun}plgen" --page "$pages/$1.html" "models/$1.spec" 2>"$work/said" ||
		{ cat "$work/said" >&2; exit 1; }
	cp "$folder/$1.svg" "$pages"
	printf '<a href="%s.html"><img src="%s.svg" alt="">%s</a>\n' "$1" "$1" "$1" >>"$pages/index.html"
}
[ -z "$pages" ] || cat >"$pages/index.html" <<'END'
<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width,initial-scale=1">
<title>Models that run</title>
<style>
a { display: inline-block; width: 18rem; margin: .5rem; font: 1rem system-ui }
img { width: 100%; display: block }
</style>
<h1>Models that run</h1>
END

echo "$lengths" | while read -r name end step scheme; do
	record "$name" "$end" "$step" >"$work/record.csv"
	case $name in
		street) shown='s/^output n1.roof.*/output n1.roof, n4.roof, n10.roof/' ;;
		vanderpol_stiff) shown='s/^step/output x\n&/' ;;
		quad2dof) shown='/^output energy/d' ;;
		cart_pole | chain | double_pendulum | four_bar) shown='s/, energy.*//' ;;
		*) shown= ;;
	esac
	spec=models/$name.spec
	[ "$name" != rotor ] || { campbell "$spec" rotor; page rotor; continue; }
	if [ -n "$shown" ]; then
		sed "$shown" "$spec" >"$work/$name.spec"
		spec=$work/$name.spec
	fi
	set -- "$spec" "$end" --step "$step" --plot "$work/picture.svg"
	[ -z "$scheme" ] || set -- "$@" --scheme "$scheme"
	[ ! -s "$work/record.csv" ] || set -- "$@" --input "$work/record.csv"
	"$plrun" "$@" -o "$work/rows.csv" 2>"$work/said" || { cat "$work/said" >&2; exit 1; }
	awk -f bench/svg.awk "$work/picture.svg" >"$folder/$name.svg"
	page "$name"
done
