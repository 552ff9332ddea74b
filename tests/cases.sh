# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=sh
# Sourced by what takes specs of the tests by their paths, with $root, the folder of the project.

# path_of FOLDER/NAME.spec: of that file, or of NAME.spec here, as FOLDER/specs.cases or FOLDER.cases has it
path_of() {
	[ ! -e "$root/$1" ] || { echo "$root/$1"; return; }
	for cases in "$root/${1%/*}/specs.cases" "$root/${1%/*}.cases"; do
		[ ! -e "$cases" ] || awk -v only="$(basename "$1" .spec)" -f "$root/tests/cases.awk" "$cases"
	done | sed "s|.*|$PWD/&.spec|"
}
