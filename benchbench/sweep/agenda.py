"""What a sweep has to do: its combinations one by one, but for those in the table and those another sweep is at."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Protocol, final

from omegaconf import OmegaConf

from benchbench.run.execution import Ended, Place, failure
from benchbench.run.hydra_errors import EXPECTED
from benchbench.run.redraw import redraw
from benchbench.run.settings import Settings
from benchbench.storage.locks import Locks, name_of
from benchbench.sweep.combination import Combination
from benchbench.sweep.job import Job
from benchbench.sweep.resume import Earlier
from benchbench.sweep.task import Task, Tasks


class Listener(Protocol):
    """Hears of combinations that do not run."""

    def refused(self, combination: Combination, end: Ended) -> None:
        """It cannot run."""

    def skipped(self, combination: Combination, code: int) -> None:
        """It has run before, with this exit code."""

    def waits(self, runs: int) -> None:
        """Nothing is left but so many runs that other sweeps are at; told again and again."""


@final
class Agenda:
    """Composes a combination when it is asked for a task."""

    def __init__(self, combinations: Sequence[Combination], listener: Listener) -> None:
        """Take all combinations."""
        self._combinations, self._listener = combinations, listener
        self._elsewhere: list[tuple[Combination, Place, Settings]] = []
        self._mine: set[str] = set()
        self._folders: set[Path] = set()
        self._locks, self._earlier = cache(Locks), cache(Earlier)
        self.places: dict[int, Place] = {}
        """Where the combinations that could be composed stand, by number."""

    def tasks(self) -> Tasks:
        """Give what is to be run, None while all that is left is at work in other sweeps.

        Raises one of `hydra_errors.EXPECTED` for a first combination that cannot be composed: the others neither.
        """
        for combination in self._combinations:
            task = self._composed(combination)
            if task and self._ours(combination, *task[1:]):
                yield self._apart(task)
        while self._elsewhere:
            left, self._elsewhere = self._elsewhere, []
            for combination, place, settings in left:
                if self._ours(combination, place, settings) and (task := self._composed(combination)):
                    yield self._apart(task)
            if len(self._elsewhere) == len(left):
                self._listener.waits(len(left))
                yield None

    def done(self, place: Place) -> None:
        """Hear that a task has its row."""
        for name in (place.labels["config_hash"], name_of(place.folder)):
            self._locks(place.root).release(name)

    def _composed(self, combination: Combination) -> Task | None:
        place, job = None, None
        try:
            job = combination.job()
            self.places[combination.number] = place = job.place()
            return job, place, job.settings()
        except EXPECTED as error:
            if job is None and combination is self._combinations[0]:
                raise
            if job and place:
                place = self._place_apart(job, place)
            end = failure(error, job.case if job else OmegaConf.create(), place)
            if place:
                self.done(place)
            self._listener.refused(combination, end)
            return None

    def _ours(self, combination: Combination, place: Place, settings: Settings) -> bool:
        """Whether this sweep shall run it; if so, no other one does from here on."""
        if settings.rerun == "all":
            return True
        locks, label = self._locks(place.root), place.labels["config_hash"]
        earlier = self._earlier(place.root, settings.rerun, settings.repeats)
        code = earlier.exit_code(label)
        if code is None:
            if not locks.take(label):
                self._elsewhere.append((combination, place, settings))
                return False
            earlier.read(self._mine)  # another sweep may have run it since the last time
            code = earlier.exit_code(label)
            if code is not None:
                locks.release(label)
        if code is not None:
            folder = earlier.folder(label)
            if settings.draws(sweep=True) and folder is not None:
                redraw(folder)
            self._listener.skipped(combination, code)
            return False
        return True

    def _apart(self, task: Task) -> Task:
        """The task in a folder of its own."""
        job, place, settings = task
        place = self.places[job.number] = self._place_apart(job, place)
        self._mine.add(place.labels["run_id"])
        return job, place, settings

    def _place_apart(self, job: Job, place: Place) -> Place:
        """The run's place, with a number behind it where another run is or was in that folder."""
        subdir, again = job.subdir, 1
        while not self._free(place):
            again += 1
            place = job.place(f"{subdir}.{again}")
        self._folders.add(place.folder)
        return place

    def _free(self, place: Place) -> bool:
        """Whether no other run, of this sweep or another one, is or was in its folder; if so, none will be."""
        locks, name = self._locks(place.root), name_of(place.folder)
        if place.folder in self._folders or not locks.take(name):
            return False
        if place.taken:
            locks.release(name)
            return False
        return True
