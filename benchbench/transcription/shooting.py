"""Explicit Runge-Kutta methods by multiple shooting: one row per state and interval, no stage unknowns."""

from __future__ import annotations

from typing import Literal

import casadi as ca

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.mechanics import acceleration
from benchbench.ocp.model import Model, space
from benchbench.ocp.plan import bernstein
from benchbench.ocp.scenario import Scenario
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.nodal import (
    NodalTrajectory,
    cost,
    each_interval,
    nodal_variables,
    output_limits,
    total_time,
)
from benchbench.transcription.tableau import Tableau


def transcribe(
    tableau: Tableau, inputs: Literal["interval", "linear"], scenario: Scenario, model: Model, grid: Grid
) -> tuple[Mpcc, Trajectory]:
    """Return nodes, one step per interval and the cost; limits hold at the nodes.

    inputs "interval": one held input per interval; "linear": nodal inputs, linear in between. The end of a step is
    normalised: quaternions that may grow scale the thrust, and coarse grids are solved by that.
    """
    held = inputs == "interval"
    count = grid.intervals + (not held)

    def rows(q0: ca.SX, v0: ca.SX, q1: ca.SX, v1: ca.SX, *rest: ca.SX) -> ca.SX:
        *u, h = rest
        q, v = step(tableau, model, q0, v0, u, h)
        return ca.vertcat(q1 - space(model).normalised(q), v1 - v)

    block = each_interval("shooting", grid, model, 1 if held else 2, rows, "m, rad, m/s, rad/s")
    variables = nodal_variables(scenario, model, grid, count)
    mpcc = Mpcc(variables, (block,), cost(scenario, model, grid, count)) + total_time(scenario, grid)
    mpcc += output_limits(scenario, model, grid)
    return mpcc, NodalTrajectory(grid, model, "hold" if held else "linear", equations=(block.name,))


def step(
    tableau: Tableau, model: Model, q: ca.SX, v: ca.SX, points: list[ca.SX], h: ca.SX
) -> tuple[ca.SX, ca.SX]:
    """One explicit step of length h from q, v; `points` are the control points of the input."""
    slopes_q: list[ca.SX] = []
    slopes_v: list[ca.SX] = []
    for row, c in zip(tableau.a, tableau.c, strict=True):
        u = sum((b * point for b, point in zip(bernstein(len(points), c), points, strict=True)), ca.SX(0))
        place, speed = _moved(q, slopes_q, row, h), _moved(v, slopes_v, row, h)
        slopes_q.append(space(model).kinematics(place, speed))
        slopes_v.append(acceleration(model, place, speed, u))
    return _moved(q, slopes_q, tableau.b, h), _moved(v, slopes_v, tableau.b, h)


def _moved(start: ca.SX, slopes: list[ca.SX], weights: Array, h: ca.SX) -> ca.SX:
    used = [(w, slope) for w, slope in zip(weights, slopes, strict=False) if w != 0.0]
    return start + h * sum((w * slope for w, slope in used), ca.SX(0)) if used else start
