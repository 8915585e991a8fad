"""Slack: what a failed solve is followed by. Tasks without a flight name what conflicts, tasks with one are never called infeasible."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
import pytest
from small_mpccs import by_hand

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import evaluate
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.contact import Condition, Contact, Target
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.node import Node
from benchbench.planning import posing
from benchbench.planning.case import Case
from benchbench.planning.disturb import disturbed
from benchbench.planning.elastic import PREFIX, ease, with_slack
from benchbench.planning.ladder import coarse
from benchbench.planning.margins import NONE, with_margins
from benchbench.planning.rescue import rescue
from benchbench.run import config, pipeline

CROSSING = "+scenario=linear scenario.target.velocity_mps=[0,2,0] scenario.target.start_m=[1,-2,0.4]"
"""A target that crosses at 2 m/s, to be met within 0.01 m/s by a vehicle that flies 1.3 m/s, for one average step."""


@lru_cache
def case_of(words: str) -> Case:
    case = config.compose(*words.split(), "solver=ipopt", "compile=never", "iteration_limit=300")
    return coarse(with_margins(case, NONE))


def looked(words: str, seed: int = 0) -> Any:
    case, ledger = case_of(words), Ledger(60.0)
    start = disturbed(case.guess.plan(case, ledger), case, seed)
    return ease(posing.phases(case, start), case, ledger, "slack")


def test_slack_makes_any_point_feasible_in_what_are_no_equations() -> None:
    """At the guess every soft row is kept, its slack is what the row misses there, and equations are untouched."""
    case = case_of("+scenario=circle")
    problem = posing.phases(case, posing.line(case)).mpcc
    soft = with_slack(problem)
    x = soft.guess
    for before, after in zip(problem.constraints, soft.constraints, strict=True):
        if np.all(before.lower == before.upper):
            assert after is before
            continue
        value = evaluate(after, soft, x)
        assert np.all(value <= after.upper + 1e-12) and np.all(value >= after.lower - 1e-12)
        missed = evaluate(before, problem, problem.guess) - before.upper
        (slack,) = [v.guess for v in soft.variables if v.name == f"{PREFIX}{before.name}"]
        np.testing.assert_allclose(slack[:, before.upper.shape[1] :], np.maximum(missed, 0.0))


def test_pairs_are_decided_before() -> None:
    with pytest.raises(ValueError, match="pairs"):
        with_slack(by_hand()[0].mpcc)


@pytest.mark.parametrize("seed", [0, 7])
@pytest.mark.parametrize(
    "words", ["+scenario=circle", "+scenario=static", "+scenario=random_handover seed=99"]
)
def test_a_task_with_a_flight_ends_without_slack(words: str, seed: int) -> None:
    found = looked(words, seed)
    assert found.feasible and not found.conflicts
    case = case_of(words)
    assert rescue(case, Ledger(60.0), [found.result.plan]).conflict == ""


@pytest.mark.parametrize(
    ("words", "missed", "against"),
    [
        ("+scenario=circle scenario.travel_time=[0.1,2.6]", "travel time 2.8", "motor"),
        (CROSSING, "heading error", "largest rate of y, 1.3 m/s"),
    ],
)
def test_a_task_without_a_flight_names_what_conflicts(words: str, missed: str, against: str) -> None:
    """The quickest circle known on this grid takes 2.85 s or more; a nose cannot be turned by 90 degrees before the target is gone."""
    case, ledger = case_of(words), Ledger(60.0)
    start = case.guess.plan(case, ledger)
    found = rescue(case, ledger, [start, disturbed(start, case, 7)])
    assert found.plan is None
    assert "no feasible plan found (no proof)" in found.conflict
    asked, able = found.conflict.split(", against ")
    assert missed in asked and against in able


def test_two_starts_that_end_with_the_same_slack_say_what_conflicts() -> None:
    """The second need not be looked at from where it failed, too; with another slack than before it has to be."""
    case = case_of("+scenario=circle scenario.travel_time=[0.1,2.6]")
    start = case.guess.plan(case, Ledger(60.0))
    least = ease(posing.phases(case, start), case, Ledger(60.0), "slack").total
    for before, solves in ((least, 1), (3 * least, 2)):
        ledger = Ledger(60.0)
        assert "travel time" in rescue(case, ledger, [start, start], [before]).conflict
        assert len(ledger.solves) == solves


def test_the_default_strategy_says_so_and_stops() -> None:
    """Within 1000 iterations in all; without it four starts used 400 to 3000 each on two grids."""
    words = "+scenario=circle scenario.travel_time=[0.1,2.6]"
    record = pipeline.run(config.compose(*words.split(), "solver=ipopt")).record
    assert record["status"] == "infeasible" and not record["certified"]
    assert list(record["reasons"]) == [record["conflict"]] and "travel time" in record["conflict"]
    assert record["iterations"] < 1000
    assert len(record["refinement"]) == 1


def test_a_solve_that_does_not_end_proves_no_conflict() -> None:
    case = replace(case_of(CROSSING), iteration_limit=2)
    start = case.guess.plan(case, Ledger(60.0))
    found = rescue(case, Ledger(60.0), [start])
    assert found.plan is None and found.conflict == ""


class Above(Contact):
    """The end effector is 4 cm above the target in contact, which position forbids."""

    noun: ClassVar[str] = "depth below the least height"
    aside: ClassVar[str] = "below the least height"
    unit: ClassVar[str] = "m"
    reach: ClassVar[None] = None
    limit = 0.005

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        return Condition(
            (target.position[2] + 0.04 - model.tool(node.configuration)[2]) / self.limit - 1, self.unit
        )

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        return np.maximum(target_position[..., 2] + 0.04 - plant.tool(q, v)[0][..., 2], 0.0)


def test_two_conditions_that_exclude_each_other_are_both_named() -> None:
    case, ledger = case_of("+scenario=static"), Ledger(60.0)
    both = case.scenario.model_copy(update={"contacts": {**case.scenario.contacts, "above": Above()}})
    case = replace(case, scenario=both)
    found = rescue(case, ledger, [case.guess.plan(case, ledger)])
    asked, able = found.conflict.split(", against ")
    names = {"distance", "depth below the least height"}
    assert {name for name in names if name in asked} | {name for name in names if name in able} == names
