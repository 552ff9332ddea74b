#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# contacts.sh BUILD: time of a step of models with friction and impacts: one that slips or stays clear, one that sticks,
# one with one event, beside the same model without contacts.
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
echo "friction and impacts, gcc -O2:"
for case in stick_slip:friction impact_oscillator:impacts; do
	name=${case%:*}
	# the same without: friction is left away, the stop too
	sed -e 's/ + friction(x. - vb, F, S) = 0/ = 0/' -e '/^output rub/d' -e '/^stop /d' "models/$name.spec" \
		>"$work/plain.spec"
	for h in 0.001 0.01 0.05; do
		"$build/plgen" --step $h --prefix plain -o "$work/plain_pl.c" "$work/plain.spec" 2>/dev/null
		"$build/plgen" --step $h --prefix contacts -o "$work/contacts_pl.c" "models/$name.spec" 2>/dev/null
		gcc -std=gnu11 -O2 -Iruntime -I"$work" bench/contacts.c "$work/plain_pl.c" "$work/contacts_pl.c" \
			runtime/*.c -o "$work/contacts" -lm
		"$work/contacts" "$name, h = $h" "${case#*:}"
	done
done
