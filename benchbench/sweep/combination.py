"""The combinations of a sweep, composed one by one when their turn comes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from omegaconf import DictConfig

from benchbench.run.hydra_errors import explained
from benchbench.sweep import processes
from benchbench.sweep.job import Job

Compose = Callable[[int, Sequence[str]], DictConfig]
"""Composes the configuration of a combination from its number and its overrides."""


@dataclass(frozen=True)
class Combination:
    """Overrides that make one run; `number` counts from 1."""

    number: int
    overrides: Sequence[str]
    compose: Compose
    cwd: str

    def job(self) -> Job:
        """Compose it. Raises one of `hydra_errors.EXPECTED`."""
        processes.stand_in(self.cwd)
        try:
            return Job(self.number, self.compose(self.number - 1, self.overrides))
        except ValueError as error:  # Hydra says some of it so
            raise explained(error) from error
