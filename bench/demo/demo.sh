#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# demo.sh BUILD: from a spec to a plot, as a user would do it by hand.
set -e
build=$1
out=$build/demo
mkdir -p "$out"
say() { printf '\n\033[1m%s\033[0m\n' "$*"; }

say '1. The model: models/sdcsf.spec'
grep -v '^#' models/sdcsf.spec

say "2. Generate C:   plgen models/sdcsf.spec > sdcsf_pl.c"
"$build/plgen" models/sdcsf.spec >"$out/sdcsf_pl.c"
sed -n '1,/ \*\/$/p' "$out/sdcsf_pl.c"

say '3. Compile it with the runtime and step it for 30 s'
echo 'cc -O2 -Iruntime runtime/host/plmain.c sdcsf_pl.c runtime/*.c -DMODEL=sdcsf -o sdcsf && ./sdcsf 30 > sdcsf.csv'
${CC:-cc} -O2 -Iruntime runtime/host/plmain.c "$out/sdcsf_pl.c" runtime/*.c -DMODEL=sdcsf -o "$out/sdcsf"
"$out/sdcsf" 30 >"$out/sdcsf.csv"
head -n 6 "$out/sdcsf.csv"
echo "... $(($(wc -l <"$out/sdcsf.csv") - 1)) rows"

say '4. Compare'
"$build/plgen" --solution 30 models/sdcsf.spec >"$out/solution.csv"
closed=$(paste -d, "$out/sdcsf.csv" "$out/solution.csv" | awk -F, '
	function abs(x) { return x < 0 ? -x : x }
	NR > 1 { for (i = 2; i <= NF / 2; i++) {
		d = abs($i - $(i + NF / 2)); if (d > diff[i]) diff[i] = d
		if (abs($i) > top[i]) top[i] = abs($i) } }
	END { for (i in diff) if (diff[i] / top[i] > worst) worst = diff[i] / top[i]; printf "%.2e", worst }')
cvode=$("$build/bench/demo_cvode" 30)
echo "largest deviation over 30 s, relative to the largest value of each component:"
echo "    from the closed form (plgen --solution 30):          $closed"
echo "    from SUNDIALS CVODE on the equations (rtol 1e-12):   $cvode"

say '5. Draw'
"$build/plgen" --explain=json models/sdcsf.spec |
	sed -n 's/.*"re": \([^,]*\), "im": \([^,]*\),.*/\1 \2/p' >"$out/poles.dat"
gnuplot -e "out='$out'" bench/demo/demo.gp
for file in displacement.svg poles.svg sdcsf.csv sdcsf_pl.c; do
	echo "    $out/$file"
done
