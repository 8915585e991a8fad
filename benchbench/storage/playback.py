"""A recording read back: the plan, its replay and the configuration that made it."""

from __future__ import annotations

import json
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchbench.certificate.replay import Replay
from benchbench.ground.arrays import Array
from benchbench.ground.errors import Unavailable
from benchbench.ocp.plan import Interpolation, Plan

if TYPE_CHECKING:
    from mcap.reader import McapReader

TOPICS = [
    "/plan/configuration", "/plan/velocity", "/plan/inputs", "/plan/progress",
    "/replay/configuration", "/replay/velocity",
]  # fmt: skip


@dataclass(frozen=True)
class Recording:
    """What a recording holds; `flight` is None if there was no replay, `config` the composed YAML."""

    plan: Plan
    flight: Replay | None
    config: str


@dataclass(frozen=True)
class _Table:
    names: tuple[str, ...]
    units: tuple[str, ...]
    time: Array
    values: Array


def read_mcap(path: Path) -> Recording:
    """Read what `write_mcap` wrote.

    Raises OSError where the file cannot be read, ValueError where it is cut off or no recording of a plan,
    Unavailable where the package mcap is not installed.
    """
    try:
        from mcap.exceptions import McapError
        from mcap.reader import make_reader
    except ImportError:
        raise Unavailable("recordings: mcap is not installed; pip install 'benchbench[report]'") from None
    try:
        with path.open("rb") as file:
            return _recording(make_reader(file, validate_crcs=True))
    except (OSError, ValueError):
        raise
    except McapError as error:
        raise ValueError(f"cannot be read: {type(error).__name__} {error}".rstrip()) from None
    except Exception as error:  # noqa: BLE001  # the readers of a broken file fail in many ways
        raise ValueError(f"cannot be read: {type(error).__name__}: {error}") from None


def _recording(reader: McapReader) -> Recording:
    tables, config = _tables(reader)
    missing = [topic for topic in TOPICS[:4] if topic not in tables]
    if missing:
        raise ValueError(f"no recording of a plan: {', '.join(missing)} missing")
    plan = _plan(tables)
    return Recording(plan, _flight(tables, plan), config)


def _tables(reader: McapReader) -> tuple[dict[str, _Table], str]:
    """The JSON channels by topic, and the configuration in the metadata."""
    rows: dict[str, list[dict[str, Any]]] = defaultdict(list)
    schemas: dict[str, dict[str, Any]] = {}
    for schema, channel, message in reader.iter_messages(topics=TOPICS):
        rows[channel.topic].append(json.loads(message.data))
        if schema is not None and channel.topic not in schemas:
            schemas[channel.topic] = json.loads(schema.data)
    config = next((m.metadata.get("config", "") for m in reader.iter_metadata()), "")
    return {topic: _table(schemas[topic], rows[topic]) for topic in schemas}, config


def _table(schema: dict[str, Any], rows: list[dict[str, Any]]) -> _Table:
    units = {name: field["description"] for name, field in schema["properties"].items() if name != "time"}
    values = [[np.nan if row[name] is None else row[name] for name in units] for row in rows]
    time = np.array([row["time"] for row in rows], float)
    return _Table(tuple(units), tuple(units.values()), time, np.array(values, float))


def _plan(tables: dict[str, _Table]) -> Plan:
    q, v, u, progress = (tables[topic] for topic in TOPICS[:4])
    interpolation: Interpolation = {len(q.time) - 1: "hold", len(q.time): "linear"}.get(len(u.time), "bezier")  # type: ignore[assignment]
    return Plan(
        time=q.time, configuration=q.values, velocity=v.values, inputs=u.values, progress=progress.values,
        interpolation=interpolation, coordinate_names=q.names, coordinate_units=q.units, input_names=u.names,
        input_units=u.units, velocity_names=v.names, velocity_units=v.units, stop_names=_stops(progress.names),
    )  # fmt: skip


def _stops(names: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the stops whose progress indices these are."""
    return tuple(name.removeprefix("epsilon_") if name != "epsilon" else "target" for name in names)


def _flight(tables: dict[str, _Table], plan: Plan) -> Replay | None:
    if TOPICS[4] not in tables or TOPICS[5] not in tables:
        return None
    q, v = (tables[topic] for topic in TOPICS[4:])
    nodes = np.clip(np.searchsorted(q.time, plan.time), 0, len(q.time) - 1)
    complete = bool(np.isfinite(q.values).all())
    return Replay(q.time, q.values, v.values, nodes, (), None if complete else float(q.time[-1]))
