#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# instructions.sh PLGEN SOURCE_ROOT: a table of the instructions of a step by a Taylor series of fixed order, in float
# on a Cortex-M4F: those that its code has, without what sinf, cosf take; the last column with a tolerance.
set -eu
plgen=$1
root=$2
firmware=$root/tests/firmware
. "$firmware/boards.sh"
board m4f
work=$(mktemp -d "${TMPDIR:-/tmp}/instructions.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM

# count MODEL ORDER [OPTION ...]: of NAME_step and what it calls in its own file
count() {
	model=$1
	order=$2
	shift 2
    "$plgen" --real float --scheme "taylor $order" --prefix counted "$@" -o "$work/model.c" "$root/models/$model.spec" \
		2>"$work/said" || { cat "$work/said" >&2; exit 1; }
	# shellcheck disable=SC2086
	$arm-gcc $optimize $cpu -I"$root/runtime" -c "$work/model.c" -o "$work/model.o"
	$arm-objdump -dr "$work/model.o" | awk '
		/^[0-9a-f]+ <.*>:$/ { f = substr($2, 2, length($2) - 3); next }
		/^ +[0-9a-f]+:/ && !/\.word|R_ARM/ {
			n[f]++
		}
		/R_ARM_THM_(CALL|JUMP24)/ { calls[f] = calls[f] " " $NF }
		function add(f,   i, m, list) {
			if (seen[f]++ || !(f in n)) return
			sum += n[f]
			m = split(calls[f], list, " ")
			for (i = 1; i <= m; i++) if (list[i] ~ /^counted_/) add(list[i])
		}
		END { add("counted_step"); print sum }'
}

echo '| model | order 6 | order 8 | order 8, tolerance 1e-5 |'
echo '| --- | --- | --- | --- |'
for name in pendulum vanderpol quad2dof duffing mathieu; do
	echo "| $name | $(count $name 6) | $(count $name 8) | $(count $name 8 --tolerance 1e-5) |"
done
