#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# contacts.sh BUILD [--count]: time of a step of models with friction and impacts: one that slips or stays clear, one
# that sticks, one with one event, beside the same model without contacts; likewise under a load that changes its
# formula. --count: instructions of two masses with a stop, friction, an impact, by callgrind, in steps without.
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

# built STEP: of $work/model.spec and $work/plain.spec
built() {
	"$build/plgen" --fast --step "$1" --prefix plain -o "$work/plain_pl.c" "$work/plain.spec" 2>/dev/null
	"$build/plgen" --fast --step "$1" --prefix contacts -o "$work/contacts_pl.c" "$work/model.spec" 2>/dev/null
	gcc -std=gnu11 -O2 ${changes:+-D$changes} -Iruntime -I"$work" bench/contacts.c "$work/plain_pl.c" \
		"$work/contacts_pl.c" runtime/*.c -o "$work/contacts" -lm
}

# counted KIND STEPS: instructions of 20 steps of a kind, or of none
counted() {
	valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=sample_each \
		--toggle-collect=sample_plain "$work/contacts" x "$kind" "$@" 2>&1 >/dev/null |
		awk '/Collected/ { print $NF }'
}

if [ "${2:-}" = --count ]; then
	echo '| | without | clear, slips | sticks | slip to stick | an event |'
	echo '| --- | --- | --- | --- | --- | --- |'
	for case in '8*deadzone(x, -1, 1):stop' 'friction(x'"'"', 0.3):friction' ':impact'; do
		kind=${case#*:}
		printf "model m\\ncoord x, z\\ninit x = 0.9, z' = 1\\nx'' + 0.02*x' + 2*x - z + %s = cos(t)\\n\
z'' + 0.02*z' + 2*z - x = 0\\nstep 0.05\\n" "${case%:*}" | sed 's/ +  = / = /' >"$work/model.spec"
		[ "$kind" != impact ] || echo 'stop between x, ground at 0.5 restitution 0.7' >>"$work/model.spec"
		sed -e 's/ + [8f][^=]*) = / = /' -e '/^stop /d' "$work/model.spec" >"$work/plain.spec"
		built 0.05
		without=$(($(counted 5 0) / 20))
		row="| $kind | $without |"
		for k in 0 1 2 3; do
			steps=$([ $k -gt 1 ] && echo 20 || echo 100)
			row="$row $(counted $k 1 | awk -v none="$(counted $k 0)" -v one="$without" -v steps="$steps" '
				{ if ($1 > 0) printf "%.1f", ($1 - none) / steps / one }') |"
		done
		echo "$row"
	done
	exit 0
fi
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
		built "$h"
		"$work/contacts" "$name${changes:+, load changes}, h = $h" "$kind"
	done
done
