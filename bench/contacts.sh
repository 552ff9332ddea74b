#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# contacts.sh BUILD: time of a step of models with friction and impacts: one that slips or stays clear, one that sticks,
# one with one event, beside the same model without contacts; likewise under a load that changes its formula.
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
echo "friction and impacts, gcc -O2:"
load="(t < 5.312 ? 0.3*cos(t) : t < 10.7 ? 0.1*t : t < 16.1 ? -0.5 : 0.2*sin(2*t))"
for case in stick_slip:friction: impact_oscillator:impacts: stick_slip:friction:CHANGES; do
	name=${case%%:*}
	kind=${case#*:}
	kind=${kind%:*}
	changes=${case##*:}
	sed "${changes:+s/F, S) = 0/F, S) = $load/}" "models/$name.spec" >"$work/model.spec"
	# the same without: friction is left away, the stop too
	sed -e 's/ + friction(x. - vb, F, S) = / = /' -e '/^output rub/d' -e '/^stop /d' "$work/model.spec" \
		>"$work/plain.spec"
	for h in 0.001 0.01 0.05; do
		"$build/plgen" --fast --step $h --prefix plain -o "$work/plain_pl.c" "$work/plain.spec" 2>/dev/null
		"$build/plgen" --fast --step $h --prefix contacts -o "$work/contacts_pl.c" "$work/model.spec" \
			2>/dev/null
		gcc -std=gnu11 -O2 ${changes:+-D$changes} -Iruntime -I"$work" bench/contacts.c "$work/plain_pl.c" \
			"$work/contacts_pl.c" runtime/*.c -o "$work/contacts" -lm
		"$work/contacts" "$name${changes:+, load changes}, h = $h" "$kind"
	done
done
