#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# own.sh [-q] PLGEN SPEC FOLDER [UNTIL] [EVERY]: error against time on any spec, plgen's steps beside what else there
# is; FOLDER/NAME.csv, .svg, .png and a verdict. UNTIL, EVERY [s]: the history's end and the time between outputs;
# without them the spec's step, and 1000 of it or 300 where there are more than 12 states. -q: times are taken once, and
# of plgen's tolerances the least alone, for tests. It may be started from anywhere: `plrun --chart` does. PLGEN_RUNTIME
# names the runtime, where it is not that of the source tree. What plgen refuses is said in its own words, and the exit
# status is 1.
set -e
quick=
[ "$1" != -q ] || { quick=-q; shift; }
plgen=$1 spec=$2 folder=$3 until=$4 every=$5
own=$(dirname "$0")
charts=$own/..
PLGEN_RUNTIME=${PLGEN_RUNTIME:-$charts/../../runtime}
export PLGEN_RUNTIME
cc=${CC:-cc}
[ -f "$spec" ] || { echo "chart: no file $spec" >&2; exit 1; }

# has HEADER: may a program include it?
has() {
	echo "#include <$1>" | $cc -E -x c - >/dev/null 2>&1
}
missing=
has stdio.h && command -v ar >/dev/null || missing="$missing gcc"
has cvode/cvode.h && has arkode/arkode_erkstep.h || missing="$missing libsundials-dev"
has gsl/gsl_odeiv2.h || missing="$missing libgsl-dev"
command -v gnuplot >/dev/null || missing="$missing gnuplot-nox"
if [ -n "$missing" ]; then
	echo "chart: not installed:$missing (as Debian and Ubuntu call what has SUNDIALS, GSL, gnuplot)" >&2
	exit 1
fi
work=$(mktemp -d "${TMPDIR:-/tmp}/own.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
LC_ALL=C.UTF-8
export LC_ALL

# number TEXT: of a decimal or a fraction
number() {
	awk -v text="$1" 'BEGIN { n = split(text, part, "/"); print n == 2 ? part[1]/part[2] : n == 1 ? text + 0 : -1 }'
}

# ---- the model itself ----

if ! "$plgen" --rhs --prefix subject ${every:+--step "$every"} "$spec" >"$work/subject_pl.c" 2>"$work/said"; then
	cat "$work/said" >&2
	echo "chart: plgen refuses the spec, so there is nothing to chart" >&2
	exit 1
fi
if grep -q 'const pl_guard ' "$work/subject_pl.c"; then
	echo "chart: $spec: what bounces is not charted: NAME_rhs has no jumps of velocity," \
		"so no peer follows it and nothing says what is true" >&2
	exit 1
fi
if sed -n 's/^static const int subject_start_samples\[[0-9]*\] = {\(.*\)};.*/\1/p' "$work/subject_pl.c" |
	grep -q '[2-9]'; then
	echo "chart: $spec: inputs that are joined by polynomials of higher degree than 1 are not charted: they" \
		"reach over several outputs, which no step of another method follows" >&2
	exit 1
fi
name=$(sed -n 's/^model[ \t][ \t]*\([A-Za-z0-9_]*\).*/\1/p' "$spec" | sed -n 1p)
[ -n "$every" ] || every=$(sed -n 's/^#define SUBJECT_H \([^ ]*\).*/\1/p' "$work/subject_pl.c")
# of NAME, an enumerator at the head of the code
count_of() {
	sed -n "s/^enum {.*SUBJECT_$1 = \([0-9]*\).*/\1/p" "$work/subject_pl.c"
}
states=$(count_of STATES) inputs=$(count_of INPUTS)
# are its states coordinates, then their velocities in the same order?
second=$(sed -n '/_state_names\[\] = {/{s/.*{//;s/}.*//;s/[ "]//g;p;q;}' "$work/subject_pl.c" | tr , '\n' |
	awk '{ name[NR] = $0 } END { half = NR/2; same = NR % 2 == 0
	       for (i = 1; i <= half; i++) same = same && name[half + i] == name[i] "\047"
	       print same ? 1 : 0 }')
if [ -n "$until" ]; then
	units=$(awk -v every="$(number "$every")" -v end="$(number "$until")" \
		'BEGIN { print every <= 0 || end <= 0 ? 0 : int(end/every + 0.5) }')
else
	units=$([ "$states" -le 12 ] && echo 1000 || echo 300)
fi
if [ "$units" -lt 1 ] || [ "$units" -gt 100000 ]; then
	echo "chart: UNTIL=$until with EVERY=$every are $units outputs; 1 to 100000 can be charted" >&2
	exit 1
fi

# NAME_rhs by itself, so that peers have it inlined; and in long double
awk '/^void subject_rhs\(/ && !/;/ { on = 1 } on { print } on && /^}/ { exit }' "$work/subject_pl.c" |
	sed 's/^void subject_rhs(/INLINE void rhs_double(/' >"$work/rhs_double.h"
sed 's/rhs_double/rhs_long/; s/\([^A-Za-z0-9_]\)double\([^A-Za-z0-9_]\)/\1quad_of_truth\2/g
	s/\([^A-Za-z0-9_]\)double\([^A-Za-z0-9_]\)/\1quad_of_truth\2/g' "$work/rhs_double.h" >"$work/rhs_long.h"

# Of regions, for a peer that knows where they end: how many, and load states at t = 0, which rows of slopes name
awk -v states="$states" '
	/_input_names\[\] = \{/ { input = $0; sub(/.*\{"/, "", input); sub(/".*/, "", input) }
	/^static const double subject_slopes\[/ { split($0, part, /[][]/); regions = part[2]; on = 1 }
	/^#define PL_SEGMENTS [^1]/ { regions = 0 }
	on && /^    \{/ && ++row > states { gsub(/.*\/\* | \*\/$/, ""); load[++loads] = $0 }
	/^  \},/ { on = 0 }
	END { for (i = 1; i <= loads && load[i] != input; i++) {
		words = load[i]
		gsub(/cos|sin|exp|pi|t/, "", words)
		if (words ~ /[a-z^]/) regions = 0
		gsub(/pi/, "M_PI", load[i]); gsub(/\//, "/1.0/", load[i]); gsub(/t/, "0.0", load[i])
		at_0 = at_0 ", " load[i] }
		printf "#define REGIONS %d\n#define LOADS_AT_0 %s\n", regions, substr(at_0, 3) }' "$work/subject_pl.c" \
	>"$work/subject_regions.h"

# ---- plgen's variants ----

sh "$charts/variant.sh" "$plgen" "$work/model.so" "$spec" --step "$every"
sh "$charts/variant.sh" "$plgen" "$work/exact-1.so" "$spec" --step "$every" --scheme exact
kinds='large left'
[ "$states" -gt 12 ] || kinds='small left'
[ ! -f "$work/exact-1.so" ] || kinds=exact
grep -v '^#' "$own/variants" | while IFS='|' read -r method options setting values where; do
	case " $kinds " in *" $where "*) ;; *) continue ;; esac
	[ -z "$quick" ] || [ "$setting" != tolerance ] || values=${values##* }
	for value in $values; do
		file=$(echo "$method-$value" | tr -d ' ,').so
		if [ "$setting" = tolerance ]; then
			value=1e-$value
			echo "'$work/$file' '$spec' --step $every $options --tolerance $value" >>"$work/make"
		else
			echo "'$work/$file' '$spec' --step ($every)/$value $options" >>"$work/make"
		fi
		printf '%s\t%s\t%s\t%s\t%s\n' "$file" "$method" "$setting" "$value" "$options" >>"$work/list"
	done
done
xargs -P "${JOBS:-2}" -L1 sh "$charts/variant.sh" "$plgen" <"$work/make" &
variants=$!
for part in own kept_solvers kept_dop853 kept_radau kept_regions ../table; do
	echo "-c '$own/$part.c' -o '$work/${part#../}.o'"
done | xargs -P "${JOBS:-2}" -L1 $cc -std=gnu11 "${CHARTS_OPTIMIZE:--O2}" -fcx-limited-range -I"$PLGEN_RUNTIME" \
	-I"$own" -I"$work" -DSTATES="$states" -DINPUTS="$inputs" -DSECOND_ORDER="$second"
$cc "$work/own.o" "$work/kept_solvers.o" "$work/kept_dop853.o" "$work/kept_radau.o" "$work/kept_regions.o" \
	"$work/table.o" "${CHARTS_RUNTIME:-$work/runtime.a}" -o "$work/own" \
	-lsundials_cvode -lsundials_arkode -lsundials_nvecserial -lsundials_sunmatrixdense -lsundials_sunlinsoldense \
	-lsundials_sunnonlinsolfixedpoint -lgsl -lgslcblas -lm -ldl
wait $variants

# ---- errors, times, picture ----

"$work/own" $quick "$(number "$every")" "$units" "$work"
mkdir -p "$folder"
mv "$work/own.csv" "$folder/$name.csv"
sh "$charts/table.sh" own_verdict "$folder/$name.csv" >"$folder/$name.txt"
signal=
[ "$inputs" = 0 ] || signal='inputs: sin(2π t/40E) + sin(2π t/17E)/2, E the time between outputs, sampled there'
gnuplot -c "$own/own.gp" "$folder/$name.csv" "$folder" "$name" "$every" "$units" "$folder/$name.txt" "$signal"
echo "$name: $units outputs, one every $every s${signal:+; $signal}"
grep -v '^title:' "$folder/$name.txt"
grep ',refused,' "$folder/$name.csv" | awk -F, -f "$charts/csv.awk" -f "$own/refused.awk"
echo "$folder/$name.svg, $folder/$name.csv"
