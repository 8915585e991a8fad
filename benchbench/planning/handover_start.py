"""A start for flights with stops: the time-optimal flight of a point mass that meets each target on the way."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import IncompatibleCase
from benchbench.mpcc.problem import Block, Mpcc, block, rows
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.model import travels
from benchbench.ocp.motion import motion_state
from benchbench.ocp.plan import Plan
from benchbench.ocp.stop import Stop, spread
from benchbench.planning.case import Case
from benchbench.planning.guess import over
from benchbench.planning.point_mass import INTERVALS, SHORTEST, fly
from benchbench.transcription.grid import Grid, Phase
from benchbench.transcription.nodal import durations

NEAR, SLOW = 0.1, 0.3
"""m and m/s within which the point mass meets the place from which the tool, hanging, touches the target."""


def point_mass_plan(case: Case, ledger: Ledger) -> Plan:
    """One phase to each stop and one to the end; what a point mass does not have goes in a straight line."""
    scenario, model, itinerary = case.scenario, case.model, case.scenario.itinerary
    if not travels(model):
        problem = f"no point mass flies as '{case.names['vehicle']}' moves, which has no coordinates x, y, z"
        raise IncompatibleCase("guess", problem, "simple, line, minimum_jerk, or phases from one of them")
    made = itinerary.listed
    start, end = scenario.start_point(model), scenario.end_point(model)
    guess = scenario.travel_time_guess * spread(len(made), itinerary.middle)
    spans, longest = np.diff([0.0, *guess, scenario.travel_time_guess]), scenario.travel_time[1]
    grid = Grid(tuple(Phase(f"leg_{i}", INTERVALS, SHORTEST, longest, float(s)) for i, s in enumerate(spans)))
    corners = [over(case, stop, time) for stop, time in zip(made, guess, strict=True)]
    hang = model.plant().tool(start, np.zeros(len(model.velocity.names)))[0] - start[:3]
    meetings = tuple(_meeting(grid, stop, i + 1, hang) for i, stop in enumerate(made))
    met = np.zeros((grid.intervals + 1, len(itinerary.claimed)))
    for i, stop in enumerate(made):
        met[(i + 1) * INTERVALS, itinerary.names.index(stop.name)] = 1.0
    plan = fly(case, ledger, grid, np.stack([start, *corners, end])[:, :3], Mpcc((), meetings), met)
    share = (plan.time / plan.travel_time)[:, None]
    line = (1 - share) * start + share * end
    q = plan.configuration.copy()
    own = np.ptp(q, axis=0) < 1e-9
    q[:, own] = line[:, own]
    q[[0, -1]] = start, end
    return replace(plan, configuration=q)


def _meeting(grid: Grid, stop: Stop, phases: int, hang: Array) -> Block:
    """|p + hang - p_T|^2 <= NEAR^2 and |v - v_T|^2 <= SLOW^2 at the node after so many phases, scaled."""
    motion, count, node = stop.target, len(grid.phases), phases * INTERVALS

    def near_and_slow(p: ca.SX, v: ca.SX, duration: ca.SX, numbers: ca.SX) -> ca.SX:
        time = ca.dot(numbers[3 : 3 + count], duration)
        position, velocity = motion_state(motion, time, numbers[3 + count :])
        far, fast = p + numbers[:3] - position, v - velocity
        return ca.vertcat(ca.sumsqr(far) / NEAR**2, ca.sumsqr(fast) / SLOW**2) - 1

    slots = (rows("p", 3, [node]), rows("v", 3, [node]), durations(grid, 1))
    given = np.concatenate([hang, grid.time_weights[node], motion.parameters])[None]
    name = f"{stop.prefix}meeting"
    return block(name, slots, near_and_slow, -np.inf, parameters=given, unit="1", function="meeting")
