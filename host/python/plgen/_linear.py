# SPDX-License-Identifier: MIT-0
"""Linear equations: of a model, or of one that is not linear at a point."""
from __future__ import annotations

import json
import warnings
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from ._code import Error

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
