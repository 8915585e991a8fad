"""From a solved grid to the next one: where the new problem starts, and the error of its transcription taken off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchbench.certificate.replay import defects, replay
from benchbench.formulation.problem import Problem
from benchbench.ocp.model import Plant
from benchbench.ocp.plan import Plan
from benchbench.planning.result import Result
from benchbench.transcription.correction import correctable, corrected

BETWEEN = 10
"""Samples of an interval: states between its nodes are those that are flown, since an arm turns round within one interval."""


def started(problem: Problem, found: Result, plant: Plant) -> Problem:
    """Start a problem where a solved one of the same phases ended: at its durations, flown from node to node."""
    old, new = (one.trajectory.grid for one in (found.problem, problem))
    if [phase.name for phase in old.phases] != [phase.name for phase in new.phases]:
        return problem
    values = problem.trajectory.encode(flown_between(found.plan, plant), found.solved.values["T"].ravel())
    return replace(problem, mpcc=problem.mpcc.start_from(values))


def flown_between(plan: Plan, plant: Plant) -> Plan:
    """Return a plan with nodes between those of another, each interval flown from its planned state; the same for polynomial inputs."""
    if plan.interpolation == "bezier":
        return plan
    flight = replay(plan, plant, BETWEEN, restart_nodes=range(1, plan.intervals))
    q, v = flight.configuration.copy(), flight.velocity.copy()
    q[flight.nodes], v[flight.nodes] = plan.configuration, plan.velocity
    if not (np.isfinite(q).all() and np.isfinite(v).all()):
        return plan
    held = plan.interpolation == "hold"
    inputs = np.repeat(plan.inputs, BETWEEN, axis=0) if held else plan.input_at(flight.time)
    progress = np.zeros((len(q), *plan.progress.shape[1:]))
    progress[flight.nodes] = plan.progress
    return replace(
        plan, time=flight.time, configuration=q, velocity=v, inputs=inputs, progress=progress,
    )  # fmt: skip


def without_error(problem: Problem, plant: Plant) -> Problem:
    """Take the error of the transcription off its equations, as it is at the start of the problem; the same where that cannot be."""
    trajectory = problem.trajectory
    if not correctable(trajectory):
        return problem
    values = problem.mpcc.split(problem.mpcc.guess)
    plan = trajectory.decode(values, np.zeros(trajectory.grid.intervals + 1))
    missed = defects(plan, plant)
    ends = {"q": plan.configuration[1:] + missed.configuration, "v": plan.velocity[1:] + missed.velocity}
    if not all(np.isfinite(end).all() for end in ends.values()):
        return problem
    return replace(problem, mpcc=corrected(problem.mpcc, trajectory, values, ends))
