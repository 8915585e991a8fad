"""How the solves of a run converged, iteration by iteration: kept as CSV in the metadata of its recording."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from benchbench.ground.errors import Unavailable

NAME = "convergence"
"""Key of the metadata."""
COLUMNS = ("solve", "stage", "iteration", "cpu_s", "objective", "violation")


class Solve(Protocol):
    """What is known of a solve: its stage, its CPU time in s, objective and violation by iteration."""

    @property
    def stage(self) -> str:
        """Name."""

    @property
    def total(self) -> float:
        """CPU time, s."""

    @property
    def trace(self) -> Sequence[tuple[float, float]]:
        """Objective, worst violation."""


@dataclass(frozen=True)
class Iterate:
    """One iteration of a run; `iteration` and `cpu_s` count from its first solve on, `solve` its solves from 0."""

    solve: int
    stage: str
    iteration: int
    cpu_s: float
    objective: float
    violation: float


def text(solves: Iterable[Solve]) -> str:
    """Return the iterations of all solves that tell of them as CSV, "" where none does.

    The CPU time of a solve is spread evenly over its iterations: no library says it for each.
    """
    out = io.StringIO()
    rows = csv.writer(out, lineterminator="\n")
    before, count = 0.0, 0
    for number, solve in enumerate(solves):
        steps = max(len(solve.trace) - 1, 1)
        for i, (objective, violation) in enumerate(solve.trace):
            spent = before + solve.total * i / steps
            rows.writerow(
                [number, solve.stage, count + i, f"{spent:.6g}", f"{objective:.9g}", f"{violation:.4g}"]
            )
        before, count = before + solve.total, count + (steps if solve.trace else 0)
    return f"{','.join(COLUMNS)}\n{out.getvalue()}" if out.getvalue() else ""


def parsed(told: str) -> list[Iterate]:
    """Read what `text` wrote; raises ValueError for anything else."""
    lines = list(csv.reader(io.StringIO(told)))
    if not lines or tuple(lines[0]) != COLUMNS or any(len(line) != len(COLUMNS) for line in lines):
        raise ValueError(f"no convergence: {', '.join(COLUMNS)} are its columns")
    return [
        Iterate(int(solve), stage, int(i), float(cpu), float(f), float(c))
        for solve, stage, i, cpu, f, c in lines[1:]
    ]


def read(recording: Path) -> list[Iterate]:
    """Return what a recording says of it, nothing where it does not.

    Raises OSError or ValueError for a file that is no recording, Unavailable where the package mcap is not installed.
    """
    try:
        from mcap.exceptions import McapError
        from mcap.reader import make_reader
    except ImportError:
        raise Unavailable("recordings: mcap is not installed; pip install 'benchbench[report]'") from None
    try:
        with recording.open("rb") as file:
            found = [one.metadata.get(NAME, "") for one in make_reader(file).iter_metadata()]
    except McapError as error:
        raise ValueError(f"cannot be read: {type(error).__name__} {error}".rstrip()) from None
    except (OSError, ValueError):
        raise
    except Exception as error:  # noqa: BLE001  # the readers of a broken file fail in many ways
        raise ValueError(f"cannot be read: {type(error).__name__}: {error}") from None
    return parsed(found[0]) if found and found[0] else []
