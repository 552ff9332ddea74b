#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# models.sh ARCHIVE DEPFILE OPTION ... FILE ...: generated models as an archive, compiled only to be run: by tcc, which
# takes a tenth of the time of others and gives the same bits (tests/run/compilers.sh), or where that is not installed
# by cc, not optimised, not contracted and without warnings. Other tests have models compiled by each compiler
# (compilers.sh).
set -eu
archive=$1
depfile=$2
shift 2
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
. "${0%/*}/run_cc.sh"
: >"$depfile"
for file in $files; do
	object=$work/$(basename "$file" .c).o
	# shellcheck disable=SC2086
	$run_cc $options -fPIC -MD -MF "$object.d" -c "$file" -o "$object"
	sed "1s|^[^:]*:|$archive:|" "$object.d" >>"$depfile"
done
rm -f "$archive"
"$ar" rcsD "$archive" "$work"/*.o
finish_archive "$archive" "$work"
