#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What is chosen costs at most 1.1 times the cheapest over every set of modes, with and without their static gain, each
# with every form and precision: driven.spec, and random models of up to six masses.
# exhaustive.sh PLGEN HERE [SEED...]
plgen=$1 here=$2
shift 2
case $plgen in /*) ;; *) plgen=$PWD/$plgen ;; esac
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
bad=0

# cost OPTION...: of what is taken; nothing where the need cannot be met
cost()
{
	"$plgen" "$@" --explain=json spec 2>errors | sed -n 's/.*"taken": true, "cost": \([^,]*\),.*/\1/p'
}

for seed in driven "$@"; do
	if [ "$seed" = driven ]; then
		cp "$here/driven.spec" spec
	else
		awk -v seed="$seed" -f "$here/random.awk" >spec
	fi
	count=$(grep -c '^mass' spec)
	cost >chosen
	cost >costs
	set=1
	while [ $set -lt $(((1 << count) - 1)) ]; do
		list='' mode=1
		while [ $mode -le "$count" ]; do
			[ $(((set >> (mode - 1)) & 1)) -eq 0 ] || list="$list${list:+, }$mode"
			mode=$((mode + 1))
		done
		case $list in *,*) comma='' ;; *) comma=, ;; esac
		cost --modes "$list$comma" >>costs
		cost --modes "$list$comma without static" >>costs
		set=$((set + 1))
	done
	sort -g costs | head -1 | paste -d' ' chosen - | awk -v seed="$seed" '{
		good = $1 > 0 && $2 > 0 && $1 <= 1.1 * $2
		printf "%s - %s: cost %s, by exhaustive search %s\n", good ? "ok" : "not ok", seed, $1, $2
		exit !good
	}' || bad=1
done
exit $bad
