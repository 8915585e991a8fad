"""A race track: gates in the order they are passed, from YAML, CSV or the configuration itself."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml  # type: ignore[import-untyped]

from benchbench.errors import BadInput, unknown_field

FIELD = "scenario.track"
GATE = ("x", "y", "z", "radius", "order")
PARTS = ("start", "lap", "end", "radius", "gates")
FORM = "rows of x, y, z and, where wanted, radius and order, all finite numbers in m"


@dataclass(frozen=True)
class Gate:
    """A ball to be passed through: centre (x, y, z) and radius in m."""

    position: tuple[float, float, float]
    radius: float


@dataclass(frozen=True)
class Track:
    """Gates of one lap in order; start and end (x, y, z) in m and the number of gates where a file names them."""

    lap: tuple[Gate, ...]
    start: tuple[float, float, float] | None = None
    end: tuple[float, float, float] | None = None
    gates: int | None = None


def read(source: str | Path | Sequence[Any], radius: float) -> Track:
    """Return the track that a path (.yaml, .yml, .csv) or a list of gates gives; raises BadInput.

    A gate is [x, y, z] or a mapping with x, y, z and optionally radius (else `radius`) and order. A CSV file has
    these names as its header. With `order` gates are sorted by it, else they are passed as they are listed. A YAML
    file holds such a list, or a mapping with `lap` and optionally start, end, radius, gates.
    """
    if not isinstance(source, str | Path):
        return Track(_gates(source, radius))
    path = Path(source)
    kinds = {".yaml": _yaml, ".yml": _yaml, ".csv": _csv}
    if path.suffix.lower() not in kinds:
        raise BadInput(FIELD, f"'{path}' is no track", "a list of gates, or the path of a .yaml or .csv file")
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        said = error.strerror if isinstance(error, OSError) else "it is no text"
        raise BadInput(FIELD, f"cannot read '{path}': {said}", "a .yaml or .csv file") from None
    return kinds[path.suffix.lower()](text, radius)


def _csv(text: str, radius: float) -> Track:
    rows = list(csv.reader(line for line in text.splitlines() if line.strip() and not line.startswith("#")))
    header = [name.strip() for name in rows[0]] if rows else []
    if header[:3] != ["x", "y", "z"] or not set(header) <= set(GATE) or len(set(header)) < len(header):
        raise BadInput(
            FIELD, f"has the header '{','.join(header)[:60]}'", "x,y,z, then radius and order if wanted"
        )
    for number, row in enumerate(rows[1:], 1):
        if len(row) != len(header):
            raise BadInput(f"{FIELD}, gate {number}", f"has {len(row)} columns", ",".join(header))
    return Track(_gates([dict(zip(header, row, strict=True)) for row in rows[1:]], radius))


def _yaml(text: str, radius: float) -> Track:
    try:
        found = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise BadInput(FIELD, f"is no YAML: {' '.join(str(error).split())[:120]}") from None
    if isinstance(found, list):
        return Track(_gates(found, radius))
    if not isinstance(found, dict) or "lap" not in found:
        raise BadInput(FIELD, "has no gates", "a list of gates, or a mapping with 'lap'")
    for key in found:
        if key not in PARTS:
            raise unknown_field(f"{FIELD}.{key}", PARTS)
    radius = _number(found.get("radius", radius), f"{FIELD}.radius")
    count = found.get("gates")
    if count is not None and (not isinstance(count, int) or isinstance(count, bool) or count < 1):
        raise BadInput(f"{FIELD}.gates", f"{count!r} was given", "a whole number of at least 1")
    start, end = (
        None if found.get(k) is None else _point(found[k], f"{FIELD}.{k}") for k in ("start", "end")
    )
    return Track(_gates(found["lap"], radius), start, end, count)


def _gates(source: Any, radius: float) -> tuple[Gate, ...]:
    if not isinstance(source, Sequence) or isinstance(source, str) or not source:
        raise BadInput(FIELD, "has no gates" if not source else f"{source!r} was given", "one gate or more")
    found = [_gate(row, f"{FIELD}, gate {i}", radius) for i, row in enumerate(source, 1)]
    orders = [order for order, _ in found if order is not None]
    if orders and (len(orders) < len(found) or len(set(orders)) < len(orders)):
        raise BadInput(
            FIELD, "some gates have no order, or one that another has", "each gate its own, or none any"
        )
    return tuple(gate for _, gate in (sorted(found, key=lambda one: one[0] or 0.0) if orders else found))


def _gate(row: Any, field: str, radius: float) -> tuple[float | None, Gate]:
    if not isinstance(row, Mapping):
        row = dict(zip("xyz", _point(row, field), strict=True))
    for key in row:
        if key not in GATE:
            raise unknown_field(f"{field}.{key}", GATE)
    position = _point([row.get(axis) for axis in "xyz"], field)
    own = _number(row.get("radius", radius), f"{field}, radius")
    if not own > 0:
        raise BadInput(f"{field}, radius", f"{own:g} m was given", "a radius above 0 m")
    order = row.get("order")
    return None if order is None else _number(order, f"{field}, order"), Gate(position, own)


def _point(values: Any, field: str) -> tuple[float, float, float]:
    if not isinstance(values, Sequence) or isinstance(values, str) or len(values) != 3:
        raise BadInput(field, f"{values!r} was given", FORM)
    x, y, z = (_number(value, field) for value in values)
    return x, y, z


def _number(value: Any, field: str) -> float:
    try:
        number = float(value) if not isinstance(value, bool) else math.nan
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise BadInput(field, f"{value!r} was given", FORM)
    return number
