"""Contacts on hand-made states, and how conditions are put on a trajectory: by progress, at nodes, always."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from flights import REST, table_one

from benchbench.conformance.checks.initial_value import Transcribed, one_phase, transcribe
from benchbench.formulation.coupling import Coupling, progress_index, retargeted
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import evaluate
from benchbench.ocp.contact import Condition, Contact, Target
from benchbench.ocp.model import Model
from benchbench.ocp.motion import Motion, sample
from benchbench.ocp.node import Node
from benchbench.transcription.grid import Grid, Phase
from benchbench_plugins.contacts.approach import Approach
from benchbench_plugins.contacts.floor import Floor
from benchbench_plugins.contacts.heading import Heading
from benchbench_plugins.contacts.position import Position
from benchbench_plugins.contacts.velocity import Velocity
from benchbench_plugins.dynamics.verlet import Verlet
from benchbench_plugins.motions import Circle, Linear

TIP = np.array([0.0, 0.0, 0.65 - 0.05 - 0.182])
"""End effector at REST: the arm hangs straight down from its mount."""
STILL = np.zeros(3)


@pytest.fixture(scope="module")
def model() -> Model:
    return table_one()


def h_of(contact: Contact, model: Model, q: Array, v: Array, p: Array, w: Array) -> float:
    symbols = [ca.SX.sym(k, n) for k, n in (("q", 7), ("v", 7), ("p", 3), ("w", 3))]
    node = Node(ca.vertcat(*symbols[:2]), ca.SX(0, 1), ca.SX.sym("t"), symbols[0], symbols[1])
    h = contact.condition(model, node, Target(*symbols[2:])).h
    return float(ca.Function("h", symbols, [h])(q, v, p, w))


@pytest.mark.parametrize(("distance", "h"), [(0.0, -1.0), (0.01, -0.75), (0.02, 0.0), (0.04, 3.0)])
def test_position(model: Model, distance: float, h: float) -> None:
    contact, target = Position(0.02), TIP + distance * np.array([2.0, -1.0, 2.0]) / 3
    assert h_of(contact, model, REST, 0 * REST, target, STILL) == pytest.approx(h, abs=1e-12)
    (gap,) = contact.gap(model.plant(), REST[None], 0 * REST[None], target[None], STILL[None])
    assert gap == pytest.approx(distance, abs=1e-15)


def test_velocity_of_a_turning_arm(model: Model) -> None:
    """D arm/dt = 2 rad/s at length 0.182 m, arm down: the tip moves at 0.364 m/s against x."""
    v = np.zeros(7)
    v[6] = 2.0
    contact = Velocity(0.01)
    assert h_of(contact, model, REST, v, TIP, np.array([-0.364, 0, 0])) == pytest.approx(-1.0, abs=1e-9)
    assert h_of(contact, model, REST, v, TIP, STILL) == pytest.approx(36.4**2 - 1, rel=1e-12)
    (gap,) = contact.gap(model.plant(), REST[None], v[None], TIP[None], STILL[None])
    assert gap == pytest.approx(0.364, abs=1e-14)


@pytest.mark.parametrize("degrees", [0.0, 3.0, 5.0, 6.5, 90.0, 178.0, 180.0, -3.0, -120.0])
@pytest.mark.parametrize("speed", [0.05, 0.12])
def test_heading_angle(model: Model, degrees: float, speed: float) -> None:
    q = REST.copy()
    q[5] = 0.7
    way = 0.7 + math.radians(degrees)
    target = speed * np.array([math.cos(way), math.sin(way), 0.3])
    contact = Heading(0.1)
    error = math.radians(abs(degrees))
    h = h_of(contact, model, q, 0 * q, TIP, target)
    assert h == pytest.approx((1 - math.cos(error)) / (1 - math.cos(0.1)) - 1, abs=1e-3)
    assert (h <= 0) == (error <= 0.1)
    (gap,) = contact.gap(model.plant(), q[None], 0 * q[None], TIP[None], target[None])
    assert gap == pytest.approx(error, abs=1e-12)


@pytest.mark.parametrize(("limit", "speed"), [(0.01, 0.01), (0.01, 0.032), (0.1, 0.001), (0.1, 0.12)])
def test_the_planned_limit_of_a_slow_target_is_the_certified_one(
    model: Model, limit: float, speed: float
) -> None:
    """Off by a tenth of the 1e-6 rad that the certificate grants at a node, at most."""
    for angle, holds in ((limit - 1e-7, True), (limit + 1e-7, False)):
        velocity = speed * np.array([math.cos(angle), math.sin(angle), 0.0])
        assert (h_of(Heading(limit), model, REST, 0 * REST, TIP, velocity) < 0) is holds


def test_heading_of_a_target_that_stands_holds_by_definition(model: Model) -> None:
    q = REST.copy()
    q[5] = 2.0
    for velocity in (STILL, np.array([0.0, 0.0, 0.3])):
        assert h_of(Heading(0.1), model, q, 0 * q, TIP, velocity) == pytest.approx(-1.0, abs=1e-9)
        assert Heading(0.1).gap(model.plant(), q[None], 0 * q[None], TIP[None], velocity[None])[0] == 0.0


def test_the_papers_cross_product_accepts_flying_backwards(model: Model) -> None:
    q = REST.copy()
    backwards = np.array([-0.12, 0.0, 0.0])
    printed, angle = Heading(0.1, form="cross"), Heading(0.1)
    assert h_of(printed, model, q, 0 * q, TIP, backwards) == pytest.approx(-1.0)
    assert h_of(angle, model, q, 0 * q, TIP, backwards) > 100
    assert printed.gap(model.plant(), q[None], 0 * q[None], TIP[None], backwards[None])[0] == pytest.approx(
        math.pi
    )


def test_the_papers_cross_product_has_units_of_speed(model: Model) -> None:
    """|v_T x x_B| = speed * sin(angle): the limit in rad is met at any angle when the target is slow."""
    aside = np.array([0.0, 1.0, 0.0])
    printed = Heading(0.1, form="cross")
    assert h_of(printed, model, REST, 0 * REST, TIP, 0.05 * aside) == pytest.approx(0.25 - 1)
    assert h_of(printed, model, REST, 0 * REST, TIP, 0.2 * aside) == pytest.approx(4 - 1)


@pytest.mark.parametrize(
    ("below", "h"), [(0.0, -1.0), (0.005, -0.5), (0.01, 0.0), (0.02, 1.0), (-0.5, -51.0)]
)
def test_floor(model: Model, below: float, h: float) -> None:
    target = TIP + np.array([0.4, 0.2, below])
    assert h_of(Floor(0.01), model, REST, 0 * REST, target, STILL) == pytest.approx(h, abs=1e-12)
    (gap,) = Floor(0.01).gap(model.plant(), REST[None], 0 * REST[None], target[None], STILL[None])
    assert gap == pytest.approx(max(below, 0.0), abs=1e-15)


@pytest.mark.parametrize("contact", [Position, Velocity, Heading, Floor])
@pytest.mark.parametrize("limit", [0.0, -0.1, math.nan])
def test_a_limit_must_be_positive(contact: type, limit: float) -> None:
    with pytest.raises(ValueError, match="limit"):
        contact(limit=limit)


def test_tightened_condition_keeps_its_form() -> None:
    gap = ca.SX.sym("gap")
    whole = Condition(gap**2 / 0.02**2 - 1, "m", (0.02,))
    tight = whole.tightened(0.1)
    assert tight.limit == pytest.approx((0.018,))
    value = ca.Function("h", [gap], [tight.h])
    for at in (0.0, 0.018, 0.02):
        assert float(value(at)) == pytest.approx((at / 0.018) ** 2 - 1, abs=1e-12)
    assert whole.tightened(0.0) is whole


@pytest.mark.parametrize(("below", "h"), [(0.009, 0.0), (0.01, 0.1), (0.0, -0.9)])
def test_a_condition_of_another_form_is_tightened_in_its_own_scale(below: float, h: float) -> None:
    """A floor of 10 mm with a tenth to spare is a floor of 9 mm."""
    depth = ca.SX.sym("depth")
    floor = Condition(depth / 0.01 - 1, "m").tightened(0.1)
    assert floor.limit is None
    assert float(ca.Function("h", [depth], [floor.h])(below)) == pytest.approx(h, abs=1e-12)


N = 5
CIRCLE = Circle((0.1, 0.2, 0.4), 0.3, 0.7)


def coupled(
    model: Model, motion: Motion, grid: Grid, margins: dict[str, float] | None = None
) -> tuple[Transcribed, Coupling]:
    contacts = {
        "position": Position(0.02),
        "velocity": Velocity(0.01),
        "heading": Heading(0.1),
        "floor": Floor(0.01),
    }
    transcribed = transcribe(Verlet(), model, grid)
    return transcribed, Coupling(contacts, model, motion, transcribed.trajectory, margins or {})


def random_point(mpcc, seed: int = 0) -> Array:
    draw = np.random.default_rng(seed)
    return mpcc.guess + draw.uniform(-0.3, 0.3, mpcc.size) * (mpcc.lower < mpcc.upper)


@pytest.mark.parametrize(
    "grid", [one_phase(N, 1.3), Grid((Phase("a", 2, 0.1, 9, 0.5), Phase("b", 1, 0.1, 9, 0.2), Phase("c", 2, 0.1, 9, 1.1)))],
    ids=["one phase", "three phases"],
)  # fmt: skip
@pytest.mark.parametrize("motion", [CIRCLE, Linear((0.9, 0, 0.4), (0.1, 0.2, 0))], ids=["circle", "linear"])
def test_pairs_hold_progress_and_conditions_at_the_nodes_times(
    model: Model, motion: Motion, grid: Grid
) -> None:
    """H of every pair against the plant's gaps with the target sampled at the decoded times."""
    transcribed, coupling = coupled(model, motion, grid)
    mpcc = transcribed.mpcc + coupling.by_progress(2)
    x = random_point(mpcc)
    values = mpcc.split(x)
    plan = transcribed.trajectory.decode(values, np.zeros(N + 1))
    targets = sample(motion, plan.time[:-1])
    for pair in mpcc.pairs:
        contact = coupling.contacts[pair.block.name]
        g, h = evaluate(pair.block, mpcc, x).T
        np.testing.assert_allclose(g, -np.diff(values["kappa"].ravel()), atol=1e-14)
        gap = contact.gap(model.plant(), plan.configuration[:-1], plan.velocity[:-1], *targets)
        if pair.block.name == "heading":
            np.testing.assert_allclose(h, (1 - np.cos(gap)) / (1 - np.cos(0.1)) - 1, rtol=1e-4)
        else:
            np.testing.assert_allclose(h, (gap / contact.limit) ** 2 - 1, rtol=1e-10)
        assert pair.kind == "vanishing" and pair.sign_known and pair.limit == (contact.limit,)


def test_progress_runs_from_kappa_init_to_zero(model: Model) -> None:
    _, coupling = coupled(model, CIRCLE, one_phase(N, 1.0))
    part = coupling.by_progress(3)
    (kappa,) = part.variables
    assert kappa.guess.shape == (N + 1, 1)
    assert (kappa.lower[0, 0], kappa.upper[0, 0]) == (3, 3) and (kappa.lower[-1, 0], kappa.upper[-1, 0]) == (
        0,
        0,
    )
    progress = next(b for b in part.constraints if b.name == "progress")
    falling = np.array([3.0, 3.0, 2.2, 1.2, 0.2, 0.0])
    out = evaluate(progress, part, falling).ravel()
    np.testing.assert_allclose(out, [0, 0.8, 1, 1, 0.2], atol=1e-15)
    assert np.all(progress.lower == 0) and np.all(progress.upper == 1)
    np.testing.assert_allclose(progress_index(falling), [0, 0.8, 1, 1, 0.2, 0], atol=1e-15)


def test_path_conditions_hold_everywhere_and_are_no_pairs(model: Model) -> None:
    _, coupling = coupled(model, CIRCLE, one_phase(N, 1.0))
    assert [pair.block.name for pair in coupling.by_progress(2).pairs] == ["position", "velocity", "heading"]
    for part in (coupling.by_progress(2), coupling.at_nodes([1, 2])):
        (floor,) = (b for b in part.constraints if b.name == "floor")
        assert floor.instances == N and np.all(floor.upper == 0) and np.all(np.isneginf(floor.lower))


def test_what_is_kept_until_contact_vanishes_with_what_is_left_of_it(model: Model) -> None:
    """G = kappa_k / kappa_init at all nodes; held at nodes 1 and 2 it is asked at 0 to 2."""
    transcribed, coupling = coupled(model, CIRCLE, one_phase(N, 1.0))
    coupling = replace(coupling, contacts={"position": Position(0.02), "approach": Approach(0.05)})
    mpcc = transcribed.mpcc + coupling.by_progress(2)
    x = random_point(mpcc)
    values = mpcc.split(x)
    plan = transcribed.trajectory.decode(values, np.zeros(N + 1))
    states = plan.configuration[:-1], plan.velocity[:-1], *sample(CIRCLE, plan.time[:-1])
    (pair,) = (pair for pair in mpcc.pairs if pair.block.name == "approach")
    g, h = evaluate(pair.block, mpcc, x).T
    np.testing.assert_allclose(g, values["kappa"].ravel()[:-1] / 2, atol=1e-14)
    np.testing.assert_allclose(h, (Approach(0.05).gap(model.plant(), *states) / 0.05) ** 2 - 1, rtol=1e-10)
    held = {block.name: block.instances for block in coupling.at_nodes([1, 2]).constraints}
    assert held == {"position": 2, "approach": 3}


def test_conditions_at_chosen_nodes(model: Model) -> None:
    transcribed, coupling = coupled(model, CIRCLE, one_phase(N, 1.0))
    part = coupling.at_nodes([1, 3])
    assert not part.pairs and not part.variables
    mpcc = transcribed.mpcc + part
    x = random_point(mpcc)
    paired = transcribed.mpcc + coupling.by_progress(2)
    longer = np.concatenate([x, np.zeros(N + 1)])
    for block in part.constraints:
        if block.name != "floor":
            pair = next(p for p in paired.pairs if p.block.name == block.name)
            everywhere = evaluate(pair.block, paired, longer)[:, 1]
            np.testing.assert_allclose(evaluate(block, mpcc, x).ravel(), everywhere[[1, 3]], rtol=1e-13)


def test_margins_tighten_one_contact_only(model: Model) -> None:
    grid = one_phase(N, 1.0)
    transcribed, whole = coupled(model, CIRCLE, grid)
    _, tight = coupled(model, CIRCLE, grid, {"position": 0.1})
    left, right = (transcribed.mpcc + c.at_nodes([1, 3]) for c in (whole, tight))
    x = random_point(left)
    for a, b in zip(left.constraints, right.constraints, strict=True):
        one, other = evaluate(a, left, x), evaluate(b, right, x)
        if a.name == "position":
            np.testing.assert_allclose(other + 1, (one + 1) / 0.81, rtol=1e-12)
        else:
            np.testing.assert_array_equal(one, other)


def test_target_numbers_are_parameters_so_that_functions_are_shared(model: Model) -> None:
    functions = []
    for centre in ((0.1, 0.2, 0.4), (5.0, 0.0, 0.0)):
        _, coupling = coupled(model, Circle(centre, 0.3, 0.7), one_phase(N, 1.0))
        functions.append([pair.block.function.serialize() for pair in coupling.by_progress(2).pairs])
    assert functions[0] == functions[1]


def test_another_target_has_other_numbers_at_every_node(model: Model) -> None:
    """As if the coupling had been made for it from the start."""
    other = Circle((5.0, 0.0, 0.0), 0.4, 0.9)
    old, new = (
        coupled(model, motion, one_phase(N, 1.0))[1].by_progress(2).pairs for motion in (CIRCLE, other)
    )
    for before, after in zip(old, new, strict=True):
        moved = retargeted(before.block, other)
        np.testing.assert_array_equal(moved.parameters, after.block.parameters)
        assert not np.array_equal(before.block.parameters, after.block.parameters), (
            "the old one stays as it is"
        )


@pytest.mark.parametrize(("decided", "first"), [(True, (3.0, 3.0)), (False, (0.0, 3.0))])
def test_a_contact_that_is_not_decided_starts_anywhere(
    model: Model, decided: bool, first: tuple[float, float]
) -> None:
    (kappa,) = coupled(model, CIRCLE, one_phase(N, 1.0))[1].by_progress(3, decided).variables
    assert (kappa.lower[0, 0], kappa.upper[0, 0]) == first
    assert (kappa.lower[-1, 0], kappa.upper[-1, 0]) == (0.0, 0.0)
    assert np.all(kappa.lower[1:-1] == 0.0) and np.all(kappa.upper[1:-1] == 3.0)


def test_progress_of_several_events_is_the_largest() -> None:
    kappa = np.array([[2.0, 1.0], [1.0, 1.0], [1.0, 0.5], [0.5, 0.0], [0.0, 0.0]])
    np.testing.assert_array_equal(progress_index(kappa), [1.0, 0.5, 0.5, 0.5, 0.0])


def test_nodes_know_their_time_and_the_step_that_follows() -> None:
    """Two intervals of 0.3 s, three of 0.2 s; the last node has no step of its own, and gets the one before."""
    grid = Grid((Phase("a", 2, 0.1, 9, 0.6), Phase("b", 3, 0.1, 9, 0.6)))
    trajectory = transcribe(Verlet(), table_one(), grid).trajectory
    numbers = trajectory.parameters(range(6)) @ np.kron(np.eye(2), np.array([[0.6], [0.6]]))
    np.testing.assert_allclose(numbers[:, 0], [0, 0.3, 0.6, 0.8, 1.0, 1.2], atol=1e-15)
    np.testing.assert_allclose(numbers[:, 1], [0.3, 0.3, 0.2, 0.2, 0.2, 0.2], atol=1e-15)
    np.testing.assert_array_equal(trajectory.parameters([4, 1]), trajectory.parameters(range(6))[[4, 1]])
