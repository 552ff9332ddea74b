# SPDX-License-Identifier: GPL-3.0-or-later
# break_even.csv: for each model, after how many steps generating and compiling is won back, against the cheapest peer
# in double and against each of the others
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = ARG3 eq 'narrow'
csv = folder.'/break_even.csv'
names = system("awk -F, 'NR > 1 && !seen[$1]++ { printf \"%s \", $1 }' '".csv."'")
size = sprintf('%d,%d', narrow ? 400 : 900, 150 + (narrow ? 50 : 0) + 24*words(names))
load here.'/style.gp'
load "< awk -f '".here."/csv.awk' -f '".here."/pays.awk' '".csv."'"
name = 'break_even'
set xlabel 'steps of the generated code'
unset logscale y
set yrange [words(names) + 0.6:0.4]
set xrange [1:1e11]
set xtics 1,100,1e9
set xtics add ('never' 1e10)
set lmargin (narrow ? 15 : 17)
set ytics () noenhanced font ',11'
do for [k=1:words(names)] { set ytics add (word(names, k) k) }
set arrow 1 from first 3e9, graph 0 to first 3e9, graph 1 nohead dt 3 lc rgb '#8e8e96'
colour(of) = system("awk '$1 == \"".of."\" { print $2 }' '".here."/palette.list'")
eval heading
plot $others using 1:2 with points pt 7 ps 0.45 lc rgb colour('other') title 'against every other peer', \
	$cheapest using 1:2 with points pt 5 ps 1.2 lc rgb colour('exact') title 'against the cheapest peer'
eval write
