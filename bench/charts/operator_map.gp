# SPDX-License-Identifier: GPL-3.0-or-later
# gnuplot -c bench/charts/operator_map.gp FOLDER OUTDIR: FOLDER has operator_map.csv, pl_map.csv and
# operator_boundary.csv
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2
load here.'/style.gp'
load here.'/map.gp'
ends = folder.'/operator_boundary.csv'
array names = ['etd1', 'etdrk2', 'etdrk4', 'nc2', 'nc3', 'dq4', 'bm3']
bounds = '-0.9 -0.5 -0.1 -0.001 -1e-6 1e-6 0.001 0.1 1 10'
ticks = "set cbtics ('-90 %%' 0.5, '-50 %%' 1.5, '-10 %%' 2.5, '-0.1 %%' 3.5, '±10^{-6}' 5, '0.1 %%' 6.5, '10 %%' ".\
	"7.5, '×2' 8.5, '×11' 9.5)"
unset logscale
set xrange [-2:1.5]
set yrange [-1:1]

do for [form=1:2] {
	eval (form == 1 ? svg_of_map : png_of_map)
	set output out.'/operator_map.'.(form == 1 ? 'svg' : 'png')
	set multiplot
	eval panels
	do for [k=1:7] {
		unset label
		if (k == 1) { set label 1 "Schemes with a leftover: x'' + w^2 x = 0 under an operator that is exact ".\
			"for another frequency wA" at screen 0.5,0.975 center font ',12' }
		set origin 0.003 + 0.248*((k - 1) % 4), 0.50 - 0.46*((k - 1)/4)
		set size 0.248, 0.45
		set title names[k]
		set ylabel (k % 4 == 1 ? 'wA / w' : '')
		set xlabel (k > 3 ? 'w h  [rad]' : '')
		set xtics ('0.01' -2, '0.1' -1, '1' 0, '10' 1)
		set ytics ('0.1' -1, '0.2' log10(0.2), '0.5' log10(0.5), '1' 0, '2' log10(2), '5' log10(5), '10' 1)
		plot cells(folder.'/operator_map.csv', names[k], "-v x=wh -v y=ratio -v ylog=1 -v value=growth") \
			using 1:3:1:2:3:4:5 with boxxyerror lc palette, \
			ends using (strcol(1) eq names[k] ? log10($2) : NaN):(log10($3)) skip 1 with points pt 7 ps \
			0.22 lc rgb 'black'
	}
	set origin 0.75, 0.0; set size 0.25, 0.45
	eval legend_only
	set label 11 "Colour: the amplitude's change" at screen 0.752,0.425 font ',8.5'
	set label 12 'within one true period 2π/w' at screen 0.752,0.400 font ',8.5'
	set label 13 'dots: from damped to growing or back' at screen 0.752,0.375 font ',8.5'
	set label 14 'wA/w = 1: nothing is left over, exact' at screen 0.752,0.350 font ',8.5'
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
do for [form=1:2] {
	eval (form == 1 ? "set terminal svg size 900,600 dynamic enhanced font 'DejaVu ".\
		"Sans,Helvetica,sans-serif,13' background rgb 'white'" : \
		"set terminal pngcairo size 900,600 enhanced font 'DejaVu Sans,11' background rgb 'white'")
	set output out.'/pl_map.'.(form == 1 ? 'svg' : 'png')
	set size 1,1; set origin 0,0; unset label; unset logscale; set format '%g'; unset grid
	set border 31 front lw 1 lc rgb '#404040'
	set lmargin 9; set rmargin 14; set tmargin 3.5; set bmargin 7
	set title "scheme pl, two equal undamped masses: own (k1 + k2) x exact, k2 x of the other one held" font \
		',12' offset 0,0
	set xlabel 'w h  [rad],  w = √((k1 + k2)/m)' font ',11' offset 0,0
	set ylabel 'coupling  k2 / k1' font ',11' offset 0.5,0
	set xtics ('0.01' -2, '0.1' -1, '1' 0, '10' 1) font ',10' out nomirror
	set ytics ('0.001' -3, '0.01' -2, '0.1' -1, '1' 0, '10' 1) font ',10' out nomirror
	set colorbox vertical user origin 0.88,0.17 size 0.025,0.72
	eval ticks
	set cbtics font ',9'
	unset cblabel
	set label 21 "colour: change of the amplitude within one period 2π/w; it grows at every step and coupling" at \
		screen 0.03,0.055 font ',9'
	set label 22 "dashed: growth by the modified equation, κh/4 per second, κ = k2/m, at 0.1 %, 10 %, ×2 and ".\
		"×11 a period" at screen 0.03,0.025 font ',9'
	plot cells(folder.'/pl_map.csv', 'pl', "-v x=wh -v y=coupling -v ylog=1 -v value=growth") using 1:3:1:2:3:4:5 \
		with boxxyerror lc palette, \
		ends using (strcol(1) eq 'pl' ? log10($2) : NaN):(log10($3)) skip 1 with points pt 7 ps 0.3 lc rgb \
		'black', \
		for [p in "0.1 10 100 1000"] '+' using 1:(coupling($1, p + 0)) with lines dt 2 lw 2 lc rgb 'black'
	unset output
}
