"""A plan is judged once; what differs in anything is judged anew."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchbench.nlp.ledger import Ledger
from benchbench.planning.case import Case
from benchbench.planning.result import Result
from benchbench.planning.strategy import judge
from benchbench.run import config


@pytest.fixture(scope="module")
def case() -> Case:
    found = config.compose("+scenario=static", "guess=line", "scenario.intervals=10")
    assert isinstance(found, Case)
    return found


@pytest.fixture
def made(case: Case) -> tuple[Result, Ledger]:
    """A straight way that nobody can fly, and the ledger of the run that has judged it."""
    ledger = Ledger(60.0)
    result = Result(planned=case.guess.plan(case, ledger), planner="by hand")
    assert not judge(result, case, ledger).certified
    return result, ledger


def test_the_same_plan_is_judged_once(case: Case, made: tuple[Result, Ledger]) -> None:
    result, ledger = made
    again = judge(result.telling(search="one more column"), replace(case, seed=7), ledger)
    assert again is judge(result, case, ledger)
    assert len(ledger.verdicts) == 1
    assert judge(result, case, Ledger(60.0)) is not again, "another run remembers nothing"


def test_another_plan_is_judged_anew(case: Case, made: tuple[Result, Ledger]) -> None:
    """Also where one begins like the other: the first stays as it is."""
    result, ledger = made
    first = judge(result, case, ledger)
    plan = replace(result.plan, inputs=1.5 * result.plan.inputs)
    other = judge(replace(result, planned=plan), case, ledger)
    assert other is not first
    assert other.record() != first.record()
    assert judge(result, case, ledger) is first


@pytest.mark.parametrize("name", ["time", "configuration", "velocity", "inputs", "progress"])
def test_a_plan_that_was_changed_in_place_is_judged_anew(
    case: Case, made: tuple[Result, Ledger], name: str
) -> None:
    result, ledger = made
    first = judge(result, case, ledger)
    getattr(result.plan, name)[-1] *= 1.01
    getattr(result.plan, name)[-1] += 1e-9
    assert judge(result, case, ledger) is not first


@pytest.mark.parametrize("name", ["limits", "scenario", "model"])
def test_another_task_is_another_verdict(case: Case, made: tuple[Result, Ledger], name: str) -> None:
    result, ledger = made
    first = judge(result, case, ledger)
    other = config.compose("+scenario=static", "guess=line", "scenario.intervals=10", "scenario.start.z=0.7")
    assert judge(result, replace(case, **{name: getattr(other, name)}), ledger) is not first
