"""The summary of one run that a person reads in ten seconds."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from benchbench.storage.schema import Status


def show(record: Mapping[str, Any], paths: Mapping[str, Path], console: Console | None = None) -> None:
    """Print the summary of a record and the paths of what was written."""
    console = console or Console()
    grid = Table.grid(padding=(0, 2))
    grid.add_column(style="bold")
    grid.add_column(overflow="fold")
    for name, text in _lines(record):
        grid.add_row(name, text)
    for name, path in paths.items():
        grid.add_row(name, Text(_near(path)))
    console.print(grid)


def _lines(r: Mapping[str, Any]) -> list[tuple[str, Text | str]]:
    choices = " / ".join(str(r[k]) for k in ("dynamics", "relaxation", "solver", "strategy", "guess"))
    bound = f"   (lower bound {r['lower_bound_s']:.3f} s)" if r["lower_bound_s"] else ""
    lines: list[tuple[str, Text | str]] = [
        (str(r["scenario"]), f"{choices}, N = {r['intervals']}, kappa_init = {r['kappa_init']}"),
        ("travel time", f"{r['travel_time_s']:.4f} s{bound}"),
        ("verdict", _verdict(r)),
    ]
    if r["contact_start_s"] is not None:
        lines.append((
            "contact",
            f"{r['contact_start_s']:.3f} to {r['contact_end_s']:.3f} s: {r['contact_duration_s']:.3f} s, "
            f"{r['contact_steps']} steps",
        ))  # fmt: skip
    worst = [
        _scaled(r["contact_max_distance_m"], 1e3, "mm apart"),
        _scaled(r["contact_max_speed_gap_mps"], 1e3, "mm/s relative"),
        _scaled(r["contact_max_heading_error_rad"], 1e3, "mrad heading error"),
    ]
    lines += [
        ("worst in contact", ", ".join(w for w in worst if w) or "-"),
        (
            "replay",
            f"defect {_scaled(r['replay_defect_position_m'], 1e3, 'mm') or '-'} per interval, drift "
            f"{_scaled(r['replay_drift_position_m'], 1e3, 'mm') or '-'} open loop",
        ),
        (
            "effort",
            f"{r['iterations']} iterations; CPU {r['build_cpu_s']:.2f} s build, {r['solve_cpu_s']:.2f} s solve, "
            f"{r['certificate_cpu_s']:.2f} s certificate",
        ),
    ]
    return lines


def _verdict(r: Mapping[str, Any]) -> Text:
    if r["certified"]:
        return Text("certified", style="bold green")
    claim = "the solver claims success" if r["claimed_success"] else f"the solver ended with {r['status']}"
    text = Text(f"NOT certified ({claim})", style="bold red")
    for reason in r["reasons"]:
        text.append(f"\n- {reason}", style="not bold red")
    if not r["claimed_success"]:
        text.append(f"\n  {Status.__members__[r['status'].upper()].remedy}", style="not bold")
    return text


def _scaled(value: float | None, factor: float, unit: str) -> str:
    return "" if value is None else f"{value * factor:.3g} {unit}"


def _near(path: Path) -> str:
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)
