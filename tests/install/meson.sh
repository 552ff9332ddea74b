#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A Meson project outside against what is installed: dependency('plgen') by pkg-config, find_program, a dependency file;
# a model is made anew when its data has changed, and only then.
#
#     meson.sh BUILD SOURCE_ROOT
set -u
build=$(cd "$1" && pwd) || exit 99
root=$(cd "$2" && pwd) || exit 99
. "${0%/*}/../tap.sh"
. "$root/tests/install/stage.sh"

# As doc/install.md has it
sed -n '/^```meson/,/^```/p' "$root/doc/install.md" | sed '/^```/d' >"$project/meson.build"
sed -i "s/'drive.spec'/'the models' \/ 'drive.spec'/" "$project/meson.build"
out="$work/out of meson"
[ "$(wc -l <"$project/meson.build")" -ge 5 ] && meson setup "$out" "$project" >log 2>&1 && ninja -C "$out" >>log 2>&1
result $? 'it builds'
runs 'a model in double' 200 "$out/app"
makes_again 'Meson' "$out" ninja -C "$out"
runs 'it has the other matrix' 300 "$out/app"
tap_end
