# SPDX-License-Identifier: GPL-3.0-or-later
# papers_beam_tip.csv: what etd1 makes of the rotating beam, by its operator
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = 0
load here.'/style.gp'
csv = folder.'/papers_beam_tip.csv'
unset logscale x
set format x '%g'
set xrange [0:50]
set yrange [1e-4:1e3]
set xtics 10
set ytics 1e-4,10,1e3
set bmargin 0

rows(h, operator) = "< awk -F, '$1 == ".h." && $2 == \"".operator."\" && $4 ~ /^[0-9]/ { print $3, $4 }' OFS=, ".\
	"'".csv."'"
# soft operators: open marks, dashed; from that of the true speed on: filled marks, unbroken
marks = '4 6 8 12 5 7 9'
colours = '#be3028 #c48600 #be3028 #c48600 #1f6fe0 #6a6f78 #1f6fe0'
curves(h) = "plot rows('".h."', 'reference') using 1:2 with lines lw 5 lc rgb '#c0c0c0' title 'true', ".\
	"for [w = 0:6] rows('".h."', 'A('.w.')') using 1:2 with linespoints pt int(word(marks, w + 1)) ps 0.9 pi 6 ".\
	"lc rgb word(colours, w + 1) dt 1 + (w < 4) lw (w < 4 ? 1.3 : 2.2) title 'A('.w.')'"
steps = system("awk -F, 'NR > 1 && !seen[$1]++ { print $1 }' '".csv."'")
left(k) = 0.08 + 0.265*(k - 1)

frame = "set multiplot; eval found_label; ".\
	"set tmargin screen 0.85; set bmargin screen 0.13; set xlabel 'time [s]' offset 0,0.4; ".\
	"do for [k = 1:words(steps)] { ".\
	"set lmargin screen left(k); set rmargin screen left(k) + 0.225; ".\
	"set title 'h = '.word(steps, k).' s' offset 0,-0.6; ".\
	"if (k == 1) { set ylabel 'deflection of the tip [m]'; set format y '10^{%T}' } else { set ylabel ''; ".\
	"set format y ''; unset label }; ".\
	"if (k == words(steps)) { set key at screen left(k) + 0.24,0.85 left top vertical Left reverse samplen 3 ".\
	"spacing 1.3 font ',10' } else { unset key }; ".\
	"eval curves(word(steps, k)) }; unset multiplot; "
name = 'papers_beam_tip'
do for [form = 1:forms] {
	eval begin(form)
	eval frame
	unset output
}
