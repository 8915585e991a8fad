"""A plan as a start towards what is newly known of its target: where it meets the target, it is moved with it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchbench.formulation.problem import Problem
from benchbench.ground.arrays import Array
from benchbench.ocp.model import AXES, Model, travels
from benchbench.planning.shift import marks


def followed(problem: Problem, model: Model, x: Array, away: Callable[[Array], Array]) -> Array:
    """Return unknowns whose places are moved as the target is: wholly in contact, less and less before and after.

    x     unknowns of a problem with a single contact at fixed nodes
    away  from times (n,) s to what the target is moved by, (n, 3) m
    Ends stay. Moved are places, and the speeds that go with them; of a robot that stands somewhere nothing is.
    """
    if not travels(model) or not problem.contact:
        return x
    values = problem.mpcc.split(x)
    (nodes,) = problem.contact.values()
    node_times = problem.trajectory.grid.time_weights @ values["T"].ravel()
    for suffix in ("", "_stage"):
        if f"q{suffix}" not in values:
            continue
        count, n = len(values[f"q{suffix}"]), len(node_times) - 1
        time = np.interp(marks(count, n), np.arange(n + 1.0), node_times)
        share = _share(time, node_times[nodes[0]], node_times[nodes[-1]], node_times[-1])
        moved = share[:, None] * away(time)
        for name, change in (("q", moved), ("v", np.gradient(moved, time, axis=0))):
            names = (model.configuration if name == "q" else model.velocity).names
            if set(AXES) <= set(names):
                columns = [names.index(axis) for axis in AXES]
                values[name + suffix] = _added(values[name + suffix], columns, change)
    return np.concatenate([values[v.name].ravel() for v in problem.mpcc.variables])


def _added(rows: Array, columns: list[int], change: Array) -> Array:
    found = rows.copy()
    found[:, columns] += change
    return found


def _share(time: Array, first: float, last: float, end: float) -> Array:
    """1 from first to last, 0 at 0 and at the end, without a step in the slope; times in s, the result as (n,) `time`."""
    before, after = time / first, (end - time) / (end - last)
    share = np.clip(np.minimum(before, after), 0.0, 1.0)
    return np.asarray(share**2 * (3 - 2 * share))
