#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# measured.sh PLGEN JUDGE SOURCE_ROOT: needs of models that are not linear, or piecewise linear. What is chosen is
# compiled and run; CVODE, on equations by hand, finds every sample within the need, from the spec's start and one of
# its neighbours by turns, with LONG=1 from all of them. With MERGE=1 of more models, with LONG=1 of all.
judge=$(realpath "$2")
root=$3
. "${0%/*}/../compilers.sh"
. "${0%/*}/../plgen.sh"
turn=0
! long || run_cc="${CC:-cc} -std=c99 -O1 -ffp-contract=off -w"

cat >pendulum.txt <<END
coord x
init x = 1.0472
x'' + sin(x) = 0
END
cat >duffing.txt <<END
param F = 0.5
coord x
init x = 1
x'' + 0.2*x' + x + x^3 = F*cos(1.4*t)
END
{ cat duffing.txt; echo "output a = x''"; } >shaken.txt
cat >clearance.txt <<END
param F = 0.8
coord x
init x = 0.2
x'' + 0.1*x' + 5*deadzone(x, -0.3, 0.3) = F*cos(1.3*t)
END
cat >lorenz.txt <<END
coord x, y, z
init x = 1, y = 1, z = 20
x' = 10*(y - x)
y' = x*(28 - z) - y
z' = x*y - 8/3*z
END
cat >mathieu.txt <<END
param F = 1
coord x
init x = 0.5
x'' + 0.05*x' + (1 + 0.3*cos(2.1*t))*x = F*(t < 4 ? sin(3*t) : 0)
END
# driven NAME TERM: by an input, which drive.c gives samples that plgen has not tried
driven() {
	printf "coord x\ninput u\ninit x = 0.1\nx'' + 0.3*x' + 4*x%s = u\nstep 0.05\n" "$2" >"$1.txt"
}
driven driven ' + x^3'
driven pushed ' + 9*max(x - 0.05, 0)'
sed "s/input u/& hold first/; s/= u/& + 0.2*u'/; \$a output a = x''" driven.txt >ramped.txt
driven plain ''
echo "output e = 0.5*x'^2 + 2*x^2" >>plain.txt

# Between events there are equations, but no function that a solver could take.
cat >bounces.txt <<END
coord x
init x = 1
x'' = -9.81
stop between ground, x at 0 restitution 0.8
END
cat >rubs.txt <<END
coord x
init x = 1
x'' + x + friction(x', 0.1) = 0
END
cat >rod.txt <<END
coord x, y
init x = 1
energy T = (x'^2 + y'^2)/2, V = 9.81*y
constraint rod: x^2 + y^2 = 1
END

# meets MODEL OUTPUT WITHIN UNTIL LOADS [OPTIONS]: LOADS: whether F is a load; alone: no start but the spec's
meets() {
	name=$1 within=$3 until=$4 loads=$5 rhs=--rhs
	what="$1 within $3 until $4"
	output=$2
	shift 5
	what="$what $*"
	chosen "$what" || return 0
	{ echo "model $name"; cat "$name.txt"; echo "need $output within $within until $until"; } >"$name.spec"
	flags="-DMODEL=$name -DRHS=${name}_rhs"
	! grep -q '^stop\|friction\|^constraint' "$name.txt" || flags="-DMODEL=$name" rhs=
	grep -q '^input' "$name.txt" && flags="$flags -DINPUTS"
	good=0
	: >log
	# the choice is that of the spec: other loads are put into what it has chosen; as the C tells it, where it is
	# told there, else, and with LONG=1, as --explain=json does
	"$plgen" $rhs "$@" "$name.spec" >chosen.c 2>>log || good=1
	sed -n 's/^ \*     measured [^(]*(\([^;)]*\).*/, \1,/p' chosen.c | head -n 1 >taken
	if ! long && [ -s taken ]; then
		scheme=$(sed 's/^, [a-z]*, \([a-z0-9]*\),.*/\1/' taken)
	else
		"$plgen" --explain=json "$@" "$name.spec" 2>>log | tr '\n' ' ' |
			sed 's/.*"alternatives"//; s/.*{\([^{]*"taken": true\).*/, \1/; s/[":]//g' >taken
		scheme=$(sed -n 's/.* scheme \([a-z0-9]*\),.*/\1/p' taken)
	fi
	real=$(sed -n 's/.*[ ,]\(double\|float\),.*/\1/p' taken)
	[ "$real" != float ] || flags="$flags -DFLOAT"
	step=$(sed -n 's/.*, step \([0-9.e-]*\),.*/\1/p' taken)
	tolerance=$(sed -n 's/.*, tolerance \([0-9.e-]*\),.*/\1/p' taken)
	step=${step:-$(sed -n 's/^step //p' "$name.txt")}
	neighbours=2
	[ "$loads" != yes ] || neighbours=4
	turn=$((turn + 1)) place=0
	for factors in '1 1' '1.1 1' '0.9 1' '1 1.1' '1 0.9'; do
		start=${factors% *} load=${factors#* }
		[ "$load" = 1 ] || [ "$loads" = yes ] || continue
		[ "$loads" != alone ] || [ "$factors" = '1 1' ] || continue
		place=$((place + 1))
		long || [ $place -eq 1 ] || [ $place -eq $((turn % neighbours + 2)) ] || continue
		grep -v '^need' "$name.spec" >free.spec
		force=$(sed -n 's/^param F = //p' free.spec)
		"$plgen" $rhs "$@" --real "$real" --scheme "$scheme" ${step:+--step "$step"} \
			${tolerance:+--tolerance "$tolerance"} ${force:+-D "F=$force*$load"} free.spec \
			>model.c 2>>log &&
			{ [ "$factors" != '1 1' ] || cp chosen.c model.c; } &&
			$run_cc $flags -I"$root/runtime" \
				"$root/tests/run/drive.c" model.c "$archive" -lm -o drive >>log 2>&1 &&
			./drive "$until" "$start" >samples &&
			{ echo "$scheme step $step tolerance $tolerance, start $start, load $load:"
			  "$judge" "$name" "$(echo "$within" | tr -d ' ')" "$until" "$start" "$load" <samples
			} >>log || good=1
	done
	result $good "$what"
}

long && meets pendulum x 1e-2 100 no
meets pendulum x 1e-4 50 no
long && meets pendulum x 1e-9 20 no
meets pendulum x 1e-3 20 no --real float
merging && meets pendulum x 1e-4 50 no --scheme bm3
meets duffing x 1e-5 60 yes
merging && meets duffing x 1e-5 60 yes --scheme etdam4
merging && meets duffing x '0.5 %' 30 yes
long && meets duffing x 1e-3 30 yes --real float
merging && meets shaken a 1e-4 30 yes
merging && meets clearance x 1e-3 40 yes
merging && meets clearance x 1e-6 10 yes --scheme exact
merging && meets clearance x 1e-3 40 yes --scheme etdrk4
merging && meets lorenz x 1e-3 5 no
meets mathieu x 1e-5 30 yes
meets driven x 1e-4 '20 for |u| <= 0.7' no
long && meets driven x 1e-9 '10 for |u| <= 0.7' no
merging && meets ramped a 1e-4 '20 for |u| <= 0.7' no
merging && meets pushed x 1e-3 '20 for |u| <= 0.7' no
meets bounces x 1e-6 3 no
merging && meets bounces x 1e-3 3 no --scheme radau
merging && meets rubs x 1e-5 20 no
merging && meets rubs x 1e-9 20 no --scheme taylor
meets rod x 1e-6 10 alone
meets plain e 1e-4 '20 for |u| <= 0.7' no

# varies NAME NAMES: of this model neighbours in these
varies() {
	chosen "$1 varies $2" || return 0
	{ echo "model $1"; cat "$1.txt"; echo 'need x within 1e-3 until 10'; } >"$1.spec"
	"$plgen" "$1.spec" >model.c 2>log && grep -q "where $2 are each 10 %" model.c
	result $? "$1 varies $2"
}
cat >pressed.txt <<END
param b = 0.3, k = 5, p = 0.1, G = 0.2, F = 0.8
coord x
init x = 0.2
let pushed = (x > 0.1 ? p : 0)
x'' + 0.1*x' + k*deadzone(x, -b, b) + pushed = F*cos(1.3*t) + G
END
varies clearance 'x, F'
merging && varies pressed 'x, G, F'

# says NAME TEXT OPTIONS: an error with this text, and no C
says() {
	name=$1 text=$2
	shift 2
	chosen "$name" || return 0
	"$plgen" "$@" >model.c 2>log
	[ $? -eq 1 ] && [ ! -s model.c ] && grep -qF -e "$text" log
	result $? "$name"
}

{ echo 'model lorenz'; cat lorenz.txt; echo 'need x within 1e-3 until 80'; } >chaos.spec
says 'a chaotic motion is not known for long' 'the motion is too sensitive to be known until then' chaos.spec
{ echo 'model pendulum'; cat pendulum.txt; echo 'need x within 1e-13 until 50'; } >fine.spec
says 'a need beyond what references know' 'two references differ by more than' fine.spec
{ echo 'model pendulum'; cat pendulum.txt; echo 'need x within 1e-9 until 10'; } >float.spec
merging &&
	says 'a need beyond float' 'the need cannot be met: the best that was measured, float' --real float float.spec
says 'a step that is written' 'the need cannot be met' --step 0.5 --scheme etdrk2 float.spec
{ echo 'model pendulum'; cat pendulum.txt; echo 'need x within 1e-4 until 1e7'; } >long.spec
merging && says 'an end that is too far' 'would take too long' long.spec
printf "model driven\ncoord x\ninput u\nx'' + x^3 = u\nneed x within 1e-3 until 5\n" >driven.spec
says 'an input without a step' 'missing step' driven.spec
says 'an input without a bound' "nothing says how large the input 'u' may be" --step 0.1 driven.spec
printf "model linear\ncoord x\ninput u\nx'' + x = u\nneed x within 1e-3 until 5 for |u| <= 1\n" >linear.spec
says 'a linear model with an input and without a step' 'missing step' linear.spec

# steps H MODEL: of a linear model without a step it is H: at most half of the shortest period, 1/100 of the end
steps() {
	what="without a step, a linear one: $1"
	chosen "$what" || return 0
	printf "$2" >open.spec
	"$plgen" open.spec >open.c 2>log && grep -q "One step of h = $1 s" open.c &&
		{ cat open.spec; echo "step $1"; } >closed.spec && "$plgen" closed.spec >closed.c 2>>log &&
		sed 's/closed.spec/open.spec/' closed.c | diff - open.c >>log
	result $? "$what"
}
steps 0.5 "model osc\ncoord x\ninit x = 1\nx'' + x = 0\nneed x within 1e-3 until 50\n"
steps 0.05 "model fast\ncoord x\ninit x = 1\nx'' + 3600*x = 0\nneed x within 1e-3 until 50\n"
steps 0.02 "model load\ncoord x\ninit x = 1\nx'' + x = cos(140*t)\nneed x within 1e-3 until 50\n"
steps 0.1 "model slow\ncoord x\ninit x = 1\nx' + x = 0\nneed x within 1e-3 until 20\nneed x within 1e-4 until 10\n"
# the fast mode is seen too little to be kept, and to count: 0.1 s is above half of its period
steps 0.1 "model far\ncoord x, y\ninit x = 1, y = 1\nx'' + x = 0\ny'' + 1e4*y = 0\n"\
'output o = x + 1e-6*y\nneed o within 1e-3 until 10\n'

# The word is `measured`: of a model that is not linear nothing is certified.
{ echo 'model pendulum'; cat pendulum.txt; echo 'need x within 1e-4 until 50'; } >word.spec
"$plgen" word.spec >word.c 2>log && grep -q 'Needed: x within 1e-4 until 50;' word.c && grep -q ' measured ' word.c &&
	! grep -qi certified word.c && "$plgen" --explain word.spec >word.txt 2>>log && ! grep -qi certified word.txt
result $? 'what is said is that it was measured'
"$plgen" word.spec >again.c 2>log && cmp word.c again.c >>log
result $? 'the same choice again'
{ echo 'model clearance'; cat clearance.txt; printf 'step 0.1\nscheme taylor 12 over 3\nneed x within 1e-3 until 10\n'
} >aside.spec
"$plgen" aside.spec >aside.c 2>log && grep -q 'over 3 stands aside' log &&
	grep -q 'measured [1-9].*at every sample' aside.c
result $? 'a need where `over` stands aside'
tap_end
