"""A whole study: read the space, open or resume, search, write what was found."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from benchbench.run.working import Working
from benchbench.storage.files import RECORD
from benchbench.sweep.tuning import outcome
from benchbench.sweep.tuning.begun import bury, check_same
from benchbench.sweep.tuning.search import search
from benchbench.sweep.tuning.space import read
from benchbench.sweep.tuning.task import StudySettings

Launch = Callable[[Path, Sequence[Sequence[str]], int], None]
"""Carries out runs given by overrides, the n-th in the folder `first + n` of the given one."""


def run(
    arguments: Sequence[str], over: Sequence[str], asked: Mapping[str, Any], folder: Path, launch: Launch
) -> int:
    """Return 0 if a trial has all its plans certified, otherwise 1. Raises BadInput."""
    task = StudySettings.of(**asked)
    space = read(arguments, over)
    study = task.open()
    check_same(study, space)
    folder.mkdir(parents=True, exist_ok=True)
    console = Console(highlight=False, soft_wrap=True)
    if before := len(study.trials):
        dead = bury(study, folder)
        died = f", {dead} of which died with an earlier process" if dead else ""
        console.print(f"study '{task.study_name}' goes on after {before} trials{died}")

    counts: dict[int, int] = {}

    def plan(trial: int, runs: Sequence[Sequence[str]]) -> list[Mapping[str, Any] | None]:
        first = counts.get(trial, 0)
        counts[trial] = first + len(runs)
        place = folder / "trials" / str(trial)
        what = f"trial {trial}: {len(runs)} of {len(space.problems)} plans"
        with Working(what, live=False):  # a terminal shows the runs
            launch(place, runs, first)
        return [_record(place / str(first + n) / RECORD) for n in range(len(runs))]

    search(task, study, space, plan, console.print, folder)
    paths = outcome.write(study, task.objectives, folder, space.fixed, space.problems[0])
    _show(console, task, outcome.front(study))
    for name, path in paths.items():
        console.print(f"{name:8s} {path}")
    if "best" in paths:
        console.print(f"use it:  python -m benchbench --config-dir {folder} +scenario=... +tuned=best")
    return 0 if "best" in paths else 1


def _record(path: Path) -> Mapping[str, Any] | None:
    try:
        content: Mapping[str, Any] = json.loads(path.read_text())
    except (OSError, ValueError):  # the run died before it had a folder
        return None
    return content


def _show(console: Console, task: StudySettings, best: Sequence[Any]) -> None:
    if not best:
        console.print("no trial has all its plans certified, with every objective a number")
        return
    table = Table(title="Pareto front" if len(task.objectives) > 1 else "best trial")
    for head in (*task.objectives, "trial", *best[0].params):
        table.add_column(head, overflow="fold")
    for trial in best:
        table.add_row(
            *(f"{v:.4f}" for v in trial.values), str(trial.number), *map(str, trial.params.values())
        )
    console.print(table)
