"""Flights: plans as CSV and back, against SciPy's rotations and central differences."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from flights import crossing, table_one
from scipy.spatial.transform import Rotation

from benchbench.ground.errors import BadInput
from benchbench.ocp.plan import Plan
from benchbench.storage.flight_csv import NEEDED, read_csv, to_csv
from benchbench.storage.multirotor import MultirotorTrajectory, plan_of, trajectory_of
from benchbench_plugins.models.quadrotor import Quadrotor

RACER = Quadrotor("racer", 0.85, (0.001, 0.001, 0.0017), 0.15, 0.05, (0.0, 6.9), (15.0, 15.0, 0.3))


def wild(n: int = 40) -> Plan:
    """The arm's vehicle on a smooth path that turns about all axes; the inputs mean nothing."""
    model, time = table_one(), np.linspace(0.0, 2.0, n)
    phase = np.arange(7) + time[:, None] * (1.0 + 0.3 * np.arange(7))
    q, v = 0.8 * np.sin(phase), 0.8 * np.cos(phase) * (1.0 + 0.3 * np.arange(7))
    u = model.hover() + np.random.default_rng(1).normal(size=(n, 5))
    c, i = model.configuration, model.inputs
    return Plan(time, q, v, u, np.zeros(n), "linear", c.names, c.units, i.names, i.units)


def written(flight: MultirotorTrajectory, path: Path) -> Path:
    path.write_text(to_csv(flight))
    return path


def test_the_quaternion_and_the_body_rates_are_those_of_the_motion() -> None:
    plan = wild()
    flight, h = trajectory_of(plan), 1e-5
    angles = plan.configuration[:, 3:6]
    turn = Rotation.from_euler("ZYX", angles[:, ::-1])
    assert np.allclose(Rotation.from_quat(flight.quaternion, scalar_first=True).as_matrix(), turn.as_matrix())
    later, before = (
        Rotation.from_euler("ZYX", (angles + s * h * plan.velocity[:, 3:6])[:, ::-1]) for s in (1, -1)
    )
    assert np.allclose(flight.body_rates, (before.inv() * later).as_rotvec() / (2 * h), atol=1e-8)
    assert np.all(np.sum(flight.quaternion[1:] * flight.quaternion[:-1], axis=1) > 0)


@pytest.mark.parametrize("made", [wild, lambda: crossing(table_one())], ids=["linear", "hold"])
def test_a_plan_survives_the_file(made: Callable[[], Plan], tmp_path: Path) -> None:
    plan = made()
    flight = read_csv(written(trajectory_of(plan), tmp_path / "flight.csv"))
    found = plan_of(flight, table_one(), plan.interpolation)
    for part in ("time", "configuration", "velocity", "inputs"):
        assert np.allclose(getattr(found, part), getattr(plan, part), rtol=0.0, atol=1e-12), part


def test_a_vehicle_in_quaternions_without_arm(tmp_path: Path) -> None:
    flight = trajectory_of(wild())
    bare = MultirotorTrajectory(**{**vars(flight), "arm": None})
    plan = plan_of(read_csv(written(bare, tmp_path / "flight.csv")), RACER, "linear")
    again = trajectory_of(plan)
    assert again.arm is None and plan.velocity_names == RACER.velocity.names
    for part in ("position", "quaternion", "velocity", "body_rates", "thrusts"):
        assert np.allclose(getattr(again, part), getattr(flight, part), rtol=0.0, atol=1e-14), part
    with pytest.raises(BadInput, match="arm"):
        plan_of(bare, table_one(), "linear")


def test_further_columns_blanks_and_their_order_do_not_matter(tmp_path: Path) -> None:
    path = written(trajectory_of(wild()), tmp_path / "flight.csv")
    wanted = read_csv(path)
    rows = [line.split(",") for line in path.read_text().splitlines()]
    path.write_text("\n".join(", ".join([*reversed(row), f"jerk{k}"]) for k, row in enumerate(rows)) + "\n\n")
    found = read_csv(path)
    assert all(np.array_equal(getattr(found, part), getattr(wanted, part)) for part in vars(wanted))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda lines: [lines[0].replace("w_y", "omega_y"), *lines[1:]], "has no column w_y"),
        (lambda lines: [*lines[:3], lines[2], *lines[3:]], "line 4: t: is not later"),
        (lambda lines: [lines[0], lines[1], "1.0" + ",0.6" * (len(NEEDED) + 2)], "line 3: q_w ... q_z: has not the length 1"),
        (lambda lines: [lines[0], lines[1], lines[2].replace(lines[2].split(",")[2], "nan")], "line 3: p_y"),
        (lambda lines: [*lines[:3], "1.9,2.0"], "line 4: p_y: '' was given"),
        (lambda lines: lines[:2], "1 rows"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_with_its_line(change, message: str, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    path = written(trajectory_of(wild(8)), tmp_path / "flight.csv")
    path.write_text("\n".join(change(path.read_text().splitlines())))
    with pytest.raises(BadInput, match=message):
        read_csv(path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda rows: [[*row, row[1]] for row in rows], "has two columns p_x"),
        (lambda rows: [rows[0], *([repr(float(row[0]) + 1), *row[1:]] for row in rows[1:])], "line 2: t: starts at 1 s"),
        (lambda rows: [*rows[:3], [*rows[3], "7"], *rows[4:]], "line 4: has 22 cells, the header has 21"),
    ],
    ids=["twice", "late", "longer"],
)  # fmt: skip
def test_what_could_be_meant_in_two_ways_is_refused(change, message: str, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    path = written(trajectory_of(wild(8)), tmp_path / "flight.csv")
    rows = [line.split(",") for line in path.read_text().splitlines()]
    path.write_text("\n".join(map(",".join, change(rows))))
    with pytest.raises(BadInput, match=message):
        read_csv(path)


def test_a_mark_of_the_byte_order_is_no_part_of_a_name(tmp_path: Path) -> None:
    path = written(trajectory_of(wild(8)), tmp_path / "flight.csv")
    plain = read_csv(path)
    path.write_text(path.read_text(), encoding="utf-8-sig")
    assert np.array_equal(read_csv(path).time, plain.time)


def test_a_column_of_no_progress_says_that_there_is_no_contact(tmp_path: Path) -> None:
    """Without the column the file says nothing of contact, and the longest one is looked for."""
    path = written(trajectory_of(wild(8)), tmp_path / "flight.csv")
    assert np.isnan(plan_of(read_csv(path), table_one(), "linear").progress).all()
    head, *rows = path.read_text().splitlines()
    path.write_text("\n".join([f"{head},progress", *(f"{row},0.0" for row in rows)]))
    assert np.array_equal(plan_of(read_csv(path), table_one(), "linear").progress, np.zeros(8))
