#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# archive.sh SOURCE COMPILER OUT [RUNTIME.a]: drive*.c, the wrapper of CVODE and the runtime, with sanitizers, as one
# archive; RUNTIME.a: the runtime so, as the build folder has it.
set -eu
source=$1
cc=$2
out=$(realpath "$3")
runtime=${4:-}
case $runtime in
	/* | '') ;;
	*) runtime=$PWD/$runtime ;;
esac
work=$(mktemp -d "${TMPDIR:-/tmp}/plgen.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
set -- "$source"/tests/fuzz/drive*.c
[ -n "$runtime" ] || set -- "$source"/runtime/*.c "$@"
"$cc" -std=gnu11 -O0 -fsanitize=address,undefined -fno-sanitize-recover=all -I"$source/runtime" \
	-I"$source/tests/remainder" -c "$@"
"$cc" -std=gnu11 -O0 -I"$source/tests/remainder" -c "$source/tests/remainder/truth.c"
rm -f "$out"
# the archive of the build folder only names its objects
[ -z "$runtime" ] || ar t "$runtime" | while IFS= read -r object; do cp "$object" .; done
ar rcsD "$out" ./*.o
