#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The example of doc/firmware/ as its Makefile builds it, run on emulated boards; the snippet that counts cycles,
# compiled.
#
#     example.sh PLGEN SOURCE_ROOT RUNTIME_M4F.a RUNTIME_M0.a
#
# The runtime is compiled by the Makefile as it stands; elsewhere it is that of the other tests, M3 with that of M0.
set -u
plgen=$(realpath "$1")
root=$2
m4f=$(realpath "$3")
m0=$(realpath "$4")
firmware=$root/tests/firmware
. "$firmware/boards.sh"
if ! boards_installed; then
	echo "1..0 # SKIP no $arm-gcc or no qemu-system-arm"
	exit 0
fi
. "${0%/*}/../tap.sh"
cp "$root/doc/firmware/main.c" "$root/doc/firmware/board.h" "$root/doc/firmware/cycles.h" \
	"$root/doc/firmware/Makefile" .
. "$root/tests/sparing.sh"
mkdir bin
for name in m4f m3 m0; do
	board $name
	runtime=$m0
	[ $name != m4f ] || runtime=$m4f
	sparing $arm-gcc "$root/runtime" "$runtime"
	clock=25000000
	[ $name != m0 ] || clock=16000000
	drivers="$firmware/start.c $firmware/semihosting.c $firmware/digits.c $firmware/example_board.c"
	drivers="$drivers -I$firmware -DBOARD_CLOCK_HZ=${clock}u -Werror"
	# Not the flags of a make that runs this test
	MAKEFLAGS= make -s firmware.elf PLGEN="$plgen" RUNTIME="$root/runtime" SPEC="$root/models/quarter_car.spec" \
		CPU="$cpu" CC="$work/bin/$arm-gcc" \
		BOARD="$drivers -nostartfiles -L$firmware -T $script" >log 2>&1 && [ ! -s log ]
	result $? "$name: the example builds with the lines of its Makefile, without a warning"
	# An instruction every 16 ns, whatever the host: 62500 in a millisecond.
	emulate 1200 firmware.elf -icount shift=4,align=off,sleep=off >out
	status=$?
	{
		echo "status $status; time [ms], ticks, micrometres off with corrections, without:"
		cat out
	} >log
	[ $status -eq 0 ] && awk 'NF != 4 || $1 != $2 || $2 != 50 * NR { bad = 1 } END { exit bad || NR != 20 }' out
	result $? "$name: 1000 ticks, and the model keeps their time"
    # Without corrections 0.2 s on, as the body swings; with them at the end less than what float keeps of 5 cm in so
	# many steps
	awk '$2 == 200 { early = $4 } { corrected = $3; alone = $4 } END { exit !(early >= 5000 && alone >= 500 &&
		corrected <= 1) }' out
	result $? "$name: measurements bring the model to the car"
	mv out "out.$name"
	rm -f firmware.elf quarter_car_pl.?
done
mkdir -p tree/doc/firmware
for folder in models runtime tests; do
	ln -s "$root/$folder" tree/$folder
done
cp main.c board.h Makefile tree/doc/firmware
MAKEFLAGS= make -s -C tree/doc/firmware PLGEN="$plgen" >log 2>&1 && board m4f &&
	emulate 1200 tree/doc/firmware/firmware.elf -icount shift=4,align=off,sleep=off >out 2>>log
diff out out.m4f >>log
result $? 'the Makefile as it stands builds what runs on the M4F'
: >log
diff out.m4f out.m3 >>log && diff out.m4f out.m0 >>log
result $? 'all boards say the same'

# Retuned in the background: an instruction every 64 ns, 15625 in a millisecond, which a retune exceeds
board m4f
{ cat "$root/models/quarter_car.spec"; echo 'tunable cs'; } |
	"$plgen" --real float --prefix suspension -o suspension_pl.c - >log 2>&1 &&
	$arm-gcc $optimize $cpu -Wall -Wextra -Wdouble-promotion -Werror -I. -I"$root/runtime" -I"$firmware" \
		"$root/doc/firmware/retune.c" suspension_pl.c "$firmware/retune_board.c" "$firmware/start.c" \
		"$firmware/semihosting.c" "$firmware/digits.c" "$m4f" -nostartfiles -Wl,--gc-sections -L"$firmware" \
		-T "$script" -o retune.elf >>log 2>&1 &&
	emulate 600 retune.elf -icount shift=6,align=off,sleep=off >out 2>>log
status=$?
echo "status $status; ticks, inside a retune, with other coefficients, with other bits:" >>log
cat out >>log
[ $status -eq 0 ] && awk '{ exit !($1 == 1000 && $2 >= 100 && $3 >= 100 && $4 == 0) }' out
result $? 'retuned in the background, used in the interrupt: the bits of a retune between two steps'

echo '#include "cycles.h"
uint32_t spent(void (*f)(void));
uint32_t spent(void (*f)(void))
{
	const uint32_t before = (cycles_start(), cycles());
	f();
	return cycles() - before;
}' >cycles.c
for name in m3 m4f m7; do
	board $name
	# shellcheck disable=SC2086
	$arm-gcc $optimize $cpu -Wall -Wextra -Wpedantic -Wconversion -Werror -c cycles.c >log 2>&1 &&
		$arm-objdump -d cycles.o | grep -q 'ldr.*\[' >>log
	result $? "$name: the snippet that counts cycles compiles"
done
board m0
# shellcheck disable=SC2086
$arm-gcc $optimize $cpu -c cycles.c 2>&1 | grep -q 'error.*no cycle counter'
result $? 'm0: it says that there is no such counter'

tap_end
