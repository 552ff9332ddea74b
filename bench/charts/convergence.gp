# SPDX-License-Identifier: GPL-3.0-or-later
# convergence.gp convergence.csv OUTDIR: a picture for each system
here = system("dirname '".ARG0."'"); csv = ARG1; out = ARG2
load here.'/style.gp'
orders = system("dirname '".csv."'").'/convergence_orders.csv'
set xlabel 'intervals N in 30 s [1]' offset 0,0.4
set xrange [700:300000]
set yrange [1e-16:1e3]
set ytics 1e-16,100,1e4
set bmargin 0

# At the right end of a curve: its order between the last two N
ends(model, horizon) = "< awk -F, '$1 == \"".model."\" && $2 == ".horizon." && FNR > 1 { if (NR == FNR) { n[$5] = ".\
	"$3; e[$5] = $6 } else if ($6 ~ /^[0-9]/) print n[$3], e[$3], $6 }' OFS=, '".csv."' '".orders."'"
# As in series.awk, but above the edge at the edge
clipped(model, horizon) = "< awk -F, 'NR == 1 || ($1 == \"".model."\" && $2 == ".horizon.") { if (NR > 1 && ($6 == ".\
	"\"diverged\" || $6 > 5e2)) $6 = 5e2; ".\
	"print }' OFS=, '".csv."' | awk -f '".here."/csv.awk' -f '".here."/series.awk' -v x=intervals_in_30_s -v ".\
	"y=error_over_initial_displacement"
panel(model, horizon) = "load clipped('".model."', '".horizon."'); eval 'plot '.clauses.', ends(\"".model."\", ".\
	"\"".horizon."\") using 1:2:(sprintf(\"  %.2f\", $3)) with labels left font \",9\" notitle'"

frame = "set multiplot title 'Convergence: '.model.', '.what font ',13'; ".\
	"set tmargin screen 0.85; set bmargin screen 0.17; ".\
	"set label 1 \"Numbers at the right: order, from the last two N. Drawn at the upper edge: above 500. Steps ".\
	"of h = 30 s/N.\\nParameters chosen: the source's did not survive.\" at screen 0.01,0.05 left font ',9' ".\
	"textcolor rgb '#505050'; ".\
	"set label 2 \"two readings:\\npl: coupling held\\n   over each interval\\nexact: nothing held\" at screen ".\
	"0.815,0.55 left font ',10'; ".\
	"set lmargin screen 0.085; set rmargin screen 0.40; ".\
	"set ylabel 'largest displacement error over x_1(0) [1]'; unset key; set title 'until 0.6 s' offset 0,-0.6; ".\
	"eval panel(model, '0.6'); ".\
	"unset label 1; unset label 2; set lmargin screen 0.465; set rmargin screen 0.78; set ylabel ''; ".\
	"set key at screen 0.80,0.85 left top vertical Left reverse samplen 3.5 spacing 1.3 font ',10'; ".\
	"set title 'until 30 s'; eval panel(model, '30'); ".\
	"unset multiplot; "
do for [k = 1:3] {
	model = word('scs sdcs sdcsf', k)
	what = k == 1 ? 'two undamped masses, coupled by a spring' : k == 2 ? 'coupled by a spring and a damper' : \
		'coupled by a spring and a damper, with a cosine force'
	set terminal svg size 900,600 dynamic enhanced font 'DejaVu Sans,Helvetica,sans-serif,13' background rgb 'white'
	set output out.'/convergence_'.model.'.svg'
	eval frame
	unset output
	set terminal pngcairo size 900,600 enhanced font 'DejaVu Sans,11' background rgb 'white'
	set output out.'/convergence_'.model.'.png'
	eval frame
	unset output
}
