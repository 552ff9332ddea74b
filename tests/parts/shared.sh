#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# shared.sh PLGEN PLRUN SOURCE_ROOT: the parts of share/parts, found from anywhere, against the standards' own formulas:
# roads by the power of their octaves, shocks by their change of velocity, sweeps by their cycles, a record by itself.
set -u
plgen=$(realpath "$1")
plrun=$(realpath "$2")
root=$(cd "$3" && pwd) || exit 99
. "$root/tests/tap.sh"
PLGEN_RUNTIME=$root/runtime
XDG_CACHE_HOME=$work/cache
export PLGEN_RUNTIME XDG_CACHE_HOME
CC=tcc
command -v tcc >log || CC='cc -O0'
export CC

# ---- ISO 8608 ----

cat >roads.spec <<'END'
model roads
coord x
use "road_iso8608.spec" as a with roughness = 1, v = 20
use "road_iso8608.spec" as c with roughness = 3, v = 20
use "road_iso8608.spec" as h with roughness = 8, v = 20, track = 1
use "road_iso8608.spec" as later with roughness = 3, v = 20, lag = 0.125
x' = a.rate
output a.height, c.height, h.height, later.height, x
step 1/128
END
# Power of each octave of n, by a Fourier transform of 8192 samples under Hann's window, against the integral of
# Gd(n0) (n/n0)^-2; Gd(n0) as the standard's table C.2 has it
cat >roads.py <<'END'
import cmath, math, sys
rows = [line.split(',') for line in open('roads.csv')][1:8193]
columns = [[float(r[i]) for r in rows] for i in range(1, 6)]
def transform(x):
    if len(x) == 1:
        return x
    even, odd, n = transform(x[::2]), transform(x[1::2]), len(x)
    turned = [cmath.exp(-2j * math.pi * k / n) * odd[k] for k in range(n // 2)]
    return [e + t for e, t in zip(even, turned)] + [e - t for e, t in zip(even, turned)]
N, dt, v = 8192, 1 / 128, 20.0
assert len(rows) == N
window = [1 - math.cos(2 * math.pi * k / N) for k in range(N)]
energy, wrong = sum(w * w for w in window), 0
for name, column, table in ('C', 1, 256e-6), ('H', 2, 262144e-6):
    size = [abs(z) ** 2 for z in transform([x * w for x, w in zip(columns[column], window)])[:N // 2]]
    power = [2 * s / (N * energy) for s in size]
    for k in range(8):
        low, high = 2 ** (k - 6.5), 2 ** (k - 5.5)
        got = sum(p for i, p in enumerate(power) if low <= i / (N * dt) / v < high)
        want = table * 0.1 ** 2 * (1 / low - 1 / high)
        if k == 3:      # has n0 in it
            print(name, 'Gd(n0)', got / (0.1 ** 2 * (1 / low - 1 / high)), table)
        if not abs(got / want - 1) < (0.02 if k else 0.05):
            print(name, 'octave', k, got, want)
            wrong = 1
a, c, h, later, travelled = columns
off = max(abs(y - (x - a[0])) for x, y in zip(a, travelled))
print('rate integrated', off)
wrong |= off > 1e-12
print('C less 4 A', max(abs(y - 4 * x) for x, y in zip(a, c)))
wrong |= max(abs(y - 4 * x) for x, y in zip(a, c)) > 1e-13
wrong |= max(abs(later[k + 16] - c[k]) for k in range(N - 16)) > 1e-12
dot = lambda x, y: sum(p * q for p, q in zip(x, y))
print('of two tracks', dot(c, h) / math.sqrt(dot(c, c) * dot(h, h)))
wrong |= abs(dot(c, h)) > 0.3 * math.sqrt(dot(c, c) * dot(h, h))
sys.exit(wrong)
END
"$plrun" roads.spec 64 >roads.csv 2>log && python roads.py >>log 2>&1
result $? "roads of ISO 8608: $(grep Gd log | tr '\n' ';')"

# ---- shocks, sweeps, records ----

printf '%s\n' 'model shocked' 'coord x' 'use "half_sine.spec" as shock with A = 300, D = 0.011, start = 0.0123' \
    "x'' = shock.acc" "output x'" 'step 0.01' >shocked.spec
"$plgen" --solution 0.03 shocked.spec >out 2>log && awk -F, 'NR > 1 { pi = 4 * atan2(1, 1); s = $1 - 0.0123
    want = s < 0 ? 0 : 300 * 0.011 / pi * (s > 0.011 ? 2 : 1 - cos(pi * s / 0.011))
    print $1, $2, want; if ($2 - want > 1e-13 || want - $2 > 1e-13) wrong = 1 }
    END { exit wrong || NR != 5 }' out >>log
result $? 'half-sine shock: velocities, 2 A D/pi in all'

# 10 to 100 Hz by 20 octaves a minute: (f1 - f0)/a cycles, each with two zeros; then 100 Hz
printf '%s\n' 'model swept' 'coord x' 'use "swept_sine.spec" as s with A = 3, f1 = 100, rate = 20' "x' + x = 0" \
    'output s.acc' 'step 0.0004' >swept.spec
"$plrun" swept.spec 12 >out 2>log && awk -F, 'BEGIN { a = 20 * log(2) / 60; T = log(10) / a; f = 10 }
    NR > 2 { if ((last < 0) != ($2 < 0)) { zeros++; if ($1 > T) { n++; if (n == 1) first = $1; end = $1 } }
        if ($2 > most) most = $2 } { last = $2 }
    END { want = 2 * 90 / a + 2 * 100 * (12 - T); late = (n - 1) / (end - first) / 2
        print zeros, want, late, most
        exit !(zeros > want - 2 && zeros < want + 2 && late > 99.9 && late < 100.1 && most > 2.99 && most <= 3) }' \
    out >>log
result $? "swept sine: its cycles: $(tail -n 1 log)"

printf '%s\n' 'model played' 'coord x' 'use "record.spec" as quake with scale = 2, offset = 1' "x' = quake.signal" \
    'output x' 'step 0.5' >played.spec
printf '%s\n' t,quake.record 0,1 1,2 2,5 >quake.csv
"$plrun" played.spec 2 --input quake.csv >out 2>log && [ "$(tail -n 1 out)" = 2,6 ]
result $? "a record that is played: $(tail -n 1 out)"

# A file beside the spec comes first; a path is what it says
printf 'model half_sine\noutput acc = 7\n' >half_sine.spec
sed -i 's/ with A.*//' shocked.spec
"$plgen" --solution 0.01 shocked.spec 2>log | tail -n 1 | grep -q '^0.01,0.07' &&
    sed 's/half_sine.spec/parts\/half_sine.spec/' shocked.spec | "$plgen" - >out 2>log
[ $? -eq 1 ] && grep -q "cannot read 'parts/half_sine.spec'" log
result $? 'a part of the same name beside the spec, and a path that is none'
tap_end
