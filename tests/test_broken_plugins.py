"""Deliberately broken plugins: each must fail the named check of the conformance suite, and pass no more.

A suite that accepts these says nothing about the plugins it accepts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import casadi as ca
import numpy as np
import pytest
from flights import table_one

from benchbench.conformance.checks import contacts, dynamics, models, orders, relaxations, solvers
from benchbench.conformance.checks.programs import known
from benchbench.conformance.checks.smooth_programs import hs071, quadratic
from benchbench.ground.arrays import Array
from benchbench.mpcc.problem import Mpcc, PairKind
from benchbench.nlp.relaxation import Gap, Relaxation, Relaxed, Unknown
from benchbench.nlp.solver import Outcome, Point, Prepared, Setup, Solver
from benchbench.ocp.contact import Condition, Target
from benchbench.ocp.model import LagrangianModel, Model, Plant
from benchbench.ocp.node import Node
from benchbench.ocp.scenario import Scenario
from benchbench.planning.case import Case
from benchbench.run import config
from benchbench.transcription.dynamics import Dynamics
from benchbench.transcription.grid import Grid, Trajectory
from benchbench.transcription.nodal import NodalTrajectory, cost, each_interval, nodal_variables
from benchbench_plugins.contacts.position import Position
from benchbench_plugins.contacts.velocity import Velocity
from benchbench_plugins.models.aerial_manipulator import AerialManipulator
from benchbench_plugins.models.pendulum import Pendulum
from benchbench_plugins.solvers.ipopt import Ipopt

# ---------------------------------------------------------------- dynamics


@dataclass(frozen=True)
class HandVerlet(Dynamics):
    """Verlet in two-point form written again, with the weights and places of its forces to be spoilt."""

    left: float = 0.5
    right: float = 0.5
    both_at_start: bool = False
    shift: int = 0
    limits: bool = True

    @property
    def order(self) -> int:
        return 2

    def transcribe(self, scenario: Scenario, model: Model, grid: Grid) -> tuple[Mpcc, Trajectory]:
        n = len(model.configuration.names)
        q, v = ca.SX.sym("q", n), ca.SX.sym("v", n)
        lagrangian = model.lagrangian(q, v)
        momentum = ca.Function("p", [q, v], [ca.gradient(lagrangian, v)])
        slope = ca.Function("s", [q, v], [ca.gradient(lagrangian, q)])

        def rule(q0: ca.SX, v0: ca.SX, q1: ca.SX, v1: ca.SX, u: ca.SX, h: ca.SX) -> ca.SX:
            w = (q1 - q0) / h
            shared = (momentum(q0, w) + momentum(q1, w)) / 2
            end = (q0, v0) if self.both_at_start else (q1, v1)
            leaving = (
                momentum(q0, v0) + h / 2 * slope(q0, w) - shared + self.left * h * model.force(q0, v0, u)
            )
            arriving = (
                momentum(q1, v1) - h / 2 * slope(q1, w) - shared - self.right * h * model.force(*end, u)
            )
            return ca.vertcat(leaving, arriving)

        variables = nodal_variables(scenario, model, grid, grid.intervals, self.limits)
        block = each_interval("hand", grid, model, 1, rule, "")
        block = replace(block, parameters=np.roll(block.parameters, -self.shift, axis=0))
        mpcc = Mpcc(variables, (block,), cost(scenario, model, grid, grid.intervals))
        return mpcc, NodalTrajectory(grid, model, "hold")


def test_the_unspoilt_one_passes() -> None:
    for check in (
        orders.check_order,
        orders.check_consistency,
        dynamics.check_reading,
        dynamics.check_cost,
    ):
        check(HandVerlet(), Pendulum())


@pytest.mark.parametrize(
    "broken",
    [HandVerlet(both_at_start=True), HandVerlet(1.0, 0.0), HandVerlet(0.0, 1.0), HandVerlet(0.5, 0.55)],
    ids=["forces at q_k only", "all force on leaving", "all force on arriving", "weights do not sum to one"],
)
@pytest.mark.parametrize("check", [orders.check_order, orders.check_consistency])
def test_force_of_first_order(broken: Dynamics, check: Callable[[Dynamics, Model], str]) -> None:
    with pytest.raises(AssertionError, match="order"):
        check(broken, Pendulum())


def test_force_at_one_end_needs_damping_to_show() -> None:
    """Why the test pendulum is damped: with forces that do not depend on the state the error hides."""
    orders.check_order(HandVerlet(both_at_start=True), Pendulum(damping=0.0))


def test_step_of_the_wrong_interval() -> None:
    """Each interval reads its neighbour's step: no error at all with equal steps, one on three phases."""
    spoilt, model = HandVerlet(shift=1), Pendulum()
    orders.check_order(spoilt, model)
    with pytest.raises(AssertionError, match="order"):
        orders.check_phases(spoilt, model)
    orders.check_phases(HandVerlet(), model)


def test_forgotten_rate_limits() -> None:
    with pytest.raises(AssertionError, match=r"velocity .* passed: not noticed"):
        dynamics.check_limits(HandVerlet(limits=False), Pendulum())


def test_forgotten_limit_of_the_total_time() -> None:
    """The hand-made one has no row for the sum of several phases."""
    with pytest.raises(AssertionError, match=r"flight of .* s: not noticed"):
        dynamics.check_limits(HandVerlet(), Pendulum())


class WrongOrder(HandVerlet):
    """Claims one order too many."""

    @property
    def order(self) -> int:
        return 3


def test_claimed_order_too_high() -> None:
    with pytest.raises(AssertionError, match=r"order 2\.\d+, declared 3"):
        orders.check_order(WrongOrder(), Pendulum())


# ---------------------------------------------------------------- models


class Spoilt(AerialManipulator):  # type: ignore[misc]  # the original is final
    """Servo reaction counted twice: once by the relative angle, once by hand."""

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        return super().force(q, v, u) - ca.vertcat(0, 0, 0, 0, u[4], 0, 0)


def spoilt_model(**changes: Any) -> Spoilt:
    whole = table_one(**changes)
    return Spoilt("spoilt", whole.force_model, **whole.parameters.model_dump())


@pytest.mark.parametrize("check", [models.check_acceleration, models.check_virtual_work])
def test_servo_reaction_counted_twice(check: Callable[[Model], None]) -> None:
    with pytest.raises(AssertionError, match="plant"):
        check(spoilt_model())
    check(table_one())


def test_torques_on_euler_angles() -> None:
    """The paper's force model is an ablation, and no conforming model."""
    with pytest.raises(AssertionError, match="plant"):
        models.check_acceleration(table_one(force_model="paper"))


class Slower(AerialManipulator):  # type: ignore[misc]  # the original is final
    """Says that it comes a third as far as it does."""

    def way_from_rest(self, q: Array, time: Array) -> tuple[Array, Array]:
        back, ahead = super().way_from_rest(q, time)
        return back / 3, ahead / 3


def test_a_way_from_rest_that_is_no_bound() -> None:
    whole = table_one()
    with pytest.raises(AssertionError, match="farther along"):
        models.check_way_from_rest(Slower("slower", **whole.parameters.model_dump()))
    models.check_way_from_rest(whole)
    models.check_way_from_rest(table_one(attitude="quaternion"))


@dataclass(frozen=True)
class OddPendulum(LagrangianModel):
    """A pendulum from another one, with parts replaced."""

    whole: Pendulum = field(default_factory=Pendulum)
    kinetic: float = 1.0
    tilt: float = 0.0
    bias: float = 0.0
    name: str = "odd"

    configuration = property(lambda self: self.whole.configuration)
    velocity = property(lambda self: self.whole.velocity)
    inputs = property(lambda self: self.whole.inputs)

    def lagrangian(self, q: ca.SX, v: ca.SX) -> ca.SX:
        still = self.whole.lagrangian(q, 0 * v)
        return still + self.kinetic * (self.whole.lagrangian(q, v) - still)

    def force(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        return self.whole.force(q, v, u)

    def tool(self, q: ca.SX) -> ca.SX:
        return self.whole.tool(q + self.tilt)

    def nose(self, q: ca.SX) -> ca.SX:
        return self.whole.nose(q)

    def hover(self) -> Array:
        return self.whole.hover() + self.bias

    def plant(self) -> Plant:
        return self.whole.plant()


@pytest.mark.parametrize(
    ("broken", "check", "says"),
    [
        (OddPendulum(kinetic=1.001), models.check_acceleration, "acceleration"),
        (OddPendulum(kinetic=-1.0), models.check_mass_matrix, "eigenvalue"),
        (OddPendulum(tilt=1e-4), models.check_geometry, "tool position"),
        (OddPendulum(bias=9.0), models.check_limits, "breaks the limits"),
        (OddPendulum(Pendulum(torque=(-50.0, 50.0)), bias=9.0), models.check_rest, "at rest"),
    ],
)
def test_spoilt_pendulum(broken: Model, check: Callable[[Model], None], says: str) -> None:
    with pytest.raises(AssertionError, match=says):
        check(broken)


# ---------------------------------------------------------------- contacts


class BareNorm(Position):  # type: ignore[misc]
    """No derivative where the distance is zero."""

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        distance = ca.norm_2(model.tool(node.configuration) - target.position)
        return Condition(distance / self.limit - 1, self.unit, (self.limit,))


class OtherLimit(Velocity):  # type: ignore[misc]
    """Five percent more than it says."""

    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        inner = super().condition(model, node, target)
        return Condition((inner.h + 1) / 1.05**2 - 1, inner.unit, inner.limit)


class TooNear(Position):  # type: ignore[misc]
    """It holds farther away than it says: bounds on the travel time would be wrong."""

    @property
    def reach(self) -> float:
        return 0.9 * self.limit


class OnTheWay(Velocity):  # type: ignore[misc]
    """It holds anywhere, but says that it needs nearness."""

    aside = ""

    @property
    def reach(self) -> float:
        return 0.02


@pytest.mark.parametrize(
    ("broken", "check", "says"),
    [
        (TooNear(0.02), contacts.check_reach, "beyond its reach of 0.018 m"),
        (OnTheWay(0.01), contacts.check_reach, "beyond its reach of 0.02 m"),
        (OnTheWay(0.01), contacts.check_words, "aside is ''"),
        (BareNorm(0.02), contacts.check_smoothness, "not finite"),
        (BareNorm(0.02), contacts.check_scale, "misses the gap"),
        (OtherLimit(0.01), contacts.check_meaning, "disagree"),
        (OtherLimit(0.01), contacts.check_boundary, "at its limit"),
    ],
)
def test_spoilt_contact(broken: Any, check: Callable[[Any, Model], None], says: str) -> None:
    with pytest.raises(AssertionError, match=says):
        check(broken, table_one())


# ---------------------------------------------------------------- relaxations


@dataclass(frozen=True)
class Product(Relaxation):
    """Scholtes' row, with something wrong."""

    excess: float = 0.0
    shift: float = 0.0
    signs: bool = True
    kinked: bool = False
    schedule: tuple[float, ...] = (1e-1, 1e-2, 1e-4, 1e-7)
    kinds: ClassVar[tuple[PairKind, ...]] = ("complementarity", "vanishing")

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, kind: PairKind, gap: Gap | None) -> Relaxed:
        if self.kinked:
            return Relaxed(g + h - ca.sqrt(g**2 + h**2), (-np.inf,), (0.0,))
        row = (g - self.shift) * (h - self.shift) - sigma - self.excess
        return Relaxed(row, (-np.inf,), (0.0,), signs=self.signs)


class Stray(Product):
    """A symbol that nobody knows."""

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, *rest: Any) -> Relaxed:
        inner = super().relax(g, h, sigma, *rest)
        return replace(inner, rows=inner.rows + ca.SX.sym("stray"))


class Unbounded(Product):
    """A guess that is no number."""

    def relax(self, g: ca.SX, h: ca.SX, sigma: ca.SX, *rest: Any) -> Relaxed:
        e = ca.SX.sym("e")
        return Relaxed(
            g * h - e, (-np.inf,), (0.0,), cost=e / sigma, unknowns=(Unknown(e, 0.0, np.inf, 1 / (g * h)),)
        )


@pytest.fixture(scope="module")
def case() -> Case:
    return config.compose("+scenario=static", "solver=ipopt", "compile=never", "iteration_limit=300")


def failures(relaxation: Relaxation, case: Case) -> set[str]:
    found = set()
    for problem in known():
        try:
            relaxations.check_solution(relaxation, problem, case)
        except AssertionError:
            found.add(problem.name)
    return found


def test_the_unspoilt_product_passes(case: Case) -> None:
    for check in relaxations.CHECKS:
        check(Product())
    assert failures(Product(), case) == set()


@pytest.mark.parametrize(
    ("broken", "at_least"),
    [
        (Product(excess=1e-3), {"strict"}),
        (Product(excess=-1e-3), {"biactive", "strict"}),
        (Product(shift=1e-2), {"strict"}),
        (Product(signs=False), {"strict"}),
        (Product(schedule=(1e-1, 1e-2)), {"strict"}),
    ],
    ids=[
        "rows off by 1e-3",
        "feasible points cut off",
        "corner moved",
        "signs forgotten",
        "schedule ends too early",
    ],
)
def test_relaxation_that_solves_another_problem(broken: Relaxation, at_least: set[str], case: Case) -> None:
    assert failures(broken, case) >= at_least


def test_relaxation_without_derivative_in_the_corner() -> None:
    with pytest.raises(AssertionError, match="not finite"):
        relaxations.check_derivatives(Product(kinked=True))


def test_relaxation_with_a_stray_symbol() -> None:
    with pytest.raises(AssertionError, match="stray"):
        relaxations.check_form(Stray())


def test_relaxation_with_an_infinite_guess() -> None:
    with pytest.raises(AssertionError, match="guess"):
        relaxations.check_unknowns(Unbounded())


# ---------------------------------------------------------------- solvers


@dataclass(frozen=True)
class Spoiler(Solver):
    """IPOPT, whose answers go through `spoil(sigma, start, outcome)`."""

    spoil: Callable[[float, Point, Outcome], Outcome]
    setup: Callable[[Setup], Setup] = lambda setup: setup

    def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
        solve = Ipopt().prepare(mpcc, self.setup(setup))
        return lambda sigma, start: self.spoil(sigma, start, solve(sigma, start))

    def native_options(self, setup: Setup) -> dict[str, Any]:
        return Ipopt().native_options(self.setup(setup))

    def version(self) -> str:
        return Ipopt().version()


def always_solved(sigma: float, start: Point, outcome: Outcome) -> Outcome:
    return replace(outcome, claim="solved")


def never_moves(sigma: float, start: Point, outcome: Outcome) -> Outcome:
    return replace(outcome, claim="solved", point=replace(outcome.point, x=start.x))


def other_signs(sigma: float, start: Point, outcome: Outcome) -> Outcome:
    p = outcome.point
    assert p.lam_g is not None and p.lam_x is not None
    return replace(outcome, point=Point(p.x, -p.lam_g, -p.lam_x))


def no_bound_multipliers(sigma: float, start: Point, outcome: Outcome) -> Outcome:
    return replace(outcome, point=replace(outcome.point, lam_x=np.zeros_like(outcome.point.x)))


def inaccurate(sigma: float, start: Point, outcome: Outcome) -> Outcome:
    return replace(outcome, point=replace(outcome.point, x=outcome.point.x + 1e-4))


def counts_nothing(sigma: float, start: Point, outcome: Outcome) -> Outcome:
    return replace(outcome, iterations=0, evaluations=0)


@pytest.mark.parametrize(
    "check",
    [
        solvers.check_infeasible,
        solvers.check_unbounded,
        solvers.check_undefined,
        solvers.check_iteration_limit,
    ],
)
def test_solver_that_always_says_solved(check: Callable[[Solver], None]) -> None:
    with pytest.raises(AssertionError, match=r"claims? (to be )?solved|claimed to be solved"):
        check(Spoiler(always_solved))


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (never_moves, "x: relative error"), (inaccurate, "x: relative error"), (other_signs, "lam"),
        (no_bound_multipliers, "lam_x"), (counts_nothing, "iterations"),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)  # fmt: skip
def test_solver_with_a_wrong_answer(spoil: Callable[[float, Point, Outcome], Outcome], says: str) -> None:
    with pytest.raises(AssertionError, match=says):
        solvers.check_solves(Spoiler(spoil), hs071())
        solvers.check_solves(Spoiler(spoil), quadratic())


def test_solver_that_ignores_sigma() -> None:
    @dataclass(frozen=True)
    class Deaf(Spoiler):
        def prepare(self, mpcc: Mpcc, setup: Setup) -> Prepared:
            solve = Ipopt().prepare(mpcc, setup)
            return lambda sigma, start: solve(1.0, start)

    with pytest.raises(AssertionError, match="sigma"):
        solvers.check_sigma(Deaf(always_solved))


def test_solver_that_ignores_its_limits() -> None:
    generous = Spoiler(lambda sigma, start, outcome: outcome, lambda setup: replace(setup, iterations=1000))
    for check in (solvers.check_iteration_limit, solvers.check_description):
        with pytest.raises(AssertionError, match="iteration"):
            check(generous)
