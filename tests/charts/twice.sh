#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# twice.sh BUILD ROOT: a few of the jobs of bench/charts/twice.sh, one of each kind: the same bytes twice; and tables
# that are not the same, or are none, are noticed. With LONG=1 in the environment the map of scheme pl, too.
set -u
build=$1 root=$2
. "${0%/*}/../tap.sh"

# twice BUILD FOLDER ARGUMENT...: what it says is in log
twice() {
	(cd "$root" && exec sh bench/charts/twice.sh "$@") >log 2>&1
}

map=
[ -z "${LONG:-}" ] || map=plmap
# shellcheck disable=SC2086
twice "$build" "$work/few" --quick structural $map errors_scs
result $? 'tables and errors without times: the same bytes twice'
for name in first/frame.csv first/integrators.csv ${map:+first/plmap_raw.csv} first/variants/scs.errors \
	second/variants/scs.errors; do
	[ -s "$work/few/$name" ] || echo "no $name"
done >log
grep -q '^[0-9]* [0-9.e-]* [0-9.e-]* ' "$work/few/first/variants/scs.errors" || echo 'errors without scales' >>log
[ ! -s log ]
result $? 'they are there'

# A program that counts its runs in what it writes
mkdir -p "$work/build/bench/charts"
cp "$build/plgen" "$work/build"
for name in integrators frame; do
	cat >"$work/build/bench/charts/$name" <<-EOT
		#!/bin/sh
		for folder; do :; done
		echo run >>"$work/runs"
		[ ! -f "$work/write" ] || wc -l <"$work/runs" >"\$folder/$name.csv"
	EOT
	chmod +x "$work/build/bench/charts/$name"
done
! twice "$work/build" "$work/none" structural && grep -q 'no table' log
result $? 'no table at all is noticed'
touch "$work/write"
! twice "$work/build" "$work/other" structural && grep -q 'frame.csv differ' log
result $? 'a table with other bytes is noticed'
mkdir "$work/mine"
! twice "$build" "$work/mine" structural && [ -d "$work/mine" ]
result $? 'a folder of others is left alone'
tap_end
