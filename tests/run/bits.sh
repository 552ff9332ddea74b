#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# bits.sh PLGEN INSIDE SOURCE_ROOT: the C of models, run inside the generator and compiled: the same bits, of each
# scheme and both types, in float every second by turns. Every eighteenth is compiled by another compiler than the
# generator has inside, whose bits `compilers` holds against others. With LONG=1 in the environment all are, optimised,
# and all in float too; in `make check` a third of all that.
inside=$(realpath "$2")
root=$3
. "${0%/*}/../plgen.sh"
other_cc="${CC:-cc} -std=gnu11 -O0 -ffp-contract=off -w"
turn=0
[ -z "${LONG:-}" ] || run_cc="${CC:-cc} -std=c99 -O1 -ffp-contract=off -w"
here=${0%/*}
case $here in /*) ;; *) here=$root/tests/run ;; esac

# same FILE.spec STEPS REAL [SCHEME]
same() {
	what="${1##*/} ${4:-} $3"
	taken=no
	one_of 3 || return 0
	chosen "$what" || return 0
	taken=yes
	name=$(sed -n 's/^model *\([a-z0-9_]*\).*/\1/p' "$1")
	flags="-DMODEL=$name -DRHS=${name}_rhs"
	[ "$3" = float ] && flags="$flags -DFLOAT"
	grep -q '^input' "$1" && flags="$flags -DINPUTS"
	: >log
	compiler=$run_cc
	turn=$((turn + 1))
	[ -n "${LONG:-}" ] || [ $((turn % 18)) -ne 0 ] || compiler=$other_cc
	# shellcheck disable=SC2086
	"$plgen" --rhs --real "$3" ${4:+--scheme "$4"} "$1" >model.c 2>>log &&
		$compiler $flags -I"$root/runtime" "$here/drive.c" model.c \
			"$archive" -lm -o drive >>log 2>&1 && ./drive "$2" >compiled &&
		"$inside" "$1" "$2" "$3" ${4:+"$4"} >run 2>>log && cmp compiled run >>log 2>&1 && [ -s run ]
	result $? "$what"
}

place=0         # of two models each in float with the schemes that the other is not
for model in "$root"/models/pendulum.spec "$root"/models/duffing.spec; do
	place=$((place + 1))
	for scheme in etd1 etdrk2 etdrk4 nc2 nc3 dq4 bm3 taylor radau auto etdam4 etdam5 etdam6 etdcol; do
		place=$((place + 1))
		same "$model" 300 double $scheme
		[ -z "${LONG:-}" ] && [ $((place % 2)) -eq 0 ] || same "$model" 300 float $scheme
	done
done
for name in vanderpol quad2dof mathieu scs_weak; do
	same "$root/models/$name.spec" 500 double
	same "$root/models/$name.spec" 500 float
done
for scheme in '' auto radau; do
	same "$root/models/vanderpol_stiff.spec" 200 double $scheme
done
for name in gear1 gear2 gear3 bilinear stop two_masses quarter_car_bumps; do
	same "$root/models/$name.spec" 1000 double
	same "$root/models/$name.spec" 300 float
done
same "$root/models/beam4.spec" 30 double
same "$root/models/beam4.spec" 30 double etdam4
same "$root/models/beam15.spec" 10 double

# The same for a step that has no branch: what it took, as it ran, is what step/cost.c counts.
straight() {
	same "$@"
	[ $taken = yes ] || return 0
	sed -n 's/^counted //p' log >counted
	sed -n 's/^written //p' log >written
	[ -s counted ] && cmp counted written >>log
	result $? "$what: operations"
}
for name in scs sdcs sdcsf linear2dof quarter_car drivetrain inertia; do
	straight "$root/models/$name.spec" 30 double
	straight "$root/models/$name.spec" 30 float
done
printf "model quotient\ncoord x\ninit x = 1\nx'' + x/(1 + x^2) = 0\nstep 0.01\n" >quotient.spec
straight quotient.spec 30 double etdrk2
for scheme in etd1 etdrk2; do
	straight "$root/models/pendulum.spec" 30 double $scheme
	straight "$root/models/duffing.spec" 30 float $scheme
done

# From crossing to crossing beside curves
cat >cut.spec <<END
model cut
coord x, y
input u
init x = 0.2
x'' + 0.1*x' + 5*deadzone(x, -0.3, 0.3) + y^3 = cos(1.3*t)
y'' + 0.2*y' + y + (x > 0.1 ? 0.2 : 0) = u
step 0.1
END
for scheme in etd1 etdrk2 etdrk4 taylor radau auto; do
	same cut.spec 100 double $scheme
	same cut.spec 100 float $scheme
done

# What the language has and models rarely need: inputs of each hold, outputs with functions, growing loads, matrices
cat >inputs.spec <<END
model inputs
coord x, y
input u
input v hold first
input w hold first
init x = 0.3
x'' + 0.1*x' + 2*x - y + x^3 = u + exp(-0.2*t)*cos(3*t)
y' + y + x^2*y = v + 0.1*w + 0.02*w' + (t < 1 ? t : 1) + exp(-t)
output a = x''
output b = sqrt(1 + x^2) + atan2(x, 1 + y^2)
step 0.05
END
for scheme in etdrk2 etdrk4 bm3 taylor radau; do
	same inputs.spec 100 double $scheme
	same inputs.spec 100 float $scheme
done
tap_end
