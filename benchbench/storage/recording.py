"""A plan as an MCAP recording: what Foxglove or Rerun draw as protobuf, all numbers as JSON channels.

Log time is plan time in nanoseconds from 0. Any MCAP reader finds the numbers again, at full precision.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import ONLY, Plan
from benchbench.storage.entry import LogEntry, nanoseconds
from benchbench.storage.files import replacing

if TYPE_CHECKING:
    from foxglove import Context

    from benchbench.certificate.replay import Replay
    from benchbench.ocp.model import Model
    from benchbench.ocp.scenario import Scenario

CHUNK_BYTES = 64 * 1024
"""Small chunks, so that a file that was cut off keeps nearly all complete messages."""

XYZ = ("x", "y", "z")
METRES = ("m", "m", "m")
EPSILON = "epsilon"
"""Name of the progress index in a recording; of one of several stops with the stop's name behind it."""


@dataclass(frozen=True)
class Series:
    """One JSON channel: values (n, columns) at times (n,) s, with a name and a unit per column."""

    topic: str
    times: Array
    names: Sequence[str]
    units: Sequence[str]
    values: Array


def write_mcap(
    path: Path,
    plan: Plan,
    replay: Replay | None,
    scenario: Scenario,
    model: Model,
    metadata: Mapping[str, str],
) -> None:
    """Write a plan (and its replay) to `path`, atomically.

    `metadata` becomes the metadata record "benchbench" (for example the composed configuration as YAML).
    Raises BadInput("output", ...) when the file system refuses.
    """
    series = [*plan_series(plan, scenario, model), *replay_series(replay, plan, model)]
    write_series(path, plan, series, scenario, model, metadata)


def write_series(
    path: Path,
    drawn: Plan,
    series: Sequence[Series],
    scenario: Scenario,
    model: Model,
    metadata: Mapping[str, str],
) -> None:
    """Write numbers to `path`, atomically, beside what viewers draw of a motion in space; see `write_mcap`."""
    try:
        _write(path, drawn, series, scenario, model, metadata)
    except RuntimeError as error:  # what the recorder makes of a full disk
        wanted = "a folder you may write to, with free space"
        raise BadInput("output", f"cannot write {path}: {error}", wanted) from error


def _write(
    path: Path,
    drawn: Plan,
    series: Sequence[Series],
    scenario: Scenario,
    model: Model,
    metadata: Mapping[str, str],
) -> None:
    from foxglove import Context, open_mcap
    from foxglove.mcap import MCAPWriteOptions

    from benchbench.storage.scene import scene

    context = Context()
    options = MCAPWriteOptions(chunk_size=CHUNK_BYTES, compression_threads=0, profile="")
    with (
        replacing(path) as temporary,
        closing(open_mcap(temporary, context=context, writer_options=options)) as file,
    ):
        file.write_metadata("benchbench", dict(metadata))
        entries = list(scene(context, drawn, scenario, model))
        for one in series:
            entries += _numbers(context, one)
        for entry in sorted(entries, key=lambda e: e.log_time):
            entry.channel.log(entry.message, log_time=entry.log_time)


def plan_series(plan: Plan, scenario: Scenario, model: Model) -> Iterator[Series]:
    """The numbers of a plan, one row per node (for inputs per interval or control point)."""
    tool, _ = model.plant().tool(plan.configuration, plan.velocity)
    yield Series(
        "/plan/configuration", plan.time, plan.coordinate_names, plan.coordinate_units, plan.configuration
    )
    yield Series("/plan/velocity", plan.time, plan.velocity_names, plan.velocity_units, plan.velocity)
    yield Series("/plan/inputs", plan.input_times, plan.input_names, plan.input_units, plan.inputs)
    names = [EPSILON if plan.stop_names == ONLY else f"{EPSILON}_{name}" for name in plan.stop_names]
    yield Series("/plan/progress", plan.time, names, ["1"] * len(names), plan.progress_by_stop)
    yield Series("/plan/end_effector", plan.time, XYZ, METRES, tool)
    for stop in scenario.itinerary.stops:
        target, _ = sample(stop.target, plan.time)
        yield Series(f"/plan/{stop.named('target')}", plan.time, XYZ, METRES, target)


def replay_series(replay: Replay | None, plan: Plan, model: Model) -> Iterator[Series]:
    """The numbers of a replay, on its own grid; nothing without a replay."""
    if replay is None:
        return
    tool, _ = model.plant().tool(replay.configuration, replay.velocity)
    yield Series(
        "/replay/configuration",
        replay.time,
        plan.coordinate_names,
        plan.coordinate_units,
        replay.configuration,
    )
    yield Series("/replay/velocity", replay.time, plan.velocity_names, plan.velocity_units, replay.velocity)
    yield Series("/replay/end_effector", replay.time, XYZ, METRES, tool)


def _numbers(context: Context, series: Series) -> Iterator[LogEntry]:
    from foxglove import Channel

    channel = Channel(series.topic, schema=_schema(series), context=context)
    for log_time, time, row in zip(nanoseconds(series.times), series.times, series.values, strict=True):
        values = dict(zip(series.names, map(_number, row), strict=True))
        yield LogEntry(log_time, channel, {"time": float(time), **values})


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None  # JSON has no NaN; a replay may diverge


def _schema(series: Series) -> dict[str, Any]:
    fields = {"time": "s", **dict(zip(series.names, series.units, strict=True))}
    return {
        "title": "benchbench" + series.topic.replace("/", "."),
        "type": "object",
        "properties": {
            name: {"type": ["number", "null"], "description": unit} for name, unit in fields.items()
        },
        "required": list(fields),
    }
