# SPDX-License-Identifier: GPL-3.0-or-later
# energy.csv: the largest change met so far, over steps
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = ARG3 eq 'narrow'
load here.'/style.gp'
csv = folder.'/energy.csv'
set xlabel 'steps taken'
set xrange [1:*]
set xtics 1,100,1e9

array names = ['energy_double', 'energy_float', 'energy_float_short', 'momentum_double']
array rows = ['case=undamped;real=double;step_s=0.01', 'case=undamped;real=float;step_s=0.01', \
	'case=undamped;real=float;step_s=0.0001', 'case=moving;real=double']
do for [k = 1:4] {
	name = names[k]
	set ylabel sprintf('largest change of %s so far, relative', k == 4 ? 'momentum' : 'energy')
	if (k == 1 || k == 4) { set yrange [1e-17:10]; set ytics 1e-16,100,10 } else {
		set yrange [1e-9:10]; set ytics 1e-9,10,10 }
	eval heading
	load series(csv, sprintf("-v 'where=%s' -v x=steps -v y=largest -v most=10 -v rank=last", rows[k])).\
		" | sed 's/ pt / pi 4 pt /g'"
	eval "plot ".clauses
	eval write
}
