"""Strategies made of several solves: against exhaustive scans, against what they start from, against themselves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import composing
import numpy as np
import pytest

from benchbench.certificate.window_bound import window_bounds
from benchbench.formulation.handover import fixed_window, phase_grid, phases
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput, IncompatibleCase
from benchbench.nlp.ledger import Ledger
from benchbench.nlp.warm_start import carried
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan
from benchbench.planning.case import Case
from benchbench.planning.guess import first_plan, straight_line
from benchbench.planning.result import Result
from benchbench.planning.strategy import judge, planned, pose
from benchbench.planning.windows import Windows, coarser
from benchbench.run import pipeline
from benchbench.storage.recording import write_mcap

N = 12
SMALL = (f"scenario.intervals={N}", "iteration_limit=150")


def case_of(*overrides: str) -> Case:
    return composing.case_of("+scenario=static", *SMALL, *overrides)


def solve(case: Case) -> Result:
    return planned(case.strategy, case, Ledger(case.time_limit))


@pytest.fixture(scope="module")
def scan() -> dict[int, Result]:
    """Every window of a small grid, each solved from a straight line, without bounds and neighbours."""
    case = case_of("scenario.rate_margin.arm=0", "scenario.contact_margin.position=0")
    found = {}
    for k in range(N - 1):
        line = straight_line(case)
        progress = np.zeros(N + 1)
        progress[k : k + 2] = 1.0
        problem = fixed_window(case, replace(line, progress=progress), (k, k + 1))
        found[k] = pose(problem, case, Ledger(60.0), f"{k}")
    return found


@pytest.mark.usefixtures("brief_replays")
@pytest.mark.parametrize("exhaustive", [pytest.param(True, marks=pytest.mark.slow), False])
def test_enumeration_finds_the_best_of_all_windows(scan: dict[int, Result], exhaustive: bool) -> None:
    best = min(result.objective for result in scan.values())
    found = solve(case_of("strategy=enumeration", "strategy.margin=0", f"strategy.exhaustive={exhaustive}",
                          "scenario.rate_margin.arm=0", "scenario.contact_margin.position=0"))  # fmt: skip
    assert found.objective == pytest.approx(best, rel=1e-6)
    told = found.account["search"]
    assert told.startswith(f"{N - 1} windows: ")
    assert ("all were tried" in told) == exhaustive


def test_bounds_of_windows_are_below_every_solution(scan: dict[int, Result]) -> None:
    case = case_of()
    first = np.arange(N - 1) / N
    bounds = window_bounds(case.scenario, case.model, case.limits, first, first + 1 / N)
    solved = {k: result.plan.travel_time for k, result in scan.items() if result.claimed}
    assert len(solved) >= N // 2
    assert all(bounds[k] <= travel_time for k, travel_time in solved.items())
    assert np.all(np.diff(bounds[:4]) <= 0) and np.all(np.diff(bounds[-4:]) >= 0), (
        "late or early contact costs time"
    )


def twice_as_fine(case: Case) -> Case:
    return replace(case, scenario=case.scenario.model_copy(update={"intervals": 2 * N}))


def test_the_next_grid_begins_in_the_valley(scan: dict[int, Result]) -> None:
    """At the middle of the best window, moved by at most half a node to the cheaper neighbour."""
    case = case_of()
    windows = Windows(case, Ledger(60.0), straight_line(case), found=dict(scan))
    best = windows.centre
    towards = np.sign(scan[best - 1].objective - scan[best + 1].objective)
    assert 0 < towards * (windows.valley * N - (best + 0.5)) <= 0.5
    finer = Windows(twice_as_fine(case), Ledger(60.0), windows.best.plan)
    assert finer.first_at(windows.valley) in (2 * best, 2 * best + 1)


def test_multipliers_are_carried_to_the_next_grid(scan: dict[int, Result]) -> None:
    """Both halves of an interval start from its multipliers; the solution is that of a start without."""
    fine = twice_as_fine(case_of())
    coarse = min(scan.values(), key=lambda result: result.objective)
    k = 2 * min(scan, key=lambda k: scan[k].objective)
    warm, cold = (Windows(fine, Ledger(60.0), coarse.plan, known).solve(k) for known in (coarse, None))
    assert warm.objective == pytest.approx(cold.objective, rel=1e-6)
    new = of_rows(warm, carried(warm.problem.mpcc, coarse.solved.relaxed, coarse.solved.outcome.point).lam_g)
    old = of_rows(coarse, coarse.solved.outcome.point.lam_g)
    assert np.abs(old).max() > 0
    assert np.array_equal(new[0::2], old) and np.array_equal(new[1::2], old)


def of_rows(result: Result, lam_g: Array | None) -> Array:
    """Multipliers of the dynamics, one row per interval."""
    blocks = result.problem.mpcc.constraints
    assert lam_g is not None
    parts = np.split(lam_g, np.cumsum([block.lower.size for block in blocks])[:-1])
    return next(
        part.reshape(block.lower.shape)
        for block, part in zip(blocks, parts, strict=True)
        if block.name == "verlet_leaving"
    )


@pytest.mark.slow
def test_coarse_to_fine_finds_the_window_of_an_exhaustive_search() -> None:
    """On 10, 20 and 40 intervals; an error in what one grid hands to the next leads to another window."""
    search = ("strategy=enumeration", "strategy.margin=0", "scenario.intervals=40")
    one = solve(case_of(*search, "strategy.levels=1", "strategy.exhaustive=true"))
    for levels in (2, 3):
        many = solve(case_of(*search, f"strategy.levels={levels}"))
        assert len(list(coarser(case_of("scenario.intervals=40"), levels))) == levels
        assert many.plan.contacts == one.plan.contacts
        assert many.objective == pytest.approx(one.objective, rel=1e-6)


@pytest.mark.parametrize("strategy", ["enumeration", "polish"])
def test_searching_for_one_contact_refuses_several_before_it_solves(strategy: str) -> None:
    case, ledger = (
        composing.case_of("+scenario=delivery", f"strategy={strategy}", "guess=phases"),
        Ledger(60.0),
    )
    with pytest.raises(IncompatibleCase, match="one contact"):
        planned(case.strategy, case, ledger)
    assert not ledger.solves


@pytest.mark.parametrize("strategy", ["enumeration", "polish"])
@pytest.mark.parametrize(
    ("overrides", "problem"),
    [
        (
            ("+scenario=detour", "~scenario.stops.kiosk", "scenario.stops.cart.reward=1.5"),
            "where the contact is, not whether",
        ),
        (("+scenario=static", "scenario.contact_seconds=0.1"), "at kappa_init nodes, not for 0.1 s"),
    ],
)
def test_searching_for_windows_refuses_what_windows_do_not_say(
    strategy: str, overrides: tuple[str, ...], problem: str
) -> None:
    case, ledger = composing.case_of(*overrides, f"strategy={strategy}"), Ledger(60.0)
    with pytest.raises(IncompatibleCase, match=problem):
        planned(case.strategy, case, ledger)
    assert not ledger.solves


def test_relaxations_refuse_a_contact_that_lasts_for_seconds() -> None:
    case, ledger = composing.case_of("+scenario=delivery", "strategy=relax", "guess=line"), Ledger(60.0)
    with pytest.raises(IncompatibleCase, match=r"belt_contact at kappa_init nodes, not for 0\.2 s"):
        planned(case.strategy, case, ledger)
    assert not ledger.solves


@pytest.mark.parametrize(
    ("strategy", "intervals"),
    [
        ("relax", 50),
        pytest.param("enumeration", 50, marks=pytest.mark.slow),
        pytest.param("enumeration strategy.levels=1 dynamics=trapezoidal", 60, marks=pytest.mark.slow),
    ],
)
def test_where_the_certificate_refuses_a_strategy_goes_on_in_its_own_form(
    strategy: str, intervals: int
) -> None:
    """On a grid that is too coarse for either: with margins or on a finer one, equal steps still, and its travel time is comparable."""
    case = composing.case_of(
        "+scenario=static", *f"strategy={strategy}".split(), f"scenario.intervals={intervals}"
    )
    found = solve(case)
    assert judge(found, case, Ledger(60.0)).certified and found.refined
    steps = np.diff(found.plan.time)
    assert found.plan.intervals > intervals and steps == pytest.approx(steps[0], rel=1e-6)
    told = found.account["refinement"]
    assert told[0].startswith(f"N = {intervals}") and told[-1].endswith("certified")
    assert ", corrected" in told[-1], "errors of the transcription are taken off there, too"
    assert "certified" not in told[0]


def test_with_stages_a_race_is_relaxed_on_a_coarse_grid_first() -> None:
    """Gates that move along the nodes of the grid itself take hundreds of iterations; the last sigma from the coarse plan does not."""
    only = ("strategy.finer=1", "strategy.margin=1e-9")  # nothing that comes after
    race = ("+scenario=race", "scenario.gates=2", "scenario.nodes_per_gate=16")
    case = composing.case_of(*race, "strategy=relax", "dynamics=hermite_simpson", *only)
    ledger = Ledger(60.0)
    found = planned(case.strategy, case, ledger)
    stages = [spent.stage for spent in ledger.solves]
    assert found.claimed and stages.count("relaxation") == len(case.relaxation.schedule)
    last = stages.index(f"N = {case.scenario.grid_intervals}")
    assert stages[last - 1] == "relaxation" and ledger.relaxed


@pytest.mark.parametrize("seed", [4, 7])
def test_phases_finds_the_best_known_plan_from_a_disturbed_start(seed: int) -> None:
    """Two of the 90 runs of docs/strategies.md, on the default grid."""
    record = pipeline.run(composing.case_of("+scenario=linear", f"seed={seed}")).record
    assert record["certified"]
    assert record["gap_percent"] <= 0.5


@pytest.mark.slow
@pytest.mark.usefixtures("brief_replays")
def test_polish_moves_an_early_contact_to_the_best_window() -> None:
    early = ("guess=line", "scenario.contact_guess=0.2", "scenario.intervals=20")
    relaxed, polished, best = (
        solve(case_of(f"strategy={name}", "strategy.margin=0", *more, *early))
        for name, *more in (["relax"], ["polish", "strategy.after.margin=0"], ["enumeration"])
    )
    assert polished.plan.contacts == best.plan.contacts != relaxed.plan.contacts
    assert polished.objective == pytest.approx(best.objective, rel=1e-6)
    assert polished.objective < relaxed.objective


def test_polish_gives_no_certified_plan_away_for_a_cheaper_one() -> None:
    """Without margins, the polished plan exceeds the arm's rate; that of relax has the scenario's margins."""
    case = composing.case_of("+scenario=circle", "strategy=polish", "strategy.margin=1e-9")
    assert judge(solve(case), case, Ledger(60.0)).certified


def test_phases_without_success_returns_the_attempt_with_the_whole_limit() -> None:
    case = composing.case_of(
        "+scenario=static",
        "strategy=phases",
        "strategy.patience=5",
        "strategy.attempts=2",
        "iteration_limit=20",
    )
    found = solve(case)
    assert not found.claimed
    assert found.solved.outcome.iterations == 20


def test_refine_stops_when_it_has_settled() -> None:
    case = composing.case_of(
        "+scenario=static", "strategy=refine", "strategy.coarsest=100", "strategy.finest=400"
    )
    found = solve(case)
    assert found.plan.intervals == 200
    assert judge(found, case, Ledger(60.0)).certified
    assert [line.split(":")[0] for line in found.account["refinement"]] == [
        "N = 100",
        "N = 200",
        "settled within 0.50%",
    ]


def test_refine_stops_at_the_finest_grid_without_a_certificate() -> None:
    done = pipeline.run(case_of("strategy=refine", "strategy.coarsest=8", "strategy.finest=20"))
    assert done.record["intervals"] == 16
    assert [line.split(", ")[1] for line in done.record["refinement"]] == ["not certified", "not certified"]
    assert done.record["task_hash"] is None, "on another grid than the scenario's"


def test_refine_refuses_contacts_that_do_not_fit_into_its_coarsest_grid() -> None:
    case = composing.case_of("+scenario=static", "strategy=refine", "scenario.kappa_init=95")
    with pytest.raises(BadInput, match="25 nodes in contact do not fit into 25 intervals"):
        solve(case)


def test_phases_refuses_a_start_without_the_contact(tmp_path: Path) -> None:
    """One that claims none, and the plan of a scenario with other stops; a detour may be left out."""
    other = composing.case_of("+scenario=two_free", "scenario.intervals=20")
    write_mcap(tmp_path / "plan.mcap", straight_line(other), None, other.scenario, other.model, {})
    for guess in ("guess=neutral", "guess=previous guess.path=" + str(tmp_path / "plan.mcap")):
        case = case_of("strategy=phases", *guess.split())
        with pytest.raises(IncompatibleCase, match="touches none of target"):
            solve(case)
    phases(composing.case_of("+scenario=detour"), replace(straight_line(other), progress=np.zeros((21, 2))))


@pytest.mark.usefixtures("brief_replays")
def test_multistart_is_reproducible_and_counts() -> None:
    overrides = ("strategy=multistart", "strategy.starts=2", "strategy.of.margin=0", "seed=3")
    one, again = (solve(case_of(*overrides)) for _ in range(2))
    assert one.account == again.account
    assert np.array_equal(one.plan.configuration, again.plan.configuration)
    assert one.account["starts"] == 2
    assert one.account["starts_low"] <= one.account["starts_certified"] / 2 <= one.account["starts_high"]
    alone = [solve(case_of("strategy=phases", "strategy.margin=0", f"seed={seed}")) for seed in (6, 7)]
    assert one.objective == min(result.objective for result in alone)
    assert sum(int(text.split(": ")[1].split()[0]) for text in one.account["optima"]) == 2


def test_strategies_nest_and_are_named_so() -> None:
    case = case_of("strategy=multistart", "strategy@strategy.of=polish", "strategy@strategy.of.after=relax")
    assert case.names["strategy"] == "multistart(polish(relax))"
    assert case.names["guess"] == "phases", "the innermost strategy chooses the guess"
    assert case_of("strategy=polish", "guess=line").names["guess"] == "line"


def test_margins_follow_the_replay() -> None:
    bare, held = (
        composing.case_of("+scenario=circle", "strategy=phases", f"strategy.margin={most}")
        for most in (1e-9, 0.5)
    )
    first, second = (solve(case) for case in (bare, held))
    assert [check.name for check in judge(first, bare, Ledger(60.0)).checks if not check.ok] == [
        "replay_rate"
    ]
    assert judge(second, held, Ledger(60.0)).certified
    assert 0 < second.plan.travel_time - first.plan.travel_time < 0.002


def test_margins_are_measured_on_top_of_those_by_hand() -> None:
    """By hand the arm stays a little below its limit, which is too little on `circle`; and the hand has 18 of 20 mm."""
    by_hand = ("scenario.rate_margin.arm=1e-4", "scenario.contact_margin.position=0.1")
    case = composing.case_of("+scenario=circle", "strategy=phases", *by_hand)
    found = solve(case)
    assert judge(found, case, Ledger(60.0)).certified
    arm = case.model.velocity.names.index("arm")
    rate = np.abs(found.plan.velocity[:, arm]).max() / case.model.velocity.upper[arm]
    assert 1 - 0.002 < rate < 1 - 1.1e-4, "about what the replay asks for, beyond what was given"
    (first, last), (stop,) = found.plan.contacts[0], case.scenario.itinerary.stops
    place, way = sample(stop.target, found.plan.time)
    gap = stop.contacts["position"].gap(
        case.model.plant(), found.plan.configuration, found.plan.velocity, place, way
    )
    assert gap[first : last + 1].max() <= 0.018 + 1e-6


def test_phases_are_as_long_as_in_the_plan_they_start_from() -> None:
    case = case_of("seed=4")
    start = first_plan(case, Ledger(60.0))
    grid, _, _ = phase_grid(case, start, case.scenario.itinerary.listed)
    first, last = start.contacts[0]
    assert grid.phases[0].guess == pytest.approx(start.time[[first, last]].mean())
    assert start.travel_time != pytest.approx(case.scenario.travel_time_guess, rel=1e-3)


def test_seed_zero_is_the_guess_itself() -> None:
    case = case_of()
    plan = straight_line(case)
    assert np.array_equal(first_plan(case, Ledger(60.0)).configuration, plan.configuration)


def test_previous_reads_the_plan_of_a_run(tmp_path: Path) -> None:
    case = case_of()
    plan = straight_line(case)
    write_mcap(tmp_path / "plan.mcap", plan, None, case.scenario, case.model, {})
    read: Plan = first_plan(case_of("guess=previous", f"guess.path={tmp_path}"), Ledger(60.0))
    assert np.allclose(read.configuration, plan.configuration)
    with pytest.raises(BadInput, match=r"guess\.path"):
        first_plan(case_of("guess=previous", f"guess.path={tmp_path / 'none'}"), Ledger(60.0))
