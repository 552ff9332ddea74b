# SPDX-License-Identifier: MIT-0
"""Models of plgen as Python objects: one file, NumPy, plgen and a C compiler.

    from plgen import Model
    m = Model("own.spec", k=60)             # a file, or the text of a spec
    y = m.run(1000)                         # rows x outputs: now, and after each step; m.t has their times
    m.params["k"] = 70                      # a tunable param: nothing is compiled

plgen writes C, the compiler makes a shared object of it, and that is kept where plrun keeps its own ($XDG_CACHE_HOME or
~/.cache, there plgen/). Numbers are those of NAME_step and NAME_out, bit for bit. doc/python.md has examples.
"""
import ctypes
import hashlib
import json
import os
import shlex
import shutil
import subprocess
import tempfile
import time
import warnings
from collections.abc import Mapping
from fractions import Fraction

import numpy as np

__all__ = ['Model', 'Error', 'RunError', 'StateSpace']

VERSION = 2             # PL_MODEL_VERSION: the shape of the descriptor below
STATUS = ((2, 'the step has met more crossings, or needed a longer search for them, than its bound'),
          (1, 'the step has left the finite numbers'),
          (4, 'the step needed more substeps than its bound'),
          (8, 'the last terms of the step are above the tolerance'),
          (16, 'what is to stick and what is to slip at an event had no answer'),
          (32, 'a state has left the range that the spec gives it'),
          (64, 'the step has ended beyond a stop'))
REFUSED = {8: 'the step is not above 0', 16: "with these values a load's frequency is below 0",
           4: 'with these values the mass matrix has no inverse',
           32: 'these values are outside of the ranges that the spec gives, or make other regions: a restitution not '
               'within 0 and 1, a gap or a force of friction below 0, breakpoints in another order'}
BLOCK = 1 << 20         # steps between two looks at Ctrl-C


class Error(Exception):
    """What plgen or the compiler says about a model, or why the model cannot do what it is asked for."""


class RunError(Error):
    """A step went wrong. rows: the outputs before it; t: their times; status: the bits of NAME_status."""

    def __init__(self, text, rows, t, status):
        super().__init__(text)
        self.rows, self.t, self.status = rows, t, status


class StateSpace:
    """x' = A x + B u + B1 u', y = C x + D u + D1 u'; B1 and D1 are None where no u' acts.

    inputs, outputs, states: names. h: None; of the discrete one, whose u is held over a step, the step, and x' is the
    state a step later. discrete: that one, or None."""

    def __init__(self, told, column, states, h=None):
        def matrix(key, rows):
            if key not in told:
                return None
            return np.array(told[key], dtype=float).reshape(rows, -1)[:, column]
        self.states, self.h = states, h
        self.A = np.array(told['A'], dtype=float).reshape(len(states), len(states))
        rows = len(told['C'])
        self.B, self.B1 = matrix('B', len(states)), matrix('B_slope', len(states))
        self.C = np.array(told['C'], dtype=float).reshape(rows, len(states))
        self.D, self.D1 = matrix('D', rows), matrix('D_slope', rows)
        self.inputs = self.outputs = ()
        self.discrete = None

    def response(self, f):
        """y over u at the frequencies f [Hz], complex: f's shape x outputs x inputs."""
        f = np.asarray(f, dtype=float)
        at = np.exp(2j * np.pi * f * self.h) if self.h else 2j * np.pi * f
        at = at.reshape(f.shape + (1, 1))
        B = self.B if self.B1 is None else self.B + at * self.B1
        D = self.D if self.D1 is None else self.D + at * self.D1
        x = np.linalg.solve(at * np.eye(len(self.A)) - self.A, np.broadcast_to(B, f.shape + self.B.shape))
        return self.C @ x + D


# ---- programs: plgen, the compiler, what they make ----

def _program(name):
    return shutil.which(name) if os.sep not in name else name if os.access(name, os.X_OK) else None


def _plgen():
    here = os.path.dirname(os.path.abspath(__file__))
    place = [os.environ.get('PLGEN')]
    for way in ('', '../../../bin', '../../build'):         # beside, installed, in the source tree
        place.append(os.path.join(here, way, 'plgen'))
    for path in place:
        if path and os.path.isfile(path) and os.access(path, os.X_OK):
            return os.path.normpath(path)
    found = _program(os.environ.get('PLGEN') or 'plgen')
    if not found:
        raise Error('there is no plgen beside plgen.py, nor in PATH; PLGEN names one')
    return found


def _runtime(plgen):
    here, there = os.path.dirname(os.path.abspath(__file__)), os.path.dirname(os.path.realpath(plgen))
    place = [os.environ.get('PLGEN_RUNTIME')]
    place += [os.path.join(there, '../share/plgen/runtime'), os.path.join(there, '../runtime')]
    place += [os.path.join(here, '../runtime'), os.path.join(here, '../../runtime')]
    for path in place:
        if path and os.path.isfile(os.path.join(path, 'plrt.h')):
            return os.path.normpath(path)
    raise Error('the runtime, plrt.h, is not there; PLGEN_RUNTIME names its folder')


def _cache():
    cache, home = os.environ.get('XDG_CACHE_HOME', ''), os.environ.get('HOME', '')
    if cache.startswith('/'):
        folder = os.path.join(cache, 'plgen')
    elif home.startswith('/'):
        folder = os.path.join(home, '.cache', 'plgen')
    else:
        raise Error('neither XDG_CACHE_HOME nor HOME says where to keep what is compiled')
    os.makedirs(folder, exist_ok=True)
    return folder


def _run(argv, text=None):
    """Output and messages of a program; text: its standard input."""
    try:
        done = subprocess.run(argv, input=text or '', stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              encoding='utf-8', errors='surrogateescape')
    except OSError as why:
        raise Error('cannot start {}: {}'.format(argv[0], why.strerror)) from None
    return done.returncode, done.stdout, done.stderr


class _Compiler:
    """The compiler, the runtime, and a key of all that they are."""

    def __init__(self, plgen):
        said = os.environ.get('CC', '').strip() or 'cc'
        self.words = [said] if os.sep in said and os.access(said, os.X_OK) else shlex.split(said)
        self.runtime = _runtime(plgen)
        found = _program(self.words[0])
        if not found:
            raise Error("there is no compiler '{}'; CC names another".format(self.words[0]))
        file = os.stat(os.path.realpath(found))
        self.words += ['-O2', '-fPIC', '-w'] + shlex.split(os.environ.get('CFLAGS', '')) + ['-I', self.runtime]
        self.sources = []
        key = hashlib.sha256(repr((self.words, os.path.realpath(found), file.st_size, file.st_mtime_ns)).encode())
        for name in sorted(os.listdir(self.runtime)):
            if name.endswith(('.c', '.h')):
                with open(os.path.join(self.runtime, name), 'rb') as f:
                    key.update(name.encode() + b'\0' + f.read())
                if name.endswith('.c'):
                    self.sources.append(name)
        self.key = key

    def _compile(self, words):
        status, _, said = _run(self.words + words)
        if status:
            raise Error("the compiler '{}' could not make a program of the model:\n{}".format(self.words[0], said))

    def _runtime_object(self, single, work, path):
        """turnsf.c is what turns.c is, for models in float."""
        floats = [name for name in self.sources if name[-3] == 'f' and name[:-3] + '.c' in self.sources]
        chosen = [os.path.join(self.runtime, name) for name in self.sources if (name in floats) == single]
        made = os.path.join(work, 'runtime.o')
        self._compile(['-nostdlib', '-r'] + chosen + ['-o', made])
        os.replace(made, path)

    def shared_object(self, name, single, code, anew):
        """The path of the compiled code in the cache. It is made in a folder of its own and renamed into its place, so
        two at a time do no harm."""
        cache, key = _cache(), self.key.copy()
        runtime = os.path.join(cache, 'runtime{}-{}.o'.format('f' if single else '', key.hexdigest()[:32]))
        key.update(code.encode('utf-8', 'surrogateescape'))
        path = os.path.join(cache, '{}-{}.so'.format(name, key.hexdigest()[:32]))
        if os.path.exists(path) and not anew:
            return path
        work = tempfile.mkdtemp(prefix='making.', dir=cache)
        try:
            if anew or not os.path.exists(runtime):
                self._runtime_object(single, work, runtime)
            source, made = os.path.join(work, 'model.c'), os.path.join(work, 'model.so')
            with open(source, 'w', encoding='utf-8', errors='surrogateescape') as f:
                f.write(code)
            self._compile(['-shared', '-Wl,-Bsymbolic', source, runtime, '-o', made, '-lm'])
            os.replace(made, path)
        finally:
            shutil.rmtree(work, ignore_errors=True)
        for left in os.scandir(cache):          # of what was killed: after a day nobody works there
            if left.name.startswith('making.') and left.stat().st_mtime < time.time() - 86400:
                shutil.rmtree(left.path, ignore_errors=True)
        return path


# ---- a loaded model ----

# Steps one after the other, with the outputs and the time after each; it ends before the row of a step that went wrong
# where it watches, and returns how many went well.
LOOP = """
size_t plgen_rows(void *s, size_t n, const {real} *u, {real} *out, {real} *t, int watch)
{{
    size_t k;
    for (k = 0; k < n; k++) {{
        {name}_model.step(s, u ? u + k * {name}_model.inputs : NULL);
        if (watch && {name}_model.status(s))
            return k;
        if (out)
            {name}_model.out(s, out + k * {name}_model.outputs);
        t[k] = {name}_model.time(s);
    }}
    return n;
}}
"""


def _descriptor(real):
    """pl_model or pl_modelf of plrt.h, entry by entry."""
    p, size, count = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
    call = ctypes.CFUNCTYPE
    names, reals = ctypes.POINTER(ctypes.c_char_p), ctypes.POINTER(real)

    class Descriptor(ctypes.Structure):
        _fields_ = [('version', count), ('real_size', count), ('name', ctypes.c_char_p), ('size', size),
                    ('states', count), ('inputs', count), ('outputs', count), ('h', real),
                    ('state_names', names), ('input_names', names), ('output_names', names),
                    ('init', call(None, p)), ('set', call(None, p, real, p)), ('get', call(None, p, p)),
                    ('time', call(real, p)), ('step', call(None, p, p)), ('out', call(None, p, p)),
                    ('run', call(None, p, size, p, p)), ('at', call(None, p, p, real, p)),
                    ('jump', call(None, p, ctypes.c_uint64)), ('status', call(count, p)), ('params', count),
                    ('param_names', names), ('param_values', reals), ('retune', call(count, p, p, real)),
                    ('hold', call(None, p, p)), ('start_samples', ctypes.POINTER(count))]
    return Descriptor


_DESCRIPTOR = {False: _descriptor(ctypes.c_double), True: _descriptor(ctypes.c_float)}


class _Code:
    """What plgen wrote for these params: shared by all instances."""

    def __init__(self, text, notes):
        self.text, self.notes = text, notes
        self.single = '\nextern const pl_modelf ' in text
        mark = '\nextern const pl_modelf ' if self.single else '\nextern const pl_model '
        found = text.partition(mark)[2].partition(';')[0]
        if not found.endswith('_model'):
            raise Error('what plgen wrote has no descriptor')
        self.name = found[:-len('_model')]
        tunable = text.partition(' {}_param_names[] = {{'.format(self.name))[2].partition('}')[0]
        self.tunable = [word.strip().strip('"') for word in tunable.split(',') if word.strip()]

    def load(self, compiler):
        self.dtype = np.dtype(np.float32 if self.single else np.float64)
        code = self.text + LOOP.format(name=self.name, real='float' if self.single else 'double')
        for anew in (False, True):              # what a crash has left in the cache is made anew
            path = compiler.shared_object(self.name, self.single, code, anew)
            try:
                self.library = ctypes.CDLL(path)
                break
            except OSError as why:
                if anew:
                    raise Error('cannot load what was compiled: {}'.format(why)) from None
        head = (ctypes.c_int * 2).in_dll(self.library, self.name + '_model')
        if head[0] != VERSION or head[1] != self.dtype.itemsize:
            raise Error('{}: its descriptor has version {} and numbers of {} bytes, and plgen.py reads version {}'
                        .format(path, head[0], head[1], VERSION))
        self.model = m = _DESCRIPTOR[self.single].in_dll(self.library, self.name + '_model')
        self.rows = self.library.plgen_rows
        self.rows.restype = ctypes.c_size_t
        self.rows.argtypes = [ctypes.c_void_p, ctypes.c_size_t] + 3 * [ctypes.c_void_p] + [ctypes.c_int]
        self.states = tuple(m.state_names[i].decode() for i in range(m.states))
        self.inputs = tuple(m.input_names[i].decode() for i in range(m.inputs))
        self.outputs = tuple(m.output_names[i].decode() for i in range(m.outputs))
        self.values = np.array([m.param_values[i] for i in range(m.params)], dtype=self.dtype)
        self.ahead = [m.start_samples[i] for i in range(m.inputs)]
        self.most = max(self.ahead, default=0)
        return self


class Params(Mapping):
    """Tunable params, and those that were given: m.params["k"], m.params["k"] = 70."""

    def __init__(self, model):
        self._model = model

    def _all(self):
        m = self._model
        return {**m._given, **{name: float(x) for name, x in zip(m._code.tunable, m._tuned)}}

    def __getitem__(self, name):
        return self._all()[name]

    def __setitem__(self, name, value):
        self._model.retune(**{name: value})

    def __iter__(self):
        return iter(self._all())

    def __len__(self):
        return len(self._all())

    def __repr__(self):
        return repr(self._all())


def _expression(value):
    """A value as plgen reads it: an expression as it is, a number in the digits that read back as the same."""
    return str(value) if isinstance(value, (str, int, Fraction)) else repr(float(value))


class Model:
    """A model at a point of its motion; it begins at t = 0 with the spec's initial values.

    spec     a path, or, with a line's end in it, the text of a spec
    step     instead of the spec's [s]; real: 'double' or 'float'; scheme: as --scheme
    options  more of plgen's options, as a list
    params   values of params by name, numbers or expressions: a dict, or keywords. A number for a tunable param goes
             into the instance by NAME_retune (initial values stay those of the spec); any other makes another model

    states, inputs, outputs, params: names (params: with their values). h: the step [s]. notes: what plgen remarked."""

    def __init__(self, spec, params=None, *, step=None, real=None, scheme=None, options=(), **more):
        text = isinstance(spec, str) and '\n' in spec
        self._spec, self._text = ('-', spec) if text else (os.fspath(spec), None)
        self._options = list(options)
        for name, value in (('--real', real), ('--scheme', scheme)):
            if value is not None:
                self._options += [name, str(value)]
        self._step = step
        self._given, self._tuned, self._code = {}, (), None
        self._told = None
        self._build({**(params or {}), **more}, step)

    # ---- making it ----

    def _plgen(self, given, step, extra=()):
        argv = [_plgen(), '--fast'] + self._options + list(extra)
        if step is not None:
            argv += ['--step', _expression(step)]
        for name, value in given.items():
            argv += ['-D', '{}={}'.format(name, _expression(value))]
        status, out, said = _run(argv + ['--', self._spec], self._text)
        if status:
            raise Error(said.strip() or 'plgen ended with status {}'.format(status))
        return out, said

    def _build(self, params, step):
        """Compiles for these params; only when all is well it becomes this model's own."""
        expressions = {n: v for n, v in params.items() if isinstance(v, str)}
        code = _Code(*self._plgen(expressions, step))
        fixed = {n: v for n, v in params.items() if n in expressions or n not in code.tunable}
        if len(fixed) > len(expressions):
            code = _Code(*self._plgen(fixed, step))
        code.load(_Compiler(_plgen()))
        if code.notes:
            warnings.warn(code.notes.strip(), stacklevel=4)
        values = {n: v for n, v in params.items() if n not in fixed}
        before = None if self._code is None else (self._code, self.time, self.state)
        saved = dict(self.__dict__)
        try:
            self._code, self._given, self._step = code, fixed, step
            self._memory = np.zeros((code.model.size + 7) // 8 + 1, dtype=np.uint64)
            self._state = ctypes.c_void_p(self._memory.ctypes.data)
            self._tuned, self._h = code.values.copy(), code.model.h
            self.reset()
            self._tune(values, None)
            if before and before[0].states == code.states:
                self.set(before[2], before[1])
        except Exception:
            self.__dict__.clear()
            self.__dict__.update(saved)
            raise

    def copy(self):
        """Another instance at the same point; it shares the code alone."""
        other = object.__new__(Model)
        other.__dict__.update(self.__dict__)
        other._memory = self._memory.copy()
        other._state = ctypes.c_void_p(other._memory.ctypes.data)
        other._tuned, other._given = self._tuned.copy(), dict(self._given)
        return other

    __copy__ = copy

    def __deepcopy__(self, memo):
        return self.copy()

    def __reduce__(self):
        raise TypeError('a Model is compiled code and cannot be pickled; copy() makes another')

    def __repr__(self):
        return '<plgen model {}: t = {:g}, h = {:g}, outputs {}>'.format(self.name, self.time, self.h,
                                                                        ', '.join(self.outputs))

    # ---- what it is ----

    name = property(lambda self: self._code.name)
    states = property(lambda self: self._code.states)
    inputs = property(lambda self: self._code.inputs)
    outputs = property(lambda self: self._code.outputs)
    tunable = property(lambda self: tuple(self._code.tunable))
    dtype = property(lambda self: self._code.dtype, doc='of all numbers: float64 or float32')
    h = property(lambda self: self._h, doc='the step [s]')
    notes = property(lambda self: self._code.notes)
    params = property(Params)

    @property
    def t(self):
        """Times of the rows of the last run [s]."""
        if isinstance(self._t, tuple):          # of blocks: made when they are asked for
            start, h, first, end = self._t
            self._t = (start + h * np.arange(first, end)).astype(self.dtype)
        return self._t

    # ---- where it is ----

    @property
    def time(self):
        return self._code.model.time(self._state)

    @property
    def status(self):
        """0, or the bits of NAME_status: 1 not finite, 2 too many events, 4 too many substeps, 8 inaccurate, 16
        undecided, 32 a range left, 64 beyond a stop."""
        status = self._code.model.status
        return status(self._state) if status else 0

    @property
    def state(self):
        y = np.empty(len(self.states), dtype=self.dtype)
        self._code.model.get(self._state, y.ctypes.data)
        return y

    @state.setter
    def state(self, y):
        self.set(y)

    def set(self, y, t=None):
        """The states y at the time t [s], now unless it is given."""
        y = self._vector(y, len(self.states), 'states')
        self._code.model.set(self._state, self.time if t is None else t, y.ctypes.data)
        self._begin()

    def reset(self):
        """Back to t = 0 and the initial values; params stay."""
        tuned = None if np.array_equal(self._tuned, self._code.values) and self._h == self._code.model.h else self._h
        self._code.model.init(self._state)
        if tuned is not None:
            self._retune(self._tuned, self._h)
        self._begin()

    def out(self):
        """The outputs now."""
        y = np.empty(len(self.outputs), dtype=self.dtype)
        self._code.model.out(self._state, y.ctypes.data)
        return y

    def _begin(self):
        """The next record starts at its row 0."""
        self._fresh, self._tail = True, None
        self._t = np.empty(0, dtype=self.dtype)

    def _vector(self, values, size, what):
        values = np.ascontiguousarray(values, dtype=self.dtype)
        if values.shape != (size,):
            raise ValueError('expected {} numbers, the {}, found an array of shape {}'.format(size, what, values.shape))
        return values

    def _sample(self, u):
        if not self.inputs:
            if u is not None:
                raise ValueError('the model has no inputs')
            return None
        if u is None:
            raise ValueError('the model has inputs: ' + ', '.join(self.inputs))
        if isinstance(u, dict):
            u = [u[name] for name in self.inputs]
        return self._vector(np.atleast_1d(u), len(self.inputs), 'inputs')

    # ---- steps ----

    def step(self, u=None):
        """One step, u a sample of the inputs as NAME_step takes it; returns the outputs."""
        u = self._sample(u)
        self._code.model.step(self._state, None if u is None else u.ctypes.data)
        self._fresh, self._tail = False, None
        if self.status:
            raise RunError(self._trouble(self.status), np.empty((0, len(self.outputs)), self.dtype),
                           np.empty(0, self.dtype), self.status)
        return self.out()

    def hold(self, u):
        """The sample of ramps before the next step: NAME_hold."""
        u = self._sample(u)
        if self._code.most:
            self._code.model.hold(self._state, u.ctypes.data)
            self._fresh, self._tail = False, None

    def jump(self, n):
        """n steps at once, in the time of log n: NAME_jump."""
        if not self._code.model.jump:
            raise Error('{}: it has no jump'.format(self.name))
        if n < 0:
            raise ValueError('a jump goes forward')
        self._code.model.jump(self._state, int(n))
        self._fresh = False

    def at(self, tau, u=None):
        """The states tau after now, 0 <= tau <= h: NAME_at."""
        if not self._code.model.at:
            raise Error('{}: it has no states inside a step'.format(self.name))
        if not 0 <= tau <= self.h:
            raise ValueError('tau is not in 0 .. h')
        u, y = self._sample(u), np.empty(len(self.states), dtype=self.dtype)
        self._code.model.at(self._state, None if u is None else u.ctypes.data, tau, y.ctypes.data)
        return y

    def _record(self, u):
        """Samples as rows x inputs, as they are where they are so already."""
        if isinstance(u, dict):
            if set(u) != set(self.inputs):
                raise ValueError('expected the inputs ' + ', '.join(self.inputs))
            u = np.stack([np.asarray(u[name], dtype=self.dtype) for name in self.inputs], axis=1)
        u = np.ascontiguousarray(u, dtype=self.dtype)
        if u.ndim == 1 and len(self.inputs) == 1:
            u = u.reshape(-1, 1)
        if u.ndim != 2 or u.shape[1] != len(self.inputs):
            raise ValueError('expected rows of {} numbers, the inputs, found an array of shape {}'.format(
                len(self.inputs), u.shape))
        if not np.isfinite(u).all():
            raise ValueError('the samples are not all finite')
        return u

    def _samples(self, u):
        """Rows as steps take them, and how many samples come before the first: each input is as far ahead as it has
        to be. What a run has not used yet of those ahead is kept for the next."""
        c = self._code
        if c.most == 0 or (not self._fresh and self._tail is None):
            return u, 0
        whole = u if self._fresh else np.concatenate([self._tail, u])
        n = len(whole) - c.most
        if n < 0:
            raise ValueError('too few samples: the first {} come before the first step'.format(c.most))
        if min(c.ahead) == c.most:
            return whole[c.most:], n
        return np.stack([whole[a:a + n, i] for i, a in enumerate(c.ahead)], axis=1), n

    def _hold_first(self, u):
        c = self._code
        for k in range(c.most):
            row = [u[k if a == 0 else k - c.most + a, i] if a == 0 or k >= c.most - a else 0.0
                   for i, a in enumerate(c.ahead)]
            row = np.array(row, dtype=self.dtype)
            c.model.hold(self._state, row.ctypes.data)

    def run(self, u, *, out=None, start=None, blocks=False):
        """Steps; returns rows x outputs, and t has their times.

        u      how many steps; of a model with inputs a record: rows x inputs, or a dict of columns by name. Row k is
               the sample at t = k h: n steps take n rows, n + 1 where an input is a ramp (n + m with hold third ...)
        out    where to put the rows: an array of the right shape and type
        start  True: the record starts now, and the first row of the result is now, so there are n + 1. False: it goes
               on from the run before, n rows; so pieces put together are one run. By default True for a new model and
               after reset and set, else False
        blocks True: by NAME_run, which is faster where it takes many steps at once (api.md); rounding is then its own,
               and depends on where pieces begin

        RunError, with the rows so far, where a step leaves the finite numbers or its bounds."""
        first = self._fresh if start is None else start
        if self.inputs:
            if isinstance(u, (int, np.integer)):
                raise ValueError('the model has inputs, run() takes their samples: ' + ', '.join(self.inputs))
            if first:
                self._fresh, self._tail = True, None
            record = self._record(u)
            u, _ = self._samples(record)
            n = len(u)
        else:
            n, record = int(u), None
            if n != u or n < 0:
                raise ValueError('expected a number of steps, found {}'.format(u))
            u = None
        rows = self._room(out, n + bool(first))
        if record is not None:
            self._keep(record)
        first = int(bool(first))
        if first:
            if self.inputs and self._code.most:
                self._hold_first(record)
            rows[0] = self.out()
        self._fresh = False
        if blocks:
            self._t = self.time, self._h, 1 - first, n + 1
        else:
            self._t = np.empty(len(rows), dtype=self.dtype)
            self._t[:first] = self.time
        self._go(n, u, rows, first, blocks)
        return rows

    def _room(self, out, count):
        shape = (count, len(self.outputs))
        if out is None:
            return np.empty(shape, dtype=self.dtype)
        good = isinstance(out, np.ndarray) and out.shape == shape and out.dtype == self.dtype
        if not (good and out.flags.c_contiguous and out.flags.writeable):
            raise ValueError('out: expected a contiguous array of {} of shape {}'.format(self.dtype, shape))
        return out

    def _keep(self, record):
        most = self._code.most
        if most and (self._fresh or self._tail is not None):
            whole = record if self._fresh else np.concatenate([self._tail, record])
            self._tail = whole[len(whole) - most:].copy()

    def _go(self, n, u, rows, first, blocks):
        c, done = self._code, 0
        watched = bool(c.model.status)
        while done < n:
            count = min(BLOCK, n - done)
            before = self._memory.copy() if watched else None
            where = None if u is None else u[done:].ctypes.data, rows[first + done:].ctypes.data
            if blocks:
                c.model.run(self._state, count, *where)
            else:
                c.rows(self._state, count, *where, self._t[first + done:].ctypes.data, 0)
            if watched and self.status:         # which step was it?
                self._memory[:] = before
                good = c.rows(self._state, count, *where, self.t[first + done:].ctypes.data, 1)
                if good < count:
                    end = first + done + good
                    self._t = self._t[:end]
                    raise RunError(self._trouble(self.status), rows[:end], self._t, self.status)
            done += count

    def _trouble(self, status):
        said = [text for bit, text in STATUS if status & bit] or ['status {}'.format(status)]
        return '{}: t = {!r}: {}'.format(self.name, float(self.time), '; '.join(said))

    # ---- other params ----

    def _retune(self, values, h):
        status = self._code.model.retune(self._state, np.ascontiguousarray(values).ctypes.data, h)
        if status:
            raise Error('{}: {}'.format(self.name, REFUSED.get(
                status, 'with these values the numbers of the step are not finite')))

    def _takes(self, step):
        """Does an instance take this step? Where expressions read the params there is one; what is no step is told."""
        c, h = self._code, float(self.dtype.type(step))
        scratch = self._memory.copy()
        values = np.ascontiguousarray(self._tuned)
        return not h > 0 or c.model.retune(ctypes.c_void_p(scratch.ctypes.data), values.ctypes.data, h) != 8

    def _tune(self, params, step):
        values = self._tuned.copy()
        for name, value in params.items():
            values[self._code.tunable.index(name)] = value
        h = self._h if step is None else float(self.dtype.type(step))
        if params or h != self._h:
            self._retune(values, h)
            self._tuned, self._h = values, h

    def retune(self, *, step=None, **params):
        """Other values of params, and another step; state and time stay. Of tunable ones by NAME_retune, nothing is
        compiled; any other compiles a model, whose samples kept for ramps begin anew."""
        c = self._code
        numbers = all(n in c.tunable and not isinstance(v, str) for n, v in params.items())
        if numbers and (step is None or (c.model.retune and not isinstance(step, str) and self._takes(step))):
            self._tune(params, step)
        else:
            now = {n: v for n, v in self.params.items() if n in self._given or v != self._nominal(n)}
            self._build({**now, **params}, self._step_now() if step is None else step)
        self._told = None

    def _nominal(self, name):
        return float(self._code.values[self._code.tunable.index(name)])

    def _step_now(self):
        return self._step if self._h == self._code.model.h else self._h

    # ---- what plgen tells of it ----

    @property
    def explain(self):
        """--explain=json at the present params and step, as a dict."""
        if self._told is None:
            changed = {n: v for n, v in self.params.items() if n in self._given or v != self._nominal(n)}
            self._told = json.loads(self._plgen(changed, self._step_now(), ['--explain=json'])[0])
        return self._told

    @property
    def Phi(self):
        """y(t + h) = Phi y(t) + ..., correctly rounded."""
        return np.array(self._linear('Phi')['Phi'], dtype=float)

    def _linear(self, what):
        told = self.explain
        if not told['linear']:
            raise Error('{}: not linear, so it has no {}: it would leave out {}'.format(
                self.name, what, '; '.join(told['left_out'])))
        return told

    def state_space(self, loads=False):
        """StateSpace over the inputs; loads: over the spec's loads, each with its function of time as an input."""
        own = self._linear('state space')['ss']
        delayed = [name for name in own['inputs'] if '.delayed' in name]
        if delayed:
            raise Error('{}: inputs are delayed, so it has no state space over them: it would leave out {}'.format(
                self.name, ', '.join(delayed)))
        column = [i for i, name in enumerate(own['inputs']) if (name in self.inputs) != loads]
        space = StateSpace(own, column, self.states)
        if own['discrete']:
            space.discrete = StateSpace(own['discrete'], column, self.states, own['discrete']['h'])
        for one in (space, space.discrete):
            if one:
                one.inputs, one.outputs = tuple(own['inputs'][i] for i in column), tuple(own['outputs'])
        return space

    @property
    def ss(self):
        """The state space over the inputs: A, B, C, D; discrete has those of a step."""
        return self.state_space()

    def response(self, f, loads=False):
        """Outputs over inputs at f [Hz], complex: f's shape x outputs x inputs."""
        return self.state_space(loads).response(f)
