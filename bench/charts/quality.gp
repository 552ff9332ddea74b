# SPDX-License-Identifier: GPL-3.0-or-later
# quality.csv: quality and quality_small
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = 0
load here.'/style.gp'
csv = folder.'/quality.csv'
# Curves of 81 points, equally spaced on a log axis: a mark on some of them
marked(every, options) = series(csv, options)." | sed 's/ pt / pi ".every." pt /g'"
unset bmargin

# Two panels side by side, and between them nothing but their axes: the key stands below both
do for [which=1:2] {
	name = which == 1 ? 'quality' : 'quality_small'
	do for [form=1:forms] {
		eval begin(form)
		set multiplot
		do for [side=1:2] {
			unset label; set key off; unset arrow; unset xzeroaxis
			set origin 0.5*(side - 1), 0.19; set size 0.5, 0.73
			set lmargin 9; set rmargin 2; set tmargin 2; set bmargin 4
			set xlabel 'h / T, step over period' offset 0,0.3
			if (which == 1) {
				unset logscale; set format '%g'; set xrange [0:0.4]; set xtics 0,0.1,0.4;
				set ytics auto; set xzeroaxis lw 1.5 lc rgb '#404040'
				set yrange [(side == 1 ? -20 : -30):(side == 1 ? 40 : 30)]
				set ylabel (side == 1 ? 'period elongation  [%]' : \
					'amplitude decay in a period  [%], below 0: growth') offset 1,0
			} else {
				set logscale xy; set xrange [0.005:0.5];
				set xtics ('0.005' 0.005, '0.01' 0.01, '0.02' 0.02, '0.05' 0.05, '0.1' 0.1, '0.2' \
					0.2, '0.5' 0.5); set format y '10^{%T}'
				set yrange [1e-10:1e2]
				set ylabel (side == 1 ? 'size of the period elongation  [%]' : \
					'size of the amplitude''s change in a period  [%]') offset 1,0
			}
			if (side == 1) { eval found_label }
			load marked((which == 1 ? 4 : 9), '-v x=h_over_T -v y='.(which == 1 ? (side == 1 ? \
				'period_elongation_percent' : 'amplitude_decay_percent_per_period') : \
				(side == 1 ? 'elongation_size' : 'decay_size')).(which == 1 ? ' -v any=1' : \
				" -v skip='in phase'"))
			eval 'plot '.clauses
		}
		# the key alone
		unset label; unset border; unset xtics; unset ytics; unset xlabel; unset ylabel; unset logscale;
		unset grid; unset xzeroaxis
		set origin 0,0; set size 1,0.22
		set lmargin 2; set rmargin 2; set tmargin 0; set bmargin 0
		set key at screen 0.5,0.125 center vertical Left reverse maxrows 4 width -2 samplen 4.5 spacing 1.25 \
			font ',11'
		load marked(9, '-v x=h_over_T -v y=period_elongation_percent -v any=1')
		set xrange [10:11]; set yrange [1e6:1e7]          # nothing of the curves
		eval 'plot '.clauses
		unset multiplot
		unset output
		set border lw 1 lc rgb '#404040'; set grid xtics ytics lc rgb '#dcdcdc' lw 1 dt 1; set xtics nomirror;
		set ytics nomirror
	}
}
