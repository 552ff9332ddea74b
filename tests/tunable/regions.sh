#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# regions.sh PLGEN SOURCE REAL FILE.cases: models with regions whose matrices tunable params change, each as it is
# written (retuned), and without `tunable` at the values of its line `#there` (plain): regions.c drives both, every
# tenth compiled with sanitizers, with MERGE=1 or LONG=1 in the environment all. Lines `#bad NAME=VALUE ... STATUS`:
# values that NAME_retune refuses; `#by NAME,...`: derivatives by these are compared, too.
plgen=$(realpath "$1")
source=$(realpath "$2")
real=$3
cases=$(realpath "$4")
. "$source/tests/run_cc.sh"
. "$source/tests/tap.sh"
sanitizing="${CC:-cc} -std=c11 -O0 -fsanitize=undefined -fno-sanitize=null,alignment,object-size,pointer-overflow"
sanitizing="$sanitizing -fno-sanitize-recover"
turn=0
awk -f "$source/tests/cases.awk" "$cases" >names
while read -r name; do
	spec=$name.spec
	name=${name}_$real
	compile=$run_cc
	turn=$((turn + 1))
	! merging && [ $((turn % 10)) -ne 3 ] || compile=$sanitizing
	chosen "$name" || continue
	there=$(sed -n 's/^#there //p' "$spec")
	defines=''
	for pair in $there; do
		defines="$defines -D $pair"
	done
	by=$(sed -n 's/^#by //p' "$spec")
	[ -z "$by" ] || by="--sensitivity $by"
	grep -v '^tunable' "$spec" >plain.spec
	awk '/^tunable/ { gsub(/,/, " "); for (i = 2; i <= NF; i++) order[i - 1] = $i; n = NF - 1 }
		/^#there/ { for (i = 2; i <= NF; i++) { split($i, pair, "="); value[pair[1]] = pair[2] } }
		END { printf "#define VALUES "
			for (i = 1; i <= n; i++) printf "%s%s", value[order[i]], i < n ? ", " : "\n" }
		' "$spec" >refused.h
	{
		echo 'static const struct {'
		echo '    int count; const char *name[4]; double value[4]; int status; const char *text;'
		echo '} refused[] = {'
		awk '/^#bad/ { names = values = ""; for (i = 2; i < NF; i++) { split($i, pair, "=");
			names = names (i > 2 ? ", " : "") "\"" pair[1] "\""
			values = values (i > 2 ? ", " : "") pair[2] }
			printf "    {%d, {%s}, {%s}, %s, \"%s\"},\n", NF - 2, names, values, $NF, $2 }' "$spec"
		echo '};'
	} >>refused.h
	float=''
	if [ "$real" = float ]; then
		float='-DREAL_FLOAT'
	fi
	# shellcheck disable=SC2086
	"$plgen" --real "$real" --prefix retuned $by "$spec" -o retuned.c >log 2>&1 &&
		"$plgen" --real "$real" --prefix plain $by $defines plain.spec -o plain.c >>log 2>&1 &&
		{ [ -z "$by" ] || echo '#define HAS_DERIVATIVES' >>refused.h; } &&
		{ ! grep -q ' slopes\[' retuned.h || echo '#define HAS_MATRICES' >>refused.h; } &&
		$compile -I. -I"$source/runtime" -I"$source/tests/emitted" $float "$source/tests/tunable/regions.c" \
			retuned.c plain.c "$source/tests/emitted/tap.c" $PLRT -lm -o regions >>log 2>&1 &&
		./regions >>log 2>&1
	status=$?
	grep '^not ok' log | sed 's/^/# /'
	result $status "$name"
done <names
tap_end
