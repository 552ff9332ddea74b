# SPDX-License-Identifier: GPL-3.0-or-later
# gnuplot -c bench/charts/stability.gp FOLDER OUTDIR: FOLDER has stability_map.csv and stability_boundary.csv
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2
load here.'/style.gp'
load here.'/map.gp'
map = folder.'/stability_map.csv'
ends = folder.'/stability_boundary.csv'
array names = ['explicit Euler', 'explicit trapezoid', 'RK4', 'central difference', 'Dormand-Prince 5 (fixed step)', \
	'GSL rk8pd (fixed step)', 'implicit trapezoid', 'Newmark', 'generalized-alpha', 'exact']
array titles = ['explicit Euler', 'explicit trapezoid', 'RK4', 'central difference', 'Dormand-Prince 5, fixed step', \
	'GSL rk8pd, fixed step', 'implicit trapezoid', 'Newmark, average accel.', 'generalized-alpha, ρ_{∞} = 0.8', \
	'exact (plgen)']
bounds = '-0.9 -0.5 -0.1 -0.01 -1e-12 1e-12 0.01 0.1 1 10'
unset logscale
set xrange [-2:2]
set yrange [-0.016:1.5]         # the row of ζ = 0 is seen whole

do for [form=1:2] {
	eval (form == 1 ? svg_of_map : png_of_map)
	set output out.'/stability_map.'.(form == 1 ? 'svg' : 'png')
	set multiplot
	eval panels
	do for [k=1:10] {
		unset label
		if (k == 1) { set label 1 "Spectral radius ρ of one step of each method on x'' + 2ζw x' + w^2 x = 0" \
			at screen 0.5,0.975 center font ',12' }
		set origin 0.003 + 0.248*((k - 1) % 4), 0.655 - 0.31*((k - 1)/4)
		set size 0.248, 0.30
		set title titles[k]
		set ylabel (k % 4 == 1 ? 'damping ratio ζ' : '')
		set xlabel (k > 6 ? 'w h  [rad]' : '')
		set xtics ('0.01' -2, '0.1' -1, '1' 0, '10' 1, '100' 2)
		set ytics 0,0.5,1.5
		plot cells(map, names[k], "-v x=wh -v y=zeta -v value=growth") using 1:3:1:2:3:4:5 with boxxyerror lc \
			palette, \
			for [b=1:4] ends using (strcol(1) eq names[k] && $2 == b ? log10($3) : NaN):4 skip 1 with \
			lines lw 2.6 lc rgb 'black'
	}
	set origin 0.51, 0.0; set size 0.48, 0.33
	eval legend_only
	set label 11 'Black line: the boundary, ρ = 1 + 10^{-12}.  Colour: ρ' at screen 0.525,0.285 font ',9'
	set label 12 'blue: decays (at ζ = 0 by damping of the method itself)' at screen 0.525,0.255 font ',9'
	set label 13 'explicit trapezoid at ζ = 0 grows at every step, by (wh)^4/8' at screen 0.525,0.225 font ',9'
	set label 14 'rk8pd at ζ = 0 grows as (wh)^{10}: above 10^{-12} for wh 0.36 to 1.50' at screen 0.525,0.195 \
		font ',9'
	set colorbox horizontal user origin 0.53,0.115 size 0.45,0.025
	set cbtics ('0.1' 0.5, '0.5' 1.5, '0.9' 2.5, '0.99' 3.5, '1' 5, '1.01' 6.5, '1.1' 7.5, '2' 8.5, '11' 9.5)
	set cblabel 'ρ, spectral radius of one step'
	plot [0:1][0:1] '+' using (2):(2):(0) with points palette
	unset multiplot
	unset output
}
