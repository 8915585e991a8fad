"""`benchbench export`: what is written, read back by other people's readers."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from flights import crossing, table_one
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from scipy.spatial.transform import Rotation
from test_storage import task

from benchbench.cli import application
from benchbench.ground.arrays import Array
from benchbench.ocp.plan import Plan
from benchbench.storage.flight_csv import read_csv
from benchbench.storage.recording import write_mcap


@pytest.fixture(scope="module")
def plan() -> Plan:
    return crossing(table_one())


@pytest.fixture(scope="module")
def folder(plan: Plan, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run's folder with a plan."""
    found = tmp_path_factory.mktemp("run")
    write_mcap(found / "plan.mcap", plan, None, task(), table_one(), {"config": "seed: 7"})
    return found


def test_ros2_messages_say_what_the_plan_says(folder: Path, plan: Plan, tmp_path: Path) -> None:
    out = tmp_path / "flight.mcap"
    assert application.start(["export", str(folder), "--output", str(out)]) == 0
    with out.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        found = {
            channel.topic: (schema.name, message)
            for schema, channel, _, message in reader.iter_decoded_messages()
        }
        assert [m.metadata for m in reader.iter_metadata()] == [{"config": "seed: 7"}]
    (body_type, body), (arm_type, arm) = found["/body_trajectory"], found["/arm_trajectory"]
    assert (body_type, arm_type) == tuple(f"trajectory_msgs/msg/{x}JointTrajectory" for x in ("MultiDOF", ""))
    assert body.header.frame_id == "world" and list(arm.joint_names) == ["arm"]
    q, v = plan.configuration, plan.velocity
    assert np.allclose(_vectors([p.transforms[0].translation for p in body.points]), q[:, :3], atol=1e-14)
    turn = Rotation.from_quat([[r.x, r.y, r.z, r.w] for r in (p.transforms[0].rotation for p in body.points)])
    assert (turn.inv() * Rotation.from_euler("ZYX", q[:, 5:2:-1])).magnitude().max() < 1e-12
    assert np.allclose(_vectors([p.velocities[0].linear for p in body.points]), v[:, :3], atol=1e-14)
    h = 1e-5
    later, before = (Rotation.from_euler("ZYX", (q + s * h * v)[:, 5:2:-1]) for s in (1, -1))
    spin = (later * before.inv()).as_rotvec() / (2 * h)
    assert np.allclose(_vectors([p.velocities[0].angular for p in body.points]), spin, atol=1e-8)
    assert np.allclose([[*p.positions, *p.velocities] for p in arm.points], np.stack([q[:, 6], v[:, 6]], 1))
    assert np.allclose([p.effort[0] for p in arm.points[:-1]], plan.inputs[:, 4])
    for message in (body, arm):
        since = [p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in message.points]
        assert np.allclose(since, plan.time, rtol=0.0, atol=1e-9)


def _vectors(vectors: list) -> Array:  # type: ignore[type-arg]
    return np.array([[p.x, p.y, p.z] for p in vectors])


def test_csv_of_a_run(folder: Path, plan: Plan, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "flight.csv"
    assert application.start(["export", str(folder / "plan.mcap"), "--output", str(out)]) == 0
    flight = read_csv(out)
    assert np.array_equal(flight.position, plan.configuration[:, :3])
    assert np.array_equal(flight.thrusts[:-1], plan.inputs[:, :4])
    assert f"21 points, {plan.travel_time:.4f} s with its arm" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("output", "what"),
    [("flight.bag", "--format"), ("plan.mcap", "the plan itself")],
)
def test_bad_outputs_are_refused(
    folder: Path, output: str, what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert application.start(["export", str(folder), "--output", str(folder / output)]) == 2
    assert what in capsys.readouterr().err


def test_no_plan_is_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "plan.mcap").write_bytes(b"\x89MCAP0\r\n" + bytes(40))
    assert application.start(["export", str(tmp_path), "--output", "x.csv"]) == 2
    assert application.start(["export", str(tmp_path / "empty"), "--output", "x.csv"]) == 2
    assert "does not exist" in capsys.readouterr().err


@pytest.mark.parametrize("place", [0.1, 0.3])
def test_a_damaged_plan_is_bad_input_and_never_another_plan(
    folder: Path, place: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = (folder / "plan.mcap").read_bytes()
    at = int(place * len(content))
    (tmp_path / "plan.mcap").write_bytes(content[:at] + bytes(40) + content[at + 40 :])
    assert application.start(["export", str(tmp_path), "--output", str(tmp_path / "x.csv")]) == 2
    first, second = capsys.readouterr().err.splitlines()
    assert first == "benchbench: bad input" and "is no plan that can be read" in second
    assert not (tmp_path / "x.csv").exists()


@pytest.mark.skipif(shutil.which("rerun") is None, reason="rerun-sdk is not installed")
def test_rerun_reads_a_recording(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "plan.rrd"
    command = ["rerun", "mcap", "convert", str(folder / "plan.mcap"), "-o", str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "ERROR" not in done.stderr, done.stderr
    printed = subprocess.run(["rerun", "rrd", "print", str(out)], capture_output=True, text=True, check=True)
    for entity in ("/tf", "/path/vehicle", "/plan/configuration"):
        assert entity in printed.stdout
