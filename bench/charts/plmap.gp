# SPDX-License-Identifier: GPL-3.0-or-later
# plmap.csv
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = 0
size = '900,720'
load here.'/style.gp'
csv = folder.'/plmap.csv'
unset logscale
unset key
set format '%g'
set grid noxtics noytics

# log10 of w h, of k2/k1, and of the ratio; a blank line between rows of the map
block(layout, periods) = "< awk -F, -v layout='".layout."' -v periods=".periods." '".\
	"$1 == layout && $2 == periods { n = split($6, r, \" \"); print \"\"; ".\
	"for (i = 1; i <= n; i++) print (log($4) + (i - 1)*log($5))/log(10), log($3)/log(10), ".\
	"r[i] == \"-\" ? \"NaN\" : r[i] }' '".csv."'"

# Where the ratio is 1, and where it is 100 and 1/100
set datafile separator whitespace
contour(name, layout, periods) = "set table ".name."; set contour base; set cntrparam levels discrete -2, 0, 2; ".\
	"unset surface; splot block('".layout."', ".periods.") using 1:2:3; unset table; unset contour; set surface"
eval contour('$c1', 'k3 = k1', 6)
eval contour('$c2', 'k3 = k1', 60)
eval contour('$c3', 'k3 = k1/2', 6)
eval contour('$c4', 'k3 = k1/2', 60)

# light where pl is better, dark where RK4 is: also in black and white
set palette defined (-4 '#2166ac', -2 '#92c5de', 0 '#ffffff', 2 '#f4a582', 4 '#b2182b')
set cbrange [-4:4]
set xrange [-2:0.5]
set yrange [-4:1]
set xtics ('0.01' -2, '0.03' -1.523, '0.1' -1, '0.3' -0.523, '1' 0, '3' 0.477)
set ytics ('10^{-4}' -4, '10^{-3}' -3, '10^{-2}' -2, '0.1' -1, '1' 0, '10' 1)
set cbtics ('10^{-4}' -4, '10^{-2}' -2, '1' 0, '10^{2}' 2, '10^{4}' 4)

title(layout, periods) = layout." (".(layout eq 'k3 = k1' ? "equal walls" : \
	"unequal walls").'), until '.periods.' periods'
panel(contours, layout, periods) = "set title title('".layout."', ".periods.") offset 0,-0.8 font ',11'; ".\
	"plot block('".layout."', ".periods.") using 1:2:3 with image, ".\
	contours." index 2 using 1:2 with lines lw 1 dt 2 lc rgb 'black', ".contours." index 0 using 1:2 with lines ".\
	"lw 1 dt 2 lc rgb 'black', ".\
	contours." index 1 using 1:2 with lines lw 3 lc rgb 'black', ".\
	"$marks using 1:(strcol(3) eq '".layout."' ? $2 : 1/0):5 with points pt 7 ps 1 lc rgb variable, ".\
	"$marks using 1:(strcol(3) eq '".layout."' ? $2 : 1/0):4:5 with labels left offset 0.7,0 noenhanced font ".\
	"',10' textcolor rgb variable"
draw = "set multiplot; eval found_label; ".\
	"set lmargin screen 0.075; set rmargin screen 0.44; set tmargin screen 0.885; set bmargin screen 0.555; ".\
	"unset colorbox; set xlabel ''; set ylabel 'coupling k_2/k_1 [1]'; eval panel('$c1', 'k3 = k1', 6); ".\
	"unset label 99; ".\
	"set lmargin screen 0.50; set rmargin screen 0.865; set ylabel ''; ".\
	"set colorbox user origin 0.89,0.14 size 0.02,0.74; ".\
	"set cblabel 'largest displacement error, pl over RK4 [1]'; eval panel('$c3', 'k3 = k1/2', 6); ".\
	"unset colorbox; set lmargin screen 0.075; set rmargin screen 0.44; set tmargin screen 0.455; ".\
	"set bmargin screen 0.13; set xlabel 'w h [rad], w = (k_1/m)^{1/2}' offset 0,0.5; ".\
	"set ylabel 'coupling k_2/k_1 [1]'; eval panel('$c2', 'k3 = k1', 60); ".\
	"set lmargin screen 0.50; set rmargin screen 0.865; set ylabel ''; ".\
	"set label 1 legend at screen 0.01,0.025 left font ',9' textcolor rgb '#505050'; ".\
	"eval panel('$c4', 'k3 = k1/2', 60); unset label 1; ".\
	"unset multiplot"
$marks << EOD
-1 0 "k3 = k1" "scs" 0xfffffe
-0.199 -2 "k3 = k1/2" "scs_weak" 0x000001
EOD
set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb '#b0b0b0' fillstyle solid noborder
legend = 'thick line: equal; dashed: 100 times apart; grey: both off by more than half the initial displacement; '.\
	'dots: models at h = 0.01 s'
set label 2 at graph 0.03,0.93 left 'RK4 more accurate' font ',10' textcolor rgb '#fffffe' front
set label 3 at graph 0.97,0.06 right 'pl more accurate' font ',10' textcolor rgb '#000001' front
name = 'plmap'
do for [form = 1:forms] {
	eval begin(form)
	eval draw
	unset output
}
