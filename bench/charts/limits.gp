# SPDX-License-Identifier: GPL-3.0-or-later
# limits.gp limits.csv OUTDIR: time of a step and of a row over what the machine allows, by compiler and flags
here = system("dirname '".ARG0."'"); csv = ARG1; out = ARG2
size = '1000,640'
load here.'/style.gp'
name = 'limits'
unset logscale x
set format x '%g'
set format y '%g'
set yrange [0.8:*]
set ytics (1, 1.5, 2, 3, 5, 10, 20, 50, 100)
set ylabel 'time over bound [1]'
set title 'How near generated code comes to the machine'
set xtics rotate by -40 left ()
set bmargin 9
eval note." 'Filled: bound by chains of operations as the code is written, by their number or by stores, the ".\
	"largest.\n".\
	"Open: by number and stores alone, what many rows at a time could come to. Least of short samples in ".\
	"turn with the machine itself;\n".\
	"work on integers, as phases of loads take, is in no bound.' at screen 0.01,0.065"

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
native = '-O2 -march=native'
plot 1 with lines lw 1.5 dt 2 lc rgb '#00602f' title 'the machine', \
	where('gcc', '-O2', '-0.24') using 1:3 with points pt 7 ps 1.1 lc rgb '#000000' title 'gcc -O2', \
	'' using 1:4 with points pt 6 ps 1.1 lc rgb '#000000' notitle, \
	where('gcc', native, '-0.08') using 1:3 with points pt 5 ps 1.1 lc rgb '#d00000' title 'gcc native', \
	'' using 1:4 with points pt 4 ps 1.1 lc rgb '#d00000' notitle, \
	where('clang', '-O2', '0.08') using 1:3 with points pt 9 ps 1.2 lc rgb '#0060ad' title 'clang -O2', \
	'' using 1:4 with points pt 8 ps 1.2 lc rgb '#0060ad' notitle, \
	where('clang', native, '0.24') using 1:3 with points pt 13 ps 1.2 lc rgb '#b07000' title 'clang native', \
	'' using 1:4 with points pt 12 ps 1.2 lc rgb '#b07000' notitle
eval write
