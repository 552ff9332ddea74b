#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What is certified of a run that is not walked through: lasting.spec and the same with one mode, in float; and
# as many as are chosen: without what the other one does at once, which the load would miss at every sample.
# lasting.sh PLGEN HERE RUNTIME; PLRT in the environment: the runtime as an archive
plgen=$(realpath "$1") here=$2 runtime=$3
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
bad=0
sed '/^need/d' "$here/lasting.spec" >whole.spec
"$plgen" --prefix whole -o whole_pl.c whole.spec || exit 1
for modes in '--modes 2' '--modes 1' ''; do
	# shellcheck disable=SC2086
	"$plgen" --real float $modes --prefix single -o single_pl.c "$here/lasting.spec" &&
		certified=$("$plgen" --real float $modes --explain=json "$here/lasting.spec" |
			sed -n '/"taken": true/s/.*"certified": \([^,]*\).*/\1/p') &&
		${CC:-cc} -O1 -ffp-contract=off -w -I. -I"$runtime" "$here/lasting.c" single_pl.c whole_pl.c \
			"$PLRT" -lm -o run || exit 1
	./run 2000000 "$certified" || bad=1
done
exit $bad
