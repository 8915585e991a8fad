"""The quadratic program of one real-time iteration: states condensed, inputs bounded, speeds bounded softly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from benchbench.ground.arrays import Array
from benchbench_plugins.controllers.prediction import INPUTS, STATES, Prediction

ERRORS = 9
"""Position, attitude, velocity."""
SOFT = 8
"""What daqp calls a constraint that may be violated at a price."""
SOLVED = (1, 2)
"""Its answers for an optimum, the second with soft constraints violated."""


@dataclass(frozen=True)
class Weights:
    """Square roots of weights are taken once: position 1/m^2, attitude 1/rad^2, velocity, rates and thrust over mass.

    tip  of the end effector's velocity, in the stages in which the ball is near
    """

    position: float
    attitude: float
    velocity: float
    rates: float
    thrust: float
    tip: float


@final
class Condensed:
    """min sum |S (x_k - x_ref)|^2 + |u - u_ref|^2_R + w |v_k - v_ref + L_k (u_k - u_ref)|^2 over du, x+ = A x + B u.

    The last term, where L_k is not zero, is the end effector's velocity: rates turn it about the vehicle.
    """

    def __init__(
        self, prediction: Prediction, weights: Weights, low: Array, high: Array, speed: Array | None
    ) -> None:
        """low, high: (4,) bounds of u; speed: (3,) m/s largest speed per axis, softly, None for no such rows."""
        import daqp

        self.solve_qp, self.prediction, self.stages = daqp.solve, prediction, len(prediction.inputs)
        w, n = weights, self.stages
        self.scale = np.sqrt([w.position] * 3 + [w.attitude] * 3 + [w.velocity] * 3)
        self.price, self.gentle = np.tile([w.rates] * 3 + [w.thrust], n), np.sqrt(w.tip)
        self.low, self.high, self.speed = np.tile(low, n), np.tile(high, n), speed
        self.effect = np.zeros((n, STATES, INPUTS * n))
        self.errors = np.zeros((n, ERRORS, INPUTS * n))
        size = INPUTS * n
        self.kinds = np.concatenate(
            [np.zeros(size, np.int32), np.full(0 if speed is None else 3 * n, SOFT, np.int32)]
        )

    def solve(self, state: Array, inputs: Array, error: Array, lever: Array) -> Array:
        """Return inputs (stages, 4) for references of the stages' ends: state (stages, 10), inputs (stages, 4), error (stages, 3, 4).

        lever: (stages, 3, 3) from body rates to the end effector's velocity, zeros where that does not matter.
        """
        p, n = self.prediction, self.stages
        self._effects()
        wrong = np.empty((n, ERRORS))
        wrong[:, :3] = p.after[:, :3] - state[:, :3]
        wrong[:, 3:6] = np.einsum("nij,nj->ni", error, p.after[:, 3:7])
        wrong[:, 6:] = p.after[:, 7:] - state[:, 7:]
        self.errors[:, :3], self.errors[:, 6:] = self.effect[:, :3], self.effect[:, 7:]
        np.matmul(error, self.effect[:, 3:7], out=self.errors[:, 3:6])
        rows, off = self._tip(wrong[:, 6:], p.inputs[:, :3] - inputs[:, :3], lever)
        scaled = np.vstack([(self.errors * self.scale[:, None]).reshape(n * ERRORS, -1), rows])
        hessian = scaled.T @ scaled
        hessian[np.diag_indices_from(hessian)] += self.price
        asked = p.inputs.ravel()
        gradient = scaled.T @ np.append(wrong * self.scale, off) + self.price * (asked - inputs.ravel())
        return self._solved(hessian, gradient, asked).reshape(n, INPUTS)

    def _tip(self, velocity: Array, rates: Array, lever: Array) -> tuple[Array, Array]:
        """Rows (3 m, 4 n) of the m stages in which the end effector's velocity counts, and what it is off by (3 m,)."""
        near = np.flatnonzero(lever.any(axis=(1, 2)))
        rows = self.effect[near, 7:].copy()
        for i, k in enumerate(near):
            rows[i, :, INPUTS * k : INPUTS * k + 3] += lever[k]
        off = velocity[near] + np.einsum("nij,nj->ni", lever[near], rates[near])
        return self.gentle * rows.reshape(3 * len(near), self.price.size), self.gentle * off.ravel()

    def _solved(self, hessian: Array, gradient: Array, asked: Array) -> Array:
        rows, most, least = np.zeros((0, len(asked))), self.high - asked, self.low - asked
        if self.speed is not None:
            rows = np.ascontiguousarray(self.effect[:, 7:].reshape(-1, len(asked)))
            now = self.prediction.after[:, 7:]
            most = np.append(most, (self.speed - now).ravel())
            least = np.append(least, (-self.speed - now).ravel())
        change, _, answer, _ = self.solve_qp(hessian, gradient, rows, most, least, self.kinds)
        if answer not in SOLVED:
            raise ArithmeticError(f"the quadratic program was not solved: daqp says {answer}")
        found: Any = asked + change
        return np.asarray(found)

    def _effects(self) -> None:
        """Derivatives of each stage's end by all inputs before it."""
        p, effect = self.prediction, self.effect
        for k in range(self.stages):
            until = INPUTS * k
            if k:
                np.matmul(p.by_state[k], effect[k - 1, :, :until], out=effect[k, :, :until])
            effect[k, :, until : until + INPUTS] = p.by_input[k]
