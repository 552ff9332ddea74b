#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Pictures: of each kind, with as many lines as there are outputs, and the rows beside them.
#
#     plot.sh PLRUN PLGEN SOURCE_ROOT
. "${0%/*}/begin.sh"
if ! command -v gnuplot >/dev/null; then
	skip plot 'no gnuplot'
	tap_end
fi
run "$models/sdcsf.spec" 2 >plain.csv
run "$models/sdcsf.spec" 2 --plot "it's a.svg" >rows.csv
same plain.csv rows.csv 'the rows are written, too'
grep -q '<path' "it's a.svg" && [ "$(grep -c "rgb( 31, 111, 224)" "it's a.svg")" -ge 4 ]
result $? 'svg: a line for each output'
grep -q "x1'" "it's a.svg" || grep -q 'x1&apos;\|x1&#39;' "it's a.svg"
result $? 'svg: the names of the outputs'
run "$models/sdcsf.spec" 2 --plot=a.png >rows.csv && [ "$(head -c 4 a.png | tail -c 3)" = PNG ]
result $? png
run --plot a.pdf "$models/sdcsf.spec" 2 >rows.csv && [ "$(head -c 4 a.pdf)" = %PDF ]
result $? pdf
awk '/^model two/ { on = 1 } on && /^```/ { exit } on' "$root/README.md" >two.spec
run two.spec 30 --plot two.svg >two.csv && [ "$(wc -l <two.csv)" -eq 3002 ] && [ "$(wc -c <two.svg)" -gt 20000 ]
result $? 'README: the spec, run and drawn'
run "$models/scs.spec" 300 --plot long.svg >rows.csv && [ "$(wc -c <long.svg)" -lt 4000000 ]
result $? 'a picture of many rows stays small'
for spec in brake impact_oscillator; do
	run "$models/$spec.spec" 2 >plain.csv
	run "$models/$spec.spec" 2 --plot $spec.svg >rows.csv
	same plain.csv rows.csv "$spec: the rows are written, too"
	grep -q '<path' $spec.svg
	result $? "$spec: a picture"
done
mkdir own
printf '#!/bin/sh\ncat >script\necho "$*" >arguments\necho drawn\n' >own/gnuplot
chmod +x own/gnuplot
(PATH=$PWD/own:$PATH; run "$models/sdcsf.spec" 30 --every 0.25 --plot thin.svg >rows.csv)
sed -n '/^\$data/,/^END/{//d;p}' script >points
sed '1d; s/,/ /g' rows.csv >expected
[ "$(wc -l <points)" -eq 121 ] && cmp expected points >>log 2>&1
result $? 'with --every a picture has the points of the rows'
grep -q 'xrange \[0:30\]' script
result $? 'with --every a picture ends where the rows end'
[ "$(cat arguments)" = '-d -' ] && [ "$(cat thin.svg)" = drawn ] && ! grep -q 'thin\|set output' script
result $? 'gnuplot without start files, and without the name of the file'

# ---- what is shown, and where ----
# script OPTION ...: what gnuplot is given, in `script`
script() {
	(PATH=$PWD/own:$PATH; run "$@" >rows.csv)
}
run "$models/sdcsf.spec" 2 >all.csv
script "$models/sdcsf.spec" 2 --show "x2',x1+x2,x1:x1'" --plot shown.svg
cut -d, -f 1-5 all.csv | awk -F, -v OFS=, '{ print $1, $5, $2, $3, $4 }' >expected
same expected rows.csv '--show: rows have the columns, in the order in which they are named, each once'
sed -n '/^\$data/,/^END/{//d;p}' script >points
sed '1d; s/,/ /g' rows.csv >expected
[ "$(wc -l <points)" -eq 201 ] && cmp expected points >>log 2>&1
result $? '--show: a picture has all points'
# panels in their order: columns, and the curves of one in the order in which they are named
grep '^plot' script | sed 's/ with \([^$]*\)//g; s/plot //' >panels
printf '%s\n' '$data using 1:2' '$data using 1:3$data using 1:4' '$data using 3:5' | diff - panels >log
result $? '--show: panels, and curves of one panel, in their order'
grep '^plot' script | sed -n 2p | grep -o "dt [^ ]* pt [0-9]*\|rgb '[^']*'\|title '[^']*'" | tr '\n' ' ' >found
echo "dt 1 pt 7 rgb '#1f6fe0' title 'x1' dt (12,5) pt 5 rgb '#be3028' title 'x2' " | tr -d '\n' | diff - found >log
result $? 'curves of one panel differ in colour, dash and mark'
run "$models/sdcsf.spec" 2 --show "x1+x2,x1:x1'" --plot shown.svg --title "A & B's <title>" --dark \
	--size 640x500 >rows.csv
{
	xmllint --noout shown.svg && grep -q 'width="640" height="500"' shown.svg &&
		grep -q '#14171c\|rgb( *20, *23, *28)' shown.svg && grep -q 'A &amp; B' shown.svg &&
		! grep -q '>sdcsf<' shown.svg || echo 'the look is another one'
	grep -o '<title>x[12]</title>' shown.svg | tr -d '\n'
} >log 2>&1
grep -qx '<title>x1</title><title>x2</title>' log
result $? 'svg: size, colours, title and the curves in their order'
awk '/translate\(/ { split($0, part, /[(,)]/); y = part[3] }
	/>x1<|>x2</ { if (/<text|<tspan|>x[12]</ && !/title/ && !key) key = y }
	/>-*0\.[0-9]*</ && !top { top = y }
	END { print "key at", key, "first tic at", top; exit !(key > 0 && top > 0 && key < top) }' shown.svg >log
result $? 'svg: the legend is above its panel'
printf 'model decay\ncoord x\noutput x, y = x - 1\nx'"'"' + x = 0\ninit x = 1\nstep 0.1\n' >decay.spec
script decay.spec 5 --show x --plot log.svg --log xy
grep -q '^set logscale x' script && grep -q '^set logscale y' script && grep -q 'xrange \[0.1:5\]' script
result $? '--log xy: from the first row after t = 0'
run decay.spec 5 --show y --plot log.svg --log y >rows.csv
[ $? -eq 1 ] && grep -q "^plrun: error: --log y: 'y' is nowhere above 0$" said
result $? '--log y of what is nowhere above 0'
script "$models/scs.spec" 300 --show "x1:x1'" --plot cloud.svg
grep -q '^plot \$first using 2:3 with points' script && grep -q '^note: .*a point in 4 steps$' said &&
	[ "$(sed -n '/^\$first/,/^END/{//d;p}' script | wc -l)" -eq 7501 ]
result $? 'one over another in a long run: points, all of which are rows'
sed 1d rows.csv | awk -F, 'NR % 4 == 1 { print $1, $2, $3 }' >expected
sed -n '/^\$first/,/^END/{//d;p}' script | cmp - expected >log
result $? 'one over another in a long run: every fourth row'
run "$models/sdcsf.spec" 2 --paper --plot paper.pdf >rows.csv && grep -aq '/FontFile' paper.pdf &&
	grep -aq '/MediaBox \[ 0 0 24[01]' paper.pdf
result $? '--paper: a PDF of 85 mm, fonts inside'
run "$models/sdcsf.spec" 2 --sweep k1=50:150:5 --show x1+x2 --plot sweep.svg >rows.csv
[ "$(head -n 1 rows.csv)" = 'run,k1,final x1,final x2,rms x1,rms x2,status' ] &&
	grep -o '<title>[a-z]* of x[12]<' sweep.svg | sed 's/<[a-z]*>*//g' | tr '\n' , >log &&
	grep -qx 'final of x1,rms of x1,final of x2,rms of x2,' log
result $? '--show in a sweep: columns and curves'
script "$models/sdcsf.spec" 2 --sweep k1=50:150:3 --sweep step=0.01:0.02:2 --show "x1,x1:x1'" \
	--plot runs.svg --histories
grep '^plot' script | sed -n 1p | grep -o "title '[^']*'" | sed "s/title //" | tr '\n' , >log
grep -qxF "'k1 = 50, step = 0.01','k1 = 50, step = 0.02','k1 = 100, step = 0.01','k1 = 100, step = 0.02',$(
	)'k1 = 150, step = 0.01','k1 = 150, step = 0.02'," log && [ "$(grep -c '^plot' script)" -eq 2 ]
result $? '--histories: a curve for each run, in the order of the table'
sed -n '/^\$data4/,/^END/{//d;p}' script >points
run "$models/sdcsf.spec" 2 --step 0.02 -D k1=100 --show "x1,x1'" >rows.csv
sed '1d; s/,/ /g' rows.csv >expected
[ "$(wc -l <points)" -eq 101 ] && cmp expected points >log 2>&1
result $? '--histories: the rows of a run with these values'
cat >units.spec <<'X'
model units
param k = 18 "kN/m"
tunable k
coord x "m"
init x = 0.01
(2 "kg")*x'' + (20 "N s/m")*x' + k*x = 0
output x "mm", f = k*x "kN", a = x''
step 1 "ms"
X
script units.spec 0.5 --show "x,f+a,x:x'" --plot units.svg
grep "^set [xy]label '" script | cut -d"'" -f 2- | grep -v "^' noenh" >found
printf "%s' noenhanced\n" 'x [mm]' 't [s]' 'x [mm]' "x'' [m/s]" >expected
diff expected found >log
result $? 'units at the axes, where the curves of a panel have one'
script units.spec 0.5 --psd hann:64 --show "a,x,x+f" --plot units.svg
grep "^set ylabel '" script | cut -d"'" -f 2 >found
printf '%s\n' 'a [(m/s^2)²/Hz]' 'x [mm²/Hz]' ' [unit²/Hz]' | diff - found >log
result $? 'units of spectral densities'
script units.spec 0.5 --sweep k=10:20:3 --show x --plot units.svg
grep -q "^set xlabel 'k \[kN/m\]'" script
result $? 'the unit of a param at its axis'

mkdir home && echo 'system "touch started"' | tee home/.gnuplot >.gnuplot
(HOME=$work/home XDG_CONFIG_HOME=$work/home; export HOME XDG_CONFIG_HOME
	run "$models/scs.spec" 1 --plot start.svg >rows.csv) && [ -s start.svg ] && [ ! -f started ]
result $? 'a start file of the user is not read'
name=$(printf 'a\nsystem "touch executed"\n.svg')
run "$models/scs.spec" 1 --plot "$name" >rows.csv
[ $? -eq 2 ] && [ ! -s rows.csv ] && [ ! -f executed ] &&
	[ "$(head -n 1 said)" = 'plrun: error: --plot: the name of the picture has a control character in it' ]
result $? 'lines of gnuplot in the name of a picture'
echo before >kept.svg && printf '#!/bin/sh\necho half; echo no >&2; exit 1\n' >own/gnuplot
(PATH=$PWD/own:$PATH; run "$models/scs.spec" 1 --plot kept.svg >rows.csv)
[ $? -eq 1 ] && [ "$(cat kept.svg)" = before ]
result $? 'where gnuplot fails a picture stays as it was'
(unset DISPLAY WAYLAND_DISPLAY; run "$models/scs.spec" 1 --plot >rows.csv; [ $? -eq 1 ] && grep -q 'no display' said)
result $? 'a window without a display'
run "$models/scs.spec" 1 --plot none/such/a.svg >rows.csv
[ $? -eq 1 ] && grep -q "cannot write 'none/such/a.svg': No such file" said
result $? 'a picture that cannot be written'
tap_end
