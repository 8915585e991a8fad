"""A sweep: skip what the table has, run the rest in worker processes, give every run its row."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from hydra.core.config_search_path import ConfigSearchPath
from rich.console import Console

from benchbench.run.execution import Ended, failure
from benchbench.run.hydra_errors import EXPECTED
from benchbench.sweep.display import Display
from benchbench.sweep.job import Job
from benchbench.sweep.pool import Task, run_all
from benchbench.sweep.resume import earlier

Engine = Callable[[Sequence[Task], ConfigSearchPath], Iterable[tuple[Task, Ended | Exception]]]
"""Carries out tasks and gives each with its end as soon as it is known; Hydra's search path is for the workers."""


def here(tasks: Sequence[Task], search_path: ConfigSearchPath) -> Iterable[tuple[Task, Ended | Exception]]:
    """Carry them out in worker processes on this machine."""
    workers = max(settings.workers for _, _, settings in tasks)
    return run_all(tasks, workers, search_path)


def sweep(
    jobs: Sequence[Job], search_path: ConfigSearchPath, traced: bool = False, engine: Engine = here
) -> list[int]:
    """Run all jobs and return their exit codes, in order; a skipped one has that of its earlier run.

    search_path: Hydra's, for the workers; traced: show where errors came from; engine: who carries them out.
    """
    codes: dict[int, int] = {}
    unfit: list[tuple[Job, Ended]] = []
    tasks: list[Task] = []
    known: dict[tuple[Path, str, int], dict[str, int]] = {}
    for job in jobs:
        place = None
        try:
            place = job.place()
            settings = job.settings()
        except EXPECTED as error:
            unfit.append((job, failure(error, job.case, place)))
            continue
        asked = (place.root, settings.rerun, settings.repeats)
        if asked not in known:
            known[asked] = earlier(place.root, settings.rerun, settings.repeats)
        label = place.labels["config_hash"]
        if label in known[asked]:
            codes[job.number] = known[asked][label]
        else:
            tasks.append((job, place, settings))
    if codes:
        note = f"{len(codes)} of {len(jobs)} runs are in the table and are skipped; rerun=all runs them again"
        Console(highlight=False).print(note, soft_wrap=True)
    with Display(len(tasks) + len(unfit), traced, _shared(jobs)) as display:
        for job, end in unfit:
            display.ended(job, end)
            codes[job.number] = end.code
        if tasks:
            for (job, place, _), told in engine(tasks, search_path):
                end = told if isinstance(told, Ended) else failure(told, job.case, place, peak_memory_mb=None)
                display.ended(job, end)
                codes[job.number] = end.code
    return [codes[job.number] for job in jobs]


def _shared(jobs: Sequence[Job]) -> set[str]:
    """Overrides that all of several combinations have."""
    return set.intersection(*(set(job.overrides) for job in jobs)) if len(jobs) > 1 else set()
