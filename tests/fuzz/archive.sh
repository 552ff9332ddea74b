#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# archive.sh SOURCE OUT_GCC OUT_CLANG: drive.c, CVODE's wrapper and the runtime, with sanitizers, as one archive for
# each compiler.
set -eu
source=$1
work=$(mktemp -d "${TMPDIR:-/tmp}/plgen.XXXXXX")
trap 'rm -rf "$work"' EXIT
make_archive() { # CC OUT
	cc=$1
	case $2 in
		/*) out=$2 ;;
		*) out=$PWD/$2 ;;
	esac
	mkdir "$work/$cc"
	(
		cd "$work/$cc"
		"$cc" -std=gnu11 -O0 -fsanitize=address,undefined -fno-sanitize-recover=all -I"$source/runtime" \
			-I"$source/tests/leftover" -c "$source"/runtime/*.c "$source/tests/fuzz/drive.c"
		"$cc" -std=gnu11 -O0 -I"$source/tests/leftover" -c "$source/tests/leftover/truth.c"
		rm -f "$out"
		ar rcsD "$out" ./*.o
	)
}
make_archive gcc "$2"
make_archive clang "$3"
