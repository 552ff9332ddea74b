# SPDX-License-Identifier: GPL-3.0-or-later
# gnuplot -c bench/charts/less.gp FOLDER OUTDIR: FOLDER has less.csv
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2
load here.'/style.gp'
name = 'less'
csv = folder.'/less.csv'
unset bmargin
size = '1100,580'
array scene = ['beam', 'building', 'drivetrain']
array titles = ['Beam of 10 elements, hit at its tip', 'Building of 12 storeys, earthquake', \
	'Drivetrain of 6 inertias, engine']
line_of(s) = real(system("awk -F, '$1 == \"".s."\" { print $NF; exit }' '".csv."'"))
word_of(s) = system("awk -F, '$1 == \"".s."\" { print $(NF - 1); exit }' '".csv."'")

do for [form=1:2] {
	eval (form == 1 ? "set terminal svg size 1100,580 dynamic enhanced font 'DejaVu ".\
		"Sans,Helvetica,sans-serif,12' background rgb 'white'" : \
		"set terminal pngcairo size 1100,580 enhanced font 'DejaVu Sans,10' background rgb 'white'")
	set output out.'/less.'.(form == 1 ? 'svg' : 'png')
	set multiplot
	do for [side=1:3] {
		unset label; set key off; unset arrow
		set origin (side - 1)/3.0, 0.17; set size 1/3.0, 0.76
		set lmargin 8; set rmargin 2; set tmargin 3; set bmargin 4
		set logscale y; unset logscale x; set format x '%g'; set format y '10^{%T}'
		set title titles[side] font ',12' offset 0,-0.5
		set xlabel 'multiplications in a step' offset 0,0.3
		set ylabel (side == 1 ? 'error of the output over its largest value' : '') offset 1,0
		set xrange [0:(side == 1 ? 165 : side == 2 ? 105 : 45)]; set xtics auto
		set yrange [1e-9:1]; set ytics 1e-9,10,1
		if (side == 1) { eval found_label }
		set arrow 1 from graph 0, first line_of(scene[side]) to graph 1, first line_of(scene[side]) nohead \
			lw 1.6 dt 2 lc rgb '#404040'
		set label 2 'off anyway: '.word_of(scene[side]) at graph 0.97, first \
			1.5*line_of(scene[side]) right font ',9.5' textcolor rgb '#404040'
		load series(csv, '-v by=model -v x=multiplications -v y=error_over_peak -v where=scene='.scene[side])
		eval 'plot '.clauses
	}
	unset label; unset arrow; unset border; unset xtics; unset ytics; unset xlabel; unset ylabel; unset logscale
	unset grid; unset title
	set origin 0,0; set size 1,0.2
	set lmargin 2; set rmargin 2; set tmargin 0; set bmargin 0
	set key at screen 0.5,0.09 center vertical Left reverse maxrows 2 width 2 samplen 4.5 spacing 1.25 font ',11'
	load series(csv, '-v by=model -v x=multiplications -v y=error_over_peak -v where=scene=beam')
	set xrange [10000:10001]; set yrange [1e6:1e7]          # nothing of the curves
	eval 'plot '.clauses
	unset multiplot
	unset output
	set border 31 lw 1 lc rgb '#404040'; set grid xtics ytics lc rgb '#dcdcdc' lw 1 dt 1; set xtics nomirror
	set ytics nomirror
}
