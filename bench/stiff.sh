#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# stiff.sh BUILD: stiff models whose state chooses formulas, by radau and auto beside CVODE's BDF with root finding.
set -e
build=$1
root=$PWD
. tests/cases.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
for name in pressed flipping braked; do
	spec=$(cd "$work" && path_of "tests/series_switching/$name.spec")
	for case in radau:4 radau:7 radau:10 radau:13 auto:4 auto:7 auto:10; do
		scheme=${case%:*}
		digits=${case#*:}
		prefix=${name}_$scheme$digits
		"$build/plgen" --fast --prefix "$prefix" --scheme "$scheme" --tolerance "1e-$digits" \
			-o "$work/${prefix}_pl.c" "$spec" 2>/dev/null
		echo "extern const pl_model ${prefix}_model;" >>"$work/declared"
		echo "	{\"$name\", \"$scheme\", $digits, &${prefix}_model}," >>"$work/table"
	done
done
{
	printf '#include "plrt.h"\n#include <string.h>\n'
	cat "$work/declared"
	printf 'static const struct { const char *name, *scheme; int digits; const pl_model *model; } models[] = {\n'
	cat "$work/table"
	printf '};\nstatic const pl_model *stiff_model(const char *name, const char *scheme, int digits)\n'
	printf '{\n\tint i = 0;\n\twhile (strcmp(models[i].name, name) || strcmp(models[i].scheme, scheme) ||\n'
	printf '\t       models[i].digits != digits)\n\t\ti++;\n\treturn models[i].model;\n}\n'
} >"$work/stiff_models.h"
gcc -std=gnu11 -O2 -Iruntime -Ibench -I"$work" bench/stiff.c "$work"/*_pl.c runtime/*.c -o "$work/stiff" \
	-lsundials_cvode -lsundials_nvecserial -lm
"$work/stiff"
