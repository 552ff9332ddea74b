#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# page.sh FOLDER: FOLDER/index.html, a page for each model and one for each topic, from the pictures and tables there.
# Run at the top of the source tree. A picture stands beside its caption (=== NAME in captions.txt, or that of the
# longest beginning of NAME that has one). What is not there is left out; what lies in FOLDER and is named nowhere here
# comes on the page more.html, so that nothing is lost. The picture of a model, precision_MODEL.svg and for narrow
# screens precision_MODEL_narrow.svg, moves into its page; where it is not there, the page keeps the one it has.
set -e
folder=$1
charts=bench/charts
work=$(mktemp -d)
shown=$work/shown
trap 'rm -rf "$work"' EXIT
stories='headline_integrators headline_equal_step energy_double hard less needs'
# The topics: NAME|short title, for links|title|what is shown, as `show` reads it
topics='stability|Stability and failures|Stability, quality, and where methods fail|hard hard_table +hard.csv
 hard_methods.csv friction friction_times.csv friction.csv stability_map +stability_map.csv stability_boundary.csv
 stability_check.csv quality quality_small quality.csv quality_check.csv operator_map +operator_map.csv
 operator_boundary.csv pl_map +pl_map.csv operator_check.csv The_largest_stable_step=largest_step
structural|Structural dynamics|Time integrators of structural dynamics|frame frame.csv frame_history.csv
 frame_record.csv integrators integrators.csv =integrators_orders integrators_check.csv
energy|Energy|Energy and momentum in long runs|energy_double energy_float energy_float_short momentum_double
 +energy.csv Light_damping=decay
papers|The papers|What the papers found, and what is measured|Source_000=papers_000 papers_times papers_times.csv
 plmap +plmap.csv plmap_check.csv Source_001=papers_001 Source_002=papers_002 Source_004=papers_004
 papers_beam_tip papers_beam_tip.csv
convergence|Convergence|Convergence, and where frequencies meet|convergence_scs@convergence.csv:system=scs
 convergence_sdcs@convergence.csv:system=sdcs convergence_sdcsf@convergence.csv:system=sdcsf
 convergence_orders.csv headline_confluence headline_confluence.csv
limits|Generating, derivatives, clocks|What generating and derivatives cost, how near to the machine, clocks|break_even
 =generation sensitivities sensitivities.csv limits limits.csv How_times_agree=precision_check
more|More|More|'

there() {
	[ -f "$folder/$1" ]
}

# made SECTION [OPTION...] FILE.csv: by tables.txt
made() {
	sh $charts/table.sh "$@"
}

escaped() {
	sed 's/&/\&amp;/g; s/</\&lt;/g; s/"/\&quot;/g'
}

# text_of NAME: its caption
text_of() {
	name=$1
	while ! grep -qx "=== $name" $charts/captions.txt; do
		case $name in
			*_*) name=${name%_*} ;;
			*) return 0 ;;
		esac
	done
	awk -v name="$name" '/^=== / { here = $2 == name; next } here' $charts/captions.txt | escaped
}

# caption NAME: as a paragraph
caption() {
	text=$(text_of "$1")
	[ -z "$text" ] || printf '<p>%s</p>\n' "$text"
}

# heard NAME: its caption as text, and for whom it is read aloud what it found
heard() {
	text=$(text_of "$1")
	found=$(sh $charts/finding.sh "$1" "$folder" | escaped)
	[ -n "$found" ] || found=$(printf '%s' "$text" | tr '\n' ' ' | sed 's/\. .*/./')
}

# inline FILE CLASS PAGE: the picture in FILE, without the styles that style.css has; or that of the page
inline() {
	if there "$1"; then
		sed "1s/^<svg \(viewBox=\"[^\"]*\"\).*/<svg class=$2 \1>/
			/^<style>.*<\/style>$/d; /^<style>/,/<\/style>/d
			s/=\"\([^\" ]*\)\"\([ >]\)/=\1\2/g" "$folder/$1"
		rm "$folder/$1"
	elif [ -f "$work/$3" ]; then
		sed -n "/<svg class=$2 /,/^<\/svg>/p" "$work/$3"
	fi
}

# picture_of MODEL: within its page, for broad and narrow screens with one definition of their marks
picture_of() {
	inline "precision_$1.svg" broad "model_$1.html" >"$work/broad"
	inline "precision_$1_narrow.svg" narrow "model_$1.html" | sed '/^<defs>/,/^<\/defs>/d' >"$work/narrow"
	[ -s "$work/broad" ] || return 0
	heard "precision_$1"
	printf '<figure id="precision_%s"><div class="figure fits" role="img" aria-label="%s">\n' "$1" "$found"
	cat "$work/broad" "$work/narrow"
	printf '</div>\n<figcaption>%s</figcaption></figure>\n' "$text"
}

# picture NAME: nothing where there is none
picture() {
	there "$1.svg" || return 0
	echo "$1.svg" >>"$shown"
	heard "$1"
	size=$(sed -n '/viewBox/{s/.*="0 0 \([0-9]*\)0 \([0-9]*\)0".*/width="\1" height="\2"/p;q;}' "$folder/$1.svg")
	fits=
	if there "${1}_narrow.svg"; then
		fits=' fits'
		echo "${1}_narrow.svg" >>"$shown"
	fi
	printf '<figure id="%s"><div class="figure%s"><a href="%s.svg">' "$1" "$fits" "$1"
	[ -z "$fits" ] || printf '<picture><source media="(max-width: 640px)" srcset="%s_narrow.svg">' "$1"
	printf '<img src="%s.svg" %s alt="%s" loading="lazy">%s</a></div>\n' "$1" "$size" "${found:-$1}" \
		"${fits:+</picture>}"
	printf '<figcaption>%s</figcaption></figure>\n' "${text:-$found}"
}

# table FILE.csv [COLUMN=VALUE]: nothing where there is none
table() {
	there "$1" || return 0
	echo "$1" >>"$shown"
	made table -v name="$1" -v where="$2" -v methods="$(! there precision_methods.csv || echo 1)" "$folder/$1"
}

# numbers FILE.csv: a link to it; what it has in its rows is for programs
numbers() {
	there "$1" || return 0
	echo "$1" >>"$shown"
	printf '<p class=numbers>Numbers: <a href="%s">%s</a></p>\n' "$1" "$1"
}

# headed HEADING NAME: the table NAME.csv with its caption below a heading, if there is one
headed() {
	there "$2.csv" || return 0
	[ -z "$1" ] || printf '<h2 id="%s">%s</h2>\n' "$2" "$1"
	caption "$2"
	table "$2.csv"
}

# show ITEM...: NAME, a picture; NAME.csv, a table; +NAME.csv, a link to its numbers; HEADING=NAME, a table below its
# caption; NAME@FILE.csv:COLUMN=VALUE, a picture and, where it is there, those rows
show() {
	for item; do
		case $item in
			*@*)
				name=${item%%@*} item=${item#*@}
				! there "$name.svg" || { picture "$name"; table "${item%%:*}" "${item#*:}"; } ;;
			+*) numbers "${item#+}" ;;
			*=*) headed "$(echo "${item%%=*}" | tr _ ' ')" "${item#*=}" ;;
			*.csv) table "$item" ;;
			hard_table) ! there hard.csv || { caption hard_table; made hard_table "$folder/hard.csv"; } ;;
			*) picture "$item" ;;
		esac
	done
}

# topic NAME FIELD: of the list; 2: the short title, 3: the title, 4: what is shown
topic() {
	echo "$topics" | awk -F '|' -v name="$1" -v field="$2" '
		!/^ / { on = $1 == name; if (on) print $field; next } on && field == 4'
}

# content TOPIC; of more: what no page has shown
content() {
	# Words
	# shellcheck disable=SC2046
	[ "$1" = more ] || { show $(topic "$1" 4); return; }
	for file in "$folder"/*.svg "$folder"/*.csv; do
		name=$(basename "$file")
		[ -f "$file" ] && ! grep -qxF "$name" "$shown" || continue
		case $name in
			*_narrow.svg | *_raw.csv) ;;
			*.svg) picture "${name%.svg}" ;;
			*) caption "${name%.csv}"; table "$name" ;;
		esac
	done
}

# page NAME TITLE: what comes in, as a page
page() {
	cat <<-EOT
	<!DOCTYPE html>
	<html lang="en">
	<meta charset="utf-8">
	<meta name="viewport" content="width=device-width, initial-scale=1">
	<title>$2</title>
	<link rel="stylesheet" href="style.css">
	<h1>$2</h1>
	<nav>
	EOT
	[ "$1" = index ] || echo '<a href="index.html">All models</a>'
	for other in $names; do
		[ "$other" = "$1" ] || [ "$1" = model ] || [ ! -f "$folder/$other.html" ] ||
			printf '<a href="%s.html">%s</a>\n' "$other" "$(topic "$other" 2)"
	done
	echo '</nav>'
	cat
	echo '</html>'
}

# of_model NAME COLUMN: what its first row in precision.csv has there
of_model() {
	made first -v where=model -v is="$1" -v wanted="$2" "$folder/precision.csv"
}

# model NAME: its page
model() {
	about=$(sed -n "s/^$1	//p" $charts/models.list | escaped)
	spec=$charts/specs/$1.spec
	[ -f "$spec" ] || spec=models/$1.spec
	printf '<p>%s The model: <code>%s</code>; %s s, an output every %s s.</p>\n' "$about" "$spec" \
		"$(of_model "$1" history_s)" "$(of_model "$1" unit_s)"
	made grid -v only="$1" "$folder/matrix.csv"
	picture_of "$1"
	! there precision_methods.csv || echo '<p><a href="index.html#methods">How it was measured</a></p>'
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
	made ranking -v model="$1" "$folder/precision.csv"
	numbers precision.csv
	! there largest_step.csv ||
		[ -z "$(made first -v where=model -v is="$1" -v wanted=model "$folder/largest_step.csv")" ] ||
		echo '<p><a href="stability.html#largest_step">The largest stable step</a></p>'
}

index() {
	if there matrix.csv; then
		made verdict "$folder/matrix.csv"
		made grid "$folder/matrix.csv"
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
		caption methods
		table precision_methods.csv
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
	survive; what is deduced and what is chosen is said in each model's file. In the .csv files the first column,
	family and setting_kind are empty where they have what the row above has, and others say <code>same</code>.</p>
	EOT
}

for page in "$folder"/*.html; do
	[ ! -f "$page" ] || mv "$page" "$work"
done
cp $charts/style.css "$folder"
names=$(echo "$topics" | sed -n 's/^\([a-z]*\)|.*/\1/p')
# Which topics have something, so that each page links to them; then the pages
for topic in $names; do
	[ "$topic" = more ] || [ -z "$(content "$topic")" ] || : >"$folder/$topic.html"
done
if there precision.csv; then
	for name in $(awk -F, 'NR > 1 && $1 != "" && !seen[$1]++ { print $1 }' "$folder/precision.csv"); do
		model "$name" | page model "$name: time against error" >"$folder/model_$name.html"
	done
fi
index >"$folder/index.html.new"
rest=$(content more)
[ -z "$rest" ] || : >"$folder/more.html"
for topic in $names; do
	[ -f "$folder/$topic.html" ] || continue
	if [ "$topic" = more ]; then printf '%s\n' "$rest"; else content "$topic"; fi |
		page "$topic" "$(topic "$topic" 3)" >"$folder/$topic.html.new"
	mv "$folder/$topic.html.new" "$folder/$topic.html"
done
page index 'plgen: the cheapest way to a wanted error, and where methods fail' <"$folder/index.html.new" \
	>"$folder/index.html"
rm "$folder/index.html.new"
