"""The search for the fastest plan that succeeds: what is searched, when flights end, what is on the front."""

from __future__ import annotations

from pathlib import Path

import pytest
from scipy.stats import binom

from benchbench.analysis.binomial import decided, exact_bound
from benchbench.analysis.front import Candidate, candidate, fastest, front
from benchbench.cli import commands
from benchbench.ground.errors import BadInput
from benchbench.report.front import draw_front


def flown(travel_time: float, succeeded: int, flights: int = 59) -> Candidate:
    row = {
        "certified": True, "travel_time_s": travel_time, "flights": flights, "flights_succeeded": succeeded,
        "flights_low_exact": exact_bound(succeeded, flights), "flights_low": 0.1, "flights_high": 0.9,
    }  # fmt: skip
    found = candidate([f"slope={travel_time}"], row)
    assert found is not None
    return found


@pytest.mark.parametrize(("successes", "runs"), [(59, 59), (50, 59), (1, 20), (92, 93)])
def test_the_exact_bound_is_the_rate_at_which_so_many_successes_are_as_rare_as_one_in_twenty(
    successes: int, runs: int
) -> None:
    assert binom.sf(successes - 1, runs, exact_bound(successes, runs)) == pytest.approx(0.05)


def test_flights_end_where_more_of_them_decide_nothing() -> None:
    """59 of 59 prove 95 %; with one failure 93 are needed, so that 59 cannot prove it any more."""
    assert decided(59, 59, 93, 0.95) and not decided(58, 58, 93, 0.95)
    assert decided(10, 11, 59, 0.95) and not decided(10, 11, 93, 0.95)
    assert decided(92, 93, 200, 0.95) and not decided(91, 92, 200, 0.95)


def test_the_front_has_what_no_other_plan_beats() -> None:
    found = [flown(3.2, 59), flown(2.9, 2), flown(3.0, 40), flown(3.1, 30), flown(3.3, 59), flown(2.85, 2)]
    assert [(one.travel_time, one.succeeded) for one in front(found)] == [(2.85, 2), (3.0, 40), (3.2, 59)]
    best = fastest(found, 0.95)
    assert best is not None and best.travel_time == 3.2
    assert fastest(found, 0.97) is None
    assert candidate([], {"certified": False, "flights": None}) is None


def test_what_is_searched() -> None:
    """The slope and the aim, unless something else is given as a list."""
    usual = commands.run("robust", ["+scenario=circle", "flights=100"])
    assert isinstance(usual, commands.Sweep)
    assert {"-m", "+scenario/contact=approach", "flights=100", "target_success=0.95"} <= set(usual.arguments)
    assert sum("," in text for text in usual.arguments) == 2
    own = commands.run("robust", ["+scenario=circle", "scenario.authority=0,0.05"])
    assert isinstance(own, commands.Sweep)
    assert [text for text in own.arguments if "," in text] == ["scenario.authority=0,0.05"]
    with pytest.raises(BadInput, match="scenario"):
        commands.run("robust", ["flights=3"])
    for scenario, says in (("race", "no ball"), ("circle,two_free", "2 targets")):
        with pytest.raises(BadInput, match=says) as told:
            commands.run("robust", [f"+scenario={scenario}"])
        assert told.value.field == "scenario"
    for wrong in ("2", "0", "nan", "often"):
        with pytest.raises(BadInput, match="target_success"):
            commands.run("robust", ["+scenario=circle", f"target_success={wrong}"])


def test_the_picture_of_a_front(tmp_path: Path) -> None:
    draw_front(tmp_path / "front.png", [flown(3.2, 59), flown(2.9, 2)], 0.95, "circle")
    assert (tmp_path / "front.png").stat().st_size > 10_000
