"""Names of the columns of a plan's frame: the one place that says them; docs/python.md shows them to people."""

from __future__ import annotations

from collections.abc import Sequence

TIME, NODE, PROGRESS = "time", "node", "progress"


def velocity_columns(coordinates: Sequence[str], velocities: Sequence[str]) -> list[str]:
    """Velocities by their own names; those that have the name of a coordinate get a `v_` in front."""
    return [f"v_{name}" if name in coordinates else name for name in velocities]


def input_columns(names: Sequence[str], points: int) -> list[str]:
    """Inputs by name, then the further control points of each interval, `motor_1.1`, `motor_1.2`, ..., point by point."""
    return [*names, *(f"{name}.{j}" for j in range(1, points) for name in names)]


def progress_columns(stops: Sequence[str]) -> list[str]:
    """One column where there is one stop, else one for each, with its name."""
    return [PROGRESS] if len(stops) == 1 else [f"{PROGRESS}_{stop}" for stop in stops]


def stops_of(columns: Sequence[str]) -> list[str]:
    """Names of the stops whose progress is among some columns; the one of a lone stop is "target"."""
    if PROGRESS in columns:
        return ["target"]
    return [name.removeprefix(f"{PROGRESS}_") for name in columns if name.startswith(f"{PROGRESS}_")]
