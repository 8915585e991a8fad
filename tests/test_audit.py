"""The audit of contacts on gaps that are given: no vehicle flies, its x and y are the gaps of two conditions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, final

import numpy as np
import pytest
from flights import Polynomial, plan_of, table_one
from test_certificate import LIMITS

from benchbench.certificate.audit import Audit, audit, claimed
from benchbench.certificate.replay import Replay
from benchbench.ground.arrays import Array
from benchbench.ocp.contact import Condition, Contact, Kept, Target
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.node import Node
from benchbench.ocp.plan import Plan
from benchbench.ocp.stop import Itinerary, Stop

MODEL = table_one()
PLANT = MODEL.plant()
EDGE = 0.5 + LIMITS.node
"""Limit of either condition and what the certificate grants at nodes."""
OVER = float(np.nextafter(EDGE, 1.0))
HERE = Polynomial(0.0, np.zeros((1, 3)))


@final
@dataclass(frozen=True)
class Told(Contact):
    """Its gap is a coordinate of the vehicle."""

    noun: ClassVar[str] = "gap"
    aside: ClassVar[str] = "off"
    unit: ClassVar[str] = "m"
    coordinate: int
    limit: float = 0.5
    kept: Kept = "in contact"  # type: ignore[misc]

    @property
    def reach(self) -> None:
        return None

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        raise NotImplementedError

    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        return q[:, self.coordinate]


BOTH = {"x": Told(0), "y": Told(1)}


def stop(name: str = "target", contacts: dict[str, Contact] = BOTH) -> Stop:  # type: ignore[assignment]
    return Stop(name, HERE, contacts, 2)


def path(gaps: Any) -> Array:
    """Configurations with these gaps, (rows, 2)."""
    gaps = np.array(gaps, float)
    return np.hstack([gaps, np.zeros((len(gaps), 5))])


def plan(gaps: Any, claims: Any) -> Plan:
    q = path(gaps)
    time = np.arange(float(len(q)))
    made = plan_of(MODEL, time, q, 0 * q, np.zeros((len(q) - 1, 5)))
    return replace(made, progress=np.array(claims, float))


def flown(gaps: Any, samples: int) -> Replay:
    q = path(gaps)
    time = np.arange(len(q)) / samples
    return Replay(time, q, 0 * q, np.arange(0, len(q), samples), (), None)


def audited(made: Plan, flight: Replay, *stops: Stop) -> list[Audit]:
    return list(audit(made, flight, Itinerary(stops or (stop(),)), PLANT, LIMITS))


ZERO = [0.0, 0.0]


def test_a_contact_is_the_longest_run_of_claimed_nodes_that_hold_everything() -> None:
    """Node 1 is off in x, node 3 in y, node 6 is not claimed; the limit and what is granted at nodes still holds."""
    gaps = [ZERO, [OVER, 0], ZERO, [0, OVER], [EDGE, EDGE], [0.1, 0.2], ZERO]
    replayed = np.full((13, 2), 9.0)
    replayed[7:12] = [[0.3, 0], [0.4, 0.1], [0.2, 0.7], [0, 0], [0.1, 0.6]]
    (one,) = audited(plan(gaps, [1, 1, 1, 1, 1, 1, 0]), flown(replayed, 2))
    assert one.claims.tolist() == [True] * 6 + [False]
    assert one.window == (4, 5) and one.steps == 2
    assert one.dense.tolist() == [8 <= k <= 10 for k in range(13)]
    np.testing.assert_array_equal(one.planned["x"], np.array(gaps)[:, 0])
    np.testing.assert_array_equal(one.replayed["y"], replayed[:, 1])
    assert (one.worst_planned("x"), one.worst_planned("y")) == (1, 3)
    assert (one.worst_replayed("x"), one.worst_replayed("y")) == (8, 9)


def test_a_node_claims_contact_above_a_share_of_progress() -> None:
    edge = LIMITS.contact_claim
    (one,) = audited(plan([ZERO] * 4, [edge, 2 * edge, 0.5 * edge, 1.0]), flown([ZERO] * 4, 1))
    assert one.claims.tolist() == [False, True, False, True]
    assert one.window == (1, 1)


def test_without_a_contact_there_is_no_window() -> None:
    for gaps, claims in (([ZERO] * 3, [0, 0, 0]), ([[9.0, 0.0]] * 3, [1, 1, 1])):
        (one,) = audited(plan(gaps, claims), flown([ZERO] * 3, 1))
        assert (one.window, one.steps, one.dense.any()) == (None, 0, False)


def test_what_is_no_number_is_worst_and_holds_nothing() -> None:
    gaps = [[0.1, 0], [np.nan, 0], [0.3, 0], [0.2, 0]]
    (one,) = audited(plan(gaps, [1, 1, 1, 1]), flown(gaps, 1))
    assert one.worst_planned("x") == 1 and one.window == (2, 3)
    assert one.worst_replayed("x") == 2


def test_path_conditions_are_measured_but_make_no_contact() -> None:
    contacts = {"x": Told(0), "path": Told(1, kept="always")}
    (one,) = audited(plan([[0, 9], [0, 9]], [1, 1]), flown([[0, 8], [0, 7]], 1), stop(contacts=contacts))
    assert one.window == (0, 1)
    assert (one.planned["path"].tolist(), one.replayed["path"].tolist()) == ([9, 9], [8, 7])


def test_what_is_kept_until_contact_ends_with_it() -> None:
    """Contact at nodes 1 and 2 of 4; without a window it is asked all along, and nowhere where none is claimed."""
    gaps = [[9, 0], [0, 0], [0, 0], [9, 0]]
    until, always = Told(1, kept="until contact"), Told(1, kept="always")
    contacts = {"x": Told(0), "until": until, "always": always}
    (one,) = audited(plan(gaps, [0, 1, 1, 0]), flown([gaps[0], *gaps], 1), stop(contacts=contacts))
    assert one.window == (1, 2)
    assert one.path_nodes(until).tolist() == [True, True, True, False]
    assert one.path_samples(until).tolist() == [True, True, True, False, False]
    assert one.path_nodes(always).all() and one.path_samples(always).all()
    for claims, asked in ([0, 0, 0, 1], True), ([0, 0, 0, 0], False):
        (one,) = audited(plan(gaps, claims), flown([gaps[0], *gaps], 1), stop(contacts=contacts))
        assert one.window is None and (one.path_nodes(until) == asked).all()


def test_a_stop_that_the_plan_does_not_know_is_not_claimed() -> None:
    claims = np.array([[1.0, 0.0], [0.0, 1.0]])
    made = replace(plan([ZERO] * 2, [0, 0]), progress=claims, stop_names=("b", "a"))
    found = audited(made, flown([ZERO] * 2, 1), stop("a"), stop("b"), stop("c"))
    assert [one.stop.name for one in found] == ["a", "b", "c"]
    assert [one.progress.tolist() for one in found] == [[0, 1], [1, 0], [0, 0]]
    assert [one.window for one in found] == [(1, 1), (0, 0), None]


def test_contacts_depend_on_the_target_at_their_time() -> None:
    """The target passes x = 2 t - 3 with 2 m/s; the tool stands below the vehicle at 0, 0."""

    @final
    @dataclass(frozen=True)
    class Seen(Contact):
        noun: ClassVar[str] = "x"
        aside: ClassVar[str] = "off"
        unit: ClassVar[str] = "m"
        limit: float = 0.0
        reach = None

        def condition(self, model: Model, node: Node, target: Target) -> Condition:
            raise NotImplementedError

        def gap(self, plant: Plant, q: Array, v: Array, place: Array, moving: Array) -> Array:
            return place[:, 0] + 10 * moving[:, 0] + 100 * q[:, 0] + 1000 * v[:, 0]

    passing = Stop("target", Polynomial(0.0, np.array([[-3.0, 0, 0], [2.0, 0, 0]])), {"seen": Seen()}, 2)
    made = replace(plan([ZERO, [1, 0]], [0, 0]), velocity=np.eye(2, 7))
    flight = replace(flown([[0, 0], [0, 0], [5, 0]], 1), velocity=np.eye(3, 7, -1))
    (one,) = audited(made, flight, passing)
    np.testing.assert_allclose(one.planned["seen"], [-3 + 20 + 1000, -1 + 20 + 100])
    np.testing.assert_allclose(one.replayed["seen"], [-3 + 20, -1 + 20 + 1000, 1 + 20 + 500])


def test_a_claim_is_made_where_all_conditions_hold_together() -> None:
    """One holds at nodes 0 to 3, the other at nodes 2 to 5; a stop without a condition of the event claims nothing."""
    gaps = [[0, 9], [0, 9], [EDGE, 0], [0, EDGE], [OVER, 0], [9, 0]]
    silent = plan(gaps, [np.nan] * 6)
    stops = (
        stop("none", {}),
        stop("path", {"x": Told(0, kept="always")}),
        stop("both"),
        stop("x", {"x": Told(0)}),
    )
    found = claimed(silent, Itinerary(stops), PLANT, LIMITS)
    assert found.stop_names == ("none", "path", "both", "x")
    expected = [[0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 1, 1, 0, 0], [1, 1, 1, 1, 0, 0]]
    np.testing.assert_array_equal(found.progress.T, expected)
    assert found.configuration is silent.configuration
    partly = replace(silent, progress=np.array([np.nan, 0, 0, 0, 0, np.nan]))
    assert claimed(partly, Itinerary(stops), PLANT, LIMITS) is partly


@pytest.mark.parametrize("reverse", [False, True])
def test_the_order_of_conditions_does_not_matter(reverse: bool) -> None:
    contacts = dict(sorted(BOTH.items(), reverse=reverse))
    gaps = [[0, 9], [0, 0], [9, 0]]
    found = claimed(plan(gaps, [np.nan] * 3), Itinerary((stop("a", contacts),)), PLANT, LIMITS)
    assert found.progress.ravel().tolist() == [0, 1, 0]
    (one,) = audited(plan(gaps, [1, 1, 1]), flown(gaps, 1), stop("a", contacts))
    assert one.window is None  # the plan does not know of "a"
    (one,) = audited(plan(gaps, [1, 1, 1]), flown(gaps, 1), stop(contacts=contacts))
    assert one.window == (1, 1)
