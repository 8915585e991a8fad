"""From a race to the problems it can be posed as: phases, gates held at nodes, gates by progress variables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchbench.formulation.formulation import Formulation
from benchbench.formulation.gates import StatePlace, at_nodes, by_progress, passed_at
from benchbench.formulation.problem import NodesByStop, Problem
from benchbench.formulation.transcribed import transcribed
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Mpcc
from benchbench.ocp.gates import passes
from benchbench.ocp.model import racing
from benchbench.ocp.plan import ONLY, Plan
from benchbench.ocp.race import Race
from benchbench.transcription.grid import Grid, Phase, Trajectory

SHORTEST = 1e-3
"""Shortest duration of a segment in s."""
ALLOWANCE = 0.01
"""A plan that misses a gate by less than this, m, is taken to pass it."""


def straight_line(race: Race, case: Formulation) -> Plan:
    """Along the straight lines between the gates at the speed of the guess, upright, at hover."""
    model = case.model
    corners = np.array([race.start_position, *(goal.position for goal in race.goals)])
    passed = np.concatenate([[0.0], np.cumsum(race.segments)]) / race.speed_guess
    time = np.linspace(0.0, passed[-1], race.grid_intervals + 1)
    place = np.stack([np.interp(time, passed, column) for column in corners.T], axis=-1)
    lift = np.tile([0.0, 0.0, float(np.sum(model.hover()))], (race.grid_intervals, 1))
    q, v, _ = racing(model).follow(time, place, np.gradient(place, time, axis=0), lift)
    progress = np.zeros(race.grid_intervals + 1)
    progress[[int(np.argmin(np.abs(time - t))) for t in passed[1:]]] = 1.0
    hover = np.tile(model.hover(), (race.grid_intervals, 1))
    return Plan.of(model, time=time, configuration=q, velocity=v, inputs=hover, progress=progress)


def segments(race: Race, intervals: int, guess: Array) -> Grid:
    """Time axis with one phase per segment; `guess` are their durations (segments,) in s."""
    longest = race.travel_time[1]
    names = [f"gate_{i + 1}" for i in range(len(race.goals) - 1)] + ["end"]
    return Grid(
        tuple(Phase(n, intervals, SHORTEST, longest, float(s)) for n, s in zip(names, guess, strict=True))
    )


def phases(race: Race, case: Formulation, start: Plan) -> Problem:
    """Each gate is passed at the last node of its segment; guessed from a plan; smooth."""
    grid = segments(race, race.nodes_per_gate, np.diff([0.0, *_times(race, start)]))
    grid = Grid(tuple(phase.on(case.mesh) for phase in grid.phases))
    base, trajectory = transcribed(case, grid)
    held = at_nodes(race, _place(case), grid.ends, race.goals)
    return Problem(
        base.start_from(trajectory.encode(start)) + Mpcc((), held),
        trajectory,
        _at(grid.ends),
    )


def held(race: Race, case: Formulation, start: Plan) -> Problem:
    """One step size, each gate at the node nearest to where the plan passes it; smooth."""
    base, trajectory = _flight(race, case, start)
    nodes = (*nearest_nodes(race, start, trajectory), race.grid_intervals)
    return Problem(
        base + Mpcc((), at_nodes(race, _place(case), nodes, race.goals)),
        trajectory,
        _at(nodes),
    )


def free(race: Race, case: Formulation, start: Plan) -> Problem:
    """One step size; progress variables and complementarity say at which nodes the gates are passed."""
    base, trajectory = _flight(race, case, start)
    end = at_nodes(race, _place(case), [race.grid_intervals], race.goals[-1:])
    mpcc = base + Mpcc((), end) + by_progress(race, _place(case), race.grid_intervals)
    kappa = passed_at(race.grid_intervals, nearest_nodes(race, start, trajectory))
    return Problem(mpcc.start_from({"kappa": kappa}), trajectory, None)


def nearest_nodes(race: Race, plan: Plan, trajectory: Trajectory) -> tuple[int, ...]:
    """Nodes of a grid of one step size nearest to where a plan passes the gates, the end left out."""
    time = trajectory.grid.time_weights @ trajectory.encode(plan)["T"].ravel()
    nodes = [int(np.argmin(np.abs(time - t))) for t in _times(race, plan)[:-1]]
    return tuple(np.clip(nodes, 1, trajectory.grid.intervals - 1).tolist())


def _times(race: Race, plan: Plan) -> Sequence[float]:
    """When a plan passes the gates, the end included, in s: as it claims, else where it is nearest to them."""
    claimed = plan.time[plan.progress > 0.5]
    if len(claimed) == len(race.goals):
        return tuple(claimed)
    found = passes(plan.time, plan.configuration[:, :3], race.goals, ALLOWANCE)
    return (*(one.time for one in found[:-1]), plan.travel_time)


def _flight(race: Race, case: Formulation, start: Plan) -> tuple[Mpcc, Trajectory]:
    grid = Grid((Phase("flight", race.grid_intervals, *race.travel_time, start.travel_time),))
    base, trajectory = transcribed(case, grid)
    return base.start_from(trajectory.encode(start)), trajectory


def _at(nodes: Sequence[int]) -> NodesByStop:
    """Nodes at which the gates are passed, in the only column of the progress."""
    return dict.fromkeys(ONLY, tuple(nodes))


def _place(case: Formulation) -> StatePlace:
    model = case.model
    return StatePlace("q", len(model.configuration.names), len(model.velocity.names), model)
