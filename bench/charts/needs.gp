# SPDX-License-Identifier: GPL-3.0-or-later
# gnuplot -c bench/charts/needs.gp FOLDER OUTDIR: FOLDER has needs.csv
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2
size = '1100,760'
load here.'/style.gp'
name = 'needs'
csv = folder.'/needs.csv'
unset bmargin
array scene = ['beam', 'building', 'drivetrain', 'quarter_car', 'pendulum']
array titles = ['Beam of 15 masses, its tip', 'Building of 12 storeys, any record', 'Drivetrain of 6 inertias', \
	'Quarter car over a step of the road', 'Pendulum: measured']
# rows of a scene: cost, error over need; those of a type, or the one that is taken
rows(s, real, taken) = "< awk -F, '$1 == \"".s."\" && (\"".real."\" == \"\" || $3 == \"".real."\") && (\"".taken. \
	"\" == \"\" || $14 == \"".taken."\") { print $11 \",\" $12 }' '".csv."'"

do for [form=1:forms] {
	eval begin(form)
	set multiplot
	do for [panel=1:5] {
		unset label; set key off; unset arrow
		set origin ((panel - 1) % 3)/3.0, panel > 3 ? 0.0 : 0.46; set size 1/3.0, 0.46
		set lmargin 8; set rmargin 2; set tmargin 2.5; set bmargin 3.5
		set logscale xy; set format x '%g'; set format y '10^{%T}'
		set title titles[panel] font ',12' offset 0,-0.5
		set xlabel 'operations in a '.(panel == 5 ? 'second' : 'step').', of double twice' offset 0,0.3
		set ylabel (panel % 3 == 1 ? 'error over what is needed' : '') offset 1,0
		set xrange [*:*]; set yrange [*:*]; set xtics auto; set ytics auto
		if (panel == 1) { eval found_label }
		set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead lw 1.6 dt 2 lc rgb '#404040'
		plot rows(scene[panel], 'float', '') using 1:2 with points pt 6 ps 0.9 lw 1.5 lc rgb '#1f6fb4', \
			rows(scene[panel], 'double', '') using 1:2 with points pt 4 ps 0.9 lw 1.5 lc rgb '#b4531f', \
			rows(scene[panel], '', 'true') using 1:2 with points pt 7 ps 1.7 lc rgb '#2a8a3a'
	}
	unset label; unset arrow; unset border; unset xtics; unset ytics; unset xlabel; unset ylabel; unset logscale
	unset grid; unset title
	set origin 2/3.0,0; set size 1/3.0,0.46
	set key at graph 0.5,0.6 center vertical Left reverse samplen 2 spacing 1.4 font ',12' textcolor rgb '#202020'
	set xrange [0:1]; set yrange [0:1]
	plot NaN with points pt 6 ps 0.9 lw 1.5 lc rgb '#1f6fb4' title 'float', \
		NaN with points pt 4 ps 0.9 lw 1.5 lc rgb '#b4531f' title 'double', \
		NaN with points pt 7 ps 1.7 lc rgb '#2a8a3a' title 'the choice', \
		NaN with lines lw 1.6 dt 2 lc rgb '#404040' title 'the need'
	unset multiplot
	unset output
	set border 31 lw 1 lc rgb '#404040'; set grid xtics ytics lc rgb '#dcdcdc' lw 1 dt 1; set xtics nomirror
	set ytics nomirror
}
