"""What a sweep has to do: its combinations one by one, but for those in the table and those another sweep is at."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Protocol, final

from omegaconf import OmegaConf

from benchbench.run.execution import Ended, Place, failure
from benchbench.run.hydra_errors import EXPECTED
from benchbench.run.settings import Settings
from benchbench.sweep.claims import Claims
from benchbench.sweep.combination import Combination
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
        self._claims, self._earlier = cache(Claims), cache(Earlier)
        self.places: dict[int, Place] = {}
        """Where the combinations that could be composed stand, by number."""

    def tasks(self) -> Tasks:
        """Give what is to be run, None while all that is left is at work in other sweeps.

        Raises one of `hydra_errors.EXPECTED` for a first combination that cannot be composed: the others neither.
        """
        for combination in self._combinations:
            task = self._composed(combination)
            if task and self._ours(combination, *task[1:]):
                yield task
        while self._elsewhere:
            left, self._elsewhere = self._elsewhere, []
            for combination, place, settings in left:
                if self._ours(combination, place, settings) and (task := self._composed(combination)):
                    yield task
            if len(self._elsewhere) == len(left):
                self._listener.waits(len(left))
                yield None

    def done(self, place: Place) -> None:
        """Hear that a task has its row."""
        self._claims(place.root).release(place.labels["config_hash"])

    def _composed(self, combination: Combination) -> Task | None:
        place, job = None, None
        try:
            job = combination.job()
            self.places[combination.number] = place = job.place()
            return job, place, job.settings()
        except EXPECTED as error:
            if job is None and combination is self._combinations[0]:
                raise
            self._listener.refused(
                combination, failure(error, job.case if job else OmegaConf.create(), place)
            )
            return None

    def _ours(self, combination: Combination, place: Place, settings: Settings) -> bool:
        """Whether this sweep shall run it; if so, no other one does from here on."""
        if settings.rerun == "all":
            return True
        claims, label = self._claims(place.root), place.labels["config_hash"]
        earlier = self._earlier(place.root, settings.rerun, settings.repeats)
        code = earlier.exit_code(label)
        if code is None:
            if not claims.take(label):
                self._elsewhere.append((combination, place, settings))
                return False
            earlier.read(self._mine)  # another sweep may have run it since the last time
            code = earlier.exit_code(label)
            if code is not None:
                claims.release(label)
        if code is not None:
            self._listener.skipped(combination, code)
            return False
        self._mine.add(place.labels["run_id"])
        return True
