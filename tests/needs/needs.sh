#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Random models with needs (random.awk): what is emitted is compiled and run, and at every sample up to the end of the
# need its output is within the bound of the exact one, which --solution gives from residues, correctly rounded.
# needs.sh PLGEN HERE RUNTIME FIRST LAST: those of these seeds
# needs.sh PLGEN HERE RUNTIME drivetrain: models/drivetrain.spec, a scene of parts, with a need
# needs.sh PLGEN HERE RUNTIME beam: the beam of beam.awk, of which at most 6 modes are kept and a third of the cost
plgen=$1 here=$2 runtime=$3 first=$4 last=${5:-}
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
models=$(cd "$here/../../models" && pwd) || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
bad=0 met=0 unmet=0
mkdir objects
for source in "$runtime"/*.c; do
	${CC:-cc} -O1 -ffp-contract=off -w -c "$source" -o "objects/$(basename "$source" .c).o" || exit 1
done
seeds=beam
case $first in
	beam) ;;
	drivetrain) seeds=drivetrain; cp "$models"/*.spec . ;;
	*) seeds=$(seq "$first" "$last") ;;
esac
for seed in $seeds; do
	if [ "$seed" = beam ]; then
		awk -f "$here/beam.awk" >drawn.spec
	elif [ "$seed" = drivetrain ]; then
		sed 's/^model .*/model drawn/; /^output [ec]/d' drivetrain.spec >drawn.spec
		echo 'need drive within 0.1 % until 3' >>drawn.spec
	else
		awk -v seed="$seed" -f "$here/random.awk" >drawn.spec
	fi
	if ! "$plgen" --explain=json drawn.spec >drawn.json 2>errors; then
		if grep -q 'cannot be met' errors; then
			unmet=$((unmet + 1))
		else
			echo "not ok - seed $seed: $(head -1 errors)"
			bad=$((bad + 1))
		fi
		continue
	fi
	end=$(sed -n 's/^need.* until //p' drawn.spec)
	"$plgen" drawn.spec >drawn_pl.c && "$plgen" --solution "$end" drawn.spec | sed 1d >exact.csv &&
		${CC:-cc} -O0 -ffp-contract=off -I"$work" -I"$runtime" -w "$here/run.c" objects/*.o -o run &&
		./run "$(wc -l <exact.csv)" >got || { echo "not ok - seed $seed: no program"; exit 1; }
	sed -n '/"taken": true/s/.*"certified": \([^,]*\), "dropped": \([^,]*\),.*"needed": \([^}]*\)}.*/\1 \3 \2/p' \
		drawn.json >bound
	paste -d' ' got exact.csv | tr , ' ' | awk -v seed="$seed" '
		NR == FNR { bound = $1; needed = $2; dropped = $3; next }
		{ e = $1 - $3; e = e < 0 ? -e : e; if (!(e <= worst)) worst = e; size = $3 > size ? $3 : size }
		END {
			spare = 4.5e-16 * size  # what reading both here rounds
			good = worst <= bound + spare && bound <= needed
			printf "%s - seed %s: error %.3g, bound %.3g, need %.3g, dropped modes %.3g\n",
				good ? "ok" : "not ok", seed, worst, bound, needed, dropped
		}' bound - >line
	cat line
	met=$((met + 1))
	grep -q '^not ok' line && bad=$((bad + 1))
done
if [ "$first" = beam ]; then
	sed -n 's/.*"modes": "\([^"]*\)".*"taken": \([a-z]*\), "cost": \([^,]*\), "excess": \([^,]*\).*/\1 \2 \3 \4/p' \
		drawn.json | awk '
		$1 == "all" && $4 <= 1 && (!all || $3 < all) { all = $3 }
		$2 == "true" { taken = $3; modes = $0 }
		END {
			split(modes, kept, /[- ]/)
			good = kept[1] == 1 && kept[2] <= 6 && 3 * taken <= all
			printf "%s - modes %s-%s of 15 kept, cost %s of %s\n", good ? "ok" : "not ok", kept[1], kept[2],
				taken, all
			exit !good
		}' || bad=1
fi
echo "# $met met, $unmet cannot be met, $bad wrong"
[ $bad -eq 0 ] && [ $met -gt 0 ]
