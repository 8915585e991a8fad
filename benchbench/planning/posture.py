"""How a robot that stands somewhere reaches a place: its own tool in numbers, searched and then refined."""

from __future__ import annotations

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.planning.case import Case

SAMPLES, WIDE = 2000, {"m": 5.0, "rad": np.pi}
"""Configurations that are looked at, and how far from the start a coordinate without limits is looked for."""


def nearest_touch(case: Case, places: Array) -> tuple[float, Array]:
    """Return how near the tool comes to one of several places (n, 3), in m, and the configuration (n_q,) that does."""
    tried, tools = _sampled(case)
    apart = np.linalg.norm(tools[:, None] - places, axis=2)
    sample, place = np.unravel_index(int(np.argmin(apart)), apart.shape)
    return _refined(case, tried[sample], places[place])


def touching(case: Case, place: Array, near: Array) -> Array:
    """Return the configuration (n_q,) that has the tool nearest to a place (3,), of several the one nearest to `near` (n_q,)."""
    tried, tools = _sampled(case)
    close = np.argsort(np.linalg.norm(tools - place, axis=1))[:20]
    starts = [near, *tried[close[np.argsort(np.linalg.norm(tried[close] - near, axis=1))[:3]]]]
    found = [_refined(case, q, place) for q in starts]
    least = min(gap for gap, _ in found)
    return min((q for gap, q in found if gap < least + 1e-3), key=lambda q: float(np.linalg.norm(q - near)))


def _sampled(case: Case) -> tuple[Array, Array]:
    """Configurations (n, n_q) within limits, spread evenly, and the tool's place (n, 3) in each."""
    from scipy.stats import qmc

    low, high = _box(case)
    q = low + (high - low) * qmc.Halton(len(low), scramble=False).random(SAMPLES)
    return q, case.model.plant().tool(q, np.zeros((SAMPLES, len(case.model.velocity.names))))[0]


def _box(case: Case) -> tuple[Array, Array]:
    limits, start = case.scenario.limits(case.model), case.scenario.start_point(case.model)
    wide = np.array([WIDE.get(unit, 1.0) for unit in limits.units])
    low = np.where(np.isfinite(limits.lower), limits.lower, start - wide)
    return low, np.where(np.isfinite(limits.upper), limits.upper, start + wide)


def _refined(case: Case, start: Array, place: Array) -> tuple[float, Array]:
    """Least squares from a configuration: how near the tool comes, m, and where."""
    from scipy.optimize import least_squares

    plant, still = case.model.plant(), np.zeros(len(case.model.velocity.names))
    low, high = _box(case)
    own = low < high
    first = np.clip(start, low, high)

    def gap(free: Array) -> Array:
        q = first.copy()
        q[own] = free
        return np.asarray(plant.tool(q, still)[0] - place)

    inside = np.clip(first[own], low[own] + 1e-9, high[own] - 1e-9)
    found = least_squares(gap, inside, bounds=(low[own], high[own]), xtol=1e-12)
    q = first.copy()
    q[own] = found.x
    return float(np.linalg.norm(found.fun)), q
