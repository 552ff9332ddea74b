# SPDX-License-Identifier: GPL-3.0-or-later
# hard.csv: methods down, cases across, what came of it
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = ARG3 eq 'narrow'
csv = folder.'/hard.csv'
load "< awk -v narrow=".narrow." -f '".here."/csv.awk' -f '".here."/hard_grid.awk' '".csv."'"
size = sprintf('%d,%d', narrow ? 400 : 900, 150 + (narrow ? 50 : 0) + (narrow ? 19 : 23)*rows)
load here.'/style.gp'
name = 'hard'
unset logscale
unset grid
unset border
set xrange [0.5:cases + 0.5]
set yrange [rows + 0.5:0.5]
eval "set ytics (".tics.") noenhanced scale 0 font ',".(narrow ? 9 : 11)."'"
eval "set x2tics (".cases_tics.") noenhanced scale 0 rotate by 40 left offset 0,0 font ',".(narrow ? 9 : 11)."' ".\
	"textcolor rgb '#202020'"
unset xtics
set x2range [0.5:cases + 0.5]
set lmargin (narrow ? 20 : 26)
set rmargin (narrow ? 8 : 10)
set key off
eval heading
eval sprintf("set tmargin %g", 1.5 + 1.15*lines_of(found) + 4.4)
set bmargin (narrow ? 4 : 3)
set style fill solid 1 border rgb '#ffffff'
legend = 'ok: error below 0.001   exact: nothing left over, ok   poor: below 0.1   wrong: above   div.: diverged   '.\
	'quit: gave up   ref.: refused'
if (narrow) {
	legend = "blue: error below 0.001; p, poor: below 0.1; w, wrong:\nabove; d: diverged; q: gave up; r: refused"
}
set label 1 legend at screen 0.02,screen 0.0 offset 0,(narrow ? 2.2 : 1.2) left font ',10' textcolor rgb '#202020'
plot $cells using 1:2:(0.5):(0.5):3 with boxxyerror lc rgb variable, \
	$cells using 1:2:4 with labels font (narrow ? ',9' : ',10') textcolor rgb '#000001'
eval write
