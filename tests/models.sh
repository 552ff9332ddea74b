#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# models.sh ARCHIVE DEPFILE OPTION ... FILE ...: generated models as an archive, not optimised and without warnings, by
# clang, which takes a third of gcc's time for them, or where that is not installed by cc. Other tests have them
# compiled by each compiler (compilers.sh). Not contracted, as gcc without optimisation has them.
set -eu
archive=$1
depfile=$2
shift 2
cc=clang
command -v clang >/dev/null 2>&1 || cc=${CC:-cc}
options=
files=
for word; do
	case $word in
		*.h) ;;
		*.c) files="$files $word" ;;
		*) options="$options $word" ;;
	esac
done
work=$(mktemp -d "${TMPDIR:-/tmp}/plgen.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
: >"$depfile"
for file in $files; do
	object=$work/$(basename "$file" .c).o
	# shellcheck disable=SC2086
	$cc -std=gnu11 -O0 -ffp-contract=off -fPIC -w $options -MD -MQ "$archive" -MF "$object.d" -c "$file" \
		-o "$object"
	cat "$object.d" >>"$depfile"
done
rm -f "$archive"
ar rcsD "$archive" "$work"/*.o
