#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# A Meson project outside against what is installed: dependency('plgen') by pkg-config, find_program, a dependency file;
# a model is made anew when its data has changed, and only then. With `subproject` plgen is one of the project's own:
# the same meson.build, the generator built on the way, none of its tests, and nothing of it for the outside.
#
#     meson.sh BUILD SOURCE_ROOT [subproject]
set -u
build=$(cd "$1" && pwd) || exit 99
root=$(cd "$2" && pwd) || exit 99
. "${0%/*}/../tap.sh"
. "$root/tests/install/stage.sh"

inside() {
	unset PKG_CONFIG_PATH
	PATH=$(echo "$PATH" | sed 's/^[^:]*://')
	mkdir -p "$project/subprojects/plgen/tests"
	cp "$source/tests/to.sh" "$project/subprojects/plgen/tests"
	for part in meson.build meson_options.txt LICENSE gen runtime host share models doc; do
		cp -r "$source/$part" "$project/subprojects/plgen"
	done
	printf '[wrap-file]\ndirectory = plgen\n\n[provide]\ndependency_names = plgen\nprogram_names = plgen, plrun\n' \
		>"$project/subprojects/plgen.wrap"
}

# As doc/install.md has it
sed -n '/^```meson/,/^```/p' "$root/doc/install.md" | sed '/^```/d' >"$project/meson.build"
sed -i "s/'drive.spec'/'the models' \/ 'drive.spec'/" "$project/meson.build"
out="$work/out of meson"
case ${3:-} in
	subproject)
		inside
		meson setup "$out" "$project" --force-fallback-for=plgen >log 2>&1 &&
			nice ninja -C "$out" app >>log 2>&1
		result $? 'it builds, without tests and benchmarks'
		PATH=$prefix/bin:$PATH ;;
	*)
		[ "$(wc -l <"$project/meson.build")" -ge 5 ] && meson setup "$out" "$project" >log 2>&1 &&
			ninja -C "$out" >>log 2>&1
		result $? 'it builds' ;;
esac
runs 'a model in double' 200 "$out/app"
makes_again 'Meson' "$out" ninja -C "$out" app
runs 'it has the other matrix' 300 "$out/app"
tap_end
