#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# methods.sh PLGEN METHODS ROOT: the generated code that the program methods looks at, then that program.
set -e
plgen=$(realpath "$1") program=$(realpath "$2") root=$3
work=$(mktemp -d "${TMPDIR:-/tmp}/methods.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$root"
{
	for name in pendulum vanderpol_stiff scs sdcs sdcsf scs_weak linear2dof tuned_floor quarter_car; do
		echo "$work/$name.so models/$name.spec"
	done
	for parts in 256 512; do
		echo "$work/scs-pl-$parts.so models/scs.spec --scheme pl --step 1/5/$parts"
		for scheme in pl etd1; do
			echo "$work/pendulum-$scheme-$parts.so models/pendulum.spec --scheme $scheme --step 2/5/$parts"
		done
	done
	for parts in 32 64; do
		echo "$work/pendulum-etdrk2-$parts.so models/pendulum.spec --scheme etdrk2 --step 2/5/$parts"
	done
	for scheme in etdrk4 nc2 nc3 dq4 bm3; do
		for parts in 8 16; do
			echo "$work/pendulum-$scheme-$parts.so models/pendulum.spec --scheme $scheme --step 2/5/$parts"
		done
	done
	for name in scs sdcs sdcsf scs_weak tuned_floor; do
		echo "$work/$name-exact-1.so models/$name.spec --scheme exact --step 1/100"
	done
	echo "$work/linear2dof-exact-1.so models/linear2dof.spec --scheme exact --step 1/5"
	echo "$work/quarter_car-exact-1.so models/quarter_car.spec --scheme exact --step 1/1000"
} | xargs -P "${JOBS:-2}" -L 1 bench/charts/variant.sh "$plgen"
"$program" "$work" 2>"$work/said" || { status=$?; sed 's/^/# /' "$work/said"; exit $status; }
