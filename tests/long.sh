#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# long.sh PROGRAM ...: runs the tests that `make check` leaves out, prints what failed, and ends with how many did.
set -u
failed=0
output=$(mktemp) || exit 1
trap 'rm -f "$output"' EXIT
for program; do
	if "$program" >"$output" 2>&1; then
		echo "$(basename "$program"): $(grep -c '^ok' "$output") passed"
	else
		echo "$(basename "$program"): failed"
		grep -v '^ok' "$output"
		failed=$((failed + 1))
	fi
done
echo "$# programs, $failed failed"
[ "$failed" -eq 0 ]
