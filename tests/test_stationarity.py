"""Stationarity of points whose class is worked out by hand, and against pympcc's own enumeration of branches."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import OptimizeResult, lsq_linear, milp
from small_mpccs import by_hand, problem, pympcc_problems

from benchbench.certificate import descent, multipliers
from benchbench.certificate import stationarity as stationarity_module
from benchbench.certificate.descent import b_stationary
from benchbench.certificate.linearised import Linearised, Tangent
from benchbench.certificate.multipliers import classify, weak
from benchbench.certificate.stationarity import Stationarity, stationarity
from benchbench.mpcc.problem import Mpcc, PairKind
from benchbench.nlp.ledger import Ledger
from benchbench.planning.strategy import planned
from benchbench.run import config, pipeline


def corner(cost: Callable, kind: PairKind = "complementarity", **more: Any) -> Mpcc:
    """Minimise a cost with the pair (x_0, x_1): its multipliers at the origin are the partial derivatives."""
    return problem([0.0, 0.0], cost, lambda x: [x[0]], lambda x: [x[1]], kind=kind, **more)


def linear(a: float, b: float) -> Callable:
    return lambda x: a * x[0] + b * x[1]


def at(mpcc: Mpcc, *x: float) -> Stationarity:
    return stationarity(mpcc, np.array(x))


ORIGIN = [  # grad f = (gamma, nu), unique, since the two gradients are independent: B means S
    (1, 1, "S", "yes"), (1, 0, "S", "yes"), (0, 0, "S", "yes"),
    (-1, 0, "M", "no"), (0, -1, "M", "no"),
    (-1, -1, "C", "no"),
    (1, -1, "W", "no"), (-2, 3, "W", "no"),
]  # fmt: skip


@pytest.mark.parametrize(("a", "b", "kind", "descends"), ORIGIN)
def test_every_class_at_a_corner(a: float, b: float, kind: str, descends: str) -> None:
    found = at(corner(linear(a, b)), 0.0, 0.0)
    assert (found.kind, found.b_stationary) == (kind, descends)
    assert found.kkt_residual < 1e-12


@pytest.mark.parametrize(("a", "b", "kind", "descends"), ORIGIN)
def test_what_a_relaxation_leaves_of_a_corner(a: float, b: float, kind: str, descends: str) -> None:
    """G = H = sqrt(sigma) instead of 0."""
    found = at(corner(linear(a, b)), 3e-5, 3e-5)
    assert (found.kind, found.b_stationary) == (kind, descends)


@pytest.mark.parametrize(
    ("off", "zero"), [(0.0, 1e-8), (1e-8, 1e-8), (2e-8, 1e-6), (1e-6, 1e-6), (3e-5, 1e-4), (1e-4, 1e-4)]
)
@pytest.mark.parametrize("nu", [1, -1])
def test_what_counts_as_zero_is_at_least_the_error_of_the_point(off: float, zero: float, nu: int) -> None:
    found = at(corner(linear(1, nu)), off, off)
    assert (found.kind, found.active) == ("S" if nu > 0 else "W", zero)


def test_a_point_that_is_too_far_off_is_not_classified() -> None:
    far = at(corner(linear(1, 1)), 1.01e-4, 1.01e-4)
    assert (far.kind, far.b_stationary) == ("undecided", "undecided")
    assert np.isnan(far.kkt_residual) and np.isnan(far.active)


def test_out_of_time_it_says_what_it_took_for_zero() -> None:
    late = stationarity(corner(linear(1, 1)), np.zeros(2), 0.0)
    assert (late.kind, late.b_stationary, late.active) == ("undecided", "undecided", 1e-8)


def test_on_an_arm_the_other_multiplier_is_zero() -> None:
    """At (1, 0): grad f = nu (0, 1), of any sign; a part along x_0 is a residual."""
    assert at(corner(linear(0, -3)), 1.0, 0.0).kind == "S"
    found = at(corner(linear(-0.5, 1)), 1.0, 0.0)
    assert (found.kind, found.b_stationary) == ("none", "no")
    assert found.kkt_residual == pytest.approx(0.5)
    assert found.record() == {
        "kkt_residual": found.kkt_residual, "stationarity": "none", "b_stationary": "no"
    }  # fmt: skip


VANISHING = [  # x_0 >= 0, x_0 x_1 <= 0 at the origin: grad f = gamma (1, 0) - mu (0, 1), mu >= 0 already for W
    (1, 0, "S", "yes"), (0, 0, "S", "yes"),
    (-1, 0, "M", "no"),  # into x_0 > 0 along x_1 = 0
    (0, -1, "M", "no"), (-1, -1, "C", "no"),
    (1, -1, "W", "no"),  # up, x_1 > 0, with x_0 = 0
    (0, 1, "none", "no"),  # down, x_1 < 0, is always allowed
]  # fmt: skip


@pytest.mark.parametrize(("a", "b", "kind", "descends"), VANISHING)
def test_every_class_of_a_vanishing_pair(a: float, b: float, kind: str, descends: str) -> None:
    found = at(corner(linear(a, b), "vanishing"), 0.0, 0.0)
    assert (found.kind, found.b_stationary) == (kind, descends)


@pytest.mark.parametrize(
    ("x", "a", "b", "kind"),
    [
        ((0.0, 1.0), -1, 0, "S"),  # H > 0: G = 0 is an equation
        ((0.0, -1.0), 1, 0, "S"),  # H < 0: only G >= 0
        ((0.0, -1.0), -1, 0, "none"),
        ((1.0, 0.0), 0, -1, "S"),  # G > 0: H <= 0
        ((1.0, 0.0), 0, 1, "none"),
        ((1.0, -1.0), 0, 0, "S"),  # nothing is active
    ],
)
def test_a_vanishing_pair_away_from_the_corner(x: tuple[float, ...], a: float, b: float, kind: str) -> None:
    assert at(corner(linear(a, b), "vanishing"), *x).kind == kind


def named(name: str) -> Mpcc:
    return next(small.mpcc for small in by_hand() if small.name == name)


def test_known_points_of_the_literature() -> None:
    """Their notes in small_mpccs.py say what is known of them."""
    assert at(named("ralph2"), 0, 0).kind == "S"
    assert at(named("scholtes3"), 0, 0).kind == "C"
    assert at(named("weak"), 0, 0).kind == "W"
    assert at(named("cubic"), 0, 0).kind == "M"
    assert at(named("academic"), 0, 5).kind == "S"
    found = at(named("academic"), 0, 5 * np.sqrt(2))  # (4, 2) = gamma (1, 0) + mu (1, 1): gamma = mu = 2
    assert (found.kind, found.b_stationary) == ("W", "no")  # down along x_0 = 0, where the condition vanishes


def test_b_stationary_without_strong_stationarity() -> None:
    """scholtes4: gamma = 1 - 4 l_1, nu = 1 - 4 l_2 with l_1 + l_2 = 1 add up to -2: M with (0, -2), never S."""
    found = at(named("scholtes4"), 0, 0, 0)
    assert (found.kind, found.b_stationary) == ("M", "yes")


def test_signs_are_searched_where_multipliers_are_not_unique() -> None:
    """Ten copies of scholtes4 that share nothing: 2^10 combinations of M or C, each pair on its own."""
    n = 10

    def cost(x: Any) -> Any:
        return sum(x[3 * i] + x[3 * i + 1] - x[3 * i + 2] for i in range(n))

    def below(x: Any) -> list[Any]:
        return [x[3 * i + 2] - 4 * x[3 * i + j] for i in range(n) for j in range(2)]

    firsts, seconds = (lambda x: [x[3 * i] for i in range(n)]), (lambda x: [x[3 * i + 1] for i in range(n)])
    found = stationarity(problem(np.zeros(3 * n), cost, firsts, seconds, below=below), np.zeros(3 * n))
    assert (found.kind, found.b_stationary) == ("M", "yes")


def test_m_found_by_search_where_least_squares_sees_c() -> None:
    """Cost -x_0 - x_1: the pair once is C; twice, gammas and nus add up to -1 each, and (-1, 0), (0, -1) is M."""
    twice = problem([0.0, 0.0], linear(-1, -1), lambda x: [x[0], x[0]], lambda x: [x[1], x[1]])
    assert at(twice, 0, 0).kind == "M"
    assert at(corner(linear(-1, -1)), 0, 0).kind == "C"


def test_a_bound_that_repeats_the_sign_of_a_pair_changes_nothing() -> None:
    """With x >= 0 counted as well, gamma could be split and C would pass as M."""
    for lower in (-np.inf, 0.0):
        assert at(corner(linear(-1, -1), lower=lower), 0, 0).kind == "C"
        assert at(corner(linear(1, -1), lower=lower), 0, 0).kind == "W"


def test_a_curved_descent_without_licq_is_undecided() -> None:
    """x_0^2 + x_1^2 <= 0 leaves only the origin, but linearised it says nothing: the cost seems to fall along x_0."""
    point = corner(linear(-1, 0), below=lambda x: [x[0] ** 2 + x[1] ** 2])
    assert at(point, 0, 0).b_stationary == "undecided"


def test_out_of_time_and_far_from_feasible_are_undecided() -> None:
    tangent = Linearised(named("scholtes4"))
    active = tangent.active(np.zeros(3), 1e-8)
    found = tangent.tangent(np.zeros(3), active)
    assert classify(found, 1e-6, time.perf_counter() - 1.0) == "undecided"
    assert b_stationary(found, 1e-6, time.perf_counter() - 1.0) == "undecided"
    late = stationarity(corner(linear(1, 1)), np.zeros(2), 0.0)
    assert (late.kind, late.b_stationary) == ("undecided", "undecided") and np.isnan(late.kkt_residual)
    far = at(corner(linear(1, 1)), 0.5, 0.5)
    assert (far.kind, far.b_stationary) == ("undecided", "undecided")
    assert np.isnan(far.kkt_residual)


def test_its_seconds_hold_for_a_flight() -> None:
    """Its first linear program alone takes longer."""
    once = ("strategy=relax", "strategy.margin=0", "guess=line", "scenario.intervals=60")
    case = config.compose("+scenario=static", *once)
    result = planned(case.strategy, case, Ledger(60.0))
    found = stationarity(result.mpcc, result.solved.x, 0.01)
    assert found.kind == found.b_stationary == "undecided"


@pytest.fixture
def limits(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Time limits that programs are given, s, by a clock that says one second more after each of them."""
    given: list[float] = []

    def slow(*arguments: Any, **options: Any) -> OptimizeResult:
        given.append(options["options"]["time_limit"])
        return milp(*arguments, **options)

    for module in (stationarity_module, multipliers, descent):
        monkeypatch.setattr(module, "time", SimpleNamespace(perf_counter=lambda: float(len(given))))
    for module in (multipliers, descent):
        monkeypatch.setattr(module, "milp", slow)
    return given


def test_all_programs_share_one_deadline(limits: list[float]) -> None:
    found = stationarity(corner(linear(1, -1)), np.zeros(2), 20.0)
    assert (found.kind, found.b_stationary) == ("W", "no")
    assert len(limits) > 5 and limits == [20.0 - k for k in range(len(limits))]


@pytest.mark.parametrize("seconds", [0.5, 1.5, 2.5, 3.5])
def test_nothing_is_begun_past_the_deadline(seconds: float, limits: list[float]) -> None:
    found = stationarity(corner(linear(1, -1)), np.zeros(2), seconds)
    assert (found.kind, found.b_stationary) == ("undecided", "undecided")
    assert limits == [seconds - k for k in range(int(seconds) + 1)]


def test_no_rank_is_computed_past_the_deadline(limits: list[float], monkeypatch: pytest.MonkeyPatch) -> None:
    ranks: list[Tangent] = []
    monkeypatch.setattr(Tangent, "independent", property(lambda tangent: not ranks.append(tangent)))
    local = Linearised(corner(linear(-1, 0)))
    curved = dataclasses.replace(local.tangent(np.zeros(2), local.active(np.zeros(2), 1e-8)), affine=False)
    assert b_stationary(curved, 1e-6, 1.5) == "undecided" and not ranks
    assert b_stationary(curved, 1e-6, 20.0) == "no" and ranks


@pytest.mark.parametrize("good", range(3))
def test_a_failed_program_decides_nothing(good: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """All but the first `good` fail, with time left; grad f alone would say "none"."""
    calls: list[int] = []

    def failing(*arguments: Any, **options: Any) -> OptimizeResult:
        calls.append(1)
        return milp(*arguments, **options) if len(calls) <= good else OptimizeResult(x=None, status=4)

    for module in (multipliers, descent):
        monkeypatch.setattr(module, "milp", failing)
    found = at(corner(linear(1, 1)), 0, 0)
    assert (found.kind, found.b_stationary) == ("undecided", "undecided")
    assert np.isnan(found.kkt_residual) == (good == 0)


def soon() -> float:
    return time.perf_counter() + 60.0


def random_tangent(seed: int) -> Tangent:
    """Three pairs of unknowns, random linear cost and inequalities through the origin."""
    random = np.random.default_rng(seed)
    a, c = random.integers(-3, 4, (2, 6)), random.integers(-2, 3, 6)
    mpcc = problem(
        np.zeros(6), lambda x: sum(k * v for k, v in zip(c, x, strict=True)), lambda x: list(x[:3]),
        lambda x: list(x[3:]), below=lambda x: [sum(k * v for k, v in zip(row, x, strict=True)) for row in a],
    )  # fmt: skip
    local = Linearised(mpcc)
    return local.tangent(np.zeros(6), local.active(np.zeros(6), 1e-8))


@pytest.mark.parametrize("seed", range(12))
def test_the_milp_agrees_with_all_branches(seed: int) -> None:
    """All 2^3 branches as least-squares problems of their own (Farkas): no descent if and only if multipliers exist."""
    tangent = random_tangent(seed)
    stationary = []
    for sides in np.ndindex(2, 2, 2):
        low = np.where(tangent.roof, -np.inf, 0.0)
        high = np.where(tangent.floor, np.inf, 0.0)
        for side, rows in zip(sides, tangent.biactive, strict=True):
            low[rows], high[rows] = 0.0, np.inf  # both may not fall ...
            low[rows[side]] = -np.inf  # ... and one of them may not rise either
        fit = lsq_linear(tangent.rows.T.toarray(), tangent.gradient, (low, high), method="bvls")
        stationary.append(fit.cost < 1e-16)
    expected = "yes" if all(stationary) else "no"
    assert b_stationary(tangent, 1e-6, soon()) == expected


@pytest.mark.parametrize("seed", range(4))
def test_the_kkt_residual_is_at_most_that_of_least_squares(seed: int) -> None:
    tangent = random_tangent(seed)
    low, high = (np.where(k, np.inf, 0.0) for k in (tangent.roof, tangent.floor))
    low[tangent.biactive] = high[tangent.biactive] = np.inf
    fit = lsq_linear(tangent.rows.T.toarray(), tangent.gradient, (-low, high), method="bvls")
    scale = max(1.0, np.max(np.abs(tangent.gradient)))
    assert weak(tangent, soon()).residual <= np.max(np.abs(fit.fun)) / scale + 1e-9


def test_pympcc_comes_to_the_same_b_stationarity() -> None:
    """It solves a linear program per branch; both look at the same point, its solution made exactly active."""
    import pympcc
    from pympcc.benchmarks import ALL_PROBLEMS

    agreed = []
    for small, spec in zip(pympcc_problems(), ALL_PROBLEMS, strict=True):
        result = pympcc.solve(spec.problem)
        assert result.obj == pytest.approx(spec.f_opt, abs=1e-3)
        local = Linearised(small.mpcc)
        x = local.snapped(np.asarray(result.x), local.active(np.asarray(result.x), 1e-3))
        g, h = (np.asarray(k(x)) for k in (spec.problem.comp_G, spec.problem.comp_H))
        theirs = pympcc.verify_b_stationarity(dataclasses.replace(result, x=x, G=g, H=h), spec.problem)
        ours = stationarity(small.mpcc, x)
        assert ours.b_stationary == {"B-stationary": "yes", "not B-stationary": "no"}[theirs["status"]], (
            spec.name
        )
        agreed.append(spec.name)
    assert len(agreed) == 13


def test_a_relaxed_flight_is_stationary_and_says_so() -> None:
    """A solution of Scholtes' relaxation for small sigma is near an S-stationary point where MPCC-LICQ holds."""
    case = config.compose(
        "+scenario=static",
        "scenario.intervals=20",
        "strategy=relax",
        "strategy.margin=0",
        "certificate.stationarity=on",
    )
    record = pipeline.run(case).record
    assert record["claimed_success"]
    assert record["kkt_residual"] < 1e-5
    assert (record["stationarity"], record["b_stationary"]) == ("S", "yes")
