# SPDX-License-Identifier: MIT-0
"""Derivatives of runs, forwards and backwards: a part of Model. Columns are as plgen names them: k of a param, x(0) of
the initial value of x, u along an input."""
from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from ._code import Error


def _words(size: int) -> np.ndarray:
    """Room for a struct of so many bytes"""
    return np.zeros((size + 7) // 8 + 1, dtype=np.uint64)


class Derivatives:
    def _derive(self: Any, jac: Any) -> None:
        """From now on a model that has these; its state stays."""
        by = jac if isinstance(jac, str) else None if jac is True else ','.join(jac)
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
        return self._narrow(rows), J[:, 0] if self._squeeze and len(self.outputs) == 1 else J

    def vjp(self: Any, u: Any, w: Any, jac: Any = True, *, end: Any = None,
            snapshots: int = 32) -> tuple[np.ndarray, np.ndarray | None]:
        """Derivatives of a cost backwards: from w, those by the rows that run(u) returns, to those by the names of jac,
        and by the record's samples (rows x inputs; None without inputs), of the inputs that are among the names. The
        run begins here, and the model goes to its end.

        end        derivatives of the cost by the states at the end
        snapshots  how many states are kept, at most 64; the others are stepped to again"""
        self._derive(jac)
        c = self._code
        samples, n, rows, J = self._open_d(u, int(self._fresh))
        first, start = len(rows) - n, self._memory.copy()
        w = np.array(w, dtype=self.dtype).reshape(len(rows), len(self.outputs))
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
