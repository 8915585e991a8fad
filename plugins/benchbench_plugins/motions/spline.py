"""A target that runs through timed points, for example a predicted path of a mobile robot or a recorded one."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.motion import Motion, sample
from benchbench.ocp.reading import content
from benchbench.ocp.scenario import NonNegative
from benchbench.ocp.sizes import CSV_BYTES
from benchbench_plugins.motions.spline_fit import smoothed
from benchbench_plugins.motions.spline_table import FIELD, read

KEPT = 8
"""Paths that are kept in memory once they are fitted."""


@final
@dataclass(frozen=True)
class Spline(Motion):
    """Natural cubic spline through the rows `t,x,y,z` (s, m) of a CSV file with that header.

    noise_m  standard deviation of the measured positions' noise on each axis, m: the spline passes the points by so
             much (root mean square) and is as smooth as that allows; 0: through the points. Without it the noise of a
             recording becomes a motion that the vehicle is asked to follow: 1 mm at 100 Hz is 0.1 m/s from row to row.

    Before the first and after the last time the target goes on in a straight line. The cost of a plan does not depend
    on the number of rows: the spline is a table in which the planner looks up its place, not an expression.
    """

    csv: Path
    noise_m: NonNegative = 0.0

    @property
    def points(self) -> Array:
        """The rows of the file, less their noise, (n, 4); raises BadInput when the file is missing or malformed."""
        return _points(_content(self.csv), self.noise_m)

    @property
    def parameters(self) -> Array:
        """None: the table is part of the function, since every instance of a block would repeat it as parameters."""
        return np.zeros(0)

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        """Twice continuously differentiable; B-splines, evaluated as a function that the expression calls."""
        ends, rates, table = _table(_content(self.csv), self.noise_m)
        inside = ca.fmin(ca.fmax(time, ends[0]), ends[1])
        beyond = ca.fmin(time - ends[0], 0) * ca.DM(rates[0]) + ca.fmax(time - ends[1], 0) * ca.DM(rates[1])
        return table(inside) + beyond


@sample.register
def _(motion: Spline, times: Array) -> tuple[Array, Array]:
    """The same motion from SciPy's piecewise polynomials: what judges a plan shares only the points with the planner."""
    return _numbers(_content(motion.csv), motion.noise_m, times)


def _content(path: Path) -> bytes:
    return content(path, FIELD, CSV_BYTES, "a CSV file with the header t,x,y,z")


@lru_cache(KEPT)
def _points(data: bytes, noise: float) -> Array:
    points = read(data)
    found = smoothed(points, noise) if noise else points
    found.flags.writeable = False
    return found


@lru_cache(KEPT)
def _table(data: bytes, noise: float) -> tuple[Array, Array, ca.Function]:
    """First and last time (2,), velocities there (2, 3), and time -> position."""
    from scipy.interpolate import make_interp_spline  # a third of a second, which no other motion needs

    points = _points(data, noise)
    ends = points[[0, -1], 0]
    spline = make_interp_spline(points[:, 0], points[:, 1:], k=3, bc_type="natural")
    table = ca.Function.bspline(
        "path", [spline.t.tolist()], spline.c.ravel().tolist(), [3], 3, {"never_inline": True}
    )
    return ends, spline(ends, 1), table


def _numbers(data: bytes, noise: float, times: Array) -> tuple[Array, Array]:
    from scipy.interpolate import CubicSpline

    points = _points(data, noise)
    spline = CubicSpline(points[:, 0], points[:, 1:], bc_type="natural")
    inside = np.clip(times, *points[[0, -1], 0])
    velocity = spline(inside, 1)
    return spline(inside) + (times - inside)[:, None] * velocity, velocity
