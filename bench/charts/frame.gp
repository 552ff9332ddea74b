# SPDX-License-Identifier: GPL-3.0-or-later
# gnuplot -c bench/charts/frame.gp FOLDER OUTDIR: FOLDER has frame.csv and frame_history.csv
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2
size = '1100,560'
load here.'/style.gp'
name = 'frame'
csv = folder.'/frame.csv'
unset bmargin
do for [form=1:2] {
	eval (form == 1 ? "set terminal svg size 1100,560 dynamic enhanced font 'DejaVu ".\
		"Sans,Helvetica,sans-serif,12' background rgb 'white'" : \
		"set terminal pngcairo size 1100,560 enhanced font 'DejaVu Sans,10' background rgb 'white'")
	set output out.'/frame.'.(form == 1 ? 'svg' : 'png')
	set multiplot
	set bmargin 5; set tmargin 4.5
	unset logscale; set format '%g'
	set origin 0,0; set size 0.45,1; set lmargin 8; set rmargin 2
	eval found_label
	set title 'The roof from 8 to 12 s, h = 0.02 s' font ',12'
	set xlabel 't  [s]'; set ylabel 'displacement of the roof  [mm]' offset 1,0
	set xrange [8:12]; set xtics 8,1,12; set autoscale y; set ytics auto
	set key inside bottom left horizontal samplen 3 font ',10'
	load series(folder.'/frame_history.csv', '-v any=1 -v with=lines -v x=t_s -v y=roof_mm')
	eval 'plot '.clauses
	unset label
	set origin 0.45,0; set size 0.55,1; set lmargin 9; set rmargin 22
	set title 'Largest error of 20 s' font ',12'
	set xlabel 'step h  [s]'; set ylabel 'error of the roof over its largest displacement' offset 1,0
	set logscale xy; set format y '10^{%T}'
	set xrange [0.004:0.025]; set xtics ('1/200' 0.005, '1/100' 0.01, '1/50' 0.02)
	set yrange [1e-16:1]; set ytics 1e-16,100,1
	set key outside right top vertical Left reverse samplen 3 spacing 1.15 font ',10'
	load series(csv, '-v x=h_s -v y=roof_error_over_peak')
	eval 'plot '.clauses
	unset multiplot
	unset output
}
