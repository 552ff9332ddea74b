# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by tests that are shell scripts, once they have made their paths absolute: a folder of their own, which is the
# current one and goes at the end, and results as TAP. What a command says goes to `log` there; a failure shows the head
# of it. A script ends with `tap_end`. CASE=TEXT in the environment: only results whose name has TEXT in it are told and
# counted.
LC_ALL=C
export LC_ALL
work=$(mktemp -d "${TMPDIR:-/tmp}/plgen.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$work" || exit 99
count=0
failed=0
: >log

# long: whether this is for `make check-long`. merging: for that or for `make check-merge`, not for `make check` alone
long() {
	[ -n "${LONG:-}" ]
}
merging() {
	[ -n "${LONG:-}${MERGE:-}" ]
}

# one_of N: whether `make check` takes what asks: the first of each N that do, where it is merging all
asked=0
one_of() {
	asked=$((asked + 1))
	merging || [ $((asked % $1)) -eq 1 ]
}

# seeds FIRST COUNT: so many from FIRST on, STRIDE in the environment apart
seeds() {
	seq "$1" "${STRIDE:-1}" $(($1 + $2 * ${STRIDE:-1} - 1))
}

# chosen NAME: whether it is one of those that CASE asks for
chosen() {
	case $1 in
		*"${CASE:-}"*) return 0 ;;
	esac
	return 1
}

# result STATUS NAME
result() {
	chosen "$2" || return 0
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
	chosen "$1" || return 0
	count=$((count + 1))
	echo "ok $count - $1 # SKIP $2"
}

# runtime_archive FOLDER: sets `archive` to the runtime as it comes from the build folder (PLRT), or makes it of
# FOLDER/*.c
runtime_archive() {
	archive=${PLRT:-}
	[ -z "$archive" ] || return 0
	mkdir runtime_objects || exit 99
	for file in "$1"/*.c; do
		${CC:-cc} -std=c99 -O1 -fPIC -I"$1" -c "$file" -o "runtime_objects/${file##*/}.o" || exit 99
	done
	archive=$PWD/runtime_objects/plrt.a
	ar rcs "$archive" runtime_objects/*.o || exit 99
}

# python ARGUMENT ...: python3 itself, not what may choose among several, and without the packages of its site, which
# take most of its start
python() {
	: "${python_itself:=$(python3 -c 'import sys; print(sys.executable)')}"
	"$python_itself" -I -S "$@"
}

# main_of NAME [OPTIONS]: sets `main` to what a compiler links as runtime/host/plmain.c of that model, which is compiled
# once for the same options; $root is that of the sources
main_of() {
	main=$work/plmain$(echo "${2-}" | tr -d ' =-').o
	# shellcheck disable=SC2086
	[ -e "$main" ] || ${CC:-cc} ${2-} -I"$root/runtime" -DMODEL=PLMAIN -c "$root/runtime/host/plmain.c" \
		-o "$main" || exit 99
	main="$main -Wl,--defsym=PLMAIN_model=$1_model"
}

tap_end() {
	if [ "$count" -eq 0 ]; then
		echo "Bail out! no case ${CASE:-}"
		exit 99
	fi
	echo "1..$count"
	exit $failed
}
