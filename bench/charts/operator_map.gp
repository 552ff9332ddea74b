# SPDX-License-Identifier: GPL-3.0-or-later
# operator_map.csv, pl_map.csv and operator_boundary.csv
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = 0
size = '900,690'
load here.'/style.gp'
load here.'/map.gp'
ends = folder.'/operator_boundary.csv'
array names = ['etd1', 'etdrk2', 'etdrk4', 'nc2', 'nc3', 'dq4', 'bm3']
ticks = "set cbtics ('-90 %%' 0.5, '-50 %%' 1.5, '-10 %%' 2.5, '-0.1 %%' 3.5, '±10^{-6}' 5, '0.1 %%' 6.5, '10 %%' ".\
	"7.5, '×2' 8.5, '×11' 9.5)"
unset logscale
set xrange [-2:1.5]
set yrange [-1:1]

name = 'operator_map'
do for [form=1:forms] {
	eval begin(form)
	set multiplot
	eval panels
	do for [k=1:7] {
		unset label
		if (k == 1) { eval found_label }
		set origin 0.003 + 0.248*((k - 1) % 4), 0.475 - 0.455*((k - 1)/4)
		set size 0.248, 0.44
		set title names[k] noenhanced textcolor rgb '#202020'
		set ylabel (k % 4 == 1 ? 'wA / w' : '')
		set xlabel (k > 3 ? 'w h  [rad]' : '')
		set xtics ('0.01' -2, '0.1' -1, '1' 0, '10' 1)
		set ytics ('0.1' -1, '0.2' log10(0.2), '0.5' log10(0.5), '1' 0, '2' log10(2), '5' log10(5), '10' 1)
		plot cells(folder.'/operator_map.csv', names[k], '-v ylog=1') using 1:2:3 with image, \
			ends using (strcol(1) eq names[k] ? log10($2) : NaN):(log10($3)) skip 1 with points pt 7 ps \
			0.22 lc rgb 'black'
	}
	set origin 0.75, 0.0; set size 0.25, 0.45
	eval legend_only
	set label 11 "Colour: the amplitude's change" at screen 0.752,0.425 font ',9' textcolor rgb '#202020'
	set label 12 'within one true period 2π/w' at screen 0.752,0.400 font ',9' textcolor rgb '#202020'
	set label 13 'dots: from damped to growing or back' at screen 0.752,0.375 font ',9' textcolor rgb '#202020'
	set label 14 'wA/w = 1: nothing is left over, exact' at screen 0.752,0.350 font ',9' textcolor rgb '#202020'
	set colorbox vertical user origin 0.80,0.035 size 0.03,0.285
	unset cblabel
	eval ticks
	plot [0:1][0:1] '+' using (2):(2):(0) with points palette
	unset multiplot
	unset output
}

# ---- pl ----
# Where pl grows by kappa h/4 a second the amplitude grows by e^{(pi/2) (k2/(k1 + k2)) w h} a period: dashed, at the
# bounds of the classes
predicted(x, percent) = log(1 + percent/100.0)*2/pi/10**x         # k2/(k1 + k2)
coupling(x, percent) = predicted(x, percent) < 1 ? log10(predicted(x, percent)/(1 - predicted(x, percent))) : NaN
set yrange [-3:1]
size = '900,600'
load here.'/style.gp'
load here.'/map.gp'
name = 'pl_map'
do for [form=1:forms] {
	eval begin(form)
	set size 1,1; set origin 0,0; unset label; unset logscale; set format '%g'; unset grid
	set border 31 front lw 1 lc rgb '#404040'
	set lmargin 9; set rmargin 14; set bmargin 4
	unset title; eval heading
	set xlabel 'w h  [rad],  w = √((k1 + k2)/m)' font ',11' offset 0,0
	set ylabel 'coupling  k2 / k1' font ',11' offset 0.5,0
	set xtics ('0.01' -2, '0.1' -1, '1' 0, '10' 1) font ',10' out nomirror
	set ytics ('0.001' -3, '0.01' -2, '0.1' -1, '1' 0, '10' 1) font ',10' out nomirror
	set colorbox vertical user origin 0.88,0.17 size 0.025,0.72
	eval ticks
	set cbtics font ',9'
	unset cblabel
	plot cells(folder.'/pl_map.csv', 'pl', '-v ylog=1') using 1:2:3 with image, \
		ends using (strcol(1) eq 'pl' ? log10($2) : NaN):(log10($3)) skip 1 with points pt 7 ps 0.3 lc rgb \
		'black', \
		for [p in "0.1 10 100 1000"] '+' using 1:(coupling($1, p + 0)) with lines dt 2 lw 2 lc rgb 'black'
	unset output
}
