#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh BUILD: what a row of NAME_run costs, in blocks and step by step, as two compilers make it of plain C with
# several flags, beside what it is to cost and beside memset.
set -e
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/driven.spec" <<'EOF'
model driven
coord body, wheel
input road
400*body'' + 1500*(body' - wheel') + 20000*(body - wheel) = 0
40*wheel'' + 1500*(wheel' - body') + 20000*(wheel - body) + 180000*(wheel - road) = 0
step 0.001
EOF
# SPEC TARGET: at -O2, with the machine's own instructions, with vectors of 512 bits
while read -r spec base native wide; do
	case $spec in models/*) file=$spec ;; *) file=$work/$spec ;; esac
	echo "$spec:"
	: >"$work/builds.h"
	objects=
	while read -r name rows target compiler flags; do
		[ "$target" = none ] && target=0 || eval "target=\$$target"
		command -v $compiler >/dev/null 2>&1 || continue
		[ "$rows" = - ] && option= || option="--rows $rows"
		"$build/plgen" --fast $option --prefix "$name" "$file" >"$work/$name.c"
		$compiler $flags -Iruntime -c "$work/$name.c" -o "$work/$name.o"
		objects="$objects $work/$name.o"
		label="$compiler $flags"
		[ "$rows" = 1 ] && label="$label, by steps"
		echo "X($name, \"$label\", $target)" >>"$work/builds.h"
	done <<-'EOF'
		b_gcc - base gcc -O2
		b_clang - base clang -O2
		b_gcc_native - native gcc -O2 -march=native
		b_clang_native - native clang -O2 -march=native
		b_gcc_wide - wide gcc -O2 -march=native -mprefer-vector-width=512
		b_clang_wide - wide clang -O2 -march=native -mprefer-vector-width=512
		s_gcc 1 none gcc -O2
		s_clang 1 none clang -O2
		s_gcc_native 1 none gcc -O2 -march=native
		s_clang_native 1 none clang -O2 -march=native
	EOF
	gcc -O2 -I"$work" -Iruntime bench/run.c $objects runtime/*.c -lm -o "$work/run"
	"$work/run"
done <<'EOF'
models/sdcs.spec 2.3 1.2 0.9
models/scs.spec 2.3 1.2 0.9
models/sdcsf.spec 4.5 2.2 2.2
models/tuned_floor.spec 3.6 1.6 1.6
driven.spec 6 2.5 2.5
EOF
