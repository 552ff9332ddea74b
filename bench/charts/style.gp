# SPDX-License-Identifier: GPL-3.0-or-later
# How every chart here looks. draw.sh runs each NAME.gp as
#     gnuplot -c bench/charts/NAME.gp FOLDER OUTDIR [narrow]
# FOLDER has the tables; narrow: for a screen of 400 pixels, with the legend below. A script begins with
#     here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = ARG3 eq 'narrow'
#     load here.'/style.gp'
# Then, for each picture: axes, and
#     name = '...'; eval heading          # what the picture found, from findings/NAME.awk
#     load series(csv, "-v where='model=scs' -v x=ns_median -v y=largest")
#     eval "plot ".clauses
#     eval write                          # OUTDIR/name.svg and OUTDIR/name.png; narrow: OUTDIR/name_narrow.svg
# clauses: one for each method in the CSV, with colours and marks by series.awk. Colours of text and axes are those that
# draw.sh turns light in dark style; what stands on a filled area is '#000001', which it leaves.

set datafile separator ','
set encoding utf8

series(file, options) = "< awk -v palette='".here."/palette.list' -f '".here."/csv.awk' -f '".here."/series.awk' ".\
	options." '".file."'"

if (!exists('narrow')) narrow = 0
if (!exists('size')) size = narrow ? '400,560' : '900,560'         # pixels; a script may set it before
eval "set terminal svg size ".size              # until it is written: into nothing
set output '/dev/null'
font = narrow ? "12" : "13"
svg = "set terminal svg size ".size." dynamic enhanced font 'DejaVu Sans,Helvetica,sans-serif,".font."' background ".\
	"rgb 'white'; set output out.'/'.name.(narrow ? '_narrow' : '').'.svg'"
png = "set terminal pngcairo size ".size." enhanced font 'DejaVu Sans,11' background rgb 'white'; set output ".\
	"out.'/'.name.'.png'"
# Of several panels: do for [form=1:forms] { eval begin(form); set multiplot; ...; unset multiplot; unset output }
forms = narrow ? 1 : 2
begin(form) = form == 1 ? svg : png
write = svg."; replot; unset output; ".(narrow ? '' : png."; replot; unset output; ")."set output '/dev/null'"

set border lw 1 lc rgb '#404040'
set grid xtics ytics lc rgb '#dcdcdc' lw 1 dt 1
set tics nomirror textcolor rgb '#202020'
set xlabel textcolor rgb '#202020'
set ylabel textcolor rgb '#202020'
if (narrow) { set xlabel offset 0,0.7; set xtics offset 0,0.2 }
if (narrow) set key outside center bottom vertical Left reverse maxrows 5 samplen 2.5 spacing 1.15 width -1 height 0.7 \
	font ',10' textcolor rgb '#202020'; else set key outside right top vertical Left reverse samplen 3.5 \
	spacing 1.25 width 1 font ',11' textcolor rgb '#202020'
set format x '10^{%T}'
set format y '10^{%T}'
set logscale xy

# What was found, over the whole width; lines of as many letters as the picture holds
letters(pixels) = substr(pixels, 1, strstrt(pixels, ',') - 1)/(narrow ? 6.7 : 7.7)
finding(name, pixels) = system(sprintf("sh '%s/finding.sh' '%s' '%s' %d", here, name, folder, letters(pixels)))
lines_of(text) = strstrt(text, "\n") > 0 ? 1 + lines_of(substr(text, strstrt(text, "\n") + 1, strlen(text))) : 1
found_label = "found = finding(name, size); set label 99 found at screen 0.012,screen 0.999 offset 0,-0.75 left ".\
	"noenhanced font ',".(narrow ? 12 : 14)."' textcolor rgb '#202020'"
heading = found_label."; set tmargin 1.2 + 1.15*lines_of(found)"
