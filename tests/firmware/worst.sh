#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# worst.sh PLGEN SOURCE_ROOT: the longest step that a search finds on emulated boards (worst.c), against the bound that
# --explain=json and NAME_STEP_MAX have: never above it, and above 0.7 of it; of steps with events above 0.3, since not
# every model has as many as it may, or roots that take all looks, of series with events above 0.5, by tolerance 0.4,
# beside quotients 0.2; of peaks and contacts that act on each other 0.1, for few use all looks, or all sweeps each
# time. The bound was not fitted to these models, but for the long chain. With --table: the table of
# doc/firmware.md instead.
set -u
table=
[ "$1" != --table ] || { table=1; shift; }
plgen=$(realpath "$1")
root=$(cd "$2" && pwd) || exit 99
firmware=$root/tests/firmware
. "$root/tests/tap.sh"
. "$firmware/boards.sh"
if ! boards_installed; then
	echo '1..0 # SKIP no arm-none-eabi-gcc, or no qemu-system-arm'
	exit 0
fi
work=$(mktemp -d "${TMPDIR:-/tmp}/worst.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 99' HUP INT TERM
cd "$work" || exit 99

# What the boards share, once for each; of the runtime what linear steps, peaks, steps of regions and retunes call
calls=$(ls "$root"/runtime/*.c | grep -Ev '_compensated|_d[.]|_df[.]|/(event|region)')
prepare() {
	for b; do
		board "$b"
		mkdir "$b"
		# shellcheck disable=SC2086
		(cd "$b" && $arm-gcc $optimize $cpu -I"$root/runtime" -I"$firmware" -fcallgraph-info=su -c \
			$calls "$firmware/start.c" "$firmware/semihosting.c" \
			"$firmware/digits.c" && $arm-ar rcD runtime.a ./*.o)
	done
}

# A chain of masses, from one end to the other: chain N DAMPING
chain() {
	awk -v n="$1" -v c="$2" 'BEGIN {
		print "model chain\ncoord q[" n "]\ninit q[1] = 1"
		for (i = 1; i <= n; i++)
			print "q[" i "]\47\47 + " c "*q[" i "]\47 + 2*q[" i "]" (i > 1 ? " - q[" i - 1 "]" : "") \
				(i < n ? " - q[" i + 1 "]" : "") " = 0"
		print "step 0.05" }'
}

# search BOARD REAL SPEC [OPTION ...]: usual, largest, bound, stack. The clock of -icount shift=6 has 64 ns an
# instruction, that of SysTick 40 ns a tick, of the M0's board 62.5; it counts to 2^24. Where there are events, starts
# are sought beside breakpoints.
search() {
	b=$1
	real=$2
	spec=$3
	shift 3
	board "$b"
	target=cortex-$(echo "${b%f}")
	option=-DREAL_DOUBLE
	[ "$real" = double ] || option=-DREAL_FLOAT
	special=$("$plgen" --explain "$@" "$spec" 2>/dev/null |
		awk '/breakpoints/ { sub(/.*breakpoints /, ""); gsub(/[^-0-9.e,]/, ""); printf "%s,", $0 }')
	# what serves as long as a tolerance lets it be, and peaks, are slow from states that are found by steps, too
	[ -n "$special" ] || ! grep -q 'tolerance\|peak(' "$spec" || special=0,
	# shellcheck disable=SC2086
	"$plgen" --real "$real" --prefix counted "$@" -o model.c "$spec" 2>log &&
		times=$(awk '/_change\[.* = \{/, /^}/ { if (sub(/^ *\{/, "")) printf "%s", $1 }' model.c) &&
		"$plgen" --real "$real" --prefix counted "$@" --explain=json "$spec" >told 2>>log &&
		$arm-gcc $optimize $cpu -I"$root/runtime" -I"$firmware" -DMODEL=counted_model $option -include model.h \
			${special:+-DSPECIAL=$special-1} ${times:+-DTIMES=${times%,}} \
			-fcallgraph-info=su -c "$firmware/worst.c" model.c >>log 2>&1 &&
		link image.elf model.o worst.o "$b/runtime.a" -lm >>log 2>&1 &&
		emulate 300 image.elf -icount shift=6,align=off,sleep=off >out 2>>log
	stack=$(awk -f "$firmware/stack.awk" model.ci "$b"/*.ci 2>/dev/null | awk '$1 == "counted_step" { print $3 }')
	tail -n 1 out | cat - told | awk -v target="\"$target\":" -v stack="${stack:-0}" -v m0="$b" '
		NR == 1 { scale = m0 == "m0" ? 1.024 : 1.6; usual = $1 / scale; largest = $2 / scale; header = $3 }
		/"worst"/ { gsub(/[{},]/, " "); for (i = 1; i < NF; i++) if ($i == target) bound = $(i + 1) }
		END { printf "%.0f %.0f %d %d %d\n", usual, largest, bound, header, stack }'
}

# found NAME BOARD REAL SPEC [OPTION ...]
found() {
	name=$1
	shift
	set -- "$@"
	# shellcheck disable=SC2046
	search "$@" >line
	read -r usual largest bound header _ <line
	[ "$largest" -le "$bound" ] && [ $((largest * 10)) -ge $((bound * ${least:-7})) ] && [ "$bound" = "$header" ]
	result $? "$name, $1, $2: $usual usual, $largest at most, bound $bound, in the header $header"
}

if [ -n "$table" ]; then
	prepare m0 m4f m7
	echo '|model|type|M0: usual|largest|bound|stack|M4F: usual|largest|bound|stack|M7: usual|largest|bound|stack|'
	echo '|---|---|---|---|---|---|---|---|---|---|---|---|---|---|'
	events="bouncing_ball brake gear1 gear2 impact_oscillator stick_slip stop"
	for model in axle building drivetrain frame half_car linear2dof quarter_car rotor scs sdcs sdcsf street \
		tuned_floor $events; do
		cp "$root/models/$model.spec" table.spec
		case " $events " in *" $model "*) echo 'events at most 2 a step' >>table.spec; model=$model:2 ;; esac
		for real in double float; do
			row="|$model|$real|"
			for b in m0 m4f m7; do
				search $b $real table.spec >line
				read -r usual largest bound _ stack <line
				row="$row$usual|$largest|$bound|$stack|"
			done
			echo "$row"
		done
	done
	exit 0
fi
prepare m0 m4f m7
chain 2 0.02 >two.spec
chain 6 0.02 >six.spec
chain 8 0.03 >eight.spec
chain 14 0.02 >fourteen.spec
sed 's/ = 0$/ = cos(3*t)/' fourteen.spec >driven.spec
cat >loads.spec <<'END'
model loads
coord x, z, y
input u hold first
init x = 1
x'' + 0.3*x' + 40*x - z - 0.1*z' = 2*u
z'' + 0.3*z' + 140*z - x - y = 0
y'' + 0.2*y' + 30*y - z = 4*cos(11*t)
step 0.01
END
cat >cubic.spec <<'END'
model cubic
coord x, z
init x = 1
x'' + 0.2*x' + x + 0.4*(x - z)^3 = 0.3*cos(2*t)
z'' + 0.1*x^2*z' + 2*z - 0.4*(x - z)^3 = 0
step 0.1
scheme taylor 9
END
sed 's/taylor 9/taylor 12 over 3/' cubic.spec >over.spec
sed "s/x^2.z'/z'/; s/0.4.(x - z)^3/0.4*sin(x - z)/" cubic.spec >swing.spec
sed 's/q\[1\] = 1$/&\nrange q[1] in [-1, 1], q[2]\x27 in [-2, 3]/' six.spec >ranged.spec
sed -e 's/^coord/param k = 40, c = 0.3\ntunable k, c\n&/; s/ 40\*/ k*/; s/0\.3\*z/c*z/' loads.spec >tuned.spec
sed 's/^coord/param k = 2\ntunable k\n&/; s/ 2\*q/ k*q/' fourteen.spec >tuned_chain.spec
cat >pulse.spec <<'END'
model pulse
coord x, z
init x = 1
let p = t < 0.7 ? 3*t : t < 0.704 ? 2 : t < 0.9 ? cos(4*t) : 0
x'' + 0.3*x' + 50*x - 2*z = p
z'' + 0.4*z' + 90*z - 2*x = 0
step 0.01
END
while read -r b real spec options; do
	# shellcheck disable=SC2086
	found "$spec $options" "$b" "$real" "$spec.spec" $options
done <<'END'
m0 double two
m0 float loads
m4f double loads
m4f float two
m4f float six --accuracy compensated
m4f float fourteen
m7 double six
m7 double eight
m7 double driven
m7 double loads --form direct
m7 float fourteen
m0 float cubic
m4f float cubic
m4f double over
m7 double over
m4f double swing --math own
m7 double swing --math own
m4f float ranged
m7 double ranged
m0 double tuned
m4f double tuned
m7 float tuned
m4f float tuned_chain
m4f float eight --form modal
m7 double loads --form modal
m4f float pulse
m7 double pulse
m0 float pulse
END
least=6
sed 's/taylor 9/radau/; s/x^2/z^2/; $a tolerance 1e-6\nsubsteps 3' cubic.spec >radau.spec
found radau m4f float radau.spec
sed 's/taylor 9/taylor/; $a tolerance 1e-6\nsubsteps 5' cubic.spec >within.spec
found within m4f float within.spec
found within m7 double within.spec
least=2
sed 's/x + 0.4.(x - z)^3/x + x\/(4 + x^2)/' within.spec >quotient.spec
found 'within, a quotient' m4f float quotient.spec
least=4
found radau m7 double radau.spec
sed "s/0.2.x'/0.2*x'*abs(x')/; \$a events at most 2 a step" within.spec >within_events.spec
found 'within, events' m4f float within_events.spec
least=5
sed "s/0.2.x'/0.2*x'*abs(x')/; s/taylor 9/taylor 7/; \$a events at most 2 a step" cubic.spec >drag.spec
sed 's/2.z -/2*z + 9*max(z - 0.4, 0) -/; s/taylor 9/taylor 7/; $a events at most 1 a step' cubic.spec >touch.spec
while read -r b real spec; do
	found "$spec" "$b" "$real" "$spec.spec"
done <<'END'
m4f float drag
m4f float touch
m7 double touch
END
least=3
sed 's/radau/auto/' radau.spec >auto.spec
found auto m4f float auto.spec
cat >gap.spec <<'END'
model gap
coord x, z
init x = 0.4, z' = 1
x'' + 0.1*x' + 9*x - 3*z + 20*max(x - z - 0.2, 0) = 0
z'' + 0.1*z' + 8*z - 3*x = cos(3*t)
step 0.05
events at most 2 a step
END
sed "s/20.max(x - z - 0.2, 0)/friction(x', 0.4)/" gap.spec >rub.spec
sed 's/ + 20.max(x - z - 0.2, 0)//; $a stop between x, ground at 0.3 restitution 0.6' gap.spec >bounce.spec
# independent parts
sed "s/ - 3\*z / /; s/ - 3\*x = / + 30*max(z - 0.1, 0) = /; s/x - z - 0.2/x - 0.2/" gap.spec >parts.spec
# which take most of what their bound adds up: looks; rows, with friction and a bounce on one mass
cat >looks.spec <<'END'
model looks
coord x, y
init x = -0.21, y = -0.8
x'' + 0.1*x' + 140*x + 506*(x - y) + 225*max(x - y + 0.2, 0) = 0
y'' + 0.5*y' + 0.76*y + 1410*(y - x) + 2340*max(y - 0.3, 0) = 0
step 0.005
events at most 2 a step
END
cat >rows.spec <<'END'
model rows
coord x
init x = -0.6
x'' + 2*x' + 0.861*x + friction(x', 0.1) = 3*cos(7.4*t)
stop between x, ground at 0.3 restitution 0.3
step 0.1
events at most 1 a step
END
while read -r b real spec; do
	found "$spec" "$b" "$real" "$spec.spec"
done <<'END'
m4f float looks
m4f float rows
m4f float gap
m4f double gap
m4f float parts
m7 double parts
m7 double rub
m4f float rub
m0 float bounce
m7 double bounce
END
least=1
sed 's/2\*u/0/; s/^input.*//; $a output p = peak(x), v = peak(z\x27)' loads.spec >peaks.spec
found peaks m4f float peaks.spec
sed '$a stop between z, x at 0.2 restitution 0.4' bounce.spec >stack.spec
found stack m4f float stack.spec
tap_end
