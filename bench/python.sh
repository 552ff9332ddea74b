#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# python.sh BUILD: a million steps with all outputs kept by the Python package, beside a C program: ns per step, minima
# of three runs of each in turn
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
PLGEN=$(cd "$build" && pwd)/plgen PLGEN_RUNTIME=$PWD/runtime PYTHONPATH=$PWD/host/python XDG_CACHE_HOME=$work/cache
export PLGEN PLGEN_RUNTIME PYTHONPATH XDG_CACHE_HOME
PYTHONDONTWRITEBYTECODE=1
export PYTHONDONTWRITEBYTECODE
python=
for one in python3 /usr/bin/python3; do
	[ -n "$python" ] || ! "$one" -c 'import numpy' 2>/dev/null || python=$one
done
[ -n "$python" ] || { echo 'no python3-numpy' >&2; exit 1; }
printf "model driven\ncoord x\ninput u\nx'' + 0.2*x' + 40*x = u\nstep 0.001\noutput x\n" >"$work/driven.spec"
cp models/sdcsf.spec models/pendulum.spec "$work"
printf '%-16s%s\n' 'ns per step' '  C: step, out       run  Python: out=   new    blocks   out= / C    blocks / run'
for name in sdcsf driven pendulum; do
	driven=
	[ $name != driven ] || driven=-DDRIVEN
	"$build/plgen" --fast -o "$work/model_pl.c" "$work/$name.spec" 2>"$work/said"
	gcc -O2 $driven -DMODEL=$name -Ibench -Iruntime -I"$work" bench/python.c "$work/model_pl.c" runtime/*.c -lm \
		-o "$work/program"
	for run in 1 2 3; do
		echo "$("$work/program") $("$python" -W ignore bench/python.py "$work/$name.spec")"
	done | awk -v name=$name '
		{ for (i = 1; i <= 5; i++) if (NR == 1 || $i < least[i]) least[i] = $i }
		END { printf "%-16s%14.1f%10.1f%14.1f%6.1f%10.1f%11.2f%16.2f\n", name, least[1], least[2], least[3],
			least[4], least[5], least[3] / least[1], least[5] / least[2] }'
done
