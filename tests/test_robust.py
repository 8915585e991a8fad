"""The search for the fastest plan that succeeds: what is searched, when flights end, what is on the front."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest
from program import told
from scipy.stats import binom

from benchbench.analysis.binomial import decided, exact_bound
from benchbench.analysis.front import Candidate, candidate, elsewhere, fastest, front, paired, proves
from benchbench.analysis.refining import finer, unseen
from benchbench.cli import commands
from benchbench.ground.errors import BadInput, BenchBenchError
from benchbench.report.front import draw_front


def flown(travel_time: float, succeeded: int, flights: int = 59, *overrides: str) -> Candidate:
    row = {
        "certified": True, "travel_time_s": travel_time, "flights": flights, "flights_succeeded": succeeded,
        "flights_low_exact": exact_bound(succeeded, flights), "flights_low": 0.1, "flights_high": 0.9,
        "flight_reasons": {"too fast": float(flights - succeeded)},
    }  # fmt: skip
    found = candidate(overrides or (f"slope={travel_time}",), row)
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


def slope(value: float, travel_time: float, succeeded: int, flights: int = 20, aim: float = 1.0) -> Candidate:
    return flown(travel_time, succeeded, flights, "+scenario=circle", f"slope={value:g}", f"aim={aim:g}")


def asked(found: list[Candidate]) -> list[str]:
    return [" ".join(one[1:]) for one in finer(found, "slope", 0.95)]


def test_a_search_goes_on_where_success_falls() -> None:
    """Between neighbours that differ; not between two that never succeed, nor beyond what proves the target."""
    proved, half, none, fast = slope(4, 3.2, 59, 59), slope(6, 3.0, 10), slope(8, 2.9, 1), slope(12, 2.8, 0)
    assert asked([fast, none, half, proved]) == ["slope=5 aim=1", "slope=7 aim=1"]
    assert asked([none, fast]) == ["slope=5.6 aim=1"]  # none succeeds: gentler by far
    assert asked([slope(3, 3.5, 59, 59), proved]) == []
    assert asked([slope(5.0, 3.1, 59, 59), slope(5.25, 3.08, 10)]) == []  # so near that nothing is between


def test_a_search_tries_nothing_that_a_plan_beats_already() -> None:
    """A family whose plans are slower than one that proves it ends; a faster one that does not prove it gets a gentler plan."""
    proved, fast = slope(5, 3.1, 59, 59), slope(6, 3.0, 10)
    assert asked([proved, fast, slope(5, 3.3, 59, 59, aim=0.6), slope(6, 3.2, 5, aim=0.6)]) == [
        "slope=5.5 aim=1"
    ]
    assert asked([slope(5, 3.2, 59, 59), slope(5, 3.1, 15, aim=0.6)]) == ["slope=4.5 aim=0.6"]


def test_a_search_ends_at_the_fastest_slope_that_proves_it() -> None:
    """Of a world in which plans with a slope up to 5.3 always succeed, and success falls to nothing at 7."""

    def fly(value: float) -> Candidate:
        share = min(1.0, max(0.0, (7 - value) / 1.7))
        return slope(value, 5 - value / 5, round(20 * share) if share < 1 else 59, 20 if share < 1 else 59)

    found = [fly(8.0), fly(12.0)]
    for _ in range(9):
        found += [fly(float(one[1].partition("=")[2])) for one in finer(found, "slope", 0.95)]
    best = fastest(found, 0.95)
    assert best is not None and 5.3 / 1.06 < float(best.overrides[1].partition("=")[2]) <= 5.3
    assert len(front(found)) >= 6 and len(found) < 20


def test_the_best_is_flown_in_worlds_that_it_was_not_chosen_by() -> None:
    """Where it does not prove the target there, the search goes on: with plans between, and with the next best."""
    best, other, bold = slope(5, 3.1, 59, 59), slope(4, 3.2, 59, 59), slope(5.25, 3.05, 10)
    again = unseen([best, other, bold], 0.95)
    assert again == [("+scenario=circle", "slope=5", "aim=1", "seed=1")] == [elsewhere(best.overrides)]
    failed = flown(3.1, 110, 124, *again[0])
    found = paired([best, other, bold, failed])
    assert [one.again for one in found] == [failed, None, None]
    assert not proves(found[0], 0.95) and fastest(found, 0.95) == other
    assert asked(found) == ["slope=4.5 aim=1"] and unseen(found, 0.95) == [elsewhere(other.overrides)]
    assert found[0].rate == pytest.approx((59 + 110) / (59 + 124)) and found[0].whole.runs == 183
    good = paired([best, other, bold, flown(3.1, 59, 59, *again[0])])
    assert fastest(good, 0.95) == good[0] and unseen(good, 0.95) == [] == asked(good)
    assert elsewhere(("seed=3", "slope=5")) == ("slope=5", "seed=4")


def test_what_is_searched() -> None:
    """The slope and the aim, unless something else is given as a list."""
    usual = commands.run("robust", ["+scenario=circle", "flights=100"])
    assert isinstance(usual, commands.Sweep)
    assert {"-m", "+scenario/contact=approach", "flights=100", "target_success=0.95"} <= set(usual.arguments)
    assert sum("," in text for text in usual.arguments) == 2
    assert {"hydra/sweeper=front", "hydra.sweeper.target=0.95"} <= set(usual.arguments)
    asked = commands.run("robust", ["+scenario=circle", "target_success=0.9"])
    assert isinstance(asked, commands.Sweep) and "hydra.sweeper.target=0.9" in asked.arguments
    own = commands.run("robust", ["+scenario=circle", "scenario.authority=0,0.05"])
    assert isinstance(own, commands.Sweep)
    assert [text for text in own.arguments if "," in text] == ["scenario.authority=0,0.05"]
    assert not any("sweeper" in text for text in own.arguments)  # what is listed is all that is searched
    with pytest.raises(BadInput, match="scenario"):
        commands.run("robust", ["flights=3"])
    for scenario, says in (("race", "no ball"), ("circle,two_free", "2 targets")):
        with pytest.raises(BadInput, match=says) as told:
            commands.run("robust", [f"+scenario={scenario}"])
        assert told.value.field == "scenario"
    ranges = commands.run("robust", ["+scenario=circle", "mismatch.gust=[0.1,0.2]"])
    assert isinstance(ranges, commands.Sweep)  # a list that is one value is no search
    assert "hydra/sweeper=front" in ranges.arguments
    for wrong, field in (
        ("flights=5,0", "flights"), ("rig.motor_force=[3,5]", "rig.motor_force"), ("workers=0", "workers"),
        ("vehicle=race_quadrotor", "vehicle"), ("scenario.contacts.approach.slope=[5]", "scenario.contacts.approach.slope"),
    ):  # fmt: skip
        with pytest.raises(BenchBenchError) as told:
            commands.run("robust", ["+scenario=circle", wrong])
        assert getattr(told.value, "field", field) == field
    some = commands.run(
        "robust", ["+scenario=circle", "rig.pull=0.1,2.5"]
    )  # wrong in one run, right in the next
    assert isinstance(some, commands.Sweep)
    for wrong in ("2", "0", "nan", "often"):
        with pytest.raises(BadInput, match="target_success"):
            commands.run("robust", ["+scenario=circle", f"target_success={wrong}"])


def test_the_picture_of_a_front(tmp_path: Path) -> None:
    draw_front(
        tmp_path / "front.png", [flown(3.2, 59), flown(2.9, 2)], 0.95, "circle", lambda one: one.overrides[0]
    )
    assert (tmp_path / "front.png").stat().st_size > 10_000


@pytest.mark.slow
def test_a_search_flies_between_what_it_has_flown_and_goes_on_from_its_table(tmp_path: Path) -> None:
    """One flight each; one success in one flight proves 5 %, so 4 % are asked."""
    asked = ("robust", "+scenario=circle", "scenario.aim.position=1.0", "flights=1", "target_success=0.04", "hydra.sweeper.rounds=2")  # fmt: skip
    done = told(tmp_path, *asked)
    assert "round 2" in done.stdout, done.stdout + done.stderr
    assert "worlds that it was not chosen by" in done.stdout
    table = pd.read_csv(next((tmp_path / "results" / "robust").glob("*.csv")))
    slopes = table.overrides.str.extract(r"slope=(\S+)")[0].astype(float)
    good = dict(zip(slopes, table.succeeded == table.flights, strict=True))
    assert {5.0, 7.0, 12.0} < set(good)
    for low, high in ((5.0, 7.0), (7.0, 12.0)):
        assert ((low + high) / 2 in good) == (good[low] != good[high])
    best = table[table.chosen]
    assert len(best) == 1 and best.travel_time_s.item() == table[table.succeeded == 1].travel_time_s.min()
    assert best.elsewhere_flights.item() == 1
    again = told(tmp_path, *asked)
    assert "3 of 3 runs are in the table" in again.stdout and "certified  " not in again.stdout
