#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# look.sh PLGEN LOOK SWEEPS ROOT: the linear part as --explain=json, --response, --plot and --report tell it, and
# sweeps of models with clearances. Numbers are LOOK's and SWEEPS'; pictures are scripts, which a gnuplot of the test's
# own hands on as they are.
set -u
plgen=$(realpath "$1") || exit 99
look=$(realpath "$2") || exit 99
sweeps=$(realpath "$3") || exit 99
root=$(cd "$4" && pwd) || exit 99
here=$root/tests/look
. "$root/tests/tap.sh"
. "$root/tests/cases.sh"

# numbers NAME SPEC: one result for all that LOOK finds, of which it says those that are wrong
numbers() {
	"$plgen" --explain=json "$2" >json 2>log && "$plgen" --response 0.05:50:400 "$2" >csv 2>log &&
		"$look" "$1" json csv >log
	status=$?
	grep '^not ok' -B 2 log >wrong && mv wrong log
	result $status "numbers of $1"
}
numbers sdcsf "$root/models/sdcsf.spec"
numbers car "$here/car.spec"
numbers held "$here/held.spec"

"$plgen" --response 1:2:3 "$here/car.spec" | head -n 1 | tr ',' '\n' >head.csv
for force in 'road' 'sin(30*t)'; do
	for output in body travel felt tyre; do
		printf '%s/%s mag\n%s/%s phase\n' "$output" "$force" "$output" "$force"
	done
done | sed '1i f' >expected
diff expected head.csv >log
result $? 'names of the columns'

"$plgen" --response 0.05:50:400 "$root/models/sdcsf.spec" >many && "$plgen" --response 0.05:50:2 \
	"$root/models/sdcsf.spec" >two && [ "$(tail -n 1 many)" = "$(tail -n 1 two)" ] && [ "$(wc -l <two)" -eq 3 ]
result $? 'a phase does not depend on the rows before it'

# ---- delayed inputs: e^{-iwd} of each, by complex numbers; what cancels is 0 ----

cat >late.spec <<'END'
model late
coord z
input u hold first, w hold first
z'' + 0.4*z' + 9*z = u + 0.5*u(t - 0.25) + u'(t - 0.1) + w(t - 0.2)
output z, v = z' + 2*u(t - 0.2), gone = u + u(t - 1/3) + u(t - 2/3), half = u(t - 0.5) + u(t - 1)
step 1/60
END
"$plgen" --response 1:8:4 late.spec >csv 2>log && awk -F, '
	function add(size, angle) { re += size * cos(angle); im += size * sin(angle) }
	function check(column, pi) {
		pi = 4 * atan2(1, 1)
		angle = $(column + 1) * pi / 180
		off = sqrt(($column * cos(angle) - re)^2 + ($column * sin(angle) - im)^2)
		if (!(off < 1e-13 && angle <= pi && angle >= -pi)) {
			print $1, column, $column, re, im
			bad = 1
		}
		re = im = 0
	}
	NR > 1 {
		w = 8 * atan2(1, 1) * $1
		down = -log((9 - w^2)^2 + (0.4 * w)^2) / 2; turn = -atan2(0.4 * w, 9 - w^2)
		add(exp(down), turn); add(exp(down) / 2, turn - w / 4)
		add(w * exp(down), turn + 2 * atan2(1, 1) - w / 10); x = re; y = im; check(2)
		re = -w * y; im = w * x; add(2, -w / 5); check(4)
		if ($1 == 1 && $6 != 0 || $1 == 1 && $8 != 0) { print "not 0:", $6, $8; bad = 1 }
		add(1, 0); add(1, -w / 3); add(1, -2 * w / 3); check(6)
		add(1, -w / 2); add(1, -w); check(8)
		add(exp(down), turn - w / 5); check(10)
	} END { exit bad || NR != 5 }' csv >>log
result $? 'delayed inputs'
"$plgen" --response 1:8:4 --amplitude 1 late.spec >out 2>log
[ $? -eq 1 ] && [ ! -s out ] && grep -q 'error: --amplitude does not go with delayed inputs' log
result $? 'delayed inputs have no sweep of an amplitude'

# ---- sweeps up and down, of models with clearances ----

# swept MODEL SPEC BAND AMPLITUDE APART TOLERANCE: of SWEEPS, as above
swept() {
	"$plgen" --response "$3" --amplitude "$4" "$2" >csv 2>log && [ ! -s log ] &&
		"$sweeps" "$1" "$5" "$4" "$6" csv >log
	status=$?
	grep '^not ok' -B 2 log >wrong && mv wrong log
	result $status "a sweep of $1: $(grep -o 'differ at .* frequencies' log)"
}
! merging || swept gear "$root/models/gear1.spec" 0.05:0.25:20 1 3 1e-6
swept two "$here/stops.spec" 0.28:0.95:16 0.2 1 1e-6
# A damper of two rates: at 0.4985 Hz, next to the undamped frequency, 0.09224 and no resonance, whatever the amplitude
printf '%s\n' 'model rates' 'coord x' 'input u hold first' "x'' + (x' > 0 ? 2 : 5)*x' + 9.81*x = u" \
	"output x, v = x'" 'step 0.001' >rates.spec
swept rates rates.spec 0.4985:1.5:10 1 0 1e-6
"$plgen" --response 0.4985:1.5:10 --amplitude 300 rates.spec 2>>log | awk -F, 'NR == FNR { one[FNR] = $2; next }
	FNR == 2 { print $2; first = $2 - 0.0922408 }
	FNR > 1 && $2 / one[FNR] - 1 < 1e-9 && one[FNR] / $2 - 1 < 1e-9 { same++ }
	END { exit !(same == 10 && first < 1e-6 && first > -1e-6) }' csv - >log
result $? 'two rates: forces in proportion to the motion, whatever the amplitude'

"$plgen" --response 1:2:3 --amplitude 0.2 "$here/stops.spec" 2>log | head -n 1 | tr ',' '\n' >head.csv
for output in x apart mixed; do
	for way in up down; do
		printf '%s/floor mag %s\n%s/floor phase %s\n' $output $way $output $way
	done
done | sed '1i f' >expected
diff expected head.csv >log
result $? 'names of the columns of a sweep'

# Within the clearance the response is that of the mass alone: x = 4 + 0.2 s over s^2 + 0.2 s + 4
"$plgen" --response 0.05:5:50 --amplitude 1e-3 "$here/stops.spec" 2>log | awk -F, 'NR > 1 {
	w = 8 * atan2(1, 1) * $1
	size = sqrt((16 + 0.04 * w^2) / ((4 - w^2)^2 + 0.04 * w^2))
	for (i = 2; i < 5; i += 2)
		if (!($i / size - 1 < 1e-10 && $i / size - 1 > -1e-10)) {
			print $1, $i, size
			wrong = 1
		}
} END { exit wrong || NR != 51 }' >log
result $? 'within clearances the response is linear'

"$plgen" --response 1.1:1.2:3 --amplitude 0.2 "$here/stops.spec" >csv 2>log &&
	grep -q '^plgen: note: at 5 of 5 frequencies the motion does not repeat with the excitation: means over 64' log
result $? 'a motion of two periods is told'

# A load on the first of two masses: over x1, s^2 + s + 200, whose roots are -0.5 +- i sqrt(199.75)
"$plgen" --explain "$root/models/sdcsf.spec" >text 2>log
grep -F 'x1 / cos(5*t)' text | grep -F ' 0.0066666667 ' | grep -qF -- '-0.5 +- 14.133294 i'
result $? 'the zeros of two masses'

mkdir own bare
cat >own/gnuplot <<'END'
#!/bin/sh
[ "$*" = '-d -' ] && exec cat
END
chmod +x own/gnuplot

PATH=$PWD/own:$PATH "$plgen" --plot poles,modes,frf,response "$root/models/sdcsf.spec" >script 2>log
result $? 'a script of all kinds'

# block NAME: the rows of a block of data
block() {
	sed -n "/^\\\$$1 << END\$/,/^END\$/p" script | sed '1d;$d'
}

block frf >rows
# band_of_rows: F0:F1:N that --response takes
band_of_rows() {
	echo "$(head -n 1 rows | cut -d ' ' -f 1):$(tail -n 1 rows | cut -d ' ' -f 1):$(wc -l <rows | tr -d ' ')"
}
"$plgen" --response "$(band_of_rows)" "$root/models/sdcsf.spec" 2>log | sed 1d | tr ',' ' ' >csv
[ -s csv ] && cmp rows csv >log 2>&1
result $? 'frf is drawn from the numbers of --response'

gear=$root/models/gear1.spec
PATH=$PWD/own:$PATH "$plgen" --plot frf --amplitude 1 "$gear" >script 2>log && block frf >rows
"$plgen" --response "$(band_of_rows)" --amplitude 1 "$gear" 2>log | sed 1d | tr ',' ' ' >csv
[ -s csv ] && cmp rows csv >log 2>&1 && grep -q 'over cos(0.8\*t), swept with amplitude 1' script
result $? 'a sweep is drawn from the numbers of --response'
PATH=$PWD/own:$PATH "$plgen" --plot poles,modes,frf,response "$root/models/sdcsf.spec" >script 2>log

block response >rows
"$plgen" --solution "$(tail -n 1 rows | cut -d ' ' -f 1)" "$root/models/sdcsf.spec" | sed 1d | tr ',' ' ' >csv
cat >same.awk <<'END'
NR == FNR { row[$1] = $0; next }
$1 in row { same += row[$1] == $0; seen++ }
END { print seen + 0, same + 0 >"/dev/stderr"; exit !(seen > 50 && same == seen) }
END
awk -f same.awk csv rows 2>log
result $? 'response is drawn from the numbers of --solution'

block poles | awk '{ print $1, $2 }' | sort >rows
"$plgen" --explain=json "$root/models/sdcsf.spec" | sed -n '/"poles": \[/,/\],/p' | tr -d '{}' |
	awk -F '[:,]' '/"re"/ { print $2, $4 }' | sed 's/^ //; s/  / /' | sort >csv
[ -s csv ] && diff rows csv >log
result $? 'poles are those of the JSON'

! grep -E "$root|$work|20[0-9][0-9]-|:[0-9][0-9]:[0-9][0-9]" script >log
result $? 'no paths and no dates in a script'

PATH=$PWD/own:$PATH "$plgen" --report "$root/models/sdcsf.spec" >page 2>log && awk -f "$here/page.awk" page >log 2>&1
result $? 'a page without pictures is closed well'

# ---- how pictures look ----

# Every pole has its frequency beside the plane, texts at least 13 points of 360 apart and within it; or none has
cat >many.spec <<'END'
model many
coord q[12]
matrix K = "many.mtx"
q'' + 0.01*q' + K*q = 0
init q[1] = 1
step 0.01
END
awk 'BEGIN { print "%%MatrixMarket matrix coordinate real general\n12 12 12"
	for (i = 1; i <= 12; i++) print i, i, 100 + i * i / 10 }' >many.mtx
PATH=$PWD/own:$PATH "$plgen" --plot poles many.spec >script 2>log
"$plgen" --explain=json many.spec | tr -d '{}' | awk -F '[:,]' '/"frequency_hz"/ { printf "%.4g Hz\n", $2 }' >expected
sed -n 's/^set label "\(.* Hz\)" at graph 1.025,first .*/\1/p' script | tac | diff expected - >>log &&
	[ "$(wc -l <expected)" -eq 12 ]
result $? 'every pole has its frequency'
awk '/^plot / { high = $3; sub(/.*:/, "", high); high += 0 }
	/Hz" at graph/ { split($0, part, /first /); at[++n] = part[2] + 0 }
	END { for (i = 1; i <= n; i++) if (at[i] > high || at[i] < -high ||
			(i > 1 && at[i - 1] - at[i] < 2 * high * 13 / 360 * 0.999)) { print i, at[i], high; bad = 1 }
		exit bad || n != 12 || !(high > 0) }' script >log
result $? 'no text of a pole is on another'
sed -i 's/q\[12\]/q[28]/; s/many.mtx/more.mtx/' many.spec
awk 'BEGIN { print "%%MatrixMarket matrix coordinate real general\n28 28 28"
	for (i = 1; i <= 28; i++) print i, i, 100 + i * i / 10 }' >more.mtx
PATH=$PWD/own:$PATH "$plgen" --plot poles many.spec >script 2>log
! grep -q 'Hz"' script && grep -q "damping ratio; 28, listed by --explain'" script
result $? 'none of too many has'

# A page has each picture on a broad and on a narrow sheet, of the same numbers
PATH=$PWD/own:$PATH "$plgen" --plot frf "$root/models/sdcsf.spec" >script 2>log
[ "$(grep -c '^set key outside top left' script)" -eq 2 ] && grep '^plot' script | head -n 1 | tr , '\n' |
	grep -o 'dt .* pt [0-9]*\|#[0-9a-f]*' | sort | uniq -d >log && [ ! -s log ]
result $? 'legends above their panels; curves differ in dash, mark and colour'

# Every colour of a dark picture but the curves' is one of the dark page; a title has quotes; lengths of a print: its
# column of 85 mm has 2008 dots of 600 to an inch
PATH=$PWD/own:$PATH "$plgen" --plot poles,modes,frf,response --dark --title "It's \"dark\" %d" \
	"$root/models/sdcsf.spec" >script 2>log
grep -o "'#[0-9a-f]*'" script | tr -d "'" | sort -u >colours
grep -o '"#[0-9a-f]*"' "$root/runtime/host/picture.h" | tr -d '"' | sort -u >all
grep -x -v -F -f all colours >log
grep -q "^set label 1 'It''s \"dark\" %d' noenhanced at screen" script && ! grep -q '#ffffff\|#202020' colours &&
	grep -q '#14171c' colours && [ ! -s log ] && [ "$(wc -l <colours)" -gt 6 ]
result $? 'a dark picture, and its title'
for size in 85 60x40=1417,945; do
	# shellcheck disable=SC2046
	PATH=$PWD/own:$PATH "$plgen" --plot frf --paper -o print.png $([ $size = 85 ] || echo --size ${size%=*}) \
		"$root/models/sdcsf.spec" 2>log
	[ $size = 85 ] && dots=2008, || dots=${size#*=}
	grep -q "pngcairo noenhanced size $dots" print.png
	result $? "a print of ${size%=*} mm has $dots dots"
done

# In a page no row of a matrix is wider than 400 points; entries: their number, and the sum of their squares
"$plgen" --explain=json "$root/models/beam4.spec" 2>log | tr -d ' \n' | sed 's/.*"M":\[\[//; s/\]\],"C".*//' |
	tr '],[' '\n\n\n' | awk 'NF { n++; sum += $1^2 } END { print n, sum }' >M
PATH=$PWD/own:$PATH "$plgen" --report "$root/models/beam4.spec" 2>>log | awk '
	/<table class="matrix">/ { getline; of = />M</ ? "M" : "" }
	/<\/table>/ { of = "" }
	of == "M" && /<td>/ {
		gsub(/<[^>]*>/, " ")
		for (i = 2; i <= NF; i++) { n++; sum += $i^2 }
		wide = length($0) > wide ? length($0) : wide
	}
	END { print n, sum, wide }' >found
paste -d ' ' M found | awk '{ print }
	!($1 == 225 && $3 == 225 && $2 > 0.1 && ($2 / $4 - 1)^2 < 1e-20 && $5 < 62) { exit 1 }' >>log
result $? 'a page: matrices in tables that a telephone holds'

# ---- without gnuplot, and where it fails ----

# refused STATUS TEXT NAME OPTION...: nothing on standard output
refused() {
	expected=$1
	text=$2
	name=$3
	shift 3
	PATH=${path:-$PATH} "$plgen" "$@" >out 2>log
	[ $? -eq "$expected" ] && [ ! -s out ] && grep -qF -- "$text" log
	result $? "$name"
}
spec=$root/models/sdcsf.spec
echo kept >kept.svg
path=$PWD/bare
refused 1 'gnuplot draws pictures, and it is not installed' 'gnuplot is missing' --plot poles "$spec"
refused 1 'gnuplot draws pictures, and it is not installed' 'gnuplot is missing: the page' --report "$spec"
refused 1 'gnuplot draws pictures' 'gnuplot is missing: onto a file' --plot poles -o kept.svg "$spec"
printf '#!/bin/sh\necho no such terminal >&2\necho half a picture\nexit 1\n' >bare/gnuplot
chmod +x bare/gnuplot
path=$PWD/bare:$PATH
refused 1 'no such terminal' 'gnuplot fails' --plot poles -o kept.svg "$spec"
[ "$(cat kept.svg)" = kept ] && [ "$(ls kept.svg*)" = kept.svg ]
result $? 'a file stays as it was where gnuplot fails'
path=
refused 2 '--amplitude goes with --response and --plot frf' 'an amplitude without a sweep' --plot poles --amplitude 1 \
	"$spec"
refused 2 "with commas between, or campbell, found 'pole'" 'no such picture' \
	--plot poles,pole "$spec"
refused 2 "found ''" 'a picture without a name' --plot poles, "$spec"
refused 2 "-o of --plot takes FILE.svg, FILE.png or FILE.pdf, found 'a.c'" 'no such ending' --plot poles -o a.c "$spec"
refused 1 'plrun --plot' 'a response that is not linear' --plot response "$root/models/pendulum.spec"
refused 1 'plrun --plot' 'a response with inputs' --plot response "$here/car.spec"
printf 'model m\ncoord x, y\ninput u\nx%s + x = 0\ny%s + y = u\noutput x\nstep 0.01\n' "''" "''" >apart.spec
printf 'model m\ncoord x\nx%s + x = 0\nstep 0.01\n' "''" >alone.spec
printf 'model m\ncoord q[13]\ninput u\nmatrix b = [1; 1; 1; 1; 1; 1; 1; 1; 1; 1; 1; 1; 1]\nq%s + q = b*u\nstep 0.01\n' \
	"''" >many.spec
refused 1 'no output that is linear reacts' 'no reaction' --plot frf apart.spec
refused 1 'there is no input and no load' 'no input and no load' --plot frf alone.spec
refused 1 '26 states: frequency responses are limited to 24' 'too many states' --plot frf many.spec

# ---- models that are not linear ----

# unlinear NAME LEFT_OUT GAIN,K,C|WHY EQUATION: --explain names what linear terms leave out; the response is that of the
# linear equation at rest, x'' + C x' + K x = GAIN u, or is refused for a reason
unlinear() {
	printf 'model unlinear\nparam k = 4\ncoord x\ninput u\n%s\noutput x\nstep 0.01\n' "$4" >"$1.spec"
	good=0
	"$plgen" --response 0.1:1:3 "$1.spec" >out 2>log || [ ! -s out ] || good=1
	case $3 in
	[0-9]*)
		grep -q 'note: linearised at rest: x = ' log || good=1
		awk -F, -v want="$3" 'BEGIN { split(want, v, ",") } NR > 1 {
			w = 8 * atan2(1, 1) * $1
			size = v[1] / sqrt((v[2] - w^2)^2 + (v[3] * w)^2)
			print $2, size
			wrong = wrong || ($2 - size) * ($2 - size) > 1e-24 * size * size
		} END { exit wrong || NR != 4 }' out >>log || good=1 ;;
	*) [ ! -s out ] && grep -qF -- "$3" log || good=1 ;;
	esac
	"$plgen" --explain=json "$1.spec" >json 2>>log && python -c '
import json, sys
told = json.load(open("json"))
print(told["linear"], told["left_out"])
wrong = told["linear"] or "; ".join(told["left_out"]) != sys.argv[1] or {"ss", "shapes", "zeros"} & set(told)
missing = {"M", "C", "K", "B", "poles", "modes", "Phi", "cost"} - set(told)
sys.exit(bool(wrong or missing))' "$2" >>log || good=1
	"$plgen" --explain "$1.spec" >text 2>>log && grep -A1 'The model is not linear' text | grep -qF -- "    $2" &&
		! grep -q 'static gain  ' text || good=1
	result $good "not linear: $1"
}
kink='differs between the sides'
contact='friction, impacts and jumps have no linear equations'
unlinear rate "(x' > 0 ? 1 : 4)*x'" "$kink" "x'' + (x' > 0 ? 1 : 4)*x' + k*x = u"
unlinear lifting 'max(k*(u - x), -2)' 4,4,0 "x'' = max(k*(u - x), -2)"
unlinear pendulum 'sin(x)' 1,1,0.1 "x'' + 0.1*x' + sin(x) = u"
unlinear several "x'^3; max(x - 0.2, 0)" 1,4,0 "x'' + 0.1*x'^3 + k*x + max(x - 0.2, 0) = u"
unlinear rubbed "friction(x', 0.3)" "$contact" "x'' + k*x + friction(x', 0.3) = u"
unlinear struck "when x >= 0.1: x' = -0.8*x'" "$contact" "x'' + k*x = u
when x >= 0.1: x' = -0.8*x'"
unlinear growing "(1 + 0.1*cos(t))*k*x" 1,4.4,0 "x'' + (1 + 0.1*cos(t))*k*x = u"
unlinear changing '(t < 1 ? 1 : 2)*x' 1,1,0 "x'' + (t < 1 ? 1 : 2)*x = u"
unlinear squared 'u^2' 0,4,0 "x'' + k*x = u^2"

# at PLACE NOTE SPEC LINEAR: the response of SPEC there is that of the equations written by hand
at() {
	printf '%b\nstep 0.01\n' "$3" >bent.spec
	printf '%b\nstep 0.01\n' "$4" >hand.spec
	"$plgen" --response 0.1:5:7 --at "$1" bent.spec >bent.csv 2>log &&
		"$plgen" --response 0.1:5:7 hand.spec >hand.csv 2>>log &&
		grep 'note: linearised at' log | grep -qF "$2" && awk -F, '
		NR == FNR { for (i = 1; i <= NF; i++) one[FNR, i] = $i; rows = FNR; columns = NF; next }
		FNR == 1 && NF != columns { print NF, "columns"; bad = 1 }
		{ for (i = 1; i <= NF; i++) { d = FNR > 1 ? $i - one[FNR, i] : $i != one[FNR, i]
			v = FNR > 1 && $i != 0 ? $i : 1
			if (d * d > 1e-20 * v * v) { print FNR, i, $i, one[FNR, i]; bad = 1 } } }
		END { exit bad || FNR != 8 || rows != 8 }' hand.csv bent.csv >>log
	result $? "at $1: $2"
}
at rest 'rest: z = -0.185082, w = -0.021582' "model m\ncoord z, w\ninput road hold first\ninit z = 2, w = 1.7
300*z'' + 1200*(z' - w') + 18000*(z - w) = -300*9.81
30*w'' - 1200*(z' - w') - 18000*(z - w) + 150000*min(w - road, 0) = -30*9.81\noutput z, a = z''" \
	"model m\ncoord z, w\ninput road hold first
300*z'' + 1200*(z' - w') + 18000*(z - w) = 0
30*w'' - 1200*(z' - w') - 18000*(z - w) + 150000*(w - road) = 0\noutput z, a = z''"
at "x=0.5,x'=-1" "x = 0.5, x' = -1; the motion does not stay there" "model m\ncoord x\ninput u hold first
2*x'' + 3*x'*(1 + x^2) + 50*sin(x) = u^3 + u + 0.2*u'\noutput x, p = x*x'' + u*x, v = x'^2" \
	"model m\ncoord x\ninput u hold first\nparam a = (3.75 - 50*sin(0.5))/2
2*x'' + 3.75*x' + (50*cos(0.5) - 3)*x = u + 0.2*u'\noutput x, p = 0.5*x'' + a*x + 0.5*u, v = -2*x'"
at rest 'rest: q[1] = 0.5, q[2] = 0, z = -0.693147' "model m\ncoord q[2], z\ninput u\nlet s = q[1]*q[2]
q'' + [2, -1; -1, 4]*q + [s; 2*s] = [1 + u; -0.5]\nz' + exp(z) = q[1]\noutput q[1], z" \
	"model m\ncoord q[2], z\ninput u
q'' + [2, -0.5; -1, 5]*q = [u; 0]\nz' + 0.5*z = q[1]\noutput q[1], z"
at rest 'rest: x = 0' "model m\ncoord x\ninput u hold first
x'' + 0.2*x' + 9.81*sin(x) = u + 0.5*u(t - 0.25) + u'(t - 0.1)*cos(x)\noutput x, late = u(t - 0.3) + x^2" \
	"model m\ncoord x\ninput u hold first
x'' + 0.2*x' + 9.81*x = u + 0.5*u(t - 0.25) + u'(t - 0.1)\noutput x, late = u(t - 0.3)"
# Where the model's own motion is at t: x = 1/(1 + t); a mass that falls from 0.2 m by 10 m/s^2 onto a spring, which it
# meets at t = 0.2 s
bend="model m\ncoord x, y\ninput u\ninit x = 1, y = 1, y' = 1\ntolerance 1e-14
x' + x^2 = u\ny'' + 0.2*y' + (2 + sin(pi*t))*y^2 = u + cos(pi*t/3)\noutput x"
at t=1 't = 1 of the motion from the initial values, scheme taylor: x = 0.5, y = ' "$bend" \
	"model m\ncoord x, y\ninput u\nx' + x = u\ny' + y = cos(pi*t/3)\noutput x"
grep -q 'loads are as there: cos(1.0471975512\*t) = 0.5; coefficients are those of that time' log
result $? 'at t=1: the load there is named'
at t=0.5,x=3,y=2 "t = 0.5, x = 3, y = 2, y' = 1" "$bend, y" "model m\ncoord x, y\ninput u
x' + 6*x = u\ny'' + 0.2*y' + 12*y = u + cos(pi*t/3)\noutput x, y"
fall="model m\ncoord x\ninput u\ninit x = 0.2\nx'' + x' - x' + 100*min(x, 0) = u - 10"
at t=0.1 "scheme exact: x = 0.15, x' = -1; in region 1, where 0 < x" \
	"$fall" "model m\ncoord x\ninput u\nx'' = u"
at t=0.3 'in region 0, where x < 0' "$fall" "model m\ncoord x\ninput u\nx'' + 100*x = u"

# It starts with the spec's initial values less the point.
printf "model m\ncoord x\ninit x = 1, x' = 2\nx'' + 0.3*x' + exp(x) - 1 = cos(2*t) + 1\nstep 0.1\n" >bent.spec
printf "model m\ncoord x\ninit x = 1 - log(2), x' = 2\nx'' + 0.3*x' + 2*x = cos(2*t)\nstep 0.1\n" >hand.spec
"$plgen" --at rest --solution 1 bent.spec >bent.csv 2>log && "$plgen" --solution 1 hand.spec >hand.csv 2>>log &&
	awk -F, 'NR == FNR { for (i = 1; i <= NF; i++) one[FNR, i] = $i; rows = FNR; next }
		{ for (i = 1; i <= NF; i++) { d = $i - one[FNR, i]
			if (FNR > 1 && d * d > 1e-28) { print FNR, i, $i, one[FNR, i]; bad = 1 } } }
		END { exit bad || FNR != 12 || rows != 12 || NF != 3 }' hand.csv bent.csv >>log
result $? 'deviations from rest: the closed form of the linear equations by hand'

cat >ended.spec <<'END'
model ended
coord x, y, z
init x = 1, y = 1
x' + x = t < 1 ? cos(3*t) : 0
y'' + y = t < 2 ? t : 0
z'' + z = t < 2 ? cos(t) : 0
step 50
END
"$plgen" --solution 600 ended.spec 2>log | awk -F, 'NR > 3 { t = $1 - 2
		off = ($2/x/exp(-50) - 1)^2 + ($3 - cos($1) + sin($1) - 2*cos(t) - sin(t))^2
		if (off + ($4 - sin($1) - sin(2)/2*sin(t))^2 > 1e-26) { print $1, off; bad = 1 } } { x = $2 }
	END { exit bad || NR != 14 }' >>log
result $? 'a load that has ended: to all digits what it has left, also where it swings as the mass does'

# linear NAME EQUATION OPTION...: a load in time, a scheme, a param that the target changes take nothing away
linear() {
	name=$1
	printf 'model linear\nparam k = 4\ncoord x\ninput u\n%s\noutput x\nstep 0.01\n' "$2" >linear.spec
	shift 2
	"$plgen" --explain=json "$@" linear.spec >json 2>log && grep -q '"linear": true' json &&
		grep -q '"left_out": \[\]' json && grep -q '"static_gain": 0.25' json &&
		"$plgen" --response 0.1:1:3 "$@" linear.spec 2>>log | awk -F, 'NR > 1 {
			w = 8 * atan2(1, 1) * $1
			size = 1 / sqrt((4 - w^2)^2 + w^2)
			if (!($2 / size - 1 < 1e-12 && $2 / size - 1 > -1e-12)) {
				print $1, $2, size
				wrong = 1
			}
		} END { exit wrong || NR != 4 }' >>log
	result $? "linear: $name"
}
linear 'as it is' "x'' + x' + k*x = u"
linear 'a load of no known kind' "x'' + x' + k*x = u + sqrt(1 + t)"
linear 'a load that changes' "x'' + x' + k*x = u + (t < 1 ? sin(t) : t)"
linear 'a scheme with a remainder' "x'' + x' + k*x = u" --scheme etdrk4
linear 'scheme pl' "x'' + x' + k*x = u" --scheme pl
linear 'scheme taylor, and a tunable param' "x'' + x' + k*x = u
tunable k" --scheme taylor

# ---- Campbell diagrams ----

# An undamped rotor whirls by e^{iv t} with (k - m v^2)(kr - It v^2 + Ip w v) = kt^2, v above 0 forward and below 0
# backward (Den Hartog 1956, 6.4); at v = w and v = -w that is of second degree in w^2.
"$plgen" --plot campbell --sweep w=0:600:13 -D c=0 --orders 1,2 -o rotor.csv "$root/models/rotor.spec" 2>log &&
	awk -F '[, ]' 'BEGIN { pi = 4 * atan2(1, 1); EI = 2.1e11 * pi * 0.03^4 / 64; L = 0.4
			k = 12 * EI / L^3; kt = 6 * EI / L^2; kr = 4 * EI / L; m = 10; It = 0.1; Ip = 0.2 }
		function off(v, w,  one, two) {
			one = k - m * v * v
			two = kr - It * v * v + Ip * w * v
			return (one * two - kt^2) / ((k + m * v * v) * (kr + It * v * v + Ip * w * v) + kt^2)
		}
		function close_to(got, want, what) {
			print what, got, want
			if (!(got / want - 1 < 1e-9 && got / want - 1 > -1e-9)) wrong = 1
		}
		# (k - m z)(kr - j z) = kt^2 by z = w^2: the lower one that is above 0
		function critical(j,  p, q, one, two) {
			p = (k * j + kr * m) / (m * j)
			q = (k * kr - kt^2) / (m * j)
			one = (p - sqrt(p * p - 4 * q)) / 2
			two = (p + sqrt(p * p - 4 * q)) / 2
			return sqrt(one > 0 && (one < two || two < 0) ? one : two)
		}
		/^[0-9]/ { rows++; v = 2 * pi * $3; w = $1
			e = $7 == "backward" ? off(-v, w) : off(v, w)
			if (!(e < 1e-11 && e > -1e-11) || $7 != (w == 0 ? "planar" : $8 > 0 ? "forward" : "backward")) {
				print $0, e; wrong = 1 }
			if (w > 0 && ($8 * $8 < 1 - 1e-9 || $4 != 0)) wrong = 1 }
		/^# 1x.*backward/ { seen++; close_to(2 * pi * substr($10, 1), critical(It + Ip), "backward, 1x") }
		/^# 1x.*forward/ { seen++; close_to(2 * pi * $10, critical(It - Ip), "forward, 1x") }
		/^# 2x/ { twice++ }
		END { exit wrong || rows != 52 || seen != 2 || twice != 3 }' rotor.csv >log
result $? 'campbell: whirl of a rotor with a gyroscopic moment, and its critical speeds'
"$plgen" --plot campbell --sweep w=0:600:3 --depfile rotor.d "$root/models/rotor.spec" >log 2>&1 && test -s rotor.d &&
	"$plgen" --plot campbell --sweep w=0:600:13 --whirl y:x,b:a -o back.csv - <"$root/models/rotor.spec" 2>log &&
	"$plgen" --plot campbell --sweep w=0:600:13 -o back.json "$root/models/rotor.spec" 2>>log && python -c '
import json, sys
rows = [line.split(",") for line in open("back.csv") if line[0].isdigit()]
told = json.load(open("back.json"))
other = {"forward": "backward", "backward": "forward", "planar": "planar"}
modes = [(v["value"], m) for v in told["values"] for m in v["modes"]]
wrong = len(modes) != len(rows) or len(rows) != 52 or len(told["crossings"]) != 2 or told["unit"] != "rad/s"
for row, (value, m) in zip(rows, modes):
    wrong |= float(row[0]) != value or float(row[2]) != m["frequency_hz"] or row[6] != other[m["whirl"]]
wrong |= [p["by"] for p in told["pairs"]] != ["gyroscopic terms", "names"]
sys.exit(wrong)' >>log 2>&1
result $? 'campbell: JSON, and pairs the other way around'
# A cubic spring that a weight bends by 1: K = 1 + 3*0.25*x^2 there, sqrt(k + 0.75)/(2 pi) Hz; the speed in rpm
printf "model m\nparam m = 1 \"kg\", k = 1 \"N/m\"\ncoord x \"m\"
m*x'' + k*x + (0.25 \"N/m^3\")*x^3 = k*(1 \"m\") + (0.25 \"N\")\nstep 0.1\n" >bent.spec
"$plgen" --plot campbell --sweep k=1:3rpm:3 --orders 10 -o bent.csv bent.spec 2>log && awk -F , '/^[0-9]/ { rows++
	d = $3 * 8 * atan2(1, 1) / sqrt($1 + 0.75) - 1; if (d * d > 1e-24 || $7 != "none") wrong = 1 }
	/^# 10x crosses mode 1 at k = 1\.[0-9]*: 0\.[0-9]* Hz/ { seen++ }
	END { exit wrong || rows != 3 || seen != 1 }' bent.csv
result $? 'campbell: a nonlinear model at rest for each value; rpm'
refused 2 '--plot campbell takes the param and its values from --sweep' 'campbell alone' --plot campbell "$spec"
refused 2 '--sweep goes with --plot campbell' 'a sweep alone' --sweep w=0:1 --plot poles "$spec"
refused 2 'of campbell also FILE.csv and FILE.json' 'an ending of campbell' --plot campbell --sweep w=0:1 -o a.c "$spec"
refused 2 "found 'a.csv'" 'an ending of others' --plot poles -o a.csv "$spec"
refused 1 'expected two values that rise' 'a sweep that falls' --plot campbell --sweep w=3:1 "$spec"
refused 1 'expected a number of values from 2' 'one value' --plot campbell --sweep w=0:1:1 "$spec"
refused 2 '--dark is of a picture: --plot KIND draws it' 'C in the dark' --dark "$spec"
refused 2 'the page of --report is as wide as its window' 'a page on paper' --report --paper "$spec"
refused 2 '--paper is light, and --dark is not' 'a paper in the dark' --plot poles --dark --paper "$spec"
refused 2 "each from 20 to 10000, found '10x400'" 'a picture of 10 points' --plot poles --size 10x400 "$spec"
refused 2 'has a control character in it' 'a title with commands' --plot poles --title "$(printf 'a\tb')" "$spec"
refused 2 "--title is of a picture, and 'a.csv' is a table" 'the title of a table' --plot campbell --sweep w=0:1 \
	--title a -o a.csv "$spec"
refused 1 'up to 16 numbers above 0' 'order 0' --plot campbell --sweep w=0:1 --orders 0 "$spec"
refused 1 "'x:q' is none" 'a pair that is none' --plot campbell --sweep w=1:2 --whirl x:q "$root/models/rotor.spec"
refused 1 "no param is named 'zz'" 'a sweep of nothing' --plot campbell --sweep zz=0:1 "$spec"

# ---- with gnuplot ----

if command -v gnuplot >log; then
	good=0
	for kind in 'svg <?xml' 'png PNG' 'pdf %PDF'; do
		end=${kind%% *}
		"$plgen" --plot frf,poles -o "a.$end" "$spec" >out 2>log &&
			"$plgen" --plot frf,poles -o "b.$end" "$spec" && [ ! -s out ] &&
			head -c 8 "a.$end" | grep -aqF "${kind#* }" || good=1
	done
	"$plgen" --plot campbell --sweep w=0:600 --orders 1,2 -o rotor.svg "$root/models/rotor.spec" 2>log &&
		grep -q '<svg ' rotor.svg && grep -q 'crosses mode 2 at w = 163.347' log || good=1
	cmp a.svg b.svg >>log && cmp a.png b.png >>log && [ "$good" -eq 0 ]
	result $? 'svg, png and pdf'
	for name in models/sdcsf models/quarter_car models/tuned_floor tests/refresh/growing; do
		"$plgen" --report "$(path_of $name.spec)" >page 2>log && awk -f "$here/page.awk" page >log 2>&1 &&
			[ "$(grep -c '^ width="900"' page)" -ge 3 ] &&
			[ "$(grep -c '^ width="900"' page)" -eq "$(grep -c '^ width="400"' page)" ]
		result $? "the page of $name, each picture on a broad and on a narrow sheet"
	done
	for name in models/bilinear models/quarter_car_bumps models/beam4 models/pendulum tests/remainder/gated; do
		"$plgen" --report "$root/$name.spec" >page 2>log &&
			awk -v nonlinear=1 -f "$here/page.awk" page >log 2>&1 && ! grep -q '<svg ' page
		result $? "the page of $name, which is not linear"
	done
else
	skip 'svg, png and pdf' 'no gnuplot'
fi

tap_end
