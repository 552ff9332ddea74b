#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# pages.sh ROOT: what readers see of the charts: the pages and pictures kept in doc/charts, and some drawn of small
# tables. Nothing is measured. As TAP.
set -u
root=$(realpath "$1")
. "${0%/*}/../tap.sh"
here=$root/tests/charts
charts=$root/bench/charts
kept=$root/doc/charts
csv=$charts/csv.awk
stories='headline_integrators headline_equal_step energy_double hard less needs'

# entries PICTURE.svg: of its legend, or of that of the picture in a page
entries() {
	sed -n 's/^<g><title>\(.*\)<\/title>$/\1/p' "$1" | sort -u | grep -c .
}

# at_most_ten FOLDER: legends of stories and models
at_most_ten() {
	: >log
	: >all_entries
	for name in $stories; do
		[ ! -f "$1/$name.svg" ] || ls "$1/$name.svg" "$1/${name}"_narrow.svg 2>/dev/null
	done >pictures
	ls "$1"/model_*.html >>pictures
	while read -r file; do
		n=$(entries "$file")
		echo "$n" >>all_entries
		[ "$n" -le 10 ] || echo "$(basename "$file"): $n entries" >>log
	done <pictures
	# where none is found nothing is read
	[ "$(sort -n all_entries | tail -n 1)" -ge 5 ] || echo 'no legend is found' >>log
	[ ! -s log ]
}

# whole FOLDER: its pages have what they link to, each picture and table is on a page, and what pages need
whole() {
	: >log
	for page in "$1"/*.html; do
		name=$(basename "$page")
		awk -f "$here/look.awk" "$page" | sed "s/^/$name: /" >>log
		sed 's/>/>\n/g' "$page" | sed -n 's/.*<[^>]* \(src\|href\|srcset\)="\([^"]*\)".*/\2/p' >links
		while read -r link; do
			file=${link%%#*}
			[ -z "$file" ] || [ -s "$1/$file" ] || echo "$name: no $link" >>log
			case $link in
				*'#'*)
					grep -q "id=\"${link#*#}\"" "$1/${file:-$name}" ||
						echo "$name: no $link" >>log ;;
			esac
		done <links
		cat links >>all
	done
	for file in "$1"/*.svg "$1"/*.csv; do
		case $file in *_raw.csv) continue ;; esac
		grep -qxF "$(basename "$file")" all || echo "no page has $(basename "$file")" >>log
	done
	rm -f all
	[ ! -s log ]
}

# titled FOLDER: the first words of what a picture found stand in it
titled() {
	: >log
	count_of=0
	for file in "$1"/*.svg "$1"/model_*.html; do
		case $file in
			*.svg) name=$(basename "$file" .svg) ;;
			*) name=$(basename "$file" .html) name=precision_${name#model_} ;;
		esac
		found=$(cd "$root" && sh bench/charts/finding.sh "${name%_narrow}" "$1" | cut -c 1-25)
		[ -n "$found" ] || continue
		count_of=$((count_of + 1))
		grep '^<text' "$file" | sed "s/&apos;/'/g; s/&#39;/'/g" | grep -qF "$found" ||
			echo "$name: has no title \"$found\"" >>log
		! grep -q 'nan\b\|: of  ' <<-EOT || echo "$name: \"$found\"" >>log
		$found
		EOT
	done
	[ "$count_of" -gt "$2" ] || echo "only $count_of pictures have a finding" >>log
	[ ! -s log ]
}

# compared FOLDER: matrix.csv there, and what the page shows of it, against the other road
compared() {
	sh "$here/matrix.sh" "$1/precision.csv" | cut -f 1,2,4,6,7 >expected
	awk -f "$csv" -f "$here/matrix_fields.awk" "$1/matrix.csv" >found
	diff found expected >log
	# cells of the page
	for class in ahead even behind nobody; do
		sed 's/<td/\n&/g' "$1/index.html" | grep -c "<td class=$class>"
	done | tr '\n' ' ' >cells
	awk -F '\t' '{ n[$5]++ } END { printf "%d %d %d %d ", n["ours"] + n["only ours"], n["even"],
		n["peer"] + n["only peer"], n["none"] }' expected >words
	cmp cells words >>log 2>&1 || cat cells words >>log
	[ -s expected ] && [ ! -s log ]
}

awk -f "$here/palette.awk" "$charts/palette.list" >log
[ ! -s log ]
result $? 'palette: contrast with both grounds, colours that a deuteranope tells apart'
sed 's/^adaptive #....../adaptive #8a7a2e/' "$charts/palette.list" | awk -f "$here/palette.awk" >log
grep -q 'to a deuteranope' log
result $? 'palette: colours alike to a deuteranope are noticed'
sed 's/^other #....../other #c8c8c8/' "$charts/palette.list" | awk -f "$here/palette.awk" >log
grep -q 'contrast 1.6.* with paper' log
result $? 'palette: a pale colour is noticed'

made=$charts/table.sh
sh "$made" fold -v by=model,method,family -v lists=setting,largest,ns_median "$here/matrix/precision.csv" \
	>folded.csv 2>log
sh "$made" matrix folded.csv >given.csv 2>>log
diff given.csv "$here/matrix/expect.csv" >>log
result $? 'matrix of given times: as worked out by hand'
sh "$made" grid given.csv | grep -o '<td class=[a-z]*>\(<b>[^<]*\)*' |
	sed 's/<td class=//; s/><b>/ /; s/>$//' | tr '\n' ';' >cells
echo 'ahead 2.0×;behind DOP853;behind RADAU5;nobody;even even;even even;ahead alone;ahead alone;' | tr -d '\n' >words
cmp cells words >log 2>&1 || cat cells words >>log
[ ! -s log ]
result $? 'matrix of given times: the same as a table'

# what is straight, what bends, what failed, what is not timed: the settings that stay, by hand
cat >curves.csv <<-'END'
	model,method,setting,largest,ns_median
	a,straight,1 2 3 4 5,1e-1 1e-2 1e-3 1e-4 1e-5,10 100 1000 1e4 1e5
	a,bent,1 2 3 4,0.5 0.5 0.05 0.005,10 100 100 100
	a,failed,1 2,failed failed,none none
	a,slow,1 2 3,1e-4 1e-7 1e-8,10 dear dear
END
sh "$made" thin curves.csv >thin.csv 2>log
sh "$made" thin thin.csv 2>>log | cmp - thin.csv >>log 2>&1
printf 'setting\n1 3 5\n1 2 4\n1\n1 3\n' | cmp - <<-END >>log 2>&1
	$(cut -d , -f 7 thin.csv)
END
[ ! -s log ]
result $? 'curves of given times: thinned as by hand, and once more the same'

# growth over a grid as runs of letters, and cells of them again; numbers of three digits
printf '%s\n' method,wh,zeta,rho,growth RK4,1,0,0,-0.5 RK4,2,0,0,-0.5 RK4,4,0,0,none RK4,8,0,0,inf >map_raw.csv
sh "$made" classes -v bounds='-0.1 1' map_raw.csv >map.csv 2>log
printf 'method,zeta,first_wh,ratio_of_wh,class_of_growth\nRK4,0,1,2,2a-c\n' | cmp - map.csv >>log 2>&1
sh "$made" cells -v name=RK4 map.csv 2>>log | sed 's/.*,//' | tr '\n' ' ' >cells
printf '0 0 NaN 2 ' | cmp - cells >>log 2>&1
printf '%s\n' 'x,"y",z' '1.23456e-05 none,1.23456,"12,345"' >long.csv
sh "$made" digits -v to=3 long.csv >digits.csv 2>>log
printf '%s\n' 'x,y,z' '1.23e-5 none,1.23,"12,345"' | cmp - digits.csv >>log 2>&1
[ ! -s log ]
result $? 'maps and digits: as by hand'

# a list of 70 numbers is 70 rows, too many for a page; and again a row for each
printf 'a,x,y\nm,%s,%s\n' "$(seq -s ' ' 1 70)" "$(seq -s ' ' 2 71)" >lists.csv
sh "$made" table -v name=lists.csv lists.csv >page 2>log
grep -q ', 70 rows' page && ! grep -q '<table' page || cat page >>log
sh "$made" unfold -v lists=x,y lists.csv >rows 2>>log
[ "$(wc -l <rows) $(sed -n '71p' rows)" = '71 m,70,71' ] || cat rows >>log
sh "$made" fold -v by=a -v lists=x,y rows 2>>log | cmp - lists.csv >>log 2>&1
[ ! -s log ]
result $? 'lists: as rows and back, and as rows too many for a page'

whole "$kept"
result $? 'doc/charts: pages have alts, captions, links that lead somewhere; nothing is on no page'
titled "$kept" 30
result $? 'doc/charts: titles of pictures say what is found'
at_most_ten "$kept"
result $? 'doc/charts: legends of stories and models have at most 10 entries'
compared "$kept"
result $? 'doc/charts: the matrix agrees with precision.csv by another road'

# What follows from the tables once more, then pages with the pictures that are there; LONG: those drawn, too
mkdir again
for file in "$kept"/*.csv; do
	case $file in *_raw.csv | */matrix.csv) ;; *) cp "$file" again ;; esac
done
if [ -n "${LONG:-}" ]; then
	(cd "$root" && sh bench/charts/draw.sh "$work/again") >log 2>&1
else
	cp "$kept"/*.svg "$kept"/*.html again
	(cd again && sh "$made" matrix precision.csv >matrix.csv &&
		sh "$made" after generation.csv precision.csv >break_even_raw.csv &&
		cd "$root" && sh bench/charts/page.sh "$work/again") >log 2>&1
fi
for file in "$kept"/*.html "$kept"/style.css "$kept"/matrix.csv; do
	cmp "$file" "again/$(basename "$file")" >>log 2>&1
done
[ "$(ls again/*.html | wc -l)" = "$(ls "$kept"/*.html | wc -l)" ] || echo 'not the same pages' >>log
[ ! -s log ]
result $? 'doc/charts: tables and pages made of its tables are those that lie there'
if [ -n "${LONG:-}" ]; then
	for file in "$kept"/*.svg; do
		cmp "$file" "again/$(basename "$file")"
	done >log 2>&1
	[ ! -s log ]
	result $? 'doc/charts: pictures drawn of its tables are those that lie there'
fi

# Two models, one of them unknown, and more methods than a legend holds, some of families nobody has heard of
few() {
	mkdir -p "$1"
	sh "$made" once -v columns_of="$(head -n 1 "$kept/precision.csv")" "$kept/precision.csv" >rows
	awk -F, 'NR == 1 || $1 == "scs"' rows >"$1/precision.csv"
	sed -n 's/^pendulum,/new_thing,/p' rows >new
	cat new >>"$1/precision.csv"
	for k in 1 2 3 4 5 6 7 8 9; do
		sed "s/,RK4,fixed/,Solver $k,fixed/; s/,etdrk4,/,etdam$k,/
			s/,GSL msadams,adaptive/,DOP$k,strange/" new
	done | grep -e ',Solver' -e ',etdam' -e ',DOP[1-9]' >>"$1/precision.csv"
	cp "$kept/hard.csv" "$kept"/headline_*.csv "$1"
}
few one
# Once more, with the known one alone
few two
grep -v '^new_thing,' two/precision.csv >known && mv known two/precision.csv
for folder in one two; do
	(cd "$root" && sh bench/charts/draw.sh "$work/$folder") >>log 2>&1 || echo "draw.sh: status $?" >>log
done
grep -v '^$' log >said
[ ! -s said ]
result $? 'few tables: drawn, without a warning'
find two -name '*scs*' -o -name 'hard*' -o -name 'headline_*' | sed 's,two/,,' | sort >again_there
: >log
while read -r file; do
	cmp "one/$file" "two/$file" >>log 2>&1
done <again_there
[ "$(grep -c 'svg$' again_there)" -ge 4 ] && [ ! -s log ]
result $? 'few tables: the same bytes twice'
whole "$work/one"
result $? 'few tables: pages of what is there, no link to what is not'
: >log
[ -s one/model_new_thing.html ] && grep -q new_thing one/index.html || echo 'the new model has no page' >>log
grep -q 'id="less"\|energy_double' one/index.html && echo 'the page names what is not there' >>log
[ ! -s log ]
result $? 'few tables: a model that nobody has described, no slot for what is missing'
titled "$work/one" 5
result $? 'few tables: titles of pictures say what is found'
at_most_ten "$work/one"
result $? 'few tables: legends of at most 10 entries among some sixty methods'
compared "$work/one"
result $? 'few tables: the matrix by another road'
cp "$kept/headline_confluence.svg" two/less.svg
echo 'model,error' >two/less.csv
echo 'beam,1e-3' >>two/less.csv
(cd "$root" && sh bench/charts/page.sh "$work/two") >log 2>&1
grep -q 'id="less"' two/index.html && grep -q '"less.csv"' two/index.html
result $? 'few tables: what modelling less saves stands on the first page once it is there'
tap_end
