"""Races in the report: the table of dynamics by gates, the track in space, limits that grow."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from browser import address, browser, errors
from program import records, told
from test_table import row

from benchbench.analysis.naming import name_runs
from benchbench.analysis.races import races
from benchbench.cli.report_content import content
from benchbench.ocp.track import Gate, Opening
from benchbench.report.gates import outline, outlines
from benchbench.report.html.plans.limits import limits
from benchbench.report.html.plans.view import view
from benchbench.report.html.race_table import race_rows
from benchbench.report.race_panels import race_panels
from benchbench.report.scene import scene
from benchbench.run import config, pipeline
from benchbench.storage.collect import collect


def race(run: str, gates: int, dynamics: str = "rk4", **values: Any) -> dict[str, Any]:
    standard = {
        "scenario": "race", "vehicle": "race_quadrotor", "kappa_init": None, "gates": gates, "dynamics": dynamics,
        "intervals": 40 * (gates + 1), "build_cpu_s": 0.25, "solve_cpu_s": 1.0, "travel_time_s": 1.25,
        "replay_drift_position_m": 5e-4,
    }  # fmt: skip
    return row(run, **{**standard, **values})


def table(*rows: dict[str, Any], settings: list[Any] | None = None) -> Any:
    known = settings or [None] * len(rows)
    return races(name_runs(pd.DataFrame(rows), known), known)


def test_cells_by_hand() -> None:
    missed = {"certified": False, "status": "uncertified", "reasons": ["gate 1 is passed at 0.5 m"]}
    found = table(
        race("a", 1),
        race("b", 1, solve_cpu_s=3.0, travel_time_s=1.75, replay_drift_position_m=2e-3),
        race("c", 2),
        race("d", 1, "verlet", **missed),
        race("e", 1, intervals=40),
        row("f"),
    )
    assert [(r.method, r.nodes, sorted(r.cells)) for r in found] == [
        ("rk4", 20, [1]),
        ("rk4", 40, [1, 2]),
        ("verlet", 40, [1]),
    ]
    twice, lost = found[1].cells[1], found[2].cells[1]
    assert (twice.runs, twice.certified, twice.travel_time_s, twice.cpu_s, twice.error_m) == (
        2,
        2,
        1.5,
        2.25,
        2e-3,
    )
    assert (lost.certified, list(lost.reasons)) == (0, ["gate 1 is passed at 0.5 m"])
    gates, rows = race_rows(found)
    assert gates == [1, 2]
    assert [cell.lines for cell in rows[1]][2:] == [
        ("40",),
        ("1.5000 s", "2.25 s CPU", "2.00 mm", "2 of 2 certified"),
        ("1.2500 s", "1.25 s CPU", "0.50 mm", "certified"),
    ]
    assert (rows[2][3].lines[-1], rows[2][3].verdict, rows[2][3].hint) == (
        "not certified",
        "bad",
        "gate 1 is passed at 0.5 m",
    )
    assert rows[2][4].lines == ("",) and rows[2][4].verdict == ""


def test_one_bad_run_among_good_ones_is_told() -> None:
    ended = {"certified": False, "status": "timeout", "reasons": None, "travel_time_s": None}
    (only,) = table(race("a", 1), race("b", 1, **ended))
    cell = race_rows([only])[1][0][3]
    assert cell.lines[-1] == "1 of 2 certified"
    assert (cell.verdict, cell.hint) == ("bad", "timeout")


def test_tracks_and_vehicles_are_rows_of_their_own_gates_are_not() -> None:
    settings = [
        {"scenario.gates": 1, "scenario.radius": 0.3},
        {"scenario.gates": 2, "scenario.radius": 0.3},
        {"scenario.gates": 1, "scenario.radius": 0.1},
        {"scenario.gates": 1, "scenario.radius": 0.3},
    ]
    rows = [race("a", 1), race("b", 2), race("c", 1), race("d", 1, vehicle="race_ramp")]
    named = {r.race: sorted(r.cells) for r in table(*rows, settings=settings)}
    assert named == {
        "race_quadrotor radius=0.3": [1, 2],
        "race_quadrotor radius=0.1": [1],
        "race_ramp radius=0.3": [1],
    }


def test_repeated_runs_are_counted_by_their_medians() -> None:
    (only,) = table(race("a", 1, solve_cpu_median_s=0.5, build_cpu_median_s=0.125))
    assert only.cells[1].cpu_s == 0.625


def test_no_race_no_table() -> None:
    assert table(row("a")) == []


def test_the_outline_of_a_ball_and_of_a_rectangle() -> None:
    ball = Gate((1.0, 2.0, 3.0), 0.5)
    points = outline(ball)
    known = points[np.isfinite(points[:, 0])]
    np.testing.assert_allclose(np.linalg.norm(known - ball.position, axis=1), 0.5)
    assert np.ptp(known, axis=0) == pytest.approx((1, 1, 1), abs=0.02)
    window = Gate((0.0, 0.0, 1.0), 1.0, Opening((1.0, 0.0, 0.0), 2.0, 1.0))
    np.testing.assert_allclose(np.ptp(outline(window), axis=0), (0, 2, 1), atol=1e-12)
    assert list(outlines((ball, window, ball, window))) == ["1, 3", "2, end"]


@pytest.fixture(scope="module")
def flown() -> pipeline.Run:
    return pipeline.run(
        config.compose(
            "+scenario=race", "vehicle=race_ramp", "scenario.gates=1", "scenario.nodes_per_gate=20"
        )
    )


def test_limits_that_grow_are_drawn_as_they_run(flown: pipeline.Run) -> None:
    plan, race, model = flown.result.plan, flown.case.scenario, flown.case.model
    panels = race_panels(race, plan, model, flown.certificate.flight)
    assert [panel.title for panel in panels] == [
        "Speed", "Motor forces", "Angular rates", "Angular rate of wz", "Height",
    ]  # fmt: skip
    force = panels[1].curves[0]
    assert force.band is not None
    assert force.band.upper[0] == pytest.approx(3.1269) and force.band.upper[-1] < 6.8794
    assert np.all(force.line[1] <= force.band.upper + 1e-6)
    figure = limits(panels, (), plan.travel_time)
    dashed = [trace for trace in figure.data if trace.line.dash == "dash"]
    np.testing.assert_allclose(dashed[1].y, force.band.upper)
    heights = [shape for shape in figure.layout.shapes if shape.yref == "y5" and shape.y0 == shape.y1]
    assert [shape.y0 for shape in heights] == [0.5]


def test_the_track_is_coloured_by_speed_with_its_gates(flown: pipeline.Run) -> None:
    plan = flown.result.plan
    shown = scene(plan, flown.case.scenario, flown.case.model, flown.certificate.flight)
    figure = view(shown)
    path = next(trace for trace in figure.data if trace.name == "path")
    np.testing.assert_allclose(path.line.color, np.linalg.norm(plan.velocity[:, :3], axis=1), rtol=1e-6)
    np.testing.assert_allclose(np.array([path.x, path.y, path.z]).T, plan.configuration[:, :3], atol=1e-5)
    texts = next(trace for trace in figure.data if trace.mode == "text")
    assert list(texts.text) == ["1", "end"]


def test_the_page_has_the_table_and_opens_without_an_error(tmp_path: Path) -> None:
    done = told(
        tmp_path, "-m", "+scenario=race", "scenario.gates=1,2", "scenario.nodes_per_gate=20",
        "dynamics=rk4,lie_verlet", "picture=false", "workers=1",
    )  # fmt: skip
    assert done.returncode in (0, 1), done.stderr
    assert told(tmp_path, "report", "results").returncode == 0
    found = content(collect([tmp_path / "results"]), [tmp_path / "results"], None, 0)
    assert found.runs.gates.tolist().count(2) == 2
    page = (tmp_path / "report.html").read_text()
    text = re.sub("<script.*?</script>|<style.*?</style>", "", page, flags=re.DOTALL)
    (shown,) = re.findall('<table class="plain" id="race-table">.*?</table>', text, re.DOTALL)
    for record in records(tmp_path / "results"):
        assert f"{record['travel_time_s']:.4f} s<br>" in shown
    assert "rk4" in shown and "lie_verlet" in shown and '<th class="number">2 gates</th>' in shown
    with browser(1400) as driver:
        driver.get(address(tmp_path / "report.html"))
        assert driver.find_element("id", "race-table").is_displayed()
        assert errors(driver) == []
