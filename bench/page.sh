#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# page.sh BUILD [NAME...]: pages of models/, in headless Chromium: kB; of a frame with 1000 steps and all pictures the
# processor time [ms] and what it leaves on the heap [kB]. 60 frames a second leave 16.7 ms.
set -e
build=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for spec in models/*.spec; do
	name=$(basename "$spec" .spec)
	[ $# -eq 0 ] || case " $* " in *" $name "*) ;; *) continue ;; esac
	"$build/plgen" --page "$work/$name.html" "$spec" 2>"$work/said"
	node tests/page/page.js frames "$work/$name.html"
done | awk 'BEGIN { printf "%-18s %5s %8s %8s\n", "model", "kB", "ms", "heap" }
	{ printf "%-18s %5s %8s %8s ", $1, $2, $3, $4; for (i = 5; i <= NF; i++) printf " %s", $i; print "" }'
