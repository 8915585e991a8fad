"""A plan from a file of any form that we know: a recording, a frame as CSV, or the CSV of people who fly."""

from __future__ import annotations

import csv
from pathlib import Path

from benchbench.ground.errors import BadInput
from benchbench.ocp.columns import TIME
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Interpolation, Plan
from benchbench.ocp.reading import plain_yaml
from benchbench.storage.attached import attached
from benchbench.storage.flight_csv import flight_of_lines, read_csv
from benchbench.storage.lines import lines_of, read_lines
from benchbench.storage.multirotor import plan_of
from benchbench.storage.playback import read_mcap


def read_plan(path: Path, model: Model, interpolation: Interpolation = "hold") -> Plan:
    """Return the plan of a model that a file holds.

    .mcap      a recording of a run, or the ROS 2 file that `benchbench export` made of one
    other      CSV: with a column `time` the frame of `Plan.to_frame`, else the columns of docs/export.md
    interpolation: "hold" or "linear", of the inputs of the latter; recordings and frames say it themselves.
    Raises BadInput for a file that cannot be used, Unavailable where recordings need a package that is not installed.
    """
    if path.suffix == ".mcap":
        text = attached(path)
        if text is None:
            return _recorded(path, model)
        return plan_of(
            flight_of_lines(lines_of(text.splitlines(), str(path)), str(path)), model, interpolation
        )
    if _is_frame(path):
        import pandas as pd

        from benchbench.storage.frame import plan_of_frame

        header, *rows = read_lines(path)
        frame = pd.DataFrame(rows, columns=header).replace(r"^\s*$", float("nan"), regex=True)
        return plan_of_frame(frame, model, str(path))
    return plan_of(read_csv(path), model, interpolation)


def of_model(plan: Plan, model: Model) -> Plan:
    """Return a plan as it is. Raises BadInput where it moves what the model does not have."""
    for ours, theirs in (
        (model.configuration.names, plan.coordinate_names), (model.velocity.names, plan.velocity_names),
        (model.inputs.names, plan.input_names),
    ):  # fmt: skip
        if ours != theirs:
            problem = f"'{model.name}' has {', '.join(ours)}, but the plan {', '.join(theirs)}"
            raise BadInput("vehicle", problem, "the vehicle of the plan")
    return plan


def _recorded(path: Path, model: Model) -> Plan:
    """Of a run: its configuration says whose plan it is; two vehicles may have the same coordinates."""
    try:
        recording = read_mcap(path)
    except (OSError, ValueError) as error:
        raise BadInput(str(path), f"is no plan that can be read: {error}", "a plan.mcap of a run") from None
    whose = _vehicle(recording.config)
    if whose not in (None, model.name):
        problem = f"'{model.name}' was asked for, but {path} is a plan of '{whose}'"
        raise BadInput("vehicle", problem, f"{whose}, or a plan of '{model.name}'")
    return of_model(recording.plan, model)


def _vehicle(config: str) -> str | None:
    """Name of the vehicle in a composed configuration; None where it says none."""
    try:
        tree = plain_yaml(config)
    except ValueError:
        return None
    vehicle = tree.get("vehicle") if isinstance(tree, dict) else None
    name = vehicle.get("name") if isinstance(vehicle, dict) else None
    return name if isinstance(name, str) else None


def _is_frame(path: Path) -> bool:
    """Whether the header of a CSV file names the time as frames do; what cannot be read is none."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            header = next(csv.reader(file), [])
    except (OSError, UnicodeDecodeError, csv.Error):
        return False
    return TIME in [name.strip() for name in header]
