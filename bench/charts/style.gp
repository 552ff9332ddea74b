# SPDX-License-Identifier: GPL-3.0-or-later
# How every chart here looks. What loads it (picture.sh, own/own.gp) says where this file lies, here; where the tables
# are, folder; where pictures go, out; and narrow: for a screen of 400 pixels, with the legend below. Then, for each
# picture: size, axes, and
#     name = '...'; eval heading          # what the picture found, from findings.txt
#     load series(csv, "-v where='model=scs' -v x=ns_median -v y=largest")
#     eval "plot ".clauses
#     eval write                          # OUTDIR/name.svg and OUTDIR/name.png; narrow: OUTDIR/name_narrow.svg
# clauses: one for each method in the CSV, with colours and marks by drawn.txt. Colours of text and axes are those that
# draw.sh turns light in dark style; what stands on a filled area is '#000001', which it leaves.

set datafile separator ','
set encoding utf8

made(section, options, file) = "< sh '".here."/table.sh' ".section." -v palette='".here."/palette.list' ".options.\
	" '".file."'"
series(file, options) = made('series', options, file)
# A mark on some points of a curve
marked(every, options) = series(csv, options)." | sed 's/ pt / pi ".every." pt /g'"
# What the first column has, each once, where it has no blanks
first_words(file) = system("awk -F, 'NR > 1 && $1 != \"\" && !seen[$1]++ { printf \"%s \", $1 }' '".file."'")

size = narrow ? '400,560' : '900,560'           # pixels; a picture may have another
eval "set terminal svg size ".size              # until it is written: into nothing
set output '/dev/null'
font = narrow ? "12" : "13"
png_font = '11'
# Of several panels: do for [form=1:forms] { eval begin(form); set multiplot; ...; eval end }
forms = narrow ? 1 : 2
begin(form) = form == 1 ? "set terminal svg size ".size." dynamic enhanced font 'DejaVu Sans,Helvetica,sans-serif,".\
	font."' background rgb 'white'; set output out.'/'.name.(narrow ? '_narrow' : '').'.svg'" : \
	"set terminal pngcairo size ".size." enhanced font 'DejaVu Sans,".png_font."' background rgb 'white'; set ".\
	"output out.'/'.name.'.png'"
end = "unset multiplot; unset output"
write = "do for [form=1:forms] { eval begin(form); replot; unset output }; set output '/dev/null'"

look = "set border 31 lw 1 lc rgb '#404040'; set grid xtics ytics lc rgb '#dcdcdc' lw 1 dt 1"
eval look
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
# A panel for the key alone, and back
bare = "unset title; unset border; unset xtics; unset ytics; unset xlabel; unset ylabel; unset logscale; unset grid; ".\
	"unset label; unset arrow; unset xzeroaxis; set lmargin 2; set rmargin 2; set tmargin 0; set bmargin 0"
dressed = look."; set xtics nomirror; set ytics nomirror"
# The key below panels, of all that `load` then gives, whose curves lie elsewhere
key_below(high, y, rows, width) = bare.sprintf("; set origin 0,0; set size 1,%g; set key at screen 0.5,%g center ".\
	"vertical Left reverse maxrows %d width %d samplen 4.5 spacing 1.25 font ',11'", high, y, rows, width)
keyed = "set xrange [1e4:1.001e4]; set yrange [1e6:1e7]; eval 'plot '.clauses; eval end; eval dressed"

# What was found, over the whole width; lines of as many letters as the picture holds
letters(pixels) = substr(pixels, 1, strstrt(pixels, ',') - 1)/(narrow ? 6.7 : 7.7)
finding(name, pixels) = system(sprintf("sh '%s/finding.sh' '%s' '%s' %d", here, name, folder, letters(pixels)))
lines_of(text) = strstrt(text, "\n") > 0 ? 1 + lines_of(substr(text, strstrt(text, "\n") + 1, strlen(text))) : 1
found_label = "found = finding(name, size); set label 99 found at screen 0.012,screen 0.999 offset 0,-0.75 left ".\
	"noenhanced font ',".(narrow ? 12 : 14)."' textcolor rgb '#202020'"
heading = found_label."; set tmargin 1.2 + 1.15*lines_of(found)"

# Maps: classes of growth in eleven colours, blue below and orange to red above, neutral in grey; x is log10. Between
# the classes stand the bounds by which draw.sh makes letters of growth.
cells(file, name, options) = made('cells', "-v name='".name."' ".options, file)
set palette defined (-0.5 '#08306b', 0.5 '#08306b', 0.5 '#2f79b5', 1.5 '#2f79b5', 1.5 '#73b2d8', 2.5 '#73b2d8', \
	2.5 '#b2d4ea', 3.5 '#b2d4ea', 3.5 '#e2eff8', 4.5 '#e2eff8', 4.5 '#c8c8c8', 5.5 '#c8c8c8', 5.5 '#fff0c0', \
	6.5 '#fff0c0', 6.5 '#fdc070', 7.5 '#fdc070', 7.5 '#f08030', 8.5 '#f08030', 8.5 '#c83c14', 9.5 '#c83c14', \
	9.5 '#7a0c00', 10.5 '#7a0c00')
set cbrange [-0.5:10.5]
panels = "set key off; unset logscale; set format '%g'; unset grid; unset colorbox; unset label; set border 31 front ".\
	"lw 1 lc rgb '#404040'; ".\
	"set lmargin 6.3; set rmargin 1; set tmargin 1.6; set bmargin 2.8; set title font ',10' offset 0,-0.5; ".\
	"set xtics font ',9' out nomirror; set ytics font ',9' out nomirror; set ylabel font ',9' offset 1.6,0; ".\
	"set xlabel font ',9' offset 0,0.9"
legend_only = "unset title; unset border; unset xtics; unset ytics; unset xlabel; unset ylabel; unset label; set ".\
	"cbtics font ',9' textcolor rgb '#202020'; set cblabel font ',10' offset 0,0.6 textcolor rgb '#202020'"
growth_ticks = "set cbtics ('-90 %%' 0.5, '-50 %%' 1.5, '-10 %%' 2.5, '-0.1 %%' 3.5, '±10^{-6}' 5, '0.1 %%' 6.5, ".\
	"'10 %%' 7.5, '×2' 8.5, '×11' 9.5)"
