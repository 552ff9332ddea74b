# SPDX-License-Identifier: GPL-3.0-or-later
# gnuplot -c bench/charts/integrators.gp FOLDER OUTDIR: FOLDER has integrators.csv
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2
size = '1100,560'
load here.'/style.gp'
name = 'integrators'
csv = folder.'/integrators.csv'
marked(every, options) = series(csv, options)." | sed 's/ pt / pi ".every." pt /g'"
unset bmargin
array columns = ['spectral_radius', 'period_elongation_percent', 'amplitude_decay_percent_per_period']
array ordinates = ['spectral radius of a step', 'period elongation  [%]', 'amplitude decay in a period  [%]']

# Three panels side by side, the key below them
do for [form=1:2] {
	eval (form == 1 ? "set terminal svg size 1100,560 dynamic enhanced font 'DejaVu ".\
		"Sans,Helvetica,sans-serif,12' background rgb 'white'" : \
		"set terminal pngcairo size 1100,560 enhanced font 'DejaVu Sans,10' background rgb 'white'")
	set output out.'/integrators.'.(form == 1 ? 'svg' : 'png')
	set multiplot
	do for [side=1:3] {
		unset label; set key off
		set origin (side - 1)/3.0, 0.19; set size 1/3.0, 0.72
		set lmargin 8; set rmargin 2; set tmargin 1; set bmargin 4
		unset logscale; set format '%g'
		set xlabel 'h / T, step over period' offset 0,0.3
		set ylabel ordinates[side] offset 1,0
		if (side == 1) {
			set logscale x; set xrange [0.01:100]; set xtics ('0.01' 0.01, '0.1' 0.1, '1' 1, '10' 10, \
				'100' 100)
			set yrange [0:1.1]; set ytics 0,0.2,1
			eval found_label
		} else {
			set xrange [0:0.2]; set xtics 0,0.05,0.2; set ytics auto
			set yrange [(side == 2 ? -6 : -1):(side == 2 ? 20 : 12)]
		}
		load marked((side == 1 ? 16 : 6), '-v any=1 -v x=h_over_T -v y='.columns[side])
		eval 'plot '.clauses
	}
	unset label; unset border; unset xtics; unset ytics; unset xlabel; unset ylabel; unset logscale; unset grid
	set origin 0,0; set size 1,0.22
	set lmargin 2; set rmargin 2; set tmargin 0; set bmargin 0
	set key at screen 0.5,0.105 center vertical Left reverse maxrows 3 width 2 samplen 4.5 spacing 1.25 font ',11'
	load marked(9, '-v any=1 -v x=h_over_T -v y=spectral_radius')
	set xrange [1000:1001]; set yrange [1e6:1e7]          # nothing of the curves
	eval 'plot '.clauses
	unset multiplot
	unset output
	set border 31 lw 1 lc rgb '#404040'; set grid xtics ytics lc rgb '#dcdcdc' lw 1 dt 1; set xtics nomirror
	set ytics nomirror
}
