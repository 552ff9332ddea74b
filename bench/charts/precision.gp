# SPDX-License-Identifier: GPL-3.0-or-later
# For each model in precision.csv its error against time; on narrow screens without what is grey
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = ARG3 eq 'narrow'
load here.'/style.gp'
csv = folder.'/precision.csv'
models = system("awk -F, 'NR > 1 && !($1 in seen) { seen[$1] = 1; printf \"%s \", $1 }' '".csv."'")
set ylabel 'largest error over the history, relative'
set yrange [1e-16:10]
set ytics 1e-16,100,10
set mytics 2
set xlabel "CPU time per output [µs], median"
do for [m in models] {
	name = 'precision_'.m
	eval heading
	load series(csv, sprintf("-v 'where=model=%s' -v x=ns_median -v y=largest -v xfactor=1e-3 -v most=10 %s", \
		m, narrow ? '-v rest=no' : ''))
	eval "plot ".clauses
	eval write
}
