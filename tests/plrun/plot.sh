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
grep -q '<path' "it's a.svg" && [ "$(grep -c "rgb( 31,  95, 168)" "it's a.svg")" -ge 4 ]
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
