"""A plan read back from its frame, `Plan.to_frame`, whoever changed or made it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.columns import TIME, input_columns, progress_columns, stops_of, velocity_columns
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Interpolation, Plan
from benchbench.storage.lines import check_once, check_start


def plan_of_frame(frame: pd.DataFrame, model: Model, where: str = "frame") -> Plan:
    """Return the plan of a model that a frame with the columns of `Plan.to_frame`, in any order, says.

    Where no column of progress is there, the plan says nothing of contact. Further columns are ignored. where: what messages
    call the frame. Raises BadInput for a column that is missing or there twice, for what is no finite number, and for time
    that does not start at 0 and increase.
    """
    q, v, u = model.configuration, model.velocity, model.inputs
    moving = velocity_columns(q.names, v.names)
    _complete(frame, [TIME, *q.names, *moving, *u.names], where)
    time = _values(frame, [TIME], where)[:, 0]
    if len(time) < 2 or not np.all(np.diff(time) > 0):
        row = frame.index[int(np.argmin(np.diff(time))) + 1] if len(time) > 1 else len(time)
        raise BadInput(
            f"{where}, row {row}: {TIME}", "is not later than the row before", "2 rows or more, in order"
        )
    inputs, interpolation = _inputs(frame, u.names, where)
    check_start(time[0], f"{where}, row {frame.index[0]}: {TIME}")
    stops = stops_of([str(name) for name in frame.columns]) or ["target"]
    claims = [name for name in progress_columns(stops) if name in frame.columns]
    progress = _values(frame, claims, where) if claims else np.full((len(time), 1), np.nan)
    return Plan.of(
        model, time=time, configuration=_values(frame, q.names, where),
        velocity=_values(frame, moving, where), inputs=inputs,
        progress=progress[:, 0] if len(stops) == 1 else progress, interpolation=interpolation,
        stop_names=tuple(stops),
    )  # fmt: skip


def _inputs(frame: pd.DataFrame, names: Sequence[str], where: str) -> tuple[Array, Interpolation]:
    """Inputs as a plan wants them: control points where there are some, else held where the last row has none."""
    points = 1
    while f"{names[0]}.{points}" in frame.columns:
        points += 1
    columns = input_columns(names, points)
    _complete(frame, columns, where)
    if points > 1:
        return _values(frame[:-1], columns, where).reshape(-1, len(names)), "bezier"
    held = bool(frame[columns].iloc[-1].isna().all())
    return _values(frame[:-1] if held else frame, columns, where), "hold" if held else "linear"


def _complete(frame: pd.DataFrame, names: Sequence[str], where: str) -> None:
    missing = [name for name in names if name not in frame.columns]
    if missing:
        raise BadInput(where, f"has no column {', '.join(missing)}", ", ".join(names))
    check_once(list(map(str, frame.columns)), where)


def _values(frame: pd.DataFrame, names: Sequence[str], where: str) -> Array:
    """Columns as (rows, columns) finite numbers."""
    numbers = frame[list(names)].apply(pd.to_numeric, errors="coerce").to_numpy(float)
    if (bad := np.argwhere(~np.isfinite(numbers))).size:
        row, column = bad[0]
        given = frame[names[column]].iloc[row]
        place = f"{where}, row {frame.index[row]}: {names[column]}"
        raise BadInput(place, f"'{given}' was given", "a finite number")
    return numbers
