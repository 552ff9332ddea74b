#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Six people who are new to plgen: the first session of each as they typed it, in a folder of its own. Numbers are
# compared with closed forms, the classical Runge-Kutta method on the equations written again, and NumPy.
#
#     users.sh PLGEN SOURCE_ROOT
set -u
here=$(cd "${0%/*}" && pwd) || exit 99
python=
for one in python3 /usr/bin/python3; do         # the distribution's may not be the first in PATH
	[ -n "$python" ] || ! "$one" -c 'import numpy' 2>/dev/null || python=$one
done
. "$here/begin.sh"
PATH=$(dirname "$PLGEN"):$PATH
export PATH

# user NAME: the folder of the next one
user() {
	mkdir "$work/$1" && cd "$work/$1" || exit 99
	: >log
}

# ---- half a car whose tyres lift off and whose rear wheel follows the front one ----

user car
cat >half.spec <<'END'
model half
param m = 1100 "kg", J = 1500 "kg m^2", mw = 40 "kg", k = 22 "kN/m", c = 1.5 "kN s/m", kt = 180 "kN/m"
param a = 1.1 "m", b = 1.4 "m", v = 36 "km/h", g = 9.81 "m/s^2"
coord z "m", th, zf "m", zr "m"
input road "m" hold first
let sf = k*(zf - z + a*th) + c*(zf' - z' + a*th')
let sr = k*(zr - z - b*th) + c*(zr' - z' - b*th')
let late = road(t - (a + b)/v)
m*z'' = sf + sr
J*th'' = b*sr - a*sf
mw*zf'' = kt*max(road - zf, -(mw + m*b/(a + b))*g/kt) - sf
mw*zr'' = kt*max(late - zr, -(mw + m*a/(a + b))*g/kt) - sr
output z "mm", th, front = zf "mm", rear = zr "mm", lift = road - zf "mm", seat = z'' "m/s^2"
step 1 "ms"
END
awk 'BEGIN { print "t,road"; for (k = 0; k <= 1500; k++) { s = k - 200
	printf "%.3f,%.17g\n", k / 1000, (s > 0 && s < 60 ? 0.09 * sin(3.14159265358979 * s / 60)^2 : 0) } }' >bump.csv
plrun half.spec --input bump.csv --plot half.svg --show z,front+rear >rows.csv 2>log &&
	plrun half.spec --input bump.csv --stats >stats.csv 2>>log && grep -q '<path' half.svg &&
	plgen --response 0.5:20:3 half.spec >response.csv 2>>log && grep -q 'linearised at rest' log
result $? 'car: a run, its picture, statistics, its linear response'
cat >car.awk <<'END'
function slope(t, y, d,    i, r, l, sf, sr) {
	r = road(t); l = road(t - 0.25)
	sf = 22000 * (y[3] - y[1] + 1.1 * y[2]) + 1500 * (y[7] - y[5] + 1.1 * y[6])
	sr = 22000 * (y[4] - y[1] - 1.4 * y[2]) + 1500 * (y[8] - y[5] - 1.4 * y[6])
	for (i = 1; i < 5; i++) d[i] = y[i + 4]
	d[5] = (sf + sr) / 1100; d[6] = (1.4 * sr - 1.1 * sf) / 1500
	d[7] = (180000 * atleast(r - y[3], -(40 + 1100 * 1.4 / 2.5) * 9.81 / 180000) - sf) / 40
	d[8] = (180000 * atleast(l - y[4], -(40 + 1100 * 1.1 / 2.5) * 9.81 / 180000) - sr) / 40
}
function atleast(x, least) { return x > least ? x : least }
function road(t,    k) {
	if (t <= 0) return 0
	t *= 1000; k = int(t + 1e-9)
	return u[k] + (t - k) * (u[k + 1] - u[k])
}
FNR == NR { if (FNR > 1) u[FNR - 2] = $2; next }
FNR == 1 { next }
{
	off = ($2 / 1000 - y[1])^2 + ($3 / 1000 - y[3])^2
	worst = off > worst ? off : worst
	low = u[FNR - 2] - y[3] < low ? u[FNR - 2] - y[3] : low
	t = $1; h = 0.00025
	for (n = 0; n < 4; n++) {
		slope(t, y, p)
		for (i = 1; i < 9; i++) x[i] = y[i] + h / 2 * p[i]
		slope(t + h / 2, x, q)
		for (i = 1; i < 9; i++) x[i] = y[i] + h / 2 * q[i]
		slope(t + h / 2, x, r)
		for (i = 1; i < 9; i++) x[i] = y[i] + h * r[i]
		slope(t + h, x, w)
		for (i = 1; i < 9; i++) y[i] += h / 6 * (p[i] + 2 * q[i] + 2 * r[i] + w[i])
		t += h
	}
}
END { print sqrt(worst), low; exit !(FNR == 1502 && sqrt(worst) < 2e-6 && low < -0.04) }
END
awk -F, -f car.awk bump.csv rows.csv >log
result $? "car: z and front as by Runge-Kutta [m], and the tyre lifts: $(cat log)"
grep '^lift,' stats.csv | awk -F, -v low="$(cut -d ' ' -f 2 log)" '{ print $5 " mm"; d = $5 / 1000 - low }
	END { exit !(NR == 1 && d < 2e-6 && d > -2e-6) }' >found
result $? "car: the least lift of --stats is of a tyre in the air: $(cat found)"

# ---- a drive whose stiffness is tuned on a board ----

user drive
cat >drive.spec <<'END'
model drive
param J1 = 0.02 "kg m^2", J2 = 0.03 "kg m^2", k = 300 "N m/rad", d = 0 "N m s/rad"
tunable k in [100, 1000]
coord motor "rad", load "rad"
input torque "N m"
J1*motor'' + d*(motor' - load') + k*(motor - load) = torque
J2*load'' + d*(load' - motor') + k*(load - motor) = 0
output twist = motor - load "mrad", speed = motor' "rpm"
step 0.5 "ms"
END
plgen --real float -o drive_pl.c --a2l drive.a2l drive.spec >log 2>&1 &&
	grep -q 'MEASUREMENT\|CHARACTERISTIC' drive.a2l &&
	plgen --explain --real float drive.spec >told 2>>log && grep -q 'On a Cortex-M4.*instructions a step' told
result $? 'drive: C in float, names for calibration, instructions on the board'
if command -v arm-none-eabi-gcc >/dev/null 2>&1; then
	arm-none-eabi-gcc -mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard -ffreestanding -Wall -Wextra -Werror -O2 \
		-I"$root/runtime" -c drive_pl.c >log 2>&1
	result $? 'drive: the C compiles for a Cortex-M4F'
else
	skip 'drive: the C compiles for a Cortex-M4F' 'no arm-none-eabi-gcc'
fi
awk 'BEGIN { print "torque"; for (k = 0; k < 400; k++) print 2 }' >push.csv
# twist = T/(J1 w^2) (1 - cos w t), w^2 = k (1/J1 + 1/J2); speed = T t/(J1 + J2) + J2/(J1 + J2) twist'
twisted() {
	awk -F, -v k="$1" 'NR > 1 { w = sqrt(k * (50 + 100 / 3)); t = $1
		off = ($2 / 1000 - 100 / w^2 * (1 - cos(w * t)))^2
		off += ($3 * 3.14159265358979 / 30 - 40 * t - 60 / w * sin(w * t))^2
		worst = off > worst ? off : worst } END { print sqrt(worst); exit !(NR == 402 && worst < 1e-20) }' "$2"
}
plrun drive.spec --input push.csv >as_is.csv 2>log && plrun drive.spec --input push.csv -D k=800 >tuned.csv 2>>log &&
	twisted 300 as_is.csv >>log && twisted 800 tuned.csv >>log
result $? "drive: twist and speed, as it is and with another k: $(tail -n 2 log | paste -s -d ' ')"
plrun drive.spec --input push.csv -D k=50 >low.csv 2>log
[ $? -eq 1 ] && grep -q '^drive: error: k = 50: outside of the range' log
result $? 'drive: a k out of its range is refused by its name'

# ---- the same as an FMU ----

plgen --fmu drive.fmu --fmu-binary drive.spec >log 2>&1
result $? 'FMU: with its binary'
cat >importer.py <<'END'
import ctypes as c, math, os, re, sys, zipfile
zipfile.ZipFile('drive.fmu').extractall('fmu')
text = open('fmu/modelDescription.xml').read()
k = re.search(r'<Float64 [^>]*name="k"[^>]*', text).group()
assert 'variability="tunable"' in k and 'start="300.0"' in k and 'unit="N m/rad"' in k, k
reference = {n: int(re.search('valueReference="([0-9]*)"', r).group(1)) for r, n in
			 ((m.group(), m.group(1)) for m in re.finditer(r'<Float64 [^>]*name="([^"]*)"[^>]*', text))}
folder = [f for f in os.listdir('fmu/binaries')][0]
lib = c.CDLL(os.path.join('fmu/binaries', folder, os.listdir('fmu/binaries/' + folder)[0]))
make = lib.fmi3InstantiateCoSimulation
make.restype = c.c_void_p
token = re.search('instantiationToken="([^"]*)"', text).group(1).encode()
one = c.c_void_p(make(b'one', token, None, *[c.c_bool(False)] * 4, None, c.c_size_t(0), None, None, None))
flag, last = c.c_bool(), c.c_double()
def put(name, value):
	assert lib.fmi3SetFloat64(one, (c.c_uint32 * 1)(reference[name]), c.c_size_t(1), (c.c_double * 1)(value),
							  c.c_size_t(1)) == 0
def get(name):
	got = (c.c_double * 1)()
	assert lib.fmi3GetFloat64(one, (c.c_uint32 * 1)(reference[name]), c.c_size_t(1), got, c.c_size_t(1)) == 0
	return got[0]
assert lib.fmi3EnterInitializationMode(one, c.c_bool(False), c.c_double(0), c.c_double(0), c.c_bool(False),
									   c.c_double(0)) == 0
put('torque', 2)
assert lib.fmi3ExitInitializationMode(one) == 0
for n in range(40):
	assert lib.fmi3DoStep(one, c.c_double(n * 0.005), c.c_double(0.005), c.c_bool(True), *[c.byref(flag)] * 3,
						  c.byref(last)) == 0
w = math.sqrt(300 * (50 + 100 / 3))
off = get('twist') / 1000 - 100 / w ** 2 * (1 - math.cos(w * 0.2))
print(get('twist'), off)
sys.exit(not abs(off) < 1e-11)
END
${python:-python3} importer.py >>log 2>&1
result $? "FMU: k is tunable, with unit and start; the twist after 40 calls: $(tail -n 1 log)"

# ---- a student's seven ----

user student
# seven NAME EXPECTED TOLERANCE T TEXT: the last value of the first output
seven() {
	printf '%b\n' "model $1" "$5" >"$1.spec"
	plrun "$1.spec" "$4" 2>log | tail -n 1 | awk -F, -v want="$2" -v within="$3" '{ print $2, want
		exit !($2 - want < within && want - $2 < within) }' >>log
	result $? "student: $1: $(tail -n 1 log)"
}
seven swing "$(awk 'BEGIN { print cos(6) }')" 1e-5 3 "coord x\ninit x = 1\nx'' + 4*x = 0\nstep 0.01"
seven damped "$(awk 'BEGIN { w = sqrt(3.75); printf "%.10f", exp(-1.5) * (cos(3 * w) + 0.5 / w * sin(3 * w)) }')" \
	1e-9 3 "coord x\ninit x = 1\nx'' + x' + 4*x = 0\nstep 0.01"
seven resonant "$(awk 'BEGIN { printf "%.10f", 10 / 4 * sin(20) }')" 1e-9 10 "coord x\nx'' + 4*x = cos(2*t)\nstep 0.01"
seven base "$(awk 'BEGIN { printf "%.10f", 4 / 3 * (sin(3) - sin(6) / 2) }')" 1e-9 3 \
	"coord x\nx'' + 4*(x - sin(t)) = 0\nstep 0.01"
seven beats "$(awk 'BEGIN { printf "%.10f", (cos(10) + cos(10 * sqrt(1.2))) / 2 }')" 1e-9 10 \
	"coord x, y\ninit x = 1\nmass 1 at x\nmass 1 at y\nspring 1 between x, ground\nspring 1 between y, ground
spring 0.1 between x, y\nstep 0.01"
seven pendulum "$(awk 'BEGIN { x = 2; h = 0.0005; for (k = 0; k < 10000; k++) { v += -sin(x) * h / 2; x += v * h
	v += -sin(x) * h / 2 } printf "%.7f", x }')" 1e-6 5 "coord x\ninit x = 2\nx'' + sin(x) = 0\nstep 0.01"
# falls 0.5 m in sqrt(1/g), is thrown up with 0.8 sqrt(g) and lands 1.6/sqrt(g) later: at 1 s it has bounced twice
seven ball "$(awk 'BEGIN { g = 9.81; d = 1 - 2.6 / sqrt(g); printf "%.10f", 0.64 * sqrt(g) * d - g * d^2 / 2 }')" \
	1e-9 1 "coord y\ninit y = 0.5\ny'' = -9.81\nstop between ground, y at 0 restitution 0.8\noutput y\nstep 0.01"

# ---- a frame in Python; the drive in Octave ----

user frame
if [ -n "$python" ]; then
	cat >frame.py <<'END'
import numpy as np
from plgen import Model
text = '''model frame
matrix M = "M.mtx"
matrix K = "K.mtx"
coord q[6]
input base
init q[6] = 0.01
M*q'' + 0.3*q' + K*q = [base; 0; 0; 0; 0; 0]
output q[1], roof = q[6]
step 0.01
'''
M = np.diag([2., 2, 2, 2, 2, 1])
K = 400 * (2 * np.eye(6) - np.eye(6, k=1) - np.eye(6, k=-1))
K[5, 5] = 400
m = Model(text, matrices={'M': M, 'K': K})
A = np.block([[np.zeros((6, 6)), np.eye(6)], [-np.linalg.solve(M, K), -0.3 * np.linalg.inv(M)]])
values, vectors = np.linalg.eig(A)
start = np.zeros(12)
start[5] = 0.01
direct = (vectors * np.exp(2 * values) @ np.linalg.solve(vectors, start)).real
got = m.run(np.zeros((200, 1)))
print('poles', abs(np.sort_complex(m.poles()) - np.sort_complex(values)).max())
print('roof', abs(got[-1, 1] - direct[5]), got.shape)
s = 2j * np.pi * 1.3
over = np.linalg.solve(s * s * M + 0.3 * s * np.eye(6) + K, np.eye(6)[:, 0])
print('response', abs(m.response(1.3)[:, 0] - over[[0, 5]]).max())
try:
	m.run({'bass': np.zeros(3)})
except ValueError as e:
	print(e)
END
	PYTHONPATH=$root/host/python PYTHONDONTWRITEBYTECODE=1 "$python" frame.py >log 2>&1 && awk '
		/^(poles|roof|response)/ && $2 < 1e-10 { good++ }
		/did you mean .base/ { good++ }
		END { exit good != 4 }' log
	result $? "frame: matrices of NumPy; $(sed -n '1,3{s/ (.*//;p;}' log | paste -s -d ' ')"
else
	skip 'frame: in Python' 'no python3-numpy'
fi
if merging; then
	user octave
	cp "$work/drive/drive.spec" .
	if command -v octave-cli >/dev/null 2>&1 && CC=$cc_given mkoctfile --mex -I"$root/runtime" -o plgen_mex.mex \
		"$root/host/octave/plgen_mex.c" >log 2>&1; then
		octave-cli --no-init-file --path "$root/host/octave" --eval '
			m = plgen_model("drive.spec", "k", 800);
			y = m.run(2 * ones(400, 1));
			w = sqrt(800 * (50 + 100 / 3));
			printf("%g\n", max(abs(y(:, 1) / 1000 - 100 / w^2 * (1 - cos(w * m.t(:))))));' >log 2>said &&
			awk 'END { exit !($1 < 1e-12) }' log
		result $? "drive in Octave: the twist: $(tail -n 1 log)"
	else
		skip 'drive in Octave' 'no octave, or no octave-dev'
	fi

	# ---- a researcher's chart ----

	user chart
	printf '%s\n' 'model swing' 'coord x' 'init x = 1' "x'' + 0.1*x' + sin(x) = 0" 'step 0.05' >swing.spec
	CC=$cc_given CFLAGS='' plrun --chart swing.spec 5 -o charts >log 2>&1 && awk -F, '
		NR > 1 && $2 == "ours" && $5 < 1e-11 { ours++ } NR > 1 && $1 ~ /DOP853/ { peers++ }
		END {
			print ours, "of ours below 1e-11,", peers, "of DOP853"
			exit !(ours && peers)
		}' charts/swing.csv >>log
	result $? "chart: $(tail -n 1 log)"
fi
tap_end
