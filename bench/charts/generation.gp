# SPDX-License-Identifier: GPL-3.0-or-later
# generation.gp break_even.csv OUTDIR
here = system("dirname '".ARG0."'"); csv = ARG1; out = ARG2
size = '1000,760'                       # room for some thirty rivals in the legend
load here.'/style.gp'
set key font ',9' spacing 1.0
names = system("awk -F, 'NR > 1 && !seen[$1]++ { printf \"%s \", $1 }' '".csv."'")
# Each model's number in place of its name; `never` has a band of its own above all that is ever, where the rivals stand
# one over the other
never = 1e10
numbered = "< awk -F, 'NR == 1 { print; next } !($1 in n) { n[$1] = ++count } { sub(/^[^,]*/, n[$1]); if (/,never/) ".\
	"gsub(/,never/, sprintf(\",%g\", ".sprintf("%g", never)." * 1.6^m[$1]++)); ".\
	"print }' '".csv."' | awk -f '".here."/csv.awk' -f '".here."/series.awk' -v by=rival -v x=model -v ".\
	"y=break_even_steps | sed 's/with linespoints/with points/g; s/ dt [^ ]* lw/ lw/g'"
name = 'break_even'
set title "Steps that win back generating and compiling, error 1e-6 (float: 1e-3)"
set ylabel 'steps of the generated code [1]'
unset logscale x
unset xlabel
set format x '%g'
set xrange [0.5:words(names) + 0.5]
set xtics rotate by -40 left ()
do for [k=1:words(names)] { set xtics add (system("echo '".word(names, k)."' | sed 's/_/\\\\_/g'") k) }
set bmargin 10
set yrange [*:3e12]
set ytics 1, 10, 1e9
set ytics add ('never' never)
set arrow 1 from graph 0, first 3e9 to graph 1, first 3e9 nohead dt 3 lc rgb '#808080'
set label 2 "never: the rival is as fast or faster, or it alone comes to that error. No mark: the rival does not. ".\
	"Float beside float." \
	at screen 0.01,0.05 left font ',9' textcolor rgb '#505050'
eval note." 'Parameters of most models chosen. Each at its cheapest setting; gcc -O2 for all. What a rival computes ".\
	"before it starts is not counted.'"
load numbered
eval "plot ".clauses
eval write
