# SPDX-License-Identifier: GPL-3.0-or-later
# The pictures that are maps. As pictures.gp.

=== stability_map: stability_map.csv stability_boundary.csv
# A panel for each method of the table
ends = made('unfold', '-v lists=wh,zeta', folder.'/stability_boundary.csv')
methods = system("awk -F, 'NR > 1 && $1 != \"\" && !seen[$1]++ { print $1 }' '".csv."'")
count = lines_of(methods)
named(k) = system(sprintf("echo '%s' | sed -n %dp", methods, k))
lines = ceil((count + 2)/4.0)           # of panels, the last two places for the colours
high = 60 + 205*lines
size = sprintf('900,%d', high)
unset logscale
set xrange [-2:2]
set yrange [-0.016:1.5]         # the row of zeta = 0 is seen whole
do for [form=1:forms] {
	eval begin(form)
	set multiplot
	eval panels
	do for [k=1:count] {
		unset label
		if (k == 1) { eval found_label }
		line = (k - 1)/4
		method = named(k)
		set origin 0.003 + 0.248*((k - 1) % 4), 1 - (50.0 + 205*(line + 1))/high
		set size 0.248, 200.0/high
		set title method noenhanced textcolor rgb '#202020'
		set ylabel (k % 4 == 1 ? 'damping ratio ζ' : '')
		set xlabel (k > count - 4 ? 'w h  [rad]' : '')
		set xtics ('0.01' -2, '0.1' -1, '1' 0, '10' 1, '100' 2)
		set ytics 0,0.5,1.5
		plot cells(csv, method, '') using 1:2:3 with image, \
			for [b=1:4] ends using (strcol(1) eq method && $2 == b ? log10($3) : NaN):4 skip 1 with \
			lines lw 2.6 lc rgb 'black'
	}
	set origin 0.51, 0.0; set size 0.48, 200.0/high
	eval legend_only
	y(n) = (205.0 - 20*n)/high
	set label 11 'Black line: the boundary, ρ = 1 + 10^{-12}' at screen 0.53,y(1.4) font ',10' \
		textcolor rgb '#202020'
	set label 12 'blue: decays (at ζ = 0 by damping of the method itself)' at screen 0.53,y(2.5) font ',10' \
		textcolor rgb '#202020'
	set colorbox horizontal user origin 0.53,y(6) size 0.45,18.0/high
	set cbtics ('0.1' 0.5, '0.5' 1.5, '0.9' 2.5, '0.99' 3.5, '1' 5, '1.01' 6.5, '1.1' 7.5, '2' 8.5, '11' 9.5)
	set cblabel 'ρ, spectral radius of one step'
	plot [0:1][0:1] '+' using (2):(2):(0) with points palette
	eval end
}

=== operator_map: operator_map.csv operator_boundary.csv
size = '900,690'
ends = made('unfold', '-v lists=wh,across', folder.'/operator_boundary.csv')
unset logscale
set xrange [-2:1.5]; set yrange [-1:1]
do for [form=1:forms] {
	eval begin(form)
	set multiplot
	eval panels
	do for [k=1:7] {
		unset label
		if (k == 1) { eval found_label }
		set origin 0.003 + 0.248*((k - 1) % 4), 0.475 - 0.455*((k - 1)/4)
		set size 0.248, 0.44
		method = word('etd1 etdrk2 etdrk4 nc2 nc3 dq4 bm3', k)
		set title method noenhanced textcolor rgb '#202020'
		set ylabel (k % 4 == 1 ? 'wA / w' : '')
		set xlabel (k > 3 ? 'w h  [rad]' : '')
		set xtics ('0.01' -2, '0.1' -1, '1' 0, '10' 1)
		set ytics ('0.1' -1, '0.2' log10(0.2), '0.5' log10(0.5), '1' 0, '2' log10(2), '5' log10(5), '10' 1)
		plot cells(csv, method, '-v ylog=1') using 1:2:3 with image, \
			ends using (strcol(1) eq method ? log10($2) : NaN):(log10($3)) skip 1 with points pt 7 ps \
			0.22 lc rgb 'black'
	}
	set origin 0.75, 0.0; set size 0.25, 0.45
	eval legend_only
	array said = ["Colour: the amplitude's change", 'within one true period 2π/w', \
		'dots: from damped to growing or back', 'wA/w = 1: there is no remainder, exact']
	do for [k=1:4] { set label 10 + k said[k] at screen 0.752,0.450 - 0.025*k font ',9' textcolor rgb '#202020' }
	set colorbox vertical user origin 0.80,0.035 size 0.03,0.285
	unset cblabel
	eval growth_ticks
	plot [0:1][0:1] '+' using (2):(2):(0) with points palette
	eval end
}

=== pl_map: pl_map.csv operator_boundary.csv
# Where pl grows by kappa h/4 a second the amplitude grows by e^{(pi/2) (k2/(k1 + k2)) w h} a period: dashed, at the
# bounds of the classes
size = '900,600'
ends = made('unfold', '-v lists=wh,across', folder.'/operator_boundary.csv')
predicted(x, percent) = log(1 + percent/100.0)*2/pi/10**x         # k2/(k1 + k2)
coupling(x, percent) = predicted(x, percent) < 1 ? log10(predicted(x, percent)/(1 - predicted(x, percent))) : NaN
unset logscale; unset grid
set format '%g'
set key off
set border 31 front lw 1 lc rgb '#404040'
set lmargin 11; set rmargin 14; set bmargin 4
set xrange [-2:1.5]; set yrange [-3:1]
set xlabel 'w h  [rad],  w = √((k1 + k2)/m)' font ',11' offset 0,0
set ylabel 'coupling  k2 / k1' font ',11' offset 0.5,0
set xtics ('0.01' -2, '0.1' -1, '1' 0, '10' 1) font ',10' out nomirror
set ytics ('0.001' -3, '0.01' -2, '0.1' -1, '1' 0, '10' 1) font ',10' out nomirror
set colorbox vertical user origin 0.88,0.17 size 0.025,0.72
eval growth_ticks
set cbtics font ',9' textcolor rgb '#202020'
unset cblabel
do for [form=1:forms] {
	eval begin(form)
	eval heading
	plot cells(csv, 'pl', '-v ylog=1') using 1:2:3 with image, \
		ends using (strcol(1) eq 'pl' ? log10($2) : NaN):(log10($3)) skip 1 with points pt 7 ps 0.3 lc rgb \
		'black', \
		for [p in "0.1 10 100 1000"] '+' using 1:(coupling($1, p + 0)) with lines dt 2 lw 2 lc rgb 'black'
	unset output
}

=== plmap: plmap.csv
size = '900,720'
unset logscale; unset key
set format '%g'
set grid noxtics noytics
# log10 of w h, of k2/k1, and of the ratio; a blank line between rows of the map
block(layout, periods) = "< awk -F, -v layout='".layout."' -v periods=".periods." '".\
	"{ for (i = 1; i < 6; i++) if ($i == \"\") $i = last[i]; else last[i] = $i } ".\
	"$1 == layout && $2 == periods { n = split($6, r, \" \"); print \"\"; ".\
	"for (i = 1; i <= n; i++) print (log($4) + (i - 1)*log($5))/log(10), log($3)/log(10), ".\
	"r[i] == \"-\" ? \"NaN\" : r[i] }' '".csv."'"
# Where the ratio is 1, and where it is 100 and 1/100
set datafile separator whitespace
array contour = ['$c1', '$c2', '$c3', '$c4']
array layout = ['k3 = k1', 'k3 = k1', 'k3 = k1/2', 'k3 = k1/2']
array periods = [6, 60, 6, 60]
do for [k=1:4] {
	eval "set table ".contour[k]
	set contour base; set cntrparam levels discrete -2, 0, 2
	unset surface
	splot block(layout[k], periods[k]) using 1:2:3
	unset table; unset contour; set surface
}
# light where pl is better, dark where RK4 is: also in black and white
set palette defined (-4 '#2166ac', -2 '#92c5de', 0 '#ffffff', 2 '#f4a582', 4 '#b2182b')
set cbrange [-4:4]
set xrange [-2:0.5]; set yrange [-4:1]
set xtics ('0.01' -2, '0.03' -1.523, '0.1' -1, '0.3' -0.523, '1' 0, '3' 0.477)
set ytics ('10^{-4}' -4, '10^{-3}' -3, '10^{-2}' -2, '0.1' -1, '1' 0, '10' 1)
set cbtics ('10^{-4}' -4, '10^{-2}' -2, '1' 0, '10^{2}' 2, '10^{4}' 4)
panel(k) = "set title '".layout[k]." (".(k < 3 ? "equal" : "unequal")." walls), until ".periods[k]." periods' ".\
	"offset 0,-0.8 font ',11'; ".\
	"set lmargin screen ".(k < 3 ? "0.075" : "0.50")."; set rmargin screen ".(k < 3 ? "0.44" : "0.865")."; ".\
	"set tmargin screen ".(k % 2 ? "0.885" : "0.455")."; set bmargin screen ".(k % 2 ? "0.555" : "0.13")."; ".\
	"plot block('".layout[k]."', ".periods[k].") using 1:2:3 with image, ".\
	"for [i = 2:0:-2] ".contour[k]." index i using 1:2 with lines lw 1 dt 2 lc rgb 'black', ".\
	contour[k]." index 1 using 1:2 with lines lw 3 lc rgb 'black', ".\
	"$marks using 1:(strcol(3) eq '".layout[k]."' ? $2 : 1/0):5 with points pt 7 ps 1 lc rgb variable, ".\
	"$marks using 1:(strcol(3) eq '".layout[k]."' ? $2 : 1/0):4:5 with labels left offset 0.7,0 noenhanced font ".\
	"',10' textcolor rgb variable"
$marks << EOD
-1 0 "k3 = k1" "scs" 0xfffffe
-0.199 -2 "k3 = k1/2" "scs_weak" 0x000001
EOD
set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb '#b0b0b0' fillstyle solid noborder
legend = 'thick line: equal; dashed: 100 times apart; grey: both off by more than half the initial displacement; '.\
	'dots: models at h = 0.01 s'
set label 2 at graph 0.03,0.93 left 'RK4 more accurate' font ',10' textcolor rgb '#fffffe' front
set label 3 at graph 0.97,0.06 right 'pl more accurate' font ',10' textcolor rgb '#000001' front
do for [form = 1:forms] {
	eval begin(form)
	set multiplot
	eval found_label
	unset colorbox; set xlabel ''; set ylabel 'coupling k_2/k_1 [1]'
	eval panel(1)
	unset label 99
	set ylabel ''
	set colorbox user origin 0.89,0.14 size 0.02,0.74
	set cblabel 'largest displacement error, pl over RK4 [1]'
	eval panel(3)
	unset colorbox
	set xlabel 'w h [rad], w = (k_1/m)^{1/2}' offset 0,0.5; set ylabel 'coupling k_2/k_1 [1]'
	eval panel(2)
	set ylabel ''
	set label 1 legend at screen 0.01,0.025 left font ',9' textcolor rgb '#505050'
	eval panel(4)
	unset label 1
	eval end
}
