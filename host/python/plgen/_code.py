# SPDX-License-Identifier: MIT-0
"""What stands behind a Model: plgen, the compiler, the cache, and the code that they make."""
from __future__ import annotations

import contextlib
import ctypes
import difflib
import hashlib
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any, Union

import numpy as np

Value = Union[float, int, str, Fraction]
VERSION = 2             # PL_MODEL_VERSION: the shape of the descriptor below
STATUS = ((2, 'the step has met more crossings, or needed a longer search for them, than its bound'),
          (1, 'the step has left the finite numbers'),
          (4, 'the step needed more substeps than its bound'),
          (8, 'the last terms of the step are above the tolerance'),
          (16, 'no combination of stick and slip was valid at an event'),
          (32, 'a state has left the range that the spec gives it'),
          (64, 'the step has ended beyond a stop'),
          (128, 'the mass matrix is singular, or gradients of constraints depend on each other'))
DOUBTS = ('a stop was met, or all but met, so flatly that behind it they are not known',
          'events, or peaks, fell together, or an output jumps at its peak: they are of one side',
          'no combination of stick and slip was valid', 'their own steps have failed')
REFUSED = {8: 'the step is not above 0', 16: "with these values a load's frequency is below 0",
           4: 'with these values the mass matrix has no inverse',
           32: 'these values are outside of the ranges that the spec gives, or make other regions: a restitution not '
               'within 0 and 1, a gap or a force of friction below 0, breakpoints in another order'}


class Error(Exception):
    """What plgen or the compiler says about a model, or why the model cannot do what it is asked for."""


class RunError(Error):
    """A step went wrong. rows: the outputs before it; t: their times; status: the bits of NAME_status."""

    def __init__(self, text: str, rows: np.ndarray, t: np.ndarray, status: int) -> None:
        super().__init__(text)
        self.rows, self.t, self.status = rows, t, status


def unknown(what: str, name: str, known: Iterable[str]) -> str:
    """A message about a name that is not known: with the nearest that is."""
    known = list(known)
    near = difflib.get_close_matches(str(name), known, 1)
    return "no {} is called '{}'; {}".format(
        what, name, "did you mean '{}'?".format(near[0]) if near else 'there are: ' + ', '.join(known) if known
        else 'there are none')


# ---- programs: plgen, the compiler, what they make ----

def _program(name: str) -> str | None:
    return shutil.which(name) if os.sep not in name else name if os.access(name, os.X_OK) else None


def find_plgen() -> str:
    here = os.path.dirname(os.path.abspath(__file__))
    place = [os.environ.get('PLGEN')]
    for way in ('bin', '..', '../../../../bin', '../../../build'):  # of a wheel, beside, installed, of the source tree
        place.append(os.path.join(here, way, 'plgen'))
    for path in place:
        if path and os.path.isfile(path) and os.access(path, os.X_OK):
            return os.path.normpath(path)
    found = _program(os.environ.get('PLGEN') or 'plgen')
    if not found:
        raise Error('there is no plgen beside the package, nor in PATH; PLGEN names one')
    return found


def start_plgen() -> None:
    """The command plgen of a wheel."""
    _start('plgen')


def start_plrun() -> None:
    _start('plrun')


def _start(name: str) -> None:
    program = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'bin', name)
    try:
        os.execv(program, [program] + sys.argv[1:])
    except OSError as why:
        sys.exit('{}: {}'.format(program, why.strerror))


def _runtime(plgen: str) -> str:
    here, there = os.path.dirname(os.path.abspath(__file__)), os.path.dirname(os.path.realpath(plgen))
    place = [os.environ.get('PLGEN_RUNTIME')]
    place += [os.path.join(there, '../share/plgen/runtime'), os.path.join(there, '../runtime')]
    place += [os.path.join(here, way) for way in ('runtime', '../../runtime', '../../../runtime')]
    for path in place:
        if path and os.path.isfile(os.path.join(path, 'plrt.h')):
            return os.path.normpath(path)
    raise Error('the runtime, plrt.h, is not there; PLGEN_RUNTIME names its folder')


def _cache() -> str:
    cache, home = os.environ.get('XDG_CACHE_HOME', ''), os.environ.get('HOME', '')
    if cache.startswith('/'):
        folder = os.path.join(cache, 'plgen')
    elif home.startswith('/'):
        folder = os.path.join(home, '.cache', 'plgen')
    else:
        raise Error('neither XDG_CACHE_HOME nor HOME says where to keep what is compiled')
    os.makedirs(folder, exist_ok=True)
    return folder


def run(argv: Sequence[str], text: str | None = None) -> tuple[int, str, str]:
    """Output and messages of a program; text: its standard input."""
    try:
        done = subprocess.run(argv, input=text or '', stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              encoding='utf-8', errors='surrogateescape')
    except OSError as why:
        raise Error('cannot start {}: {}'.format(argv[0], why.strerror)) from None
    return done.returncode, done.stdout, done.stderr


class Compiler:
    """The compiler, the runtime, and a key of all that they are."""

    def __init__(self, plgen: str) -> None:
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

    def _compile(self, words: list[str]) -> None:
        status, _, said = run(self.words + words)
        if status:
            raise Error("the compiler '{}' could not make a program of the model:\n{}".format(self.words[0], said))

    def _runtime_object(self, single: bool, work: str, path: str) -> None:
        """phasesf.c is what phases.c is, for models in float."""
        floats = [name for name in self.sources if name[-3] == 'f' and name[:-3] + '.c' in self.sources]
        chosen = [os.path.join(self.runtime, name) for name in self.sources if (name in floats) == single]
        made = os.path.join(work, 'runtime.o')
        self._compile(['-nostdlib', '-r'] + chosen + ['-o', made])
        os.replace(made, path)

    def shared_object(self, name: str, single: bool, code: str, anew: bool) -> str:
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
            with contextlib.suppress(FileNotFoundError):        # another process has ended there since
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

# Behind a code with derivatives: n steps with those of the outputs; du: by an offset of each input
LOOP_D = """
size_t plgen_rows_d(void *s, void *ds, size_t n, const {real} *u, const {real} *du, {real} *out, {real} *t, {real} *J)
{{
    const size_t inputs = (size_t){name}_model.inputs, outputs = (size_t){name}_model.outputs;
    size_t k;
    for (k = 0; k < n; k++) {{
        {name}_derivatives.step(s, ds, u ? u + k * inputs : 0, du);
        if ({name}_model.status && {name}_model.status(s))
            return k;
        {name}_model.out(s, out + k * outputs);
        t[k] = {name}_model.time(s);
        {name}_derivatives.out(s, ds, J + k * outputs * (size_t){name}_derivatives.columns);
    }}
    return n;
}}
"""

# NAME_batch over `count` instances, each with params of its own; now: the outputs at the start, out: after each step
LANES = """
void plgen_lanes(size_t count, size_t n, const {real} *params, {real} h, const {real} *u, const {real} *first,
                 {real} *y, {real} *factors, {real} *peak, {real} *now, {real} *out, int *status)
{{
    const size_t tuned = (size_t){name}_model.params, outputs = (size_t){name}_model.outputs;
    {name}_instances b = {{0}};
    size_t j;
    {name} s;
    (void)u;
    (void)first;
    b.count = count;
    b.y = y;
    b.factors = factors;
    b.peak = peak;
    {name}_batch_init(&b);
    {name}_init(&s);
    {hold}
    for (j = 0; j < count; j++) {{
        {name}_coeffs c;
        status[j] = {name}_retune(&c, params + j * tuned, h);
        if (status[j] == 0)
            status[j] = {name}_batch_use(&b, j, &c);
        if (status[j] == 0)
            {name}_use(&s, &c);
        {name}_out(&s, now + j * outputs);
    }}
    {name}_batch(&b, n, {u}out);
    for (j = 0; j < count; j++)
        status[j] |= {name}_batch_status(&b, j);
}}
"""


def _descriptor(real: type) -> type[ctypes.Structure]:
    """pl_model or pl_modelf of plrt.h, entry by entry."""
    p, size, count = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
    call: Any = ctypes.CFUNCTYPE
    names, reals = ctypes.POINTER(ctypes.c_char_p), ctypes.POINTER(real)    # type: ignore[var-annotated]

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


def _derivatives(real: Any) -> type[ctypes.Structure]:
    """pl_derivatives or pl_derivativesf of plreal.h"""
    p, size, count = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int
    call: Any = ctypes.CFUNCTYPE

    class Doubt(ctypes.Structure):
        _fields_ = [('status', ctypes.c_uint), ('function', count * 4), ('time', real * 4)]

    class Derivatives(ctypes.Structure):
        _fields_ = [('size', size), ('columns', count), ('names', ctypes.POINTER(ctypes.c_char_p)),
                    ('init', call(None, p, p)), ('step', call(None, p, p, p, p)), ('out', call(None, p, p, p)),
                    ('hold', call(None, p, p)), ('status', call(ctypes.c_uint, p)),
                    ('by', ctypes.POINTER(real * 4)),
                    ('gradient', call(size, p, p, size, p, p, p, p, p, p, size)),
                    ('doubt', call(ctypes.POINTER(Doubt), p))]
    return Derivatives


_DERIVATIVES = {False: _derivatives(ctypes.c_double), True: _derivatives(ctypes.c_float)}
_DESCRIPTOR = {False: _descriptor(ctypes.c_double), True: _descriptor(ctypes.c_float)}


class Units(Mapping):
    """Units as texts, None where one is not known, by name: m.units["f"]; outputs before inputs, params and states,
    whose own are m.units.outputs, .inputs, .params and .states. States are in SI units, all others as it is written."""

    def __init__(self, states: dict[str, str | None], inputs: dict[str, str | None], outputs: dict[str, str | None],
                 params: dict[str, str | None]) -> None:
        self.states, self.inputs, self.outputs, self.params = states, inputs, outputs, params
        self._all = {**states, **params, **inputs, **outputs}

    def __getitem__(self, name: str) -> str | None:
        return self._all[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def __repr__(self) -> str:
        return repr(self._all)


class Code:
    """What plgen wrote for these params: shared by all instances."""

    def __init__(self, text: str, notes: str) -> None:
        self.text, self.notes = text, notes
        self.single = '\nextern const pl_modelf ' in text
        mark = '\nextern const pl_modelf ' if self.single else '\nextern const pl_model '
        found = text.partition(mark)[2].partition(';')[0]
        if not found.endswith('_model'):
            raise Error('what plgen wrote has no descriptor')
        self.name = found[:-len('_model')]
        tunable = text.partition(' {}_param_names[] = {{'.format(self.name))[2].partition('}')[0]
        self.tunable = [word.strip().strip('"') for word in tunable.split(',') if word.strip()]

    def _words(self) -> dict[str, str]:
        return {'name': self.name, 'real': 'float' if self.single else 'double'}

    def _loaded(self, compiler: Compiler, code: str) -> ctypes.CDLL:
        for anew in (False, True):              # what a crash has left in the cache is made anew
            path = compiler.shared_object(self.name, self.single, code, anew)
            try:
                return ctypes.CDLL(path)
            except OSError as why:
                if anew:
                    raise Error('cannot load what was compiled: {}'.format(why)) from None
        raise AssertionError

    def load(self, compiler: Compiler) -> Code:
        self.dtype = np.dtype(np.float32 if self.single else np.float64)
        loops = LOOP + (LOOP_D if '\nextern const pl_derivatives' in self.text else '')
        self.library = self._loaded(compiler, self.text + loops.format(**self._words()))
        path = self.library._name
        head = (ctypes.c_int * 2).in_dll(self.library, self.name + '_model')
        if head[0] != VERSION or head[1] != self.dtype.itemsize:
            raise Error('{}: its descriptor has version {} and numbers of {} bytes, and this package reads version {}'
                        .format(path, head[0], head[1], VERSION))
        self.model = m = _DESCRIPTOR[self.single].in_dll(self.library, self.name + '_model')
        self.rows = self.library.plgen_rows
        self.rows.restype = ctypes.c_size_t
        self.rows.argtypes = [ctypes.c_void_p, ctypes.c_size_t] + 3 * [ctypes.c_void_p] + [ctypes.c_int]
        self.states = tuple(m.state_names[i].decode() for i in range(m.states))
        self.inputs = tuple(m.input_names[i].decode() for i in range(m.inputs))
        self.outputs = tuple(m.output_names[i].decode() for i in range(m.outputs))
        self.values = np.array([m.param_values[i] for i in range(m.params)], dtype=self.dtype)
        self._read_units(m)
        self.ahead = [m.start_samples[i] for i in range(m.inputs)]
        self.most = max(self.ahead, default=0)
        self._read_derivatives()
        return self

    def _read_derivatives(self) -> None:
        """derivatives: None, or NAME_derivatives. columns: names; per: one of each param's own unit in SI units"""
        self.derivatives = d = None if not hasattr(self.library, 'plgen_rows_d') else \
            _DERIVATIVES[self.single].in_dll(self.library, self.name + '_derivatives')
        if d is None:
            return
        self.columns = tuple(d.names[i].decode() for i in range(d.columns))
        self.per = np.array([d.by[i][1] for i in range(d.columns)])
        self.set_d = getattr(self.library, self.name + '_set_d')
        self.set_d.argtypes, self.set_d.restype = [ctypes.c_void_p, ctypes.c_void_p], None
        self.rows_d = self.library.plgen_rows_d
        self.rows_d.restype = ctypes.c_size_t
        self.rows_d.argtypes = [ctypes.c_void_p] * 2 + [ctypes.c_size_t] + [ctypes.c_void_p] * 5

    def _read_units(self, m: Any) -> None:
        """NAME_units, which a model without units has not. factors: of the own units of params in SI units"""
        names, count = ctypes.POINTER(ctypes.c_char_p), (m.states, m.inputs, m.outputs, m.params, m.params)
        try:
            entries = list((names * len(count)).in_dll(self.library, self.name + '_units'))
        except ValueError:
            entries = []
        texts = [[t[i].decode() for i in range(n)] if t else [''] * n
                 for t, n in zip(entries or [None] * len(count), count)]
        of = (self.states, self.inputs, self.outputs, self.tunable)
        self.units = Units(*(dict(zip(n, (u or None for u in t))) for n, t in zip(of, texts)))
        self.factors = np.array([float(f or 1) for f in texts[4]])

    def lanes(self, compiler: Compiler, text: str) -> Any:
        """A function over instances side by side; text: of plgen --batch, which has the lanes."""
        u = 'u, ' if self.inputs else ''
        hold = '{name}_hold(&s, first);\n    {name}_hold(&b.shared, first);'.format(name=self.name) if self.most else ''
        code = text + LANES.format(u=u, hold=hold, **self._words())
        function = self._loaded(compiler, code).plgen_lanes
        p, size, real = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_float if self.single else ctypes.c_double
        function.restype = None
        function.argtypes = [size, size, p, real, p, p, p, p, p, p, p, p]
        return function


# ---- what plgen is given ----

class Params(Mapping):
    """Tunable params, and those that were given, in their own units: m.params["k"], m.params["k"] = 70."""

    def __init__(self, model: Any) -> None:
        self._model = model

    def _all(self) -> dict[str, Any]:
        m = self._model
        return {**m._given, **{name: float(x) for name, x in zip(m._code.tunable, m._tuned / m._code.factors)}}

    def __getitem__(self, name: str) -> Any:
        every = self._all()
        if name not in every:
            raise KeyError(unknown('tunable or given param', name, every))
        return every[name]

    def __setitem__(self, name: str, value: Value) -> None:
        self._model.retune(**{name: value})

    def __iter__(self) -> Iterator[str]:
        return iter(self._all())

    def __len__(self) -> int:
        return len(self._all())

    def __repr__(self) -> str:
        return repr(self._all())



def expression(value: Value) -> str:
    """A value as plgen reads it: an expression as it is, a number in the digits that read back as the same."""
    return str(value) if isinstance(value, (str, int, Fraction)) else repr(float(value))


def matrix_file(name: str, given: Any) -> str:
    """A matrix, of NumPy or of SciPy sparse, as a Matrix Market file in the cache: each number in the digits that read
    back as the same. A vector is a column. The file's name says what is in it, so it is written once."""
    if hasattr(given, 'tocsr'):                 # entries that stand twice are added
        entries = given.tocsr().tocoo()
        rows, columns, values, shape = entries.row, entries.col, np.asarray(entries.data), entries.shape
    else:
        full = np.asarray(given)
        full = full.reshape(-1, 1) if full.ndim == 1 else full
        if full.ndim != 2:
            raise ValueError("matrix '{}': expected a vector or a matrix, found {} dimensions".format(name, full.ndim))
        rows, columns = np.nonzero(full)
        values, shape = full[rows, columns], full.shape
    if values.dtype.kind not in 'fiub':
        raise ValueError("matrix '{}': expected real numbers, found {}".format(name, values.dtype))
    if not np.isfinite(values).all():
        raise ValueError("matrix '{}': its entries are not all finite".format(name))
    lines = ['%%MatrixMarket matrix coordinate real general', '{} {} {}'.format(*shape, len(values))]
    lines += ['{} {} {!r}'.format(i + 1, j + 1, x) for i, j, x in
              zip(rows.tolist(), columns.tolist(), (values + 0).tolist())]
    text = '\n'.join(lines) + '\n'
    path = os.path.join(_cache(), '{}-{}.mtx'.format(name, hashlib.sha256(text.encode()).hexdigest()[:32]))
    if not os.path.exists(path):
        handle, made = tempfile.mkstemp(prefix='making.', dir=_cache())
        with os.fdopen(handle, 'w') as f:
            f.write(text)
        os.replace(made, path)
    return path
