"""`benchbench report`: what the page says is true, also for the odd cases, and it needs nothing but itself."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from browser import address, browser, errors, resize
from omegaconf import OmegaConf
from program import Done, assert_refused, records, told
from selenium.webdriver import ActionChains, Keys
from selenium.webdriver.common.by import By
from selenium.webdriver.remote.webdriver import WebDriver
from selenium.webdriver.support.ui import WebDriverWait
from sharing import Once
from test_picture import curved_plan, dense, task, vehicle
from test_table import row

from benchbench.cli.report_content import best_first, content
from benchbench.report.claims import load, said
from benchbench.report.html.page import render
from benchbench.report.html.plans.view import FRAMES, frame_nodes, view
from benchbench.report.scene import scene
from benchbench.storage.collect import collect
from benchbench.storage.files import write_record
from benchbench.storage.playback import read_mcap
from benchbench.storage.recording import write_mcap

SWEEP = (
    "+scenario=static,linear",
    "scenario.intervals=12,20",
    "dynamics=collocation,midpoint",
    "strategy=phases",
    "strategy.margin=0",
    "picture=false",
    "workers=1",
)
RUNS = 9


@pytest.fixture(scope="module")
def made(once: Once) -> tuple[Path, Done]:
    """A real sweep, one run that crashed and a broken record, and the report on them."""
    folder = once("report", report_on_a_sweep)
    return folder, Done((), *json.loads((folder / "told.json").read_text()))


def report_on_a_sweep(folder: Path) -> None:
    assert told(folder, "-m", *SWEEP).stdout.splitlines()[-1].endswith("of 8 runs certified")
    write_record(
        folder / "results" / "runs" / "crash",
        row("crash", status="crash", certified=False, travel_time_s=None, intervals=12),
    )
    (folder / "results" / "broken").mkdir()
    (folder / "results" / "broken" / "record.json").write_text("{")
    done = told(folder, "report", "results", "--plans", "3")
    (folder / "told.json").write_text(json.dumps([done.returncode, done.stdout, done.stderr]))


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
    done = made[1]
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"{RUNS} runs, 3 plans in report.html (")
    assert "left out" in done.stderr and "broken/record.json: JSONDecodeError" in done.stderr


def test_the_rates_are_those_of_the_records(made: tuple[Path, Done]) -> None:
    found = content(collect([made[0] / "results"]), [made[0] / "results"], None, 0)
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
    assert '<th scope="row">scenario.intervals</th><td>12, 20</td>' in text
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


def test_the_floor_is_drawn_where_it_is_near() -> None:
    model, plan = vehicle(), curved_plan(vehicle())
    for level, seen in ((0.3, True), (-2.0, False)):
        made = view(scene(plan, task(workspace={"z": (level, 9.0)}), model, None))
        floors = [trace for trace in made.data if trace.name == "lowest for the vehicle"]
        assert [set(trace.z) for trace in floors] == [{np.float32(level)}] * seen
        assert (made.layout.scene.zaxis.range[0] <= level) is seen


def test_one_run(results: Path) -> None:
    only(results, 1, certified=True)
    report = content(collect([results]), [results], "One", 5)
    assert len(report.plans) == 1 and report.runs.method.tolist() == ["ipopt"]
    assert "<title>One</title>" in render(report)


def test_no_certified_run(results: Path) -> None:
    only(results, 2, certified=False, intervals=12)
    text = render(content(collect([results]), [results], None, 5))
    assert text.count("No run has a certified plan, so there is no cost to compare.") == 2
    assert "not certified</span>" in text


def test_no_plan_at_all(results: Path) -> None:
    only(results, 1, status="crash")
    text = render(content(collect([results]), [results], None, 5))
    for says in (
        "No run has a recorded plan.",
        "No run has a plan.",
        "No run has a plan whose error was measured.",
    ):
        assert says in text
    menu = re.findall(r'href="#([a-z-]+)"', text.partition("</nav>")[0])
    assert menu == ["success", "speed", "runs", "settings", "claims"], "nothing to see in the others"


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        (lambda run: (run / "plan.mcap").write_bytes((run / "plan.mcap").read_bytes()[:5000]), "cannot be read"),
        (lambda run: (run / "plan.mcap").write_bytes(b""), "cannot be read"),
        (lambda run: overwrite(run / "plan.mcap"), "is not shown"),
        (lambda run: [(run / p).unlink() for p in ("config.yaml", ".hydra/config.yaml")], "configuration is missing"),
        (lambda run: (run / "config.yaml").write_text("vehicle: {_target_: not.Here}"), "scenario"),
        (lambda run: (run / "config.yaml").write_text((run / "config.yaml").read_text().replace(
            "aerial_manipulator.AerialManipulator", "gone.Gone")), "cannot be loaded"),
        (lambda run: (run / "config.yaml").write_text((run / "config.yaml").read_text().replace(
            "  kappa_init:", "  kappa:")), "scenario.kappa"),
    ],
)  # fmt: skip
def test_a_plan_that_cannot_be_shown_is_told(results: Path, damage: Any, says: str) -> None:
    bad, _ = only(results, 2, certified=True)
    damage(bad)
    report = content(collect([results]), [results], None, 5)
    assert len(report.plans) == 1 and len(report.runs) == 2
    assert len(report.missing) == 1 and says in report.missing[0]


def overwrite(path: Path) -> None:
    """Damage the middle of a file, as a bad disk does."""
    content = path.read_bytes()
    middle = len(content) // 2
    path.write_bytes(content[:middle] + bytes(200) + content[middle + 200 :])


def test_a_plan_of_an_older_configuration_is_shown(results: Path) -> None:
    """What a plan was solved with is of no use any more when it is shown."""
    old, _ = only(results, 2, certified=True)
    tree = OmegaConf.load(old / "config.yaml")
    tree.guess = {"_target_": "benchbench_plugins.guesses.phases.Phases"}  # today it needs a start
    tree.solver._target_ = "gone.Gone"
    del tree["certificate"]
    OmegaConf.save(tree, old / "config.yaml")
    report = content(collect([results]), [results], None, 5)
    assert len(report.plans) == 2 and not report.missing
    assert "gone.Gone" in render(report)


def test_a_row_without_its_folder_is_a_run(results: Path) -> None:
    shutil.rmtree(results / "sweeps")
    report = content(collect([results]), [results], None, 5)
    assert len(report.runs) == RUNS and not report.plans


@pytest.mark.parametrize(
    ("arguments", "field", "says"),
    [
        ((), "benchbench report", "DIR"),
        (("nowhere",), "nowhere", "no such folder"),
        (("empty",), "empty", "no run was found"),
        (("results", "--plans", "-1"), "--plans", "-1"),
        (("results", "--output", "empty", "--plans", "0"), "output", "cannot write"),
    ],
)
def test_bad_arguments_are_bad_input(
    made: tuple[Path, Done], arguments: tuple[str, ...], field: str, says: str
) -> None:
    (made[0] / "empty").mkdir(exist_ok=True)
    done = told(made[0], "report", *arguments)
    if "results" in arguments:  # the broken record is told first
        done.stderr = "".join(done.stderr.partition("benchbench: bad input")[1:])
    assert_refused(done, field, says)


@pytest.mark.parametrize("package", ["plotly", "jinja2"])
def test_without_the_extra_the_remedy_is_named(package: str, tmp_path: Path) -> None:
    """In a process of its own: here the page's modules are imported already."""
    script = f"import sys; sys.modules[{package!r}] = None; from benchbench.cli.application import start; " \
             f"sys.exit(start(['report', {str(tmp_path)!r}]))"  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=100, check=False
    )
    assert done.returncode == 2
    assert "pip install 'benchbench[report]'" in done.stderr


@pytest.fixture(scope="module")
def page(made: tuple[Path, Done]) -> Iterator[WebDriver]:
    """The report in a browser, as wide as a desk's."""
    with browser(1400) as driver:
        opened(driver, made[0] / "report.html")
        yield driver


def opened(driver: WebDriver, path: Path) -> None:
    driver.get(address(path))
    wait(driver, "return document.querySelectorAll('.figure .main-svg').length > 0")
    wait(
        driver,
        "return !document.querySelector('details.plan') || !!document.querySelector('details.plan[data-drawn]')",
    )


def wait(driver: WebDriver, script: str, *values: object) -> None:
    WebDriverWait(driver, 60).until(lambda d: d.execute_script(script, *values))


def state(driver: WebDriver) -> dict[str, Any]:
    """What the open plan shows: end effector, time in words, the cursors of the limits."""
    return driver.execute_script("""
        const plan = document.querySelector("details.plan[open]");
        const view = plan.querySelector(".view"), limits = plan.querySelector(".limits");
        const tool = view._fullData.find((trace) => trace.name === "end effector");
        return {
            run: plan.dataset.run, tool: [tool.x[0], tool.y[0], tool.z[0]],
            told: view.querySelector(".slider-label").textContent,
            cursors: limits.layout.shapes.filter((s) => s.name === "cursor").map((s) => s.x0),
        };""")


def test_the_page_loads_without_an_error_and_without_the_network(
    page: WebDriver, made: tuple[Path, Done]
) -> None:
    figures, drawn = page.execute_script(
        "return [document.querySelectorAll('.figure').length, document.querySelectorAll('.figure > .plot-container').length]"
    )
    assert figures == drawn >= 10
    assert (made[0] / "report.html").stat().st_size < 6e6
    assert errors(page) == []
    loaded = page.execute_script("return performance.getEntriesByType('resource').map((entry) => entry.name)")
    assert [name for name in loaded if not name.startswith(("data:", "blob:"))] == []


def ticks(page: WebDriver, title: str, axis: str) -> list[str]:
    """Texts along an axis of the chart with this title."""
    return page.execute_script(
        """
        const chart = [...document.querySelectorAll("article.chart")].find((one) => one.querySelector("h3").textContent === arguments[0]);
        return [...chart.querySelectorAll(`.${arguments[1]}tick text`)].map((text) => text.textContent);""",
        title, axis,
    )  # fmt: skip


def test_runs_and_intervals_are_counted_in_whole_numbers(page: WebDriver) -> None:
    told = [int(text) for text in ticks(page, "How the runs ended", "x")]
    assert told[0] == 0 and told == sorted({*told}) and len(told) > 2
    assert ticks(page, "Travel time over N", "x") == ["12", "20"]
    text = page.find_element(By.ID, "travel-time").text
    assert "static" in text and "linear" in text, "the lines say which scenario they are"


def test_the_menu_leads_to_what_there_is(page: WebDriver) -> None:
    links = [
        one.get_attribute("href").partition("#")[2] for one in page.find_elements(By.CSS_SELECTOR, "nav a")
    ]
    assert links == ["success", "speed", "travel-time", "plans", "runs", "settings", "claims", "left-out"]
    assert all(page.find_elements(By.ID, link) for link in links)


def test_convergence_over_iterations_and_over_cpu_time(page: WebDriver, made: tuple[Path, Done]) -> None:
    """Each method's line ends at the iterations of its record, or at its CPU time in the solver; violations fall."""
    chart = page.find_element(By.XPATH, "//article[h3[starts-with(., 'Convergence on')]]")
    read = """return arguments[0].querySelector('.js-plotly-plot').data.map((t) => ({
        name: t.name, x: [...t.x], y: [...t.y], axis: t.yaxis || 'y'}));"""
    known = records(made[0] / "results" / "sweeps")
    problem = chart.find_element(By.TAG_NAME, "h3").text

    def asked(method: str) -> list[dict[str, Any]]:
        return [
            r
            for r in known
            if r["dynamics"] == method and r["scenario"] in problem and f"N={r['intervals']}" in problem
        ]

    def ends(column: str) -> bool:
        """Whether each line ends where the record of its run says."""
        lines = page.execute_script(read, chart)
        assert {line["name"].split(" / ")[0] for line in lines} == {"collocation", "midpoint"} and len(
            lines
        ) == 4
        for line in lines:
            assert line["x"] == sorted(line["x"]) and line["x"][0] == 0
            assert line["axis"] == "y2" or line["y"][-1] < 1e-4 < line["y"][0]
        return all(
            any(
                line["x"][-1] == pytest.approx(run[column], rel=1e-4)
                for run in asked(line["name"].split(" / ")[0])
            )
            for line in lines
        )

    for button, column in enumerate(("iterations", "solve_cpu_s")):
        page.execute_script("arguments[0].scrollIntoView({block: 'center'})", chart)
        chart.find_elements(By.CSS_SELECTOR, ".updatemenu-button")[button].click()
        WebDriverWait(page, 20).until(lambda _, column=column: ends(column))
    assert errors(page) == []


def test_plan_charts_have_a_time_and_a_legend(page: WebDriver) -> None:
    charts = page.find_element(By.CSS_SELECTOR, "details.plan[open] .limits")
    assert [one.text for one in charts.find_elements(By.CSS_SELECTOR, ".legendtext")] == [
        "planned", "flown", "limit", "in contact",
    ]  # fmt: skip
    titles = charts.find_elements(By.CSS_SELECTOR, "[class*='xtitle'], [class^='x'][class*='title']")
    assert "time [s]" in {one.text for one in titles}


def test_the_page_has_the_ledger_of_claims(page: WebDriver) -> None:
    rows = page.execute_script(
        "return [...document.querySelectorAll('#claim-table tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))"
    )
    plain = [
        [one.source, one.claim, "".join(one.commands), one.value.replace("`", ""), said(one).replace("`", "")]
        for one in load()
    ]
    assert rows == plain and len(rows) > 10


def test_the_slider_moves_the_vehicle_as_planned(page: WebDriver, made: tuple[Path, Done]) -> None:
    before = state(page)
    rail = page.find_element(By.CSS_SELECTOR, "details.plan[open] .slider-rail-touch-rect")
    page.execute_script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", rail)
    ActionChains(page).move_to_element_with_offset(rail, 120, 0).click().perform()
    WebDriverWait(page, 20).until(lambda d: state(d)["tool"] != before["tool"])
    after = state(page)
    time = float(after["told"].removeprefix("t = ").removesuffix(" s"))
    assert after["cursors"] == [time] * len(after["cursors"]) and len(after["cursors"]) > 8
    recording = made[0] / "results" / "sweeps"
    folder = next(
        path.parent
        for path in recording.rglob("record.json")
        if records(path.parent)[0]["run_id"] == after["run"]
    )
    plan = read_mcap(folder / "plan.mcap").plan
    node = int(np.argmin(np.abs(plan.time - time)))
    assert plan.time[node] == pytest.approx(time, abs=1e-3)
    assert plan.travel_time / 2 < time < plan.travel_time
    assert np.linalg.norm(after["tool"] - plan.configuration[node, :3]) == pytest.approx(0.232, abs=0.01)
    assert errors(page) == []


def test_play_flies_on_from_where_it_is(page: WebDriver) -> None:
    before = state(page)
    page.find_elements(By.CSS_SELECTOR, "details.plan[open] .updatemenu-button")[0].click()
    WebDriverWait(page, 20).until(lambda d: state(d)["cursors"][0] > before["cursors"][0])
    assert errors(page) == []


def test_one_plan_is_open_at_a_time(page: WebDriver) -> None:
    first = page.find_element(By.CSS_SELECTOR, "details.plan[open]").get_attribute("data-run")
    page.find_elements(By.CSS_SELECTOR, "details.plan > summary")[1].click()
    wait(page, "return document.querySelectorAll('details.plan[data-drawn]').length === 1 && "
               "document.querySelector('details.plan[data-drawn]').dataset.run !== arguments[0]", first)  # fmt: skip
    assert len(page.find_elements(By.CSS_SELECTOR, "details.plan canvas")) == 1
    assert errors(page) == []


def column(page: WebDriver, name: str) -> list[str]:
    """Texts of a column of the table of runs, of the rows that are shown."""
    return page.execute_script(
        """
        const table = document.getElementById("run-table");
        const heads = [...table.querySelectorAll("th")].map((head) => head.textContent);
        const rows = [...table.tBodies[0].rows].filter((row) => row.checkVisibility());
        return rows.map((row) => row.cells[heads.indexOf(arguments[0])].dataset.key);""",
        name,
    )


def test_sorting_puts_numbers_in_order_and_empty_cells_last(page: WebDriver) -> None:
    head = page.find_element(By.XPATH, "//th/button[text()='travel time s']")
    for reverse in (False, True):
        head.click()
        shown = column(page, "travel time s")
        known = [float(value) for value in shown[:-1]]
        assert len(shown) == RUNS and shown[-1] == "" and known == sorted(known, reverse=reverse)
    page.find_element(By.XPATH, "//th/button[text()='scenario']").click()
    assert column(page, "scenario") == sorted(column(page, "scenario"))


@pytest.mark.parametrize(
    ("name", "text", "shown"),
    [
        ("intervals", "=20", ["20"] * 4), ("intervals", "<20", ["12"] * 5), ("intervals", "20..200", ["20"] * 4),
        ("dynamics", "MID", ["midpoint"] * 4), ("status", "!certified", ["crash"]), ("scenario", "nothing", []),
    ],
)  # fmt: skip
def test_filters(page: WebDriver, name: str, text: str, shown: list[str]) -> None:
    field = page.find_element(By.CSS_SELECTOR, f"input[aria-label='filter {name}']")
    field.send_keys(text)
    try:
        assert column(page, name) == shown
        assert page.find_element(By.ID, "shown").text == f"{len(shown)} of {RUNS} runs shown."
    finally:
        field.send_keys(Keys.CONTROL, "a", Keys.DELETE)
    assert len(column(page, name)) == RUNS


def test_a_run_leads_to_its_plan(page: WebDriver) -> None:
    link = page.find_elements(By.CSS_SELECTOR, "#run-table button.link")[-1]
    run = link.text
    link.click()
    wait(page, "return document.querySelector('details.plan[data-drawn]')?.dataset.run === arguments[0]", run)


@pytest.mark.parametrize("width", [480, 1400])
def test_nothing_sticks_out_of_the_page(page: WebDriver, made: tuple[Path, Done], width: int) -> None:
    resize(page, width)
    opened(page, made[0] / "report.html")
    assert page.execute_script("return document.documentElement.scrollWidth") <= width


def test_texts_of_a_record_stay_texts(page: WebDriver, tmp_path: Path) -> None:
    evil = "</script><script>window.hit = 1</script><img src=x onerror='window.hit = 1'>"
    values = {
        "solver": evil,
        "status": "crash",
        "certified": False,
        "reasons": [evil],
        "solver_version": evil,
    }
    for name in ("a", "b"):
        write_record(tmp_path / "results" / name, row(name, **{**values, "relaxation": evil + name}))
    done = told(tmp_path, "report", "results", "--title", evil)
    assert done.returncode == 0, done.stderr
    opened(page, tmp_path / "report.html")
    assert page.execute_script("return window.hit") is None
    assert evil in page.find_element(By.CSS_SELECTOR, "#success-rates").text
    assert errors(page) == []


@pytest.fixture(scope="module")
def board(made: tuple[Path, Done], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A leaderboard of a bundle and of the folder it is made of."""
    folder = tmp_path_factory.mktemp("board")
    shutil.copytree(made[0] / "results" / "sweeps", folder / "results" / "sweeps")
    assert told(folder, "bundle", "results", "--machine", "<laptop>").returncode == 0
    done = told(folder, "report", "results.zip", "results", "--leaderboard", "--plans", "1")
    assert done.returncode == 0, done.stderr
    assert "8 runs judged again: " in done.stderr and "in leaderboard.html" in done.stdout
    return folder


def test_the_leaderboard_has_the_fastest_certified_plan_of_each_method(page: WebDriver, board: Path) -> None:
    """Rows are methods, columns are tasks; what is said of a cell is true of the file that it leads to."""
    resize(page, 1400)
    page.get(address(board / "leaderboard.html"))
    times: dict[tuple[str, str], float] = {}
    for record in (record for record in records(board / "results") if record["certified"]):
        key = record["dynamics"], f"{record['scenario']}, N={record['intervals']}, κ={record['kappa_init']}"
        times[key] = min(times.get(key, np.inf), record["travel_time_s"])
    table = page.find_element(By.ID, "leaderboard")
    tasks = [head.text for head in table.find_elements(By.CSS_SELECTOR, "thead th")][2:]
    rows = table.find_elements(By.CSS_SELECTOR, "tbody tr")
    shown = {
        (row.find_element(By.TAG_NAME, "th").text, task): cell.find_element(By.TAG_NAME, "a")
        for row in rows
        for task, cell in zip(tasks, row.find_elements(By.TAG_NAME, "td")[1:], strict=True)
        if cell.find_elements(By.TAG_NAME, "a")
    }
    assert {key: link.text for key, link in shown.items()} == {key: f"{t:.4f}" for key, t in times.items()}
    counts = [int(row.find_element(By.TAG_NAME, "td").text) for row in rows]
    assert sum(counts) == len(times) and counts == sorted(counts, reverse=True)
    assert "none (" in table.text and "<laptop>" in page.find_element(By.ID, "sources").text
    for (method, _), link in shown.items():
        link.click()
        entry = page.find_element(By.ID, link.get_attribute("href").partition("#")[2])
        wait(page, "return arguments[0].open", entry)
        assert f"dynamics={method}" in entry.find_element(By.CSS_SELECTOR, "code.command").text
        file = board / entry.find_element(By.CSS_SELECTOR, "a[download]").text
        assert hashlib.sha256(file.read_bytes()).hexdigest() in entry.text
        assert f"{read_mcap(file).plan.travel_time:.4f} s" in entry.find_element(By.TAG_NAME, "summary").text
    assert errors(page) == []


def test_the_leaderboard_shows_a_plan_and_fits_a_telephone(page: WebDriver, board: Path) -> None:
    resize(page, 480)
    page.get(address(board / "leaderboard.html"))
    assert page.execute_script("return document.documentElement.scrollWidth") <= 480
    page.execute_script("document.querySelector('details:has(.view)').open = true")
    wait(page, "return !!document.querySelector('details.plan[data-drawn] canvas')")
    assert page.execute_script("return document.documentElement.scrollWidth") <= 480
    assert errors(page) == []
