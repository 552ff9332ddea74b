# SPDX-License-Identifier: MIT-0
"""Models of plgen as Python objects: NumPy, plgen and a C compiler.

    from plgen import Model
    m = Model("own.spec", k=60)             # a file, or the text of a spec
    y = m.run(1000)                         # rows x outputs: now, and after each step; m.t has their times
    m.params["k"] = 70                      # a tunable param: nothing is compiled

plgen writes C, the compiler makes a shared object of it, and that is kept where plrun keeps its own ($XDG_CACHE_HOME or
~/.cache, there plgen/). Numbers are those of NAME_step and NAME_out, bit for bit. doc/python.md has examples.
"""
from __future__ import annotations

import copy
import ctypes
import hashlib
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from . import _code
from ._code import REFUSED, STATUS, VERSION, Code, Compiler, Error, Params, RunError, Units, Value
from ._linear import Derivatives, Linear, StateSpace, StateSpaces

__all__ = ['Model', 'Error', 'RunError', 'StateSpace', 'VERSION']
BLOCK = 1 << 20         # steps between two looks at Ctrl-C
LANES = 64              # instances of a batch that a thread takes at a time


class Model(Linear, Derivatives):
    """A model at a point of its motion; it begins at t = 0 with the spec's initial values.

    spec     a path, or, with a line's end in it, the text of a spec
    step     instead of the spec's [s]; real: 'double' or 'float'; scheme: as --scheme
    options  more of plgen's options, as a list
    params   values of params by name, numbers or expressions: a dict, or keywords. A number for a tunable param goes
             into the instance by NAME_retune (initial values stay those of the spec); any other makes another model
    matrices values of matrices by name, of NumPy or of SciPy sparse, in the place of those that the spec names
    squeeze  rows of one output alone are an array of one dimension; False: they have a column

    states, inputs, outputs, params: names (params: with their values). h: the step [s]. notes: what plgen remarked."""

    def __init__(self, spec: str | os.PathLike[str], params: Mapping[str, Value] | None = None, *,
                 step: Value | None = None, real: str | None = None, scheme: str | None = None,
                 options: Sequence[str] = (), matrices: Mapping[str, Any] | None = None, squeeze: bool = True,
                 **more: Value) -> None:
        text = isinstance(spec, str) and '\n' in spec
        self._spec: str = '-' if text else os.fspath(spec)
        self._text: str | None = str(spec) if text else None
        if isinstance(options, str):
            raise TypeError('options: a list of texts is expected, as ["--fast"]')
        self._options = list(options)
        for name, value in (('--real', real), ('--scheme', scheme)):
            if value is not None:
                self._options += [name, str(value)]
        for name, value in (matrices or {}).items():
            self._options += ['-D', '{}="{}"'.format(name, _code.matrix_file(name, value))]
        self._step, self._squeeze = step, squeeze
        self._given: dict[str, Value] = {}
        self._tuned: np.ndarray = np.empty(0)
        self._code: Code = None                 # type: ignore[assignment]
        self._told: dict[str | None, tuple[dict[str, Any], str]] = {}
        self._lanes: Any = None
        self._t: Any = np.empty(0)
        self._tail: np.ndarray | None = None
        self._by: str | None = None             # what derivatives are by, and these
        self._moved: np.ndarray | None = None
        self._build({**(params or {}), **more}, step)

    # ---- making it ----

    def _plgen(self, given: Mapping[str, Value], step: Value | None, extra: Sequence[str] = ()) -> tuple[str, str]:
        argv = [_code.find_plgen(), '--fast'] + self._options + list(extra)
        if self._by:
            argv += ['--sensitivity', self._by]
        if step is not None:
            argv += ['--step', _code.expression(step)]
        for name, value in given.items():
            argv += ['-D', '{}={}'.format(name, _code.expression(value))]
        status, out, said = _code.run(argv + ['--', self._spec], self._text)
        if status:
            raise Error(said.strip() or 'plgen ended with status {}'.format(status))
        return out, said

    def _build(self, params: Mapping[str, Value], step: Value | None) -> None:
        """Compiles for these params; only when all is well it becomes this model's own."""
        expressions = {n: v for n, v in params.items() if isinstance(v, str)}
        code = Code(*self._plgen(expressions, step))
        fixed = {n: v for n, v in params.items() if n in expressions or n not in code.tunable}
        if len(fixed) > len(expressions):
            code = Code(*self._plgen(fixed, step))
        code.load(Compiler(_code.find_plgen()))
        if code.notes:
            warnings.warn(code.notes.strip(), stacklevel=3)
        values = {n: v for n, v in params.items() if n not in fixed}
        before = None if self._code is None else (self._code, self.time, self.state)
        saved = dict(self.__dict__)
        try:
            self._code, self._given, self._step, self._lanes = code, fixed, step, None
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

    def copy(self) -> Model:
        """Another instance at the same point; it shares the code alone."""
        other = object.__new__(Model)
        other.__dict__.update(self.__dict__)
        other._memory = self._memory.copy()
        other._state = ctypes.c_void_p(other._memory.ctypes.data)
        other._moved = None if self._moved is None else self._moved.copy()
        other._tuned, other._given, other._told = self._tuned.copy(), dict(self._given), dict(self._told)
        return other

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Model:
        return self.copy()

    def __reduce__(self) -> tuple[Callable[..., Model], tuple[dict[str, Any], str]]:
        """What it is made of, and where it is: what is compiled is made again, or found in the cache."""
        kept = {name: value for name, value in self.__dict__.items()
                if name not in ('_code', '_state', '_told', '_lanes')}
        if self._text is None:
            kept['_spec'] = os.path.abspath(self._spec)
        return _again, (kept, hashlib.sha256(self._code.text.encode()).hexdigest())

    def __repr__(self) -> str:
        return '<plgen model {}: t = {:g}, h = {:g}, outputs {}>'.format(self.name, self.time, self.h,
                                                                        ', '.join(self.outputs))

    # ---- what it is ----

    @property
    def name(self) -> str:
        return self._code.name

    @property
    def states(self) -> tuple[str, ...]:
        return self._code.states

    @property
    def inputs(self) -> tuple[str, ...]:
        return self._code.inputs

    @property
    def outputs(self) -> tuple[str, ...]:
        return self._code.outputs

    @property
    def tunable(self) -> tuple[str, ...]:
        return tuple(self._code.tunable)

    @property
    def dtype(self) -> np.dtype:
        """Of all numbers: float64 or float32."""
        return self._code.dtype

    @property
    def h(self) -> float:
        """The step [s]."""
        return self._h

    @property
    def notes(self) -> str:
        return self._code.notes

    @property
    def params(self) -> Params:
        return Params(self)

    @property
    def units(self) -> Units:
        return self._code.units

    @property
    def ss(self) -> StateSpaces:
        """A, B, C, D over the inputs, discrete: those of a step; ss(at=...) at another point."""
        return StateSpaces(self)

    @property
    def t(self) -> np.ndarray:
        """Times of the rows of the last run [s]."""
        if isinstance(self._t, tuple):          # of blocks: made when they are asked for
            start, h, first, end = self._t
            self._t = (start + h * np.arange(first, end)).astype(self.dtype)
        return self._t

    # ---- where it is ----

    @property
    def time(self) -> float:
        return self._code.model.time(self._state)

    @property
    def status(self) -> int:
        """0, or the bits of NAME_status: 1 not finite, 2 too many events, 4 too many substeps, 8 inaccurate, 16
        undecided, 32 a range left, 64 beyond a stop, 128 a singular mass matrix."""
        status = self._code.model.status
        return status(self._state) if status else 0

    @property
    def state(self) -> np.ndarray:
        y = np.empty(len(self.states), dtype=self.dtype)
        self._code.model.get(self._state, y.ctypes.data)
        return y

    @state.setter
    def state(self, y: Any) -> None:
        self.set(y)

    def set(self, y: Any, t: float | None = None) -> None:
        """The states y at the time t [s], now unless it is given."""
        y = self._vector(y, len(self.states), 'states')
        t = self.time if t is None else t
        if not (np.isfinite(y).all() and np.isfinite(t)):
            raise ValueError('states and time are not all finite')
        self._code.model.set(self._state, t, y.ctypes.data)
        self._begin()

    def reset(self) -> None:
        """Back to t = 0 and the initial values; params stay."""
        tuned = None if np.array_equal(self._tuned, self._code.values) and self._h == self._code.model.h else self._h
        self._code.model.init(self._state)
        if tuned is not None:
            self._retune(self._tuned, self._h)
        self._begin()

    def out(self) -> np.ndarray:
        """The outputs now."""
        y = np.empty(len(self.outputs), dtype=self.dtype)
        self._code.model.out(self._state, y.ctypes.data)
        return y

    def _begin(self) -> None:
        """The next record starts at its row 0."""
        self._fresh, self._tail, self._moved = True, None, None
        self._t = np.empty(0, dtype=self.dtype)

    def _vector(self, values: Any, size: int, what: str) -> np.ndarray:
        values = np.ascontiguousarray(values, dtype=self.dtype)
        if values.shape != (size,):
            raise ValueError('expected {} numbers, the {}, found an array of shape {}'.format(size, what, values.shape))
        return values

    def _sample(self, u: Any) -> np.ndarray | None:
        if not self.inputs:
            if u is not None:
                raise ValueError('the model has no inputs')
            return None
        if u is None:
            raise ValueError('the model has inputs: ' + ', '.join(self.inputs))
        if isinstance(u, dict):
            u = [u[name] for name in self._input_names(u)]
        return self._vector(np.atleast_1d(u), len(self.inputs), 'inputs')

    # ---- steps ----

    def step(self, u: Any = None) -> np.ndarray:
        """One step, u a sample of the inputs as NAME_step takes it; returns the outputs."""
        u = self._sample(u)
        self._code.model.step(self._state, None if u is None else u.ctypes.data)
        self._fresh, self._tail, self._moved = False, None, None
        if self.status:
            raise RunError(self._trouble(self.status), np.empty((0, len(self.outputs)), self.dtype),
                           np.empty(0, self.dtype), self.status)
        return self.out()

    def hold(self, u: Any) -> None:
        """The sample of ramps before the next step: NAME_hold."""
        u = self._sample(u)
        if self._code.most:
            self._code.model.hold(self._state, u.ctypes.data)
            self._fresh, self._tail = False, None

    def jump(self, n: int) -> None:
        """n steps at once, in the time of log n: NAME_jump."""
        if not self._code.model.jump:
            raise Error('{}: it has no jump'.format(self.name))
        if n < 0:
            raise ValueError('a jump goes forward')
        self._code.model.jump(self._state, int(n))
        self._fresh, self._moved = False, None

    def at(self, tau: float, u: Any = None) -> np.ndarray:
        """The states tau after now, 0 <= tau <= h: NAME_at."""
        if not self._code.model.at:
            raise Error('{}: it has no states inside a step'.format(self.name))
        if not 0 <= tau <= self.h:
            raise ValueError('tau is not in 0 .. h')
        u, y = self._sample(u), np.empty(len(self.states), dtype=self.dtype)
        self._code.model.at(self._state, None if u is None else u.ctypes.data, tau, y.ctypes.data)
        return y

    def _input_names(self, given: Mapping[str, Any]) -> tuple[str, ...]:
        for name in given:
            if name not in self.inputs:
                raise ValueError(_code.unknown('input', name, self.inputs))
        for name in self.inputs:
            if name not in given:
                raise ValueError("the input '{}' has no samples; expected the inputs {}".format(
                    name, ', '.join(self.inputs)))
        return self.inputs

    def _record(self, u: Any) -> np.ndarray:
        """Samples as rows x inputs, as they are where they are so already."""
        if isinstance(u, dict):
            u = np.stack([np.asarray(u[name], dtype=self.dtype) for name in self._input_names(u)], axis=1)
        u = np.ascontiguousarray(u, dtype=self.dtype)
        if u.ndim == 1 and len(self.inputs) == 1:
            u = u.reshape(-1, 1)
        if u.ndim != 2 or u.shape[1] != len(self.inputs):
            raise ValueError('expected rows of {} numbers, the inputs, found an array of shape {}'.format(
                len(self.inputs), u.shape))
        if not np.isfinite(u).all():
            raise ValueError('the samples are not all finite')
        return u

    def _samples(self, u: np.ndarray) -> tuple[np.ndarray, int]:
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

    def _hold_first(self, u: np.ndarray) -> None:
        c = self._code
        for k in range(c.most):
            row = np.array([u[k if a == 0 else k - c.most + a, i] if a == 0 or k >= c.most - a else 0.0
                            for i, a in enumerate(c.ahead)], dtype=self.dtype)
            c.model.hold(self._state, row.ctypes.data)

    def _request(self, u: Any, first: int) -> tuple[np.ndarray | None, int, np.ndarray | None]:
        """Of what run takes: samples as steps take them, how many steps, and the record"""
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
        return u, n, record

    def run(self, u: Any, *, out: np.ndarray | None = None, start: bool | None = None,
            blocks: bool = False, jac: Any = None) -> Any:
        """Steps; returns rows x outputs (of one output: its rows, unless squeeze=False), and t has their times.

        u      how many steps; of a model with inputs a record: rows x inputs, rows alone of one input, or a dict of
               columns by name. Row k is the sample at t = k h: n steps take n rows, n + 1 where an input is a ramp (n +
               m with hold third ...)
        out    where to put the rows: an array of the right shape and type
        start  True: the record starts now, and the first row of the result is now, so there are n + 1. False: it goes
               on from the run before, n rows; so pieces put together are one run. By default True for a new model and
               after reset and set, else False
        blocks True: by NAME_run, which is faster where it takes many steps at once (api.md); rounding is then its own,
               and depends on where pieces begin
        jac    names of params, of states (by their initial values), of inputs (by an offset), or True for those of the
               statement `sensitivity`: returns rows and their derivatives, rows x outputs x names

        RunError, with the rows so far, where a step leaves the finite numbers or its bounds."""
        first = int(self._fresh if start is None else start)
        if jac is not None and jac is not False:
            if out is not None or blocks:
                raise ValueError('jac: without out and blocks')
            self._derive(jac)
            return self._run_d(u, first)
        self._moved = None
        u, n, record = self._request(u, first)
        rows = self._room(out, n + first)
        if record is not None:
            self._keep(record)
        if first:
            if record is not None and self._code.most:
                self._hold_first(record)
            rows[0] = self.out()
        self._fresh = False
        if blocks:
            self._t = self.time, self._h, 1 - first, n + 1
        else:
            self._t = np.empty(len(rows), dtype=self.dtype)
            self._t[:first] = self.time
        self._go(n, u, rows, first, blocks)
        return out if out is not None else self._narrow(rows)

    def _narrow(self, rows: np.ndarray) -> np.ndarray:
        return rows[..., 0] if self._squeeze and len(self.outputs) == 1 else rows

    def _room(self, out: np.ndarray | None, count: int) -> np.ndarray:
        shape = (count, len(self.outputs))
        if out is None:
            return np.empty(shape, dtype=self.dtype)
        narrow = shape[1] == 1 and isinstance(out, np.ndarray) and out.shape == shape[:1]
        good = isinstance(out, np.ndarray) and (out.shape == shape or narrow) and out.dtype == self.dtype
        if not (good and out.flags.c_contiguous and out.flags.writeable):
            raise ValueError('out: expected a contiguous array of {} of shape {}'.format(self.dtype, shape))
        return out.reshape(shape)

    def _keep(self, record: np.ndarray) -> None:
        most = self._code.most
        if most and (self._fresh or self._tail is not None):
            whole = record if self._fresh else np.concatenate([self._tail, record])
            self._tail = whole[len(whole) - most:].copy()

    def _go(self, n: int, u: np.ndarray | None, rows: np.ndarray, first: int, blocks: bool) -> None:
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
                    self._fail(rows, first + done + good)
            done += count

    def _fail(self, rows: np.ndarray, end: int) -> None:
        self._t = self._t[:end]
        raise RunError(self._trouble(self.status), self._narrow(rows[:end]), self._t, self.status)

    def _trouble(self, status: int) -> str:
        said = [text for bit, text in STATUS if status & bit] or ['status {}'.format(status)]
        return '{}: t = {!r}: {}'.format(self.name, float(self.time), '; '.join(said))

    # ---- other params ----

    def _retune(self, values: np.ndarray, h: float) -> None:
        status = self._code.model.retune(self._state, np.ascontiguousarray(values).ctypes.data, h)
        if status:
            raise Error('{}: {}'.format(self.name, REFUSED.get(
                status, 'with these values the numbers of the step are not finite')))

    def _takes(self, step: Value) -> bool:
        """Does an instance take this step? Where expressions read the params it does; what is no step is reported."""
        c, h = self._code, float(self.dtype.type(step))
        scratch = self._memory.copy()
        values = np.ascontiguousarray(self._tuned)
        return not h > 0 or c.model.retune(ctypes.c_void_p(scratch.ctypes.data), values.ctypes.data, h) != 8

    def _tune(self, params: Mapping[str, Value], step: Value | None) -> None:
        values = self._tuned.copy()
        for name, value in params.items():
            place = self._code.tunable.index(name)
            values[place] = value * self._code.factors[place]
        h = self._h if step is None else float(self.dtype.type(step))
        if params or h != self._h:
            self._retune(values, h)
            self._tuned, self._h = values, h

    def retune(self, *, step: Value | None = None, **params: Value) -> None:
        """Other values of params, and another step; state and time stay. Of tunable ones by NAME_retune, nothing is
        compiled; any other compiles a model, whose samples kept for ramps begin anew."""
        c = self._code
        numbers = all(n in c.tunable and not isinstance(v, str) for n, v in params.items())
        if numbers and (step is None or (c.model.retune and not isinstance(step, str) and self._takes(step))):
            self._tune(params, step)
        else:
            self._build({**self._changed(), **params}, self._step_now() if step is None else step)
        self._told = {}

    def _nominal(self, name: str) -> float:
        place = self._code.tunable.index(name)
        return float(self._code.values[place] / self._code.factors[place])

    def _changed(self) -> dict[str, Value]:
        return {n: v for n, v in self.params.items() if n in self._given or v != self._nominal(n)}

    def _step_now(self) -> Value | None:
        return self._step if self._h == self._code.model.h else self._h

    # ---- many ----

    def batch(self, u: Any, params: Mapping[str, Any] | None = None, *, jobs: int | None = None) -> np.ndarray:
        """Runs from here with other values of params, on all cores: instances x rows x outputs, each instance the
        same, bit for bit, as run of a copy with its values; this one stays where it is, and t has the times.

        u       as run takes it, for all
        params  arrays of values by name, as long as there are instances; what is no array is the same in all
        jobs    threads; by default one for each core

        Tunable params of a linear model go side by side through NAME_batch; others run apart, and where a param is not
        tunable each value is compiled."""
        values = {name: np.atleast_1d(np.asarray(x)) for name, x in (params or {}).items()}
        count = max((x.size for x in values.values()), default=1)
        for name, x in values.items():
            if x.ndim > 1 or x.size not in (1, count):
                raise ValueError("params['{}']: expected {} values, found an array of shape {}".format(
                    name, count, x.shape))
        table = [{name: x.reshape(-1)[j if x.size > 1 else 0].item() for name, x in values.items()}
                 for j in range(count)]
        with ThreadPoolExecutor(jobs or os.cpu_count()) as pool:
            rows = self._side_by_side(u, table, pool)
            if rows is None:
                rows = np.array(list(pool.map(lambda given: self._apart(u, given), table)))
        return self._narrow(rows)

    def _apart(self, u: Any, given: Mapping[str, Value]) -> np.ndarray:
        one = self.copy()
        one._squeeze = False
        try:
            one.retune(**given)
            rows = one.run(u)
        except Error as why:
            why.args = ('with {}: {}'.format(', '.join('{} = {}'.format(*x) for x in given.items()), why),)
            raise
        self._t = one._t
        return rows

    def _lane_function(self) -> Any:
        """The function of Code.lanes, or False where instances of this model do not step side by side."""
        if self._lanes is None:                 # loads have other roundings there, where phasors are refreshed
            text = '' if self.explain['loads'] else self._plgen(self._given, self._step, ['--batch'])[0]
            side = '/* From the runtime, batch.h' in text and '_batch_use(' in text
            self._lanes = self._code.lanes(Compiler(_code.find_plgen()), text) if side else False
            self._widths = [int(text.partition('BATCH_{} = '.format(what))[2].split(None, 1)[0].strip(',}'))
                            for what in ('ROWS', 'FACTORS')] if side else []
        return self._lanes

    def _side_by_side(self, u: Any, table: list[dict[str, Value]], pool: ThreadPoolExecutor) -> np.ndarray | None:
        """Where all begin as the spec says, and differ in tunable params alone; None: they are to run apart."""
        new, c = self.copy(), self._code
        new.reset()
        begins = self.time == 0 and self._fresh and self._h == c.model.h and np.array_equal(new.state, self.state)
        numbers = all(name in c.tunable and not isinstance(x, str) for given in table for name, x in given.items())
        if len(table) < 2 or not begins or not numbers or not self._lane_function():
            return None
        record = self._record(u) if self.inputs else None
        steps, n = (None, int(u)) if record is None else new._samples(record)
        n = n if steps is None else len(steps)
        params = np.tile(self._tuned, (len(table), 1))
        for j, given in enumerate(table):
            for name, x in given.items():
                params[j, c.tunable.index(name)] = x * c.factors[c.tunable.index(name)]
        first = None if record is None else record[:1]
        rows = np.empty((len(table), n + 1, len(self.outputs)), dtype=self.dtype)
        if c.most > 1 or not all(pool.map(lambda j: self._some(params[j:j + LANES], n, steps, first,
                                                               rows[j:j + LANES]), range(0, len(table), LANES))):
            return None
        self._t = 0, self._h, 0, n + 1
        return rows

    def _some(self, params: np.ndarray, n: int, u: np.ndarray | None, first: np.ndarray | None,
              rows: np.ndarray) -> bool:
        """Some instances, in this thread; False: something is wrong with one of them."""
        def room(*shape: int) -> np.ndarray:
            return np.empty(shape, dtype=self.dtype)
        count = len(params)
        y, factors, peak = (room(width, count) for width in (*self._widths, len(self.outputs)))
        now, out, status = room(count, len(self.outputs)), room(n, len(self.outputs), count), np.zeros(count, np.intc)
        u, params = None if u is None else np.ascontiguousarray(u), np.ascontiguousarray(params)
        self._lanes(count, n, params.ctypes.data, self._h,      # arrays that are there until the call returns
                    *(None if x is None else x.ctypes.data for x in (u, first, y, factors, peak, now, out, status)))
        rows[:, 0], rows[:, 1:] = now, out.transpose(2, 0, 1)
        return not status.any()


def _again(kept: dict[str, Any], code: str) -> Model:
    """A pickled Model: compiled again, and put where it was."""
    m = object.__new__(Model)
    m.__dict__.update(kept)
    m._code, m._told, m._lanes = None, {}, None         # type: ignore[assignment]
    m._build(m._given, m._step)
    if hashlib.sha256(m._code.text.encode()).hexdigest() != code:
        raise Error('{}: the spec, or plgen, is another than when this was pickled'.format(m.name))
    state = m._memory, m._state
    m.__dict__.update(copy.deepcopy(kept))
    m._memory, m._state = state
    m._memory[:] = kept['_memory']
    return m
