# SPDX-License-Identifier: GPL-3.0-or-later
# stability_map.csv, stability_boundary.csv: a panel for each method of the table
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = 0
map = folder.'/stability_map.csv'
ends = folder.'/stability_boundary.csv'
count = int(system("awk -F, 'NR > 1 && !seen[$1]++ { n++ } END { print n }' '".map."'"))
named(k) = system(sprintf("awk -F, 'NR > 1 && !seen[$1]++ && ++n == %d { print $1; exit }' '%s'", k, map))
lines = ceil((count + 2)/4.0)           # of panels, the last two places for the colours
high = 60 + 205*lines
size = sprintf('900,%d', high)
load here.'/style.gp'
load here.'/map.gp'
unset logscale
set xrange [-2:2]
set yrange [-0.016:1.5]         # the row of zeta = 0 is seen whole
name = 'stability_map'

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
		plot cells(map, method, '') using 1:2:3 with image, \
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
	unset multiplot
	unset output
}
