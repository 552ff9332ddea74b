# SPDX-License-Identifier: GPL-3.0-or-later
# told.py SOURCE_ROOT, in the folder where python.sh has left specs, records and rows: a line `good NAME`, `bad NAME` or
# `skip NAME: why` for each case, `end` when all have been told.
import copy
import os
import pickle
import re
import sys
import threading
import warnings

import numpy as np

import plgen
from plgen import Error, Model, RunError

root = sys.argv[1]


def case(name, good, *told):
    if not good:
        for one in told:
            print('#', *str(one).split('\n')[:6])
    print('good' if good else 'bad', name)


def model(name, *more, **params):
    return Model(os.path.join(root, 'models', name + '.spec'), *more, **params)


def rows(name, m):
    return np.fromfile(name + '.rows', dtype=m.dtype).reshape(-1, len(m.outputs) + 1)


def same(a, b):
    return a.shape == b.shape and a.dtype == b.dtype and a.tobytes() == b.tobytes()


def beside(name, m, y, how=''):
    other = rows(name, m)
    good = len(y) > 10 and same(y, other[:, 1:].copy()) and same(m.t, other[:, 0].copy())
    case('{}{}: the rows and times of plmain.c'.format(name, how), good, m, y[:2], other[:2], m.t[:3])


def message(of, call):
    try:
        call()
    except of as why:
        return str(why)
    return 'nothing was raised'


def refuses(name, expected, call, of=Error):
    said = message(of, call)
    case('refuses ' + name, said == expected, 'expected', expected, 'said', said)


record = np.loadtxt('held.csv', delimiter=',', skiprows=1)
count = 256

# ---- rows ----
m = model('sdcsf')
beside('sdcsf', m, m.run(2000))
whole = rows('sdcsf', m)
m.reset()
pieces = [m.run(n) for n in (700, 1, 0, 1299)]
case('pieces put together are one run', same(np.concatenate(pieces), whole[:, 1:].copy()), [len(p) for p in pieces])
m.reset()
stepped = np.array([m.out()] + [m.step() for k in range(50)])
case('step by step', same(stepped, whole[:51, 1:].copy()))
m.reset()
given = np.full((2001, 4), np.nan)
case("rows in an array of the caller's", m.run(2000, out=given) is given and same(given, whole[:, 1:].copy()))
y = model('sdcsf').run(2000, blocks=True)
off = np.abs(y - whole[:, 1:]).max()
case('by NAME_run, with rounding of its own', 0 < off < 1e-12, off)
m = Model('held.spec')
y = m.run(record, blocks=True)
other = Model('held.spec')
case('... of a tunable model the same', same(y, other.run(record)) and np.allclose(m.t, other.t, rtol=1e-15, atol=0))
m = Model('hard.spec')
case('... and what goes wrong', message(RunError, lambda: m.run(100, blocks=True)) ==
     'hard: t = 0.4: the step has left the finite numbers')
case('start=False leaves out the row of now', same(model('sdcsf').run(30, start=False), whole[1:31, 1:].copy()))
m = model('sdcsf', k2=80.5)
beside('weaker', m, m.run(500))
m = model('sdcsf', {'k2': '161/2'})
beside('weaker', m, m.run(500), ', by an expression')
m = model('stop')
beside('stop', m, m.run(5000))
m = model('pendulum')
beside('pendulum', m, m.run(100))
m = Model('held.spec')
beside('held', m, m.run(record[:count + 1]))
m = Model(open('held.spec').read())
beside('held', m, m.run({'push': record[:count + 1, 0], 'base': list(record[:count + 1, 1])}),
       ', a text and columns by name')
for name in 'held', 'smooth', 'single':
    m = Model('smooth.spec' if name == 'smooth' else 'held.spec', real='float' if name == 'single' else None)
    most = 2 if name == 'smooth' else 1
    y = [m.run(record[:40])]
    t = [m.t]
    for a, b in (40, 41), (41, 200), (200, count + most):
        y.append(m.run(record[a:b]))
        t.append(m.t)
    m._t = np.concatenate(t)
    beside(name, m, np.concatenate(y), ' in pieces')
m = Model('plain.spec')
u = np.ascontiguousarray(record[:count])
y = m.run(u)
case('held inputs: a row more than samples', len(y) == count + 1 and len(m.t) == count + 1)

# ---- params ----
m = Model('held.spec', k=70.25, c=0.1)
beside('tuned', m, m.run(record[:count + 1]))
code = m._code
m.reset()
beside('tuned', m, m.run(record[:count + 1]), ', after reset')
m = Model('held.spec')
m.params['k'] = 70.25
m.retune(c=0.1)
case('a tunable param compiles nothing', m.tunable == ('k', 'c') and m._code.library._name == code.library._name)
beside('tuned', m, m.run(record[:count + 1]), ' later')
case('params read back', dict(m.params) == {'k': 70.25, 'c': 0.1}, dict(m.params))
a, b = Model('held.spec', k=60), Model('held.spec', k=60, m=2.5)
a.run(record[:30])
y, t = a.state, a.time
a.params['m'] = 2.5
case('another param: state, time and tuned ones stay', same(a.state, y) and a.time == t and a.params['k'] == 60 and
     a.params['m'] == 2.5, a.params)
b.set(y, t)
case('... and it goes on as the model of these params',
     same(a.run(record[:99]), b.run(record[:99])) and same(a.t, b.t))
a = Model('held.spec', step=1 / 128)
b = Model('held.spec')
b.retune(step=1 / 128)
y, other = a.run(record), b.run(record)
case('another step: with and without compiling', a.h == b.h == 1 / 128 and same(a.t, b.t) and
     np.allclose(y, other, rtol=0, atol=1e-12 * np.abs(y).max()), np.abs(y - other).max())
a = model('sdcsf', step=0.01)
a.retune(step=0.02)
case('another step of a model without tunable params', a.h == 0.02 and a.run(5).shape == (6, 4) and a.t[1] == 0.02, a)

# ---- instances ----
a = Model('held.spec')
a.run(record[:50])
b, c = a.copy(), copy.deepcopy(a)
b.params['k'] = 10
y = c.run(record[50:90])
case('copies go their own ways', same(a.run(record[50:90]), y) and a.params['k'] == 80 and c.params['k'] == 80 and
     not same(b.run(record[50:90]), y))
held = [Model('held.spec'), model('sdcsf')]
alone = [held[0].copy().run(record), held[1].copy().run(20000)]
results = [None] * 8


def work(i):
    one = held[i % 2].copy()
    results[i] = one.run(record) if i % 2 == 0 else one.run(20000)


threads = [threading.Thread(target=work, args=(i,)) for i in range(8)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
case('eight threads', all(same(results[i], alone[i % 2]) for i in range(8)))
m = model('sdcsf')
m.jump(1500)
other = model('sdcsf')
other.run(1500)
off = np.abs(m.state - other.state).max()
case('a jump is as many steps', m.time == other.time == 15.0 and off < 1e-14 < np.abs(m.state).max(), off)
m = model('sdcsf')
half, y = m.at(0.005), m.at(0.01)
m.step()
twice = model('sdcsf', step=0.005)
twice.step()
off = np.abs(y - m.state).max(), np.abs(half - twice.state).max()
case('inside a step', max(off) < 1e-15, off)
m.state = [1, 2, 3, 4]
case('a state read back, time stays', same(m.state, np.array([1.0, 2, 3, 4])) and m.time == 0.01)
m.set([0, 0, 0, 0], 2)
case('a state at another time', m.time == 2 and m.run(3).shape == (4, 4) and list(m.t) == [2, 2.01, 2.02, 2.03], m.t)
m = Model('held.spec')
case('names', m.states == ('x', 'y', "x'", "y'") and m.inputs == ('push', 'base') and
     m.outputs == ('x', 'y', 'pull', 'speed') and m.name == 'held' and m.h == 1 / 64 and list(m.params) == ['k', 'c'])

# ---- what goes wrong ----
refuses('an unknown name as plgen does', "<stdin>:3:13: error: unknown name 'foo'\nx'' + 4*x = foo\n            ^\n"
        "note: did you mean 'cos'?", lambda: Model("model a\ncoord x\nx'' + 4*x = foo\nstep 0.1\n"))
refuses('a file that is not there', 'none.spec:1:1: error: cannot read the file: No such file or directory',
        lambda: Model('none.spec'))
said = message(Error, lambda: Model('held.spec', kk=3)), message(Error, lambda: Model('held.spec').retune(kk=3))
case('refuses a param that is not there', "'kk'" in said[0] and said[1] == said[0], said)
refuses('a step of 0', 'held: the step is not above 0', lambda: Model('held.spec').retune(step=0.0))
m = Model('held.spec')
message(Error, lambda: m.retune(m='-'))
case('a refused param changes nothing', dict(m.params) == {'k': 80, 'c': 0.6} and
     same(m.run(record), Model('held.spec').run(record)))
m = Model('hard.spec')
try:
    m.run(100)
    case('a run that leaves the finite numbers', False)
except RunError as why:
    y = Model('hard.spec').run(3)
    case('a run that leaves the finite numbers', str(why) == 'hard: t = 0.4: the step has left the finite numbers' and
         same(why.rows, y) and len(why.t) == 4 and why.status == m.status == 1, why, why.rows)
refuses('a number of steps beside inputs', 'the model has inputs, run() takes their samples: push, base',
        lambda: Model('held.spec').run(5), ValueError)
refuses('a record too narrow', 'expected rows of 2 numbers, the inputs, found an array of shape (5, 3)',
        lambda: Model('held.spec').run(np.zeros((5, 3))), ValueError)
refuses('states that are not finite', 'states and time are not all finite',
        lambda: model('sdcsf').set([np.nan] * 4), ValueError)
refuses('samples that are not finite', 'the samples are not all finite',
        lambda: Model('held.spec').run(np.full((5, 2), np.inf)), ValueError)
refuses('an array of another type', 'out: expected a contiguous array of float64 of shape (6, 4)',
        lambda: model('sdcsf').run(5, out=np.zeros((6, 4), np.float32)), ValueError)
refuses('no record at all before ramps', 'too few samples: the first 1 come before the first step',
        lambda: Model('held.spec').run(np.zeros((0, 2))), ValueError)
refuses('a jump where there is none', 'held: it has no jump', lambda: Model('held.spec').jump(3))
refuses('tau beyond the step', 'tau is not in 0 .. h', lambda: model('sdcsf').at(0.02), ValueError)
with open('late.spec', 'w') as late:
    late.write("model late\ncoord x\ninput u\nx'' + x = u(t - 0.1)\nstep 0.05\n")
refuses('the state space of a delay',
        'late: inputs are delayed, so it has no state space over them: it would leave out u.delayed1; '
        'response and frf count them', lambda: Model('late.spec').ss.A)
if 'ss' in Model('late.spec').explain:
    over = Model('late.spec').response([0.5, 2.5])
    direct = np.exp(-0.2j * np.pi * np.array([0.5, 2.5])) / (1 - (2 * np.pi * np.array([0.5, 2.5])) ** 2)
    case('the response to a delayed input', over.shape == (2, 2, 1) and np.abs(over[:, 0, 0] - direct).max() < 1e-14 and
         np.abs(Model('late.spec').frf(np.pi)[0, 0] - direct[0]) < 1e-14 and
         np.abs(np.sort(Model('late.spec').poles().imag) - [-1, 1]).max() < 1e-14, over[:, 0, 0] - direct)
refuses('an input that is not there', "no input is called 'pusch'; did you mean 'push'?",
        lambda: Model('held.spec').run({'pusch': record[:5, 0], 'base': record[:5, 1]}), ValueError)
refuses('a dict without an input', "the input 'base' has no samples; expected the inputs push, base",
        lambda: Model('held.spec').step({'push': 1}), ValueError)
refuses('to read a param that is not there', '"no tunable or given param is called \'kk\'; did you mean \'k\'?"',
        lambda: Model('held.spec').params['kk'], KeyError)
refuses('the Phi of a stop', 'stop: not linear, so it has no Phi: it would leave out max(x, 0)',
        lambda: model('stop').Phi)
# k is 18000 N/m either way; the stiffness of plgen's own account says what a number given for it means
for tuned in ('', 'tunable k\n'):
    with open('measured.spec', 'w') as text:
        text.write('model measured\nparam m = 400 "kg", k = 18 "kN/m"\n' + tuned +
                   'coord z "mm"\ninput u "N"\nm*z\'\' + k*z = u\noutput z, f = k*z "kN"\nstep 1 "ms"\n')
    m = Model('measured.spec', k=36)
    case('units of a model' + (', tuned' if tuned else ''),
         m.units['f'] == 'kN' and m.units['z'] == 'mm' and m.units.states == {'z': 'm', "z'": 'm/s'} and
         m.units.inputs == {'u': 'N'} and m.explain['K'] == [[36000]] and m.params['k'] == 36,
         (m.units, m.params, m.explain['K']))
case('a model without units has none', set(Model('held.spec').units.values()) == {None}, Model('held.spec').units)
compiler = os.environ.get('CC', 'cc')
os.environ['CC'] = 'no-such-compiler'
refuses('a compiler that is not there', "there is no compiler 'no-such-compiler'; CC names another",
        lambda: model('sdcsf'))
os.environ['CC'] = compiler
header = open(os.path.join(root, 'runtime', 'plrt.h')).read()
version = int(re.search(r'PL_MODEL_VERSION = (\d+)', header).group(1))
case('its descriptor is that of plrt.h', version == plgen.VERSION, version)

# ---- what plgen tells ----
m = Model('held.spec', k=70.25)
a = np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-70.25 / 2, 70.25 / 2, -0.3, 0.3], [70.25, -73.25, 0.6, -0.6]])
value, vector = np.linalg.eig(a / 64)
phi = (vector @ np.diag(np.exp(value)) @ np.linalg.inv(vector)).real
case('Phi at the params of now', np.abs(m.Phi - phi).max() < 1e-13 < np.abs(Model('held.spec').Phi - phi).max(),
     m.Phi - phi)
told = 'ss' in m.explain
if not told:
    print('skip the state space: --explain=json tells none')
    print('skip the response: --explain=json tells none')
else:
    ss = m.ss
    B = np.array([[0, 0], [0, 0], [0.5, 0], [0, 3]])
    C = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 70.25, 0, 0], [0, 0, 1, 0]])
    D = np.array([[0, 0], [0, 0], [0, -70.25], [0, 0]])
    F = np.linalg.solve(a, phi - np.eye(4)) @ B
    good = [np.abs(x - y).max() <= 1e-13 * np.abs(y).max() for x, y in ((ss.A, a), (ss.B, B), (ss.C, C), (ss.D, D))]
    case('the state space', all(good) and ss.inputs == m.inputs and ss.outputs == m.outputs, good, ss.B)
    case('... of a step', np.abs(ss.discrete.A - phi).max() < 1e-13 and np.abs(ss.discrete.B - F).max() < 1e-13 and
         ss.discrete.h == 1 / 64, ss.discrete.B - F)
    f = np.array([0.3, 1.0, 7.5])
    direct = np.array([C @ np.linalg.inv(2j * np.pi * x * np.eye(4) - a) @ B + D for x in f])
    case('the response', m.response(f).shape == (3, 4, 2) and np.allclose(m.response(f), direct, rtol=1e-10, atol=0) and
         np.allclose(m.response(0.3), direct[0], rtol=1e-10, atol=0), m.response(f) - direct)
try:
    from scipy.signal import StateSpace, lsim
except ImportError:
    print('skip lsim: no python3-scipy')
else:
    B = np.array([[0, 0], [0, 0], [0.5, 0], [0, 3]])
    C, D = np.array([[0, 70.25, 0, 0]]), np.array([[0, -70.25]])
    m = Model('plain.spec', k=70.25)
    y = m.run(record[:200])
    t = np.arange(201) / 64
    other = lsim(StateSpace(a, B, C, D), record[:201], t, X0=[0.1, 0, 0, 0], interp=False)
    off = np.abs(y[1:, 0] - other[2][1:, 0]).max()
    case('lsim, held', off < 1e-11 * np.abs(y[:, 0]).max() and len(y) == 201, off)
    ramps = Model(open('held.spec').read().replace('input push', 'input push hold first'), k=70.25)
    y = ramps.run(record[:201])
    other = lsim(StateSpace(a, B, C, D), record[:201], t, X0=[0.1, 0, 0, 0], interp=True)
    off = np.abs(y[:, 2] - other[1].reshape(-1)).max()
    case('lsim, ramps, an output with its input', off < 1e-11 * np.abs(y[:, 2]).max(), off, y[:3, 2], other[1][:3])
# ---- one input, one output ----
ONE = """model one
param m = 2, k = 80
tunable k, m
coord x
input u
m*x'' + 0.6*x' + k*x = u
output pull = k*x
init x = 0.1
step 1/64
"""
m, wide = Model(ONE), Model(ONE, squeeze=False)
y, columns = m.run(record[:40, 0]), wide.run(record[:40, :1])
case('rows of one output have one dimension', y.shape == (41,) and columns.shape == (41, 1) and
     same(y, columns[:, 0].copy()), y.shape, columns.shape)
m.reset()
given = np.full(41, np.nan)
case("... in an array of the caller's too", m.run(record[:40, 0], out=given) is given and same(given, y))

# ---- many instances ----
values = [50, 60.5, 80, 91.25] * 20


BALL = "model ball\nparam k = 80\ntunable k\ncoord x\nx'' + k*max(x, 0) = -1\ninit x = -1\nstep 0.05\n"


def alone(spec, u, **params):
    one = Model(spec, **params)
    return one.run(u), one.t


for name, spec, u, other in (('in lanes', ONE, record[:40, 0], {'m': 1.5}),
                             ('of a model with ramps', 'held.spec', record[:99], {}),
                             ('with a peak', open('held.spec').read() + 'output largest = peak(x)\n', record[:99], {}),
                             ('of a model with loads', open('held.spec').read().replace('= push', '= push + sin(3*t)'),
                              record[:99], {}),
                             ('of a model that is not linear', BALL, 60, {})):
    m = Model(spec)
    rows = m.batch(u, {'k': values, **other}, jobs=3)
    single = [alone(spec, u, k=k, **other) for k in values[:4]]
    case('batch {}: each as it runs alone'.format(name), len(rows) == 80 and m.time == 0 and
         all(same(rows[j].copy(), single[j % 4][0]) for j in range(80)) and same(m.t, single[0][1]) and
         bool(m._lanes) == (name in ('in lanes', 'of a model with ramps', 'with a peak')), rows.shape, m._lanes,
         np.abs(rows[1] - single[1][0]).max())
m = Model('held.spec')
m.run(record[:30])
rows = m.batch(record[30:60], {'m': [2, 2.5]})
one = m.copy()
one.retune(m=2.5)
case('batch of a param that is not tunable, from where a model is', same(rows[1].copy(), one.run(record[30:60])) and
     m.time == 29 / 64, rows.shape)
refuses('arrays of params of other lengths', "params['c']: expected 3 values, found an array of shape (2,)",
        lambda: Model('held.spec').batch(record, {'k': [1, 2, 3], 'c': [1, 2]}), ValueError)
BOUND = "model hard\nparam k = 1\ntunable k in [0, 5]\ncoord x\nx'' + k*x = 0\nstep 0.1\ninit x = 1\n"
said = message(Error, lambda: Model(BOUND).batch(5, {'k': [1, -2.0]}))
case('refuses an instance that cannot be, with its values', said.startswith('with k = -2.0: hard: these values'), said)

# ---- pickling ----
m = Model('held.spec', k=70.25, matrices={})
m.run(record[:30])
other = pickle.loads(pickle.dumps(m))
case('a pickled model goes on', same(other.run(record[30:90]), m.run(record[30:90])) and same(other.t, m.t) and
     dict(other.params) == dict(m.params) and other.time == m.time)
with open('changed.spec', 'w') as f:
    f.write(ONE)
kept = pickle.dumps(Model('changed.spec'))
with open('changed.spec', 'w') as f:
    f.write(ONE.replace('0.6', '0.7'))
refuses('a pickled model of a spec that is another now',
        'one: the spec, or plgen, is another than when this was pickled', lambda: pickle.loads(kept))

# ---- units ----
SCALED = '''model scaled
param m = 2 "kg", k = 0.1 "N/mm", c = 0.5 "N*s/m"
tunable k, c
coord x "mm"
input u "kN"
m*x'' + c*x' + k*x = u
output f = k*x "kN"
init x = 3 "mm"
step 10 "ms"
'''
PLAIN = '''model scaled
param m = 2, k = 100, c = 0.5
tunable k, c
coord x
input u
m*x'' + c*x' + k*x = 1000*u
output f = k*x/1000
init x = 0.003
step 0.01
'''
m, plain = Model(SCALED, k=0.25), Model(PLAIN, k=250)
case('params in units of their own', m.params['k'] == 0.25, m.params)
y, other, written = m.run(record[:90, 0]), plain.run(record[:90, 0]), Model(SCALED, k='0.25').run(record[:90, 0])
off = np.abs(y - other).max(), np.abs(y - written).max()
case('... and a run as of the same in SI units', max(off) < 1e-13 * np.abs(other).max(), off)
rows = Model(SCALED).batch(record[:90, 0], {'k': [0.1, 0.25]})
case('... and a batch', same(rows[1].copy(), y), np.abs(rows[1] - y).max())
J, other = (Model(text).run(record[:90, 0], jac=['k', 'u'])[1][-1] for text in (SCALED, PLAIN))
case('... and derivatives, those by k per N/mm, those by u per kN', np.allclose(J, other * [1000, 1], rtol=1e-12), J, other)
os.symlink('nowhere', os.path.join(os.environ['XDG_CACHE_HOME'], 'plgen', 'making.gone'))
case('a folder of the cache that has gone since it was listed', len(Model(SCALED, m=7).run(record[:4, 0])) == 5)
m.params['m'] = 3
case('... and when another param is compiled', m.params['k'] == 0.25 and np.allclose(m.explain['K'], 250), m.params)

# ---- matrices ----
CHAIN = """model chain
matrix M = "M.mtx", K = "K.mtx", f = "f.mtx"
coord q[3]
M*q'' + K*q = f*cos(2*t)
init q[1] = 1
step 1/32
"""
K = np.array([[2 / 3, -1e-3, 0], [-0.1, 7, 0], [0, 0, np.pi]])
M = np.diag([1, 2, 3])
full = Model(CHAIN, matrices={'M': M, 'K': K, 'f': [0.5, 0, 0]})
case('matrices of NumPy, to the last bit', np.array_equal(full.explain['K'], K) and
     np.array_equal(full.explain['M'], M), full.explain['K'])
try:
    from scipy import sparse
except ImportError:
    print('skip matrices of SciPy: no python3-scipy')
else:
    twice = sparse.coo_matrix(([0.25, 0.25], ([0, 0], [0, 0])), shape=(3, 1))
    m = Model(CHAIN, matrices={'M': sparse.csc_matrix(M), 'K': sparse.csr_matrix(K), 'f': twice})
    case('matrices of SciPy are the same', same(m.run(99), full.run(99)))
refuses('a matrix of complex numbers', "matrix 'K': expected real numbers, found complex128",
        lambda: Model(CHAIN, matrices={'K': 1j * K}), ValueError)
refuses('a matrix with infinity', "matrix 'K': its entries are not all finite",
        lambda: Model(CHAIN, matrices={'K': K + np.inf}), ValueError)

# ---- linear equations of what is not linear ----
BENT = """model bent
param k = 3
coord x, y
input u
x'' + 0.2*x' + sin(x) + x*y = u
y' + k*y = x^2
init x = 0.5
output f = x*y
output x
step 0.01
scheme taylor
"""


def slope(x, y):
    return np.array([[0, 0, 1], [2 * x, -3, 0], [-np.cos(x) - y, -x, -0.2]])


m = Model(BENT)
A, B, C, D = m.linearise(at={'x': 0.25, 'y': 0.5, "x'": 2})
case('at a point: by the derivatives written out', m.states == ('x', 'y', "x'") and
     np.abs(A - slope(0.25, 0.5)).max() < 1e-15 and np.array_equal(B.ravel(), [0, 0, 1]) and
     np.abs(C - [[0.5, 0.25, 0], [1, 0, 0]]).max() < 1e-15, A - slope(0.25, 0.5), C)
case('jac', np.abs(m.jac(0, [0.25, 0.5, 2]) - slope(0.25, 0.5)).max() < 1e-15)
m.state = [0.125, 1, 0]
case('where it is now', np.abs(m.ss(at='now').A - slope(0.125, 1)).max() < 1e-15, m.ss(at='now').A)
with warnings.catch_warnings(record=True) as told:
    warnings.simplefilter('always')
    poles = m.poles()
    roots = np.linalg.eigvals(slope(0, 0))
    far = min(np.abs(poles[:, None] - roots).min(axis=1).max(), np.abs(poles[:, None] - roots).min(axis=0).max())
    case('at rest without a word of where, and that is said', far < 1e-12 and len(told) == 1 and
         str(told[0].message) == 'bent: not linear, and linearised at rest: x = 0, y = 0', far,
         [str(w.message) for w in told])
at_rest = m.linearise()
direct = at_rest.C @ np.linalg.solve(2j * np.eye(3) - at_rest.A, at_rest.B)
case('its stability', at_rest.stability == 'stable' and np.real(at_rest.poles).max() < 0, at_rest.stability)
case('its response at 2 rad/s', np.abs(m.frf(2.0, at='rest') - direct).max() < 1e-14 and at_rest.at ==
     'linearised at rest: x = 0, y = 0', at_rest.at)
# ---- derivatives, forwards and backwards: beside differences of runs, and of costs that are linear in the samples ----

spec = """model derived
param m = 2, k = 50, w = 4
coord x, z
init x = 0.01*m
input u
input r hold first
m*x'' + 0.5*x' + k*(x - z) = 3*cos(w*t) + u
z'' + k*z = r + 0.3*t
output x, acc = x'', q = k*x + 2*u
step 0.01
"""
random = np.random.default_rng(3)
record, by = random.standard_normal((101, 2)), ['m', 'k', 'w', "x'", 'u', 'r']
plain = Model(spec).run(record)
m = Model(spec)
y, J = m.run(record, jac=by)
off = [abs((Model(spec, **{p: v + 1e-4}).run(record) - Model(spec, **{p: v - 1e-4}).run(record)) / 2e-4
           - J[:, :, by.index(p)]).max() / abs(J[:, :, by.index(p)]).max() for p, v in (('m', 2), ('k', 50), ('w', 4))]
case('jac: rows as without, derivatives within 1e-7 of differences', same(y, plain) and max(off) < 1e-7, off)
first = Model(spec)
pieces = [first.run(record[:41], jac=by)[1], first.run(record[41:], jac=by)[1]]
case('jac: pieces put together are one run', same(np.concatenate(pieces), J))
w = random.standard_normal(y.shape)
m.reset()
pb, ub = m.vjp(record, w, by, snapshots=5)
forward = np.einsum('ri,rip->p', w, J)
case('vjp: the sums of weighted derivatives, within 1e-12', np.allclose(pb, forward, rtol=1e-12), pb, forward)
found = []
for place in ((0, 0), (0, 1), (37, 0), (37, 1), (99, 0), (100, 1)):
    other = record.copy()
    other[place] += 1
    found.append((((Model(spec).run(other) - plain) * w).sum(), ub[place]))
case('vjp: by samples, as costs differ', np.allclose(*np.array(found).T, rtol=1e-10), found)
m.reset()
ub = m.vjp(record, w, ['m', 'r'])[1]
case('vjp: no number for samples of an input that is not named', np.isnan(ub[:, 0]).all() and not np.isnan(ub[:, 1]).any(),
     ub[:3])
m.reset()
refuses('weights of another shape than the rows', 'w: expected an array as the rows, of shape {}, found {}'.format(
        y.shape, y.T.shape), lambda: m.vjp(record, w.T, by), ValueError)
case('vjp: after that as before', same(m.vjp(record, w, by, snapshots=5)[0], pb))
refuses('jac without a name', 'jac: no name; True takes those of the statement `sensitivity`',
        lambda: m.run(record, jac=[]), ValueError)
try:
    from scipy.optimize import least_squares
    ring = 'model ring\nparam k = 40, c = 0.5\ncoord x\ninit x = 0.02\n2*x\'\' + c*x\' + k*x = 0\noutput x\nstep 0.02\n'
    measured, names, m = Model(ring, k=50, c=0.8).run(150), ['k', 'c'], Model(ring)

    def moved(p):
        m.retune(**dict(zip(names, p)))
        m.reset()
        return m.run(len(measured) - 1, jac=names)

    fitted = least_squares(lambda p: moved(p)[0] - measured, [40, 0.5], jac=lambda p: moved(p)[1], x_scale='jac')
    case('least_squares on jac', np.allclose(fitted.x, [50, 0.8], rtol=1e-7), fitted)
    page = open(root + '/doc/python.md').read()
    text = page[page.index('### A trajectory'):]
    block = [part.split('\n', 1)[1] for part in text.split('```')[1:4:2]]
    open('carriage.spec', 'w').write(block[0])
    exec(block[1])
    push, step = found.x, np.where(np.arange(101) == 10, 1e-6, 0)
    by_steps = [(ends(push + step)[of] - ends(push - step)[of]) / 2e-6 for of in range(2)]
    case('a trajectory through an impact: it ends where it is to, as python.md says',
         np.allclose(ends(push), goal, atol=1e-6) and abs(found.fun - 191.37) < 0.01, found.fun, ends(push))
    case('a trajectory through an impact: gradients within 1e-6 of differences',
         np.allclose([slope(push, of)[10] for of in range(2)], by_steps, atol=1e-6), by_steps)
except ImportError:
    print('skip least_squares: no SciPy')
refuses('jac without a statement', 'derived: its spec has no statement `sensitivity`: jac=["k", "x"]',
        lambda: Model(spec).run(record, jac=True))

print('end')
