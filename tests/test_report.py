"""`benchbench report`: what the page says is true, also for the odd cases, and it needs nothing but itself."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from browser import address, browser, errors
from selenium.webdriver import ActionChains, Keys
from selenium.webdriver.common.by import By
from selenium.webdriver.remote.webdriver import WebDriver
from selenium.webdriver.support.ui import WebDriverWait
from test_picture import curved_plan, dense, task, vehicle
from test_program import Done, assert_refused, program, records
from test_table import row

from benchbench.plan import Plan
from benchbench.report.html.page import render
from benchbench.report.html.plans.view import FRAMES, frame_nodes, view
from benchbench.report.views import scene
from benchbench.report_content import best_first, content
from benchbench.storage.files import write_record
from benchbench.storage.playback import read_mcap
from benchbench.storage.recording import write_mcap

SWEEP = (
    "+scenario=static,linear",
    "scenario.intervals=20,100",
    "dynamics=verlet,midpoint",
    "strategy=phases",
)
RUNS = 9


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Done]:
    """A real sweep, one run that crashed and a broken record, and the report on them."""
    folder = tmp_path_factory.mktemp("report")
    assert program(folder, "-m", *SWEEP).stdout.splitlines()[-1].endswith("of 8 runs certified")
    write_record(
        folder / "results" / "runs" / "crash",
        row("crash", status="crash", certified=False, travel_time_s=None),
    )
    (folder / "results" / "broken").mkdir()
    (folder / "results" / "broken" / "record.json").write_text("{")
    return folder, program(folder, "report", "results", "--plans", "3")


@pytest.fixture
def results(made: tuple[Path, Done], tmp_path: Path) -> Path:
    """A copy to damage."""
    return Path(shutil.copytree(made[0] / "results", tmp_path / "results"))


def only(results: Path, count: int, **wanted: Any) -> list[Path]:
    """Keep that many runs with these values, and no table; returns their folders."""
    shutil.rmtree(results / "table")
    kept = []
    for path in sorted(results.rglob("record.json")):
        try:
            record = records(path.parent)[0]
        except ValueError:
            record = {}
        if len(kept) < count and all(record.get(key) == value for key, value in wanted.items()):
            kept.append(path.parent)
        else:
            shutil.rmtree(path.parent)
    assert len(kept) == count
    return kept


def page_text(path: Path) -> str:
    return re.sub("<script.*?</script>|<style.*?</style>", "", path.read_text(), flags=re.DOTALL)


def test_the_program_says_what_it_wrote(made: tuple[Path, Done]) -> None:
    folder, done = made
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"{RUNS} runs, 3 plans in report.html (")
    assert "left out" in done.stderr and "broken/record.json: JSONDecodeError" in done.stderr


def test_the_rates_are_those_of_the_records(made: tuple[Path, Done]) -> None:
    found = content([made[0] / "results"], None, 0)
    certified = sum(record["certified"] for record in found.runs.to_dict("records"))
    assert 0 < certified < RUNS
    text = page_text(made[0] / "report.html")
    share = f"{100 * certified / RUNS:.0f} % ("
    assert re.search(rf"<dt>certified</dt><dd>{re.escape(share)}", text)
    assert "broken/record.json" in text and "crash" in text
    assert "3 of 8 plans are shown" in text


def test_the_file_refers_to_nothing_outside(made: tuple[Path, Done]) -> None:
    text = page_text(made[0] / "report.html")
    assert not re.search(r"""(src|href)=["'](?!#|data:)""", text)
    assert "default-src 'none'" in text


def test_settings_versions_and_machine_are_told(made: tuple[Path, Done]) -> None:
    text = page_text(made[0] / "report.html")
    record = next(r for r in records(made[0] / "results" / "sweeps"))
    for column in ("casadi_version", "python_version", "platform", "solver_version"):
        assert record[column] in text
    assert '<th scope="row">scenario.intervals</th><td>20, 100</td>' in text
    assert "quadrotor_mass: 1.659" in text


def test_best_plans_come_first_and_each_problem_gets_one() -> None:
    rows = [("p", 2.0, True), ("p", 1.0, False), ("q", 9.0, True), ("p", 3.0, True), ("q", None, False)]
    runs = pd.DataFrame(rows, columns=["problem", "travel_time_s", "certified"])
    assert best_first(runs) == [0, 2, 3, 1, 4]


@pytest.mark.parametrize("interpolation", ["hold", "linear", "bezier"])
def test_a_recording_gives_plan_and_replay_back(interpolation: str, tmp_path: Path) -> None:
    model, plan = vehicle(), curved_plan(vehicle(), 0.2)
    rows = {"hold": plan.intervals, "linear": plan.intervals + 1, "bezier": 4 * plan.intervals}[interpolation]
    inputs = np.arange(rows * 5.0).reshape(rows, 5)
    plan = replace(plan, inputs=inputs, interpolation=interpolation)
    flight = dense(plan)
    flight.configuration[-3:] = np.nan
    write_mcap(tmp_path / "plan.mcap", plan, flight, task(), model, {"config": "a: 1"})
    back = read_mcap(tmp_path / "plan.mcap")
    assert back.config == "a: 1"
    for name in ("time", "configuration", "velocity", "inputs", "progress"):
        np.testing.assert_array_equal(getattr(back.plan, name), getattr(plan, name))
    for name in ("interpolation", "coordinate_names", "coordinate_units", "input_names", "input_units"):
        assert getattr(back.plan, name) == getattr(plan, name)
    np.testing.assert_array_equal(back.flight.configuration, flight.configuration)
    np.testing.assert_array_equal(back.flight.nodes, flight.nodes)


def test_a_recording_without_replay_is_read(tmp_path: Path) -> None:
    write_mcap(tmp_path / "plan.mcap", curved_plan(vehicle()), None, task(), vehicle(), {})
    assert read_mcap(tmp_path / "plan.mcap").flight is None


def test_the_frames_show_the_plan(tmp_path: Path) -> None:
    model, plan = vehicle(), curved_plan(vehicle(), n=200)
    shown = scene(plan, task(), model, dense(plan))
    nodes = frame_nodes(shown)
    assert {0, 17, 18, 200} <= set(nodes) and FRAMES <= len(nodes) <= FRAMES + 2
    figure = view(shown)
    for node, frame in zip(nodes, figure.frames, strict=True):
        assert float(frame.name) == pytest.approx(plan.time[node], abs=1e-3)
        tool = frame.data[2]
        assert [tool.x[0], tool.y[0], tool.z[0]] == pytest.approx(shown.tool[node])
        assert np.nanmean(frame.data[0].x[:2]) == pytest.approx(plan.configuration[node, 0], abs=1e-5)


def test_a_replay_that_runs_away_does_not_set_the_scale() -> None:
    model, plan = vehicle(), curved_plan(vehicle())
    flight = dense(plan)
    flight.configuration[150:, :3] += 1e3
    space = view(scene(plan, task(), model, flight)).layout.scene
    assert space.xaxis.range[1] < 4 and space.zaxis.range[1] < 2


def test_one_run(results: Path) -> None:
    only(results, 1, certified=True)
    report = content([results], "One", 5)
    assert len(report.plans) == 1 and report.runs.method.tolist() == ["none / ipopt"] or report.plans
    assert "<title>One</title>" in render(report)


def test_no_certified_run(results: Path) -> None:
    only(results, 2, certified=False, intervals=20)
    text = render(content([results], None, 5))
    assert text.count("No run has a certified plan, so there is no cost to compare.") == 2
    assert "not certified</span>" in text


def test_no_plan_at_all(results: Path) -> None:
    only(results, 1, status="crash")
    text = render(content([results], None, 5))
    for says in (
        "No run has a recorded plan.",
        "No run has a plan.",
        "No run has a plan whose error was measured.",
    ):
        assert says in text


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        (lambda run: (run / "plan.mcap").write_bytes((run / "plan.mcap").read_bytes()[:5000]), "cannot be read"),
        (lambda run: (run / "plan.mcap").write_bytes(b""), "cannot be read"),
        (lambda run: [(run / p).unlink() for p in ("config.yaml", ".hydra/config.yaml")], "configuration is missing"),
        (lambda run: (run / "config.yaml").write_text("vehicle: {_target_: not.Here}"), "scenario"),
        (lambda run: (run / "config.yaml").write_text((run / "config.yaml").read_text().replace(
            "aerial_manipulator.AerialManipulator", "gone.Gone")), "cannot be loaded"),
    ],
)  # fmt: skip
def test_a_plan_that_cannot_be_shown_is_told(results: Path, damage: Any, says: str) -> None:
    bad, _ = only(results, 2, certified=True)
    damage(bad)
    report = content([results], None, 5)
    assert len(report.plans) == 1 and len(report.runs) == 2
    assert len(report.missing) == 1 and says in report.missing[0]


def test_a_row_without_its_folder_is_a_run(results: Path) -> None:
    shutil.rmtree(results / "sweeps")
    report = content([results], None, 5)
    assert len(report.runs) == RUNS and not report.plans


@pytest.mark.parametrize(
    ("arguments", "field", "says"),
    [
        ((), "benchbench report", "DIR"),
        (("nowhere",), "nowhere", "no such folder"),
        (("empty",), "empty", "no run was found"),
        (("results", "--plans", "-1"), "--plans", "-1"),
        (("results", "--output", "empty"), "output", "cannot write"),
    ],
)
def test_bad_arguments_are_bad_input(
    made: tuple[Path, Done], arguments: tuple[str, ...], field: str, says: str
) -> None:
    (made[0] / "empty").mkdir(exist_ok=True)
    done = program(made[0], "report", *arguments)
    if "results" in arguments:  # the broken record is told first
        done.stderr = "".join(done.stderr.partition("benchbench: bad input")[1:])
    assert_refused(done, field, says)


@pytest.mark.parametrize("package", ["plotly", "jinja2"])
def test_without_the_extra_the_remedy_is_named(package: str, tmp_path: Path) -> None:
    script = f"import sys; sys.modules[{package!r}] = None; from benchbench.application import start; " \
             f"sys.exit(start(['report', {str(tmp_path)!r}]))"  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=100, check=False
    )
    assert done.returncode == 2
    assert "pip install 'benchbench[report]'" in done.stderr
