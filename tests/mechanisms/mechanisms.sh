#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# mechanisms.sh PLGEN PLRUN SOURCE: mechanisms.cases, as TAP: the values that plrun prints at a time.
set -u
PLGEN=$(realpath "$1")
plrun=$(realpath "$2")
root=$(realpath "$3")
export PLGEN
. "$root/tests/tap.sh"
. "$root/tests/run_cc.sh"
XDG_CACHE_HOME=$work/cache
CC=${run_cc%% *}
CFLAGS=${run_cc#* }
export XDG_CACHE_HOME CC CFLAGS
cases=$work/cases
mkdir "$cases"
awk -v at="$cases/" -v root="$root" '/^=== / { name = at $2; part = ".spec"; next }
	name == "" { next }
	/^---$/ { part = ".values"; next }
	/^from / {
		on = NF == 2
		for (file = root "/" $2; (getline line <file) > 0;) {
			on = NF == 2 || (line == "=== " $3) || (on && line != "---")
			if (on && line !~ /^===/)
				print line >(name part)
		}
		close(file)
		next
	}
	NF > 0 { print >(name part) }' "$root/tests/mechanisms/mechanisms.cases"

# compared VALUES CSV WITHIN: the last row against the values; WITHIN in place of their tolerances. Prints what differs,
# and fails then.
compared() {
	awk -v within="$3" '
		FNR == NR && NF == 3 && $1 != "scheme" { name[++count] = $1; value[count] = $2; bound[count] = $3 }
		FNR == NR { next }
		FNR == 1 { columns = split($0, head, ","); next }
		{ row = $0 }
		END {
			split(row, found, ",")
			for (k = 1; k <= columns; k++)
				column[head[k]] = k
			for (i = 1; i <= count; i++) {
				d = found[column[name[i]]] - value[i]
				size = value[i] < 0 ? -value[i] : value[i]
				allowed = (within == "" ? bound[i] : within) * (size > 1 ? size : 1)
				if ((name[i] in column) && d <= allowed && d >= -allowed)
					continue
				print name[i] " is " found[column[name[i]]] ", expected " value[i] " within " allowed
				wrong = 1
			}
			exit wrong || count == 0
		}' "$1" "$2"
}

# check NAME TITLE WITHIN OPTION...
check() {
	values=$cases/$1.values title=$2 within=$3 spec=$cases/$1.spec
	shift 3
	chosen "$title" || return 0
	sed -n 's/^samples //p' "$values" | tr ' ' '\n' >samples.csv
	[ ! -s samples.csv ] || set -- --input samples.csv "$@"
	"$plrun" "$@" "$spec" "$(sed -n 's/^at //p' "$values")" >run.csv 2>log &&
		compared "$values" run.csv "$within" >log
	result $? "$title"
}

for spec in "$cases"/*.spec; do
	name=$(basename "$spec" .spec)
	[ "$name" != reaction_curved ] || merging || continue         # a second and a half
	check "$name" "$name" ""
	sed -n 's/^scheme //p' "$cases/$name.values" >schemes
	while read -r scheme within <&3; do
		one_of 2 || continue
		check "$name" "$name, $scheme" "$within" --scheme "$scheme"
	done 3<schemes
done
# The Jacobian of the accelerations, M^-1 K of the linear equations at a point and K of an operator there, against their
# differences
cat >slope.spec <<'SPEC'
model slope
param p = 1
coord q1, q2
2*q1'' + cos(q1 - q2)*q2'' + sin(q1 - q2)*q2'^2 + 2*9.81*sin(q1) = 0
cos(q1 - q2)*q1'' + q2'' - sin(q1 - q2)*q1'^2 + 9.81*sin(q2) = 0
init q1 = p, q2 = 0.5
output a1 = q1'', a2 = q2''
step 0.01
SPEC
# accelerations P: at q1 = P, as two numbers
accelerations() {
	"$plrun" -D "p=$1" slope.spec 0.01 2>>log | sed -n '2s/,/ /gp' | cut -d ' ' -f 2,3
}
: >log
"$PLGEN" --at q1=1,q2=0.5 --explain=json slope.spec 2>>log | tr -d ' \n[]' |
	sed 's/.*"M":\(.*\)"C":.*"K":\(.*\)"B".*/\1\2/; s/,/ /g' >K
{ cat slope.spec; echo 'scheme etdrk4'; echo 'operator at q1 = 1, q2 = 0.5'; } >operator.spec
"$PLGEN" --explain=json operator.spec 2>>log | tr -d ' \n[]' |
	sed 's/.*"operators":.*"K":\([^"]*\),"poles".*/\1/; s/,/ /g' >operator
echo "$(accelerations 1.00001) $(accelerations 0.99999) $(cut -d ' ' -f 1-8 K) $(cat operator)" | awk '
	{ a = -($1 - $3)/2e-5; b = -($2 - $4)/2e-5
	  print "differences " a " " b ", M and K " $5 " " $6 " " $7 " " $8 ", " $9 " " $11 ", operator " $13 " " $15
	  near = ($5*a + $6*b - $9)^2 + ($7*a + $8*b - $11)^2 < 1e-14 && (a - $13)^2 + (b - $15)^2 < 1e-14
	  exit !near }' >>log
result $? 'the Jacobian of accelerations is that of their differences'
# Rounding of a series is of one sign. By Jacobi's sn in 30 digits: x of the pendulum at t = 1000.
sed '/^output miss/d; s/^output .*/output energy, x/; s/^step .*/step 0.1/' "$cases/pendulum_cartesian.spec" \
	>conserved.spec
"$plrun" conserved.spec 1000 --every 10 2>log | awk -F , '
	NR == 2 { start = $2 }
	NR > 1 { off = $2 - start; worst = off*off > worst*worst ? off : worst; x = $3 + 0.683230188552314855 }
	END { print "the energy of a pendulum is off by " worst ", at most 1e-14; x by " x ", at most 1e-12"
	      exit !(NR == 102 && worst*worst < 1e-28 && x*x < 1e-24) }' >>log
result $? 'energy beside constraints'
printf "model turns\ncoord q\nenergy T = q'^2/2, V = -9.81*cos(q)\ninit q = 2\noutput energy\n" >turns.spec
"$plrun" --scheme 'taylor 16' --step 0.01 turns.spec 3000 --every 10 2>log | awk -F , '
	NR == 2 { start = $2 }
	NR > 1 { d = $2 - start; worst = d*d > worst ? d*d : worst }
	END { print NR " rows, the energy is off by " sqrt(worst) ", at most 6e-15"
	      exit !(NR == 302 && worst < 3.6e-29) }' >>log
result $? 'energy of a series of fixed order'
# The linear equations that constraints leave at a place, against those of coordinates that fulfil them
awk -v rest=minimal.spec -f "$root/tests/cases.awk" "$root/tests/mechanisms/pairs.cases" >pairs
numbers() {
	"$PLGEN" --at "$2" --explain=json "$1" 2>>log | tr -d '\n' |
		sed 's/.*"ss": *\(.*\)"Phi": *\(.*\)"order".*/\1 \2/' | grep -o '[-0-9.e]*[0-9]\|"[^"]*"'
}
while read -r name; do
	[ "$name" != four_bar ] || merging || continue                   # a second
	: >log
	place=$(sed -n 's/^# at //p' "$name.spec")
	numbers "$name.spec" "$place" >held
	numbers "$name.minimal.spec" "$place" >free
	paste held free | awk '
		$1 ~ /^"/ && $2 ~ /^"/ { next }
		{ d = $1 - $2; size = $1*$1 > 1 ? $1*$1 : 1; wrong += NF != 2
		  worst = d*d/size > worst ? d*d/size : worst }
		END { print NR " numbers differ by " sqrt(worst) " of themselves, at most 1e-14"
		      exit !(NR > 30 && !wrong && worst < 1e-28) }' >>log
	result $? "$name: linear equations as in minimal coordinates"
done <pairs
# Of a linkage there are two ways to close it: its equilibria are those of one, and others
if merging; then
	for name in four_bar four_bar.minimal; do
		"$PLGEN" --equilibrium "$name.spec" 2>>log |
			sed -n 's/^[0-9]*: a = \([^,;]*\).*; /a \1 /p; s/^    *[-0-9]/&/p' >"$name.found"
	done
	sort -u four_bar.found >both
	sort -u four_bar.minimal.found | comm -23 - both >log
	cat four_bar.minimal.found >>log
	test "$(wc -l <four_bar.minimal.found)" -eq 5 && test "$(wc -l <log)" -eq 5
	result $? 'equilibria of a linkage, and their poles, as in minimal coordinates'
fi
# Second derivatives of sines are shifts: a link of a chain takes 4 products of sequences, where it took 13
for model in chain robot_arm; do
	"$PLGEN" --scheme taylor "$root/models/$model.spec" 2>>log |
		sed -n 's/^ \* One step of h.* \([0-9]*\) multiplications.*/\1/p'
done | tr '\n' ' ' >cost
awk '{ print "multiplications of a chain and of an arm: " $1 " " $2 ", at most 18000 and 3000"
	exit !($1 > 5000 && $1 < 18000 && $2 > 1000 && $2 < 3000) }' cost >log
result $? 'second derivatives of sines cost no products'
# The energy changes by the power: of a moving support, a force, a damper, of network elements too
cat >power.spec <<'SPEC'
model power
coord x, th
let X = x + sin(th), Y = -cos(th)
energy T = 1/2*(X'^2 + Y'^2), V = 9.81*Y + 20*(x - 0.1*sin(3*t))^2
mass 3 at x
damper 0.5 between x, th
force cos(5*t) on x
output energy, power
tolerance 1e-13
step 0.001
SPEC
"$plrun" power.spec 2 2>log | awk -F , 'NR > 1 { E[NR] = $2; P[NR] = $3 }
	END { for (k = 3; k < NR; k++) { d = (E[k + 1] - E[k - 1])/0.002 - P[k]; worst = d*d > worst*worst ? d : worst }
	      print "the power is off the differences of the energy by " worst
	      exit !(NR > 2000 && worst*worst < 1e-8) }' >>log
result $? 'the power is the slope of the energy'
# A cart that is free to move: upright and hanging, its pole by hand +-sqrt((M + m)g/(M l)), and i times that
for start in 0.1 3; do
	sed "s/^init th = .*/init th = $start/" "$cases/cart_and_pole.spec" >cart.spec
	"$PLGEN" --at rest --explain cart.spec >log 2>&1 && case $start in
		3) grep -q '0 +- 4\.6456431 i' log ;;
		*) grep -q '^ *-4\.6456431 ' log && grep -q '^ *4\.6456431 ' log ;;
	esac
	result $? "the poles of a cart and pole at rest near th = $start"
done
# Two pendulums of mass and length 1: w^2 l/g is 2 -+ sqrt(2) where both hang or stand, and +-sqrt(2) between
sed -e 's/^init q = .*/init q = [0.2; 0.1]/' "$cases/pair_energies.spec" >two.spec
"$PLGEN" --equilibrium two.spec >log 2>&1 && awk '/^[0-9]+:/ { kind = $0 ~ /3.14159/; both = $0 ~ /3.14159.*3.14159/ }
	/^    [-0-9]/ { p = $1 ~ /^-?0$/ ? -$3*$3 : $1*$1; r = p/9.81; n++
		root = sqrt(2)
		good += !kind && (near(r, root - 2) || near(r, -root - 2)) ||
			both && (near(r, 2 - root) || near(r, 2 + root)) ||
			kind && !both && (near(r, root) || near(r, -root)) }
	function near(a, b) { return (a - b)^2 < 1e-12 }
	END { print n " poles, " good " of them as by hand"; exit !(n == 12 && good == n) }' log >>log
result $? 'the equilibria of two pendulums, and their poles'
"$PLGEN" --equilibrium --explain=json -o log.json "$cases/cart_and_pole.spec" 2>&1 && tr -d ' \n' <log.json >log
grep -q '"at":{"x":0,"th":0},"stability":"unstable","free":\["x"\]' log &&
	grep -q '"at":{"x":0,"th":3.1415926535897931},"stability":"marginal","free":\["x"\]' log
result $? 'equilibria for a program: a cart is free to move'
# -sin(a) (1 + 2 cos(a)) is 0 at 0, at pi and at +-2 pi/3, each of them once though the search starts at one of them
printf "model wells\ncoord a\nenergy T = a'^2/2, V = cos(a) + cos(2*a)/2\nstep 0.01\n" >wells.spec
"$PLGEN" --equilibrium wells.spec >log 2>&1
test "$(sed -n 's/^[0-9]*: a = \(.*\)/\1/p' log | sort -g)" = "-2.094395102; marginal
0; unstable
2.094395102; marginal
3.141592654; unstable"
result $? 'all equilibria of a potential with two wells'
# A flat arch: roots of 1000 (s - sqrt(1.0025)) y/s + 0.01, s = sqrt(1 + y^2), by mpmath; far starts meet the outer ones
printf "model arch\ncoord y\nenergy T = y'^2/2, V = 500*(sqrt(1 + y^2) - sqrt(1.0025))^2 + y/100\nstep 1\n" >arch
"$PLGEN" --equilibrium arch >log 2>&1
test "$(sed -n 's/^[0-9]*: y = \(.*\); \(.*\)/\1 \2/p' log | sort -g)" = "-0.05361061259 marginal
0.008228236685 unstable
0.04536737279 marginal"
result $? 'the state of an arch between two'
"$PLGEN" --explain=json "$root/models/swing_arm.spec" 2>log | grep -A 3 drawing >>log
grep -qF '"what": "wheel", "at": ["across", "wheel"], "radius": "r"}]' log && grep -qF '"from": ["0", "z"], "to"' log
result $? 'what is drawn, for a program'
# A chain without weight turns as a whole; a cart without friction moves; a weight holds the chain
sed -e '/^energy/s/, V.*//' "$cases/triple.spec" >turning.spec
"$PLGEN" --explain turning.spec 2>log | grep -qF 'no equation changes: q[1] + q[2] + q[3].' &&
	"$PLGEN" --explain "$root/models/cart_pole.spec" 2>log | grep -qF 'no equation depends on them: x.' &&
	"$PLGEN" --explain=json "$cases/triple.spec" 2>log | grep -qF '"free": []'
result $? 'cyclic coordinates and rigid directions'
# The crane's trolley rests where the beam is lowest, in its middle, and the rope hangs: the modes carry m g there
"$PLGEN" --equilibrium - <"$root/models/crane.spec" >log 2>&1
awk '/^[0-9]+:/ { gsub(/[,;]/, ""); rests = $4 == 10 && $NF == "stable" && $16 == 0; count++
		w = -1100*9.81/(4e7*20/2*(atan2(0, -1)/20)^4); if (rests && near($7, w) && near($13, -w/81)) found++ }
	/memory/ { without++ }
	function near(a, b) { return (a - b)^2 < 1e-18 }
	END { print count " equilibria, " found + 0 " as by hand, " without + 0 " without poles"
	      exit !(count == 6 && found == 1 && without == 0) }' log >>log
result $? 'the equilibria of a crane on its beam, and their poles'
# What falls has none
cat >falls.spec <<'SPEC'
model falls
coord x
energy T = x'^2/2, V = x
step 0.01
SPEC
! "$PLGEN" --equilibrium falls.spec >log 2>&1 && grep -q 'no equilibrium is found from' log
result $? 'no equilibrium of what falls'
# M = 2 cos(a) vanishes at pi/2, which the motion reaches at 0.20492...: the last good state has the energy of
# the start, 4 cos(1) + 1, and stands shortly before; that time is the integral of sqrt(cos(a)/(E - a)).
printf "model ends\ncoord a\nenergy T = cos(a)*a'^2, V = a\ninit a = 1, a' = 2\nstep 0.01\n" >ends.spec
cat >kept.c <<'C'
#include "ends.h"
#include <math.h>
#include <stdio.h>
int main(void)
{
	ends s;
	real y[2], near = sizeof *y == 4 ? 1e-3 : 1e-11;
	ends_init(&s);
	while (ends_status(&s) == 0 && s.k < 100)
		ends_step(&s);
	ends_get(&s, y);
	const double left = acos(-1)/2 - y[0], off = cos(y[0])*y[1]*y[1] + y[0] - 4*cos(1) - 1;
	printf("status %d, %g before pi/2, energy off by %g\n", ends_status(&s), left, off);
	return s.k != 21 || ends_status(&s) != PL_SINGULAR_MASS || fabs(left) > near ||
		   fabs(off) > (near > 1e-9 ? 0.1 : 1e-3);
}
C
for options in '--scheme taylor' '--scheme radau' '--scheme auto' '--real float'; do
	real=double
	[ "$options" = '--real float' ] && real=float
	# shellcheck disable=SC2086
	"$PLGEN" $options --bundle ends.spec -o ends.c 2>log && $run_cc -Dreal=$real kept.c ends.c -lm -o kept 2>log &&
		./kept >log
	result $? "a singular mass keeps the last good state, $options"
done
# Two coordinates of det M = cos(a) - 0.01: p = b' + a'/10 and a'^2 det/2 stay, so det is 0 at the integral of
# sqrt(det/(2 E)) from 1 to acos(0.01), 0.18500: these schemes say so in that step, the 19th, and keep a state with
# det M above 0. Steps of fixed length may land anywhere behind, in float those by tolerance too.
cat >two.spec <<'SPEC'
model two
coord a, b
energy T = cos(a)*a'^2/2 + b'^2/2 + a'*b'/10
init a = 1, a' = 2.053086
step 0.01
SPEC
cat >two_kept.c <<'C'
#include "two.h"
#include <math.h>
#include <stdio.h>
int main(void)
{
	two s;
	real y[4];
	double x = 1, end = acos(0.01), t = 0, h = (end - 1)/100000;
	for (; x < end - h/2; x += h)
		t += sqrt((cos(x + h/2) - 0.01)/(cos(1) - 0.01))/2.053086*h;
	two_init(&s);
	while (two_status(&s) == 0 && s.k < 100)
		two_step(&s);
	two_get(&s, y);
	printf("status %d in step %d, det %g; it is 0 at t = %g\n", two_status(&s), (int)s.k, cos(y[0]) - 0.01, t);
	return s.k != (unsigned)ceil(t/0.01) || two_status(&s) != PL_SINGULAR_MASS || !(cos(y[0]) > 0.01);
}
C
while read -r real scheme; do
	{ cat two.spec; [ -z "$scheme" ] || echo "scheme $scheme"; } >scheme.spec
	"$PLGEN" --real $real --bundle scheme.spec -o two.c 2>log &&
		$run_cc -Dreal=$real two_kept.c two.c -lm -o kept 2>log && ./kept >log
	result $? "a mass matrix that becomes singular within a step, $real, $scheme"
done <<-'SCHEMES'
	double taylor 6
	float taylor 12
	double taylor 12 over 5
	float taylor 12 over 5
	double taylor
	float taylor
	double radau
	float radau
	double auto
	float auto
	double etdcol
	float etdam4
SCHEMES
# x^2 = 1 - 2 t where M = x^2: it touches 0 at t = 0.5, and no sign changes
printf "model touch\ncoord x\nenergy T = x^2*x'^2/2\ninit x = 1, x' = -1\nstep 0.01\n" >touch.spec
for scheme in 'taylor 6' 'taylor 12 over 5' taylor radau etdrk4 etdcol nc2; do
	"$plrun" --scheme "$scheme" touch.spec 1 2>log | tail -n 1 >>log
	grep -q 't = 0.51*: the mass matrix is singular' log && awk -F , 'NR == 2 { exit !($2 > 0 && $2 < 0.2) }' log
	result $? "a mass matrix that touches a singular one, $scheme"
done
# One that is not symmetric: det M = cos(a)^2 - 1/50, of two blocks whose pivots change their signs together
cat >blocks.spec <<'SPEC'
model two
coord a, b, c
cos(a)*a'' + c'' + 0*b'' = sin(a)*a'^2/2
a''/50 + cos(a)*c'' = 0
cos(a)*b'' = 1
init a = 1, a' = 2
scheme taylor 8
output det = cos(a)^2 - 1/50
step 0.01
SPEC
"$plrun" blocks.spec 1 >blocks.csv 2>log
[ $? = 1 ] && awk -F , 'NR > 1 && $2 < 0 { bad = 1 }
	END { print "det " $2 " at " $1; exit bad || NR > 40 }' blocks.csv >>log &&
	grep -qF 'the mass matrix is singular' log
result $? 'a mass matrix that is not symmetric becomes singular'
"$plrun" ends.spec 1 >ends.csv 2>log
[ $? = 1 ] && [ "$(tail -n 1 ends.csv | cut -d , -f 1)" = 0.2 ] &&
	grep -qF 't = 0.21: the mass matrix is singular, or gradients of constraints depend on each other' log
result $? 'a singular mass, what plrun prints'
# On the axes x y = 0 the gradient (y, x) vanishes where they cross, at t = 1: that state is kept
cat >axes.spec <<'SPEC'
model axes
coord x, y
energy T = (x'^2 + y'^2)/2
constraint axes: x*y = 0
init x = 1, x' = -1
scheme taylor
step 0.25
SPEC
"$plrun" axes.spec 2 >axes.csv 2>log
[ $? = 1 ] && [ "$(tail -n 1 axes.csv)" = '0.75,0.25,0,-1,0' ] &&
	grep -qF 't = 1: the mass matrix is singular, or gradients of constraints depend on each other' log
result $? 'gradients of constraints that vanish'
# Six links at rest at one angle: the last begin to move by high powers of time, by rounding at first
sed -e 's/14\]/6]/g;/^tol/d;s/^init.*/init q = [1; 1; 1; 1; 1; 1]\/10/' \
	-e 's/^output.*/friction 2 between q[1], ground/' \
	-e '/^step/i stop between sum(sin(q)), ground at 0.7 restitution 0.5' "$cases/chain_of_fourteen.spec" >rest.spec
for scheme in taylor radau; do
	"$plrun" --scheme $scheme rest.spec 0.5 2>log | tail -n 1
done | awk -F , '{ for (i = 1; i <= NF; i++) { d = $i - was[i]; was[i] = $i
		if (NR == 2 && d*d > worst) worst = d*d } }
	END { print "radau is off taylor by " sqrt(worst)
	      exit !(NR == 2 && was[1] == 0.5 && sqrt(worst) < 1e-7) }' >>log
result $? 'a chain at rest with contacts, by radau'
# A stop of an expression that stands before friction of its velocity
printf "model block\ncoord x\nx'' + x + max(x - 0.2, 0) + friction(x', 0.3) = 2*sin(0.7*t)\n" >block.spec
printf "stop between x, ground at 0.5 restitution 0\ninit x' = 1\nstep 0.01\n" >>block.spec
for scheme in exact taylor; do
	"$plrun" --scheme $scheme block.spec 18 --every 1 2>>log
done | awk -F , '$1 ~ /t/ { run++ }
	run == 1 { x[$1] = $2; rests += $2 == 0.5 && $3 == 0 }
	run == 2 && $1 !~ /t/ { d = $2 - x[$1]; worst = d*d > worst ? d*d : worst }
	END { print "regions are off a series by " sqrt(worst) ", at most 1e-12; " rests " rows at rest"
	      exit !(run == 2 && rests > 1 && worst < 1e-24) }' >>log
result $? 'friction beside a stop of the same coordinate'
# Long runs: the energy of chains of 2 and 3 links over 2,500,000 expansions, of 10 over 500,000, relative to where it
# starts; a constraint and its rate over 10,000,000 expansions
if long; then
	while read -r links start until step bound <&3; do
		sed "s/q\[10\]/q[$links]/; s/^init.*/init q = [$start]/; /^output/d" "$root/models/chain.spec" \
			>chain.spec
		printf 'output energy\nscheme taylor 24\n' >>chain.spec
		"$plrun" --step "$step" chain.spec "$until" --every 100 2>>log | awk -F , -v bound="$bound" '
			NR == 2 { start = $2 }
			NR > 2 { d = $2/start - 1; worst = d*d > worst*worst ? d : worst }
			END { print NR " rows, the energy is off by " worst ", at most " bound
			      exit !(NR > 10 && worst*worst < bound*bound) }' >log
		result $? "the energy of a chain of $links links, $until s"
	done 3<<-END
		2 1;1.1 50000 0.02 1e-13
		3 1;1.1;1.2 50000 0.02 1e-13
		10 1;1.1;1.2;1.3;1.4;1.5;1.6;1.7;1.8;1.9 1000 0.002 1e-11
	END
	sed '/^output/d; /^tolerance/d' "$cases/pendulum_cartesian.spec" >rod.spec
	printf 'output miss = x^2 + y^2 - 1, rate = x*x'"'"' + y*y'"'"'\nscheme taylor 22\n' >>rod.spec
	"$plrun" --step 0.02 rod.spec 200000 --every 20 2>>log | awk -F , '
		NR > 1 { miss = $2*$2 > miss*miss ? $2 : miss; rate = $3*$3 > rate*rate ? $3 : rate }
		END { print NR " rows, missed by " miss ", at most 1e-15; its rate by " rate ", at most 4e-15"
		      exit !(NR > 9000 && miss*miss < 1e-30 && rate*rate < 1.6e-29) }' >log
	result $? 'a constraint over 10,000,000 expansions'
fi
tap_end
