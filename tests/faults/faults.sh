#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
# faults.sh [-j COPIES] [-w FOLDER] [--check | --refresh] [NAME ...]: faults of which a suite is known to notice them,
# all or those named.
# A case `=== NAME` of the lists beside this script, TOPIC.cases, is a patch that changes one file of gen, runtime or
# host. Its head says:
#   # suite: TEST            the meson test that has to fail
#   # run: PROGRAM ARGUMENT  only this of it, where the whole takes long: the program by its path in the build folder,
#                            run in the root of the tree
#   # case: ARGUMENT ...     or this is appended to the command of the test
#   # text: TEXT             or only results with this in their names (CASE in the environment)
#   # notice: build          plgen may stop while it writes what the suite is made of; otherwise what does not build
#                            is not noticed
#   # says: ...              what a user would see
# Each is applied to a copy of the tree and taken out again; the suite must pass before and fail with it, and is ended
# where it first does. The seconds told are of processor time. --check: do all apply? --refresh writes the patches anew,
# where lines or files have moved; a line before and behind only where what they take out stands elsewhere too. The
# copies stay in FOLDER, where there is one, for the next time; no two runs at a time may share it.
# faults.sh --first COMMAND ...: a test by TAP, ended where it first fails; for `meson test --wrapper`.
set -u
here=$(cd "$(dirname "$0")" && pwd) || exit 99
root=$(cd "$here/../.." && pwd) || exit 99
LC_ALL=C
export LC_ALL

usage()
{
	echo "usage: faults.sh [-j COPIES] [-w FOLDER] [--check | --refresh] [NAME ...]" >&2
	exit 2
}

# first COMMAND ...: what it prints up to its first failure; it has a session of its own, to be ended whole
first()
{
	pipe=$(mktemp -d "${TMPDIR:-/tmp}/plgen.XXXXXX") || exit 99
	mkfifo "$pipe/tap" || exit 99
	setsid "$@" >"$pipe/tap" &
	test=$!
	trap 'kill -TERM -"$test" 2>/dev/null; rm -rf "$pipe"' EXIT
	trap 'exit 99' HUP INT TERM
	awk '{ print } /^not ok/ && !/# (TODO|SKIP)/ { exit 1 }' "$pipe/tap" || exit 1
	wait "$test"
}

if [ "${1:-}" = --first ]; then
	shift
	first "$@"
	exit
fi

copies=1
folder=
mode=run
while [ $# -gt 0 ]; do
	case $1 in
	-j) [ $# -gt 1 ] || usage; copies=$2; shift ;;
	-w) [ $# -gt 1 ] || usage; folder=$2; shift ;;
	--check) mode=check ;;
	--refresh) mode=refresh ;;
	-*) usage ;;
	*) break ;;
	esac
	shift
done

work=$(mktemp -d "${TMPDIR:-/tmp}/plgen.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
if [ -z "$folder" ]; then
	folder=$work
fi
mkdir -p "$folder" && folder=$(cd "$folder" && pwd) || exit 99

# Each fault as a file of its own
patches=$work/patches
mkdir "$patches" && awk -v into="$patches/" -v kind=patch -v names="$work/names" -f "$here/../cases.awk" \
	"$here"/*.cases || exit 99
if [ $# -eq 0 ]; then
	# shellcheck disable=SC2046
	set -- $(cat "$work/names")
fi
for name; do
	[ -f "$patches/$name.patch" ] || { echo "faults.sh: no fault $name" >&2; exit 2; }
done

# head_of NAME WORD: what the head says of it
head_of()
{
	sed -n "s/^# $2: *//p; /^+++ /q" "$patches/$1.patch"
}

# accepts TREE FILE PATCH: with the context as it is
accepts()
{
	patch -s -f --dry-run -F 0 "$1/$2" "$3" >/dev/null 2>&1
}

# file_of TREE NAME: the file that the patch is for: by its path, by its name in another room, or by what it says
file_of()
{
	wanted=$(sed -n 's|^+++ b/||p' "$patches/$2.patch")
	if accepts "$1" "$wanted" "$patches/$2.patch"; then
		echo "$wanted"
		return
	fi
	for file in $(cd "$1" && { find gen runtime host -name "${wanted##*/}"
		find gen runtime host -name '*.[ch]'; }); do
		if accepts "$1" "$file" "$patches/$2.patch"; then
			echo "$file"
			return
		fi
	done
	return 1
}

# ---- do they apply? ----

# heads NAME ...: of each a line SUITE SAYS FILE, a dash where there is none; by one program, as to start them is what
# takes time
heads()
{
	for name; do
		echo "$patches/$name.patch"
	done | xargs awk 'FNR == 1 { tell(); suite = says = file = "-" }
		/^# suite: *[^ ]/ && file == "-" { suite = $3 }
		/^# says: *[^ ]/ && file == "-" { says = "says" }
		/^\+\+\+ b\// && file == "-" { file = substr($0, 7) }
		function tell() { if (NR > 1) print suite, says, file }
		END { NR++; tell() }'
}

# As TAP, for the tests that `make check` runs.
check_all()
{
	number=0
	failed=0
	echo "1..$#"
	heads "$@" >"$work/heads"
	while read -r suite says file; do
		name=$1
		shift
		number=$((number + 1))
		why=
		[ "$suite" != - ] || why='its head names no suite'
		[ "$says" != - ] || why='its head says nothing'
		accepts "$root" "$file" "$patches/$name.patch" || [ -n "$(file_of "$root" "$name")" ] ||
			why='it applies to no file'
		if [ -z "$why" ]; then
			echo "ok $number - $name"
		else
			echo "not ok $number - $name"
			echo "# $why"
			failed=1
		fi
	done <"$work/heads"
	[ $# -eq 0 ] || failed=1
	return $failed
}

# unmistakable PATCH: whether it takes out lines, each of which stands only once in what can be changed
unmistakable()
{
	sed -n '/^@@ /,$s/^-//p' "$1" >"$work/lines"
	[ -s "$work/lines" ] && while IFS= read -r line; do
		[ "$(grep -cxF -e "$line" "$work/sources")" -eq 1 ] || return 1
	done <"$work/lines"
}

# refresh NAME: the same fault, as a patch of the tree as it is
refresh()
{
	file=$(file_of "$root" "$1") || { echo "$1: applies to no file"; return 1; }
	cp "$root/$file" "$work/old" && cp "$work/old" "$work/new" || return 1
	patch -s -f -F 0 "$work/new" "$patches/$1.patch" || return 1
	around=1
	! unmistakable "$patches/$1.patch" || around=0
	sed '/^\(---\|+++\) /,$d' "$patches/$1.patch" >"$work/patch"
	diff -U "$around" --label "a/$file" --label "b/$file" "$work/old" "$work/new" | sed 1d >>"$work/patch"
	cmp -s "$work/patch" "$patches/$1.patch" || { cp "$work/patch" "$patches/$1.patch" && echo "$1: $file"; }
}

# refresh_all NAME ...: and then the lists, of what they have
refresh_all()
{
	(cd "$root" && find gen runtime host -name '*.[ch]' -exec cat {} +) >"$work/sources"
	for name; do
		refresh "$name"
	done
	for list in "$here"/*.cases; do
		sed -n 's/^=== //p' "$list" | while read -r name; do
			echo "=== $name"
			cat "$patches/$name.patch"
		done >"$work/list"
		cmp -s "$work/list" "$list" || cp "$work/list" "$list"
	done
}

# ---- are they noticed? ----

# make_copy FOLDER: all but builds, those files newer that differ
make_copy()
{
	mkdir -p "$1" || return 1
	(cd "$root" && for entry in *; do
		if [ -f "$entry/build.ninja" ] || [ -f "$entry/index.html" ]; then
			continue
		elif [ -e "$1/$entry" ]; then
			diff -rq "$entry" "$1/$entry" |
				sed -n 's/^Files \(.*\) and .* differ$/\1/p; s|^Only in \([^/].*\): |\1/|p'
		else
			echo "$entry"
		fi
	done) >"$1.entries"
	(cd "$root" && tar cf - -T "$1.entries") | (cd "$1" && tar xmf -) || return 1
	[ -f "$1/build/build.ninja" ] ||
		meson setup -Dtests=enabled -Dbuildtype=plain -Doptimization=0 "$1/build" "$1" >"$1.log" 2>&1
}

# run_suite COPY NAME LOG: 0 passes, 1 fails, 2 does not build
run_suite()
{
	suite=$(head_of "$2" suite)
	program=$(head_of "$2" run)
	if [ -n "$program" ]; then
		ninja -C "$1/build" "${program%% *}" >"$3" 2>&1 || return 2
		(cd "$1" && eval "timeout 300 build/$program") >>"$3" 2>&1 && return 0
		return 1
	fi
	CASE=$(head_of "$2" text) timeout 600 meson test -C "$1/build" --setup all --timeout-multiplier 5 \
		--print-errorlogs "$suite" --wrapper="sh $here/faults.sh --first" \
		--test-args="$(head_of "$2" case)" >"$3" 2>&1
	case $? in
	0) ! grep -q '^Skipped: *[1-9]' "$3" ;;         # by a case that there is not
	125) return 2 ;;
	*) return 1 ;;
	esac
}

# passes_without COPY NAME: once for each way to call a suite
passes_without()
{
	key=$(for word in suite run case text; do head_of "$2" "$word"; done)
	key=$work/passed.$(printf '%s' "$key" | tr -c 'a-zA-Z0-9_.-' '_')
	if [ ! -f "$key" ]; then
		run_suite "$1" "$2" "$key.log"
		echo $? >"$key"
	fi
	[ "$(cat "$key")" -eq 0 ] || { cp "$key.log" "$1.log"; return 1; }
}

# verdict COPY NAME: a word or two
verdict()
{
	passes_without "$1" "$2" || { echo "SUITE FAILS WITHOUT IT"; return; }
	file=$(file_of "$1" "$2") || { echo "APPLIES TO NO FILE"; return; }
	cp "$1/$file" "$1.kept"
	patch -s -f -F 0 "$1/$file" "$patches/$2.patch"
	run_suite "$1" "$2" "$1.log"
	case $?$(head_of "$2" notice) in
	1 | 1build) echo noticed ;;
	2build) [ -n "$(find "$1/build/plgen" -newer "$1.kept")" ] && echo noticed || echo "DOES NOT COMPILE" ;;
	2) echo "DOES NOT BUILD" ;;
	*) echo "NOT NOTICED" ;;
	esac
	cp "$1.kept" "$1/$file"
}

# spent FILE ...: processor time of children by what `times` wrote to FILE; of a second less that of the first. A
# command that is substituted has waited for none.
spent()
{
	awk 'FNR == 2 { split($1 " " $2, p, /[ms ]+/); last = p[1] * 60 + p[2] + p[3] * 60 + p[4] - last }
		END { printf "%.1f", last }' "$@"
}

# one NAME COPY
one()
{
	times >"$2.begin"
	is=$(verdict "$2" "$1")
	times >"$2.end"
	printf '%-32s %-24s %s, %s s\n' "$1" "$(head_of "$1" suite)" "$is" "$(spent "$2.begin" "$2.end")"
	echo "$is" >"$work/verdict.$1"
	if [ "$is" != noticed ]; then
		tail -n 20 "$2.log" | cut -c 1-200 | sed 's/^/    /'
	fi
}

# worker COPY SUITE-LIST: takes a suite that nobody took, and all its faults; first each way to call it without them,
# so that what has no fault is built once
worker()
{
	copy=$1
	suites=$2
	make_copy "$copy" || { echo "faults.sh: no copy $copy" >&2; cat "$copy.log" >&2; return 1; }
	for suite in $suites; do
		mkdir "$work/taken.$suite" 2>/dev/null || continue
		faults=$(awk -v suite="$suite" '$2 == suite { print $1 }' "$work/suites")
		for name in $faults; do
			passes_without "$copy" "$name"
		done
		for name in $faults; do
			one "$name" "$copy"
		done
	done
}

run_all()
{
	start=$(date +%s)
	heads "$@" | while read -r suite _; do
		echo "$1 $suite"
		shift
	done >"$work/suites"
	suites=$(cut -d ' ' -f 2 "$work/suites" | sort | uniq -c | sort -rn | awk '{ print $2 }')
	number=1
	workers=
	while [ "$number" -le "$copies" ]; do
		worker "$folder/copy$number" "$suites" &
		workers="$workers $!"
		number=$((number + 1))
	done
	trap 'kill $workers; exit 99' HUP INT TERM
	wait
	noticed=0
	for name; do
		[ "$(cat "$work/verdict.$name" 2>/dev/null)" != noticed ] || noticed=$((noticed + 1))
	done
	times >"$work/times"
	echo "$noticed of $# noticed, $(($(date +%s) - start)) seconds, of processor time $(spent "$work/times")"
	[ "$noticed" -eq $# ]
}

case $mode in
check) check_all "$@" ;;
refresh) refresh_all "$@" ;;
run) run_all "$@" ;;
esac
