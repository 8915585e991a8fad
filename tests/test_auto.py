"""From the certificate back to the planner: grids of unequal steps, multipliers between them, and the loop that uses both."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from types import SimpleNamespace

import composing
import numpy as np
import pytest

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.check import Check
from benchbench.certificate.replay import defects
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Mpcc, evaluate, evaluated
from benchbench.nlp.ledger import Ledger
from benchbench.planning import posing
from benchbench.planning.case import Case
from benchbench.planning.disturb import disturbed
from benchbench.planning.findings import RAISED, Round, Step, next_step
from benchbench.planning.ladder import NEARER, climb, coarse, on_grid, rung
from benchbench.planning.margins import NONE, with_margins
from benchbench.planning.mesh import apart, exceeded, halved, marked, steady
from benchbench.planning.onward import started, without_error
from benchbench.planning.prices import of_paths
from benchbench.planning.proximal import PRICE, kept_near, price_of
from benchbench.planning.result import Result
from benchbench.transcription.correction import correctable
from benchbench.transcription.grid import Grid, Phase, Trajectory
from benchbench.transcription.prolongation import prolongation
from benchbench.transcription.runge_kutta import INCREMENTS, StageTrajectory

TWO = Grid((Phase("approach", 3, 0.0, 9.0, 2.0), Phase("leave", 2, 0.0, 9.0, 1.0)))


@lru_cache
def case_of(*overrides: str) -> Case:
    return composing.case_of("+scenario=static", "solver=ipopt", "compile=never", *overrides)


@lru_cache
def on_forty(dynamics: str = "verlet") -> tuple[Case, Result]:
    """A flight on a grid that is too coarse for its certificate."""
    case = with_margins(case_of("scenario.intervals=40", f"dynamics={dynamics}"), NONE)
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
    case, now = case_of(), Round(NONE)
    contact = verdict(("contact_position", 0.021, 0.02))
    step = next_step(contact, case, now)
    assert step is not None and not step.finer and 0.05 < step.margins["contact_margin"]["position"] < 0.06
    step = next_step(contact, case, replace(now, raised=RAISED))
    assert step is not None and step.finer
    for found in (verdict(("defect_angle", 0.03, 0.02)), verdict(("contact_position", 0.04, 0.02))):
        step = next_step(found, case, now)
        assert step is not None and step.finer and not step.correct and not step.margins["rate_margin"]
        assert next_step(found, case, replace(now, may_refine=False)) is None
    ahead = step.margins["contact_margin"]["position"]
    assert ahead == pytest.approx(0.1), "at most a tenth, though the coarse grid would ask for all of it"
    both = verdict(("contact_position", 0.021, 0.02), ("replay_end", 0.03, 0.02))
    step = next_step(both, case, now)
    assert step is not None and step.finer


def test_an_error_of_the_transcription_is_taken_off_before_anything_is_cut() -> None:
    case, now = case_of(), Round(NONE, correctable=True)
    step = next_step(verdict(("defect_angle", 0.03, 0.02), ("contact_position", 0.021, 0.02)), case, now)
    assert step is not None and step.correct and not step.rates and not step.contacts
    assert 0.05 < step.margins["contact_margin"]["position"] < 0.06, (
        "margins that are cheap are taken with it"
    )
    step = next_step(verdict(("replay_angle", 0.03, 0.02)), case, now)
    assert step is not None and step.correct and step.rates, "the room is exceeded between nodes"
    far = verdict(("contact_position", 0.035, 0.02), ("defect_angle", 0.03, 0.02))
    assert [next_step(far, case, replace(now, corrected=c)).contacts for c in (False, True)] == [False, True]  # type: ignore[union-attr]
    last = replace(now, may_refine=False, corrected=True)
    assert next_step(verdict(("defect_angle", 0.03, 0.02)), case, last) is None
    step = next_step(verdict(("contact_position", 0.021, 0.02)), case, replace(now, corrected=True))
    assert step is not None and step.correct and not step.finer, "what was corrected stays so with margins"


def test_without_measured_margins_those_of_the_scenario_stay() -> None:
    """Where none may be measured: whatever is exceeded, the next plan is made with the same margins."""
    own = {"rate_margin": {"arm": 0.01}, "contact_margin": {"position": 0.03}}
    found = verdict(("defect_angle", 0.03, 0.02), ("contact_position", 0.025, 0.02))
    for corrected in (False, True):
        step = next_step(found, case_of(), Round(own, own, 0.0, correctable=True, corrected=corrected))
        assert step is not None and step.margins == own


def test_margins_are_cheap_by_what_is_measured_beyond_those_by_hand() -> None:
    """The same overshoot asks for the same margin on top, whatever was given by hand; a finer grid starts with what was given."""
    own = {"rate_margin": {"arm": 0.1}, "contact_margin": {"position": 0.3}}
    for able in (False, True):
        bare, kept = Round(NONE, correctable=able), Round(own, own, correctable=able)
        passed = verdict(("contact_position", 0.021, 0.02))
        one, two = (next_step(passed, case_of(), now) for now in (bare, kept))
        assert one is not None and two is not None and not (one.finer or two.finer)
        added = one.margins["contact_margin"]["position"]
        assert two.margins["contact_margin"]["position"] == pytest.approx(0.3 + added)
        assert two.margins["rate_margin"] == own["rate_margin"]
    far = next_step(verdict(("contact_position", 0.04, 0.02)), case_of(), Round(own, own))
    assert far is not None and far.finer and far.margins == own


def test_a_margin_of_a_rate_is_taken_where_it_costs_nothing() -> None:
    """An arm 10 % too fast: a margin where its multipliers are nothing, cut intervals where they are not."""
    case = case_of("strategy.correction=true")
    found = verdict(("replay_rate", 1.15, 1.05))
    fast = np.array(case.model.velocity.upper) * 1.15
    found = replace(found, flight=SimpleNamespace(velocity=np.where(np.isfinite(fast), fast, 0.0)[None]))  # type: ignore[arg-type]
    names = case.model.velocity.names
    for price, cut in ((0.0, False), (1e-2, True)):
        step = next_step(found, case, Round(NONE, correctable=True, prices=dict.fromkeys(names, price)))
        assert step is not None and step.rates == cut and bool(step.margins["rate_margin"]) != cut


def test_a_margin_along_the_path_is_taken_where_it_costs_nothing() -> None:
    """The tip is 0.2 mm too deep for a floor of 10 mm: a margin where its multipliers are nothing, cut intervals where they are not."""
    case, found = case_of("+scenario/contact=floor"), verdict(("replay_path_floor", 0.0102, 0.01))
    for price, cut in ((0.0, False), (1.0, True)):
        for able in (False, True):
            step = next_step(found, case, Round(NONE, correctable=able, paths={"floor": price}))
            assert step is not None and (step.rates or step.finer) == cut
            assert (step.margins["contact_margin"].get("floor", 0.0) > 0.02) != cut


def test_the_price_of_a_margin_along_the_path_is_what_it_costs() -> None:
    """The floor of the authors' demo on a climb: its multipliers tell what a tighter one costs, to first order."""
    case = with_margins(
        case_of("+scenario/contact=floor", "scenario.intervals=40", "scenario.end.z=1.2"), NONE
    )
    found = climb(case, Ledger(60.0), posing.line(case))
    price = of_paths(found, case.scenario)["floor"]
    tight = with_margins(case, {**NONE, "contact_margin": {"floor": 0.1}})
    dearer = rung(tight, Ledger(60.0), found.plan, found).objective / found.objective - 1
    assert dearer > 1e-7 and 0.5 * dearer < 0.1 * price / 2 < 2 * dearer


def test_what_adds_up_is_not_passed_between_nodes() -> None:
    """The whole flight is beyond a limit, no interval of it is: nothing is cut for that."""
    case, found = on_forty()
    certificate = case.judge(found)
    alone = apart(found.plan, certificate, case)
    assert alone.flight is not None and alone.flight.restarts == tuple(range(1, found.plan.intervals))
    assert np.allclose(alone.flight.velocity[alone.flight.nodes[0]], found.plan.velocity[0])
    drifted = verdict(("replay_rate", 1.15, 1.05))
    step = next_step(drifted, case, Round(NONE, correctable=True), verdict())
    assert step is not None and step.correct and not step.rates


def test_a_price_on_leaving_a_plan_is_none_where_it_is_kept() -> None:
    case, found = on_forty()
    problem = replace(found.problem, mpcc=found.problem.mpcc.start_from(found.solved.values))
    near = kept_near(problem, case.model.velocity)
    (added,) = near.mpcc.costs[len(problem.mpcc.costs) :]
    assert np.sum(evaluate(added, near.mpcc, near.mpcc.guess)) == pytest.approx(0.0, abs=1e-12)
    values = near.mpcc.split(near.mpcc.guess)
    limit = np.array(case.model.velocity.upper)
    values["v"] = values["v"] + np.where(np.isfinite(limit), limit, 0.0)
    other = np.concatenate([values[one.name].ravel() for one in near.mpcc.variables])
    share = PRICE * found.plan.travel_time * np.isfinite(limit).sum()
    assert np.sum(evaluate(added, near.mpcc, other)) == pytest.approx(share, rel=0.05)


def test_what_had_to_be_kept_nearer_is_so_at_once_the_next_time() -> None:
    """Each plan is tried at the price that the last one took, so that a flight that needs the higher one fails at the lower one once."""
    case, found = on_forty()
    velocity = case.model.velocity
    assert price_of(found.problem, velocity) == 0.0
    for price in (PRICE, NEARER * PRICE):
        near = replace(
            found, posed=replace(found.solution, problem=kept_near(found.problem, velocity, price))
        )
        assert price_of(near.problem, velocity) == pytest.approx(price)
        ledger = Ledger(60.0)
        after = rung(case, ledger, found.plan, near, correct=True)
        assert after.claimed and price_of(after.problem, velocity) == pytest.approx(price)
        assert len(ledger.solves) == 1


def test_cut_are_intervals_in_contact_and_those_that_a_correction_does_not_reach() -> None:
    case, found = on_forty()
    certificate = case.judge(found)
    first, last = found.plan.contacts[0]
    near = exceeded(found, certificate, case, Step(NONE, contacts=True), False)
    assert np.flatnonzero(near).tolist() == list(range(first, last))
    missed = np.abs(defects(found.plan, case.model.plant()).velocity[:, -1]) > case.limits.defect_rate
    assert missed.any() and exceeded(found, certificate, case, Step(NONE), True)[missed].all()
    assert not exceeded(found, certificate, case, Step(NONE), False).any()


def test_intervals_are_marked_where_the_replay_found_errors() -> None:
    case, found = on_forty()
    certificate = case.judge(found)
    assert not certificate.certified
    chosen = marked(found.plan, certificate, case)
    missed = np.abs(defects(found.plan, case.model.plant()).velocity).max(axis=1)
    assert chosen.any() and chosen[int(np.argmax(missed))]
    assert steady(case) and not steady(composing.case_of("+scenario=race", "vehicle=race_ramp"))


def test_a_replay_that_breaks_down_is_no_share_of_a_limit() -> None:
    """Its check has no finite limit; what is marked then is what the errors of the intervals say."""
    case, found = on_forty()
    broken = Check("replay_complete", 20.0, np.inf, "s", False, "it breaks down")
    alone, certificate = (replace(case.judge(found), checks=checks) for checks in ((), (broken,)))
    assert np.array_equal(marked(found.plan, certificate, case), marked(found.plan, alone, case))


# --- deferred correction ------------------------------------------------------------------------------------------

ORDERS = [
    ("dynamics=verlet",), ("dynamics=verlet", "dynamics.inputs=nodal"), ("dynamics=midpoint",),
    ("dynamics=lie_verlet", "vehicle=table1_quaternion"), ("dynamics=trapezoidal",),
    ("dynamics=trapezoidal", "dynamics.inputs=linear", "vehicle=table1_quaternion"),
]  # fmt: skip


@pytest.mark.parametrize("overrides", ORDERS, ids=" ".join)
def test_corrected_equations_hold_where_the_flown_interval_ends(overrides: tuple[str, ...]) -> None:
    """Whatever the plan: each equation, read with the flown end of its interval, leaves what stands on its right-hand side."""
    holds_where_it_is_flown(case_of("scenario.intervals=16", *overrides))


def test_corrected_steps_of_a_race_hold_where_they_are_flown() -> None:
    holds_where_it_is_flown(
        composing.case_of(
            "+scenario=race", "scenario.gates=2", "scenario.nodes_per_gate=5", "dynamics=rk4", "compile=never"
        )
    )


def holds_where_it_is_flown(case: Case) -> None:
    problem = posing.phases(case, disturbed(posing.line(case), case, 3))
    plant, mpcc = case.model.plant(), without_error(problem, case.model.plant()).mpcc
    values = problem.mpcc.split(problem.mpcc.guess)
    plan = problem.decode(values)
    moved = [name for name, b, c in shifts(problem.mpcc, mpcc) if np.any(b != c)]
    assert moved == list(problem.trajectory.equations)  # type: ignore[attr-defined]
    ends = defects(plan, plant)
    for k in range(plan.intervals):  # one interval at a time, with its own end in place of the next node
        one = {name: rows.copy() for name, rows in values.items()}
        one["q"][k + 1] += ends.configuration[k]
        one["v"][k + 1] += ends.velocity[k]
        one |= increments(problem.trajectory, one)
        x = np.concatenate([one[v.name].ravel() for v in mpcc.variables])
        for block in (b for b in mpcc.constraints if b.name in moved):
            np.testing.assert_allclose(evaluate(block, mpcc, x)[k], block.upper[k], atol=1e-9)


def increments(trajectory: Trajectory, values: dict[str, Array]) -> dict[str, Array]:
    """Where stages are nodes: the increments that the Euler-Lagrange equations have there."""
    if not isinstance(trajectory, StageTrajectory):
        return {}
    read = lambda block: [values[slot.variable].ravel()[slot.index] for slot in block.slots]  # noqa: E731
    found = trajectory.increments(read)
    for i, block in enumerate(trajectory.motion):
        left = evaluated(
            block, np.hstack([*read(block)[:2], found[i :: len(trajectory.motion)], *read(block)[3:]])
        )
        np.testing.assert_allclose(left, 0.0, atol=1e-10)
    return {INCREMENTS: found}


def shifts(mpcc: Mpcc, other: Mpcc) -> Iterator[tuple[str, Array, Array]]:
    for one, two in zip(mpcc.constraints, other.constraints, strict=True):
        assert one.function is two.function and np.array_equal(two.upper - two.lower, one.upper - one.lower)
        yield one.name, one.upper, two.upper


@pytest.mark.parametrize("dynamics", ["verlet", "trapezoidal"])
def test_repeated_corrections_take_the_error_away(dynamics: str) -> None:
    """On the same grid, each by more than half; margins and nodes stay as they are."""
    case, found = on_forty(dynamics)
    plant = case.model.plant()
    errors = [np.abs(defects(found.plan, plant).velocity).max()]
    for _ in range(3):
        found = rung(case, Ledger(60.0), found.plan, found, True)
        assert found.claimed and found.plan.intervals == 40
        errors.append(np.abs(defects(found.plan, plant).velocity).max())
    assert all(b < a / 2 for a, b in pairwise(errors)) and errors[-1] < errors[0] / 50


def test_a_transcription_with_stages_is_not_corrected() -> None:
    case = case_of("scenario.intervals=16", "dynamics=collocation")
    problem = posing.phases(case, posing.line(case))
    assert not correctable(problem.trajectory) and without_error(problem, case.model.plant()) is problem


def test_a_finer_problem_starts_where_the_solved_one_ended() -> None:
    """Durations and states at its nodes, and between them what is flown."""
    case, found = on_forty()
    fine = replace(case, mesh=halved(found.problem.trajectory.grid, np.ones(40, bool)))
    problem = started(posing.phases(fine, found.plan), found, case.model.plant())
    plan = problem.decode(problem.mpcc.split(problem.mpcc.guess))
    np.testing.assert_allclose(plan.time[::2], found.plan.time, atol=1e-12)
    np.testing.assert_allclose(plan.configuration[::2], found.plan.configuration, atol=1e-9)
    limits = case.scenario.planned_rates(case.model)
    within = np.all(
        (plan.velocity > limits.lower) & (plan.velocity < limits.upper), axis=1
    )  # guesses are clipped
    missed = defects(plan, case.model.plant()).velocity[::2][within[1::2]]
    assert len(missed) > 10 and np.abs(missed).max() < 1e-6, "from a node to the middle it flies"


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
