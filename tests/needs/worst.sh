#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What is certified for any input within a bound is attained by one: driven.spec, held and as a ramp. Of one mode the
# largest value is known in closed form: gain.spec.
# worst.sh PLGEN HERE RUNTIME; PLRT in the environment: the runtime as an archive
plgen=$(realpath "$1") here=$2 runtime=$3
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
bad=0
for hold in held ramp; do
	if [ $hold = ramp ]; then
		sed 's/^input u/input u hold first/' "$here/driven.spec" >driven.spec
	else
		cp "$here/driven.spec" .
	fi
	sed '/^need/d' driven.spec >whole.spec
	"$plgen" --real double --prefix chosen -o chosen_pl.c driven.spec &&
		"$plgen" --real double --prefix whole -o whole_pl.c whole.spec &&
		${CC:-cc} -O1 -w -I. -I"$runtime" "$here/worst.c" chosen_pl.c whole_pl.c "$PLRT" -lm -o $hold ||
		exit 1
	certified=$("$plgen" --real double --explain=json driven.spec |
		sed -n '/"taken": true/s/.*"certified": \([^,]*\).*/\1/p')
	./$hold 2000 3 "$certified" || bad=1
done
"$plgen" --explain=json "$here/gain.spec" | sed -n '/"taken": true/s/.*"needed": \([^}]*\)}.*/\1/p' | awk '{
	angle = 3.14159265358979 * 0.05 / (2 * sqrt(1 - 0.05 * 0.05))
	closed = 2 * 3 / 100 * (exp(angle) + exp(-angle)) / (exp(angle) - exp(-angle))
	good = $1 > 0.9998 * closed && $1 < 1.0001 * closed
	printf "%s - the largest of one mode: %.9g, in closed form %.9g\n", good ? "ok" : "not ok", $1, closed
	exit !good
}' || bad=1
exit $bad
