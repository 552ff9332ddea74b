#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# cost.sh PLGEN SOURCE: what a step of etdrk4 costs that looks for crossings, beside one of the same model with smooth
# terms in their place, and what a crossing costs: instructions, by callgrind. Two runs over 6 s, one of twice as many
# steps and as many crossings, tell steps and crossings apart. $CC compiles, $PLRT is the runtime.
set -eu
plgen=$(realpath "$1")
source=$(realpath "$2")
PLRT=${PLRT:+$(realpath "$PLRT")}
work=$(mktemp -d "${TMPDIR:-/tmp}/cost.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
awk -f "$source/tests/cases.awk" "$source/tests/series_switching/specs.cases" >names
cat >drive.c <<'END'
#include "m.h"
#include <stdlib.h>
int main(int count, char **argument)
{
	static m s;
	m_init(&s);
	for (long k = count > 1 ? atol(argument[1]) : 0; k > 0; k--)
		m_step(&s);
	return m_status(&s);
}
END

# instructions STEPS: of m.spec over 6 s
instructions() {
	"$plgen" --scheme etdrk4 --step "6/$1" m.spec -o m.c 2>/dev/null
	${CC:-cc} -O2 -I. -I"$source/runtime" -o drive drive.c m.c ${PLRT:-} -lm
	valgrind --tool=callgrind --callgrind-out-file=/dev/null ./drive "$1" 2>&1 |
		awk '/refs/ { gsub(",", "", $NF); print $NF }'
}

# model NAME SMOOTH CROSSINGS: its step with and without the look, its crossing
model() {
	sed "s/^model .*/model m/; s/^scheme.*//; $2" "$1.spec" >m.spec
	plain=$(instructions 6000)
	plain_twice=$(instructions 12000)
	sed 's/^model .*/model m/; s/^scheme.*//' "$1.spec" >m.spec
	cut=$(instructions 6000)
	cut_twice=$(instructions 12000)
	echo "| \`$1\` | $(((plain_twice - plain) / 6000)) | $(((cut_twice - cut) / 6000)) | \
$((((2 * cut - cut_twice) - (2 * plain - plain_twice)) / $3)) |"
}

model drag "s/abs(x')/x'/" 1
model stop_cubic 's/max(x - 0.5, 0)/(x - 0.5)/' 4
model two_gap 's/max(x1 - x2 - 0.1, 0)/(x1 - x2 - 0.1)/' 1
