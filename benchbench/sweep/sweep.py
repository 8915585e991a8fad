"""A sweep: skip what the table has, run the rest in worker processes, give every run its row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

from hydra.core.config_search_path import ConfigSearchPath
from rich.console import Console

from benchbench.ground.errors import BadInput
from benchbench.run.execution import Ended, Place, failure
from benchbench.sweep.agenda import Agenda
from benchbench.sweep.combination import Combination
from benchbench.sweep.display import Display
from benchbench.sweep.pool import run_all
from benchbench.sweep.task import Engine, Task


@dataclass(frozen=True)
class Swept:
    """A combination that ran, now or earlier: its overrides, its exit code, and where it stands if it could be composed."""

    overrides: tuple[str, ...]
    code: int
    place: Place | None
    number: int = 0
    earlier: bool = False


def sweep(
    combinations: Sequence[Combination],
    search_path: ConfigSearchPath,
    traced: bool = False,
    engine: Engine = run_all,
    before: Sequence[Swept] = (),
) -> list[Swept]:
    """Run all combinations and return how they ended, in order; a skipped one ended as its earlier run did.

    search_path: Hydra's, for the workers; traced: show where errors came from; engine: who carries them out; before: what ran
    earlier in the same call, whose overrides need not be repeated either.
    """
    by_number = {combination.number: combination for combination in combinations}
    common = shared([*(one.overrides for one in before), *(one.overrides for one in combinations)])
    with Display(len(combinations), traced, common) as display:
        account = _Account(display)
        agenda = Agenda(combinations, account)
        for task, told in engine(agenda.tasks(), search_path):
            job, place, _ = task
            end = _end(task, told)
            agenda.done(place)
            account.ended(by_number[job.number], end)
    if account.earlier:
        note = f"{len(account.earlier)} of {len(combinations)} runs are in the table and are skipped"
        Console(highlight=False).print(f"{note}; rerun=all runs them again", soft_wrap=True)
    return [
        Swept(
            tuple(one.overrides),
            account.codes[number],
            agenda.places.get(number),
            number,
            number in account.earlier,
        )
        for number, one in by_number.items()
    ]


def _end(task: Task, told: Ended | BaseException) -> Ended:
    """Give a run its row, if its process has not: that may have lost the right to."""
    job, place, _ = task
    if isinstance(told, Ended):
        if told.record is not None or place.stored:
            return told
        why = "; ".join(complaint.text for complaint in told.complaints)
        told = BadInput("output", f"the run could not store its record: {why}")
    return failure(told, job.case, place, peak_memory_mb=None)


@final
class _Account:
    """Exit codes by number of the run, shown as they come."""

    def __init__(self, display: Display) -> None:
        self.codes: dict[int, int] = {}
        self.earlier: set[int] = set()
        self._display = display

    def ended(self, combination: Combination, end: Ended) -> None:
        self.codes[combination.number] = end.code
        self._display.ended(combination.number, combination.overrides, end)

    refused = ended

    def skipped(self, combination: Combination, code: int) -> None:
        self.codes[combination.number] = code
        self.earlier.add(combination.number)
        self._display.skipped()

    def waits(self, runs: int) -> None:
        self._display.waits(runs)


def shared(overrides: Sequence[Sequence[str]]) -> set[str]:
    """Return what all of several combinations have, which is not worth repeating."""
    return set.intersection(*map(set, overrides)) if len(overrides) > 1 else set()
