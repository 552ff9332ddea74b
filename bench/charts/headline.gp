# SPDX-License-Identifier: GPL-3.0-or-later
# headline_integrators.csv, headline_equal_step.csv, headline_confluence.csv
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = ARG3 eq 'narrow'

# ---- each integrator at the setting that reaches an error ----
csv = folder.'/headline_integrators.csv'
count = int(system("awk -F'\"' '$3 ~ /,reached,/ && !seen[$2]++ { n++ } END { print n }' '".csv."'"))
size = sprintf('%d,%d', narrow ? 400 : 900, 150 + (narrow ? 70 : 0) + 25*count)
load here.'/style.gp'
load "< awk -v palette='".here."/palette.list' -f '".here."/csv.awk' -f '".here."/headline.awk' '".csv."'"
name = 'headline_integrators'
set xlabel 'CPU time per output [ns]'
unset logscale y
set format y '%s'
set yrange [rows + 1.4:0.4]
set xrange [1:1e5]
eval "set ytics (".tics.") font ',".(narrow ? 9 : 11)."' noenhanced"
set grid noytics
set lmargin (narrow ? 20 : 25)
if (!narrow) { set key inside top right }
eval heading
eval "plot ".clauses
eval write
unset label; unset lmargin

# ---- at equal step ----
csv = folder.'/headline_equal_step.csv'
load "< awk -v palette='".here."/palette.list' -f '".here."/csv.awk' -f '".here."/equal_step.awk' '".csv."'"
size = sprintf('%d,%d', narrow ? 400 : 900, 150 + 26*rows)
name = 'headline_equal_step'
found = finding(name, size)
top = 1 - (34.0 + 17*lines_of(found))/(150 + 26*rows)
panels = narrow ? 2 : 3
first = narrow ? 0.43 : 0.265
wide = (1 - first)/panels
array axis = ['time of a step [ns]', 'largest error', 'drift of the energy']
load here.'/style.gp'
do for [form = 1:forms] {
	eval begin(form)
	set multiplot
	unset key
	unset logscale y
	set grid xtics ytics
	do for [k = 1:panels] {
		set lmargin screen first + wide*(k - 1)
		set rmargin screen first + wide*k - 0.025
		set tmargin screen top
		set bmargin screen 70.0/(150 + 26*rows)
		unset label
		set yrange [rows + 0.6:0.4]
		set xlabel axis[k] font ',11'
		if (k == 1) {
			eval found_label
			eval "set ytics (".tics.") font ',".(narrow ? 9 : 11)."' noenhanced"
			unset logscale x; set format x '%g'
			set xrange [0:*]; set xtics autofreq font ',10'
			if (narrow) { set xtics 0,10 }
		} else {
			eval "set ytics (".blank.")"
			set logscale x; set format x '10^{%T}'
			set xrange [(k == 2 ? 1e-16 : 1e-15):(k == 2 ? 1e-3 : 1)]
			set xtics 1e-14,(narrow ? 1e6 : 1e4),1 font ',10'
		}
		eval 'plot '.panel(k)
	}
	unset multiplot
	unset output
}
reset

# ---- where frequencies nearly meet ----
csv = folder.'/headline_confluence.csv'
size = narrow ? '400,560' : '900,560'
load here.'/style.gp'
set xlabel 'relative gap between the two frequencies'
set ylabel 'largest error over 100 s, relative'
set xrange [3e-4:3e-13] reverse
set yrange [1e-17:10]
set xtics ('10^{-4}' 1e-4, '10^{-6}' 1e-6, '10^{-8}' 1e-8, '10^{-10}' 1e-10, '0' 1e-12)
name = 'headline_confluence'
eval heading
load series(csv, "-v where=case=one-way -v x=gap -v y=error -v xzero=1e-12 -v most=10 -v rank=last -v keep=modal")
eval "plot ".clauses
eval write
