"""A run that is ready to be carried out, and how it ended."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from hydra.core.config_search_path import ConfigSearchPath

from benchbench.run.execution import Ended, Place
from benchbench.run.settings import Settings
from benchbench.sweep.job import Job

LOG = "output.log"
"""File in a run's folder with what it printed; only if there was any."""

Task = tuple[Job, Place, Settings]
Tasks = Iterator[Task | None]
"""Tasks as they are made; None where there is none for now, but may be later."""
Ends = Iterable[tuple[Task, Ended | BaseException]]
"""Tasks with their ends, an error where the process died."""
Engine = Callable[[Tasks, ConfigSearchPath], Ends]
"""Carries out tasks and gives each with its end as soon as it is known; Hydra's search path is for the workers."""
