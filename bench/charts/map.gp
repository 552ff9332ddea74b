# SPDX-License-Identifier: GPL-3.0-or-later
# How the maps look: classes of growth in eleven colours, blue below and orange to red above, neutral in grey; x is
# log10. Between the classes stand the bounds by which draw.sh makes letters of growth.
cells(file, name, options) = "< awk -F, -v name='".name."' ".options." -f '".here."/cells.awk' '".file."'"
set key off
set palette defined (-0.5 '#08306b', 0.5 '#08306b', 0.5 '#2f79b5', 1.5 '#2f79b5', 1.5 '#73b2d8', 2.5 '#73b2d8', 2.5 \
	'#b2d4ea', 3.5 '#b2d4ea', \
	3.5 '#e2eff8', 4.5 '#e2eff8', 4.5 '#c8c8c8', 5.5 '#c8c8c8', 5.5 '#fff0c0', 6.5 '#fff0c0', 6.5 '#fdc070', 7.5 \
	'#fdc070', \
	7.5 '#f08030', 8.5 '#f08030', 8.5 '#c83c14', 9.5 '#c83c14', 9.5 '#7a0c00', 10.5 '#7a0c00')
set cbrange [-0.5:10.5]
panels = "unset logscale; set format '%g'; unset grid; unset colorbox; unset label; set border 31 front lw 1 lc rgb ".\
	"'#404040'; \
	set lmargin 6.3; set rmargin 1; set tmargin 1.6; set bmargin 2.8; set title font ',10' offset 0,-0.5; \
	set xtics font ',9' out nomirror; set ytics font ',9' out nomirror; set ylabel font ',9' offset 1.6,0; set \
	xlabel font ',9' offset 0,0.9"
legend_only = "unset title; unset border; unset xtics; unset ytics; unset xlabel; unset ylabel; unset label; set ".\
	"cbtics font ',9' textcolor rgb '#202020'; set cblabel font ',10' offset 0,0.6 textcolor rgb '#202020'"
