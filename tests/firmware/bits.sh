#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The same bits on an emulated board as on this host, from the same sources.
#
#     bits.sh BOARD VARIANTS_double.c VARIANTS_float.c HOST_PROGRAM RUNTIME.a SOURCE_ROOT STEPS
#
# RUNTIME.a is that of the board: archive.sh. LONG=1 in the environment: what is emitted is optimised as firmware is.
# CASE=TEXT: only variants with this text in their name.
set -u
name=$1
double=$2
float=$3
host=$4
runtime=$5
root=$6
firmware=$root/tests/firmware
. "$firmware/boards.sh"
if ! boards_installed; then
	echo "1..0 # SKIP no $arm-gcc or no qemu-system-arm"
	exit 0
fi
board "$name"
optimize_less "$name"
# with all of it the second list has 3 KiB more than there are
[ "$name" != m0 ] || optimize=$(echo "$optimize" | sed 's/-O2/-Os/')
work=$(mktemp -d "${TMPDIR:-/tmp}/firmware.XXXXXX") || exit 99
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM

compile() {         # compile SOURCE OBJECT [OPTION ...]
	source=$1
	object=$work/$2.o
	shift 2
	# shellcheck disable=SC2086
	$arm-gcc $optimize $cpu -I"$root/runtime" -I"$firmware" "$@" -c "$source" -o "$object" || exit 99
}
compile "$double" double
compile "$float" float -DREAL_FLOAT
compile "$firmware/steps.c" steps_double
compile "$firmware/steps.c" steps_float -DREAL_FLOAT
compile "$firmware/steps_main.c" main "-DSTEPS=$7" "-DWANTED=\"${CASE:-}\""
for f in start semihosting digits; do compile "$firmware/$f.c" $f; done
link "$work/image.elf" "$work"/*.o "$runtime" || exit 99

"$host" "$7" >"$work/expected" || exit 99
# Many times what the slowest takes
emulate "${FIRMWARE_TIMEOUT:-4800}" "$work/image.elf" >"$work/found"
status=$?

# A result for each variant, one for the stack, which on a small board must not reach the variables, and one for the
# end.
awk -v board="$name" -v steps="$7" -v status=$status '
	FNR == NR { if (!($1 in lines)) order[++n] = $1
				expected[$1 " " $2] = $0; lines[$1] = lines[$1] "|" $1 " " $2; next }
	{ found[$1 " " $2] = $0; last = $0 }
	$1 == "stack" { used = $2; room = $4 }
	END {
		for (i = 1; i <= n; i++) {
			m = split(lines[order[i]], key, "|")
			bad = 0
			for (j = 2; j <= m; j++)
                # status 1 or 4: a run that has left the finite numbers, or that gives up each step, says nothing
                if ((found[key[j]] != expected[key[j]] || expected[key[j]] ~ / status [145]$/) && bad++ == 0)
					said = "# found    " found[key[j]] "\n# expected " expected[key[j]]
			print (bad ? "not ok " : "ok ") i " - " board ", " order[i] ": the bits of this host, " \
				m - 1 " lines, up to " steps " steps"
			if (bad) print said "\n# " bad " of " m - 1 " lines differ"
			failed += bad != 0
		}
		good = used > 0 && used < room
		print (good ? "ok " : "not ok ") n + 1 " - " board ": stack " used + 0 " bytes, of at least " \
			room + 0 " that are there"
		failed += !good
		good = status == 0 && last == "end"
		print (good ? "ok " : "not ok ") n + 2 " - " board ": the image runs to its end"
		if (!good) { print "# status " status " (124: timeout), last line " last; failed++ }
		print "1.." n + 2
		exit failed != 0 }' "$work/expected" "$work/found"
