"""Replanning: the numbers of a new situation, put into a program that was built once, give what a fresh solve gives."""

from __future__ import annotations

import runpy
from pathlib import Path

import composing
import numpy as np
import pytest

from benchbench.formulation.handover import phases
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput, IncompatibleCase
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.program import assemble
from benchbench.nlp.solver import TOLERANCE
from benchbench.ocp.motion import Kind, Motion, same_kind
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case
from benchbench.planning.followed import followed
from benchbench.planning.guess import straight_line
from benchbench.planning.replan import Replanner, moved, renumbered
from benchbench.planning.result import Result
from benchbench.planning.shift import Shift
from benchbench.planning.strategy import pose
from benchbench.transcription.grid import Grid, Phase
from benchbench_plugins.motions import Circle, Combined, Fixed, Linear

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "replanning.py"
SMALL = ("scenario.intervals=24", "scenario.contact_seconds=0.1", "compile=never")
TARGETS: dict[str, Motion] = {
    "static": Fixed((1.1, 0.1, 0.4)),
    "linear": Linear((0.92, 0.0, 0.4), (0.1, 0.02, 0.0)),
    "circle": Circle((1.0, 0.05, 0.4), 0.4, -0.35, 1.4),
}


def state(plan: Plan, at: float) -> tuple[Array, Array]:
    """Configuration and velocity of a plan at a time in s."""
    q, v = (np.array([np.interp(at, plan.time, c) for c in a.T]) for a in (plan.configuration, plan.velocity))
    return q, v


def fresh(case: Case) -> Result:
    return pose(phases(case, straight_line(case)), case, Ledger(60.0), "fresh")


@pytest.mark.parametrize("name", TARGETS)
def test_replanned_travel_time_is_that_of_a_fresh_solve(name: str) -> None:
    replanner = Replanner(composing.case_of(f"+scenario={name}", *SMALL))
    q, v = state(replanner.first.plan, 0.1)
    answer = replanner.plan(TARGETS[name], q, v, elapsed=0.1)
    again = fresh(answer.case)
    assert not answer.cold and answer.result.solved.outcome.claim == "solved"
    assert answer.result.solved.outcome.iterations < again.solved.outcome.iterations
    assert abs(answer.plan.travel_time - again.plan.travel_time) < 1e-4
    np.testing.assert_allclose(answer.plan.velocity[0], v, atol=1e-9)
    by_name = {check.name: check for check in answer.certificate().checks}
    asked = ("residual", "planned_start", "planned_start_rest", "planned_end", "contact_node_position")
    assert all(by_name[check].ok for check in asked)


@pytest.mark.parametrize("name", TARGETS)
def test_renumbered_problem_is_the_one_built_anew(name: str) -> None:
    case = composing.case_of(f"+scenario={name}", *SMALL)
    old = phases(case, straight_line(case))
    q = case.scenario.start_point(case.model) + 0.01
    new = moved(case, TARGETS[name], q, np.linspace(-0.1, 0.1, 7), Kind(TARGETS[name]))
    built = phases(new, straight_line(new))
    assert renumbered(old, new, TARGETS[name]).mpcc.digest == built.mpcc.digest != old.mpcc.digest


def test_parameters_of_a_program_are_the_constants_of_another() -> None:
    case = composing.case_of("+scenario=linear", *SMALL)
    old, new = (
        phases(c, straight_line(c)).mpcc
        for c in (case, moved(case, TARGETS["linear"], np.ones(7), np.zeros(7), Kind(TARGETS["linear"])))
    )
    open_, constant = assemble(old, "never", tuple(case.scenario.contacts)), assemble(new, "never")
    p, x = open_.numbers(new, 0.0), new.guess + 0.01
    lam = np.linspace(-1.0, 1.0, len(constant.lower_g))
    for name, more in (("gradient", ()), ("jacobian", ()), ("hessian", (1.0, lam))):
        ours, theirs = (getattr(g, name).call([x, n, *more]) for g, n in ((open_, p), (constant, [0.0])))
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_allclose(np.asarray(a.T), np.asarray(b.T), rtol=1e-12, atol=1e-12)
    now = open_.moved(new)
    np.testing.assert_array_equal(now.lower_x, constant.lower_x)
    np.testing.assert_array_equal(now.upper_g, constant.upper_g)


def test_shift_reads_the_old_plan_later() -> None:
    """A function of time, sampled at nodes and in the middle of intervals, is met where it is linear."""
    grid = Grid((Phase("a", 4, 0, 9, 1.0), Phase("b", 2, 0, 9, 1.0), Phase("c", 3, 0, 9, 1.0)))
    duration = np.array([2.0, 0.5, 1.5])
    shift = Shift(grid, duration, 0.3)
    old, new = grid.time_weights @ duration, 0.3 + grid.time_weights @ shift.rest
    np.testing.assert_allclose(shift.rows(old[:, None])[:, 0], new, atol=1e-14)
    middle, later = (old[1:] + old[:-1]) / 2, (new[1:] + new[:-1]) / 2
    inside = later >= middle[0]
    np.testing.assert_allclose(shift.rows(middle[:, None])[inside, 0], later[inside], atol=1e-14)
    np.testing.assert_array_equal(shift.rows(np.eye(3)), np.eye(3))
    still = Shift(grid, duration, 0.0)
    np.testing.assert_allclose(still.rows(old[:, None]), old[:, None], atol=1e-14)


def test_a_start_goes_with_its_target() -> None:
    """Tool and target are as far apart in contact as before, ends stay, and speeds are those of the places."""
    case = composing.case_of("+scenario=linear", *SMALL)
    problem = phases(case, straight_line(case))
    way, x = np.array([0.03, -0.02, 0.01]), problem.mpcc.guess
    assert problem.contact is not None
    (nodes,) = problem.contact.values()
    before = problem.mpcc.split(x)
    time = problem.trajectory.grid.time_weights @ before["T"].ravel()
    after = problem.mpcc.split(followed(problem, case.model, x, lambda t: t[:, None] * way))
    change = after["q"] - before["q"]
    np.testing.assert_allclose(change[list(nodes), :3], time[list(nodes), None] * way, atol=1e-12)
    assert not change[[0, -1]].any() and not change[:, 3:].any()
    moved_by = np.cumsum(
        np.diff(time)[:, None] * ((after["v"] - before["v"])[1:] + (after["v"] - before["v"])[:-1]) / 2,
        axis=0,
    )
    np.testing.assert_allclose(moved_by, change[1:], atol=2e-3)
    np.testing.assert_array_equal(after["u"], before["u"])


def test_a_replan_stays_as_far_from_bounds_as_its_accuracy_needs() -> None:
    """Slack times multiplier is about mu, which goes no further down than the tolerance asks."""
    replanner = Replanner(composing.case_of("+scenario=linear", *SMALL, "accuracy=low"))
    answer = replanner.plan(TARGETS["linear"], *state(replanner.first.plan, 0.0))
    mpcc, outcome = answer.result.problem.mpcc, answer.result.solved.outcome
    assert outcome.claim == "solved" and outcome.point.lam_x is not None
    slack = np.minimum(outcome.point.x - mpcc.lower, mpcc.upper - outcome.point.x)
    bound = np.isfinite(slack) & (mpcc.upper > mpcc.lower) & (np.abs(outcome.point.lam_x) > 1e-3)
    products = np.abs(outcome.point.lam_x[bound]) * slack[bound]
    assert TOLERANCE["low"] / 100 < np.median(products) < TOLERANCE["low"]


def test_the_example_follows_its_target(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(EXAMPLE))["main"](intervals=24)
    lines = [line for line in capsys.readouterr().out.splitlines() if "end in" in line]
    turns = np.array(["the target turns" in line for line in lines])
    ends = np.array([float(line.split("end in ")[1].split(" s")[0]) for line in lines])
    assert turns.sum() == 2
    sooner = -np.diff(ends)[~turns[1:]]
    assert np.all(np.abs(sooner - 0.05) < 0.01), (
        "50 ms later the end is nearer by 50 ms, but where the target turns"
    )


def test_bad_input_is_explained() -> None:
    replanner = Replanner(composing.case_of("+scenario=static", *SMALL))
    q, v = state(replanner.first.plan, 0.0)
    with pytest.raises(BadInput, match="another kind"):
        replanner.plan(TARGETS["linear"], q, v)
    line, round_ = TARGETS["linear"], TARGETS["circle"]
    assert same_kind(Combined((line, round_)), Combined((line, round_)))
    assert not same_kind(Combined((line, round_)), Combined((round_, line))), "as many numbers"
    with pytest.raises(BadInput, match="contact has begun"):
        replanner.plan(TARGETS["static"], q, v, elapsed=5.0)
    with pytest.raises(BadInput, match="elapsed: nan was given"):
        replanner.plan(TARGETS["static"], q, v, elapsed=float("nan"))
    with pytest.raises(BadInput, match=r"q: .* 7 numbers: x, y, z"):
        replanner.plan(TARGETS["static"], q[:6], v)
    with pytest.raises(BadInput, match=r"v: .* 7 numbers: x, y, z"):
        replanner.plan(TARGETS["static"], q, np.full(7, np.nan))
    with pytest.raises(IncompatibleCase, match="builds each problem anew"):
        Replanner(composing.case_of("+scenario=static", "solver=sqpmethod", *SMALL))
    with pytest.raises(IncompatibleCase, match="no single target"):
        Replanner(composing.case_of("+scenario=race"))
