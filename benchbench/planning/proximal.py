"""A small price on leaving the plan before: where many motions are as good as each other, the next plan keeps to the last one's.

An arm that swings freely on its way has many ways to do so at the same cost. Each solve would find another one, with other errors of
the transcription than those that were taken off, in other intervals than those that were cut. With a price on the squared distance repeated
solves are a proximal-point method (Rockafellar 1976, doi:10.1137/0314056): its fixed points are those of the problem without.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from benchbench.formulation.problem import Problem
from benchbench.mpcc.problem import Mpcc, block, rows
from benchbench.ocp.model import Coordinates

PRICE = 1e-3
"""Share of a flight's time that it costs to fly all of it at rates that differ by their limits."""


NAME = "proximal"
"""Of the block of costs."""


def price_of(problem: Problem, velocity: Coordinates) -> float:
    """Return at which price a problem is kept near the plan that it starts from, 0 for none."""
    width = len(velocity.names)
    limit = np.maximum(np.abs(velocity.lower), np.abs(velocity.upper))
    column = int(np.argmax(np.isfinite(limit) & (limit > 0)))
    weights = next((c.parameters[:, width + column] for c in problem.mpcc.costs if c.name == NAME), None)
    if weights is None:
        return 0.0
    seconds = problem.trajectory.decode(problem.mpcc.split(problem.mpcc.guess), np.zeros(len(weights))).time
    return float(np.median(weights / np.gradient(seconds)) * limit[column] ** 2)


def kept_near(problem: Problem, velocity: Coordinates, price: float = PRICE) -> Problem:
    """Return the problem with a price on nodal velocities other than those it starts from; the same where it has none.

    Rates without a limit are free.
    """
    values = problem.mpcc.split(problem.mpcc.guess)
    start, nodes = values.get("v"), problem.trajectory.grid.intervals + 1
    if start is None or start.shape != (nodes, len(velocity.names)):
        return problem
    seconds = np.gradient(problem.trajectory.decode(values, np.zeros(nodes)).time)
    limit = np.maximum(np.abs(velocity.lower), np.abs(velocity.upper))
    weights = price * seconds[:, None] / np.where(limit > 0, limit, np.inf) ** 2
    width = len(limit)

    def distance(rates: ca.SX, p: ca.SX) -> ca.SX:
        return ca.dot(p[width:], (rates - p[:width]) ** 2)

    numbers = np.hstack([start, weights])
    cost = block(NAME, [rows("v", width, range(nodes))], distance, parameters=numbers, unit="s", symbols="v")
    return replace(problem, mpcc=problem.mpcc + Mpcc((), (), (cost,)))
