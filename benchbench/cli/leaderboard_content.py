"""What a leaderboard shows, gathered from bundles and folders: only plans and solutions that were certified again here."""

from __future__ import annotations

import hashlib
import logging
import math
import re
import shlex
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
import yaml  # type: ignore[import-untyped]

from benchbench.analysis.costs import solve_time
from benchbench.analysis.naming import name_runs
from benchbench.cli.gathering import Gathered
from benchbench.cli.report_content import plan_view
from benchbench.ground.errors import BadInput
from benchbench.report.html.leaderboard import Board, Entry, Place
from benchbench.report.html.page import PlanView
from benchbench.run.failure import reason
from benchbench.storage.best_known import gap
from benchbench.storage.bundle import OVERRIDES
from benchbench.storage.configuration import configuration, read
from benchbench.storage.files import PLAN, SOLUTION, write_bytes
from benchbench.storage.settings import SettingsReader
from benchbench.storage.table import frame

log = logging.getLogger(__name__)
SIZES = {"intervals": "N", "kappa_init": "κ"}
GRADES = "certificate."
"""Settings that play no part: everybody is judged by the same limits."""


@dataclass(frozen=True)
class _Run:
    """A run that may be on the board, by its row; `value` is its travel time in s, or the objective of a problem that is no flight."""

    row: int
    method: str
    asked: str
    certified: bool
    value: float
    flies: bool
    why: str


def board(
    found: Gathered, title: str | None, most: int, plans: Path, page: Path, hear: Callable[[str], None]
) -> Board:
    """Rank the plans that were certified anew and copy the best of each method and task into the folder `plans`.

    most: how many plans can be looked at on the page, the fastest of each task first. Raises BadInput where there is no run.
    """
    if not found.rows.num_rows:
        raise BadInput("leaderboard", "no run was found", "bundles, or folders with results")
    reader = SettingsReader()
    settings = [reader.read(folder) for folder in found.folders]
    fair = [
        None if one is None else {k: v for k, v in one.items() if not k.startswith(GRADES)}
        for one in settings
    ]
    named = name_runs(frame(found.rows), fair)
    named = named.assign(solve_s=solve_time(named))
    runs = list(_runs(found, named))
    names = _task_names(runs, named, settings)
    best = {(r.method, r.asked): r for r in sorted(runs, key=lambda r: -r.value) if r.certified}
    solved = [asked for asked in names if any(a == asked for _, a in best)]
    fastest = {asked: min(r.value for (_, a), r in best.items() if a == asked) for asked in solved}
    flights = [r for r in best.values() if r.flies]
    shown = {r.row for r in sorted(flights, key=lambda r: gap(r.value, fastest[r.asked]))[:most]}
    entries = {}
    for number, (key, run) in enumerate(best.items()):
        hear(f"plan {number + 1} of {len(best)}")
        entries[key] = _entry(
            run, found, named, names[run.asked], fastest[run.asked], plans, page, run.row in shown
        )
    methods = sorted({r.method for r in runs}, key=lambda m: (-sum(key[0] == m for key in best), m))
    rows = [(m, [_place(m, asked, entries, runs) for asked in solved]) for m in methods]
    lost = Counter(anew.said for anew in found.anew if anew is not None and anew.certified is None)
    return Board(
        title or "Leaderboard", [(names[asked], asked) for asked in solved], rows,
        [name for asked, name in names.items() if asked not in solved], found.said, _sources(found, named),
        dict(lost.most_common()), {str(path): problem for path, problem in found.problems.items()},
    )  # fmt: skip


def _runs(found: Gathered, named: pd.DataFrame) -> Iterator[_Run]:
    reasons = found.rows["reasons"].to_pylist()
    for row, (anew, method) in enumerate(zip(found.anew, named.method, strict=True)):
        if anew is not None and anew.certified is not None:
            why = "; ".join(anew.reasons or reasons[row] or [anew.said])
            told = anew.travel_time if anew.objective is None else anew.objective
            value = math.inf if told is None else told
            yield _Run(row, method, anew.asked, anew.certified, value, anew.objective is None, why)


def _task_names(
    runs: Sequence[_Run], named: pd.DataFrame, settings: Sequence[Mapping[str, Any] | None]
) -> dict[str, str]:
    """A name for each thing that is asked; what is called alike but asks something else gets a part of its hash."""
    names: dict[str, str] = {}
    for run in runs:
        own = settings[run.row] or {}
        sizes = [
            f"{sign}={own[f'scenario.{size}']}" for size, sign in SIZES.items() if f"scenario.{size}" in own
        ]
        names.setdefault(run.asked, ", ".join([str(named.task[run.row]), *sizes]))
    count = Counter(names.values())
    return {asked: f"{name} ({asked[:6]})" if count[name] > 1 else name for asked, name in names.items()}


def _entry(
    run: _Run,
    found: Gathered,
    named: pd.DataFrame,
    task: str,
    fastest: float,
    plans: Path,
    page: Path,
    drawn: bool,
) -> Entry:
    folder = Path(found.folders[run.row] or "")
    data = (folder / (PLAN if run.flies else SOLUTION)).read_bytes()
    digest = hashlib.sha256(data).hexdigest()
    anchor = (
        re.sub(r"[^\w.-]+", "-", f"{task}-{run.method}".replace("κ", "kappa"), flags=re.ASCII).strip("-")[:80]
        + f"-{digest[:8]}"
    )
    file = plans / f"{anchor}{'.mcap' if run.flies else '.json'}"
    write_bytes(file, data)
    record = found.rows.slice(run.row, 1).to_pylist(maps_as_pydicts="strict")[0]
    return Entry(
        anchor, run.method, task, run.value, run.flies, run.value == fastest, gap(run.value, fastest),
        _command(folder), file.relative_to(page.parent).as_posix(), digest, _facts(run.row, found, named, record),
        yaml.safe_dump(configuration(folder), sort_keys=False), _view(record, task, run, folder) if drawn else None,
    )  # fmt: skip


def _view(record: dict[str, Any], task: str, run: _Run, folder: Path) -> PlanView | None:
    try:
        return plan_view(record, f"{task}: {run.method}", folder)
    except Exception as error:  # noqa: BLE001  # a plan that cannot be drawn still counts
        log.warning("%s: %s cannot be shown: %s", task, run.method, reason(error))
        return None


def _facts(row: int, found: Gathered, named: pd.DataFrame, record: Mapping[str, Any]) -> dict[str, str]:
    told = {
        "machine": found.machines[row], "certificate": found.whose[row], "run": record["run_id"], "planned": record["started_at"],
        "BenchBench": record["benchbench_version"], "commit": (record["git_commit"] or "")[:10], "solver": record["solver_version"],
        "CPU time of the solver": "" if pd.isna(named.solve_s[row]) else f"{named.solve_s[row]:.3g} s",
    }  # fmt: skip
    return {name: str(text) for name, text in told.items() if text}


def _command(folder: Path) -> str:
    """The call that plans it again, "" where nobody kept it."""
    try:
        said = read(folder / OVERRIDES)
    except (OSError, ValueError):
        return ""
    overrides = [text for text in map(str, said if isinstance(said, list) else ()) if "hydra." not in text]
    return shlex.join(["benchbench", *overrides]) if overrides else ""


def _place(method: str, asked: str, entries: Mapping[tuple[str, str], Entry], runs: Sequence[_Run]) -> Place:
    tried = [run for run in runs if (run.method, run.asked) == (method, asked)]
    if (entry := entries.get((method, asked))) is not None:
        return Place(entry, len(tried))
    return Place(None, len(tried), tried[0].why if tried else "")


def _sources(found: Gathered, named: pd.DataFrame) -> list[tuple[str, str, int, str]]:
    versions = [
        ", ".join(filter(None, (f"BenchBench {v}", (c or "")[:10] if isinstance(c, str) else "", p if isinstance(p, str) else "")))
        for v, c, p in zip(named.benchbench_version, named.git_commit, named.platform, strict=True)
    ]  # fmt: skip
    counts = Counter(zip(found.sources, found.machines, versions, strict=True))
    return [(path, machine, count, made) for (path, machine, made), count in counts.items()]
