#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# What is chosen costs at most 1.1 times the cheapest over every set of modes, with and without their static gain, each
# with every form and precision: driven.spec, and random models of up to six masses.
# exhaustive.sh PLGEN HERE [SEED...]
plgen=$(realpath "$1") here=$2
shift 2
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
bad=0

# taken OPTION...: cost of what is taken and its type; nothing where the need cannot be met
taken()
{
	"$plgen" "$@" --explain=json spec 2>errors |
		sed -n 's/.*"real": "\([a-z]*\)".*"taken": true, "cost": \([^,]*\),.*/\2 \1/p'
}

# members SET: how many modes it has
members()
{
	rest=$1 members=0
	while [ "$rest" -gt 0 ]; do
		members=$((members + (rest & 1))) rest=$((rest >> 1))
	done
}

for seed in driven "$@"; do
	if [ "$seed" = driven ]; then
		cp "$here/driven.spec" spec
	else
		awk -v seed="$seed" -f "$here/random.awk" >spec
	fi
	count=$(grep -c '^mass' spec)
	taken >chosen
	cp chosen costs
	# of more modes than a choice in float has there is nothing cheaper
	most=$count
	if grep -q float chosen; then
		most=$("$plgen" --explain=json spec 2>errors |
			sed -n 's/.*"modes": "\([^"]*\)".*"taken": true.*/\1/p' | tr ',' '\n' |
			awk -F- -v all="$count" '
				/all/ { n += all }
				!/all/ { n += NF > 1 ? $2 - $1 + 1 : 1 }
				END { print n }')
	fi
	set=1
	while [ $set -lt $(((1 << count) - 1)) ]; do
		list='' mode=1
		members $set
		while [ $mode -le "$count" ]; do
			[ $(((set >> (mode - 1)) & 1)) -eq 0 ] || list="$list${list:+, }$mode"
			mode=$((mode + 1))
		done
		case $list in *,*) comma='' ;; *) comma=, ;; esac
		if [ $members -le "$most" ]; then
			taken --modes "$list$comma" >>costs
			taken --modes "$list$comma without static" >>costs
		fi
		set=$((set + 1))
	done
	if [ ! -s costs ]; then
		echo "ok - $seed: the need cannot be met by any"
		continue
	fi
	sort -g costs | head -1 | paste -d' ' chosen - | awk -v seed="$seed" '
		{
			good = NF == 4 && $1 <= 1.1 * $3
			printf "%s - %s: cost %s, by exhaustive search %s\n", good ? "ok" : "not ok", seed, $1, $3
			exit !good
		}' || bad=1
done
exit $bad
