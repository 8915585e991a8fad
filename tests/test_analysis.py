"""Statistics of the report, against values worked out by hand or published."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest

from benchbench.analysis import naming
from benchbench.analysis.costs import by_step, by_work, comparable, cost_matrix, solve_time
from benchbench.analysis.means import shifted_geometric_mean, three_means
from benchbench.analysis.naming import name_runs
from benchbench.analysis.profiles import data_profile, performance_profile
from benchbench.analysis.wilson import Rate, wilson
from benchbench.run.settings import NOT_DECISIVE
from benchbench.storage.settings import flatten

INF = np.inf


@pytest.mark.parametrize(
    ("successes", "runs", "low", "high"),
    [  # Brown, Cai, DasGupta 2001, eq. (4) with z = 1.959964
        (8, 10, 0.490162, 0.943318),
        (0, 10, 0.0, 0.277533),
        (10, 10, 0.722467, 1.0),
        (1, 1, 0.206549, 1.0),
    ],
)
def test_wilson_intervals(successes: int, runs: int, low: float, high: float) -> None:
    rate = wilson(successes, runs)
    assert (rate.low, rate.high) == pytest.approx((low, high), abs=1e-6)
    z, p = 1.9599639845, successes / runs
    middle = (p + z**2 / (2 * runs)) / (1 + z**2 / runs)
    assert (rate.low + rate.high) / 2 == pytest.approx(middle, abs=1e-9)


@pytest.mark.parametrize(
    ("confidence", "z"), [(0.9, 1.6448536270), (0.95, 1.9599639845), (0.99, 2.5758293035)]
)
def test_wilson_by_its_formula(confidence: float, z: float) -> None:
    rate, p = wilson(3, 4, confidence), 0.75
    half = z * np.sqrt(p * (1 - p) / 4 + z**2 / 64) / (1 + z**2 / 4)
    assert (rate.successes, rate.runs, rate.rate) == (3, 4, p)
    assert (rate.high - rate.low) / 2 == pytest.approx(half, abs=1e-9)


def test_wilson_of_nothing_knows_nothing() -> None:
    assert wilson(0, 0) == Rate(0, 0, None, 0.0, 1.0)


@pytest.mark.parametrize("count", [(-1, 3), (4, 3), (1, 0)])
def test_wilson_refuses_impossible_counts(count: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="successes"):
        wilson(*count)


COSTS = pd.DataFrame({"a": [1.0, 2.0, INF, INF], "b": [2.0, 1.0, 3.0, INF]}, index=["p", "q", "r", "s"])


def test_performance_profile_by_hand() -> None:
    profile = performance_profile(COSTS)
    assert [x.tolist() for x in profile["a"]] == [[1.0, 2.0], [0.25, 0.5]]
    assert [x.tolist() for x in profile["b"]] == [[1.0, 2.0], [0.5, 0.75]]


def test_data_profile_by_hand() -> None:
    assert [x.tolist() for x in data_profile(COSTS)["b"]] == [[1.0, 2.0, 3.0], [0.25, 0.5, 0.75]]
    sizes = pd.Series({"s": 9, "q": 4, "p": 1, "r": 2})
    places, shares = data_profile(COSTS, sizes)["b"]
    assert places.tolist() == [0.2, 1.0]
    assert shares.tolist() == [0.25, 0.75]


def test_a_method_that_never_succeeds_has_an_empty_profile() -> None:
    places, shares = performance_profile(pd.DataFrame({"a": [INF], "b": [1.0]}))["a"]
    assert places.size == shares.size == 0


@pytest.mark.parametrize("cost", [0.0, -1.0, np.nan])
def test_profiles_refuse_costs_that_are_none(cost: float) -> None:
    for profile in (performance_profile, data_profile):
        with pytest.raises(ValueError, match="positive"):
            profile(pd.DataFrame({"a": [cost]}))


def test_shifted_geometric_mean_by_hand() -> None:
    assert shifted_geometric_mean(np.array([1.0, 3.0]), 1.0) == pytest.approx(8**0.5 - 1)
    assert shifted_geometric_mean(np.array([1.0, 4.0]), 0.0) == pytest.approx(2.0)
    assert shifted_geometric_mean(np.array([]), 1.0) is None
    with pytest.raises(ValueError, match="above"):
        shifted_geometric_mean(np.array([0.0]), 0.0)


def test_failures_are_counted_in_three_ways() -> None:
    means = three_means(COSTS, shift=1.0, penalty=7.0)
    assert means["a"].own == pytest.approx(6**0.5 - 1)
    assert means["b"].own == pytest.approx(24 ** (1 / 3) - 1)
    assert means["a"].common == means["b"].common == pytest.approx(6**0.5 - 1)
    assert means["a"].penalised == pytest.approx((2 * 3 * 8 * 8) ** 0.25 - 1)
    assert means["b"].penalised == pytest.approx((3 * 2 * 4 * 8) ** 0.25 - 1)


def test_costs_are_medians_of_repeats_and_failures_infinite() -> None:
    runs = pd.DataFrame(
        {
            "problem": ["p", "p", "p", "q", "q", "p"], "method": ["a", "a", "a", "a", "a", "b"],
            "seconds": [1.0, 5.0, 2.0, 1.0, 1.0, 4.0], "certified": [True, True, True, True, None, False],
        }
    ).astype({"certified": "boolean"})  # fmt: skip
    costs = cost_matrix(runs, "seconds")
    assert costs.loc["p"].tolist() == [2.0, INF]
    assert costs.loc["q", "a"] == INF  # one of two failed
    assert np.isnan(costs.loc["q", "b"])  # never tried is no failure


def test_methods_tried_on_few_problems_do_not_spoil_the_comparison() -> None:
    costs = pd.DataFrame(
        {"a": [1.0, 2.0, INF, 1.0], "odd": [np.nan, np.nan, INF, np.nan], "b": [1.0, 2.0, 1.0, np.nan]},
        index=[*"pqrs"],
    )
    kept = comparable(costs)
    assert (kept.index.tolist(), kept.columns.tolist()) == (["p", "q", "r"], ["a", "b"])
    everything = costs.fillna(1.0)
    assert comparable(everything).equals(everything)
    assert comparable(pd.DataFrame({"a": [1.0, np.nan], "b": [np.nan, 1.0]})).shape == (1, 1)


def test_times_of_repeats_and_of_single_solves_are_never_mixed() -> None:
    runs = pd.DataFrame({"solve_cpu_s": [1.0, 2.0, None], "solve_cpu_median_s": [0.5, 1.5, None]})
    assert solve_time(runs).tolist()[:2] == [0.5, 1.5]
    runs.loc[1, "solve_cpu_median_s"] = None
    assert solve_time(runs).tolist()[:2] == [1.0, 2.0]


PARTS = {
    "build_cpu_s": [3.0, 4.0, None, 5.0], "derivatives_cpu_s": [1.0, None, None, 2.0],
    "solve_cpu_s": [10.0, 20.0, None, 30.0], "functions_cpu_s": [4.0, None, None, None],
    "linear_algebra_cpu_s": [6.0, None, None, None], "certificate_cpu_s": [0.5, 0.25, None, 0.5],
    "guess_cpu_s": [2.0, None, None, 0.0], "homotopy_cpu_s": [3.0, None, None, 0.0],
}  # fmt: skip


def test_parts_of_the_cost_add_up_also_for_old_records_and_silent_solvers() -> None:
    runs = pd.DataFrame(PARTS)  # all known, an old record, a crash, a solver that tells nothing
    whole = runs.build_cpu_s + runs.solve_cpu_s + runs.certificate_cpu_s
    work, step = by_work(runs), by_step(runs)
    assert work.sum(axis=1, min_count=1).equals(whole) and step.sum(axis=1, min_count=1).equals(
        runs.solve_cpu_s
    )
    assert work.loc[0, ["assembly", "build", "solver"]].tolist() == [2.0, 0.0, 0.0]
    assert work.loc[1, ["assembly", "build", "solver"]].tolist() == [0.0, 4.0, 20.0]
    assert step["last solve"].fillna(-1.0).tolist() == [5.0, 0.0, -1.0, 30.0]


def runs_of(*rows: dict[str, Any]) -> pd.DataFrame:
    standard = {
        "scenario": "static", "vehicle": "table1", "dynamics": "verlet", "relaxation": "scholtes", "solver": "ipopt",
        "strategy": "relax", "guess": "line", "intervals": 20, "kappa_init": 2, "seed": 0,
    }  # fmt: skip
    return pd.DataFrame([{**standard, **row} for row in rows])


def test_only_what_differs_is_named() -> None:
    runs = runs_of({}, {"relaxation": "kadrani"}, {"scenario": "circle", "intervals": 30})
    named = name_runs(runs, [None] * 3)
    assert named.method.tolist() == ["scholtes", "kadrani", "scholtes"]
    assert named.task.tolist() == ["static", "static", "circle"]
    assert named.problem.tolist() == ["static, N=20, κ=2", "static, N=20, κ=2", "circle, N=30, κ=2"]


def test_one_run_has_a_name() -> None:
    assert name_runs(runs_of({}), [None]).method.tolist() == ["scholtes / ipopt"]


def test_options_in_which_runs_of_one_choice_differ_are_named() -> None:
    trees = [
        {
            "relaxation": {"schedule": [1.0]},
            "accuracy": "high",
            "time_limit": 5,
            "scenario": {"input_cost": 1},
        },
        {
            "relaxation": {"schedule": [2.0]},
            "accuracy": "high",
            "time_limit": 6,
            "scenario": {"input_cost": 1},
        },
        {
            "relaxation": {"schedule": [3.0]},
            "accuracy": "low",
            "time_limit": 6,
            "scenario": {"input_cost": 2},
        },
    ]
    runs = runs_of({}, {}, {"relaxation": "kadrani"})
    named = name_runs(runs, [flatten(tree) for tree in trees])
    assert named.method.tolist() == [
        "scholtes (schedule=[1.0]) / accuracy=high", "scholtes (schedule=[2.0]) / accuracy=high",
        "kadrani / accuracy=low",
    ]  # fmt: skip
    assert named.task.tolist() == ["static (input_cost=1)"] * 2 + ["static (input_cost=2)"]


def test_limits_of_the_certificate_are_named_where_they_tell_problems_apart() -> None:
    """Each kind of scenario has limits of its own; only runs of one scenario can differ in them."""
    runs = runs_of({}, {}, {"scenario": "race"})
    limits = [{"certificate": {"rate_ratio": ratio, "end_m": end}} for ratio, end in ((1, 2), (3, 2), (1, 5))]
    tasks = name_runs(runs, [flatten(tree) for tree in limits]).task.tolist()
    assert tasks == ["static / rate_ratio=1", "static / rate_ratio=3", "race"]


def test_what_plays_no_part_has_no_name_and_no_options() -> None:
    """An MPCC that is no flight beside a flight: no vehicle, dynamics or guess; its relaxation met no pairs; its own default of `compile`."""
    choice = {"solver": "ipopt", "kappa_init": None, "seed": 0}
    runs = pd.DataFrame([
        {**choice, "scenario": "zermelo", "relaxation": "", "strategy": "continuation", "intervals": None, "vehicle": None, "dynamics": None, "guess": None},
        {**choice, "scenario": "static", "relaxation": "", "strategy": "auto", "intervals": 100, "vehicle": "table1", "dynamics": "rk4", "guess": "simple"},
    ])  # fmt: skip
    common = {"solver.tol": 1, "relaxation._target_": "a.B"}
    settings = [
        {**common, "scenario.intervals": 20, "compile": "never", "relaxation.schedule": [1]},
        {
            **common,
            "scenario.intervals": 100,
            "compile": "auto",
            "vehicle.mass": 1,
            "dynamics._target_": "x",
            "guess._target_": "y",
            "flights": 4,
        },
    ]
    named = name_runs(runs, settings)
    assert named.method.tolist() == ["continuation", "rk4 / auto / simple"]
    assert named.problem.tolist() == ["zermelo, N=20", "static / table1, N=100"]
    sizes = pd.array([None, 100], dtype="Int64")
    assert name_runs(runs.assign(intervals=sizes), settings).problem.tolist() == named.problem.tolist()
    alone = runs.iloc[1:].assign(intervals=np.array([50], dtype=np.int64)).reset_index(drop=True)
    assert name_runs(alone, settings[1:]).problem.tolist() == ["static, N=50"]


def test_unknown_choices_and_numbers_have_names() -> None:
    named = name_runs(runs_of({"solver": None, "intervals": None, "kappa_init": None}, {}), [None, None])
    assert named.method.tolist() == ["unknown", "ipopt"]
    assert named.problem.tolist() == ["static", "static, N=20, κ=2"]


def test_what_decides_nothing_is_in_no_name() -> None:
    """Its list stands where such fields are read, above the room of names."""
    assert set(NOT_DECISIVE) <= set(naming.NEITHER)
