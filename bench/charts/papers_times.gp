# SPDX-License-Identifier: GPL-3.0-or-later
# papers_times.gp papers_times.csv OUTDIR: time of a step of pl over that of RK4, beside the ratios that its source
# reports
here = system("dirname '".ARG0."'"); csv = ARG1; out = ARG2
load here.'/style.gp'
unset logscale
set format '%g'
set yrange [0:1.1]
set xrange [-0.6:5.6]
set grid noxtics
set ylabel 'CPU time of 30 s over that of RK4 at the same step [1]'
set title 'Piecewise-Laplace method: time over that of RK4'
set label 1 "reported: Fang and others 2020, with their own programs. measured: compiled C, -O2, no -march=native; ".\
	"RK4 on the generated equations;\na row kept at each step; ".\
	"medians of samples taken in turns. Parameters chosen: the source's did not survive." at screen 0.01,0.05 \
	left font ',9' textcolor rgb '#505050'
set bmargin 7

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
set style fill solid 0.9 border lc rgb 'black'
name = 'papers_times'
plot bars using ($1 - 0.26):3 with boxes fs pattern 4 lc rgb '#404040' title 'pl: reported', \
	'' using 1:4:xtic(stringcolumn(2)) with boxes fs solid 0.9 lc rgb '#000000' title 'pl: measured', \
	'' using ($1 + 0.26):5 with boxes fs solid 0.9 lc rgb '#d00000' title 'exact: measured', \
	'' using ($1 - 0.26):3:(sprintf('%.2f', $3)) with labels offset 0,0.6 font ',9' notitle, \
	'' using 1:4:(sprintf('%.2f', $4)) with labels offset 0,0.6 font ',9' notitle, \
	'' using ($1 + 0.26):5:(sprintf('%.2f', $5)) with labels offset 0,0.6 font ',9' notitle, \
	1 with lines lw 1 dt 2 lc rgb '#00602f' title 'RK4'
eval write
