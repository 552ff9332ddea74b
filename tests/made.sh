# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=sh
# Sourced by what makes one file of many models, each $work/NAME.c beside its header, with a line NAME in $work/names.

# specs_of FOLDER ...: specs and their data files to $work, those of FOLDER/specs.cases or FOLDER.cases too; later
# folders do not hide earlier ones
specs_of() {
	[ $# -gt 0 ] || return 0
	(shift && specs_of "$@")
	[ ! -d "$1" ] || cp -R "$1"/. "$work"
	for cases in "$1/specs.cases" "$1.cases"; do
		[ ! -e "$cases" ] || awk -v into="$work/" -f "${0%/*}/../cases.awk" "$cases" >"$work/names"
	done
}

# made ENDING: these files one after the other, but for the lines that include their own header
made() {
	(cd "$work" && sed "s/$/.$1/" names | xargs awk 'FNR == 1 {
		own = "#include \"" substr(FILENAME, 1, length(FILENAME) - 1) "h\""
	}
	$0 != own')
}
