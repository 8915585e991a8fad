"""Parts of the report that need no browser: numbers of charts, what is hidden, what convergence says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
import pytest

from benchbench.analysis.reference_times import travel_time_errors
from benchbench.analysis.varied import slacks, varied
from benchbench.report.html.charts import drift, profiles, slack
from benchbench.report.html.charts.chart import counting, figure, styles
from benchbench.report.html.charts.travel_time import chart as over
from benchbench.report.html.objective_table import objective_rows
from benchbench.report.html.plans.limits import limits
from benchbench.report.panel import Curve, Panel, dashes
from benchbench.storage.convergence import parsed, text


@dataclass(frozen=True)
class Solve:
    """A solve, as the ledger keeps it."""

    stage: str
    total: float
    trace: tuple[tuple[float, float], ...]


def test_problems_that_are_no_flight_have_a_table() -> None:
    same = {"problem": "zermelo, N=50", "vehicle": None, "intervals": None, "mpcc_hash": "a", "best_known_objective": 5.0,
            "published_objective": 4.5, "published_source": "a book", "solve_s": 0.5}  # fmt: skip
    runs = pd.DataFrame([
        {**same, "method": "a", "certified": True, "objective": 5.5, "gap_percent": 10.0},
        {**same, "method": "a", "certified": True, "objective": 5.0, "gap_percent": 0.0},
        {**same, "method": "b", "certified": False, "objective": 1.0, "gap_percent": None},
        {**same, "method": "a", "certified": True, "objective": 2.0, "gap_percent": None, "vehicle": "table1", "intervals": 100},
    ])  # fmt: skip
    first, second = objective_rows(runs)
    assert (first.objective, first.gap, first.best_known, first.published, first.source) == (
        "5",
        "+0.000 %",
        "5",
        "4.5",
        "a book",
    )
    assert (first.verdict, first.good, second.objective, second.verdict) == (
        "2 of 2 certified",
        True,
        "",
        "0 of 1 certified",
    )


def test_convergence_counts_on_from_solve_to_solve() -> None:
    solves = [
        Solve("N = 25", 2.0, ((3.0, 10.0), (2.5, 1.0), (2.6, 1e-9))),
        Solve("silent", 1.0, ()),
        Solve("a,\nb", 3.0, ((2.6, 0.5), (2.7, 0.0))),
    ]
    found = parsed(text(solves))
    assert [(one.solve, one.iteration, one.cpu_s) for one in found] == [
        (0, 0, 0.0),
        (0, 1, 1.0),
        (0, 2, 2.0),
        (2, 2, 3.0),
        (2, 3, 6.0),
    ]
    assert [one.objective for one in found] == [3.0, 2.5, 2.6, 2.6, 2.7] and found[-1].stage == "a,\nb"
    assert text([Solve("silent", 1.0, ())]) == ""


@pytest.mark.parametrize(
    "told",
    [
        "",
        "a,b\n",
        "solve,stage,iteration,cpu_s,objective,violation\n1,2\n",
        "solve,stage,iteration,cpu_s,objective,violation\nx,,0,0,0,0\n",
    ],
)
def test_what_is_no_convergence_is_refused(told: str) -> None:
    with pytest.raises(ValueError):  # noqa: PT011  # also those of float()
        parsed(told)


@pytest.mark.parametrize(("most", "step"), [(1, 1), (8, 1), (9, 2), (16, 2), (17, 5), (4000, 500)])
def test_counting_axes_have_whole_steps(most: float, step: int) -> None:
    made = figure()
    counting(made, "xaxis", most)
    assert made.layout.xaxis.dtick == step and made.layout.xaxis.tick0 == 0


def runs(**columns: object) -> pd.DataFrame:
    """Four certified runs of one task on two grids."""
    given = {
        "task": ["a"] * 4, "scenario": ["a"] * 4, "kappa_init": [2] * 4, "certified": [True] * 4, "intervals": [20, 20, 40, 40],
        "travel_time_s": [2.02, 1.98, 2.0, 2.002], "method": ["x", "y", "x", "y"], "problem": ["p", "p", "q", "q"],
        "status": ["certified"] * 4, "solve_s": [1.0, 2.0, 3.0, 4.0], **columns,
    }  # fmt: skip
    return pd.DataFrame(given)


def test_errors_of_travel_times_are_measured_on_the_finest_grid() -> None:
    """A plan on a coarse grid that is faster than the truth is wrong by as much as one that is slower."""
    assert travel_time_errors(runs()).to_numpy() == pytest.approx([0.01, 0.01, 0.0, 0.001])
    lost = travel_time_errors(runs(certified=[True, True, False, True]))
    assert np.isnan(lost[2]) and lost[3] == 0.0 and lost[1] == pytest.approx(2.002 / 1.98 - 1, rel=0.02)
    races = travel_time_errors(runs(kappa_init=pd.array([None] * 4, "Int64")))
    assert races.to_numpy() == pytest.approx([0.01, 0.01, 0.0, 0.001]), "a race has no kappa_init"


def test_what_a_race_has_no_number_for_is_drawn() -> None:
    some = runs(kappa_init=pd.array([None] * 4, "Int64"))
    made = over(some, styles(some.method), "intervals").figure
    assert made is not None and sum(np.isfinite(trace.x).sum() for trace in made.data) == 4


def test_no_line_joins_two_series() -> None:
    """One trace for a method, with a gap where another task begins."""
    some = runs(task=["a", "b", "a", "b"], method=["x"] * 4, certified=[True, True, True, False])
    made = over(some, styles(some.method), "intervals").figure
    assert made is not None
    (trace,) = made.data
    assert [None if np.isnan(x) else x for x in trace.x] == [20, 40, None, 20, 40]
    assert trace.y[[0, 1, 3, 4]].tolist() == [2.02, 2.0, 1.98, 2.002]
    assert list(trace.marker.symbol) == ["circle", "circle", "circle", "circle", "circle-open"]


def settings(field: str, values: list[float], **other: list[object]) -> list[dict[str, object]]:
    return [{field: v, **{k: o[i] for k, o in other.items()}} for i, v in enumerate(values)]


NU = "scenario.contacts.position.limit"


def test_slack_is_compared_where_nothing_else_differs() -> None:
    told = settings(
        NU,
        [0.01, 0.02, 0.02, 0.04],
        **{"solver.name": ["i", "i", "i", "u"], "certificate.stationarity_seconds": [1, 2, 3, 4]},
    )
    assert slacks(told) == [NU]
    for one in told:
        one.pop("certificate.stationarity_seconds")
    found = varied(runs(), told, NU)
    assert found.value.tolist() == [0.01, 0.02] and found.travel_time_s.tolist() == [2.02, 1.98]
    (drawn,) = slack.charts(runs(), told)
    assert drawn.title == "What nu_max (position.limit) costs" and drawn.figure is not None
    assert [list(trace.x) for trace in drawn.figure.data] == [[0.01, 0.02]]
    assert list(slack.charts(runs(), settings(NU, [0.02] * 4))) == []


def test_the_fastest_of_several_runs_keeps_its_method() -> None:
    some = runs(method=["slow", "fast", "slow", "slow"], travel_time_s=[3.0, 2.0, 1.9, 2.5])
    found = varied(some, settings(NU, [0.01, 0.01, 0.02, 0.02]), NU)
    assert list(zip(found.method, found.travel_time_s, strict=True)) == [("fast", 2.0), ("slow", 1.9)]


def test_one_method_has_a_legend() -> None:
    some = runs(method=["x"] * 4)
    made = profiles.performance(some, styles(some.method)).figure
    assert made is not None and made.layout.showlegend and made.data[0].name == "x"


def test_drift_is_drawn_where_it_was_measured() -> None:
    some = runs(
        reference_cpu_s=[0.2, 0.3, None, 0.2],
        cpu=["c"] * 4,
        started_at=["2026-01-01T00:00:00+00:00"] * 4,
        run_id=["a"] * 4,
    )
    (drawn,) = drift.charts(some)
    assert "up to 50 %" in drawn.text and drawn.figure is not None and len(drawn.figure.data[0].x) == 3
    assert list(drift.charts(some.assign(reference_cpu_s=np.nan))) == []


def panel(*heights: float) -> Panel:
    time = np.linspace(0, 1, 50)
    return Panel(
        "Force",
        "N",
        tuple(Curve(f"motor_{i}", None, (time, np.full(50, h)), 0.0, 6.0) for i, h in enumerate(heights)),
    )


def test_curves_that_coincide_take_turns() -> None:
    assert dashes(panel(1, 2, 3, 4), 12.0) == [None] * 4
    assert dashes(panel(1, 1, 3, 3), 12.0) == [None, (6.0, 6.0), None, (6.0, 6.0)]
    four = dashes(panel(2, 2, 2, 2), 12.0)
    assert four == [None, (9.0, 3.0), (6.0, 6.0), (3.0, 9.0)], (
        "each later one leaves some of the earlier ones free"
    )
    lines = [
        trace
        for trace in limits([panel(2, 2)], [], 1.0).data
        if trace.mode == "lines" and trace.x[0] is not None
    ]
    assert [line.line.dash for line in lines] == ["solid", "8.0px,8.0px"]


def test_the_key_names_windows_only_where_there_are_some() -> None:
    def names(windows: list[tuple[float, float]]) -> list[str]:
        return [trace.name for trace in limits([panel(1)], windows, 1.0, "at a gate").data if trace.name]

    assert names([]) == ["flown", "limit"] and names([(0.1, 0.2)]) == ["flown", "limit", "at a gate"]
