#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# variant.sh PLGEN OUT.so SPEC [plgen options]: a model's C as a shared object whose names begin with `subject`,
# compiled as its user would. Run at the top of the source tree, or with PLGEN_RUNTIME. It keeps the options it was made
# with: subject_options. What plgen refuses is a result too: its message goes to OUT.so.refused, no object is left, and
# the exit status is 0.
# CHARTS_OPTIMIZE: another level than -O2, where nothing is timed. CHARTS_RUNTIME: the runtime as an archive that is
# there already, for the same reason. CHARTS_RHS: empty, for models that have no --rhs.
#     -fno-semantic-interposition  gcc may inline subject_step into subject_run, as it does in a program
#     no -march=native, no -ffast-math: for the peers neither
set -e
plgen=$1 out=$2 spec=$3
shift 3
cc=${CC:-cc}
flags="-std=gnu11 ${CHARTS_OPTIMIZE:--O2} -fPIC -fno-semantic-interposition"
headers=${PLGEN_RUNTIME:-runtime}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The runtime once for all variants of a folder; where two make it at the same time, they make the same
runtime=${CHARTS_RUNTIME:-$(dirname "$out")/runtime.a}
if ! [ -f "$runtime" ]; then
	for part in "$headers"/*.c; do
		$cc $flags -I"$headers" -c "$part" -o "$work/$(basename "$part" .c).o"
	done
	ar rcD "$work/runtime.a" "$work"/*.o
	mv "$work/runtime.a" "$runtime.$$"
	mv "$runtime.$$" "$runtime"
fi

rm -f "$out" "$out.refused"
# shellcheck disable=SC2086
if ! "$plgen" --fast --prefix subject ${CHARTS_RHS---rhs} "$@" "$spec" >"$work/subject_pl.c" 2>"$work/messages"; then
	sed -n '/error:/{p;q;}' "$work/messages" >"$out.refused"
	[ -s "$out.refused" ] || sed -n '1p' "$work/messages" >"$out.refused"
	exit 0
fi
printf '\nextern const char subject_options[];\nconst char subject_options[] = "%s";\n' "$*" >>"$work/subject_pl.c"
$cc $flags -shared -Wl,-Bsymbolic -I"$headers" "$work/subject_pl.c" "$runtime" -o "$work/subject.so"
mv "$work/subject.so" "$out"
