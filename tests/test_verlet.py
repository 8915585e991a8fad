"""The two-point form of Verlet against the paper's forced discrete Euler-Lagrange equations."""

from __future__ import annotations

from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from flights import table_one
from scipy.optimize import root

from benchbench.conformance.checks.initial_value import integrate, one_phase, told, transcribe
from benchbench.conformance.checks.orders import check_consistency, check_order, energy_errors
from benchbench.conformance.checks.states import at_rest
from benchbench.formulation.handover import phases
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import evaluate
from benchbench.nlp.ledger import Ledger
from benchbench.ocp.model import Model
from benchbench.planning.guess import straight_line
from benchbench.planning.strategy import pose
from benchbench.run import config
from benchbench_plugins.dynamics.verlet import Verlet
from benchbench_plugins.models.pendulum import Pendulum

N, SECONDS = 6, 0.3
H = SECONDS / N


class Paper:
    """Eq. 15 to 21 as printed, from nothing but L and Q; derivatives of L_d by AD on L_d itself."""

    def __init__(self, model: Model) -> None:
        n, m = len(model.configuration.names), len(model.inputs.names)
        a, b, v, u, w, h = (ca.SX.sym(k, size) for k, size in zip("abvuwh", (n, n, n, m, m, 1), strict=True))
        mean = (b - a) / h
        discrete = h / 2 * model.lagrangian(a, mean) + h / 2 * model.lagrangian(b, mean)
        rest = ca.SX.zeros(n)
        force = h / 4 * (model.force(a, rest, u) + model.force(b, rest, w))
        self._d1 = ca.Function("d1", [a, b, h], [ca.gradient(discrete, a)])
        self._d2 = ca.Function("d2", [a, b, h], [ca.gradient(discrete, b)])
        self._force = ca.Function("f", [a, b, u, w, h], [force])
        self._momentum = ca.Function("p", [a, v], [ca.gradient(model.lagrangian(a, v), v)])

    def interior(self, q: Array, u: Array, k: int, h: float = H) -> Array:
        """Eq. 16 at node k: D_2 L_d(q_{k-1}, q_k) + D_1 L_d(q_k, q_{k+1}) + f^+_{k-1} + f^-_k."""
        gradients = self._d2(q[k - 1], q[k], h) + self._d1(q[k], q[k + 1], h)
        forces = self._force(q[k - 1], q[k], u[k - 1], u[k], h) + self._force(
            q[k], q[k + 1], u[k], u[k + 1], h
        )
        return np.asarray(gradients + forces).ravel()

    def first(self, q: Array, v: Array, u: Array, h: float = H) -> Array:
        """Eq. 19, start: p(q_0, v_0) + D_1 L_d + f^-_0."""
        return np.asarray(
            self._momentum(q[0], v) + self._d1(q[0], q[1], h) + self._force(q[0], q[1], u[0], u[1], h)
        ).ravel()

    def last(self, q: Array, v: Array, u: Array, h: float = H) -> Array:
        """Eq. 19, end: -p(q_N, v_N) + D_2 L_d + f^+_{N-1}."""
        return np.asarray(
            -self._momentum(q[-1], v) + self._d2(q[-2], q[-1], h) + self._force(q[-2], q[-1], u[-2], u[-1], h)
        ).ravel()


@pytest.fixture(scope="module")
def model() -> Model:
    return table_one()


@pytest.fixture(scope="module")
def paper(model: Model) -> Paper:
    return Paper(model)


def legendre_rows(model: Model, q: Array, v: Array, u: Array) -> tuple[Array, Array]:
    """Our rows, leaving and arriving, (N, n) each."""
    averaged = transcribe(Verlet(inputs="averaged"), model, one_phase(N, SECONDS))
    values = averaged.mpcc.split(averaged.mpcc.guess) | {"q": q, "v": v, "u": u}
    x = np.concatenate([values[name.name].ravel() for name in averaged.mpcc.variables])
    leaving, arriving = (evaluate(block, averaged.mpcc, x) for block in averaged.mpcc.constraints[:2])
    return leaving, arriving


def random_flight(seed: int) -> tuple[Array, Array, Array]:
    draw = np.random.default_rng(seed)
    q = draw.uniform([-1, -1, 0, -0.6, -0.6, -2, 1.1], [1, 1, 1, 0.6, 0.6, 2, 2.0], (N + 1, 7))
    return q, draw.uniform(-2, 2, (N + 1, 7)), draw.uniform([2, 2, 2, 2, -2], [6, 6, 6, 6, 2], (N + 1, 5))


@pytest.mark.parametrize("seed", range(5))
def test_eliminating_velocities_gives_the_papers_equations(model: Model, paper: Paper, seed: int) -> None:
    q, v, u = random_flight(seed)
    leaving, arriving = legendre_rows(model, q, v, u)
    for k in range(1, N):
        wanted = paper.interior(q, u, k)
        ours = leaving[k] - arriving[k - 1]
        np.testing.assert_allclose(ours, wanted, rtol=0, atol=1e-11 * (1 + np.max(np.abs(wanted))))
    np.testing.assert_allclose(leaving[0], paper.first(q, v[0], u), rtol=1e-11, atol=1e-10)
    np.testing.assert_allclose(-arriving[-1], paper.last(q, v[-1], u), rtol=1e-11, atol=1e-10)


def test_gradients_of_the_discrete_lagrangian_against_differences(model: Model, paper: Paper) -> None:
    """Eq. 21 differentiated numerically, so that the oracle itself is checked."""
    a, v = ca.SX.sym("a", 7), ca.SX.sym("v", 7)
    lagrangian = ca.Function("l", [a, v], [model.lagrangian(a, v)])
    (q0, q1, *_), *_ = random_flight(9)
    q1 = q0 + 0.05 * (q1 - q0)

    def discrete(q: Array, p: Array) -> float:
        w = (p - q) / H
        return float(H / 2 * lagrangian(q, w) + H / 2 * lagrangian(p, w))

    steps = 1e-6 * np.eye(7)
    d1 = [(discrete(q0 + s, q1) - discrete(q0 - s, q1)) / 2e-6 for s in steps]
    d2 = [(discrete(q0, q1 + s) - discrete(q0, q1 - s)) / 2e-6 for s in steps]
    np.testing.assert_allclose(np.asarray(paper._d1(q0, q1, H)).ravel(), d1, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(np.asarray(paper._d2(q0, q1, H)).ravel(), d2, rtol=1e-6, atol=1e-6)


def test_solutions_agree(model: Model, paper: Paper) -> None:
    """March the paper's equations node by node, and ours all at once; then the last velocity by Eq. 19."""
    q0, v0 = at_rest(model), 0.3 * np.cos(np.arange(7.0))
    time = np.linspace(0, SECONDS, N + 1)
    u = model.hover() + 0.2 * np.sin(9 * time[:, None] + np.arange(5))
    q = [q0]
    q.append(root(lambda x: paper.first(np.array([q0, x]), v0, u), q0 + H * v0, tol=1e-13).x)
    for k in range(1, N):
        q.append(root(lambda x, k=k: paper.interior(np.array([*q, x]), u, k), 2 * q[-1] - q[-2], tol=1e-13).x)
    path = np.array(q)
    last = root(lambda v: paper.last(path, v, u), (path[-1] - path[-2]) / H, tol=1e-13).x

    ours = transcribe(Verlet(inputs="averaged"), model, one_phase(N, SECONDS))
    plan = integrate(ours, told(ours, q0, v0, lambda t: u))
    np.testing.assert_allclose(plan.configuration, path, atol=1e-9)
    np.testing.assert_allclose(plan.velocity[-1], last, atol=1e-8)
    assert np.max(np.abs(path[-1] - q0)) > 0.05, "the flight goes somewhere"


@pytest.mark.parametrize("inputs", ["interval", "nodal", "averaged"])
def test_second_order_with_every_kind_of_input(inputs: str) -> None:
    for check in (check_order, check_consistency):
        check(Verlet(inputs=inputs), Pendulum())


def test_averaged_inputs_hide_an_alternating_one() -> None:
    """The paper's forces do not see u, -u, u, ...; nodal ones do."""
    model = Pendulum()
    quiet, loud = (lambda t: np.zeros((len(t), 1))), (lambda t: 2.0 * (-1.0) ** np.arange(len(t))[:, None])
    ends = {}
    for inputs in ("averaged", "nodal"):
        ours = transcribe(Verlet(inputs=inputs), model, one_phase(20, 1.0))
        flown = [
            integrate(ours, told(ours, np.array([0.5]), np.zeros(1), s)).configuration for s in (quiet, loud)
        ]
        ends[inputs] = np.max(np.abs(flown[0] - flown[1]))
    assert ends["averaged"] < 1e-10
    assert ends["nodal"] > 1e-3


def test_free_fall_keeps_horizontal_momentum(model: Model) -> None:
    """Discrete Noether theorem: L_d does not depend on x and y, so p_x and p_y stay exactly."""
    q, v = ca.SX.sym("q", 7), ca.SX.sym("v", 7)
    momentum = ca.Function("p", [q, v], [ca.gradient(model.lagrangian(q, v), v)[:2]])
    start = at_rest(model) + np.array([0, 0, 0, 0.3, -0.2, 0.4, 0.2])
    ours = transcribe(Verlet(), model, one_phase(20, 0.4))
    spin = np.array([0.5, -0.3, 0.2, 1.0, -1.5, 0.7, 2.0])
    plan = integrate(ours, told(ours, start, spin, lambda t: np.zeros((len(t), 5))))
    kept = np.array(
        [np.asarray(momentum(*s)).ravel() for s in zip(plan.configuration, plan.velocity, strict=True)]
    )
    np.testing.assert_allclose(kept, np.tile(kept[0], (21, 1)), atol=1e-11)
    assert np.ptp(plan.velocity[:, 0]) > 1e-3, "the body's own velocity does change"


def test_energy_error_is_bounded_and_of_second_order() -> None:
    model = Pendulum(damping=0.0)
    first, second = energy_errors(Verlet(), model, 10.0, 0.05)
    assert second < 1.05 * first
    finer, _ = energy_errors(Verlet(), model, 5.0, 0.025)
    assert np.log2(first / finer) > 1.8


def test_mean_velocities_are_limited_where_the_paper_limits_them() -> None:
    """Node view and rows use (q_{k+1} - q_k) / h; nodal velocities may then exceed the limit, and do."""
    case = config.compose(
        "+scenario=static",
        "scenario.intervals=20",
        "dynamics.velocity=mean",
        "compile=never",
        "strategy=phases",
    )
    plan = pose(phases(case, straight_line(case)), case, Ledger(60.0), "mean").plan
    means = np.diff(plan.configuration, axis=0) / np.diff(plan.time)[:, None]
    limits = case.scenario.planned_rates(case.model)
    assert np.all(np.abs(means) <= limits.upper * (1 + 1e-6))
    assert np.any(np.abs(plan.velocity) > 1.2 * limits.upper), "what the mean hides"

    trajectory = transcribe(Verlet(velocity="mean"), case.model, one_phase(N, SECONDS)).trajectory
    node = trajectory.node
    view = ca.Function("view", [node.z, node.p], [node.velocity])
    q, _, _ = random_flight(1)
    for (a, b), p in zip(pairwise(q), trajectory.parameters(range(N)), strict=True):
        np.testing.assert_allclose(
            np.asarray(view(np.concatenate([a, b, [SECONDS]]), p)).ravel(), (b - a) / H
        )
