"""What the loop does where a round or a start brings nothing new: without the margins that failed, on from where rounds were used up."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import composing
import pytest

from benchbench.nlp.ledger import Ledger
from benchbench.planning import loop, posing
from benchbench.planning.case import Case
from benchbench.planning.ladder import climb
from benchbench.planning.loop import Loop, phases_again
from benchbench.planning.margins import NONE, with_margins
from benchbench.planning.result import Result


@lru_cache
def coarse_flight() -> tuple[Case, Result]:
    """A flight on a grid that is too coarse for its certificate."""
    case = composing.case_of("+scenario=static", "solver=ipopt", "compile=never", "scenario.intervals=40")
    case = with_margins(case, NONE)
    return case, climb(case, Ledger(60.0), posing.line(case))


def looped(rounds: Loop) -> bool:
    case, found = coarse_flight()
    return rounds.settles(case, found, NONE)


def test_a_solve_that_fails_with_new_margins_is_tried_without_them() -> None:
    """Whatever margins a round asks for cannot be kept; errors are taken off and grids refined all the same."""
    case, _ = coarse_flight()
    asked = []

    def unable(level: Case, ledger: Ledger, near: Result, correct: bool) -> Result:
        asked.append(level.scenario)
        found = phases_again(level, ledger, near, correct)
        if not level.scenario.rate_margin and not level.scenario.contact_margin:  # type: ignore[attr-defined]
            return found
        failed = found.solved.claiming("iteration_limit", "")
        return replace(found, posed=replace(found.solution, solved=failed))

    tried = Loop(case, Ledger(60.0), 8 * case.scenario.grid_intervals, 0.5, again=unable)
    looped(tried)
    pairs = list(pairwise(asked))
    failed = [one for one in pairs if one[0].rate_margin or one[0].contact_margin]  # type: ignore[attr-defined]
    assert failed, "the first round asks for margins"
    assert all(not after.rate_margin and not after.contact_margin for _, after in failed)  # type: ignore[attr-defined]
    assert all(found.claimed for found, _ in tried.tried)


def test_the_same_plan_from_another_start_goes_on_where_rounds_were_used_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(loop, "ROUNDS", 0)
    case, _ = coarse_flight()
    tried = Loop(case, Ledger(60.0), 8 * case.scenario.grid_intervals, 0.5)
    assert not tried.certifies(case, posing.line(case)) and len(tried.tried) == 1
    monkeypatch.setattr(loop, "ROUNDS", 5)
    assert tried.certifies(case, posing.line(case))
    assert any(told.endswith("as from an earlier start") for told in tried.told)


def test_the_same_plan_from_another_start_is_not_judged_again_where_nothing_helped() -> None:
    case, _ = coarse_flight()
    tried = Loop(case, Ledger(60.0), case.scenario.grid_intervals, 1e-6, correction=False)
    assert not tried.certifies(case, posing.line(case))
    count = len(tried.tried)
    assert not tried.certifies(case, posing.line(case)) and len(tried.tried) == count


def test_a_correction_that_bends_quaternions_is_left_for_a_finer_grid() -> None:
    """Ten nodes from gate to gate: with the error of Runge-Kutta taken off, attitudes are 4e-6 too long, on any grid."""
    case = composing.case_of(
        "+scenario=race",
        "scenario.gates=null",
        "scenario.track=[{x: 1.586, y: -1.444, z: 1.801, radius: 0.4129},"
        "{x: 3.197, y: -5.047, z: 1.124, radius: 0.6337},"
        "{x: -4.636, y: 1.992, z: 1.277, width: 1.944, height: 0.614, yaw: 1.17, direction: either},"
        "{x: 4.006, y: 3.647, z: 4.525, width: 1.815, height: 0.7022, yaw: 0.5718},"
        "{x: -2.508, y: 7.055, z: 2.434, radius: 0.1819, speed: [5.878, 7.189]}]",
        "scenario.start={x: 7.566, y: -3.331, z: 2.391}",
        "scenario.end={x: -6.372, y: 6.759, z: 3.743}",
        "scenario.nodes_per_gate=10",
        "solver=ipopt", "compile=never",
    )  # fmt: skip
    result = case.plan(Ledger(60.0))
    assert case.judge(result).certified and len(result.account["refinement"]) <= 5
