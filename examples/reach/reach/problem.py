"""What is solved: one phase, and |p_N - p_end|^2 <= reach^2; smooth, so all three forms are the same."""

from __future__ import annotations

import casadi as ca
import numpy as np

from benchbench import Grid, Mpcc, Phase, Plan, Slot, rows
from benchbench.formulation import forms
from benchbench.formulation.formulation import Formulation
from benchbench.formulation.problem import Problem
from benchbench.formulation.transcribed import transcribed
from benchbench.mpcc.problem import block
from reach.scenario import AXES, Reach


def problem(scenario: Reach, case: Formulation, start: Plan) -> Problem:
    """Pose the flight, guessed from a plan."""
    model, n = case.model, scenario.intervals
    grid = Grid((Phase("flight", n, *scenario.travel_time, start.travel_time),))
    base, trajectory = transcribed(case, grid)
    place = [model.configuration.index(axis) for axis in AXES]
    last = Slot("q", rows("q", len(model.configuration.names), [n]).index[:, place])
    within = block(
        "reach", [last], lambda p, c: ca.sumsqr(p - c[:3]) / c[3] ** 2 - 1,
        parameters=np.append(scenario.end_point(model)[place], scenario.reach)[None], lower=-np.inf,
    )  # fmt: skip
    return Problem(base.start_from(trajectory.encode(start)) + Mpcc((), (within,)), trajectory, {})


for form in (forms.phases, forms.held, forms.free):
    form.register(Reach, problem)
