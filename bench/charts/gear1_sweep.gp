# SPDX-License-Identifier: GPL-3.0-or-later
# gear1_sweep.csv, of bench/sweep.sh: half the range of the motion over the frequency, up and then down
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = ARG3 eq 'narrow'
load here.'/style.gp'
csv = folder.'/gear1_sweep.csv'
set datafile separator whitespace
unset logscale
set format '%g'
set xlabel 'frequency of the force, eta [rad/s]'
set ylabel 'half the range of q [1]'
set offsets graph 0, graph 0, graph 0.05, graph 0
set key inside top right vertical Left reverse font ',11'
name = 'gear1_sweep'
eval heading
plot csv index 0 using 1:2 with linespoints pt 8 lw 1.6 lc rgb '#be3028' title 'up', \
	'' index 1 using 1:2 with linespoints pt 11 lw 1.6 lc rgb '#1f6fe0' title 'down'
eval write
