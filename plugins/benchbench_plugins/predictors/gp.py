"""A Gaussian process of the target's position over time, which knows no kind of motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, final

import casadi as ca
import numpy as np
from pydantic import Field, validate_call

from benchbench.flight.predictor import Predictor, Seen
from benchbench.ground.arrays import Array
from benchbench.ocp.motion import Motion
from benchbench.ocp.scenario import Positive
from benchbench_plugins.predictors.windows import latest

WIDE = 10.0
"""m and m/s, standard deviation of the line about which a target is thought to move: any."""
CREEP = 0.02
"""m/s, speed below which a heading tells nothing of the motion."""

Points = Annotated[int, Field(ge=1, le=100)]


@final
@dataclass(frozen=True)
class Mean(Motion):
    """p(t) = place + t way + sum_i weights_i exp(-(t - times_i)^2 / (2 length^2)).

    line (2, 3): place m and way m/s; times (m,) s; weights (m, 3) m; length s
    """

    line: Array
    times: Array
    weights: Array
    length: float

    @property
    def parameters(self) -> Array:
        """All of them, weights axis by axis."""
        return np.concatenate([self.line.ravel(), [self.length], self.times, self.weights.T.ravel()])

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """A line and bumps."""
        count = len(self.times)
        place, way, length, times, weights = ca.vertsplit(parameters, [0, 3, 6, 7, 7 + count, 7 + 4 * count])
        bumps = ca.exp(-(((time - times) / length) ** 2) / 2)
        return place + time * way + ca.reshape(weights, count, 3).T @ bumps


@final
class Gp(Predictor):
    """Kernel: any line, and size^2 exp(-d^2 / (2 length^2)) about it, by the subset of regressors (Quinonero-Candela & Rasmussen 2005).

    Headings are observations of the derivative: a target does not move across the way it points. No library conditions on those
    besides (scikit-learn has positions only), and it is one linear least squares. Nothing is tuned in flight.

    window, points  the last so many s are used, with so many bumps
    size, length    m and s: by how much a target leaves a line, and how soon; size / length^2 is an acceleration
    noise, pointing  m and rad, of one observation
    """

    @validate_call
    def __init__(
        self, window: Positive = 3.0, points: Points = 6, size: Positive = 0.08, length: Positive = 3.0, noise: Positive = 0.01,
        pointing: Positive = 0.01,
    ) -> None:  # fmt: skip
        """Keep the numbers."""
        self.window, self.size, self.length, self.noise, self.pointing = window, size, length, noise, pointing
        self.times = np.linspace(-window, 0.0, points)
        apart = np.subtract.outer(self.times, self.times) / length
        size_, axes = np.linalg.eigh(np.exp(-(apart**2) / 2))
        root = np.sqrt(np.maximum(size_, 0.0))[:, None] * axes.T / size
        self.prior = np.block([
            [np.eye(2) / WIDE, np.zeros((2, points))], [np.zeros((points, 2)), root]
        ])  # fmt: skip

    def predict(self, seen: Seen) -> Motion:
        """Condition on what was seen: level axes together, since headings tie them, the vertical apart."""
        recent = latest(seen, self.window)
        values, slopes = self._rows(recent.time)
        centre = recent.position.mean(axis=0)
        away, none = (recent.position - centre) / self.noise, np.zeros(len(self.prior))
        rows, size = values / self.noise, len(self.prior)
        up = np.linalg.lstsq(np.vstack([self.prior, rows]), np.append(none, away[:, 2]), rcond=None)[0]
        level = [np.kron(np.eye(2), self.prior), np.kron(np.eye(2), rows)]
        right = [np.tile(none, 2), away[:, 0], away[:, 1]]
        across = self._across(recent, slopes)
        found = np.linalg.lstsq(
            np.vstack([*level, across]), np.concatenate([*right, np.zeros(len(across))]), rcond=None
        )[0]
        weights = np.stack([found[:size], found[size:], up], axis=-1)
        line = weights[:2] + np.stack([centre, np.zeros(3)])
        return Mean(line, self.times, weights[2:], self.length)

    def _rows(self, time: Array) -> tuple[Array, Array]:
        """What line and bumps (n, 2 + m) are at times (n,), and their derivatives."""
        apart = np.subtract.outer(time, self.times) / self.length
        bumps, one = np.exp(-(apart**2) / 2), np.ones((len(time), 1))
        values = np.hstack([one, time[:, None], bumps])
        return values, np.hstack([0 * one, one, -apart / self.length * bumps])

    def _across(self, seen: Seen, slopes: Array) -> Array:
        """Rows of the speeds across the headings, over their noise; none of a target that hardly moves."""
        told = np.isfinite(seen.heading)
        way = np.polyfit(seen.time, seen.position[:, :2], 1)[0]
        speed = float(np.hypot(*way))
        if speed < CREEP or not told.any():
            return np.zeros((0, 2 * len(self.prior)))
        a, rows = seen.heading[told, None], slopes[told] / (self.pointing * speed)
        return np.hstack([-np.sin(a) * rows, np.cos(a) * rows])
