"""Tracks as people write them: a list of gates, a YAML or a CSV file."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

import numpy as np

from benchbench.ground.errors import BadInput, unknown_field
from benchbench.ocp.reading import content, plain_yaml
from benchbench.ocp.sizes import GATES, TRACK_BYTES
from benchbench.ocp.track import EXACT, Direction, Gate, Opening, Track, Triple, triple

FIELD = "scenario.track"
OPENING = ("width", "height", "yaw", "normal", "direction")
GATE = ("x", "y", "z", "radius", "order", "speed", "heading", *OPENING)
COLUMNS = (
    *(name for name in GATE if name not in ("speed", "normal")),
    "speed_min",
    "speed_max",
    "nx",
    "ny",
    "nz",
)
"""Names in a CSV file, where a cell holds one number."""
PARTS = ("start", "lap", "end", "radius", "gates")
TRACKS = "a list of gates, or the path of a .yaml or .csv file"
FORM = "rows of x, y, z and, where wanted, radius and order, all finite numbers in m"


def read(source: str | Path | Sequence[Any], radius: float, said: bool = False) -> Track:
    """Return the track that a path (.yaml, .yml, .csv) or a list of gates gives; raises BadInput.

    radius: of gates that name none, m; where it was `said`, it wins over the file's, else the file's over it.

    A gate is [x, y, z] or a mapping of the names in `GATE`: x, y, z and optionally radius (else `radius`) and order; width
    and height of a rectangle with yaw or normal, and direction; speed, a number or [least, largest]; heading. A CSV file
    has the names in `COLUMNS` as its header, and empty cells where a gate has none. With `order` gates are sorted by it,
    else they are passed as they are listed. A YAML file holds such a list, or a mapping with `lap` and optionally start,
    end, radius, gates.
    """
    if not isinstance(source, str | Path):
        return Track(_gates(source, radius))
    path = Path(source)
    kinds = {".yaml": _yaml, ".yml": _yaml, ".csv": _csv}
    if path.suffix.lower() not in kinds:
        raise BadInput(FIELD, f"'{path}' is no track", TRACKS)
    return kinds[path.suffix.lower()](_text(path), radius, said)


def beside_the_lap(source: Any) -> dict[str, Any]:
    """Return what a track file says beside its gates, as fields of a scenario (start.x, radius); nothing for other sources."""
    if not isinstance(source, str | Path) or Path(source).suffix.lower() not in (".yaml", ".yml"):
        return {}
    try:
        found = plain_yaml(_text(Path(source)))
    except (BadInput, ValueError):
        return {}  # told when it is read
    told = found if isinstance(found, dict) else {}
    said = {name: told[name] for name in ("start", "end", "radius", "gates") if told.get(name) is not None}
    points = {name: value for name, value in said.items() if is_point(value)}
    axes = {
        f"{name}.{axis}": x for name, place in points.items() for axis, x in zip("xyz", place, strict=True)
    }
    return axes | {name: value for name, value in said.items() if name not in points}


def _text(path: Path) -> str:
    try:
        return content(path, FIELD, TRACK_BYTES, "a .yaml or .csv file").decode("utf-8-sig")
    except UnicodeDecodeError:
        raise BadInput(FIELD, f"cannot read '{path}': it is no text", "a .yaml or .csv file") from None


def _csv(text: str, radius: float, said: bool) -> Track:
    rows = list(csv.reader(line for line in text.splitlines() if line.strip() and not line.startswith("#")))
    header = [name.strip() for name in rows[0]] if rows else []
    for name in header[3:]:
        if name not in COLUMNS:
            raise unknown_field(f"{FIELD}.{name}", COLUMNS)
    if header[:3] != ["x", "y", "z"] or len(set(header)) < len(header):
        raise BadInput(
            FIELD, f"has the header '{','.join(header)[:60]}'", f"x,y,z, then of {', '.join(COLUMNS[3:])}"
        )
    for number, row in enumerate(rows[1:], 1):
        if len(row) != len(header):
            raise BadInput(f"{FIELD}, gate {number}", f"has {len(row)} columns", ",".join(header))
    return Track(_gates([_cells(header, row) for row in rows[1:]], radius))


def _cells(header: Sequence[str], row: Sequence[str]) -> dict[str, Any]:
    """Fields of a gate from the cells of a row."""
    cells: dict[str, Any] = {
        name: text.strip() for name, text in zip(header, row, strict=True) if text.strip()
    }
    speed, normal = (
        [cells.pop(name, None) for name in names]
        for names in (("speed_min", "speed_max"), ("nx", "ny", "nz"))
    )
    if any(speed):
        cells["speed"] = [speed[0] or 0.0, math.inf if speed[1] is None else speed[1]]
    return cells | ({"normal": normal} if any(normal) else {})


def _yaml(text: str, radius: float, said: bool) -> Track:
    try:
        found = plain_yaml(text)
    except ValueError as error:
        raise BadInput(FIELD, str(error)) from None
    if isinstance(found, list):
        return Track(_gates(found, radius))
    if not isinstance(found, dict) or "lap" not in found:
        raise BadInput(FIELD, "has no gates", "a list of gates, or a mapping with 'lap'")
    for key in found:
        if key not in PARTS:
            raise unknown_field(f"{FIELD}.{key}", PARTS)
    own = _number(found.get("radius", radius), f"{FIELD}.radius")
    radius = radius if said else own
    count = found.get("gates")
    if count is not None and (
        not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= GATES
    ):
        raise BadInput(f"{FIELD}.gates", f"{count!r} was given", f"a whole number from 1 to {GATES}")
    start, end = (
        None if found.get(k) is None else _point(found[k], f"{FIELD}.{k}") for k in ("start", "end")
    )
    return Track(_gates(found["lap"], radius), start, end, count)


def _gates(source: Any, radius: float) -> tuple[Gate, ...]:
    if not isinstance(source, Sequence) or isinstance(source, str) or not source:
        raise BadInput(FIELD, "has no gates" if not source else f"{source!r} was given", "one gate or more")
    if len(source) > GATES:
        raise BadInput(FIELD, f"has {len(source)} gates", f"at most {GATES}")
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
    row = {name: value for name, value in row.items() if value is not None}
    position = _point([row.get(axis) for axis in "xyz"], field)
    opening = _opening(row, field)
    if opening is None:
        own = _above(row.get("radius", radius), f"{field}, radius")
    elif "radius" in row:
        raise BadInput(f"{field}, radius", "is given beside width and height", "a ball or a rectangle")
    else:
        own = math.hypot(opening.width, opening.height) / 2
    speed = None if "speed" not in row else _range(row["speed"], f"{field}, speed")
    heading = (
        None if "heading" not in row else _number(row["heading"], f"{field}, heading", "an angle in rad")
    )
    order = None if "order" not in row else _number(row["order"], f"{field}, order")
    return order, Gate(position, own, opening, speed, heading)


def _opening(row: Mapping[str, Any], field: str) -> Opening | None:
    if not any(name in row for name in OPENING):
        return None
    for name in ("width", "height"):
        if name not in row:
            raise BadInput(
                f"{field}, {name}", "is missing", "width, height, and yaw or normal of a rectangle"
            )
    if ("yaw" in row) == ("normal" in row):
        problem = "are both given" if "yaw" in row else "are both missing"
        raise BadInput(
            f"{field}, yaw and normal", problem, "one of the two, for the direction across a rectangle"
        )
    if "yaw" in row:
        yaw = _number(row["yaw"], f"{field}, yaw", "an angle in rad")
        normal = (math.cos(yaw), math.sin(yaw), 0.0)
    else:
        given = np.array(_point(row["normal"], f"{field}, normal"))
        if not np.linalg.norm(given) > 0:
            raise BadInput(f"{field}, normal", f"{row['normal']!r} was given", "a direction [nx, ny, nz]")
        normal = triple(given / np.linalg.norm(given))
    direction = row.get("direction", "along")
    if direction not in get_args(Direction):
        raise BadInput(f"{field}, direction", f"{direction!r} was given", ", ".join(get_args(Direction)))
    width, height = (_above(row[name], f"{field}, {name}") for name in ("width", "height"))
    return Opening(normal, width, height, direction)


def _range(given: Any, field: str) -> tuple[float, float]:
    """Least and largest speed; a number stands for itself to `EXACT`."""
    allowed = "a speed in m/s, or [least, largest]"
    if isinstance(given, Sequence) and not isinstance(given, str) and len(given) == 2:
        low = _number(given[0], field, allowed)
        high = math.inf if given[1] in (None, math.inf) else _number(given[1], field, allowed)
    else:
        value = _number(given, field, allowed)
        low, high = max(value - EXACT, 0.0) if value >= 0 else value, value + EXACT
    if not 0 <= low < high:
        raise BadInput(field, f"{given!r} was given", f"{allowed}, none below 0, the first below the second")
    return low, high


def _above(value: Any, field: str) -> float:
    allowed = f"a {field.rpartition(' ')[2]} above 0 m"
    number = _number(value, field, allowed)
    if not number > 0:
        raise BadInput(field, f"{number:g} m was given", allowed)
    return number


def _point(values: Any, field: str) -> Triple:
    if not isinstance(values, Sequence) or isinstance(values, str) or len(values) != 3:
        raise BadInput(field, f"{values!r} was given", FORM)
    x, y, z = (_number(value, field) for value in values)
    return x, y, z


def is_point(values: Any) -> bool:
    """Whether there are three finite numbers."""
    try:
        _point(values, FIELD)
    except BadInput:
        return False
    return True


def _number(value: Any, field: str, allowed: str = FORM) -> float:
    try:
        number = float(value) if not isinstance(value, bool) else math.nan
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise BadInput(field, f"{value!r} was given", allowed)
    return number
