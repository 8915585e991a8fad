"""Storage: what a run leaves behind survives bad values, kills, old versions, full folders and cut files."""

from __future__ import annotations

import json
import math
import os
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from mcap.exceptions import EndOfFile
from mcap.reader import make_reader
from mcap.records import Message
from mcap.stream_reader import StreamReader
from scipy.spatial.transform import Rotation

from benchbench.certificate.replay import Replay, replay
from benchbench.ground.errors import BadInput
from benchbench.ocp.handover import Handover
from benchbench.ocp.plan import Plan
from benchbench.storage import provenance, table
from benchbench.storage.collect import collect
from benchbench.storage.files import replacing, write_bytes, write_record
from benchbench.storage.formats import WRITERS, format_of
from benchbench.storage.recording import write_mcap
from benchbench.storage.schema import COLUMNS, SCHEMA_VERSION, Status, make_record
from benchbench_plugins.contacts.position import Position
from benchbench_plugins.contacts.velocity import Velocity
from benchbench_plugins.models.aerial_manipulator import AerialManipulator
from benchbench_plugins.motions.circle import Circle

ROOT = Path(__file__).resolve().parents[1]


def vehicle() -> AerialManipulator:
    """Aerial manipulator with the paper's numerical parameters and round limits."""
    return AerialManipulator(
        name="test", quadrotor_mass=1.659, arm_mass=0.36, quadrotor_inertia=(0.035, 0.046, 0.07),
        arm_inertia=(0.001, 0.002, 0.001), arm_length=0.182, arm_offset=0.05, frame=0.33,
        torque_coefficient=0.013, motor_force=(2.0, 6.1), servo_torque=(-2, 2), tilt=0.785,
        arm_angle=(1.05, 2.09), speed=(1.3, 1.3, 1.15), angular_rate=(8, 8, 2), arm_rate=1.57,
    )  # fmt: skip


def task() -> Handover:
    """A target on a circle that is touched."""
    return Handover(
        name="test", start={"z": 0.65, "arm": 1.57}, end={"x": 2.5, "z": 0.65, "arm": 1.57},
        target=Circle((1.1, 0, 0.4), 0.4, -0.3, np.pi / 2),
        contacts={"position": Position(), "velocity": Velocity()},
    )  # fmt: skip


@cache
def plan_and_flight() -> tuple[Plan, Replay]:
    """Forty held inputs near hover, flown by the plant: a plan that is exactly what its replay does."""
    model, rng, n = vehicle(), np.random.default_rng(3), 40
    time = np.append(np.linspace(0.0, 1.1, n), 1.2)
    inputs = model.hover() + rng.normal(scale=[0.05] * 4 + [0.002], size=(n, 5))
    q = np.zeros((n + 1, 7))
    q[0] = [0.1, -0.2, 0.65, 0.05, -0.1, 0.3, 1.5]
    progress = np.zeros(n + 1)
    progress[[20, 21]] = 1.0

    def plan(q: np.ndarray, v: np.ndarray) -> Plan:
        c, u = model.configuration, model.inputs
        return Plan(time, q, v, inputs, progress, "hold", c.names, c.units, u.names, u.units)

    flight = replay(plan(q, np.zeros_like(q)), model.plant())
    return plan(flight.configuration[flight.nodes], flight.velocity[flight.nodes]), flight


def test_every_column_is_documented_once() -> None:
    names = [column.name for column in COLUMNS]
    assert len(names) == len(set(names))
    assert all(column.meaning for column in COLUMNS)
    for suffix, unit in (("_s", "s"), ("_rad", "rad"), ("_m", "m"), ("_mb", "MB")):
        assert {c.unit for c in COLUMNS if c.name.endswith(suffix)} == {unit}
    assert "hostname" not in names


def test_record_is_complete_and_ordered() -> None:
    record = make_record(status=Status.TIMEOUT)
    assert list(record) == [column.name for column in COLUMNS]
    assert record["schema_version"] == SCHEMA_VERSION
    assert type(record["status"]) is str and record["status"] == "timeout"
    assert record["travel_time_s"] is None


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, np.float64("nan"), np.float32("inf")])
def test_record_has_no_nan_or_infinity(value: float) -> None:
    assert make_record(travel_time_s=value)["travel_time_s"] is None


def test_record_holds_plain_python_values() -> None:
    record = make_record(
        iterations=np.int64(3), objective=np.float32(0.5), certified=np.bool_(True), wall_s=2
    )
    assert [type(record[n]) for n in ("iterations", "objective", "certified", "wall_s")] == [
        int,
        float,
        bool,
        float,
    ]
    assert json.loads(json.dumps(record, allow_nan=False)) == record


@pytest.mark.parametrize(
    "wrong",
    [{"travel_tme_s": 1.0}, {"iterations": 2.5}, {"iterations": True}, {"certified": 1}, {"objective": "2.7"},
     {"solver": 3}, {"reasons": "one text"}, {"reasons": [1]}],
)  # fmt: skip
def test_record_refuses_unknown_names_and_wrong_types(wrong: dict[str, object]) -> None:
    with pytest.raises(TypeError, match=next(iter(wrong))):
        make_record(**wrong)


def test_record_refuses_unknown_status() -> None:
    with pytest.raises(ValueError, match="solved"):
        make_record(status="solved")


def test_every_status_says_what_to_do() -> None:
    assert {str(s) for s in Status} == {
        "certified", "uncertified", "infeasible", "iteration_limit", "time_limit", "timeout", "crash",
        "out_of_memory", "pruned", "unavailable", "incompatible", "bad_input", "error",
    }  # fmt: skip
    assert all(s.message and s.remedy for s in Status)
    assert len({s.message for s in Status}) == len(Status)


def test_provenance_fills_its_columns() -> None:
    found = provenance.collect()
    record = make_record(**found)
    names = [column.name for column in COLUMNS]
    assert set(found) == set(names[names.index("benchbench_version") :]) - {"solver_version"}
    assert record["numpy_version"] == np.__version__
    assert record["cpu_count"] >= 1 and record["cpu"] and record["started_at"].endswith("+00:00")


def test_threads_setting() -> None:
    assert [provenance.threads(s) for s in ("4", "2,1", "", None, "many")] == [4, 2, None, None, None]


def test_git_state_of_a_checkout(tmp_path: Path) -> None:
    def git(*arguments: str) -> str:
        who = ["-c", "user.name=a", "-c", "user.email=a@b"]
        return subprocess.run(
            ["git", "-C", str(tmp_path), *who, *arguments], check=True, capture_output=True, text=True
        ).stdout.strip()

    assert provenance.git_state(tmp_path) == (None, None)
    git("init", "-q")
    assert provenance.git_state(tmp_path) == (None, None)
    (tmp_path / "file").write_text("a")
    git("add", "file")
    git("commit", "-q", "-m", "a")
    assert provenance.git_state(tmp_path) == (git("rev-parse", "HEAD"), False)
    (tmp_path / "file").write_text("b")
    assert provenance.git_state(tmp_path) == (git("rev-parse", "HEAD"), True)
    (tmp_path / "site-packages").mkdir()
    assert provenance.git_state(tmp_path / "site-packages") == (None, None)


def test_git_state_without_git(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert provenance.git_state(ROOT) == (None, None)


def test_table_returns_what_was_stored(tmp_path: Path) -> None:
    record = make_record(
        run_id="b", status="uncertified", certified=False, reasons=["too fast", "too far"], iterations=2**40,
        travel_time_s=0.1 + 0.2, solver="ipöpt",
    )  # fmt: skip
    table.append(record, tmp_path)
    table.append(make_record(run_id="a", status="certified"), tmp_path)
    rows = table.read(tmp_path)
    assert list(rows.columns) == list(record)
    assert list(rows.run_id) == ["a", "b"]
    row = rows.iloc[1]
    assert row.travel_time_s == 0.1 + 0.2 and row.iterations == 2**40 and row.solver == "ipöpt"
    assert list(row.reasons) == ["too fast", "too far"] and row.certified is np.False_
    assert rows.iterations.isna().tolist() == [True, False]
    assert len(rows[rows.certified.fillna(False)]) == 0


def test_empty_table_has_all_columns(tmp_path: Path) -> None:
    assert list(table.read(tmp_path).columns) == [column.name for column in COLUMNS]


def test_same_run_replaces_its_row(tmp_path: Path) -> None:
    for solver in ("old", "new"):
        table.append(make_record(run_id="a", solver=solver), tmp_path)
    assert table.read(tmp_path).solver.tolist() == ["new"]


@pytest.mark.parametrize("run_id", [None, "", "../a", "a/b", ".a", "a b"])
def test_run_id_must_be_a_file_name(run_id: str | None, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="run_id"):
        table.append(make_record(run_id=run_id), tmp_path)
    assert not list(tmp_path.rglob("*.parquet"))


def _append(job: tuple[Path, int]) -> None:
    root, i = job
    table.append(make_record(run_id=f"run{i:03}", iterations=i), root)


def test_concurrent_runs_keep_every_row(tmp_path: Path) -> None:
    with ProcessPoolExecutor(2) as pool:
        list(pool.map(_append, [(tmp_path, i) for i in range(60)]))
    assert table.read(tmp_path).iterations.tolist() == list(range(60))


def test_killed_writer_leaves_earlier_rows(tmp_path: Path) -> None:
    table.append(make_record(run_id="early"), tmp_path)
    code = (
        "import sys; from pathlib import Path\n"
        "from benchbench.storage import table; from benchbench.storage.schema import make_record\n"
        "root = Path(sys.argv[1])\n"
        "while True: table.append(make_record(run_id='late', solver='x' * 10**6), root)\n"
    )
    writer = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)], env={**os.environ, "PYTHONPATH": str(ROOT)}
    )
    until = time.monotonic() + 60
    while not (tmp_path / "table" / "late.parquet").exists() and time.monotonic() < until:
        time.sleep(0.01)
    writer.send_signal(signal.SIGKILL)
    writer.wait()
    rows = table.read(tmp_path)
    assert rows.run_id.tolist() == ["early", "late"] and rows.solver[1] == "x" * 10**6


def test_leftovers_do_not_break_reading(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = table.append(make_record(run_id="good"), tmp_path)
    path.with_name(".half.parquet.123.tmp").write_bytes(path.read_bytes()[:100])
    assert table.read(tmp_path).run_id.tolist() == ["good"] and not caplog.records
    path.with_name("broken.parquet").write_bytes(path.read_bytes()[:100])
    assert table.read(tmp_path).run_id.tolist() == ["good"]
    assert "broken.parquet" in caplog.text


def test_older_rows_still_open(tmp_path: Path) -> None:
    table.append(make_record(run_id="new", iterations=3), tmp_path)
    old = pa.table({"run_id": ["old"], "schema_version": pa.array([0], pa.int32()), "gone": [1.0]})
    pq.write_table(old, tmp_path / "table" / "old.parquet")
    rows = table.read(tmp_path)
    assert rows.schema_version.tolist() == [SCHEMA_VERSION, 0]
    assert rows.iterations[0] == 3 and pd.isna(rows.iterations[1]) and "gone" not in rows


def test_a_record_of_version_1_still_opens(tmp_path: Path) -> None:
    path = Path(__file__).parent / "records" / "version_1.json"
    stored, found = json.loads(path.read_text()), table.load_record(path)
    gaps = {"position": "distance_m", "velocity": "speed_gap_mps", "heading": "heading_error_rad"}
    gone = {name: stored.pop(f"contact_max_{column}") for name, column in gaps.items()}
    assert found["schema_version"] == 1 and {name: found[name] for name in stored} == stored
    assert found["contact_gaps"] == gone
    assert found["contact_gaps_said"] == ["19.1 mm apart", "10.5 mm/s relative", "99.9 mrad off heading"]
    new = {name for name in found if name not in stored and found[name] is not None}
    assert new == {"contact_gaps", "contact_gaps_said"}
    table.append(found, tmp_path)
    (row,) = table.read(tmp_path).to_dict("records")
    assert row["travel_time_s"] == stored["travel_time_s"] and row["contact_gaps"] == gone


def test_a_record_and_a_row_of_version_2_say_the_same(tmp_path: Path) -> None:
    folder = Path(__file__).parent / "records"
    found = table.load_record(folder / "version_2.json")
    (tmp_path / "table").mkdir()
    shutil.copy(folder / "version_2.parquet", tmp_path / "table")
    (row,) = table.read(tmp_path).to_dict("records")
    for name in ("contact_gaps", "travel_time_s", "gap_percent", "stops"):
        assert row[name] == found[name], name
    assert list(row["contact_gaps_said"]) == found["contact_gaps_said"] != []
    collected = collect([tmp_path]).rows.to_pylist()[0]
    assert dict(collected["contact_gaps"]) == found["contact_gaps"]


def test_export(tmp_path: Path) -> None:
    table.append(make_record(run_id="a", reasons=["x | y", "z"], objective=1 / 3, certified=True), tmp_path)
    table.append(make_record(run_id="b"), tmp_path)
    rows = collect([tmp_path]).rows
    for suffix in ("parquet", "csv", "md"):
        path = tmp_path / f"all.{suffix}"
        path.write_bytes(WRITERS[format_of(path)](rows))
    whole, text = pd.read_parquet(tmp_path / "all.parquet"), pd.read_csv(tmp_path / "all.csv")
    assert list(whole.columns) == list(text.columns) == [column.name for column in COLUMNS]
    assert whole.objective[0] == text.objective[0] == 1 / 3
    assert text.reasons[0] == "x | y; z"
    lines = (tmp_path / "all.md").read_text().splitlines()
    assert lines[0] == "| schema_version | run_id | certified | reasons | objective |"
    assert lines[2] == f"| {SCHEMA_VERSION} | a | True | x \\| y; z | 0.333333 |" and len(lines) == 4
    meanings = pq.read_schema(tmp_path / "all.parquet").field("wall_s").metadata
    assert meanings[b"unit"] == b"s" and meanings[b"meaning"]
    with pytest.raises(BadInput, match="csv"):
        format_of(tmp_path / "all.xlsx")


def test_record_file_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    path = write_record(tmp_path, make_record(run_id="a"))
    with pytest.raises(ValueError, match="JSON"):
        write_record(tmp_path, {"x": math.nan})
    with pytest.raises(KeyboardInterrupt), replacing(path) as temporary:
        temporary.write_text("half")
        raise KeyboardInterrupt
    assert json.loads(path.read_text())["run_id"] == "a"
    assert [p.name for p in tmp_path.iterdir()] == ["record.json"]


def test_unwritable_folder_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(BadInput, match=r"output: cannot write into .*file.*allowed: a folder") as caught:
        write_bytes(tmp_path / "file" / "record.json", b"x")
    assert caught.value.field == "output"


def test_full_disk_is_named(tmp_path: Path) -> None:
    pytest.importorskip("resource", reason="needs a limit on file size")
    code = (
        "import resource, signal, sys; from pathlib import Path\n"
        "from benchbench.storage.files import write_bytes; from benchbench.ground.errors import BadInput\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        "try: write_bytes(Path(sys.argv[1]) / 'record.json', b'x' * 5000)\n"
        "except BadInput as error: print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert f"cannot write into {tmp_path}" in done.stdout and "free space" in done.stdout
    assert not list(tmp_path.iterdir())


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("mcap") / "plan.mcap"
    plan, flight = plan_and_flight()
    write_mcap(path, plan, flight, task(), vehicle(), {"config": "scenario: test\n", "run_id": "a"})
    return path


def _channel(path: Path, topic: str) -> tuple[list[int], list[dict[str, float]]]:
    with path.open("rb") as file:
        found = [(m.log_time, json.loads(m.data)) for _, _, m in make_reader(file).iter_messages([topic])]
    return [log_time for log_time, _ in found], [values for _, values in found]


@pytest.mark.parametrize(
    ("topic", "of", "names"),
    [("/plan/configuration", "configuration", "coordinate_names"), ("/plan/velocity", "velocity", "coordinate_names"),
     ("/plan/inputs", "inputs", "input_names")],
)  # fmt: skip
def test_recording_gives_the_plan_back(recording: Path, topic: str, of: str, names: str) -> None:
    plan, _ = plan_and_flight()
    log_times, rows = _channel(recording, topic)
    values = np.array([[row[name] for name in getattr(plan, names)] for row in rows])
    assert values.shape == getattr(plan, of).shape and np.abs(values - getattr(plan, of)).max() < 1e-9
    assert np.abs(np.array(log_times) * 1e-9 - plan.time[: len(rows)]).max() < 1e-9
    assert np.abs([row["time"] for row in rows] - plan.time[: len(rows)]).max() < 1e-9


def test_recording_has_contact_target_and_replay(recording: Path) -> None:
    plan, flight = plan_and_flight()
    assert [row["epsilon"] for row in _channel(recording, "/plan/progress")[1]] == plan.progress.tolist()
    target = np.array([[row[a] for a in "xyz"] for row in _channel(recording, "/plan/target")[1]])
    circle = [
        1.1 + 0.4 * np.sin(0.3 * plan.time),
        0.4 * np.cos(0.3 * plan.time),
        np.full_like(plan.time, 0.4),
    ]
    assert np.abs(target - np.stack(circle, axis=-1)).max() < 1e-9
    tool = np.array([[row[a] for a in "xyz"] for row in _channel(recording, "/plan/end_effector")[1]])
    symbolic = np.array([_tool_by_casadi(q).ravel() for q in plan.configuration])
    assert np.abs(tool - symbolic).max() < 1e-9
    flown = _channel(recording, "/replay/configuration")[1]
    assert len(flown) == len(flight.time) and flown[-1]["z"] == flight.configuration[-1, 2]


def _tool_by_casadi(q: np.ndarray) -> np.ndarray:
    import casadi as ca

    symbol = ca.SX.sym("q", 7)
    return np.asarray(ca.Function("tool", [symbol], [vehicle().tool(symbol)])(q))


def test_recording_units_metadata_and_chunks(recording: Path) -> None:
    with recording.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert [m.metadata for m in reader.iter_metadata()] == [{"config": "scenario: test\n", "run_id": "a"}]
        by_topic = {c.topic: summary.schemas[c.schema_id] for c in summary.channels.values()}
        assert sum(1 for _ in reader.iter_messages()) == summary.statistics.message_count
    fields = json.loads(by_topic["/plan/inputs"].data)["properties"]
    assert fields["servo"]["description"] == "N m" and fields["motor_1"]["description"] == "N"
    drawn = {topic: schema.name for topic, schema in by_topic.items() if schema.encoding == "protobuf"}
    assert drawn == {
        "/tf": "foxglove.FrameTransforms", "/scene": "foxglove.SceneUpdate",
        "/path/vehicle": "foxglove.PosesInFrame", "/path/end_effector": "foxglove.PosesInFrame",
        "/path/target": "foxglove.PosesInFrame",
    }  # fmt: skip
    assert (
        max(c.uncompressed_size for c in summary.chunk_indexes) < 128 * 1024
        and len(summary.chunk_indexes) > 3
    )


def test_cut_recording_keeps_its_messages(recording: Path, tmp_path: Path) -> None:
    whole = recording.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: len(whole) * 6 // 10])
    kept: list[int] = []
    with cut.open("rb") as file, pytest.raises(EndOfFile):
        for record in StreamReader(file).records:
            if isinstance(record, Message):
                kept.append(record.log_time)  # noqa: PERF401  # the reader raises at the cut
    with recording.open("rb") as file:
        total = sum(1 for _ in make_reader(file).iter_messages())
    assert len(kept) > 0.4 * total
    assert kept == sorted(kept)


def test_vehicle_pose_matches_scipy() -> None:
    from benchbench.storage.multirotor import vehicle_pose

    q = np.random.default_rng(0).normal(size=(50, 7))
    position, quaternion = vehicle_pose(vehicle().configuration.names, q)
    expected = Rotation.from_euler("ZYX", q[:, [5, 4, 3]])
    assert np.abs((Rotation.from_quat(quaternion) * expected.inv()).magnitude()).max() < 1e-12
    assert np.array_equal(position, q[:, :3])
    upright = vehicle_pose(("angle",), q[:2, :1])
    assert np.array_equal(upright[0], np.zeros((2, 3))) and np.array_equal(upright[1], [[0, 0, 0, 1]] * 2)


def test_replay_that_broke_down_is_valid_json(tmp_path: Path) -> None:
    plan, flight = plan_and_flight()
    broken = Replay(flight.time, flight.configuration * np.nan, flight.velocity, flight.nodes, (), 0.5)
    write_mcap(tmp_path / "p.mcap", plan, broken, task(), vehicle(), {})
    assert {row["x"] for row in _channel(tmp_path / "p.mcap", "/replay/configuration")[1]} == {None}


def test_two_recordings_in_one_process_are_independent(tmp_path: Path) -> None:
    plan, _ = plan_and_flight()
    counts = []
    for name in ("a", "b"):
        write_mcap(tmp_path / f"{name}.mcap", plan, None, task(), vehicle(), {})
        counts.append(len(_channel(tmp_path / f"{name}.mcap", "/plan/configuration")[0]))
    assert counts == [len(plan.time)] * 2
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.mcap", "b.mcap"]


def test_importing_storage_does_not_load_foxglove() -> None:
    code = (
        "import sys, benchbench.storage.recording, benchbench.storage.table; print('foxglove' in sys.modules)"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
    )
    assert done.stdout.strip() == "False"
