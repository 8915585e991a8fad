"""Races by progress variables, their warm start, and the search over orders of the gates."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import permutations
from typing import cast

import composing
import numpy as np
import pytest

from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify
from benchbench.certificate.race_bound import order_bound
from benchbench.formulation.gates import passed_at
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.mpcc.residuals import residuals
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.relaxation import smooth
from benchbench.nlp.warm_start import carried
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.planning import posing
from benchbench.planning.case import Case
from benchbench.planning.ladder import from_phases
from benchbench.planning.search import Candidate, Found, best_first
from benchbench.planning.strategy import pose
from benchbench.run import config, pipeline

TWO = ("scenario.gates=2", "scenario.nodes_per_gate=20")
FINE = "relaxation.schedule=[1e-2,1e-4,1e-9]"


def case_of(*overrides: str) -> Case:
    return composing.case_of("+scenario=race", *overrides)


def race_of(case: Case) -> Race:
    return cast("Race", case.scenario)


@cache
def run(*overrides: str) -> pipeline.Run:
    return pipeline.run(case_of(*overrides))


def warm() -> pipeline.Run:
    return run(*TWO, "strategy=warm", FINE)


def kappa(done: pipeline.Run) -> Array:
    return done.result.solved.values["kappa"]


# What is posed


def test_progress_at_a_flight_through_the_gates_is_feasible_and_elsewhere_is_not() -> None:
    """Pairs, steps and order hold where kappa falls inside the gates; a node further they do not."""
    case = case_of(*TWO)
    problem = posing.free(case, posing.line(case))
    mpcc = problem.mpcc
    names = [v.name for v in mpcc.variables]

    def found(nodes: tuple[int, int]) -> tuple[float, float]:
        parts = mpcc.split(mpcc.guess)
        parts["kappa"] = passed_at(race_of(case).grid_intervals, nodes)
        judged = residuals(mpcc, np.concatenate([parts[n].ravel() for n in names]))
        return judged.pairs["ball"].natural, max(judged.constraints[k] for k in ("progress", "gate_order"))

    guessed = mpcc.split(mpcc.guess)["kappa"]
    right = tuple(int(k) for k in np.argmax(guessed[:-1] - guessed[1:], axis=0))
    assert found((right[0], right[1])) == (0.0, 0.0)
    assert found((right[0] + 3, right[1]))[0] == pytest.approx(1.0)  # far from the gate: G = 1, H > 1
    assert found((right[1], right[0]))[1] == pytest.approx(1.0)  # the second gate before the first


def test_free_order_drops_the_order_only() -> None:
    fixed, free = (case_of(*TWO, f"scenario.order={order}") for order in ("fixed", "free"))
    names = [{b.name for b in posing.free(c, posing.line(c)).mpcc.constraints} for c in (fixed, free)]
    assert names[0] - names[1] == {"gate_order"}


# What is found


@pytest.mark.parametrize("relaxation", ["scholtes", "fischer_burmeister", "elastic", "kanzow_schwartz"])
def test_relaxations_find_flights_that_pass_their_gates(relaxation: str) -> None:
    """How good they are is another matter: the timing of a gate hardly moves from where it is guessed."""
    done = run("scenario.gates=1", "scenario.nodes_per_gate=15", "strategy=relax", f"relaxation={relaxation}")
    assert done.record["claimed_success"], done.record["reasons"]
    assert done.record["gates_passed"] == 1
    assert done.record["gate_worst_miss_m"] < 1e-3
    assert done.record["travel_time_s"] > done.record["lower_bound_s"]


RELAXATIONS = [name for name in config.choices("relaxation") if name != "none"]


@pytest.mark.parametrize("relaxation", RELAXATIONS)
def test_every_relaxation_takes_the_gates_and_keeps_a_warm_start(relaxation: str) -> None:
    one = ("scenario.gates=1", "scenario.nodes_per_gate=15")
    done = run(*one, "strategy=warm", f"relaxation={relaxation}")
    assert done.certificate.certified, done.certificate.reasons
    assert done.record["relaxation"] == relaxation
    assert done.record["travel_time_s"] == pytest.approx(run(*one).record["travel_time_s"], rel=4e-3)


def test_the_warm_start_finds_what_phases_find() -> None:
    phases = run(*TWO)
    assert warm().certificate.certified, warm().certificate.reasons
    assert warm().record["travel_time_s"] == pytest.approx(phases.record["travel_time_s"], rel=2e-3)
    assert warm().record["gate_worst_miss_m"] < 1e-6


def test_all_progress_is_made_inside_the_gates_in_order() -> None:
    done = warm()
    case, plan = done.case, done.result.plan
    steps = -np.diff(kappa(done), axis=0)
    assert np.sum(steps, axis=0) == pytest.approx(1.0)
    for column, gate in zip(steps.T, race_of(case).goals[:-1], strict=True):
        beyond = np.linalg.norm(plan.configuration[:-1, :3] - np.array(gate.position), axis=1) - gate.radius
        assert np.max(beyond[column > 1e-3]) < 1e-6
    assert np.min(kappa(done)[:, 1] - kappa(done)[:, 0]) > -1e-6


def test_multipliers_are_carried_by_name() -> None:
    case = case_of("scenario.gates=1", "scenario.nodes_per_gate=8")
    held = from_phases(case, Ledger(60.0), posing.start(case, Ledger(60.0)))
    relaxed = smooth(posing.free(case, held.plan).mpcc, case.relaxation).mpcc
    start = carried(relaxed, held.solved.relaxed, held.solved.outcome.point)
    assert held.solved.relaxed is not None and start.lam_g is not None and start.lam_x is not None
    rows = held.problem.mpcc.constraints[0]  # the dynamics: in both, and at the same place
    assert relaxed.constraints[0].name == rows.name
    np.testing.assert_array_equal(
        start.lam_g[: rows.lower.size], held.solved.outcome.point.lam_g[: rows.lower.size]
    )
    assert not np.any(relaxed.split(start.lam_x)["kappa"])


# The certificate on plans that know no phases


def judge(plan: Plan) -> Certificate:
    case = warm().case
    return certify(plan, case.scenario, case.model, case.limits)


def broken(plan: Plan) -> set[str]:
    return {check.name for check in judge(plan).checks if not check.ok}


def test_the_replay_starts_again_at_the_nodes_that_touch_the_gates() -> None:
    """Of each gate one node with a step of kappa, or next to one, as the nearest one inside is taken."""
    flight = warm().certificate.flight
    assert flight is not None and len(flight.restarts) == 2
    for column, node in zip((-np.diff(kappa(warm()), axis=0)).T, flight.restarts, strict=True):
        assert np.min(np.abs(np.flatnonzero(column > 1e-3) - node)) <= 1


def test_spoiled_plans_are_refused() -> None:
    plan, (first, *_) = warm().result.plan, warm().certificate.flight.restarts  # type: ignore[union-attr]
    jumped = plan.configuration.copy()
    jumped[first + 1 :, 0] += 0.02
    beyond = plan.configuration.copy()
    way = plan.configuration[first, :3] - np.array(race_of(warm().case).goals[0].position)
    beyond[:, :3] += 0.05 * way / np.linalg.norm(way)
    assert broken(plan) == set()
    assert broken(replace(plan, configuration=jumped)) >= {"defect_position", "segment"}
    assert "gate" in broken(replace(plan, configuration=beyond))
    assert "segment" in broken(replace(plan, inputs=plan.inputs * 0.98))


# Orders


def ordered(sequence: tuple[int, ...], *overrides: str) -> float:
    case = case_of(*overrides)
    case = replace(case, scenario=race_of(case).flown_in(sequence))
    ledger = Ledger(60.0)
    return pose(posing.phases(case, posing.start(case, ledger)), case, ledger, "").plan.travel_time


def test_the_best_order_is_that_of_plain_enumeration_and_no_order_beats_its_bound() -> None:
    settings = ("scenario.gates=3", "scenario.nodes_per_gate=12")
    done = run(*settings, "scenario.order=free", "strategy=orders")
    case = done.case
    race, plant = race_of(case), case.model.plant()
    times = {order: ordered(order, *settings) for order in permutations((1, 2, 3))}
    assert done.record["gates_passed"] == 3
    assert done.record["travel_time_s"] == pytest.approx(min(times.values()), rel=1e-6)
    assert min(times.values()) < times[(1, 2, 3)] - 0.1
    assert "all were tried" in done.record["search"]
    for order, time in times.items():
        for length in range(4):
            assert order_bound(race, case.model, plant, order[:length]) < time
    assert done.record["lower_bound_s"] == order_bound(race, case.model, plant, ())


def test_branches_are_split_pruned_and_counted() -> None:
    """Digits 0..2 in two places, cost their sum: of 9 pairs only those that may win are solved."""

    def split(choice: tuple[int, ...]) -> list[Candidate[tuple[int, ...]]]:
        return [] if len(choice) == 2 else [Candidate((*choice, d), float(sum(choice) + d)) for d in range(3)]

    best, account = best_first(
        [Candidate[tuple[int, ...]]((), 0.0)], lambda c: Found(c, float(sum(c))), lambda: True, split
    )
    assert best.result == (0, 0)
    assert (account.solved, account.split, account.pruned) == (1, 2, 4)
    assert account.exhaustive


def test_any_order_is_certified_when_it_is_free() -> None:
    """A flight in the other order passes if the order is free, and else not."""
    coarse = ("scenario.gates=2", "scenario.nodes_per_gate=12", "scenario.sequence=[2,1]")
    plan = run(*coarse, "strategy=phases").result.plan
    free, fixed = case_of(*TWO, "scenario.order=free"), case_of(*TWO)
    missed = [
        {check.name for check in certify(plan, c.scenario, c.model, c.limits).checks if not check.ok}
        for c in (free, fixed)
    ]
    assert ["gate" in names for names in missed] == [False, True]


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (("scenario.sequence=[1,1]",), "scenario.sequence"),
        (("scenario.order=free", "scenario.gates=9"), "scenario.order"),
        (("scenario.order=free", "scenario.gates=7"), "one place"),
        (("strategy=orders",), "scenario.order=free"),
    ],
)
def test_orders_that_mean_nothing_are_refused(overrides: tuple[str, ...], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        run(*overrides)
