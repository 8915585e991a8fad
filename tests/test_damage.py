"""No damaged plan is certified, and no good one is refused: the catalogue of `damage.py` on a handover and on a race."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import composing
import numpy as np
import pytest
from damage import Damage, jump_at, of_claims, of_inputs, of_shape, of_states, of_time

from benchbench.certificate import sequential
from benchbench.certificate.certificate import Certificate
from benchbench.certificate.certify import certify
from benchbench.certificate.passing import gate_nodes
from benchbench.certificate.replay import FAR, TOLERANCE, fly
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case
from benchbench.run import pipeline

HANDOVER = ("+scenario=circle", "compile=never")
RACE = ("+scenario=race", "scenario.gates=2", "compile=never")
Planned = tuple[Case, Plan]


def planned(*overrides: str) -> Planned:
    case = composing.case_of(*overrides)
    plan = pipeline.run(case).result.plan
    assert plan is not None
    return case, plan


@pytest.fixture(scope="module")
def handover() -> Planned:
    return planned(*HANDOVER)


@pytest.fixture(scope="module")
def race() -> Planned:
    return planned(*RACE)


def judged(case: Case, plan: Plan) -> Certificate:
    return certify(plan, case.scenario, case.model, case.limits)


def catalogue(plan: Plan, claims: bool) -> Iterator[tuple[str, Damage]]:
    yield from of_states(plan)
    yield from of_inputs(plan)
    yield from of_time(plan)
    yield from of_shape(plan)
    if claims:
        yield from of_claims(plan)


def test_the_good_ones_are_certified(handover: Planned, race: Planned) -> None:
    for case, plan in (handover, race):
        assert judged(case, plan).certified, judged(case, plan).reasons


@pytest.mark.parametrize("which", ["handover", "race"])
def test_a_solved_plan_is_flown_at_once_as_in_turn(which: str, request: pytest.FixtureRequest) -> None:
    case, plan = request.getfixturevalue(which)
    gates = gate_nodes(plan, case.scenario, case.limits) if which == "race" else ()
    missed, flight = fly(plan, case.model.plant(), restart_nodes=gates)
    in_turn = sequential.flight(plan, case.model.plant(), np.arange(1, 11) / 10, gates, TOLERANCE, FAR)
    found = np.hstack([flight.configuration, flight.velocity])[1:]
    np.testing.assert_allclose(found, in_turn.reshape(found.shape), rtol=0, atol=1e-8)
    ends = sequential.ends(plan, case.model.plant(), TOLERANCE, FAR)
    planned = np.hstack([plan.configuration, plan.velocity])
    np.testing.assert_allclose(
        np.hstack([missed.configuration, missed.velocity]), ends - planned[1:], rtol=0, atol=1e-8
    )


def test_no_damaged_handover_is_certified(handover: Planned) -> None:
    case, plan = handover
    bad = dict(catalogue(plan, claims=True))
    assert len(bad) >= 100
    assert not [name for name, damage in bad.items() if judged(case, damage(plan)).certified]


def test_no_damaged_race_is_certified(race: Planned) -> None:
    case, plan = race
    bad = dict(catalogue(plan, claims=False))
    assert len(bad) >= 90
    assert not [name for name, damage in bad.items() if judged(case, damage(plan)).certified]


@pytest.mark.parametrize("which", ["handover", "race"])
def test_a_jump_of_velocity_is_refused_wherever_it_is(which: str, request: pytest.FixtureRequest) -> None:
    """At a gate, where the replay starts again, as anywhere: a restart forgives drift, never a jump."""
    case, plan = request.getfixturevalue(which)
    gates = np.flatnonzero(plan.progress > 0.5)
    for node in {int(gates[0]), int(gates[0]) + 1, plan.intervals // 3, 2 * plan.intervals // 3}:
        found = judged(case, jump_at(plan, node))
        assert not found.certified
        said = [reason for reason in found.reasons if "jump of the planned" in reason]
        assert said and f"interval {node - 1} " in said[0], (node, found.reasons)


def test_every_restart_sees_the_jump(handover: Planned) -> None:
    case, plan = handover
    case = replace(
        case, limits=case.limits.model_copy(update={"restart_seconds": 0.5, "restart_beyond": 0.0})
    )
    assert not [reason for reason in judged(case, plan).reasons if "jump" in reason]
    for node in np.unique([int(np.argmin(np.abs(plan.time - t))) for t in (0.5, 1.0, 2.0)]):
        reasons = judged(case, jump_at(plan, int(node))).reasons
        assert [reason for reason in reasons if "jump of the planned" in reason]
