#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Random models with needs (random.awk): what is emitted is compiled and run, and at every sample up to the end of the
# need its output is within the bound of the exact one, which --solution gives from residues, correctly rounded. What
# is certified is at most three times the largest error there is, in the median one and a half times.
# needs.sh PLGEN HERE RUNTIME FIRST LAST: those of these seeds, STRIDE in the environment apart
# needs.sh PLGEN HERE RUNTIME changes: changes.spec, whose load changes its formula; and that its C, which is certified
# as it is written, refuses a compiler that may contract products
# needs.sh PLGEN HERE RUNTIME drivetrain: models/drivetrain.spec, a scene of parts, with a need
# needs.sh PLGEN HERE RUNTIME beam: the beam of beam.awk, of which at most 6 modes are kept and a third of the cost
# PLRT in the environment: the runtime as an archive.
plgen=$(realpath "$1") here=$2 runtime=$3 first=$4 last=${5:-}
models=$(cd "$here/../../models" && pwd) || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
. "$here/../run_cc.sh"
bad=0 met=0 unmet=0
seeds=beam
case $first in
	beam) ;;
	changes) seeds=changes ;;
	drivetrain) seeds=drivetrain; cp "$models"/*.spec . ;;
	*) seeds=$(seq "$first" "${STRIDE:-1}" "$last") ;;
esac
for seed in $seeds; do
	if [ "$seed" = beam ]; then
		awk -f "$here/beam.awk" >drawn.spec
	elif [ "$seed" = changes ]; then
		cp "$here/changes.spec" drawn.spec
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
		$run_cc -I"$work" -I"$runtime" "$here/run.c" "$PLRT" -o run &&
		./run "$(wc -l <exact.csv)" >got || { echo "not ok - seed $seed: no program"; exit 1; }
	sed -n '/"taken": true/{
		s/.*"real": "\([^"]*\)"\(.*\)/\2 \1/
		s/.*"certified": \([^,]*\),.*"dropped": \([^,]*\), "rounding": \([^,]*\),/\1 \2 \3/
		s/ "needed": \([^}]*\)}[^ ]*/ \1/p
	}' drawn.json >bound
	paste -d' ' got exact.csv | tr , ' ' | awk -v seed="$seed" '
		NR == FNR {
			bound = $1; dropped = $2; contracted = $3 == "null" ? 1e99 : $2 + $3; needed = $4; real = $5
			next
		}
		{
			e = $1 - $3; e = e < 0 ? -e : e; if (!(e <= worst)) worst = e
			y = $3 < 0 ? -$3 : $3; size = y > size ? y : size
		}
		END {
			spare = 2.3e-16 * size  # what reading both here rounds
			good = worst <= bound + spare && bound <= needed && bound <= 3 * worst + 3 * spare &&
			       bound <= contracted
			printf "%s - seed %s: error %.3g, bound %.3g, need %.3g, dropped modes %.3g, contracted " \
				"%.3g, %s\n", good ? "ok" : "not ok", seed, worst, bound, needed, dropped,
				contracted, real
		}' bound - >line
	cat line
	cat line >>lines
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
if [ "$first" = changes ]; then
	compile="${CC:-cc} -O0 -ffp-contract=off -D__FP_FAST_FMAF -I$runtime -w -c drawn_pl.c -o object"
	if ! $compile 2>errors && grep -q 'products that are rounded' errors && $compile -DPL_NOT_CONTRACTED &&
		grep -q '"modes": "1-3".*"taken": true' drawn.json; then
		echo "ok - modes 1-3; contraction is refused"
	else
		echo "not ok - modes 1-3; contraction is refused"
		bad=$((bad + 1))
	fi
fi
if [ $met -gt 9 ]; then
	sed 's/.*error \([^,]*\), bound \([^,]*\),.*/\1 \2/' lines |
		awk '{ print ($1 > 0 ? $2 / $1 : 1) }' | sort -g | awk '
		{ ratio[NR] = $1 }
		END {
			median = ratio[int((NR + 1) / 2)]
			printf "%s - certified over error: %.3g in the median, %.3g at most\n",
				median <= 1.5 ? "ok" : "not ok", median, ratio[NR]
			exit !(median <= 1.5)
		}' || bad=$((bad + 1))
fi
echo "# $met met, $unmet cannot be met, $bad wrong"
[ $bad -eq 0 ] && [ $met -gt 0 ]
