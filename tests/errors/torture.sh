#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# torture.sh PLGEN LIBRARY EACH SPEC...: each EACH-th allocation and every write of the generator fails once, in turn
# (LIBRARY: fail.c). It exits 1 with a message, leaves the header and the C of before or of now, never a part of one,
# and no temporaries.
set -u
plgen=$(realpath "$1")
library=$(realpath "$2")
each=$3
shift 3
here=$PWD
LC_ALL=C
export LC_ALL
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$work/in" "$work/out" "$work/good" && cd "$work/in" || exit 1
number=0
failed=0

# one KIND AT: a run whose AT-th call of that kind fails
one()
{
	echo before > ../out/m.c
	echo before > ../out/m.h
	LD_PRELOAD=$library FAIL_KIND=$1 FAIL_AT=$2 FAIL_COUNT=$work/count \
		"$plgen" -o ../out/m.c "$name" > ../stdout 2> ../stderr < /dev/null
	status=$?
}

complain()
{
	echo "# $name, $kind $at: $1" >> ../wrong
}

whole()         # FILE: as it was before, or all of the new one
{
	[ "$(head -c 20 "../out/$1")" = before ] || cmp -s "../out/$1" "../good/$1" ||
		complain "$1 is neither as before nor whole"
}

echo "1..$((2 * $#))"
for spec in "$@"; do
	case $spec in /*) ;; *) spec=$here/$spec ;; esac
	cp "$spec" .
	name=${spec##*/}
	"$plgen" -o ../good/m.c "$name" 2> ../stderr || { echo "Bail out! $name: $(head -n 1 ../stderr)"; exit 1; }
	for kind in memory write; do
		: > ../wrong
		one "$kind" 0
		calls=$(cat ../count)
		[ "$status" -eq 0 ] || { at=0; complain "status $status with nothing failing"; }
		step=1
		[ "$kind" = memory ] && step=$each
		at=1
		tried=0
		while [ "$at" -le "$calls" ]; do
			one "$kind" "$at"
			tried=$((tried + 1))
			# the C library does without a buffer of its own: then all is well
			if [ "$kind" = memory ] && [ "$status" -eq 0 ] &&
			   cmp -s ../out/m.c ../good/m.c && cmp -s ../out/m.h ../good/m.h; then
				at=$((at + step))
				continue
			fi
			[ "$status" -eq 1 ] || complain "status $status, expected 1"
			[ "$(grep -c 'error: \(out of memory\|cannot \)' ../stderr)" -eq 1 ] ||
				complain "message: $(head -n 2 ../stderr)"
			[ -s ../stdout ] && complain 'standard output is not empty'
			[ "$(ls -A ../out | tr '\n' ' ')" = 'm.c m.h ' ] ||
				complain "files: $(ls -A ../out | tr '\n' ' ')"
			whole m.c
			whole m.h
			rm -f ../out/*
			at=$((at + step))
		done
		[ "$tried" -gt 2 ] || { at=0; complain "only $tried calls failed"; }
		number=$((number + 1))
		if [ -s ../wrong ]; then
			failed=1
			echo "not ok $number - $name: $tried of $calls calls, $kind"
			head -n 20 ../wrong
		else
			echo "ok $number - $name: $tried of $calls calls, $kind"
		fi
	done
done
[ "$failed" -eq 0 ]
