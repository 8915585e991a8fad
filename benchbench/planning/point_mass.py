"""The time-optimal flight of a point mass with the vehicle's largest thrust: a start for handovers and races.

Exact steps under a thrust held per interval, one free duration per phase:

    p_1 = p_0 + h v_0 + h^2 / 2 (f - g e_3),   v_1 = v_0 + h (f - g e_3),   |f| <= f_max
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Block, Mpcc, Variable, block, rows
from benchbench.nlp.homotopy import homotopy
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.model import racing, space
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case
from benchbench.transcription.grid import Grid
from benchbench.transcription.nodal import own_duration, total_time, travel_time

SHORTEST = 1e-3
"""Shortest duration of a phase in s."""
INTERVALS = 8
"""Intervals per phase; more change the flight little."""


def fly(case: Case, ledger: Ledger, grid: Grid, corners: Array, conditions: Mpcc, progress: Array) -> Plan:
    """Return the vehicle's guess of how to follow the point mass, at the nodes of the grid.

    corners (phases + 1, 3) m: where each phase is first guessed to begin and end; conditions: more rows on the
    unknowns p (N + 1, 3), v (N + 1, 3), f (N, 3), T (phases, 1); progress (N + 1,) or (N + 1, stops): what the
    plan claims.
    """
    with ledger.building():
        mpcc = _problem(case, grid, corners) + conditions
    with ledger.guessing():
        values = homotopy(mpcc, case, ledger, "guess: point mass").values
    time = grid.time_weights @ values["T"].ravel()
    q, v, u = racing(case.model).follow(time, values["p"], values["v"], values["f"])
    return Plan.of(
        case.model, time=time, configuration=q, velocity=v, inputs=u, progress=progress,
        stop_names=case.scenario.itinerary.claimed,
    )  # fmt: skip


def _problem(case: Case, grid: Grid, corners: Array) -> Mpcc:
    scenario, model, nodes = case.scenario, case.model, grid.intervals + 1
    flown = scenario.flown(model, nodes)
    strongest = racing(model).specific_thrust(flown)[:-1]
    lift = -float(
        model.plant().acceleration(
            space(model).origin(), np.zeros(len(model.velocity.names)), 0 * model.hover()
        )[2]
    )
    last, box = scenario.ends(model), scenario.limits(model)
    share = np.interp(np.arange(nodes), *_phase_ends(grid))
    line = np.stack([np.interp(share, np.arange(len(corners)), x) for x in corners.T], axis=-1)
    low, high = (np.tile(b[:3], (nodes, 1)) for b in (box.lower, box.upper))
    low[0] = high[0] = line[0]
    low[-1], high[-1] = last.lower_q[:3], last.upper_q[:3]
    low_v, high_v = (x[:, :3].copy() for x in scenario.planned_rates_at(model, flown))
    low_v[0] = high_v[0] = 0.0
    low_v[-1], high_v[-1] = last.lower_v[:3], last.upper_v[:3]
    speed = (
        np.gradient(line, axis=0) / np.gradient(grid.time_weights @ [p.guess for p in grid.phases])[:, None]
    )
    hover = np.tile([0.0, 0.0, lift], (grid.intervals, 1))
    duration = np.array([[p.guess] for p in grid.phases])
    free = np.full_like(hover, np.inf)
    variables = (
        Variable("p", low, high, np.clip(line, low, high), "m"),
        Variable("v", low_v, high_v, np.clip(speed, low_v, high_v), "m/s"),
        Variable("f", -free, free, hover, "m/s^2"),
        Variable("T", 0 * duration + SHORTEST, 0 * duration + scenario.travel_time[1], duration, "s"),
    )
    blocks = (_steps(grid, lift), _thrust(strongest))
    return Mpcc(variables, blocks, (travel_time(grid),)) + total_time(scenario, grid)


def _phase_ends(grid: Grid) -> tuple[Array, Array]:
    """Nodes at which phases begin and end, and their numbers 0, 1, ..., each (phases + 1,)."""
    count = np.array([0, *(phase.intervals for phase in grid.phases)], float)
    return np.cumsum(count), np.arange(len(count), dtype=float)


def _steps(grid: Grid, gravity: float) -> Block:
    left, right = range(grid.intervals), range(1, grid.intervals + 1)
    own, share = own_duration(grid)
    slots = (*(rows(k, 3, w) for w in (left, right) for k in ("p", "v")), rows("f", 3, left), own)

    def step(p0: ca.SX, v0: ca.SX, p1: ca.SX, v1: ca.SX, f: ca.SX, duration: ca.SX, p: ca.SX) -> ca.SX:
        h, a = p[0] * duration, f - ca.vertcat(0, 0, p[1])
        return ca.vertcat(p1 - p0 - h * v0 - h**2 / 2 * a, v1 - v0 - h * a)

    numbers = np.hstack([share, np.full_like(share, gravity)])
    return block("point_mass", slots, step, parameters=numbers, unit="m, m/s")


def _thrust(strongest: Array) -> Block:
    slots = [rows("f", 3, range(len(strongest)))]
    return block(
        "thrust", slots, lambda f, most: ca.sumsqr(f) / most**2, -np.inf, 1.0, parameters=strongest[:, None]
    )
