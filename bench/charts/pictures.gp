# SPDX-License-Identifier: GPL-3.0-or-later
# The pictures. A section each, `=== NAME: TABLE... [narrow]`: picture.sh runs it after style.gp, where its tables are
# there, with csv the first of them and name = 'NAME'; narrow: once more for a screen of 400 pixels.

=== convergence: convergence.csv convergence_orders.csv
# A picture for each system
orders = folder.'/convergence_orders.csv'
set xlabel 'intervals N in 30 s [1]' offset 0,0.4
set xrange [700:300000]; set xtics 1000,10,1e5
set yrange [1e-16:1e3]; set ytics 1e-16,100,1e4
set bmargin 0
# At the right end of a curve: its order between the last two N
ends(model, horizon) = "< awk -F, '$1 == \"".model."\" && $2 == ".horizon." && FNR > 1 { if (NR == FNR) { n[$5] = ".\
	"$3; e[$5] = $6 } else if ($6 ~ /^[0-9]/) print n[$3], e[$3], $6 }' OFS=, '".csv."' '".orders."'"
clipped(model, horizon) = series(csv, "-v 'where=system=".model.";horizon_s=".horizon."' -v edge=500 ".\
	"-v x=intervals_in_30_s -v y=error_over_initial_displacement")
panel(model, horizon) = "load clipped('".model."', '".horizon."'); eval 'plot '.clauses.', ends(\"".model."\", ".\
	"\"".horizon."\") using 1:2:(sprintf(\"  %.2f\", $3)) with labels left font \",9\" notitle'"
do for [model in first_words(csv)] {
	name = 'convergence_'.model
	do for [form = 1:forms] {
		eval begin(form)
		set multiplot; set tmargin screen 0.86; set bmargin screen 0.13
		eval found_label
		set label 1 "Numbers at the right: order,\nfrom the last two N.\nAt the upper edge:\nabove 500." at \
			screen 0.81,0.3 left font ',10' textcolor rgb '#505050'
		set lmargin screen 0.085; set rmargin screen 0.40
		set ylabel 'largest displacement error over x_1(0)'; unset key
		set title 'until 0.6 s' offset 0,-0.6 font ',12'
		eval panel(model, '0.6')
		unset label; set lmargin screen 0.465; set rmargin screen 0.78; set ylabel ''
		set key at screen 0.80,0.85 left top vertical Left reverse samplen 3.5 spacing 1.3 font ',11'
		set title 'until 30 s'
		eval panel(model, '30')
		eval end
	}
}

=== energy: energy.csv narrow
# The largest change met so far, over steps
set xlabel 'steps taken'
set xrange [1:*]; set xtics 1,100,1e9
array names = ['energy_double', 'energy_float', 'energy_float_short', 'momentum_double']
array rows = ['case=undamped;real=double;step_s=0.01', 'case=undamped;real=float;step_s=0.01', \
	'case=undamped;real=float;step_s=0.0001', 'case=moving;real=double']
do for [k = 1:4] {
	name = names[k]
	set ylabel sprintf('largest change of %s so far, relative', k == 4 ? 'momentum' : 'energy')
	if (k == 1 || k == 4) { set yrange [1e-17:10]; set ytics 1e-16,100,10 } else {
		set yrange [1e-9:10]; set ytics 1e-9,10,10 }
	eval heading
	load marked(4, sprintf("-v 'where=%s' -v x=steps -v y=largest -v most=10 -v rank=last", rows[k]))
	eval "plot ".clauses
	eval write
}

=== frame: frame.csv frame_history.csv
size = '1100,560'; font = '12'; png_font = '10'
unset bmargin
do for [form=1:2] {
	eval begin(form)
	set multiplot
	set bmargin 5; set tmargin 4.5
	unset logscale; set format '%g'
	set origin 0,0; set size 0.45,1; set lmargin 8; set rmargin 2
	eval found_label
	set title 'The roof from 8 to 12 s, h = 0.02 s' font ',12'
	set xlabel 't  [s]'; set ylabel 'displacement of the roof  [mm]' offset 1,0
	set xrange [8:12]; set xtics 8,1,12; set autoscale y; set ytics auto
	set key inside bottom left horizontal samplen 3 font ',10'
	load series(folder.'/frame_history.csv', '-v any=1 -v with=lines -v x=t_s -v y=roof_mm')
	eval 'plot '.clauses
	unset label
	set origin 0.45,0; set size 0.55,1; set lmargin 9; set rmargin 22
	set title 'Largest error of 20 s' font ',12'
	set xlabel 'step h  [s]'; set ylabel 'error of the roof over its largest displacement' offset 1,0
	set logscale xy; set format y '10^{%T}'
	set xrange [0.004:0.025]; set xtics ('1/200' 0.005, '1/100' 0.01, '1/50' 0.02)
	set yrange [1e-16:1]; set ytics 1e-16,100,1
	set key outside right top vertical Left reverse samplen 3 spacing 1.15 font ',10'
	load series(csv, '-v x=h_s -v y=roof_error_over_peak')
	eval 'plot '.clauses
	eval end
}

=== friction: friction_times.csv friction.csv
# A mass that sticks and slips: error over the time of a simulated second
eval heading
set xlabel 'time of a simulated second  [ns]'
set ylabel 'largest error of x over its largest value'
set yrange [1e-15:1]; set ytics 1e-15,1000,1
load series(csv, "-v x=ns_min -v y=largest")
eval 'plot '.clauses
eval write

=== gear1_sweep: gear1_sweep.csv narrow
# Of bench/sweep.sh: half the range of the motion over the frequency, up and then down
set datafile separator whitespace
unset logscale
set format '%g'
set xlabel 'frequency of the force, eta [rad/s]'
set ylabel 'half the range of q [1]'
set offsets graph 0, graph 0, graph 0.05, graph 0
set key inside top right vertical Left reverse font ',11'
eval heading
plot csv index 0 using 1:2 with linespoints pt 8 lw 1.6 lc rgb '#be3028' title 'up', \
	'' index 1 using 1:2 with linespoints pt 11 lw 1.6 lc rgb '#1f6fe0' title 'down'
eval write

=== sensitivities: sensitivities.csv
# Of bench/sensitivities.sh: a panel for each model
size = '900,640'
models = first_words(csv)
unset bmargin
do for [form=1:forms] {
	eval begin(form)
	set multiplot
	set xrange [50:1e6]; set xtics 100,10,1e6
	set yrange [1e-14:1]; set ytics 1e-14,100,1
	set logscale xy; unset mxtics; unset mytics; unset key
	set lmargin 9; set rmargin 1; set tmargin 2; set bmargin 3.5
	do for [k=1:words(models)] {
		set origin 0.33*((k - 1)%3), 0.5 - 0.5*((k - 1)/3); set size 0.33,0.5
		set title word(models, k) offset 0,-0.6
		set xlabel (k > 2 ? 'thousands of instructions' : '')
		set ylabel (k%3 == 1 ? 'error of the derivatives' : '')
		load series(csv, "-v 'where=model=".word(models, k)."' -v x=thousand_instructions -v y=error")
		eval 'plot '.clauses
	}
	eval bare; set origin 0,0; set size 1,1
	set key at screen 0.97,0.4 right top vertical Left reverse samplen 3 spacing 1.3 font ',11'
	eval keyed; eval dressed
}

=== break_even: break_even_raw.csv narrow
# For each model, after how many steps generating and compiling is won back
names = first_words(csv)
size = sprintf('%d,%d', narrow ? 400 : 900, 150 + (narrow ? 50 : 0) + 24*words(names))
load made('pays', '', csv)
set xlabel 'steps of the generated code'
unset logscale y
set yrange [words(names) + 0.6:0.4]
set xrange [1:1e11]; set xtics 1,100,1e9; set xtics add ('never' 1e10)
set lmargin (narrow ? 15 : 17)
set ytics () noenhanced font ',11'
do for [k=1:words(names)] { set ytics add (word(names, k) k) }
set arrow 1 from first 3e9, graph 0 to first 3e9, graph 1 nohead dt 3 lc rgb '#8e8e96'
colour(of) = system("awk '$1 == \"".of."\" { print $2 }' '".here."/palette.list'")
eval heading
plot $others using 1:2 with points pt 7 ps 0.45 lc rgb colour('other') title 'against every other peer', \
	$cheapest using 1:2 with points pt 5 ps 1.2 lc rgb colour('exact') title 'against the cheapest peer'
eval write

=== hard: hard.csv
# Methods down, cases across, what came of it
load made('hard_grid', '', csv)
size = sprintf('%d,%d', 900, 150 + 23*rows)
unset logscale; unset grid; unset border; unset xtics
set xrange [0.5:cases + 0.5]; set x2range [0.5:cases + 0.5]; set yrange [rows + 0.5:0.5]
eval "set ytics (".tics.") noenhanced scale 0 font ',11'"
eval "set x2tics (".cases_tics.") noenhanced scale 0 rotate by 40 left offset 0,0 font ',11' ".\
	"textcolor rgb '#202020'"
set lmargin 26; set rmargin 10
set key off
eval heading
eval sprintf("set tmargin %g", 1.5 + 1.15*lines_of(found) + 4.4)
set bmargin 3
set style fill solid 1 noborder
do for [k=1:rows - 1] { set arrow from 0.5,k + 0.5 to cases + 0.5,k + 0.5 nohead front lc rgb '#ffffff' }
do for [k=1:cases - 1] { set arrow from k + 0.5,0.5 to k + 0.5,rows + 0.5 nohead front lc rgb '#ffffff' }
legend = \
	'ok: error below 0.001   exact: nothing left over, ok   poor: below 0.1   wrong: above   div.: diverged   '.\
	'quit: gave up   ref.: refused'
set label 1 legend at screen 0.02,screen 0.0 offset 0,1.2 left font ',10' textcolor rgb '#202020'
plot $areas using 1:3:1:2:($3 - 0.5):($3 + 0.5):4 with boxxyerror lc rgb variable, \
	$cells using 1:2:3 with labels font ',10' textcolor rgb '#000001'
eval write

=== headline_integrators: headline_integrators.csv narrow
# Each integrator at the setting that reaches an error
load made('headline', '', csv)
size = sprintf('%d,%d', narrow ? 400 : 900, 150 + (narrow ? 70 : 0) + 25*rows)
set xlabel 'CPU time per output [ns]'
unset logscale y
set format y '%s'
set yrange [rows + 1.4:0.4]; set xrange [1:1e5]
eval "set ytics (".tics.") font ',".(narrow ? 9 : 11)."' noenhanced"
set grid noytics
set lmargin (narrow ? 20 : 25)
if (!narrow) { set key inside top right }
eval heading
eval "plot ".clauses
eval write

=== headline_equal_step: headline_equal_step.csv narrow
load made('equal_step', '', csv)
size = sprintf('%d,%d', narrow ? 400 : 900, 150 + 26*rows)
found = finding(name, size)
top = 1 - (34.0 + 17*lines_of(found))/(150 + 26*rows)
panels = narrow ? 2 : 3
first = narrow ? 0.43 : 0.265
wide = (1 - first)/panels
array axis = ['time of a step [ns]', 'largest error', 'drift of the energy']
do for [form = 1:forms] {
	eval begin(form)
	set multiplot
	unset key
	unset logscale y
	set grid xtics ytics
	set tmargin screen top; set bmargin screen 70.0/(150 + 26*rows)
	do for [k = 1:panels] {
		set lmargin screen first + wide*(k - 1); set rmargin screen first + wide*k - 0.025
		unset label
		set yrange [rows + 0.6:0.4]
		set xlabel axis[k] font ',11'
		if (k == 1) {
			eval found_label
			eval "set ytics (".tics.") font ',".(narrow ? 9 : 11)."' noenhanced"
			unset logscale x; set format x '%g'
			set xrange [0:*]; set xtics autofreq font ',10'
			if (narrow) { set xtics 0,10 }
		} else {
			eval "set ytics (".blank.")"
			set logscale x; set format x '10^{%T}'
			set xrange [(k == 2 ? 1e-16 : 1e-15):(k == 2 ? 1e-3 : 1)]
			set xtics 1e-14,(narrow ? 1e6 : 1e4),1 font ',10'
		}
		eval 'plot '.panel(k)
	}
	eval end
}

=== headline_confluence: headline_confluence.csv narrow
# Where frequencies nearly meet
set xlabel 'relative gap between the two frequencies'
set ylabel 'largest error over 100 s, relative'
set xrange [3e-4:3e-13] reverse
set yrange [1e-17:10]
set xtics ('10^{-4}' 1e-4, '10^{-6}' 1e-6, '10^{-8}' 1e-8, '10^{-10}' 1e-10, '0' 1e-12)
eval heading
load series(csv, "-v where=case=one-way -v x=gap -v y=error -v xzero=1e-12 -v most=10 -v rank=last -v keep=modal")
eval "plot ".clauses
eval write

=== integrators: integrators.csv
# Three panels side by side, the key below them
size = '1100,560'; font = '12'; png_font = '10'
unset bmargin
array columns = ['spectral_radius', 'period_elongation_percent', 'amplitude_decay_percent_per_period']
array ordinates = ['spectral radius of a step', 'period elongation  [%]', 'amplitude decay in a period  [%]']
do for [form=1:2] {
	eval begin(form)
	set multiplot
	do for [side=1:3] {
		unset label; set key off
		set origin (side - 1)/3.0, 0.19; set size 1/3.0, 0.72
		set lmargin 8; set rmargin 2; set tmargin 1; set bmargin 4
		unset logscale; set format '%g'
		set xlabel 'h / T, step over period' offset 0,0.3
		set ylabel ordinates[side] offset 1,0
		if (side == 1) {
			set logscale x; set xrange [0.01:100]; set xtics ('0.01' 0.01, '0.1' 0.1, '1' 1, '10' 10, \
				'100' 100)
			set yrange [0:1.1]; set ytics 0,0.2,1
			eval found_label
		} else {
			set xrange [0:0.2]; set xtics 0,0.05,0.2; set ytics auto
			set yrange [(side == 2 ? -6 : -1):(side == 2 ? 20 : 12)]
		}
		load marked((side == 1 ? 16 : 6), '-v any=1 -v x=h_over_T -v y='.columns[side])
		eval 'plot '.clauses
	}
	eval key_below(0.22, 0.105, 3, 2)
	load marked(9, '-v any=1 -v x=h_over_T -v y=spectral_radius')
	eval keyed
}

=== less: less.csv
size = '1100,580'; font = '12'; png_font = '10'
unset bmargin
array scene = ['beam', 'building', 'drivetrain']
array titles = ['Beam of 10 elements, hit at its tip', 'Building of 12 storeys, earthquake', \
	'Drivetrain of 6 inertias, engine']
last_of(s, k) = system("awk -F, '$1 == \"".s."\" { print $(NF - ".k."); exit }' '".csv."'")
line_of(s) = real(last_of(s, 0))
of_scene(s) = series(csv, '-v by=model -v x=multiplications -v y=error_over_peak -v where=scene='.s)
do for [form=1:2] {
	eval begin(form)
	set multiplot
	do for [side=1:3] {
		unset label; set key off; unset arrow
		set origin (side - 1)/3.0, 0.17; set size 1/3.0, 0.76
		set lmargin 8; set rmargin 2; set tmargin 3; set bmargin 4
		set logscale y; unset logscale x; set format x '%g'; set format y '10^{%T}'
		set title titles[side] font ',12' offset 0,-0.5
		set xlabel 'multiplications in a step' offset 0,0.3
		set ylabel (side == 1 ? 'error of the output over its largest value' : '') offset 1,0
		set xrange [0:(side == 1 ? 165 : side == 2 ? 105 : 45)]; set xtics auto
		set yrange [1e-9:1]; set ytics 1e-9,10,1
		if (side == 1) { eval found_label }
		set arrow 1 from graph 0, first line_of(scene[side]) to graph 1, first line_of(scene[side]) nohead \
			lw 1.6 dt 2 lc rgb '#404040'
		set label 2 'off anyway: '.last_of(scene[side], 1) at graph 0.97, first \
			1.5*line_of(scene[side]) right font ',9.5' textcolor rgb '#404040'
		load of_scene(scene[side])
		eval 'plot '.clauses
	}
	eval key_below(0.2, 0.09, 2, 2)
	load of_scene('beam')
	eval keyed
}

=== limits: limits.csv
# Time of a step and of a row over what the machine allows, by compiler and flags
size = '900,620'
unset logscale x
set format x '%g'; set format y '%g'
set yrange [0.8:*]; set ytics (1, 1.5, 2, 3, 5, 10, 20, 50, 100)
set ylabel 'time over bound [1]'
set xtics rotate by -40 left ()
set bmargin 9
# column 1: model and function, counted; 2: their name; 3, 4: over bound, over work
where(compiler, flags, shift) = "< awk -F, 'NR > 1 && $2 != \"run_to_memory\" { key = $1 \" \" $2; if (!(key in n)) ".\
	"n[key] = ++count; if ($3 == \"".compiler."\" && $4 == \"".flags."\") ".\
	"print n[key] + ".shift.", key, $13, $14 }' OFS=, '".csv."'"
names = system("awk -F, 'NR > 1 && $2 != \"run_to_memory\" && !seen[$1,$2]++ { printf \"%s_%s \", $1, $2 }' ".\
	"'".csv."'")
do for [k=1:words(names)] {
	set xtics add (system("echo '".word(names, k)."' | sed 's/_\\(step\\|run\\)$/ \\1/; s/_/\\\\_/g'") k)
}
set xrange [0.5:words(names) + 0.5]
eval heading
native = '-O2 -march=native'
plot 1 with lines lw 1.5 dt 2 lc rgb '#5c9a52' title 'the machine', \
	where('gcc', '-O2', '-0.24') using 1:3 with points pt 7 ps 1.1 lc rgb '#6a6f78' title 'gcc -O2', \
	'' using 1:4 with points pt 6 ps 1.1 lc rgb '#6a6f78' notitle, \
	where('gcc', native, '-0.08') using 1:3 with points pt 5 ps 1.1 lc rgb '#be3028' title 'gcc native', \
	'' using 1:4 with points pt 4 ps 1.1 lc rgb '#be3028' notitle, \
	where('clang', '-O2', '0.08') using 1:3 with points pt 9 ps 1.2 lc rgb '#1f6fe0' title 'clang -O2', \
	'' using 1:4 with points pt 8 ps 1.2 lc rgb '#1f6fe0' notitle, \
	where('clang', native, '0.24') using 1:3 with points pt 13 ps 1.2 lc rgb '#c48600' title 'clang native', \
	'' using 1:4 with points pt 12 ps 1.2 lc rgb '#c48600' notitle
eval write

=== needs: needs.csv
size = '1100,760'
unset bmargin
array scene = ['beam', 'building', 'drivetrain', 'quarter_car', 'pendulum']
array titles = ['Beam of 15 masses, its tip', 'Building of 12 storeys, any record', 'Drivetrain of 6 inertias', \
	'Quarter car over a step of the road', 'Pendulum: measured']
# rows of a scene: cost, error over need; those of a type, or the one that is taken
rows(s, real, taken) = "< awk -F, '$1 == \"".s."\" && (\"".real."\" == \"\" || $3 == \"".real."\") && (\"".taken. \
	"\" == \"\" || $14 == \"".taken."\") { print $11 \",\" $12 }' '".csv."'"
float = "points pt 6 ps 0.9 lw 1.5 lc rgb '#1f6fb4'"
double = "points pt 4 ps 0.9 lw 1.5 lc rgb '#b4531f'"
chosen = "points pt 7 ps 1.7 lc rgb '#2a8a3a'"
do for [form=1:forms] {
	eval begin(form)
	set multiplot
	do for [panel=1:5] {
		unset label; set key off; unset arrow
		set origin ((panel - 1) % 3)/3.0, panel > 3 ? 0.0 : 0.46; set size 1/3.0, 0.46
		set lmargin 8; set rmargin 2; set tmargin 2.5; set bmargin 3.5
		set logscale xy; set format x '%g'; set format y '10^{%T}'
		set title titles[panel] font ',12' offset 0,-0.5
		set xlabel 'operations in a '.(panel == 5 ? 'second' : 'step').', of double twice' offset 0,0.3
		set ylabel (panel % 3 == 1 ? 'error over what is needed' : '') offset 1,0
		set xrange [*:*]; set yrange [*:*]; set xtics auto; set ytics auto
		if (panel == 1) { eval found_label }
		set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead lw 1.6 dt 2 lc rgb '#404040'
		plot rows(scene[panel], 'float', '') using 1:2 with @float, \
			rows(scene[panel], 'double', '') using 1:2 with @double, \
			rows(scene[panel], '', 'true') using 1:2 with @chosen
	}
	eval bare
	set tmargin 2.5; set bmargin 3.5; set lmargin 8
	set origin 2/3.0,0; set size 1/3.0,0.46
	set key at graph 0.5,0.6 center vertical Left reverse samplen 2 spacing 1.4 font ',12' textcolor rgb '#202020'
	set xrange [0:1]; set yrange [0:1]
	plot NaN with @float title 'float', NaN with @double title 'double', NaN with @chosen title 'the choice', \
		NaN with lines lw 1.6 dt 2 lc rgb '#404040' title 'the need'
	eval end
	eval dressed
}

=== papers_beam_tip: papers_beam_tip.csv
# What etd1 makes of the rotating beam, by its operator
unset logscale x
set format x '%g'
set xrange [0:50]; set xtics 10
set yrange [1e-4:1e3]; set ytics 1e-4,10,1e3
set bmargin 0
rows(h, operator) = made('unfold', '-v lists=t_s,largest_tip_in_last_second_m', csv)." | awk -F, '$1 == ".h." && ".\
	"$2 == \"".operator."\" && $4 ~ /^[0-9]/ { print $3, $4 }' OFS=,"
# soft operators: open marks, dashed; from that of the true speed on: filled marks, unbroken
marks = '4 6 8 12 5 7 9'
colours = '#be3028 #c48600 #be3028 #c48600 #1f6fe0 #6a6f78 #1f6fe0'
steps = first_words(csv)
left(k) = 0.08 + 0.265*(k - 1)
do for [form = 1:forms] {
	eval begin(form)
	set multiplot; eval found_label
	set tmargin screen 0.85; set bmargin screen 0.13; set xlabel 'time [s]' offset 0,0.4
	do for [k = 1:words(steps)] {
		h = word(steps, k)
		set lmargin screen left(k); set rmargin screen left(k) + 0.225
		set title 'h = '.h.' s' offset 0,-0.6
		if (k == 1) { set ylabel 'deflection of the tip [m]'; set format y '10^{%T}' } else { set ylabel ''
			set format y ''; unset label }
		if (k == words(steps)) { set key at screen left(k) + 0.24,0.85 left top vertical Left reverse \
			samplen 3 spacing 1.3 font ',10' } else { unset key }
		plot rows(h, 'reference') using 1:2 with lines lw 5 lc rgb '#c0c0c0' title 'true', \
			for [w = 0:6] rows(h, 'A('.w.')') using 1:2 with linespoints pt int(word(marks, w + 1)) \
			ps 0.9 pi 6 lc rgb word(colours, w + 1) dt 1 + (w < 4) lw (w < 4 ? 1.3 : 2.2) title 'A('.w.')'
	}
	eval end
}

=== papers_times: papers_times.csv
# Time of a step of pl over that of RK4, beside the ratios that its source reports
unset logscale
set format '%g'
set xrange [-0.6:5.6]
set grid noxtics
set ylabel 'CPU time of 30 s over that of RK4 at the same step [1]'
set key inside top left
number = "font ',10' textcolor rgb '#202020'"
eval heading
set bmargin 3.5
set yrange [0:1.35]
# model and step; reported; measured pl; measured exact
bars = "< sed 's/, 30 s/; 30 s/' '".csv."' | awk -F, '$1 != \"000\" { next } ".\
	"$3 == \"pl\" { sub(/.*h = /, \"\", $4); ".\
	"key = $2 \"\\\\nh = \" $4; reported = $5; pl = $6 } ".\
	"$3 == \"exact\" { print n++, key, reported, pl, $6 }' OFS=,"
set boxwidth 0.24
set xtics scale 0
set style fill solid 0.9 border lc rgb '#8e8e96'
plot bars using ($1 - 0.26):3 with boxes fs pattern 4 lc rgb '#6a6f78' title 'pl: reported', \
	'' using 1:4:xtic(stringcolumn(2)) with boxes fs solid 0.9 lc rgb '#c48600' title 'pl: measured', \
	'' using ($1 + 0.26):5 with boxes fs solid 0.9 lc rgb '#be3028' title 'exact: measured', \
	for [k=3:5] '' using ($1 + 0.26*(k - 4)):k:(sprintf('%.2f', column(k))) with labels offset 0,0.6 @number \
	notitle, \
	1 with lines lw 1 dt 2 lc rgb '#5c9a52' title 'RK4'
eval write

=== precision: precision.csv matrix.csv narrow
# For each model its error against time; on narrow screens without what is grey
set ylabel 'largest error over the history, relative'
set yrange [1e-16:10]; set ytics 1e-16,100,10; set mytics 2; unset mxtics
set xlabel "CPU time per output [µs], median"
do for [m in first_words(csv)] {
	name = 'precision_'.m
	eval heading
	load series(csv, sprintf("-v 'where=model=%s' -v x=ns_median -v y=largest -v xfactor=1e-3 -v most=10 %s", \
		m, narrow ? '-v rest=no' : ''))
	if (narrow) { set key maxrows (longest > 28 ? 10 : 5) }    # so that two columns fit
	eval "plot ".clauses
	eval write
}

=== quality: quality.csv
# Two panels side by side, and between them nothing but their axes: the key stands below both. Curves of 81 points,
# equally spaced on a log axis: a mark on some of them
unset bmargin
do for [which=1:2] {
	name = which == 1 ? 'quality' : 'quality_small'
	do for [form=1:forms] {
		eval begin(form)
		set multiplot
		do for [side=1:2] {
			unset label; set key off; unset arrow; unset xzeroaxis
			set origin 0.5*(side - 1), 0.19; set size 0.5, 0.73
			set lmargin 9; set rmargin 2; set tmargin 2; set bmargin 4
			set xlabel 'h / T, step over period' offset 0,0.3
			if (which == 1) {
				unset logscale; set format '%g'; set xrange [0:0.4]; set xtics 0,0.1,0.4
				set ytics auto; set xzeroaxis lw 1.5 lc rgb '#404040'
				set yrange [(side == 1 ? -20 : -30):(side == 1 ? 40 : 30)]
				set ylabel (side == 1 ? 'period elongation  [%]' : \
					'amplitude decay in a period  [%], below 0: growth') offset 1,0
			} else {
				set logscale xy; set xrange [0.005:0.5]
				set xtics ('0.005' 0.005, '0.01' 0.01, '0.02' 0.02, '0.05' 0.05, '0.1' 0.1, '0.2' \
					0.2, '0.5' 0.5); set format y '10^{%T}'
				set yrange [1e-10:1e2]
				set ylabel (side == 1 ? 'size of the period elongation  [%]' : \
					'size of the amplitude''s change in a period  [%]') offset 1,0
			}
			if (side == 1) { eval found_label }
			load marked((which == 1 ? 4 : 9), '-v x=h_over_T -v y='.(side == 1 ? \
				'period_elongation_percent' : 'amplitude_decay_percent_per_period'). \
				(which == 1 ? ' -v any=1' : " -v sizes=1e-11 -v skip='in phase'"))
			eval 'plot '.clauses
		}
		eval key_below(0.22, 0.125, 4, -2)
		load marked(9, '-v x=h_over_T -v y=period_elongation_percent -v any=1')
		eval keyed
	}
}
