#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# check.sh BUILD [OPTION ...]: runs every test, or those that options of `meson test` choose; which cases were skipped;
# a last line counts all.
build=$1
shift
# Passing files are in memory, where there is room and programs run from it: a disk takes a tenth of the time of models.
if [ -z "${TMPDIR:-}" ] && probe=$(mktemp /dev/shm/plgen.XXXXXX 2>/dev/null); then
	echo 'df -Pk "$0" | awk "NR == 2 { exit \$4 < 4e6 }"' >"$probe"
	chmod +x "$probe"
	! "$probe" 2>/dev/null || export TMPDIR=/dev/shm
	rm -f "$probe"
fi
meson test -C "$build" --print-errorlogs "$@"
status=$?
junit=$build/meson-logs/testlog.junit.xml
sed -n '2s/.*<testsuites tests="\([0-9]*\)" errors="\([0-9]*\)" failures="\([0-9]*\)".*/\1 \2 \3/p' \
	"$junit" >"$build/counts"
read -r cases errors failures <"$build/counts" || { cases=1 errors=1 failures=0; }
failed=$((errors + failures))
# A test that died before it could count its cases is a failure too.
if [ "$status" -ne 0 ] && [ "$failed" -eq 0 ]; then
	failed=1
fi
grep '^ok.* # SKIP\|^1\.\.0 # SKIP' "$build/meson-logs/testlog.txt" >"$build/skipped"
skipped=$(wc -l <"$build/skipped")
[ "$skipped" -eq 0 ] || { sed 's/^/skipped: /' "$build/skipped"; echo "$skipped skipped"; }
echo "$((cases - errors - failures - skipped)) passed, $failed failed"
[ "$status" -eq 0 ] && [ "$failed" -eq 0 ]
