# SPDX-License-Identifier: GPL-3.0-or-later
# limits.csv: time of a step and of a row over what the machine allows, by compiler and flags
here = system("dirname '".ARG0."'"); folder = ARG1; out = ARG2; narrow = 0
size = '900,620'
load here.'/style.gp'
csv = folder.'/limits.csv'
name = 'limits'
unset logscale x
set format x '%g'
set format y '%g'
set yrange [0.8:*]
set ytics (1, 1.5, 2, 3, 5, 10, 20, 50, 100)
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
