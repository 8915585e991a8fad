"""From the certificate back to the planner: grids of unequal steps, multipliers between them, and the loop that uses both."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace

import composing
import numpy as np
import pytest

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.check import Check
from benchbench.certificate.replay import defects
from benchbench.nlp.ledger import Ledger
from benchbench.planning import posing
from benchbench.planning.case import Case
from benchbench.planning.findings import next_step
from benchbench.planning.ladder import climb, coarse, on_grid, rung
from benchbench.planning.margins import NONE, with_margins
from benchbench.planning.mesh import halved, marked, steady
from benchbench.planning.result import Result
from benchbench.transcription.grid import Grid, Phase
from benchbench.transcription.prolongation import prolongation

TWO = Grid((Phase("approach", 3, 0.0, 9.0, 2.0), Phase("leave", 2, 0.0, 9.0, 1.0)))


@lru_cache
def case_of(*overrides: str) -> Case:
    return composing.case_of("+scenario=static", "solver=ipopt", "compile=never", *overrides)


@lru_cache
def on_forty() -> tuple[Case, Result]:
    """A flight on a grid that is too coarse for its certificate."""
    case = with_margins(case_of("scenario.intervals=40"), NONE)
    return case, climb(case, Ledger(60.0), posing.line(case))


# --- grids of unequal steps ---------------------------------------------------------------------------------------


def test_halved_intervals_fill_their_phases() -> None:
    chosen = np.array([True, False, False, False, True])
    mesh = halved(TWO, chosen)
    assert mesh["approach"] == pytest.approx((1 / 6, 1 / 6, 1 / 3, 1 / 3))
    assert mesh["leave"] == pytest.approx((1 / 2, 1 / 4, 1 / 4))
    finer = Grid(tuple(phase.on(mesh) for phase in TWO.phases))
    assert finer.intervals == 7 and finer.ends == (4, 7)
    np.testing.assert_allclose(finer.time_weights[list(finer.ends)], [[1, 0], [1, 1]])
    np.testing.assert_allclose(finer.step_weights.sum(axis=0), 1.0)
    assert {TWO.phases[0].on({}), TWO.phases[0].on({"leave": (1.0,)})} == {TWO.phases[0]}


def test_rows_of_a_finer_grid_come_from_where_they_lie() -> None:
    """Nodes from the nearest one, parts of intervals from their own; what is spent along the way stays the same in sum."""
    finer = Grid(
        tuple(phase.on(halved(TWO, np.array([True, False, False, False, True]))) for phase in TWO.phases)
    )
    rows = prolongation(TWO, finer)
    which, share = rows(5, 7)
    assert which.tolist() == [0, 0, 1, 2, 3, 4, 4] and share.tolist() == [0.5, 0.5, 1, 1, 1, 0.5, 0.5]
    np.testing.assert_allclose(np.bincount(which, share), 1.0)
    which, _ = rows(10, 14)
    assert which.tolist() == [0, 1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 8, 9]
    which, _ = rows(6, 8)
    assert which.tolist()[::7] == [0, 5] and which.tolist()[2:6] == [1, 2, 3, 4]
    assert rows(2, 3) is None and prolongation(TWO, Grid(TWO.phases[:1]))(5, 3) is None


def test_a_flight_on_unequal_steps_is_as_good_where_they_are_short() -> None:
    """Halving the worst intervals takes the largest defect down, to about the largest of those that were left as they are."""
    case, found = on_forty()
    missed = np.abs(defects(found.plan, case.model.plant()).velocity).max(axis=1)
    chosen = missed > 0.3 * missed.max()
    assert 0 < chosen.sum() < 30
    fine = replace(case, mesh=halved(found.problem.trajectory.grid, chosen))
    finer = rung(fine, Ledger(60.0), found.plan, found)
    assert finer.claimed and finer.plan.intervals == found.plan.intervals + chosen.sum()
    again = np.abs(defects(finer.plan, case.model.plant()).velocity).max(axis=1)
    assert again.max() < 0.5 * missed.max()
    assert finer.plan.travel_time == pytest.approx(found.plan.travel_time, rel=0.02)


# --- a contact lasts as long on every grid ------------------------------------------------------------------------


@pytest.mark.parametrize(("kappa", "nodes"), [(1, (1, 1, 1)), (2, (2, 2, 3)), (13, (4, 13, 25))])
def test_nodes_in_contact_follow_the_grid(kappa: int, nodes: tuple[int, ...]) -> None:
    """The same share of the flight; on a coarser grid at least as long, and two nodes where there is a contact at all."""
    scenario = case_of(f"scenario.kappa_init={kappa}").scenario
    stops = [scenario.on_grid(n).itinerary.stops[0] for n in (25, 100, 200)]
    assert tuple(stop.kappa_init for stop in stops) == nodes
    assert {stop.steps(77) for stop in stops} == {(kappa - 1, 100)}
    assert scenario.on_grid(25).on_grid(100).itinerary.stops[0].kappa_init == kappa


def test_the_certificate_asks_a_finer_grid_for_as_long_a_contact() -> None:
    """kappa_init = 3 of N = 20 is a tenth of the flight; three nodes of N = 40 are half of that."""
    _, found = on_forty()
    few = with_margins(case_of("scenario.intervals=20", "scenario.kappa_init=3"), NONE)
    assert found.plan.contacts[0][1] - found.plan.contacts[0][0] < 3
    told = [check for check in few.judge(found).broken if check.name == "contact_seconds"]
    assert told and told[0].limit == pytest.approx(found.plan.travel_time / 10)
    longer = rung(on_grid(few, 40), Ledger(60.0), posing.line(few))
    assert "contact_seconds" not in {check.name for check in few.judge(longer).broken}


# --- what comes next ----------------------------------------------------------------------------------------------


def verdict(*checks: tuple[str, float, float]) -> Certificate:
    broken = tuple(Check(name, value, limit, "", False, "so") for name, value, limit in checks)
    flight = SimpleNamespace(velocity=np.zeros((2, len(case_of().model.velocity.names))))
    return Certificate(broken, None, flight)  # type: ignore[arg-type]


def test_a_small_overshoot_takes_a_margin_and_an_error_of_the_grid_a_finer_one() -> None:
    case = case_of()
    contact = verdict(("contact_position", 0.021, 0.02))
    step = next_step(contact, case, NONE, 0.5, True)
    assert step is not None and not step.finer and 0.05 < step.margins["contact_margin"]["position"] < 0.06
    step = next_step(contact, case, NONE, 0.5, True, patient=False)
    assert step is not None and step.finer
    for found in (verdict(("defect_angle", 0.03, 0.02)), verdict(("contact_position", 0.04, 0.02))):
        step = next_step(found, case, NONE, 0.5, True)
        assert step is not None and step.finer and not step.margins["rate_margin"]
        assert next_step(found, case, NONE, 0.5, False) is None
    ahead = step.margins["contact_margin"]["position"]
    assert ahead == pytest.approx(0.1), "at most a tenth, though the coarse grid would ask for all of it"
    both = verdict(("contact_position", 0.021, 0.02), ("replay_end", 0.03, 0.02))
    step = next_step(both, case, NONE, 0.5, True)
    assert step is not None and step.finer


def test_intervals_are_marked_where_the_replay_found_errors() -> None:
    case, found = on_forty()
    certificate = case.judge(found)
    assert not certificate.certified
    chosen = marked(found.plan, certificate, case)
    missed = np.abs(defects(found.plan, case.model.plant()).velocity).max(axis=1)
    assert chosen.any() and chosen[int(np.argmax(missed))]
    assert steady(case) and not steady(composing.case_of("+scenario=race", "vehicle=race_ramp"))


# --- the loop -----------------------------------------------------------------------------------------------------


def test_auto_refines_until_it_is_certified_and_tells_how() -> None:
    case = case_of("scenario.intervals=40", "strategy=auto")
    ledger = Ledger(60.0)
    result = case.plan(ledger)
    assert case.judge(result).certified and result.plan.intervals > 40
    first, *_, last = result.account["refinement"]
    assert first.startswith("N = 40: ") and not first.endswith("certified") and last.endswith(", certified")
    assert ledger.judging_cpu > 0
    begin, end = (result.plan.time[k] for k in result.plan.contacts[0])
    assert end - begin == pytest.approx(result.plan.travel_time / 40, rel=1e-6)


def test_a_coarse_case_has_no_coarser_grid() -> None:
    assert coarse(case_of("scenario.intervals=12")).scenario.grid_intervals == 12
    assert coarse(case_of()).scenario.grid_intervals == 25
    assert coarse(composing.case_of("+scenario=race", "scenario.gates=2")).scenario.nodes_per_gate == 10
