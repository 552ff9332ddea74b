# SPDX-License-Identifier: GPL-3.0-or-later
# gnuplot -c own.gp NAME.csv OUTDIR NAME EVERY UNITS VERDICT.txt SIGNAL: the picture of any spec
here = system("dirname '".ARG0."'").'/..'; csv = ARG1; out = ARG2; name = ARG3; narrow = 0
load here.'/style.gp'
size = '1240,660'
plain(m) = system("echo '".m."' | sed 's/_/\\\\_/g'")
factors = system("sed -n 's/^title: //p' '".ARG6."'")
set title plain(name).": how many times as fast plgen is as the best peer, where the error is below\n".\
	'{/*0.9 '.factors.'}'
set label 1 sprintf('%s outputs, one every %s s; errors over the largest coordinate or velocity; -O2 for all.  %s', \
	ARG5, ARG4, ARG7) at screen 0.01,0.02 left font ',8.5' textcolor rgb '#505050'
set bmargin 5
set xlabel 'CPU time per output  [µs]'
set ylabel 'largest error at outputs'
set yrange [1e-17:10]
load series(csv, '-v x=ns_min -v y=largest -v xfactor=1e-3')
eval 'plot '.clauses
eval write
