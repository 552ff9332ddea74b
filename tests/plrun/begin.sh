# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the scripts of this folder, whose arguments are PLRUN PLGEN SOURCE_ROOT: paths, and a cache of their own.
set -u
plrun=$(realpath "$1")
PLGEN=$(realpath "$2")
root=$(realpath "$3")
export PLGEN
. "$root/tests/tap.sh"
XDG_CACHE_HOME=$work/cache
ASAN_OPTIONS=detect_leaks=0             # what lives to the end of the program is not given back
export XDG_CACHE_HOME ASAN_OPTIONS
models=$root/models
# What it compiles has the same bits by tcc, or without an optimiser; with LONG=1 in the environment as a user has it
if [ -z "${LONG:-}" ]; then
	CFLAGS=-O0
	! command -v tcc >log || CC=tcc
	export CC CFLAGS
fi

# plrun with what it says in `said`; a sanitizer's report is no message
run() {
	"$plrun" "$@" 2>said
	status=$?
	if grep -q 'Sanitizer\|runtime error' said; then
		cat said >>log
		return 77
	fi
	return $status
}

# same A B NAME: the same bytes, and some
same() {
	[ -s "$1" ] && cmp "$1" "$2" >>log 2>&1
	result $? "$3"
}
