"""The NMPC's own model in discrete time, with its derivatives: the paper's quaternion model and RK4.

x = [p, q, v] (10,), u = [body rates, thrust over mass] (4,), dp/dt = v, dq/dt = q (x) [0, omega] / 2, dv/dt = R(q) e_3 c - g e_3.
"""

from __future__ import annotations

from functools import cache
from typing import final

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array

STATES, INPUTS = 10, 4


@cache
def stage(gravity: float, step: float) -> ca.Function:
    """One step of RK4 with its derivatives: (x, u, offset) -> (x+, dx+/dx, dx+/du), columns first."""
    x, u, offset = ca.SX.sym("x", STATES), ca.SX.sym("u", INPUTS), ca.SX.sym("offset", STATES)
    slope = ca.Function("slope", [x, u], [_slope(x, u, gravity)])
    k1 = slope(x, u)
    k2 = slope(x + step / 2 * k1, u)
    k3 = slope(x + step / 2 * k2, u)
    k4 = slope(x + step * k3, u)
    after = x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4) + offset
    by_state, by_input = ca.jacobian(after, x), ca.jacobian(after, u)
    return ca.Function("stage", [x, u, offset], [after, ca.densify(by_state), ca.densify(by_input)])


def _slope(x: ca.SX, u: ca.SX, gravity: float) -> ca.SX:
    w, i, j, k = ca.vertsplit(x[3:7])
    a, b, c, push = ca.vertsplit(u)
    turn = (
        ca.vertcat(
            -i * a - j * b - k * c, w * a + j * c - k * b, w * b + k * a - i * c, w * c + i * b - j * a
        )
        / 2
    )
    up = ca.vertcat(2 * (i * k + w * j), 2 * (j * k - w * i), 1 - 2 * (i * i + j * j))
    return ca.vertcat(x[7:], turn, up * push - ca.vertcat(0, 0, gravity))


@final
class Prediction:
    """`stages` steps in a row, evaluated at the price of one call; arrays are written in place."""

    def __init__(self, gravity: float, step: float, stages: int) -> None:
        """Build the function once."""
        chain = stage(gravity, step).mapaccum("prediction", stages)
        self.first, self.inputs, self.offsets = (
            np.zeros(STATES),
            np.zeros((stages, INPUTS)),
            np.zeros((stages, STATES)),
        )
        self.after = np.zeros((stages, STATES))
        self._by_state, self._by_input = (
            np.zeros((stages, STATES, STATES)),
            np.zeros((stages, INPUTS, STATES)),
        )
        self.by_state, self.by_input = self._by_state.transpose(0, 2, 1), self._by_input.transpose(0, 2, 1)
        self._buffer, self._run = chain.buffer()
        for i, array in enumerate((self.first, self.inputs, self.offsets)):
            self._buffer.set_arg(i, memoryview(array))  # type: ignore[call-arg, arg-type]
        for i, array in enumerate((self.after, self._by_state, self._by_input)):
            self._buffer.set_res(i, memoryview(array))  # type: ignore[call-arg, arg-type]

    def run(self, first: Array, inputs: Array, offsets: Array) -> None:
        """Predict from `first` (10,) with inputs (stages, 4) and offsets (stages, 10): fills after, by_state, by_input."""
        self.first[:], self.inputs[:], self.offsets[:] = first, inputs, offsets
        self._run()
