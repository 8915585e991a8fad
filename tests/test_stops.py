"""Several stops: sequences, the loop over them, bounds, what the certificate accepts, complementarity, bad input."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from pathlib import Path
from typing import Any

import composing
import numpy as np
import pytest
from flights import REST, SHIFT, along_tool, crossing, table_one
from test_certificate import LIMITS, assert_mentions

from benchbench.certificate.certify import certify
from benchbench.certificate.speed_bound import arm_reach, sequence_bound
from benchbench.conformance.checks.initial_value import one_phase, transcribe
from benchbench.formulation.coupling import Coupling
from benchbench.formulation.handover import free_contact
from benchbench.formulation.open_order import MADE, by_progress
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.mpcc.residuals import residuals
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.handover import Handover
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan
from benchbench.ocp.stop import Itinerary, Stop
from benchbench.planning import posing
from benchbench.planning.case import Case
from benchbench.planning.search import Candidate, Found, best_first
from benchbench.planning.strategy import pose
from benchbench.planning.validate import validate
from benchbench.report.scene import scene
from benchbench.run import config, pipeline
from benchbench.storage.playback import read_mcap
from benchbench.storage.recording import write_mcap
from benchbench_plugins.contacts.position import Position
from benchbench_plugins.contacts.velocity import Velocity
from benchbench_plugins.dynamics.verlet import Verlet
from benchbench_plugins.motions import Fixed, Linear

MODEL = table_one()
FIRST, SECOND = (5, 6), (13, 14)


def stop(name: str, reward: float | None = None) -> Stop:
    return Stop(name, Fixed((1.0, 0.0, 0.4)), {"position": Position()}, 2, None, reward, f"{name}_")


@pytest.mark.parametrize("order", ["fixed", "free"])
@pytest.mark.parametrize("visit", ["all", "one", "optional"])
def test_sequences_are_those_that_obey_the_rules(order: Any, visit: Any) -> None:
    stops = (stop("a", 1.0), stop("b"), stop("c", 2.0))
    if visit != "optional":
        stops = tuple(replace(s, reward=None) for s in stops)
    found = [tuple(s.name for s in made) for made in Itinerary(stops, order, visit).sequences()]

    def right(names: tuple[str, ...]) -> bool:
        if visit == "one":
            return len(names) == 1
        enough = "b" in names if visit == "optional" else len(names) == 3
        return enough and (order == "free" or names == tuple(sorted(names)))

    everything = [names for count in range(4) for names in permutations("abc", count)]
    assert sorted(found) == sorted(names for names in everything if right(names))
    assert found[0] == (("a",) if visit == "one" else ("a", "b", "c"))


@pytest.mark.parametrize("seed", range(20))
def test_the_loop_finds_what_brute_force_finds(seed: int) -> None:
    draw = np.random.default_rng(seed)
    costs = draw.uniform(1, 2, 9)
    costs[draw.random(9) < 0.2] = np.inf
    bounds = np.where(np.isfinite(costs), costs, 1.5) - draw.uniform(0, 0.6, 9)
    tried: list[int] = []

    def solve(i: int) -> Found[int]:
        tried.append(i)
        return Found(i, float(costs[i]))

    best, account = best_first([Candidate(i, float(b)) for i, b in enumerate(bounds)], solve, lambda: True)
    assert best.cost == costs.min()
    assert account.solved + account.failed + account.pruned == 9 and account.left == 0
    assert account.exhaustive == (account.failed == 0)
    assert all(bounds[i] >= costs.min() for i in set(range(9)) - set(tried))


def test_the_loop_says_what_it_left() -> None:
    best, account = best_first(
        [Candidate(i, 0.0) for i in range(4)], lambda i: Found(i, 1.0 + i), lambda: False
    )
    assert (best.result, account.solved, account.left) == (0, 1, 3)
    assert (
        account.told("sequences") == "4 sequences: 1 solved, 3 not tried; the others may hold a better plan"
    )


def test_the_bound_of_a_sequence_is_that_of_all_times_of_contact() -> None:
    """Every pair of contact times on a lattice, axis by axis, in the model of the bound."""
    fields: dict[str, Any] = {"name": "far", "start": {}, "end": {"x": 9.0}, "travel_time": (0.1, 20.0)}
    one = {"target": Linear((6.0, 1.0, 0.3), (-0.4, 0.1, 0.0))}
    other = {"target": Linear((-4.0, 2.0, 0.3), (0.3, 0.0, 0.0))}
    task = Handover(
        **fields, contacts={"position": Position()}, stops={"one": one, "other": other}, order="free"
    )
    plant, speed = MODEL.plant(), MODEL.velocity.upper[:3]
    time, close = np.arange(0.0, 20.0, 0.05), arm_reach(MODEL, plant) + 0.02
    for made in task.itinerary.sequences():
        (p, _), (q, _) = (sample(s.target, time) for s in made)
        reached = np.all(np.abs(p) <= close + speed * time[:, None], axis=1)
        apart = np.abs(q[None] - p[:, None]) - 2 * close
        later = np.all(apart <= speed * (time[None, :, None] - time[:, None, None]), axis=2)
        both = np.any(reached[:, None] & later & (time[None] >= time[:, None]), axis=0)
        rest = np.max((np.abs(q - np.array([9.0, 0, 0])) - close) / speed, axis=1)
        brute = np.min(np.where(both, time + rest, np.inf))
        assert brute - 0.25 <= sequence_bound(task, made, MODEL, plant) <= brute


_FLIGHT: list[Plan] = []


@pytest.fixture
def flight() -> Plan:
    if not _FLIGHT:
        _FLIGHT.append(crossing(MODEL))
    return _FLIGHT[0]


def claimed(plan: Plan, **nodes: tuple[int, ...]) -> Plan:
    progress = np.zeros((len(plan.time), len(nodes)))
    for i, which in enumerate(nodes.values()):
        progress[list(which), i] = 1.0
    return replace(plan, progress=progress, stop_names=tuple(nodes))


def task(plan: Plan, names: str = "ab", **changes: Any) -> Handover:
    """Two targets that move with the end effector around two moments of the flight."""
    coordinates = MODEL.configuration.names
    targets = {"a": along_tool(plan, MODEL.plant(), *FIRST), "b": along_tool(plan, MODEL.plant(), *SECOND)}
    rewards = changes.pop("rewards", {})
    fields: dict[str, Any] = {
        "name": "synthetic",
        "start": dict(zip(coordinates, plan.configuration[0], strict=True)),
        "end": dict(zip(coordinates, REST + SHIFT, strict=True)),
        "contacts": {"position": Position(), "velocity": Velocity()},
        "stops": {name: {"target": targets[name], "reward": rewards.get(name)} for name in names},
    }
    return Handover(**(fields | changes))


def test_two_stops_in_order_are_certified(flight: Plan) -> None:
    certificate = certify(claimed(flight, a=FIRST, b=SECOND), task(flight), MODEL, LIMITS)
    assert certificate.reasons == ()
    record = certificate.record()
    assert [text.split()[0] for text in record["stops"]] == ["a", "b"]
    assert record["contact_start_s"] == pytest.approx(0.4) and record["contact_end_s"] == pytest.approx(1.12)


def test_the_wrong_order_is_rejected_unless_it_is_free(flight: Plan) -> None:
    plan = claimed(flight, a=FIRST, b=SECOND)
    certificate = certify(plan, task(flight, "ba"), MODEL, LIMITS)
    assert_mentions(certificate, "'a' is made from t=0.400 s on, before 'b' is over", "the order is fixed")
    assert len(certificate.reasons) == 1
    assert certify(plan, task(flight, "ba", order="free"), MODEL, LIMITS).certified


def test_a_stop_left_out_is_missed_unless_it_is_optional(flight: Plan) -> None:
    plan = claimed(flight, a=FIRST, b=())
    assert_mentions(certify(plan, task(flight), MODEL, LIMITS), "contact of 'b'", "only 0 nodes")
    unknown = claimed(flight, a=FIRST)
    assert_mentions(certify(unknown, task(flight), MODEL, LIMITS), "contact of 'b'", "only 0 nodes")
    may = task(flight, visit="optional", rewards={"a": 0.5, "b": 0.3})
    certificate = certify(plan, may, MODEL, LIMITS)
    assert certificate.certified and certificate.measures.reward_s == 0.5
    must = task(flight, visit="optional", rewards={"a": 0.5})
    assert_mentions(certify(plan, must, MODEL, LIMITS), "contact of 'b'", "only 0 nodes")


def test_an_optional_stop_that_is_claimed_must_be_made(flight: Plan) -> None:
    may = task(flight, visit="optional", rewards={"a": 0.5, "b": 0.3})
    certificate = certify(claimed(flight, a=FIRST, b=(17, 18)), may, MODEL, LIMITS)
    assert_mentions(certificate, "claims contact of 'b'", "distance")
    assert certificate.measures.reward_s == 0.5
    half = certify(claimed(flight, a=FIRST, b=SECOND[:1]), may, MODEL, LIMITS)
    assert_mentions(half, "contact of 'b'", "only 1 nodes, required 2 nodes")


def test_one_of_several_is_exactly_one(flight: Plan) -> None:
    one = task(flight, visit="one")
    assert certify(claimed(flight, a=(), b=SECOND), one, MODEL, LIMITS).certified
    both = certify(claimed(flight, a=FIRST, b=SECOND), one, MODEL, LIMITS)
    assert_mentions(both, "exactly one stop is asked for, but the plan claims a, b")
    none = certify(claimed(flight, a=(), b=()), one, MODEL, LIMITS)
    assert_mentions(none, "exactly one stop is asked for, but the plan claims none")


def test_a_recording_and_a_picture_know_all_stops(flight: Plan, tmp_path: Path) -> None:
    plan, both = claimed(flight, a=FIRST, b=SECOND), task(flight)
    write_mcap(tmp_path / "plan.mcap", plan, None, both, MODEL, {})
    found = read_mcap(tmp_path / "plan.mcap").plan
    assert found.stop_names == ("a", "b")
    np.testing.assert_array_equal(found.progress_by_stop, plan.progress_by_stop)
    drawn = scene(plan, both, MODEL, None)
    assert list(drawn.targets) == ["a", "b"] and drawn.contact_nodes == [*FIRST, *SECOND]
    ends = [k for window in (FIRST, SECOND) for k in (window[0], window[-1])]
    assert {*ends} <= {*drawn.contact_poses} <= {*FIRST, *SECOND} and len(drawn.contact_poses) <= 6


N = 6


def tied(itinerary: Itinerary, kappas: list[list[float]], y: list[float] | None = None) -> float:
    """Worst residual of what ties the stops together, at whole numbers; contact conditions left out."""
    flown = transcribe(Verlet(), MODEL, one_phase(N, 1.0))
    couplings = [Coupling({}, MODEL, s.target, flown.trajectory, {}, s.prefix) for s in itinerary.stops]
    mpcc = by_progress(itinerary, couplings)
    values: dict[str, Array] = {
        f"{s.prefix}kappa": np.array(k) for s, k in zip(itinerary.stops, kappas, strict=True)
    }
    if y is not None:
        values[MADE] = np.array(y)
    x = np.concatenate([values[v.name].ravel() for v in mpcc.variables])
    found = residuals(mpcc, x)
    return max(found.max_violation, found.max_complementarity)


EARLY, LATE, NEVER = [2.0, 1, 0, 0, 0, 0, 0], [2.0, 2, 2, 1, 0, 0, 0], [0.0] * 7
TWO = (stop("a"), stop("b"))


def test_complementarity_says_order_number_and_choice() -> None:
    fixed, free = Itinerary(TWO), Itinerary(TWO, "free")
    assert tied(fixed, [EARLY, LATE]) == 0
    assert tied(fixed, [LATE, EARLY]) >= 1 and tied(fixed, [EARLY, EARLY]) >= 1
    assert tied(free, [LATE, EARLY]) == 0 and tied(free, [EARLY, LATE]) == 0
    assert tied(free, [EARLY, EARLY]) >= 1
    one = Itinerary(TWO, visit="one")
    assert tied(one, [EARLY, NEVER], [1, 0]) == 0 and tied(one, [NEVER, EARLY], [0, 1]) == 0
    assert tied(one, [EARLY, LATE], [1, 1]) >= 1 and tied(one, [EARLY, NEVER], [0.5, 0.5]) >= 0.5
    assert tied(one, [EARLY, LATE], [1, 0]) >= 1
    may = Itinerary((stop("a", 0.3), stop("b")), visit="optional")
    assert tied(may, [NEVER, EARLY], [0, 1]) == 0 and tied(may, [EARLY, LATE], [1, 1]) == 0
    assert tied(may, [NEVER, EARLY], [0.5, 1]) >= 0.5 and tied(may, [EARLY, NEVER], [1, 0]) >= 1


def test_order_reaches_over_a_stop_that_is_left_out() -> None:
    stops = (stop("a"), stop("b", 0.3), stop("c"))
    may = Itinerary(stops, visit="optional")
    assert tied(may, [EARLY, NEVER, LATE], [1, 0, 1]) == 0
    assert tied(may, [LATE, NEVER, EARLY], [1, 0, 1]) >= 1


def compose(*overrides: str) -> Case:
    return composing.case_of(*overrides, "compile=never")


def test_a_named_stop_is_the_same_problem_as_a_target() -> None:
    plain = compose("+scenario=linear", "scenario.intervals=16", "strategy=phases", "strategy.margin=0")
    fields = dict(plain.scenario)
    named = Handover(**(fields | {"target": None, "stops": {"cart": {"target": fields["target"]}}}))
    results = [c.strategy.solve(c, Ledger(60.0)) for c in (plain, replace(plain, scenario=named))]
    times, steps = zip(*((r.plan.travel_time, r.solved.outcome.iterations) for r in results), strict=True)
    assert times[0] == pytest.approx(times[1], rel=1e-9) and steps[0] == steps[1]
    assert results[1].plan.stop_names == ("cart",)


@pytest.mark.parametrize("scenario", ["two_free", "first_robot"])
def test_sequences_equals_brute_force(scenario: str) -> None:
    case = compose(
        f"+scenario={scenario}", "scenario.intervals=16", "strategy=sequences", "strategy.margin=0"
    )
    found = case.strategy.solve(case, Ledger(60.0))
    costs = {}
    for made in case.scenario.itinerary.sequences():
        start = posing.start(case, Ledger(60.0), made)
        result = pose(posing.phases(case, start), case, Ledger(60.0), "brute force")
        costs[tuple(s.name for s in made)] = result.solved.outcome.objective
    best = min(costs, key=lambda names: costs[names])
    first = {
        name: float(np.argmax(found.plan.progress_by_stop[:, found.plan.stop_names.index(name)]))
        for name in best
    }
    assert found.solved.outcome.objective == pytest.approx(costs[best], rel=1e-9)
    assert best != tuple(s.name for s in case.scenario.itinerary.listed)  # the obvious guess is wrong
    assert sorted(first, key=lambda name: first[name]) == list(best)
    assert found.account["search"].startswith("2 sequences: 2 solved")


@pytest.mark.slow
def test_sequences_takes_the_margins_that_the_replay_asks_for() -> None:
    """Without any, the replay exceeds a limit; fixed ones cost more."""
    free = ("scenario.rate_margin.arm=0", "scenario.contact_margin.position=0")
    measured, none, fixed = (
        pipeline.run(compose("+scenario=two_free", "strategy=sequences", *more)).record
        for more in ((), ("strategy.margin=0", *free), ("strategy.margin=0",))
    )
    assert measured["search"] == "2 sequences: 2 solved; all were tried; margins for the best one only"
    assert measured["certified"] and not none["certified"]
    assert none["travel_time_s"] < measured["travel_time_s"] < fixed["travel_time_s"]


def test_a_relaxation_chooses_one_robot_whole() -> None:
    case = compose("+scenario=first_robot", "scenario.intervals=12", "guess=phases", "guess.sequence=[far]")
    start = case.guess.plan(case, Ledger(60.0))
    result = pose(free_contact(case, start), case, Ledger(60.0), "relaxation")
    assert result.solved.outcome.claim == "solved"
    np.testing.assert_allclose(result.solved.values[MADE].ravel(), [0, 1], atol=1e-4)
    assert result.plan.progress_by_stop[:, 0].max() < 1e-3 and result.plan.progress_by_stop[
        :, 1
    ].sum() == pytest.approx(2, abs=1e-3)


REFUSED = (
    (("+scenario=two_free", "guess=phases", "guess.sequence=[cart,table]"), "guess.sequence", "no stop 'table'; allowed: cart, bench"),
    (("+scenario=delivery", "guess=phases", "guess.sequence=[shelf,robot,belt]"), "guess.sequence", "allowed: [belt, robot, shelf]"),
    (("+scenario=static", "+scenario.visit=one"), "scenario.visit", "there is one stop"),
    (("+scenario=two_free", "+scenario.visit=optional"), "scenario.visit", "no stop has a reward"),
    (("+scenario=two_free", "+scenario.stops.cart.reward=1"), "scenario.stops.cart.reward", "visit=optional"),
    (("+scenario=two_free", "+scenario.visit=some"), "scenario.visit", "'all', 'one' or 'optional'"),
    (("+scenario=two_free", "+scenario.stops.a__b.target=${scenario.stops.cart.target}"), "scenario.stops.a__b", "is no name"),
    (("+scenario=two_free", "+scenario.target=${scenario.stops.cart.target}"), "scenario.target", "beside scenario.stops"),
    (("+scenario=two_free", "scenario.stops.bench.target.position_m=[1,0,9]"), "scenario.stops.bench.target", "out of reach"),
    (("+scenario=delivery", "scenario.intervals=20"), "scenario.kappa_init", "1 to 16 in all"),
)  # fmt: skip


@pytest.mark.parametrize(
    ("overrides", "field", "says"), REFUSED, ids=[case[1] + str(i) for i, case in enumerate(REFUSED)]
)
def test_bad_input_has_one_clear_message(overrides: tuple[str, ...], field: str, says: str) -> None:
    with pytest.raises(BadInput) as caught:
        case = composing.case_of(*overrides)
        validate(case)
        case.guess.plan(case, Ledger(60.0))
    assert str(caught.value).startswith(f"{field}: ")
    assert says in str(caught.value)


def test_two_stops_of_one_name_are_refused(tmp_path: Path) -> None:
    (tmp_path / "scenario").mkdir()
    target = "target: {_target_: benchbench_plugins.motions.Fixed, position_m: [1, 0, 0.4]}"
    text = f"defaults: [handover, _self_]\nname: twice\nstops:\n  a: {{{target}}}\n  a: {{{target}}}\n"
    (tmp_path / "scenario/twice.yaml").write_text(text)
    with pytest.raises(BadInput, match="a"):
        config.compose(f"hydra.searchpath=[file://{tmp_path}]", "+scenario=twice")
