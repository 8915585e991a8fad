"""Numbers and paths as they are said to people."""

from __future__ import annotations

from pathlib import Path


def above(gap: float) -> str:
    """Return a gap in %, never -0.000."""
    return f"{round(gap, 3) + 0.0:+.3f} %"


def number(value: float | None, form: str, unit: str) -> str:
    """Return a number with its unit, a dash for none."""
    return "-" if value is None else f"{value:{form}} {unit}"


def scaled(value: float | None, factor: float, unit: str) -> str:
    """Return a number of that many units in three digits, nothing for none."""
    return "" if value is None else f"{value * factor:.3g} {unit}"


def near(path: Path) -> str:
    """Return a path below the current folder relative to it."""
    try:
        return str(path.resolve().relative_to(Path.cwd()))
    except ValueError:
        return str(path)
