#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# costs.sh PLGEN SOURCE_ROOT: what --explain says of a step on a Cortex-M4 and of the bytes of an instance,
# against an emulated one that counts instructions, within a factor of 1.34, with events of 1.25; bytes
# exactly. What the banner says, of the step's program alone, is the same within a factor of 1.06 (=) where a step is
# straight-line code, of 1.7 (~) where it is an event-free step, and nothing is compared (-) where steps share a series.
set -u
plgen=$(realpath "$1")
root=$(cd "$2" && pwd) || exit 99
firmware=$root/tests/firmware
. "$root/tests/tap.sh"
. "$firmware/boards.sh"
board m4f
if ! boards_installed; then
	echo '1..0 # SKIP no arm-none-eabi-gcc, or no qemu-system-arm'
	exit 0
fi
for f in start semihosting digits; do
	# shellcheck disable=SC2086
	$arm-gcc $optimize $cpu -I"$root/runtime" -I"$firmware" -c "$firmware/$f.c" -o "$f.o"
done
mkdir runtime
# shellcheck disable=SC2086
(cd runtime && $arm-gcc $optimize $cpu -I"$root/runtime" -c "$root"/runtime/*.c && $arm-ar rcD ../runtime.a ./*.o)
# The clock of -icount shift=10 has 1024 ns an instruction, that of SysTick 40 ns a tick
while read -r name real factor banner options; do
	option=-DREAL_DOUBLE
	[ "$real" = double ] || option=-DREAL_FLOAT
	# shellcheck disable=SC2086
	"$plgen" --real "$real" --prefix counted $options "$root/models/$name.spec" >model.c 2>log &&
		"$plgen" --real "$real" --explain=json $options "$root/models/$name.spec" >told 2>log &&
		$arm-gcc $optimize $cpu -I"$root/runtime" -I"$firmware" -DMODEL=counted_model $option -c model.c \
			"$firmware/costs.c" >>log 2>&1 &&
		link image.elf model.o costs.o start.o semihosting.o digits.o runtime.a -lm >>log 2>&1 &&
		emulate 60 image.elf -icount shift=10,align=off,sleep=off >out
	tail -n 1 out 2>/dev/null | cat - told model.c | awk -v factor="$factor" -v like="$banner" '
		NR == 1 { bytes = $1; counted = $2 / 200 / 25.6 }
		/"board"/ { gsub(/[",{}]/, " "); for (i = 1; i < NF; i++) { if ($i == "instructions") about = $(i + 2)
			if ($i == "bytes") own = $(i + 2) } }
		/On a Cortex-M4/ { for (i = 1; i < NF; i++) if ($i == "about") banner = $(i + 1) }
		END { print "instructions:", about, "told,", counted, "counted; bytes:", own, "told,", bytes
			off = like == "=" ? 1.06 : like == "~" ? 1.7 : 0
            if (off && !(banner < off * about && about < off * banner)) { print "banner:", banner; exit 1 }
            exit !(about > 0 && about < factor * counted && counted < factor * about && own == bytes) }' >log
	good=$?
	result $good "$name, $real: $(cat log)"
	rm -f out
done <<END
scs double 1.34 =
scs float 1.34 =
sdcsf double 1.34 =
sdcsf float 1.34 =
half_car double 1.1 =
half_car float 1.1 =
frame float 1.34 =
pendulum double 1.34 =
pendulum float 1.34 =
mathieu float 1.34 - --scheme etdrk4
vanderpol float 1.34 -
quad2dof double 1.34 -
gear1 double 1.25 ~
gear1 float 1.25 ~
gear3 float 1.25 ~
two_masses float 1.25 ~
stop float 1.25 ~
stick_slip double 1.25 ~
stick_slip float 1.25 ~
brake double 1.25 ~
brake float 1.25 ~
impact_oscillator float 1.25 ~
END
tap_end
