# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by tests that are shell scripts, once they have made their paths absolute: a folder of their own, which is the
# current one and goes at the end, and results as TAP. What a command says goes to `log` there; a failure shows the head
# of it. A script ends with `tap_end`.
LC_ALL=C
export LC_ALL
work=$(mktemp -d "${TMPDIR:-/tmp}/plgen.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$work" || exit 99
count=0
failed=0
: >log

# result STATUS NAME
result() {
	count=$((count + 1))
	if [ "$1" -eq 0 ]; then
		echo "ok $count - $2"
	else
		echo "not ok $count - $2"
		failed=1
		head -n 12 log | cut -c 1-200 | sed 's/^/# /'
	fi
}

# skip NAME WHY
skip() {
	count=$((count + 1))
	echo "ok $count - $1 # SKIP $2"
}

tap_end() {
	echo "1..$count"
	exit $failed
}
