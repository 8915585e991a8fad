"""The public face: plan, certify, load, runs from Python; frames come back as the plans they were."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from io import BytesIO
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image

import benchbench as bb
from benchbench.cli.application import start
from benchbench.ocp.plan import Interpolation, bezier
from benchbench.run import config
from benchbench.storage.frame import plan_of_frame

ROOT = Path(__file__).resolve().parents[1]
RACE = ("+scenario=race", "scenario.gates=1", "scenario.nodes_per_gate=20")
HANDOVER = ("+scenario=static", "scenario.intervals=12")
"""Certified, and not: its grid is too coarse."""


@cache
def run(*overrides: str) -> bb.RunView:
    return bb.plan(*overrides)


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run of the program itself."""
    root = tmp_path_factory.mktemp("results")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["benchbench"])
        assert start([*RACE, f"output={root}", f"hydra.run.dir={root}/runs/one"]) == 0
    return root / "runs" / "one"


def names(run: bb.RunView) -> set[str]:
    return {check.name for check in run.certificate.checks if not check.ok}


def test_a_run_is_that_of_the_command_line(stored: Path) -> None:
    ours, theirs = run(*RACE), bb.load(stored)
    assert ours.certified and theirs.certified
    for column in (
        "config_hash",
        "task_hash",
        "travel_time_s",
        "iterations",
        "mpcc_hash",
        "solver",
        "reasons",
    ):
        assert ours.record[column] == theirs.record[column], column
    assert ours.travel_time == ours.plan.travel_time == ours.record["travel_time_s"]
    np.testing.assert_array_equal(ours.plan.configuration, theirs.plan.configuration)
    pd.testing.assert_frame_equal(ours.plan.to_frame(), theirs.plan.to_frame())


def test_overrides_imply_what_they_imply_there() -> None:
    cfg, chosen = config.composed(*HANDOVER, "relaxation=paper")
    assert chosen["strategy"] == "relax" and cfg.scenario.intervals == 12


def test_a_frame_has_a_row_per_node_with_names_and_units() -> None:
    plan = run(*HANDOVER).plan
    frame = plan.to_frame()
    assert len(frame) == plan.intervals + 1 and frame.index.name == "node"
    assert list(frame.attrs["units"]) == list(frame.columns)
    units = frame.attrs["units"]
    assert (units["time"], units["roll"], units["v_arm"], units["servo"]) == ("s", "rad", "rad/s", "N m")
    np.testing.assert_array_equal(frame.time, plan.time)
    for i, name in enumerate(plan.coordinate_names):
        np.testing.assert_array_equal(frame[name], plan.configuration[:, i])
        np.testing.assert_array_equal(frame[f"v_{name}"], plan.velocity[:, i])
    np.testing.assert_array_equal(frame.motor_2[:-1], plan.inputs[:, 1])
    np.testing.assert_array_equal(frame.progress, plan.progress)
    assert frame[list(plan.input_names)].iloc[-1].isna().all() and not frame[:-1].isna().any().any()


def other_plan(
    interpolation: Interpolation, stops: tuple[str, ...] = ("target",)
) -> tuple[bb.Plan, bb.Model]:
    """A plan of random numbers."""
    model = config.compose(*HANDOVER).model
    q, u, random = model.configuration, model.inputs, np.random.default_rng(1)
    rows = {"hold": 3, "linear": 4, "bezier": 9}[interpolation]
    return bb.Plan(
        np.array([0.0, 0.1, 0.25, 0.3]), random.random((4, 7)), random.random((4, 7)), random.random((rows, 5)),
        random.random((4, len(stops))), interpolation, q.names, q.units, u.names, u.units, stop_names=stops,
    ), model  # fmt: skip


@pytest.mark.parametrize("stops", [("target",), ("shelf", "the_robot")])
@pytest.mark.parametrize("interpolation", ["hold", "linear", "bezier"])
def test_a_plan_comes_back_from_its_frame_and_from_its_csv(
    interpolation: Interpolation, stops: tuple[str, ...], tmp_path: Path
) -> None:
    plan, model = other_plan(interpolation, stops)
    frame = plan.to_frame()
    frame.to_csv(tmp_path / "plan.csv")
    read = pd.read_csv(tmp_path / "plan.csv")
    last = len(stops)  # columns of progress keep their order, which is that of the stops
    read = read[[*read.columns[-last - 1 :: -1], *read.columns[-last:]]].assign(more="text")
    for again in (plan_of_frame(frame, model), plan_of_frame(read, model)):
        assert (again.interpolation, again.stop_names) == (interpolation, stops)
        for name in ("time", "configuration", "velocity", "inputs", "progress"):
            np.testing.assert_allclose(getattr(again, name), getattr(plan, name), rtol=1e-15, err_msg=name)


def test_the_frame_of_polynomials_has_their_control_points() -> None:
    plan, _ = other_plan("bezier")
    row = plan.to_frame().iloc[1]
    points = np.array([row["motor_3"], row["motor_3.1"], row["motor_3.2"]])[:, None]
    middle = plan.input_at(np.array([(plan.time[1] + plan.time[2]) / 2]))[0, 2]
    assert bezier(points, 0.5)[0] == pytest.approx(middle, abs=1e-12)


@pytest.mark.parametrize("overrides", [RACE, HANDOVER])
def test_a_frame_gets_the_verdict_of_its_run(overrides: tuple[str, ...], tmp_path: Path) -> None:
    ours = run(*overrides)
    again = bb.certify(ours.plan.to_frame(), *overrides, name="ours")
    assert again.certified == ours.certified and again.record["reasons"] == ours.record["reasons"]
    assert again.record["solver"] == "ours" and again.record["strategy"] == "foreign"
    for name, value in vars(ours.certificate.measures).items():
        if name not in ("max_violation", "max_complementarity", "max_product"):  # of no problem of ours
            assert getattr(again.certificate.measures, name) == value, name


def test_recordings_and_frames_as_csv_are_judged_too(stored: Path, tmp_path: Path) -> None:
    frame = run(*RACE).plan.to_frame()
    frame.to_csv(tmp_path / "frame.csv")
    for place in (tmp_path / "frame.csv", stored / "plan.mcap", stored):
        assert bb.certify(place, *RACE).travel_time == run(*RACE).travel_time, place
    frame.loc[frame.index[9:], "motor_1"] += 3.0
    refused = bb.certify(frame, *RACE)
    assert not refused.certified and "planned_input" in names(refused)
    assert "NOT certified" in refused._repr_html_() and "motor_1" in refused._repr_html_()


REFUSED: dict[str, tuple[Callable[[pd.DataFrame], object], str]] = {
    "column": (lambda f: f.drop(columns="qx"), "frame: has no column qx"),
    "text": (lambda f: f.astype(object).replace({"x": {f.x[3]: "far"}}), "frame, row 3: x: 'far' was given"),
    "gap": (lambda f: f.assign(motor_2=f.motor_2.where(f.index != 5)), "frame, row 5: motor_2: 'nan' was given"),
    "time": (lambda f: f.iloc[[0, 2, 1, *range(3, len(f))]], "frame, row 1: time: is not later"),
    "a row": (lambda f: f[:1], "allowed: 2 rows or more"),
    "twice": (lambda f: pd.concat([f, f.x], axis=1), "has two columns x"),
    "kind": (lambda f: f.to_numpy(), "plan: a ndarray was given"),
    "file": (lambda f: "nowhere.csv", "nowhere.csv: there is no such file"),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_no_plan_is_told(what: str) -> None:
    spoil, told = REFUSED[what]
    with pytest.raises(bb.BadInput) as error:
        bb.certify(spoil(run(*RACE).plan.to_frame()), *RACE)
    assert told in str(error.value)


def test_a_plan_of_another_vehicle_is_told(stored: Path) -> None:
    """A stored plan says whose it is; a plan in memory only what its columns are."""
    told = (
        "vehicle: 'table1' has x, y, z, roll",
        "vehicle: 'table1' was asked for, .* is a plan of 'race_quadrotor'",
    )
    for plan, said in zip((run(*RACE).plan, stored), told, strict=True):
        with pytest.raises(bb.BadInput, match=said):
            bb.certify(plan, *HANDOVER)


def test_errors_are_those_of_the_program() -> None:
    for overrides, told in (
        ((), "scenario: none was chosen"), (("+scenario=circel",), "'circel' does not exist"),
        ((*HANDOVER, "solver=ipopt,uno"), "solver: got several values"), ((*HANDOVER, "hard_limit=9"), "hard_limit"),
    ):  # fmt: skip
        with pytest.raises(bb.BadInput, match=told):
            bb.plan(*overrides)
    with pytest.raises(bb.IncompatibleCase, match="dynamics"):
        bb.plan("+scenario=race", "dynamics=verlet")


def test_saved_and_loaded_it_is_the_same_run(tmp_path: Path, stored: Path) -> None:
    ours, folder = run(*RACE), tmp_path / "kept" / "first"
    loaded = bb.load(ours.save(folder))
    assert sorted(p.name for p in folder.iterdir()) == ["config.yaml", "plan.mcap", "plan.png", "record.json"]
    assert {p.name for p in folder.iterdir()} == {p.name for p in stored.iterdir() if p.is_file()}
    assert loaded.record == json.loads(json.dumps(ours.record)) and loaded.config == ours.config
    assert loaded.certified and loaded.certificate.certified and repr(loaded) == repr(ours)
    assert bb.load(loaded.save(tmp_path / "kept" / "second")).plan.travel_time == ours.travel_time
    table = bb.runs(tmp_path, stored.parents[1])
    assert len(table) == 2 and set(table.run_id) == {ours.record["run_id"], bb.load(stored).record["run_id"]}
    assert table.certified.all() and {bb.load(f).travel_time for f in table.folder} == {ours.travel_time}


def test_it_shows_itself(stored: Path) -> None:
    for one in (run(*RACE), bb.load(stored)):
        assert repr(one) == f"<race: certified, {one.travel_time:.4f} s>"
        assert "certified" in one._repr_html_() and f"{one.travel_time:.4f} s" in one._repr_html_()
        with Image.open(BytesIO(one._repr_png_())) as image:
            assert image.format == "PNG" and image.width == 1050


def test_an_old_record_alone_says_what_is_missing() -> None:
    old = bb.load(ROOT / "tests" / "records" / "version_1.json")
    assert old.certified and old.travel_time == pytest.approx(2.85593, abs=1e-5) and old.config == ""
    assert "certified" in old._repr_html_() and old._repr_png_() is None
    for ask in (lambda: old.plan, lambda: old.certificate, old.draw):
        with pytest.raises(bb.BadInput, match=r"there is no plan\.mcap in"):
            ask()
    with pytest.raises(bb.BadInput, match=r"has no record\.json"):
        bb.load(ROOT / "tests")


def test_an_mpcc_has_no_plan(tmp_path: Path) -> None:
    done = bb.plan("+scenario=pympcc")
    loaded = bb.load(done.save(tmp_path / "mpcc"))
    for one in (done, loaded):
        assert one.certified and one.plan is None and one.travel_time is None and one._repr_png_() is None
        assert "objective" in one._repr_html_()
        with pytest.raises(bb.BadInput, match="is no flight, so there is no plan to draw"):
            one.draw()
    assert done.certificate.certified
    with pytest.raises(bb.BadInput, match="of an MPCC is not stored"):
        loaded.certificate
    with pytest.raises(bb.BadInput, match="is no flight"):
        bb.certify(run(*RACE).plan, "+scenario=pympcc")


def test_runs_that_cannot_be_read_are_warned_of(tmp_path: Path) -> None:
    (tmp_path / "record.json").write_text("{}}")
    with pytest.warns(UserWarning, match=r"left out .*record\.json"):
        assert len(bb.runs(tmp_path)) == 0
    with pytest.raises(bb.BadInput, match="there is no such folder"):
        bb.runs(tmp_path / "nowhere")


def test_no_name_of_the_face_hides_a_room() -> None:
    rooms = {p.stem for p in (ROOT / "benchbench").iterdir()}
    assert not rooms & set(bb.__all__)
    assert all(getattr(bb, name) is not None for name in bb.__all__)


@pytest.mark.slow
def test_the_notebook_says_what_it_shows(tmp_path: Path) -> None:
    import nbformat  # with the kernel it takes a second that the other tests here need not wait
    from nbclient import NotebookClient

    book = nbformat.read(ROOT / "examples" / "first_steps.ipynb", 4)
    code = [cell for cell in book.cells if cell.cell_type == "code"]
    assert all(cell.outputs == [] and cell.execution_count is None for cell in code), (
        "outputs are not committed"
    )
    NotebookClient(book, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output for cell in code for output in cell.outputs]
    assert {output.output_type for output in shown} == {"execute_result", "stream"}
    kinds = [set(output.get("data", ())) for output in shown]
    assert {"text/plain", "text/html", "image/png"} in kinds, "a run"
    assert {"text/plain", "image/png"} in kinds, "a figure without pyplot"
    (said,) = (output.text for output in shown if output.output_type == "stream")
    assert "NOT certified" in said and "'motor_3' exceeds its limits" in said
    assert bb.runs(tmp_path / "results").certified.tolist() == [True, False]
