# SPDX-License-Identifier: GPL-3.0-or-later
# Draws what demo.sh computed; `out` is the folder.
set terminal svg size 900,450 font 'sans-serif,13' background rgb 'white'
set datafile separator ','
set grid lc rgb '#dddddd'
set border 3 lc rgb '#444444'
set tics nomirror

set output out.'/displacement.svg'
set title 'sdcsf: two damped masses, the first driven by cos(5 t)'
set xlabel 'time [s]'
set ylabel 'displacement [mm]'
set key outside top right horizontal
plot out.'/sdcsf.csv' skip 1 using 1:(1000*$2) with lines lw 1.5 lc rgb '#0b5fa5' title 'x1', \
     ''               skip 1 using 1:(1000*$3) with lines lw 1.5 dt 2 lc rgb '#c4501b' title 'x2'

set output out.'/poles.svg'
set terminal svg size 560,560 font 'sans-serif,13' background rgb 'white'
set datafile separator whitespace
set title 'sdcsf: poles in the s-plane'
set xlabel 'Re s [1/s]'
set ylabel 'Im s [rad/s]'
set xrange [-1:0.25]
set yrange [-20:20]
set xzeroaxis lc rgb '#888888'
set yzeroaxis lc rgb '#888888'
set key off
plot out.'/poles.dat' using 1:2 with points pt 2 ps 1.6 lw 2 lc rgb '#0b5fa5'
