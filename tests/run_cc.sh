# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=sh disable=SC2034
# Sourced by what compiles C only to see its numbers. `run_cc` is the compiler with options for that: tcc, which takes a
# tenth of the time of others (tests/run/compilers.sh holds its bits against theirs), or where that is not installed cc
# without optimisation, contraction and warnings. Other options that it is called with are those that both know: -I -D
# -include -c -o -MD -MF -fPIC -l.
if command -v tcc >/dev/null 2>&1; then
	run_cc='tcc -w'
else
	run_cc="${CC:-cc} -std=gnu11 -O0 -ffp-contract=off -w"
fi
# By themselves these load every plugin of the machine, LLVM's too, which takes 30 times as long as their work.
ar=$(command -v gcc-ar || echo ar)
nm=$(command -v gcc-nm || echo nm)

# finish_archive ARCHIVE FOLDER: of objects by run_cc, in the current folder's terms, that another compiler's linker
# takes. Those of tcc need its own library, and do not say that their stack is not for code. FOLDER: for what is passing
finish_archive() {
	[ "$run_cc" = 'tcc -w' ] || return 0
	mkdir "$2/library"
	(
		library=$(tcc -print-search-dirs | sed -n '/^libtcc1:/{n;s/^ *//p;}')
		cd "$2/library" && "$ar" x "$library"
	)
	"$ar" rcsD "$1" "$2"/library/*.o
	objcopy --add-section .note.GNU-stack=/dev/null \
		--set-section-flags .note.GNU-stack=contents,readonly "$1"
}
