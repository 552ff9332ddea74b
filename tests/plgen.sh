# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=sh disable=SC2034,SC2154
# Sourced by tests that are shell scripts of the C that plgen writes: their first argument becomes $plgen, $root is the
# folder of the project, $archive the runtime; specs of tests, C that is compiled only to see its numbers, results.
# Other arguments that are paths are made absolute before, shifted behind this.
set -u
plgen=$(realpath "$1")
root=$(realpath "$root")
. "$root/tests/run_cc.sh"
. "$root/tests/cases.sh"
. "$root/tests/tap.sh"
runtime_archive "$root/runtime"

# selftest_of SPEC REAL: what NAME_selftest returns; "none": it is refused by name
selftest_of() {
	if ! "$plgen" --real "$2" --prefix tested --selftest "$1" -o tested.c 2>log; then
		grep -q 'finds no start\|the step has' log && echo none
		return
	fi
	printf '%s\n' '#include "tested.h"' '#include <stdio.h>' \
		'int main(void) { printf("%g\n", (double)tested_selftest()); }' >tested_main.c
	$run_cc -I. -I"$root/runtime" -o tested tested_main.c tested.c "$archive" -lm >>log 2>&1 && ./tested
}
