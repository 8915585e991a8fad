"""Takes the noise out of a recorded path: the smoothest natural cubic spline that passes the points by the noise."""

from __future__ import annotations

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput

FEWEST = 5
"""Points from which SciPy smooths."""
SPAN = 12.0
"""Decades of the weight of smoothness that are searched to either side."""
ENOUGH = 0.02
"""Decades of it that change what the points are passed by, by less than a hundredth."""


def smoothed(points: Array, noise: float) -> Array:
    """Return points (n, 4) on the spline that minimises sum |x_i - f(t_i)|^2 + w integral |f''|^2.

    The weight w is the one for which the root mean square of x_i - f(t_i) on one axis is `noise` in m (Reinsch 1967). Where a
    straight line is as near as that, the line. Raises BadInput for fewer than `FEWEST` points.
    """
    from scipy.optimize import brentq

    if len(points) < FEWEST:
        raise BadInput(
            "scenario.target.noise_m", f"smooths {len(points)} rows", f"at least {FEWEST} rows, or 0"
        )
    time = (points[:, 0] - points[0, 0]) / np.mean(np.diff(points[:, 0]))  # one step is one: w has no unit

    def passing(decade: float) -> float:
        return float(np.sqrt(np.mean((_fit(time, points, decade) - points[:, 1:]) ** 2))) - noise

    if passing(-SPAN) >= 0:
        return points
    decade = SPAN if passing(SPAN) <= 0 else brentq(passing, -SPAN, SPAN, xtol=ENOUGH)
    return np.column_stack([points[:, 0], _fit(time, points, decade)])


def _fit(time: Array, points: Array, decade: float) -> Array:
    from scipy.interpolate import make_smoothing_spline

    return np.asarray(make_smoothing_spline(time, points[:, 1:], lam=10.0**decade)(time))
