#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# map.sh PLGEN LIST FOLDER ...: the struct and the step of every variant in LIST (see ../remainder/variants.sh; the step
# is given, no further options of its own than as=), with each float or double as `wide`, and a table of them with what
# --explain=json says of their drift.
set -eu
plgen=$1
list=$2
shift 2
work=$(mktemp -d "${TMPDIR:-/tmp}/map.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
. "${0%/*}/../made.sh"
specs_of "$@"
grep -v -e '^#' -e '^$' "$list" | while read -r name _ step as options; do
	as=${as#as=}
	# shellcheck disable=SC2086
	"$plgen" --prefix "$as" --step "$step" $options "$work/$name.spec" |
		sed -n -e "/^struct $as {/,/^};/p" -e "/^enum {.*;/p" -e "/^enum {[^;]*\$/,/;/p" \
			-e "/^void ${as}_step($as \*s)\$/,/^}/p" |
		sed -e '/_flush(s); }$/d' -e 's/\<float\>/wide/g' -e 's/\<double\>/wide/g' \
			-e 's/pl_accumulatef*(/wide_accumulate(/' \
			-e "s/^struct $as {/typedef struct $as $as;\\n&/" -e 's/^void/static void/'
	printf 'static void %s_map(wide *y)\n{\n    %s s = {0};\n    memcpy(s.y, y, sizeof s.y);\n' "$as" "$as"
	printf '    %s_step(&s);\n    memcpy(y, s.y, sizeof s.y);\n}\n' "$as"
done
echo 'static const struct map maps[] = {'
grep -v -e '^#' -e '^$' "$list" | while read -r name _ step as options; do
	as=${as#as=}
	# shellcheck disable=SC2086
	drift=$("$plgen" --step "$step" $options --explain=json "$work/$name.spec" |
		sed -n 's/.*"drift_per_step": {"amplitude": \(.*\), "phase": \(.*\)}.*/\1, \2/p')
	echo "    {\"$as\", ${as}_map, ${drift:-NAN, NAN}},"
done
echo '};'
