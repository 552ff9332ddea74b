#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# factor.sh PLGEN SOURCE_ROOT: outputs with a tunable factor, with --reduce: what is kept is a state without the factor.
# Against the whole model with the same values written down, output by output, to 1e-12 of the largest. And ranges of
# params, which NAME_retune looks at: of a linear model, of one that reads params in its step, of regions, of what
# follows from params.
root=$2
. "${0%/*}/../plgen.sh"

cat >bare.spec <<'EOS'
model bare
param m = 2, k = 50, c = 0.5, g = 3
coord a, b
input u hold first
init a = 0.125, b' = 0.5
output pull = k*(a - b)
output rub = 2*c/g*(a' - b')
output both = k*(a - b) + c*(a' - b') + g*u
m*a'' + c*(a' - b') + k*(a - b) = cos(3*t) + u
m*b'' + c*(b' - a') + k*(b - a) = 0
step 1/64
EOS
{ sed 2q bare.spec; echo 'tunable m, k, c, g'; sed 1,2d bare.spec; } >tuned.spec

# rows NAME VALUE ...: 4 s of it, with a ramp that turns
awk 'BEGIN { for (k = 0; k <= 256; k++) print k % 40 < 20 ? 1 : -0.5 }' >u
rows() {
	name=$1
	shift
	$run_cc -DMODEL=bare -I"$root/runtime" "$root/runtime/host/plmain.c" "$name.c" "$archive" \
		-lm -o "run_$name" >>log 2>&1 && "./run_$name" 4 "$@" <u >"$name.csv" 2>>log
}

# close A B: of each column the largest difference is within 1e-12 of its largest value; and it is not 0 everywhere
close() {
	awk -F, 'FNR == 1 { next }
		NR == FNR { for (i = 2; i <= NF; i++) one[FNR, i] = $i; rows = FNR; next }
		{ for (i = 2; i <= NF; i++) {
			d = $i - one[FNR, i]; d = d < 0 ? -d : d; v = $i < 0 ? -$i : $i
			worst[i] = d <= worst[i] ? worst[i] : d
			largest[i] = v > largest[i] ? v : largest[i]
		} columns = NF }
		END {
			for (i = 2; i <= columns; i++) {
				printf "column %d: off by %g of %g\n", i, worst[i], largest[i]
				bad = bad || !(largest[i] > 0.01) || !(worst[i] <= 1e-12 * largest[i])
			}
			exit bad || columns != 4 || rows != 258 || FNR != rows
		}' "$1" "$2" >log
}

"$plgen" --reduce tuned.spec -o tuned.c >log 2>&1 && "$plgen" --reduce --explain tuned.spec >explained 2>>log
result $? 'outputs with tunable factors are no obstacle'
sed -n '/^Reduced to/,/^Gone/p' explained >log
grep -q ' 2 of 4 states' log && grep -q 'state state1 = a - b$' log && grep -q "state state1' = a' - b'\$" log
result $? 'what is kept has no factor'

cat >gear.spec <<'EOS'
model gear
param k = 50
tunable k
coord a, b
output twist = k*(0.001*a - b)
a'' + 0.001*k*(0.001*a - b) = cos(3*t)
b'' + k*(b - 0.001*a) = 0
step 1/64
EOS
"$plgen" --reduce --explain gear.spec >explained 2>log
sed -n '/^Reduced to/,/^Gone/p' explained >>log
grep -q "state state1 = -0.001\*a + b\$" log && grep -q "state state1' = -0.001\*a' + b'\$" log
result $? 'what is kept has no large factor'

for values in 'm=2 k=50 c=0.5 g=3' 'm=3 k=70 c=0.25 g=4' 'm=2.5 k=-20 c=1 g=-0.5'; do
	options=
	for value in $values; do
		options="$options -D $value"
	done
	: >log
	# shellcheck disable=SC2086
	"$plgen" $options bare.spec -o whole.c >>log 2>&1 && rows whole && rows tuned $values &&
		close whole.csv tuned.csv
	result $? "with $values, as the whole model"
done


# ---- ranges ----
while IFS='|' read -r name equation; do
	for real in double float; do
		printf 'model m\nparam k = 50, c = 0.5\ntunable c, k in [12.5, 100]\ncoord x\ninit x = 1\n' >m.spec
		printf '%s\nstep 1/64\n' "$equation" >>m.spec
		cat >ends.c <<'EOS'
#include "m.c"
#include <stdio.h>
#include <string.h>
typedef REAL real;
int main(void)
{
	static const struct { real k; int status; } at[] = {
		{ 12.5, 0 }, { 100, 0 }, { 12.4999, PL_OUT_OF_RANGE }, { (real)100.001, PL_OUT_OF_RANGE },
		{ -50, PL_OUT_OF_RANGE }, { 50, 0 }
	};
	int wrong = 0;
	for (int i = 0; i < 6; i++) {
		m_coeffs before = m_nominal, c = m_nominal;
		const real params[2] = { (real)0.5, at[i].k };
		const int status = m_retune(&c, params, (real)M_H);
		const int stays = memcmp(&c, &before, sizeof c) == 0;
		printf("k = %.9g: %d, expected %d; coefficients %s\n", (double)at[i].k, status, at[i].status,
			stays ? "as they were" : "new");
		wrong += status != at[i].status || (status != 0 && !stays) || (at[i].k != 50 && status == 0 && stays);
	}
	return wrong != 0;
}
EOS
		"$plgen" --real $real m.spec >m.c 2>log &&
			$run_cc -DREAL=$real -I"$root/runtime" ends.c "$archive" -lm -o ends >>log 2>&1 && ./ends >>log
		result $? "$name, $real: a param outside of its range is refused, and changes nothing"
	done
done <<'EOS'
a linear model|x'' + c*x' + k*x = 0
a nonlinear model|x'' + c*x' + k*x + k*x^3 = 0
regions|x'' + c*x' + k*max(x, 0) = -1
what follows from params|x'' + c*x' + sqrt(k)*x = 0
EOS
tap_end
