#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# page.sh FOLDER: FOLDER/index.html, a page for each model and one for each topic, from the pictures and tables there.
# Run at the top of the source tree. A picture stands beside its caption (=== NAME in captions.txt, or that of the
# longest beginning of NAME that has one). What is not there is left out; what lies in FOLDER and is named nowhere here
# comes on the page more.html, so that nothing is lost.
set -e
folder=$1
charts=bench/charts
shown=$(mktemp)
trap 'rm -f "$shown"' EXIT
stories='headline_integrators headline_equal_step energy_double hard less needs'

escaped() {
	sed 's/&/\&amp;/g; s/</\&lt;/g; s/"/\&quot;/g'
}

there() {
	[ -f "$folder/$1" ]
}

# text_of NAME: its caption
text_of() {
	name=$1
	while [ -n "$name" ]; do
		if grep -qx "=== $name" $charts/captions.txt; then
			awk -v name="$name" '/^=== / { here = $2 == name; next } here' $charts/captions.txt | escaped
			return
		fi
		case $name in
			*_*) name=${name%_*} ;;
			*) name= ;;
		esac
	done
}

# caption NAME: as a paragraph
caption() {
	text=$(text_of "$1")
	[ -z "$text" ] || printf '<p>%s</p>\n' "$text"
}

# picture NAME: nothing where there is none; for whom it is read aloud, what it found
picture() {
	there "$1.svg" || return 0
	echo "$1.svg" >>"$shown"
	text=$(text_of "$1")
	found=$(sh $charts/finding.sh "$1" "$folder" | escaped)
	[ -n "$found" ] || found=$(printf '%s' "$text" | tr '\n' ' ' | sed 's/\. .*/./')
	size=$(sed -n '/viewBox/{s/.*="0 0 \([0-9]*\) \([0-9]*\)".*/width="\1" height="\2"/p;q;}' "$folder/$1.svg")
	fits=
	if there "${1}_narrow.svg"; then
		fits=' fits'
		echo "${1}_narrow.svg" >>"$shown"
	fi
	printf '<figure id="%s"><div class="figure%s"><a href="%s.svg"><picture>' "$1" "$fits" "$1"
	[ -z "$fits" ] || printf '<source media="(max-width: 640px)" srcset="%s_narrow.svg">' "$1"
	printf '<img src="%s.svg" %s alt="%s" loading="lazy"></picture></a></div>\n' "$1" "$size" "${found:-$1}"
	printf '<figcaption>%s</figcaption></figure>\n' "${text:-$found}"
}

# table FILE.csv [COLUMN=VALUE]: nothing where there is none
table() {
	there "$1" || return 0
	echo "$1" >>"$shown"
	awk -v name="$1" -v where="$2" -f $charts/csv.awk -f $charts/table.awk "$folder/$1"
}

# numbers FILE.csv: a link to it; what it has in its rows is for programs
numbers() {
	there "$1" || return 0
	echo "$1" >>"$shown"
	printf '<p class=numbers>Numbers: <a href="%s">%s</a></p>\n' "$1" "$1"
}

# rows FILE.csv COLUMN VALUE HEADING: the table of those rows, if there are any
rows() {
	there "$1" || return 0
	awk -v column="$2" -v value="$3" -f $charts/csv.awk -f $charts/rows_of.awk "$folder/$1" || return 0
	printf '<h2>%s</h2>\n' "$4"
	caption "${1%.csv}"
	table "$1" "$2=$3"
}

# head_of TITLE
head_of() {
	cat <<-EOT
	<!DOCTYPE html>
	<html lang="en">
	<meta charset="utf-8">
	<meta name="viewport" content="width=device-width, initial-scale=1">
	<title>$1</title>
	<link rel="stylesheet" href="style.css">
	<h1>$1</h1>
	EOT
}

# The topics: their pages, for what they have. A topic is a function that prints its pictures and tables; its titles,
# the short one for links
titles='stability|Stability and failures|Stability, quality, and where methods fail
structural|Structural dynamics|Time integrators of structural dynamics
energy|Energy|Energy and momentum in long runs
papers|The papers|What the papers found, and what is measured
convergence|Convergence|Convergence, and where frequencies meet
limits|Generating, machine, clocks|What generating costs, how near to the machine, how times agree
more|More|More'
topics='stability structural energy papers convergence limits'

# title_of TOPIC FIELD: 2, the short one, or 3
title_of() {
	echo "$titles" | sed -n "s/^$1|//p" | cut -d '|' -f "$(($2 - 1))"
}

# headed HEADING NAME: the table NAME.csv with its caption below a heading
headed() {
	there "$2.csv" || return 0
	printf '<h2>%s</h2>\n' "$1"
	caption "$2"
	table "$2.csv"
}

# show ITEM...: NAME, a picture; NAME.csv, a table; +NAME.csv, a link to its numbers
show() {
	for item; do
		case $item in
			+*) numbers "${item#+}" ;;
			*.csv) table "$item" ;;
			*) picture "$item" ;;
		esac
	done
}

stability() {
	show hard
	there hard.csv && caption hard_table && awk -f $charts/csv.awk -f $charts/hard_table.awk "$folder/hard.csv"
	show +hard.csv hard_methods.csv friction friction_times.csv friction.csv \
		stability_map +stability_map.csv stability_boundary.csv stability_check.csv \
		quality quality_small quality.csv quality_check.csv \
		operator_map +operator_map.csv operator_boundary.csv pl_map +pl_map.csv operator_check.csv
	headed 'The largest stable step' largest_step
}

structural() {
	show frame frame.csv frame_history.csv frame_record.csv integrators integrators.csv
	there integrators_orders.csv && caption integrators_orders
	show integrators_orders.csv integrators_check.csv
}

energy() {
	show energy_double energy_float energy_float_short momentum_double +energy.csv
	headed 'Light damping' decay
}

papers() {
	for source in 000 001 002 004; do
		headed "Source $source" papers_$source
		[ $source != 000 ] || show papers_times papers_times.csv plmap +plmap.csv plmap_check.csv
	done
	show papers_beam_tip papers_beam_tip.csv
}

convergence() {
	for file in "$folder"/convergence_*.svg; do
		[ -f "$file" ] || continue
		system=$(basename "$file" .svg)
		show "$system"
		table convergence.csv "system=${system#convergence_}"
	done
	show convergence_orders.csv headline_confluence headline_confluence.csv
}

limits() {
	show break_even break_even.csv
	there generation.csv && caption generation
	show generation.csv limits limits.csv
	headed 'How times agree' precision_check
}

# What no page has shown
more() {
	for file in "$folder"/*.svg "$folder"/*.csv; do
		name=$(basename "$file")
		if [ -f "$file" ] && ! grep -qxF "$name" "$shown"; then
			case $name in
				*_narrow.svg | *_raw.csv) ;;
				*.svg) picture "${name%.svg}" ;;
				*) caption "${name%.csv}"; table "$name" ;;
			esac
		fi
	done
}

links() {
	echo '<nav>'
	[ "$1" = index ] || echo '<a href="index.html">All models</a>'
	for other in $topics more; do
		[ "$other" = "$1" ] || [ ! -f "$folder/$other.html" ] ||
			printf '<a href="%s.html">%s</a>\n' "$other" "$(title_of "$other" 2)"
	done
	echo '</nav>'
}

# model NAME: its page
model() {
	head_of "$1: time against error"
	links model
	about=$(sed -n "s/^$1	//p" $charts/models.list | escaped)
	spec=$charts/specs/$1.spec
	[ -f "$spec" ] || spec=models/$1.spec
	printf '<p>%s The model: <code>%s</code>; %s s, an output every %s s.</p>\n' "$about" "$spec" \
		"$(of_model "$1" history_s)" "$(of_model "$1" unit_s)"
	awk -v only="$1" -f $charts/csv.awk -f $charts/words.awk -f $charts/matrix_html.awk "$folder/matrix.csv"
	picture "precision_$1"
	for file in "$folder/$1"_*.svg; do
		name=$(basename "$file" .svg)
		case $name in
			*_narrow | "$1_*") ;;
			*)
				picture "$name"
				numbers "$name.csv" ;;
		esac
	done
	printf '<h2>Every method at its cheapest setting</h2>\n<p>Time of an output.</p>\n'
	awk -v model="$1" -f $charts/csv.awk -f $charts/words.awk -f $charts/ranking.awk "$folder/precision.csv"
	numbers precision.csv
	rows largest_step.csv model "$1" 'The largest stable step'
	echo '</html>'
}

# of_model NAME COLUMN: what its first row in precision.csv has there
of_model() {
	awk -v model="$1" -v wanted="$2" -f $charts/csv.awk -f $charts/value.awk "$folder/precision.csv"
}

index() {
	head_of 'plgen: the cheapest way to a wanted error, and where methods fail'
	links index
	if there matrix.csv; then
		awk -f $charts/csv.awk -f $charts/verdict.awk "$folder/matrix.csv"
		awk -f $charts/csv.awk -f $charts/words.awk -f $charts/matrix_html.awk "$folder/matrix.csv"
		numbers matrix.csv
	fi
	for name in $stories; do
		picture "$name"
		case $name in
			hard | energy_*) ;;                     # their pages have the tables
			*)
				! there "$name.csv" || printf '<details><summary>Table</summary>'
				table "$name.csv"
				! there "$name.csv" || echo '</details>' ;;
		esac
	done
	if there precision_methods.csv; then
		echo '<h2 id="methods">Methods</h2>'
		caption precision
		printf '<details><summary>Settings</summary>'
		table precision_methods.csv
		echo '</details>'
	fi
	if there machine.csv; then
		echo '<h2 id="machine">Measured on</h2>'
		table machine.csv
	fi
	cat <<-'EOT'
	<p>plgen's own code has filled marks and unbroken lines; peers have open marks and thin lines, dashed with a
	fixed step, dotted where they adapt it, dash-dotted for matrices of a step. Errors are relative to the largest
	value of the history; they are the same to the last digit in every run. Times are medians of samples taken in
	turns, each of them a whole history; the tables have minimum, median and maximum. A failure stands as a word, in
	no place as a gap. Parameters of the models from the four papers are chosen, since those of the sources did not
	survive; what is deduced and what is chosen is said in each model's file.</p>
	EOT
	echo '</html>'
}

rm -f "$folder"/*.html
cp $charts/style.css "$folder"
# Which topics have something, so that each page links to them; then the pages
for topic in $topics; do
	[ -z "$($topic)" ] || : >"$folder/$topic.html"
done
if there precision.csv; then
	models=$(awk -F, 'NR > 1 && !seen[$1]++ { print $1 }' "$folder/precision.csv")
	for name in $models; do
		model "$name" >"$folder/model_$name.html"
	done
fi
index >"$folder/index.html.new"
rest=$(more)
[ -z "$rest" ] || : >"$folder/more.html"
for topic in $topics more; do
	[ -f "$folder/$topic.html" ] || continue
	{
		head_of "$(title_of "$topic" 3)"
		links "$topic"
		if [ "$topic" = more ]; then printf '%s\n' "$rest"; else $topic; fi
		echo '</html>'
	} >"$folder/$topic.html.new"
	mv "$folder/$topic.html.new" "$folder/$topic.html"
done
mv "$folder/index.html.new" "$folder/index.html"
