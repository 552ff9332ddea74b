#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# archive.sh SOURCE COMPILER OUT: drive.c, CVODE's wrapper and the runtime, with sanitizers, as one archive.
set -eu
source=$1
cc=$2
case $3 in
	/*) out=$3 ;;
	*) out=$PWD/$3 ;;
esac
work=$(mktemp -d "${TMPDIR:-/tmp}/plgen.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
# without what stops anyway at the address where it goes, as in batch.sh
"$cc" -std=gnu11 -O0 -fsanitize=address,undefined -fno-sanitize=null,alignment,object-size,pointer-overflow \
	-fno-sanitize-recover=all -I"$source/runtime" -I"$source/tests/leftover" \
	-c "$source"/runtime/*.c "$source/tests/fuzz/drive.c"
"$cc" -std=gnu11 -O0 -I"$source/tests/leftover" -c "$source/tests/leftover/truth.c"
rm -f "$out"
ar rcsD "$out" ./*.o
