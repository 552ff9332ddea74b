#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# valgrind.sh PLGEN CASES SPEC...: each spec, good or bad, under valgrind, as TAP: no invalid access, no use of what was
# never set, nothing leaked. A name without a folder is that of a case of ../errors.
set -u
plgen=$1
cases=$2
shift 2
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$work/cases" || exit 1
if ! command -v valgrind > "$work/path" 2>&1; then
	echo '1..0 # SKIP no valgrind'
	exit 0
fi
echo "1..$#"
number=0
failed=0
for spec; do
	number=$((number + 1))
	case $spec in
	*/*) ;;
	*) "$cases" --write "$work/cases" "$spec" && spec=$(echo "$work"/cases/*/"$spec/$spec.spec") || exit 1 ;;
	esac
	valgrind -q --leak-check=full --show-leak-kinds=all --errors-for-leak-kinds=all --error-exitcode=9 \
		--log-file="$work/log" \
		"$plgen" --rhs "$spec" > "$work/out" 2> "$work/err" < /dev/null
	status=$?
	if [ "$status" -le 1 ] && ! [ -s "$work/log" ]; then
		echo "ok $number - ${spec##*/}: status $status"
	else
		failed=$((failed + 1))
		echo "not ok $number - ${spec##*/}: status $status"
		head -n 30 "$work/log" | tr '\000-\010\013-\037\177-\377' '?' | sed 's/^/# /'
	fi
done
[ "$failed" -eq 0 ]
