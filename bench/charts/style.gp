# SPDX-License-Identifier: GPL-3.0-or-later
# How every chart here looks. A script NAME.gp is run as
#     gnuplot -c bench/charts/NAME.gp NAME.csv OUTDIR
# and begins with
#     here = system("dirname '".ARG0."'"); csv = ARG1; out = ARG2
#     load here.'/style.gp'
# Then, for each picture: titles, axes, `name = '...'`, and
#     load series(csv, "-v where='model=scs' -v x=ns_median -v y=largest")
#     eval "plot ".clauses
#     eval write                          # OUTDIR/name.svg and OUTDIR/name.png
# clauses: one for each method in the CSV, each with the mark, colour and dash it has in all charts (series.awk).

set datafile separator ','
set encoding utf8

series(file, options) = "< awk -f '".here."/csv.awk' -f '".here."/series.awk' ".options." '".file."'"

if (!exists('size')) size = '900,600'           # pixels; a script may set it before
eval "set terminal svg size ".size              # until it is written: into nothing
set output '/dev/null'
svg = "set terminal svg size ".size." dynamic enhanced font 'DejaVu Sans,Helvetica,sans-serif,13' background rgb ".\
	"'white'; set output out.'/'.name.'.svg'; replot; unset output;"
png = "set terminal pngcairo size ".size." enhanced font 'DejaVu Sans,11' background rgb 'white'; set output ".\
	"out.'/'.name.'.png'; replot; unset output;"
write = svg.png."set output '/dev/null'"

set border lw 1 lc rgb '#404040'
set grid xtics ytics lc rgb '#dcdcdc' lw 1 dt 1
set tics nomirror
set key outside right top vertical Left reverse samplen 3.5 spacing 1.15 width 1 font ',10'
set format x '10^{%T}'
set format y '10^{%T}'
set logscale xy
set title font ',13'
# Under the picture, small: what was chosen, and how it was measured
note = "set label 1 at screen 0.01,0.025 left font ',9' textcolor rgb '#505050'"
set bmargin 5.5
