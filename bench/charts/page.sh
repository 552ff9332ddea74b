#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# page.sh BUILD FOLDER COMMAND: FOLDER/index.html from the pictures and tables that charts.sh has made there. Run at
# the top of the source tree. A picture is followed by its caption (captions/NAME.txt, or that of the longest beginning
# of NAME that has one) and its numbers. What lies in FOLDER and is named nowhere here comes at the end, so that
# nothing is left out.
set -e
build=$1 folder=$2 command=$3
charts=bench/charts
page=$folder/index.html
shown=$(mktemp)
trap 'rm -f "$shown"' EXIT

section() {
	printf '<h2 id="%s">%s</h2>\n' "$1" "$2"
}

# caption NAME
caption() {
	name=$1
	while [ -n "$name" ]; do
		if [ -f "$charts/captions/$name.txt" ]; then
			printf '<p class="caption">'
			sed 's/&/\&amp;/g; s/</\&lt;/g; s/>/\&gt;/g' "$charts/captions/$name.txt"
			printf '</p>\n'
			return
		fi
		case $name in
			*_*) name=${name%_*} ;;
			*) name= ;;
		esac
	done
}

# picture NAME
picture() {
	[ -f "$folder/$1.svg" ] || { printf '<p class="bad">The picture %s is missing.</p>\n' "$1"; return; }
	echo "$1.svg" >>"$shown"
	printf '<figure id="%s"><a href="%s.svg"><img src="%s.svg" alt="%s" loading="lazy"></a>\n' "$1" "$1" "$1" "$1"
	[ ! -f "$folder/$1.png" ] || printf '<div class="as"><a href="%s.png">PNG</a></div>\n' "$1"
	echo '</figure>'
	caption "$1"
}

# table FILE.csv [COLUMN=VALUE]
table() {
	[ -f "$folder/$1" ] || { printf '<p class="bad">The table %s is missing.</p>\n' "$1"; return; }
	echo "$1" >>"$shown"
	awk -v name="$1" -v where="$2" -f $charts/csv.awk -f $charts/table.awk "$folder/$1"
}

row() {
	printf '<tr><th>%s</th><td>%s</td></tr>\n' "$1" "$2"
}

head_of_page() {
	cat <<'EOT'
<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>plgen: speed against accuracy, and stability where methods fail</title>
<style>
body { font: 16px/1.5 system-ui, sans-serif; color: #222; background: #fff; max-width: 1100px; margin: 0 auto;
	padding: 1rem 1.5rem 4rem; }
h1 { font-size: 1.7rem; line-height: 1.2; }
h2 { margin-top: 3rem; border-bottom: 2px solid #d00000; padding-bottom: .2rem; } h3 { margin: 2rem 0 0; }
figure { margin: 1rem 0 0; } img { width: 100%; max-width: 900px; height: auto; border: 1px solid #ddd; }
.as, .numbers { font-size: .8rem; margin: 0; } .caption { max-width: 900px; margin: .3rem 0 .6rem; }
.wide { overflow-x: auto; max-height: 34rem; overflow-y: auto; margin: .3rem 0 1rem; }
table { border-collapse: collapse; font-size: .78rem; font-variant-numeric: tabular-nums; }
th, td { border: 1px solid #ddd; padding: .12rem .4rem; text-align: left; vertical-align: top; max-width: 26rem; }
th { background: #f4f4f4; } .n { text-align: right; } .bad { color: #c00000; font-weight: 600; }
.poor { color: #a05a00; } .none { color: #888; }
.good { color: #006000; }
.machine td, .machine th { font-size: .85rem; } .hard td, .hard th { white-space: normal; }
.ours th:first-child { color: #c00000; }
details { margin: .3rem 0 1rem; } summary { cursor: pointer; font-size: .85rem; }
nav { columns: 2; font-size: .95rem; } nav a { display: block; }
code { font-size: .9em; background: #f4f4f4; padding: 0 .2em; }
</style>
<h1>plgen: speed against accuracy, and stability where methods fail</h1>
EOT
}

machine() {
	section machine 'Measured on'
	echo '<table class="machine">'
	row processor "$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | sed -n 1p), $(nproc) cores"
	row system "$(uname -s) $(uname -r | sed 's/-.*//') $(uname -m)$(
		sed -n 's/^PRETTY_NAME="\(.*\)"/, \1/p' /etc/os-release 2>/dev/null)"
	row compiler "$(${CC:-cc} --version | sed -n 1p)"
	row flags '<code>-O2</code> for all, generated code and peers alike; '\
'no <code>-march=native</code>, no <code>-ffast-math</code>'
	sundials=$(awk '$2 == "SUNDIALS_VERSION" { gsub(/"/, "", $3); print $3 }' \
		/usr/include/sundials/sundials_config.h 2>/dev/null)
	row libraries "GSL $(gsl-config --version 2>/dev/null), SUNDIALS $sundials, $(gnuplot --version)"
	row plgen "$("$build/plgen" --version)"
	row command "<code>$command</code>"
	echo '</table>'
	cat <<'EOT'
<p>plgen's own code has filled marks and thick lines; peers have open marks and thin lines, dashed with a fixed step,
dotted where they adapt it, dash-dotted for matrices of a step. Errors are relative to the largest value of the history;
they are the same to the last digit in every run. Times are medians of samples taken in turns, each of them a whole
history; the tables have minimum, median and maximum. A failure stands as a
<span class="bad">word</span>, in no place as a gap.</p>
<p>Parameters of the models from the four papers are chosen, since those of the sources did not survive; what is deduced
and what is chosen is said in each model's file.</p>
EOT
}

contents() {
	cat <<'EOT'
<nav>
<a href="#headline">1 Who is cheapest, and two comparisons</a>
<a href="#precision">2 Work and precision</a>
<a href="#generation">3 What generating costs</a>
<a href="#convergence">4 Convergence</a>
<a href="#papers">5 What the papers found</a>
<a href="#plmap">6 pl against RK4</a>
<a href="#stability">7 Stability and quality</a>
<a href="#energy">8 Energy and momentum in long runs</a>
<a href="#hard">9 Where methods fail</a>
<a href="#limits">10 How near to the machine</a>
<a href="#machine">Machine, compiler, command</a>
</nav>
EOT
}

headline() {
	section headline '1 Who is cheapest, and two comparisons'
	caption matrix
	awk -f $charts/csv.awk -f $charts/matrix_table.awk "$folder/matrix.csv"
	table matrix.csv
	picture headline_integrators
	table headline_integrators.csv
	picture headline_equal_step
	picture headline_drift
	table headline_equal_step.csv
	picture headline_confluence
	picture headline_twins
	table headline_confluence.csv
}

precision() {
	section precision '2 Work and precision'
	echo '<p class="caption">For each model the largest error over its whole history against the time for a unit'
	echo 'of output, and against evaluations of the right-hand side. Models that are not linear come first.</p>'
	awk -F, 'NR > 1 && !seen[$1]++ { print $1 }' "$folder/precision.csv" | while read -r model; do
		printf '<h3 id="model_%s">%s</h3>\n' "$model" "$model"
		picture "precision_$model"
		picture "evaluations_$model"
		table precision.csv "model=$model"
	done
	echo '<h3>How times agree</h3>'
	caption precision_check
	table precision_check.csv
}

generation() {
	section generation '3 What generating costs'
	picture break_even
	table break_even.csv
	caption generation
	table generation.csv
}

convergence() {
	section convergence '4 Convergence'
	for system in scs sdcs sdcsf; do
		picture convergence_$system
		table convergence.csv system=$system
	done
	table convergence_orders.csv
}

papers() {
	section papers '5 What the papers found, and what is measured'
	picture papers_times
	table papers_times.csv
	for source in 000 001 002 004; do
		caption papers_$source
		table papers_$source.csv
	done
	picture papers_beam_tip
	table papers_beam_tip.csv
}

plmap() {
	section plmap '6 The Piecewise-Laplace method with its coupling held, against RK4'
	picture plmap
	table plmap.csv
	table plmap_check.csv
}

stability() {
	section stability '7 Stability and quality'
	picture stability_map
	table stability_map.csv
	table stability_boundary.csv
	table stability_check.csv
	picture quality
	picture quality_small
	table quality.csv
	table quality_check.csv
	picture operator_map
	table operator_map.csv
	table operator_boundary.csv
	picture pl_map
	table pl_map.csv
	table operator_check.csv
	caption largest_step
	table largest_step.csv
}

energy() {
	section energy '8 Energy and momentum in long runs'
	picture energy_double
	table energy.csv 'case=undamped;real=double'
	picture energy_float
	table energy.csv 'case=undamped;real=float;step_s=0.01'
	picture energy_float_short
	table energy.csv 'case=undamped;real=float;step_s=0.0001'
	picture momentum_double
	table energy.csv 'case=moving;real=double'
	table energy.csv 'case=resting;real=double'
	picture momentum_float
	table energy.csv 'case=moving;real=float'
	table energy.csv 'case=resting;real=float'
	caption decay
	table decay.csv
}

hard() {
	section hard '9 Where methods fail'
	caption hard
	awk -f $charts/csv.awk -f $charts/hard_table.awk "$folder/hard.csv"
	table hard.csv
}

limits() {
	section limits '10 How near to the machine'
	picture limits
	table limits.csv
}

# Pictures and tables that no section has shown
others() {
	for file in "$folder"/*.svg "$folder"/*.csv; do
		name=$(basename "$file")
		if [ -f "$file" ] && ! grep -qxF "$name" "$shown"; then
			echo "$name"
		fi
	done >"$shown.others"
	if [ -s "$shown.others" ]; then
		section others 'More'
		while read -r name; do
			case $name in
				*.svg) picture "${name%.svg}" ;;
				*) caption "${name%.csv}"; table "$name" ;;
			esac
		done <"$shown.others"
	fi
	rm -f "$shown.others"
}

{
	head_of_page
	contents
	headline
	precision
	generation
	convergence
	papers
	plmap
	stability
	energy
	hard
	limits
	others
	machine
	echo '</html>'
} >"$page"
