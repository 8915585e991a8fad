"""A flight as CSV: the one place that says what its columns are; docs/export.md shows them to people.

The names are those that public racing planners and flight stacks write (Agilicious, CPC, TOGT), so their files
are read as they are; further columns are ignored.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.storage.lines import check_start, read_lines
from benchbench.storage.multirotor import MultirotorTrajectory, continuous

QUATERNION_ERROR = 1e-3
"""How far from 1 the length of a quaternion in a file may be, which writes perhaps four digits."""


@dataclass(frozen=True)
class Group:
    """Columns that belong together: the field of `MultirotorTrajectory` they hold, their unit and meaning."""

    field: str
    names: tuple[str, ...]
    unit: str
    meaning: str


GROUPS = (
    Group("time", ("t",), "s", "time, increasing"),
    Group("position", ("p_x", "p_y", "p_z"), "m", "position in the world, z up"),
    Group("quaternion", ("q_w", "q_x", "q_y", "q_z"), "1", "unit quaternion that turns body into world coordinates"),
    Group("velocity", ("v_x", "v_y", "v_z"), "m/s", "velocity in the world"),
    Group("body_rates", ("w_x", "w_y", "w_z"), "rad/s", "angular velocity about the body axes"),
    Group("thrusts", ("u_1", "u_2", "u_3", "u_4"), "N", "thrust of each motor, numbered as the vehicle's inputs"),
    Group("arm", ("arm", "arm_rate", "servo"), "rad, rad/s, N m", "arm angle, its rate and the servo torque, for a vehicle with an arm"),
    Group("progress", ("progress",), "1", "progress index by which the plan claims contact; may be left out"),
)  # fmt: skip
NEEDED = tuple(name for group in GROUPS for name in group.names if group.field not in ("arm", "progress"))


def to_csv(flight: MultirotorTrajectory) -> str:
    """Return the flight as CSV with a header, at full precision."""
    groups = [group for group in GROUPS if getattr(flight, group.field) is not None]
    values = np.column_stack([getattr(flight, group.field) for group in groups])
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([name for group in groups for name in group.names])
    writer.writerows([[repr(float(value)) for value in row] for row in values])
    return text.getvalue()


def read_csv(path: Path) -> MultirotorTrajectory:
    """Read a flight from a file with these columns in any order. Raises BadInput naming what is wrong where."""
    return flight_of_lines(read_lines(path), str(path))


def flight_of_lines(lines: list[list[str]], path: str) -> MultirotorTrajectory:
    """Return the flight that header and rows say; path: what messages call the file. Raises BadInput as `read_csv` does."""
    columns = _read(lines, path)
    missing = [name for name in NEEDED if name not in columns]
    if missing:
        raise BadInput(path, f"has no column {', '.join(missing)}", ", ".join(NEEDED))
    parts = {
        group.field: np.stack([columns[name] for name in group.names], axis=-1)
        for group in GROUPS
        if all(name in columns for name in group.names)
    }
    parts |= {name: parts[name][:, 0] for name in ("time", "progress") if name in parts}
    if not np.all(np.diff(parts["time"]) > 0):
        row = int(np.argmin(np.diff(parts["time"]))) + 3
        raise BadInput(f"{path}, line {row}: t", "is not later than the line before", "increasing times")
    check_start(float(parts["time"][0]), f"{path}, line 2: t")
    length = np.linalg.norm(parts["quaternion"], axis=1)
    if np.max(np.abs(length - 1.0)) > QUATERNION_ERROR:
        row = int(np.argmax(np.abs(length - 1.0))) + 2
        raise BadInput(f"{path}, line {row}: q_w ... q_z", "has not the length 1", "a unit quaternion")
    parts["quaternion"] = continuous(parts["quaternion"] / length[:, None])
    return MultirotorTrajectory(**parts)


def _read(lines: list[list[str]], path: str) -> dict[str, Array]:
    """All columns of numbers that are known here, by name."""
    known = {name for group in GROUPS for name in group.names}
    header = lines[0]
    if len(lines) < 3:
        raise BadInput(path, f"has {max(len(lines) - 1, 0)} rows of numbers", "a header and at least 2 rows")
    found: dict[str, Array] = {}
    for place, name in enumerate(header):
        if name in known:
            found[name] = np.array([_number(path, k, name, row, place) for k, row in enumerate(lines[1:], 2)])
    return found


def _number(path: str, line: int, name: str, row: list[str], place: int) -> float:
    text = row[place]
    try:
        value = float("" if "_" in text else text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise BadInput(f"{path}, line {line}: {name}", f"'{text}' was given", "a finite number")
    return value
