"""Planning again and again while the target moves: one program, prepared once, each plan started from the last.

What changes from plan to plan (the target's motion, the vehicle's state) are numbers of the program, so that
nothing is built but the numbers. The problem is that of `strategy=phases`: one smooth solve.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from benchbench.certificate.certificate import Certificate
from benchbench.formulation.coupling import retargeted
from benchbench.formulation.handover import SHORTEST, phases
from benchbench.formulation.problem import Problem
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput, IncompatibleCase
from benchbench.mpcc.derivatives import Compile
from benchbench.mpcc.problem import Block, Variable
from benchbench.nlp.homotopy import Solved
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.solver import Outcome, Point, Setup
from benchbench.ocp.motion import Kind, Motion
from benchbench.ocp.plan import Plan
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.stop import Stop
from benchbench.planning.case import Case
from benchbench.planning.followed import followed
from benchbench.planning.guess import straight_line
from benchbench.planning.result import Result
from benchbench.planning.shift import Shift
from benchbench.planning.strategy import judge, pose

EASED = 10
"""Nodes over which a path condition that the start breaks has to be kept again."""
EASE = 1.2
"""Times what the start breaks it by, so that its own node is no constraint that rounding decides."""


@dataclass(frozen=True)
class Replan:
    """One answer: the case it is for (times count from its own start), what was found, wall seconds it took.

    cold: the warm start failed and the plan was made from the straight line.
    """

    case: Case
    result: Result
    seconds: float
    cold: bool = False

    @property
    def plan(self) -> Plan:
        """The plan from now on."""
        return self.result.plan

    def certificate(self) -> Certificate:
        """Judge the plan by the case it is for."""
        return judge(self.result, self.case, Ledger(self.case.time_limit))


@final
class Replanner:
    """Keeps the last solution of a handover; made once, which solves the case as it stands (`first`).

    The kind of the target's motion and its number of parameters stay. Raises IncompatibleCase for races and for
    solvers that build each problem anew.
    """

    def __init__(self, case: Case, rescue: bool = True) -> None:
        """Build the program; rescue: whether a plan that is not found from the last one is looked for from the straight line."""
        self.rescue = rescue
        stop = chased(case.scenario)
        contacts, self.kind = tuple(stop.contacts), Kind(stop.target)
        began, ledger = time.perf_counter(), Ledger(case.time_limit)
        problem = phases(case, straight_line(case))
        fast: Compile = "never" if case.compile == "never" else "optimised"
        setup = Setup(case.time_limit, case.iteration_limit, case.accuracy, fast)
        self._solve = case.solver.prepare_parametric(problem.mpcc, setup, contacts)
        result = pose(problem, replace(case, compile=fast), ledger, "first plan")
        self.first = self.last = Replan(case, result, time.perf_counter() - began, cold=True)

    def plan(self, target: Motion, q: Array, v: Array, elapsed: float = 0.0) -> Replan:
        """Plan from the vehicle's state for what is now known of the target.

        target   its motion, with time counted from now
        q, v     configuration (n_q,) and velocity (n_v,) of the vehicle now, in the model's order and units
        elapsed  s since the last plan began; that much of it is left out of the start
        Raises BadInput for another kind of target, for a state or time that is none, and when the contact has begun.
        """
        began = time.perf_counter()
        if not (np.isfinite(elapsed) and elapsed >= 0):
            raise BadInput("elapsed", f"{elapsed!r} was given", "a number of seconds of at least 0")
        case = moved(self.last.case, target, q, v, self.kind)
        old = self.last.result
        problem = renumbered(old.problem, case, target)
        duration = old.solved.values["T"].ravel()
        if elapsed >= duration[0] - SHORTEST:
            raise BadInput(
                "elapsed", f"{elapsed:g} s have gone, contact has begun", f"below {duration[0]:g} s"
            )
        start = self._start(problem, case, elapsed)
        problem = eased(problem, case, start.x)
        outcome = self._solve(problem.mpcc, start)
        cold = self.rescue and outcome.claim != "solved"
        result = self._cold(case) if cold else _result(problem, outcome)
        self.last = Replan(case, result, time.perf_counter() - began, cold)
        return self.last

    def _start(self, problem: Problem, case: Case, elapsed: float) -> Point:
        """The rest of the last plan, moved with its target."""
        old, known = self.last.result.solved, chased(self.last.case.scenario).target
        new = chased(case.scenario).target
        shift = Shift(problem.trajectory.grid, old.values["T"].ravel(), elapsed)
        rest = shift.point(problem.mpcc, old.outcome.point)

        def away(times: Array) -> Array:
            return self.kind.places(new, times) - self.kind.places(known, times + elapsed)

        x = followed(problem, case.model, rest.x, away)
        return replace(rest, x=np.clip(x, problem.mpcc.lower, problem.mpcc.upper))

    def _cold(self, case: Case) -> Result:
        return pose(phases(case, straight_line(case)), case, Ledger(case.time_limit), "cold plan")


def moved(case: Case, target: Motion, q: Array, v: Array, kind: Kind) -> Case:
    """The same case from another state, with another motion of the same kind; raises BadInput otherwise."""
    for field, values, box in (("q", q, case.model.configuration), ("v", v, case.model.velocity)):
        if np.shape(values) != (len(box.names),) or not np.all(np.isfinite(values)):
            problem, names = f"{np.array(values).tolist()} was given", ", ".join(box.names)
            raise BadInput(field, problem, f"{len(box.names)} numbers: {names}")
    if not kind.has(target):
        known = type(chased(case.scenario).target).__name__
        raise BadInput("target", f"'{type(target).__name__}' is another kind of motion", known)
    start = dict(zip(case.model.configuration.names, map(float, q), strict=True))
    rates = dict(zip(case.model.velocity.names, map(float, v), strict=True))
    update = {"target": target, "start": start, "start_velocity": rates}
    return replace(case, scenario=case.scenario.model_copy(update=update))


def chased(scenario: Scenario) -> Stop:
    """Return the stop of which news may come, whose motion is the scenario's `target`; raises IncompatibleCase without."""
    stops = scenario.itinerary.stops
    if len(stops) != 1 or stops[0].prefix:
        raise IncompatibleCase("scenario", "has no single target that moves", "a handover with one target")
    return stops[0]


def renumbered(problem: Problem, case: Case, target: Motion) -> Problem:
    """The problem of phases with the start of another case and its target: what `phases` would build, guesses aside."""
    scenario, model = case.scenario, case.model
    ends = {"q": scenario.start_point(model), "v": scenario.start_rates(model)}
    variables = tuple(_starting(v, ends[v.name]) if v.name in ends else v for v in problem.mpcc.variables)
    contacts = chased(scenario).contacts
    blocks = tuple(retargeted(b, target) if b.name in contacts else b for b in problem.mpcc.constraints)
    return replace(problem, mpcc=replace(problem.mpcc, variables=variables, constraints=blocks))


def eased(problem: Problem, case: Case, x: Array) -> Problem:
    """The same with path conditions that the start may break, if it does, by what it breaks them, falling to 0 over `EASED` nodes.

    What is known of a target changes from plan to plan; a vehicle at the edge of what its distance to it allows is suddenly
    beyond, and no plan at all would begin there. x: unknowns that begin at the start.
    """
    kept = [
        name for name, contact in chased(case.scenario).contacts.items() if contact.kept == "until contact"
    ]
    values = problem.mpcc.split(x)
    blocks = tuple(_eased(b, values) if b.name in kept else b for b in problem.mpcc.constraints)
    return replace(problem, mpcc=replace(problem.mpcc, constraints=blocks))


def _eased(block: Block, values: dict[str, Array]) -> Block:
    z = np.concatenate([values[slot.variable].ravel()[slot.index[0]] for slot in block.slots])
    broken = np.maximum(block.function(z, block.parameters[0], 0.0).full().ravel() - block.upper[0], 0.0)
    share = np.clip(1 - np.arange(block.instances) / EASED, 0.0, 1.0)
    return replace(block, upper=block.upper + share[:, None] * EASE * broken)


def _starting(variable: Variable, values: Array) -> Variable:
    lower, upper, guess = (a.copy() for a in (variable.lower, variable.upper, variable.guess))
    lower[0] = upper[0] = guess[0] = values
    return replace(variable, lower=lower, upper=upper, guess=guess)


def _result(problem: Problem, outcome: Outcome) -> Result:
    values = problem.mpcc.split(outcome.point.x)
    return Result.of(problem, Solved(outcome, values, outcome.point.x, 0.0))
