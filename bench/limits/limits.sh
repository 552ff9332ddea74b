#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# limits.sh [--quick] [--flags] BUILD [FOLDER]: how near generated code comes to what the machine can do. Run at the top
# of the source tree; a table on standard output, with FOLDER also FOLDER/limits.csv. gcc and clang, as far as they are
# there, at -O2 and -O2 -march=native; with --flags at many more.
#
# Bounds, in ns for a step or a row, from latencies and rates measured in the same run, and from operations that the
# code itself counts as it runs (counted.h):
#   chain   the longest chain of operations that wait for each other, as the code is written; a step is handed its state
#           in memory, so its chain goes through a store and a load
#   work    all operations at the rate of the widest vectors
#   store   the outputs, or what a step keeps
#   bound   the largest of them. `times_bound`: the time over it. `times_work`: over work and store alone, which code
#           that takes many rows at a time could come to
set -e
models='scs sdcsf tuned_floor driven chain40'
sets='-O2:-O2 -march=native'
while [ $# -gt 0 ]; do
	case $1 in
	--quick) models='scs sdcsf' ;;
	--flags)
		scalar='-fno-tree-vectorize -fno-tree-slp-vectorize'
		sets="-O2:-O1:-O3:-Os:-O2 $scalar:-O2 -mavx2 -mfma:-O2 -march=native:-O3 -march=native"
		sets="$sets:-O2 -march=native -mprefer-vector-width=512:-O2 -march=native -ffp-contract=off"
		sets="$sets:-O2 -march=native $scalar"
		;;
	*) break ;;
	esac
	shift
done
build=$1 folder=$2
here=bench/limits
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# spec MODEL: those that are no model of models/
spec() {
	case $1 in
	driven)
		sed 's/^model .*/model driven\ninput u hold first/; s/= 0$/= u/' models/sdcs.spec
		;;
	chain40)
		awk 'BEGIN { n = 40; printf "model chain40\nparam m = 1.3, c = 0.7, k = 190\ncoord"
			for (i = 1; i <= n; i++) printf "%s x%d", (i > 1 ? "," : ""), i
			printf "\ninit x1 = 0.01\n"
			for (i = 1; i <= n; i++) {
				printf "m*x%d'\'\''", i
				split("c k", f, " ")
				for (j = 1; j <= 2; j++) {
					d = j == 1 ? "'\''" : ""
					printf " + %s*(%d*x%d%s", f[j], i < n ? 2 : 1, i, d
					if (i > 1) printf " - x%d%s", i - 1, d
					if (i < n) printf " - x%d%s", i + 1, d
					printf ")"
				}
				print " = 0" }
			print "output x1, x20, x40\nstep 0.01" }'
		;;
	*) cat "models/$1.spec" ;;
	esac
}

runtime=$(ls runtime/*.c | grep -v 'f\.c$')

# bounds FILE COUNTS: rows of the table, from the lines of limits.c and of count.cpp
bounds() {
	awk -v model="$model" -v compiler="$compiler" -v flags="$flags" -v outputs="$outputs" -v states="$states" '
	function most(a, b) { return a > b ? a : b }
	function least(a, b) { return a < b ? a : b }
	function row(name, counted, columns, store, through,    m, a, p, any, work, chain, bound, of) {
		m = count[counted, 1]; a = count[counted, 2]
		p = ("fuseds" in machine) ? least(count[counted, 3], m) : 0
		any = least(machine["mixed"], least(machine["adds"], machine["multiplies"]))
		of = machine["multiplies"]
		if ("fuseds" in machine) { any = least(any, machine["fuseds"]); of = least(of, machine["fuseds"]) }
		work = most((m + a - p) * any, m * of) / machine["lanes"]
		chain = count[counted, 5] + through
		store = columns * store / machine["lanes"]
		bound = most(chain, most(work, store))
		printf "%s,%s,%s,%s,%d,%g,%g,%.3f,%.3f,%.3f,%.3f,%.3f,%.2f,%.2f,%.4f\n", model, name, compiler, flags,
			machine["lanes"], m, a, chain, work, store, bound, time[name], time[name] / bound,
			time[name] / most(work, store), machine["add"]
	}
	FNR == NR && $1 == "machine" { machine[$2] = $3; next }
	FNR == NR { time[$2] = $3; next }
	{ for (i = 1; i <= 5; i++) count[$1, i] = $(i + 1) }
	END {
		row("step", "step", states, machine["stores"], machine["forward"])
		row("run", "run", outputs, machine["stores"], 0)
		row("run_to_memory", "run", outputs, machine["memset"], 0)
	}' "$1" "$2"
}

say() {
	printf '%s\n' "$*" >>"$work/limits.csv"
}

say "model,function,compiler,flags,lanes,multiplications,additions,chain_ns,work_ns,store_ns,bound_ns,time_ns,\
times_bound,times_work,add_ns"
mkdir "$work/counted"
for file in $runtime; do
	g++ -x c++ -w -O1 -include $here/counted.h -c "$file" -o "$work/counted/$(basename "$file").o"
done
for model in $models; do
	mkdir "$work/$model"
	spec "$model" >"$work/$model/model.spec"
	"$build/plgen" --fast -o "$work/$model/model_pl.c" "$work/$model/model.spec" 2>/dev/null
	g++ -x c++ -w -O1 -include $here/counted.h -Iruntime -DMODEL="$model" $here/count.cpp \
		"$work/$model/model_pl.c" -x none "$work"/counted/*.o -o "$work/$model/operations"
done

# measured: every model, with this compiler and these flags
measured() {
	rm -f "$work"/*.o
	for file in $runtime; do
		# shellcheck disable=SC2086
		$compiler $flags -w -c "$file" -o "$work/$(basename "$file").o" 2>/dev/null || return 0
	done
	for model in $models; do
		sizes=$(sed -n 's/.*_STATES = \([0-9]*\), .*_OUTPUTS = \([0-9]*\) .*/\1 \2/p' "$work/$model/model_pl.h")
		states=${sizes% *} outputs=${sizes#* }
		# shellcheck disable=SC2086
		$compiler $flags -w -Iruntime -DMODEL="$model" $here/limits.c "$work/$model/model_pl.c" \
			"$work"/*.o -o "$work/near"
		"$work/near" >"$work/times"
		# shellcheck disable=SC2046
		"$work/$model/operations" $(awk '$1 == "machine" { t[$2] = $3 }
			END { print t["add"], t["multiply"], ("fused" in t) ? t["fused"] : -1 }' "$work/times") \
			>"$work/counts"
		bounds "$work/times" "$work/counts" >>"$work/rows"
	done
}

echo "$sets" | tr ':' '\n' >"$work/sets"
for compiler in gcc clang; do
	command -v $compiler >/dev/null 2>&1 || continue
	while read -r flags; do
		measured
	done <"$work/sets"
done
for model in $models; do
	grep "^$model," "$work/rows" >>"$work/limits.csv"
done
echo 'how near to the machine: ns a step or row, and the time over its bound (chain, work or store, the largest);'
echo 'times_work: over work and store alone, what many rows at a time could come to'
tr ',' '\t' <"$work/limits.csv" | awk -F '\t' '{
	printf "%-12s %-14s %-6s %-66s %5s %7s %7s %9s %9s %9s %9s %12s %11s\n", $1, $2, $3, $4, $5, $6, $7, $8, $9,
		$10, $12, $13, $14 }'
awk -F, -v models="$models" '
	NR > 1 && $2 != "run_to_memory" {
		key = $2 "," $3 "," $4
		if (!(key in seen)) { seen[key] = 1; keys[++count] = key }
		time[key, $1] = $12 / $15
	}
	END {
		n = split(models, model, " ")
		for (f = 1; f <= 2; f++) {
			name = f == 1 ? "step" : "run"
			printf "%s, over that of gcc -O2; each time in additions of its own run\n%-66s", name, ""
			for (i = 1; i <= n; i++) printf " %11s", model[i]
			print ""
			for (k = 1; k <= count; k++) {
				split(keys[k], part, ",")
				if (part[1] != name) continue
				printf "%-6s %-59s", part[2], part[3]
				for (i = 1; i <= n; i++) {
					first = time[name ",gcc,-O2", model[i]]
					printf " %11.2f", (first ? time[keys[k], model[i]] / first : 0)
				}
				print ""
			}
		}
	}' "$work/limits.csv"
[ -z "$folder" ] || cp "$work/limits.csv" "$folder/limits.csv"
