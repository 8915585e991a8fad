"""What every initial guess must do: a plan that exists, keeps ends and limits, and makes progress."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from benchbench.conformance.checks.require import require
from benchbench.ground.arrays import Array
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case, Guess
from benchbench.planning.guess import first_plan

ROUNDING = 1e-6
"""Limits may be exceeded by what solvers leave, in any unit."""


@dataclass(frozen=True)
class Guessed:
    """The plans of a guess for a case, made once for all checks."""

    guess: Guess
    case: Case

    @cached_property
    def plans(self) -> list[Plan]:
        """The undisturbed one, and those of the seeds 1, 2 and 3."""
        return [self.guess.plan(self.case, Ledger(60.0)), *map(self.seeded, (1, 2, 3))]

    def seeded(self, seed: int) -> Plan:
        """Make the plan of a seed."""
        return first_plan(replace(self.case, guess=self.guess, seed=seed), Ledger(60.0))


def check_plan(guessed: Guessed) -> None:
    """Finite, time from 0 on, for this vehicle, with progress made inside the flight."""
    case = guessed.case
    for plan in guessed.plans:
        require(plan.coordinate_names == case.model.configuration.names, "plans for another vehicle")
        for name in ("time", "configuration", "velocity", "inputs", "progress"):
            require(bool(np.all(np.isfinite(getattr(plan, name)))), f"{name} is not finite")
        require(plan.time[0] == 0 and bool(np.all(np.diff(plan.time) > 0)), "time does not increase from 0")
        low, high = case.scenario.travel_time
        require(low <= plan.travel_time <= high, f"travel time {plan.travel_time} s is not allowed")
        require(bool(np.all(plan.progress_by_stop.sum(axis=0) > 0)), "makes no progress at a stop")
        for first, last in plan.contacts:
            require(first > 0 and last < plan.intervals, "contact at an end")


def check_limits(guessed: Guessed) -> None:
    """Starts and ends where the scenario says, configurations and inputs within their limits; disturbed ones too."""
    case = guessed.case
    box, inputs = case.scenario.limits(case.model), case.model.inputs
    for plan in guessed.plans:
        for where, k, point in (
            ("start", 0, case.scenario.start_point(case.model)),
            ("end", -1, case.scenario.end_point(case.model)),
        ):
            gap = float(np.max(np.abs(plan.configuration[k] - point)))
            require(gap <= ROUNDING, f"misses the {where} by {gap:.3g}")
        for what, values, low, high in (
            ("configuration", plan.configuration, box.lower, box.upper),
            ("input", plan.inputs, inputs.lower, inputs.upper),
        ):
            beyond = float(np.max(np.maximum(low - values, values - high)))
            require(beyond <= ROUNDING, f"{what} exceeds its limits by {beyond:.3g}")


def check_seeds(guessed: Guessed) -> None:
    """The same seed gives the same start, another one another contact time, travel time, path and inputs.

    And other velocities, unless it has none: lines leave those of quaternion vehicles at zero.
    """
    _, one, other, _ = guessed.plans
    again = guessed.seeded(1)
    for name in ("time", "configuration", "velocity", "inputs"):
        require(np.array_equal(getattr(one, name), getattr(again, name)), f"{name} differs for equal seeds")
        moved = not np.allclose(getattr(one, name), getattr(other, name))
        require(moved or not np.any(getattr(one, name)), f"{name} is the same for two seeds")
    require(abs(_contact(one) - _contact(other)) > 1e-3, "contact at the same time for two seeds")


CHECKS = (check_plan, check_limits, check_seeds)


def _contact(plan: Plan) -> float:
    """Mean time of the progress that is made, s."""
    weights: Array = plan.progress_by_stop.sum(axis=1)
    return float(plan.time @ weights / weights.sum())
