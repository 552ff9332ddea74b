#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# reach.sh PLGEN SOURCE: the radius of convergence at the start that --explain and --explain=json tell, beside the place
# of the nearest singularity in closed form; and the order that they tell.
set -u
plgen=$(realpath "$1")
source=$(realpath "$2")
. "$source/tests/tap.sh"

# told NAME EXPECTED: of drawn.spec; null: none is told
told() {
	"$plgen" --scheme taylor --explain=json drawn.spec >json 2>log &&
		"$plgen" --scheme taylor --explain drawn.spec >text 2>>log || { result 1 "$1"; return; }
	found=$(sed -n 's/^ *"radius": \(.*\),$/\1/p' json)
	if [ "$2" = null ]; then
		echo "found $found, expected null" >log
		[ "$found" = null ]
		result $? "$1: no radius"
		return
	fi
	echo "$found $2" | awk '{ d = $1 / $2 - 1; print "found " $1 ", expected " $2 ", tolerance 4 %"
		exit !(d > -0.04 && d < 0.04) }' >log && grep -q "radius of convergence is about $found s" text
	result $? "$1: $found s, in closed form $2 s"
}

# equation START EQUATION: the spec
equation() {
	printf 'model drawn\ncoord x\ninit %s\n%s\nstep 0.1\n' "$1" "$2" >drawn.spec
}
equation 'x = 1' "x' = x^2"
told '1/(1 - t)' 1
equation 'x = 0' "x' = 1 + x^2"
told 'tan(t): two poles' 1.5708
equation 'x = 1.03' "x' = -1/x"
told 'sqrt(1.03^2 - 2t)' 0.53045
equation 'x = 1' "x' = -t^2*x^2"
told '3/(3 + t^3): three poles, a series in t^3' 1.44225
equation 'x = 0' "x' = (t - 2 < 0 ? 1 : 2)/sqrt(1 + t^2)"
told 'asinh(t): branches' 1
equation 'x = 2' "x' = -x*log(x)"
told 'exp(log(2) exp(-t)): entire' null
cp "$source/models/mathieu.spec" drawn.spec
told 'a linear equation: entire' null
# x = 2 asin(k cd(t)): sqrt(K^2 + K'^2), k = sin(1.0472/2) (Abramowitz and Stegun, 16.5)
cp "$source/models/pendulum.spec" drawn.spec
told 'pendulum' 2.7372
equation 'x = 0' "x' = -1/x"
told 'no series' null
grep -q 'series cannot be made' text
result $? 'no series: told'

# order NAME EXPECTED OPTION...: of drawn.spec, as told twice, and as the code has it
order() {
	name=$1 expected=$2
	shift 2
	"$plgen" "$@" --explain=json drawn.spec >json 2>log && "$plgen" "$@" --explain drawn.spec >text 2>>log &&
		"$plgen" "$@" drawn.spec >code.c 2>>log || { result 1 "$name"; return; }
	found=$(sed -n 's/^ *"order": \(.*\),$/\1/p' json)
	rows=$(sed -n 's/^static void drawn_ahead(const double c\[\([0-9]*\)\].*/\1/p' code.c)
	echo "order $found, expected $expected; coefficients of a state $rows" >log
	[ "$found" = "$expected" ] && [ "$rows" = $((expected + 1)) ] && grep -q "is of order $expected in h" text
	result $? "$name: order $found"
}
# Seven products: 1421 multiplications at order 16, and orders 12 to 14 take two thirds of its time at 1e-9.
drag=$(printf "%s\n" "x'' + x'*sqrt(x'^2 + 0.01)/10 + x + x^3 = (y - x)/2" \
	"y'' + y'*sqrt(y'^2 + 0.01)/10 + y + y^3 = (x - y)/2")
equation 'x = 1' "$drag"
sed -i 's/^coord x/coord x, y/' drawn.spec
order 'a dear series' 13 --scheme taylor
order 'a dear series, as asked' 16 --scheme 'taylor 16'
order 'a dear series at 1e-3' 8 --scheme taylor --tolerance 1e-3
cp "$source/models/pendulum.spec" drawn.spec
sed -i 's/^model .*/model drawn/' drawn.spec
order 'a cheap series' 16 --scheme taylor
tap_end
