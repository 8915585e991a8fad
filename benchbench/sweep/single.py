"""One run that was given a limit: a worker process carries it out, as in a sweep.

Without a limit a run stays in the program's own process, which saves the start of a second interpreter.
"""

from __future__ import annotations

import threading
from importlib import import_module

from hydra.core.global_hydra import GlobalHydra
from omegaconf import DictConfig
from rich.console import Console

from benchbench.run.execution import Ended, failure
from benchbench.run.hydra_errors import EXPECTED
from benchbench.sweep.job import Job
from benchbench.sweep.pool import run_all

LIMITS = ("hard_limit", "memory_limit_mb")


def limited(cfg: DictConfig) -> bool:
    """Whether the configuration asks for a limit that only another process can keep."""
    return any(cfg.get(name) is not None for name in LIMITS)


def isolated(cfg: DictConfig) -> Ended:
    """Carry out the one run that Hydra composed in a process of its own; never raises an Exception."""
    place = None
    try:
        job = Job.single(cfg)
        place, settings = job.place(), job.settings()
    except EXPECTED as error:
        return failure(error, cfg, place)
    search_path = GlobalHydra.instance().config_loader().get_search_path()
    # what a record needs is imported meanwhile, so that the row of a killed run comes at once
    threading.Thread(target=import_module, args=("benchbench.storage.table",), daemon=True).start()
    note = f"running in a process of its own, which is killed after {settings.hard_limit:g} s"
    with Console(stderr=True).status(note, spinner="line"):
        ((_, told),) = run_all(iter([(job, place, settings)]), search_path)
    return told if isinstance(told, Ended) else failure(told, cfg, place, peak_memory_mb=None)
