# SPDX-License-Identifier: GPL-3.0-or-later
# papers_times.csv: time of a step of pl over that of RK4, beside the ratios that its source
# reports
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = 0
load here.'/style.gp'
csv = folder.'/papers_times.csv'
unset logscale
set format '%g'
set yrange [0:1.1]
set xrange [-0.6:5.6]
set grid noxtics
set ylabel 'CPU time of 30 s over that of RK4 at the same step [1]'
set key inside top left
number = "font ',10' textcolor rgb '#202020'"
name = 'papers_times'; eval heading
set bmargin 3.5
set yrange [0:1.35]

# model and step; reported; measured pl; measured exact
bars = "< awk 'function cut(line, f,   n, c, i, q, t) { n = 0; t = \"\"; q = 0; for (i = 1; i <= length(line); i++) ".\
	"{ c = substr(line, i, 1); ".\
	"if (c == \"\\\"\") q = !q; else if (c == \",\" && !q) { f[++n] = t; t = \"\" } else t = t c } f[++n] = t } ".\
	"{ cut($0, f) } f[1] == \"000\" { h = f[4]; sub(/.*h = /, \"\", h); key = f[2] \"\\\\nh = \" h; ".\
	"if (!(key in seen)) { seen[key] = ++n; name[n] = key } ".\
	"if (f[3] == \"pl\") { reported[seen[key]] = f[5]; ".\
	"pl[seen[key]] = f[6] } if (f[3] == \"exact\") exact[seen[key]] = f[6] } ".\
	"END { for (i = 1; i <= n; i++) print i - 1, name[i], reported[i], pl[i], exact[i] }' OFS=, '".csv."'"
set boxwidth 0.24
set xtics scale 0
set style fill solid 0.9 border lc rgb '#8e8e96'
plot bars using ($1 - 0.26):3 with boxes fs pattern 4 lc rgb '#6a6f78' title 'pl: reported', \
	'' using 1:4:xtic(stringcolumn(2)) with boxes fs solid 0.9 lc rgb '#c48600' title 'pl: measured', \
	'' using ($1 + 0.26):5 with boxes fs solid 0.9 lc rgb '#be3028' title 'exact: measured', \
	'' using ($1 - 0.26):3:(sprintf('%.2f', $3)) with labels offset 0,0.6 @number notitle, \
	'' using 1:4:(sprintf('%.2f', $4)) with labels offset 0,0.6 @number notitle, \
	'' using ($1 + 0.26):5:(sprintf('%.2f', $5)) with labels offset 0,0.6 @number notitle, \
	1 with lines lw 1 dt 2 lc rgb '#5c9a52' title 'RK4'
eval write
