# SPDX-License-Identifier: MIT-0
"""Linear equations, of a model or of one that is not linear at a point; derivatives of runs, forwards and backwards."""
from __future__ import annotations

import ctypes
import json
import warnings
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from ._code import DOUBTS, Error

if TYPE_CHECKING:
    from . import Model

Place = Union[None, str, Mapping[str, float]]


class StateSpace:
    """x' = A x + B u + B1 u', y = C x + D u + D1 u'; B1 and D1 are None where no u' acts. A, B, C, D = it, too.

    inputs, outputs, states: names. h: None; of the discrete one, whose u is held over a step, the step, and x' is the
    state a step later. discrete: that one, or None. at: where a model that is not linear is linearised, as plgen says
    it ('linearised at rest: x = 0'; x, u and y are then deviations from there); stability: there; '' of a linear one.
    poles: [1/s]."""

    def __init__(self, told: dict[str, Any], column: list[int], states: tuple[str, ...],
                 h: float | None = None) -> None:
        def matrix(key: str, rows: int) -> Any:
            if key not in told:
                return None
            return np.array(told[key], dtype=float).reshape(rows, -1)[:, column]
        self.states, self.h = states, h
        self.A = np.array(told['A'], dtype=float).reshape(len(states), len(states))
        rows = len(told['C'])
        self.B, self.B1 = matrix('B', len(states)), matrix('B_slope', len(states))
        self.C = np.array(told['C'], dtype=float).reshape(rows, len(states))
        self.D, self.D1 = matrix('D', rows), matrix('D_slope', rows)
        self.inputs: tuple[str, ...] = tuple(told['inputs'][i] for i in column) if 'inputs' in told else ()
        self.outputs: tuple[str, ...] = tuple(told.get('outputs', ()))
        self.discrete: StateSpace | None = None
        self.at = self.stability = ''
        self._delays: list[dict[str, Any]] = told.get('delays', [])
        self.poles = np.empty(0, dtype=complex)

    def __iter__(self) -> Iterator[np.ndarray]:
        return iter((self.A, self.B, self.C, self.D))

    def response(self, f: Any) -> np.ndarray:
        """y over u at the frequencies f [Hz], complex: f's shape x outputs x inputs."""
        f = np.asarray(f, dtype=float)
        at = np.exp(2j * np.pi * f * self.h) if self.h else 2j * np.pi * f
        at = at.reshape(f.shape + (1, 1))
        B = self.B if self.B1 is None else self.B + at * self.B1
        D = self.D if self.D1 is None else self.D + at * self.D1
        x = np.linalg.solve(at * np.eye(len(self.A)) - self.A, np.broadcast_to(B, f.shape + self.B.shape))
        return self.C @ x + D


def state_space(told: dict[str, Any], own: tuple[str, ...], loads: bool, name: str,
                late: bool = False) -> StateSpace:
    """Of --explain=json: over the inputs `own`, or over the others, which are loads. late: inputs as they were some
    time ago are inputs, too, which come last."""
    ss = told['ss']
    delayed = [one['input'] for one in ss.get('delays', [])]
    if delayed and not late and not loads:
        raise Error('{}: inputs are delayed, so it has no state space over them: it would leave out {}; '
                    'response and frf count them'.format(name, ', '.join(delayed)))
    own += tuple(delayed)
    column = [i for i, name in enumerate(ss['inputs']) if (name in own) != loads]
    space = StateSpace(ss, column, tuple(told['states']))
    if ss['discrete']:
        space.discrete = StateSpace(ss['discrete'], column, space.states, ss['discrete']['h'])
        space.discrete.inputs, space.discrete.outputs = space.inputs, space.outputs
    space.poles = np.array([complex(p['re'], p['im']) for p in told['poles'] for _ in range(p['multiplicity'])])
    return space


class StateSpaces:
    """m.ss: the StateSpace of now, and m.ss(at=...) that at another point."""

    def __init__(self, model: Model) -> None:
        self._model = model

    def __call__(self, at: Place = None, loads: bool = False) -> StateSpace:
        return self._model.state_space(loads, at)

    def __getattr__(self, name: str) -> Any:
        if name.startswith('_'):
            raise AttributeError(name)
        return getattr(self._model.state_space(), name)

    def __iter__(self) -> Iterator[np.ndarray]:
        return iter(self._model.state_space())


def place(at: Place, model: Model) -> str:
    """As plgen's --at takes it: of 'rest', 'now', 'x=0.1,v=2' or a dict of states; others are the initial ones."""
    if at is None:
        return 'rest'
    if isinstance(at, str) and at != 'now':
        return at
    values = dict(zip(model.states, model.state.tolist())) if isinstance(at, str) else at
    return ','.join('{}={!r}'.format(name, float(x)) for name, x in values.items())


class Linear:
    """What a Model says of its equations: --explain=json, and matrices of it."""

    def _explain(self: Any, at: str | None) -> tuple[dict[str, Any], str]:
        """--explain=json at the present params and step, and what plgen remarked."""
        if at not in self._told:
            extra = ['--explain=json'] + ([] if at is None else ['--at', at])
            out, notes = self._plgen(self._changed(), self._step_now(), extra)
            self._told[at] = json.loads(out), notes
        return self._told[at]

    @property
    def explain(self: Any) -> dict[str, Any]:
        """--explain=json at the present params and step, as a dict."""
        return self._explain(None)[0]

    @property
    def Phi(self: Any) -> np.ndarray:
        """y(t + h) = Phi y(t) + ..., correctly rounded."""
        if not self.explain['linear']:
            raise Error('{}: not linear, so it has no Phi: it would leave out {}'.format(
                self.name, '; '.join(self.explain['left_out'])))
        return np.array(self.explain['Phi'], dtype=float)

    def state_space(self: Any, loads: bool = False, at: Place = None) -> StateSpace:
        """StateSpace over the inputs; loads: over the spec's loads, each with its function of time as an input.

        at: of a model that is not linear, where: 'rest' (by default, with a warning that says so), 'now', 'x=0.1', or
        a dict of states; others are the initial ones."""
        return self._space(loads, at, False, 4)

    def _space(self: Any, loads: bool, at: Place, late: bool, above: int = 3) -> StateSpace:
        if self.explain['linear']:
            return state_space(self.explain, self.inputs, loads, self.name, late)
        told, notes = self._explain(place(at, self))
        space = state_space(told, self.inputs, loads, self.name, late)
        said = [line.partition(': note: ')[2] for line in notes.split('\n') if ': note: linearised ' in line]
        space.at = said[0] if said else 'linearised at ' + place(at, self)
        space.stability = told['linearised']['stability']
        if at is None:
            warnings.warn('{}: not linear, and {}'.format(self.name, space.at), stacklevel=above)
        return space

    def linearise(self, at: Place = 'rest') -> StateSpace:
        """A, B, C, D at a point, by exact derivatives: A, B, C, D = m.linearise(at={'x': 0.1})."""
        return self.state_space(at=at)

    def jac(self: Any, t: float, y: Any, *args: Any) -> np.ndarray:
        """The derivative of y' over y, as solvers take it: at the states y; loads do not count, so neither does t."""
        return self.state_space(at=dict(zip(self.states, self._vector(y, len(self.states), 'states').tolist()))).A

    def poles(self, at: Place = None) -> np.ndarray:
        """Poles [1/s], each as often as it is there."""
        return self._space(False, at, True).poles

    def response(self: Any, f: Any, loads: bool = False, at: Place = None) -> np.ndarray:
        """Outputs over inputs at f [Hz], complex: f's shape x outputs x inputs; u(t - d) is e^{-2 pi i f d} u."""
        space = self._space(loads, at, True)
        over = space.response(f)
        if loads:
            return over
        f = np.asarray(f, dtype=float)[..., np.newaxis]
        for late in space._delays:
            turned = over[..., space.inputs.index(late['input'])] * np.exp(-2j * np.pi * f * late['delay'])
            over[..., space.inputs.index(late['of'])] += turned
        return over[..., :len(self.inputs)]

    def frf(self, w: Any, loads: bool = False, at: Place = None) -> np.ndarray:
        """The same at w [rad/s]."""
        return self.response(np.asarray(w, dtype=float) / (2 * np.pi), loads, at)


# ---- derivatives of runs ----

def _words(size: int) -> np.ndarray:
    """Room for a struct of so many bytes"""
    return np.zeros((size + 7) // 8 + 1, dtype=np.uint64)


class Derivatives:
    """Columns are as plgen names them: k of a param, x(0) of the initial value of x, u along an input."""

    def _derive(self: Any, jac: Any) -> None:
        """From now on a model that has these; its state stays."""
        by = jac if isinstance(jac, str) else None if jac is True else ','.join(jac)
        if by == '':
            raise ValueError('jac: no name; True takes those of the statement `sensitivity`')
        if by == self._by and self._code.derivatives is not None:
            return
        before, fresh, new = self._by, self._fresh, self.time == 0 and self._is_at_start()
        self._by = by
        try:
            self._build(self._changed(), self._step_now())
            if self._code.derivatives is None:
                raise Error('{}: its spec has no statement `sensitivity`: jac=["k", "x"]'.format(self.name))
        except Exception:
            self._by = before
            raise
        if new:
            self.reset()
        self._fresh = fresh

    def _initial(self: Any) -> tuple[np.ndarray, Any]:
        """The state that `init` gives, and where there are derivatives these"""
        c, memory, moved = self._code, np.zeros_like(self._memory), None
        state = ctypes.c_void_p(memory.ctypes.data)
        if c.derivatives is None:
            c.model.init(state)
        else:
            moved = _words(c.derivatives.size)
            c.derivatives.init(state, moved.ctypes.data)
        y = np.empty(len(self.states), dtype=self.dtype)
        c.model.get(state, y.ctypes.data)
        return y, moved

    def _is_at_start(self: Any) -> bool:
        return bool(np.array_equal(self._initial()[0], self.state))

    def _start_d(self: Any) -> None:
        """Where no run with derivatives leads here: those of the initial state at t = 0, else of the state of now"""
        c = self._code
        if self._moved is not None:
            return
        y, moved = self._initial()
        if not (self._fresh and self.time == 0 and np.array_equal(y, self.state)):
            S = np.zeros((len(c.columns), len(self.states)), dtype=self.dtype)
            for p, name in enumerate(c.columns):
                if name.endswith('(0)') and name[:-3] in self.states:
                    S[p, self.states.index(name[:-3])] = 1
            c.set_d(moved.ctypes.data, S.ctypes.data)
        if c.derivatives.hold:
            ones = np.ones(len(self.inputs), dtype=self.dtype)
            c.derivatives.hold(moved.ctypes.data, ones.ctypes.data)
        self._moved = moved

    def _open_d(self: Any, u: Any, first: int) -> tuple[Any, int, np.ndarray, np.ndarray]:
        """Samples, steps, room for rows and their derivatives; the first of both, where a run begins"""
        c = self._code
        u, n, record = self._request(u, first)
        self._start_d()
        rows = self._room(None, n + first)
        J = np.empty((n + first, len(self.outputs), len(c.columns)), dtype=self.dtype)
        if record is not None:
            self._keep(record)
        if first:
            if record is not None and c.most:
                self._hold_first(record)
            rows[0] = self.out()
            c.derivatives.out(self._state, self._moved.ctypes.data, J.ctypes.data)
        self._fresh = False
        return u, n, rows, J

    def _run_d(self: Any, u: Any, first: int) -> tuple[np.ndarray, np.ndarray]:
        c = self._code
        u, n, rows, J = self._open_d(u, first)
        self._t = np.empty(len(rows), dtype=self.dtype)
        self._t[:first] = self.time
        ones = np.ones(max(len(self.inputs), 1), dtype=self.dtype)
        done = c.rows_d(self._state, self._moved.ctypes.data, n, None if u is None else u.ctypes.data,
                        ones.ctypes.data, rows[first:].ctypes.data, self._t[first:].ctypes.data,
                        J[first:].ctypes.data)
        if done < n:
            self._fail(rows, first + done)
        J *= c.per
        doubt = c.derivatives.doubt(self._moved.ctypes.data).contents
        for bit, text in enumerate(DOUBTS):
            if doubt.status >> bit & 1:
                warnings.warn('{}: derivatives from t = {:g} on{}: {}'.format(
                    self.name, doubt.time[bit],
                    '' if doubt.function[bit] < 0 else ' (switching function {})'.format(doubt.function[bit]), text),
                    stacklevel=3)
        return self._narrow(rows), J[:, 0] if self._squeeze and len(self.outputs) == 1 else J

    def vjp(self: Any, u: Any, w: Any, jac: Any = True, *, end: Any = None,
            snapshots: int = 32) -> tuple[np.ndarray, np.ndarray | None]:
        """Derivatives of a cost backwards: from w, those by the rows that run(u) returns, to those by the names of jac,
        and by the record's samples (rows x inputs; None without inputs; nan of inputs that are not among the names).
        The run begins here, and the model goes to its end.

        end        derivatives of the cost by the states at the end
        snapshots  how many states are kept, at most 64; the others are stepped to again"""
        self._derive(jac)
        c = self._code
        samples, n, rows, J = self._open_d(u, int(self._fresh))
        first, start = len(rows) - n, self._memory.copy()
        w = np.array(w, dtype=self.dtype)
        if w.shape != rows.shape and w.shape != self._narrow(rows).shape:
            self._fresh = first > 0
            raise ValueError('w: expected an array as the rows, of shape {}, found {}'.format(
                self._narrow(rows).shape, w.shape))
        w = w.reshape(rows.shape)
        lam = np.zeros(len(self.states)) if end is None else end
        lam = self._vector(lam, len(self.states), 'states').copy()
        pb, ub = np.zeros(len(c.columns), dtype=self.dtype), np.zeros((n + 1, len(self.inputs)), dtype=self.dtype)
        slots = max(1, min(64, int(snapshots)))
        kept = _words(slots * c.model.size)
        data = None if samples is None else samples.ctypes.data
        c.derivatives.gradient(start.ctypes.data, self._moved.ctypes.data, n, data, w[first:].ctypes.data,
                               lam.ctypes.data, pb.ctypes.data, ub.ctypes.data, kept.ctypes.data, slots)
        c.model.run(self._state, n, data, None)
        self._moved = None
        ub = self._rows_of_record(ub, n)
        if first:
            now = w[0] @ J[0]
            pb += now
            for p, name in enumerate(c.columns):
                if name in self.inputs:
                    ub[0, self.inputs.index(name)] += now[p]
        if ub is not None:
            ub[:, [name not in c.columns for name in self.inputs]] = np.nan
        return pb * c.per, ub

    def _rows_of_record(self: Any, ub: np.ndarray, n: int) -> np.ndarray | None:
        """Where some are ramps a row before the first step is theirs; held ones have theirs one row earlier."""
        if not self.inputs or not self._code.derivatives.hold:
            return ub[:n] if self.inputs else None
        for i, ahead in enumerate(self._code.ahead):
            if ahead == 0:
                ub[:n, i] = ub[1:, i].copy()
                ub[n, i] = 0
        return ub
