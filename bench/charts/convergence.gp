# SPDX-License-Identifier: GPL-3.0-or-later
# convergence.csv, convergence_orders.csv: a picture for each system
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = 0
load here.'/style.gp'
csv = folder.'/convergence.csv'
orders = folder.'/convergence_orders.csv'
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
	"print }' OFS=, '".csv."' | awk -v palette='".here."/palette.list' ".\
	"-f '".here."/csv.awk' -f '".here."/series.awk' -v x=intervals_in_30_s -v ".\
	"y=error_over_initial_displacement"
panel(model, horizon) = "load clipped('".model."', '".horizon."'); eval 'plot '.clauses.', ends(\"".model."\", ".\
	"\"".horizon."\") using 1:2:(sprintf(\"  %.2f\", $3)) with labels left font \",9\" notitle'"

set xtics 1000,10,1e5
frame = "set multiplot; set tmargin screen 0.86; set bmargin screen 0.13; ".\
	"eval found_label; ".\
	"set label 1 \"Numbers at the right: order,\\nfrom the last two N.\\nAt the upper edge:\\nabove 500.\" at ".\
	"screen 0.81,0.3 left font ',10' textcolor rgb '#505050'; ".\
	"set lmargin screen 0.085; set rmargin screen 0.40; ".\
	"set ylabel 'largest displacement error over x_1(0)'; unset key; ".\
	"set title 'until 0.6 s' offset 0,-0.6 font ',12'; ".\
	"eval panel(model, '0.6'); ".\
	"unset label; set lmargin screen 0.465; set rmargin screen 0.78; set ylabel ''; ".\
	"set key at screen 0.80,0.85 left top vertical Left reverse samplen 3.5 spacing 1.3 font ',11'; ".\
	"set title 'until 30 s'; eval panel(model, '30'); unset multiplot; "
systems = system("awk -F, 'NR > 1 && !seen[$1]++ { printf \"%s \", $1 }' '".csv."'")
do for [model in systems] {
	name = 'convergence_'.model
	do for [form = 1:forms] {
		eval begin(form)
		eval frame
		unset output
	}
}
