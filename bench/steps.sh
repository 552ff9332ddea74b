#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# steps.sh BUILD [--count] [TOPIC...]: times of steps of a model beside those of the same model with less in it, by what
# happens in them (steps.c). --count: instructions by callgrind, in their place.
#
#     clearances  beside the model without stops          contacts  beside the model without friction and impacts
#     tunable     beside the values written               loads     beside the model without its load
#     words       compensated, beside one word        rows      step by step, beside blocks of rows
#
# CC and CFLAGS in the environment: another compiler than gcc, other flags than -O2.
set -e
build=$1
shift
root=$PWD
. tests/cases.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
counts=
[ "${1:-}" != --count ] || { counts=yes; shift; }
topics=" $* "

# built MODEL SPEC OPTION ...: MODEL_pl.c
built() {
	name=$1 file=$2
	shift 2
	"$build/plgen" --fast --prefix "$name" -o "$work/${name}_pl.c" "$@" "$file" 2>/dev/null
	! grep -q ' segment;' "$work/${name}_pl.h" || printf '#include "%s_pl.h"\nint %s_segment(const void *s);\n\
int %s_segment(const void *s) { return ((const %s *)s)->segment; }\n' "$name" "$name" "$name" "$name" \
		>>"$work/${name}_pl.c"
}

# collected MODEL KIND PARTS: instructions of a sample, and of how many steps; status 1 where the model has no such step
collected() {
	valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=sample "$work/steps" x "$rubs" "$@" \
		2>"$work/log" >"$work/count" && echo "$(sed -n 's/.*Collected : //p' "$work/log") $(cat "$work/count")"
}

# instructions MODEL KIND: of a step, without those of putting states there
instructions() {
	all=$(collected "$@" 1) && none=$(collected "$@" 0) &&
		echo "$all $none" | awk '{ print ($1 - $3) / $2 }'
}

# One that changes its formula
load='(t < 5.312 ? 0.3*cos(t) : t < 10.7 ? 0.1*t : t < 16.1 ? -0.5 : 0.2*sin(2*t))'
# The subject's spec is that of the model by SUBJECT, a script of sed, the plain one's by PLAIN
while IFS='|' read -r topic spec steps rubs subject plain options; do
	case $topics in '  ' | *" $topic "*) ;; *) continue ;; esac
	spec=$(cd "$work" && path_of "$spec.spec")
	sed -e "$subject" -e "s/LOAD/$load/" "$spec" >"$work/subject.spec"
	sed -e "$plain" -e "s/LOAD/$load/" "$spec" >"$work/plain.spec"
	for h in $steps; do
		# Words
		# shellcheck disable=SC2086
		built subject "$work/subject.spec" --step "$h" $options && built plain "$work/plain.spec" --step "$h"
		# shellcheck disable=SC2086
		${CC:-gcc} -std=gnu11 ${CFLAGS:--O2} -Iruntime -Ibench -I"$work" bench/steps.c "$work/subject_pl.c" \
			"$work/plain_pl.c" "$build/libplrt.a" -lm -o "$work/steps"
		label="$topic: $(basename "$spec" .spec), h = $h${options:+, $options}"
		[ "$counts" ] || { "$work/steps" "$label" "$rubs"; continue; }
		echo "$label"
		for kind in 0 1 2 3 4 5 6; do
			of=$(instructions 0 $kind) || continue
			other=$(instructions 1 $kind || instructions 1 0)
			echo "$kind $of $other" | awk '{ printf "    kind %d: %.2f times\n", $1, $2 / $3 }'
		done
	done
done <<'END'
clearances|models/stop|0.001 0.01|0||s/deadzone(x, -b, b)/x/; s/max(x, 0)/x/
clearances|models/bilinear|0.01|0||s/(x > 0 ? k2\*x : k1\*x)/k1*x/
clearances|models/gear1|0.01 0.1|0||s/deadzone(\([a-z]*\), -b, b)/\1/
clearances|models/gear2|0.1 1|0||s/deadzone(\([a-z]*\[1\]\), -b, b)/\1/
clearances|models/gear3|0.001 0.01|0||s/deadzone(\([a-z0-9]*\), -b[0-9]*, b[0-9]*)/\1/
contacts|models/stick_slip|0.001 0.01 0.05|1||s/ + friction(x. - vb, F, S) = / = /; /^output rub/d
contacts|models/impact_oscillator|0.001 0.01 0.05|0||/^stop /d
contacts|models/stick_slip|0.001 0.01 0.05|1|s/F, S) = 0/F, S) = LOAD/|s/ + friction(x. - vb, F, S) = 0/ = LOAD/; /rub/d
tunable|models/stop|0.001 0.01|0|$s/$/\ntunable m, k, ks/|
tunable|models/bilinear|0.01|0|$s/$/\ntunable m, k1, k2/|
tunable|models/gear1|0.01 0.1|0|$s/$/\ntunable zeta, b/|
tunable|models/sdcs|0.01|0|$s/$/\ntunable k2, c1/||--form delta
tunable|tests/tunable/regions/coupled|0.01|0||/^tunable/d
rows|models/sdcs|0.01|0|||--rows 1
rows|models/scs|0.01|0|||--rows 1
rows|models/sdcsf|0.01|0|||--rows 1
rows|models/tuned_floor|0.01|0|||--rows 1
loads|models/sdcsf|0.01|0||s/= F\*cos(w\*t)$/= 0/
loads|models/sdcsf|0.01|0||s/= F\*cos(w\*t)$/= 0/|--refresh 1
words|tests/contacts/lasting_gap|0.01|0|||--accuracy compensated
words|tests/contacts/lasting_pair|0.013|0|||--accuracy compensated
words|models/bilinear|0.01|0|||--accuracy compensated
words|models/gear1|0.01 0.1|0|||--accuracy compensated
words|models/gear2|0.1|0|||--accuracy compensated
words|models/gear3|0.01|0|||--accuracy compensated
words|models/impact_oscillator|0.01|0|||--accuracy compensated
words|models/stick_slip|0.01|0|||--accuracy compensated
END
