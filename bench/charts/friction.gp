# SPDX-License-Identifier: GPL-3.0-or-later
# friction.csv, friction_times.csv: a mass that sticks and slips, error over the time of a simulated second
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = 0
load here.'/style.gp'
csv = folder.'/friction_times.csv'
name = 'friction'; eval heading
set xlabel 'time of a simulated second  [ns]'
set ylabel 'largest error of x over its largest value'
set yrange [1e-15:1]; set ytics 1e-15,1000,1
load series(csv, "-v x=ns_min -v y=largest")
eval 'plot '.clauses
eval write
