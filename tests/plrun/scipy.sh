#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Against SciPy: lsim on a recorded road and a ramp, solve_ivp on a pendulum and on the lines of a sweep, welch on power
# spectral densities.
#
#     scipy.sh PLRUN PLGEN SOURCE_ROOT
. "${0%/*}/begin.sh"
python=
for one in python3 /usr/bin/python3; do         # the distribution's may not be the first in PATH
	[ -n "$python" ] || ! "$one" -c 'import scipy' 2>/dev/null || python=$one
done
if [ -z "$python" ]; then
	skip scipy 'no python3-scipy'
	tap_end
fi
cat >car.spec <<'X'
model car
param m = 300, k = 18000, c = 1200, mw = 30, kt = 150000
tunable k, c
coord body, wheel
input road hold first
m*body'' + c*(body' - wheel') + k*(body - wheel) = 0
mw*wheel'' - c*(body' - wheel') - k*(body - wheel) + kt*(wheel - road) = 0
step 0.002
X
sed 's/ hold first//' car.spec >held.spec
cat >pendulum.spec <<'X'
model pendulum
param g = 9.81, L = 1, d = 0.1
coord x
x'' + d*x' + g/L*sin(x) = 0
init x = 2
step 0.01
X
# a road as loggers give it: every 0.01 s, from its 1st second on, with a decimal comma
awk 'BEGIN { print "Zeit;Profil"; srand(7); for (k = 0; k <= 600; k++) { r += (rand() - 0.5) * 0.004
	s = sprintf("%.2f;%.6f", 1 + k * 0.01, r); gsub(/\./, ",", s); print s } }' >road.csv
awk 'BEGIN { print "road"; for (k = 0; k <= 3000; k++) printf "%.17g\n", k < 500 ? k / 500 * 0.1 : 0.1 }' >ramp.csv
awk 'BEGIN { print "k,c"; for (i = 0; i < 6; i++) print 12000 + 3000 * i "," 600 + 300 * i }' >params.csv
awk 'BEGIN { print "L,d"; for (i = 0; i < 4; i++) print 0.5 + 0.5 * i "," 0.1 * i }' >lengths.csv
cat >beside.py <<'X'
import sys
import numpy as np
from scipy.integrate import solve_ivp
from scipy.signal import get_window, lsim, StateSpace, welch


def car(k=18000.0, c=1200.0, m=300.0, mw=30.0, kt=150000.0):
    a = [[0, 0, 1, 0], [0, 0, 0, 1], [-k / m, k / m, -c / m, c / m],
         [k / mw, -(k + kt) / mw, c / mw, -c / mw]]
    return StateSpace(a, [[0], [0], [0], [kt / mw]], np.eye(4), np.zeros((4, 1)))


def rows(name):
    return np.genfromtxt(name, delimiter=',', skip_header=1)


def say(name, mine, other, bound):
    off = np.max(np.abs(mine - other), axis=0) / np.max(np.abs(other), axis=0)
    good = mine.shape == other.shape and bool(np.all(off < bound))
    if not good:
        print('#', name, 'off by', off, 'of the largest, bound', bound)
    print('good' if good else 'bad', name)


def of_line(line, count):
    return np.array([float(x) for x in line.rstrip('\n').split(',')[:count]])


road = [line.replace(',', '.').split(';') for line in open('road.csv').read().split('\n')[1:-1]]
t, r = np.array([[float(a), float(b)] for a, b in road]).T
mine = rows('road_out.csv')
grid = 0.002 * np.arange(len(mine))
_, y, _ = lsim(car(), np.interp(grid, t - t[0], r), grid, interp=True)
say('a recorded road, resampled, by lsim', mine[:, 1:], y, 1e-9)
u = rows('ramp.csv')
grid = 0.002 * np.arange(len(u))
say('a ramp by lsim', rows('ramp_out.csv')[:, 1:], lsim(car(), u, grid, interp=True)[1], 1e-9)
say('held samples by lsim', rows('held_out.csv')[:, 1:], lsim(car(), np.append(u, 0), 0.002 * np.arange(len(u) + 1),
                                                             interp=False)[1], 1e-9)
lines = open('sweep_out.csv').read().split('\n')[1:-1]
mine = np.array([of_line(x, 15)[3:] for x in lines])
other = []
for line in lines:
    _, k, c = of_line(line, 3)
    y = lsim(car(k, c), u, grid, interp=True)[1]
    other.append(np.concatenate([y[-1], np.sqrt(np.mean(y**2, axis=0)), np.max(np.abs(y), axis=0)]))
say('a sweep by lsim', mine, np.array(other), 1e-8)


def density(name, run, **how):
    """Column 1 of densities against welch; their sum against the mean square of its segments (Parseval)"""
    y, mine = rows(run)[:, 1], rows(name)
    f, other = welch(y, fs=1 / 0.002, detrend='constant', scaling='density', **how)
    say('frequencies of ' + name, mine[:, :1], f[:, None], 1e-12)
    say('densities of ' + name, mine[:, 1:], other[:, None], 1e-9)
    n, w = how['nperseg'], get_window(how['window'], how['nperseg'])
    parts = [y[k:k + n] - np.mean(y[k:k + n]) for k in range(0, len(y) - n + 1, n - how['noverlap'])]
    square = np.mean([np.sum((w * part)**2) / np.sum(w**2) for part in parts])
    say('the sum of ' + name, np.array([[np.sum(mine[:, 1]) * (f[1] - f[0])]]), np.array([[square]]), 1e-9)


density('psd_hann.csv', 'ramp_out.csv', window='hann', nperseg=1024, noverlap=512)
density('psd_flattop.csv', 'ramp_out.csv', window='flattop', nperseg=256, noverlap=64)
density('psd_boxcar.csv', 'ramp_out.csv', window='boxcar', nperseg=512, noverlap=0)
density('psd_hamming.csv', 'ramp_out.csv', window='hamming', nperseg=16, noverlap=15)
density('psd_blackman.csv', 'ramp_out.csv', window='blackman', nperseg=2048, noverlap=1024)


def pendulum(length=1.0, d=0.1, until=10.0):
    t = 0.01 * np.arange(int(round(until / 0.01)) + 1)
    return solve_ivp(lambda t, y: [y[1], -d * y[1] - 9.81 / length * np.sin(y[0])], [0, until], [2.0, 0.0],
                     method='DOP853', t_eval=t, rtol=1e-13, atol=1e-13).y.T


say('a pendulum by solve_ivp', rows('pendulum_out.csv')[:, 1:], pendulum(), 1e-7)
lines = open('lengths_out.csv').read().split('\n')[1:-1]
mine = np.array([of_line(x, 7)[3:] for x in lines])
other = []
for line in lines:
    _, length, d = of_line(line, 3)
    y = pendulum(length, d)
    other.append(np.concatenate([y[-1], np.sqrt(np.mean(y**2, axis=0))]))
say('a sweep by solve_ivp', mine, np.array(other), 1e-7)
X
run car.spec --input road.csv --time Zeit --column road=Profil >road_out.csv || cat said
run car.spec --input ramp.csv >ramp_out.csv || cat said
for how in hann:1024:50 flattop:256:25 boxcar:512:0 hamming:16:94 blackman:2048; do
	run car.spec --input ramp.csv --psd $how --show body >psd_${how%%:*}.csv || cat said
done
run held.spec --input ramp.csv >held_out.csv || cat said
run car.spec --input ramp.csv --sweep params.csv --peak >sweep_out.csv || cat said
run pendulum.spec 10 >pendulum_out.csv || cat said
run pendulum.spec 10 --sweep lengths.csv >lengths_out.csv || cat said
"$python" beside.py >told 2>&1 || cat told
grep -v '^good\|^bad' told >log
while read -r how name; do
	case $how in
		good) result 0 "$name" ;;
		bad) result 1 "$name" ;;
	esac
done <told
[ "$(grep -c '^good\|^bad' told)" -eq 21 ]
result $? 'all were compared'
tap_end
