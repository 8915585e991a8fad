"""What all transcriptions share, by hand: bounds of nodes and inputs along a ramp, ends, costs, guesses from a plan."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from flights import REST, Polynomial, plan_of, table_one
from test_race_certificate import race, vehicle

from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Mpcc, Variable, evaluate
from benchbench.ocp.handover import Handover
from benchbench.ocp.plan import Interpolation
from benchbench.transcription.grid import Grid, Phase
from benchbench.transcription.nodal import (
    NodalTrajectory,
    cost,
    input_intervals,
    nodal_variables,
    output_limits,
    total_time,
)
from benchbench_plugins.models.quadrotor import Ramp

N = 20
METRES = np.concatenate([0.4 * np.arange(11), 4 + 1.2 * np.arange(1, 11)])
"""From 1 m up to the gate at 5 m in ten nodes, up to the end at 17 m in ten more."""
GRID = Grid((Phase("flight", N, 0.5, 9.0, 4.0),))
PHASES = Grid((Phase("a", 2, 0.1, 9.0, 0.6), Phase("b", 3, 0.2, 8.0, 1.4)))


def along(first: float, last: float) -> Array:
    """A limit that grows over 16 m."""
    return first + (last - first) * METRES / 16


def ramped(**changes: Any) -> Any:
    return vehicle(ramp=Ramp(metres=16.0, motor_force=2.0, body_rate=(10.0, 10.0, 0.05)), **changes)


def named(variables: tuple[Variable, ...]) -> dict[str, Variable]:
    return {v.name: v for v in variables}


def handover(**changes: Any) -> Handover:
    names = table_one().configuration.names
    fields: dict[str, Any] = {
        "name": "hover", "start": dict(zip(names, REST, strict=True)), "end": {"x": 2.0, "z": 0.65}, "contacts": {},
        "target": Polynomial(0.0, np.zeros((1, 3))), "travel_time": (0.5, 7.0),
    }  # fmt: skip
    return Handover(**(fields | changes))


def test_rates_are_limited_where_their_node_is() -> None:
    v = named(nodal_variables(race(), ramped(), GRID, N))["v"]
    np.testing.assert_allclose(v.upper[1:, 5], along(0.05, 0.3)[1:], rtol=1e-12)
    np.testing.assert_allclose(v.lower[1:, 3], -along(10.0, 15.0)[1:], rtol=1e-12)
    assert np.all(np.isposinf(v.upper[1:, :3])), "the race has no limit of speed"
    assert not v.lower[0].any() and not v.upper[0].any()
    free = named(nodal_variables(race(), ramped(), GRID, N, velocity_limits=False))["v"]
    assert np.all(np.isposinf(free.upper[1:-1])) and np.all(np.isneginf(free.lower[1:-1]))


def test_outputs_are_limited_where_their_node_is() -> None:
    """The first node is given; the others are asked for."""
    (outputs,) = output_limits(race(), ramped(attitude="euler"), GRID).constraints
    np.testing.assert_allclose(outputs.upper[:, 2], along(0.05, 0.3)[1:], rtol=1e-12)
    np.testing.assert_array_equal(outputs.lower, -outputs.upper)
    assert outputs.slots[0].index[:, 0].tolist() == [6 * k for k in range(1, N + 1)]
    assert not output_limits(race(), ramped(), GRID).constraints


@pytest.mark.parametrize(
    ("rows", "nodes"), [(N, range(N)), (N + 1, range(N + 1)), (3 * N, [k // 3 for k in range(3 * N)])]
)
def test_inputs_are_limited_where_their_interval_begins(rows: int, nodes: Any) -> None:
    np.testing.assert_array_equal(input_intervals(GRID, rows), list(nodes))
    u = named(nodal_variables(race(), ramped(), GRID, rows))["u"]
    np.testing.assert_allclose(u.upper[:, 0], along(2.0, 6.8794)[list(nodes)], rtol=1e-12)
    assert not u.lower.any()


def test_ends_and_guesses() -> None:
    """A straight line at hover, from the start to the end, in the time guessed."""
    model, task = table_one(), handover(hover_ends=True, travel_time_guess=2.0)
    found = named(nodal_variables(task, model, PHASES, 5))
    q, v, u, t = (found[name] for name in "qvuT")
    np.testing.assert_allclose(q.guess[:, 0], np.linspace(0, 2, 6), atol=1e-15)
    np.testing.assert_allclose(v.guess[1:-1, 0], 1.0)
    for limits in (q.lower, q.upper):
        np.testing.assert_allclose(limits[0], REST)
        np.testing.assert_allclose(limits[-1, :3], [2.0, 0.0, 0.65])
    for limits in (v.lower, v.upper, v.guess):
        assert not limits[[0, -1]].any()
    np.testing.assert_allclose(v.upper[1:-1], np.tile(model.velocity.upper, (4, 1)))
    for k in (0, -1):
        np.testing.assert_array_equal(u.lower[k], model.hover())
        np.testing.assert_array_equal(u.upper[k], model.hover())
    np.testing.assert_array_equal(u.upper[1:-1], np.tile(model.inputs.upper, (3, 1)))
    np.testing.assert_array_equal(u.guess, np.tile(model.hover(), (5, 1)))
    assert (t.lower.tolist(), t.upper.tolist(), t.guess.tolist()) == (
        [[0.1], [0.2]],
        [[9], [8]],
        [[0.6], [1.4]],
    )
    loose = named(nodal_variables(handover(), model, PHASES, 5))["u"]
    np.testing.assert_array_equal(loose.upper, np.tile(model.inputs.upper, (5, 1)))


def test_authority_is_left_to_the_controller_at_both_ends_of_the_range() -> None:
    """A fifth of 0.5 to 1.5 times what hover needs: a tenth of it at either end."""
    u = named(nodal_variables(handover(authority=0.2), table_one(), PHASES, 5))["u"]
    hover = 1.659 * 9.8066 / 4  # of the vehicle without its arm, paper Table I
    np.testing.assert_allclose(u.lower[:, 0], 0.6 * hover, rtol=1e-5)
    np.testing.assert_allclose(u.upper[:, 0], 1.4 * hover, rtol=1e-5)


def test_guesses_of_the_end_stay_where_it_may_be() -> None:
    """As all guesses do."""
    found = named(nodal_variables(race(), ramped(), GRID, N))["q"]
    assert np.all((found.guess >= found.lower) & (found.guess <= found.upper))


@pytest.mark.parametrize(
    ("rows", "per_interval", "seconds"), [(5, 1, 2.0), (15, 3, 2.0), (6, 1, 2.0 + 1.4 / 3)]
)
def test_effort_is_counted_by_the_time_it_takes(rows: int, per_interval: int, seconds: float) -> None:
    """All inputs 0.1 beside hover: c T 5 0.01. Nodal inputs count their step, the last one that of its interval."""
    model, task = table_one(), handover(input_cost=0.3)
    blocks = cost(task, model, PHASES, rows, per_interval)
    mpcc = Mpcc(nodal_variables(task, model, PHASES, rows))
    x = mpcc.start_from({"u": np.tile(model.hover() + 0.1, (rows, 1)), "T": np.array([0.6, 1.4])}).guess
    found = {block.name: float(evaluate(block, mpcc, x).sum()) for block in blocks}
    assert found == pytest.approx({"travel_time": 2.0, "input_cost": 0.3 * seconds * 5 * 0.01})
    assert [block.name for block in cost(handover(input_cost=0.0), model, PHASES, rows)] == ["travel_time"]


def test_the_whole_time_is_limited_where_it_has_parts() -> None:
    assert total_time(handover(), GRID) == Mpcc()
    (total,) = total_time(handover(), PHASES).constraints
    assert (total.lower.item(), total.upper.item()) == (0.5, 7.0)
    mpcc = Mpcc(nodal_variables(handover(), table_one(), PHASES, 5))
    assert evaluate(total, mpcc, mpcc.guess).item() == pytest.approx(2.0)


@pytest.mark.parametrize(("how", "points"), [("hold", 1), ("linear", 1), ("bezier", 3)])
def test_a_plan_is_sampled_at_the_nodes(how: Interpolation, points: int) -> None:
    """A plan of 4 s on 0.6 : 1.4 of it; inputs at nodes, or at the middle of what they are held for."""
    model = table_one()
    time = np.linspace(0.0, 4.0, 9)
    q, v, u = np.tile(REST, (9, 1)), np.zeros((9, 7)), np.tile(model.hover(), (9, 1))
    q[:, 0], v[:, 0], u[:, 0] = time, 2 * time, time
    values = NodalTrajectory(PHASES, model, how, control_points=points).encode(
        plan_of(model, time, q, v, u, "linear")
    )
    np.testing.assert_allclose(values["T"].ravel(), [1.2, 2.8])
    nodes = np.array([0, 0.6, 1.2, 1.2 + 2.8 / 3, 1.2 + 5.6 / 3, 4.0])
    np.testing.assert_allclose(values["q"][:, 0], nodes)
    np.testing.assert_allclose(values["v"][:, 0], 2 * nodes)
    share = (np.arange(points) + 0.5) / points
    inside = (nodes[:-1, None] + np.diff(nodes)[:, None] * share).ravel()
    np.testing.assert_allclose(values["u"][:, 0], nodes if how == "linear" else inside)
