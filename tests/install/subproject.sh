#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# plgen as a subproject of a Meson project: the same meson.build as against what is installed, with the generator built
# on the way, none of its tests, and nothing of it for the outside.
#
#     subproject.sh BUILD SOURCE_ROOT
set -u
build=$(cd "$1" && pwd) || exit 99
root=$(cd "$2" && pwd) || exit 99
. "${0%/*}/../tap.sh"
. "$root/tests/install/stage.sh"
mkdir -p "$project/subprojects/plgen/tests"
cp "$source/tests/to.sh" "$project/subprojects/plgen/tests"
unset PKG_CONFIG_PATH
PATH=$(echo "$PATH" | sed 's/^[^:]*://')

sed -n '/^```meson/,/^```/p' "$root/doc/install.md" | sed '/^```/d' >"$project/meson.build"
sed -i "s/'drive.spec'/'the models' \/ 'drive.spec'/" "$project/meson.build"
mkdir -p "$project/subprojects/plgen"
for part in meson.build meson_options.txt LICENSE gen runtime host share models doc; do
	cp -r "$source/$part" "$project/subprojects/plgen"
done
printf '[provide]\ndependency_names = plgen\nprogram_names = plgen, plrun\n' >"$project/subprojects/plgen.wrap"
sed -i '1i [wrap-file]\ndirectory = plgen\n' "$project/subprojects/plgen.wrap"
out="$work/out of meson"
meson setup "$out" "$project" --force-fallback-for=plgen >log 2>&1 && nice ninja -C "$out" app >>log 2>&1
result $? 'it builds, without tests and benchmarks'
PATH=$prefix/bin:$PATH
runs 'a model in double' 200 "$out/app"
makes_again 'Meson' "$out" ninja -C "$out" app
runs 'it has the other matrix' 300 "$out/app"
tap_end
