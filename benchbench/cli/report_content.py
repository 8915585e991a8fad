"""What a report shows, gathered from folders of results."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Protocol

import numpy as np
import pandas as pd
import pyarrow as pa
import yaml  # type: ignore[import-untyped]

from benchbench.analysis.costs import solve_time
from benchbench.analysis.naming import name_runs
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.report.contact_window import contact_windows
from benchbench.report.html.charts.convergence import Converged
from benchbench.report.html.page import PlanView, Report
from benchbench.report.html.plans.limits import limits
from benchbench.report.html.plans.view import view
from benchbench.report.html.room import ROWS
from benchbench.report.panels import panels
from benchbench.report.scene import scene
from benchbench.run.failure import reason
from benchbench.run.stored import scene_parts
from benchbench.storage.configuration import configuration
from benchbench.storage.convergence import Iterate, read
from benchbench.storage.files import FLIGHT, PLAN
from benchbench.storage.playback import read_mcap
from benchbench.storage.recording import XYZ
from benchbench.storage.schema import Record
from benchbench.storage.series import read_series
from benchbench.storage.settings import SettingsReader
from benchbench.storage.table import frame

Hear = Callable[[str], None]


class Found(Protocol):
    """Runs, as `benchbench.storage.collect` or `benchbench.cli.gathering` give them."""

    @property
    def rows(self) -> pa.Table:
        """All of them."""

    @property
    def folders(self) -> tuple[Path | None, ...]:
        """Where each is."""

    @property
    def problems(self) -> dict[Path, str]:
        """Files that could not be used."""


LINES, TRIED = 8, 5
"""Methods whose convergence is drawn, and problems that are looked at for some."""
FACTS = {
    "travel time": ("travel_time_s", 1.0, "s"), "lower bound": ("lower_bound_s", 1.0, "s"),
    "best known": ("best_known_s", 1.0, "s"), "above it": ("gap_percent", 1.0, "%"),
    "iterations": ("iterations", 1.0, ""), "solver": ("solve_cpu_s", 1.0, "s CPU"),
    "error of one interval": ("replay_defect_position_m", 1e3, "mm"),
    "drift of the replay": ("replay_drift_position_m", 1e3, "mm"), "beyond a gate's edge": ("gate_worst_miss_m", 1e3, "mm"),
}  # fmt: skip
"""What is said of a plan: column, factor, unit."""


def content(
    found: Found,
    places: Sequence[Path],
    title: str | None,
    most: int,
    rows: int = ROWS,
    hear: Hear = lambda _: None,
) -> Report:
    """Take the runs found below `places` and read at most `most` of their plans, to list at most `rows` of the runs.

    hear: told what is done. Raises BadInput where there is no run.
    """
    if not found.rows.num_rows:
        problem = f"no run was found{', only files that cannot be used' if found.problems else ''}"
        raise BadInput(", ".join(map(str, places)), problem, "folders with results, as runs write them")
    hear("reading configurations")
    reader = SettingsReader()
    settings = [reader.read(folder) for folder in found.folders]
    runs = name_runs(frame(found.rows), settings)
    runs = runs.assign(solve_s=solve_time(runs))
    plans, missing = [], []
    candidates = [i for i in best_first(runs) if _has_plan(found.folders[i])]
    for number, i in enumerate(candidates[:most]):
        hear(f"plan {number + 1} of {min(most, len(candidates))}")
        (record,) = found.rows.slice(i, 1).to_pylist(maps_as_pydicts="strict")
        try:
            plans.append(plan_view(record, f"{runs.problem[i]}: {runs.method[i]}", found.folders[i]))
        except Exception as error:  # noqa: BLE001  # it was written by another version, plugin or program
            told = str(error) if isinstance(error, (OSError, ValueError)) else reason(error)
            missing.append(f"The plan of {record['run_id']} is not shown: {told}")
    if len(candidates) > most:
        missing.append(
            f"{most} of {len(candidates)} plans are shown, the best of each problem first; --plans shows more."
        )
    if not candidates:
        missing.append("No run has a recorded plan.")
    names = ", ".join(folder.resolve().name for folder in places)
    converged = _converged(runs, found)
    return Report(
        title or f"Report on {names}", runs, settings, plans, missing, found.problems, rows, converged
    )


def _converged(runs: pd.DataFrame, found: Found) -> Converged | None:
    """One run of at most `LINES` methods on the problem that most of them tell of; certified ones first."""
    order = runs.assign(bad=~runs.certified.fillna(False).astype(bool)).sort_values("bad", kind="stable")
    first = order.drop_duplicates(["problem", "method"])
    for problem in first.problem.value_counts(sort=True).index[:TRIED]:
        told: dict[str, list[Iterate]] = {}
        for i in first.index[first.problem == problem][: 2 * LINES]:
            with suppress(OSError, ValueError):
                if _has_plan(found.folders[i]) and len(told) < LINES:
                    told |= {
                        str(runs.method[i]): one for one in [read(Path(found.folders[i] or "", PLAN))] if one
                    }
        if told:
            return Converged(str(problem), told)
    return None


def best_first(runs: pd.DataFrame) -> list[int]:
    """Positions of the runs: certified ones first, then by their rank in travel time within their problem."""
    certified = runs.certified.fillna(False).astype(bool)
    times = runs.travel_time_s.astype(float).fillna(float("inf"))
    rank = times.groupby([runs.problem, certified]).rank(method="first")
    order = pd.DataFrame({"rejected": ~certified, "rank": rank, "time": times})
    return order.reset_index(drop=True).sort_values(["rejected", "rank", "time"]).index.tolist()


def plan_view(record: Record, title: str, folder: Path | None) -> PlanView:
    """Make the views of a recorded plan.

    Raises ValueError for a recording that cannot be used, BadInput for a scenario or vehicle that cannot be
    built here, for example since a plugin is not installed.
    """
    recording = read_mcap(Path(folder or "", PLAN))
    tree = configuration(folder)
    if tree is None:
        raise ValueError("its configuration is missing")
    scenario, model = scene_parts(tree)
    plan, flight = recording.plan, recording.flight
    windows = [(float(plan.time[a]), float(plan.time[b])) for a, b in contact_windows(plan)]
    shown = scene(plan, scenario, model, flight, truth(folder))
    return PlanView(
        run_id=str(record["run_id"]),
        title=title,
        certified=record["certified"] is True,
        reasons=record["reasons"] or (),
        advice=record["advice"] or "",
        facts=_facts(record),
        view=view(shown),
        limits=limits(
            panels(scenario, plan, model, flight),
            windows,
            plan.travel_time,
            "at a gate" if shown.marks.coloured else "in contact",
        ),
        config=yaml.safe_dump(tree, sort_keys=False),
    )


def truth(folder: Path | None) -> Array | None:
    """What happened in the flight that was recorded beside the plan; None where there is none, or it cannot be read."""
    path = Path(folder or "", FLIGHT)
    with suppress(BadInput):
        tool, ball = (
            read_series(path, f"/truth/{what}", XYZ) if path.is_file() else None
            for what in ("end_effector", "ball")
        )
        return None if tool is None or ball is None else np.hstack([tool, ball[:, 1:]])
    return None


def _has_plan(folder: Path | None) -> bool:
    return folder is not None and (folder / PLAN).is_file()


def _facts(record: Record) -> dict[str, str]:
    numbers = {
        name: f"{record[column] * factor:.4g} {unit}".rstrip()
        for name, (column, factor, unit) in FACTS.items()
        if record[column] is not None
    }
    said = {"in contact": record["contact_gaps_said"], "limits used": record["limits_used_said"]}
    if record["flights"]:
        numbers["flights that succeed"] = f"{record['flights_succeeded']} of {record['flights']}"
    return numbers | {name: ", ".join(texts) for name, texts in said.items() if texts}
