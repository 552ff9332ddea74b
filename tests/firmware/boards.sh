# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the scripts here, with $firmware set to this folder: the boards, how to build for them and how to run them.
arm=arm-none-eabi
optimize='-std=c99 -O2 -ffp-contract=off -ffunction-sections -fdata-sections'

# Less of it, which takes half as long and on which bits must not depend; not with LONG=1 in the environment.
# optimize_less BOARD: where only bits are asked for, of M4F, which has room for that, not at all: a fifth
optimize_less() {
	case ${1:-} in m4f) level=-O0 ;; *) level=-O1 ;; esac
	[ -n "${LONG:-}" ] || optimize=$(echo "$optimize" | sed "s/-O2/$level/")
}

# board NAME: sets cpu (options of the compiler), machine and script
board() {
	script=mps2.ld
	case $1 in
		m0) cpu='-mcpu=cortex-m0 -mthumb' machine=microbit script=microbit.ld ;;
		m3) cpu='-mcpu=cortex-m3 -mthumb' machine=mps2-an385 ;;
		m4f) cpu='-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16' machine=mps2-an386 ;;
		m7) cpu='-mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16' machine=mps2-an500 ;;
        *) echo "boards.sh: no board $1" >&2; exit 99 ;;
	esac
}

boards_installed() {
	command -v $arm-gcc >/dev/null 2>&1 && command -v qemu-system-arm >/dev/null 2>&1
}

# link IMAGE OBJECT ...: of newlib only memcpy and memset, no start-up code
link() {
	image=$1
	shift
	# shellcheck disable=SC2086
	$arm-gcc $cpu -nostartfiles -Wl,--gc-sections -L"$firmware" -T "$script" "$@" -o "$image"
}

# emulate SECONDS IMAGE [OPTION ...]: semihosting writes to standard error
emulate() {
	seconds=$1
	image=$2
	shift 2
	timeout "$seconds" qemu-system-arm -M "$machine" -nographic -monitor none -serial none \
		-semihosting-config enable=on,target=native "$@" -kernel "$image" 2>&1 </dev/null
}
