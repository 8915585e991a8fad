"""What `benchbench compare` says of two runs, and of two folders of runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from rich.console import Console
from rich.table import Table

from benchbench.analysis.pairs import Pairs, Row, paired
from benchbench.analysis.suite import cpu
from benchbench.cli.finding import run_folder
from benchbench.ground.errors import BadInput
from benchbench.ground.families import PLANNED
from benchbench.report.figure_file import write_figure
from benchbench.run.settings import NOT_DECISIVE
from benchbench.storage.configuration import configuration
from benchbench.storage.files import PLAN

NUMBERS = {
    "travel time": ("travel_time_s", 1.0, "s"), "objective": ("objective", 1.0, ""), "lower bound": ("lower_bound_s", 1.0, "s"),
    "above best known": ("gap_percent", 1.0, "%"), "contact begins": ("contact_start_s", 1.0, "s"), "contact ends": ("contact_end_s", 1.0, "s"),
    "off after an interval": ("replay_defect_position_m", 1e3, "mm"), "off open loop": ("replay_drift_position_m", 1e3, "mm"),
    "iterations": ("iterations", 1.0, ""), "CPU build": ("build_cpu_s", 1.0, "s"), "CPU solve": ("solve_cpu_s", 1.0, "s"),
    "CPU check": ("certificate_cpu_s", 1.0, "s"), "unknowns": ("n_variables", 1.0, ""), "pairs": ("n_pairs", 1.0, ""),
    "flights succeeded": ("flights_succeeded", 1.0, ""),
}  # fmt: skip
"""What is compared of two runs: column, factor, unit."""
MOST = 24
"""Fields chosen differently, and pairs, that are shown."""


def compare_runs(one: str, other: str, output: Path) -> str:
    """Print two runs side by side, draw their plans where both have one, and return where the figure is. Raises BadInput."""
    from benchbench.run.verbs import load

    folders = [run_folder(given) for given in (one, other)]
    rows = [load(folder).record for folder in folders]
    table = _grid("", one, other, "B against A")
    if rows[0]["task_hash"] != rows[1]["task_hash"]:
        print("another task, grid or transcription: their results answer different questions")
    for name, a, b in _chosen(rows, [configuration(folder) or {} for folder in folders]):
        table.add_row(name, a, b, "")
    table.add_row("[bold]verdict", *(_verdict(row) for row in rows), "", style="bold")
    for name, (column, factor, unit) in NUMBERS.items():
        a, b = (row[column] for row in rows)
        if a is not None or b is not None:
            table.add_row(
                name, _said(a, factor, unit), _said(b, factor, unit), "" if unit == "%" else _change(a, b)
            )
    _print(table)
    if not all((folder / PLAN).is_file() for folder in folders):
        return "no figure: not both have a plan"
    return _draw(folders, (one, other), output)


def _draw(folders: Sequence[Path], names: tuple[str, str], output: Path) -> str:
    from benchbench.report.overlay import Side, overlay
    from benchbench.run.redraw import Drawable

    found = [Drawable.of(folder) for folder in folders]
    sides = [
        Side(f"{letter}  {name}", one.recording.plan, one.scenario, one.model, one.recording.flight)
        for letter, name, one in zip("AB", names, found, strict=True)
    ]
    write_figure(overlay(*sides), output)
    return f"figure  {output}"


def compare_folders(one: Path, other: Path, output: Path) -> str:
    """Print the pairs of runs of two folders, draw them, and return where the figure is. Raises BadInput."""
    from benchbench.report.pairs_figure import pairs_figure
    from benchbench.storage.collect import collect

    sides = [collect([folder]).rows.to_pylist() for folder in (one, other)]
    for folder, rows in zip((one, other), sides, strict=True):
        if not rows:
            raise BadInput(str(folder), "holds no run", "a folder with results, as runs write them")
    found = paired(*sides)
    for name, a, b in found.differ:
        print(f"{name}: {', '.join(a)} (A) against {', '.join(b)} (B)")
    if not found.pairs:
        raise BadInput(
            f"{one} {other}", "have no run of the same task in common", "two folders with the same tasks"
        )
    _print(_pairs(found, str(one), str(other)))
    print("\n".join(_sum(found)))
    write_figure(pairs_figure(list(found.pairs.values()), (str(one), str(other))), output)
    return f"figure  {output}"


def _pairs(found: Pairs, one: str, other: str) -> Table:
    table = _grid(" ".join(found.names), one, other, "B against A")
    for key, (a, b) in list(found.pairs.items())[:MOST]:
        change = _change(a["travel_time_s"], b["travel_time_s"])
        table.add_row(" ".join(map(str, key)), _outcome(a), _outcome(b), change)
    if len(found.pairs) > MOST:
        table.add_row(f"and {len(found.pairs) - MOST} more", "", "", "")
    return table


def _outcome(row: Row) -> str:
    time = "" if row["travel_time_s"] is None else f" {row['travel_time_s']:.4f} s"
    return f"{row['status']}{time}"


def _sum(found: Pairs) -> Iterator[str]:
    pairs = list(found.pairs.values())
    counts = [sum(pair[i]["certified"] is True for pair in pairs) for i in (0, 1)]
    yield f"certified     A {counts[0]}, B {counts[1]} of {len(pairs)}"
    both = [(a, b) for a, b in pairs if a["certified"] is True and b["certified"] is True]
    changes = [
        100 * (b["travel_time_s"] / a["travel_time_s"] - 1)
        for a, b in both
        if a["travel_time_s"] and b["travel_time_s"]
    ]
    if changes:
        worst = max(changes, key=abs)
        yield f"travel time   B against A: median {median(changes):+.3f} %, most {worst:+.3f} % ({len(changes)} certified by both)"
    costs = [cpu(b) / cpu(a) for a, b in pairs if 0 < cpu(a) < float("inf") and cpu(b) < float("inf")]
    if costs:
        yield f"CPU           B against A: median {median(costs):.3g} times"
    if any(found.single):
        yield f"alone         A {found.single[0]}, B {found.single[1]} runs have no partner"


def _chosen(rows: Sequence[Row], trees: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, str, str]]:
    """Choices that differ by name, then fields of choices that do not."""
    named = [name for name in PLANNED if rows[0][name] != rows[1][name]]
    yield from ((name, str(rows[0][name] or "-"), str(rows[1][name] or "-")) for name in named)
    a, b = (dict(_leaves(tree)) for tree in trees)
    told = [
        key for key in dict.fromkeys([*a, *b])
        if a.get(key) != b.get(key) and key.split(".")[0] not in (*named, *NOT_DECISIVE)
    ]  # fmt: skip
    yield from ((key, str(a.get(key, "-")), str(b.get(key, "-"))) for key in told[:MOST])
    if len(told) > MOST:
        yield f"and {len(told) - MOST} fields more", "", ""


def _leaves(tree: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    if not isinstance(tree, Mapping):
        yield prefix, tree
        return
    for key, value in tree.items():
        yield from _leaves(value, f"{prefix}.{key}" if prefix else str(key))


def _grid(first: str, one: str, other: str, last: str) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column(first, overflow="fold")
    table.add_column(f"A  {one}", overflow="fold")
    table.add_column(f"B  {other}", overflow="fold")
    table.add_column(last, justify="right", no_wrap=True)
    return table


def _print(table: Table) -> None:
    console = Console(highlight=False)
    console.print(table)


def _verdict(row: Row) -> str:
    return "certified" if row["certified"] else f"NOT: {next(iter(row['reasons'] or ()), row['status'])}"


def _said(value: float | None, factor: float, unit: str) -> str:
    return "-" if value is None else f"{value * factor:.6g} {unit}".rstrip()


def _change(a: float | None, b: float | None) -> str:
    """How B is above A in percent; many times as a factor."""
    if not a or b is None or a < 0:
        return ""
    return f"{100 * (b / a - 1):+.3f} %" if 0.5 < b / a < 2 else f"{b / a:.3g} times"
