#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#     models.sh PLGEN FOLDER MODELS.h
# The models of delays.c as one header: echo with the delays below, the others beside what they are without a delay.
set -eu
plgen=$1
folder=$2
made=$3
work=$(mktemp -d "${TMPDIR:-/tmp}/delays.XXXXXX")
trap 'rm -rf "$work"' EXIT
: >"$work/all"
mkdir "$work/specs" && awk -v into="$work/specs/" -v names="$work/names" -f "$folder/../cases.awk" "$folder/specs.cases"
add() {         # NAME SPEC EDIT OPTION ...
	name=$1
	spec=$2
	edit=$3
	shift 3
	sed -e "$edit" "$work/specs/$spec.spec" >"$work/$name.spec"
	"$plgen" --prefix "$name" "$@" "$work/$name.spec" >>"$work/all" 2>"$work/said" ||
		{ cat "$work/said" >&2; exit 1; }
}
ramp='s/input u/input u hold first/'
for d in 0.25 0.3 0.04 0.1 1.7 0; do
	mark=$(echo "$d" | tr . _)
	add "held$mark" echo '' -D "d=$d"
	add "ramp$mark" echo "$ramp" -D "d=$d"
done
for d in 0.03 0.1 0.25 0; do
	add "jumps$(echo "$d" | tr . _)" jumps '' -D "d=$d"
done
tunable='s/^param.*/&\
tunable w/'
add tuned echo "$tunable" -D w=2 -D d=0.25
add tuned_ramp echo "$tunable;$ramp" -D w=2 -D d=0.04
add tuned_delay echo "$tunable;s/u(t - d)/u(t - 0.6\/w)/" -D w=2
add other_step echo '' -D d=0.25 --step 0.04
for model in stopped bent; do
	add "$model" "$model" ''
	add "${model}_ramp" "$model" "$ramp"
	add "${model}_plain" "$model" 's/u(t - d)/u/;/^param/d' --step 0.05
	add "${model}_plain_ramp" "$model" "s/u(t - d)/u/;/^param/d;$ramp" --step 0.05
done
mv "$work/all" "$made"
