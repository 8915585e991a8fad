"""What happens in a worker process: a warm interpreter that carries out one run after the other."""

from __future__ import annotations

import contextlib
import ctypes
import faulthandler
import os
import signal
import sys
import threading
from collections.abc import Iterator
from importlib import import_module
from multiprocessing import connection, parent_process
from pathlib import Path
from typing import Any

from hydra import version
from hydra._internal.callbacks import Callbacks
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.hydra import Hydra
from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.global_hydra import GlobalHydra
from hydra.core.plugins import Plugins
from hydra.core.utils import run_job
from hydra.types import HydraContext

from benchbench.run.execution import Ended, execute
from benchbench.run.settings import Settings
from benchbench.sweep.job import Job

WRITERS = ("benchbench.storage.recording", "benchbench.storage.table")
PICTURE = "benchbench.report.picture"
"""Modules that a run needs once it has a plan."""
LOG = "output.log"
"""File in a run's folder with what native code printed; only if there was any."""
_PR_SET_PDEATHSIG = 1


def begin(search_path: ConfigSearchPath, picture: bool = True) -> None:
    """Make this process a worker: it ends with its parent, leads its own group, and knows Hydra's search path.

    picture: whether any of its runs will draw.
    """
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)  # killed with its compilers; Ctrl-C is for the parent
    _end_with_parent()
    for module in (
        (*WRITERS, PICTURE) if picture else WRITERS
    ):  # not at the top: the parent, and whoever refuses bad input, does without
        import_module(module)
    version.setbase("1.3")
    Plugins.instance()  # finds the kinds of places that configuration comes from
    GlobalHydra.instance().clear()
    GlobalHydra.instance().initialize(Hydra("benchbench", ConfigLoaderImpl(config_search_path=search_path)))


def work(job: Job, settings: Settings) -> Ended:
    """Carry out one run."""
    context = HydraContext(GlobalHydra.instance().config_loader(), Callbacks())
    folder = Path(job.config.hydra.runtime.output_dir)
    folder.mkdir(parents=True, exist_ok=True)
    folder_key, sub_key = ("hydra.sweep.dir", "hydra.sweep.subdir") if job.swept else ("hydra.run.dir", None)
    with _output_in(folder / LOG), _memory_limit(settings.memory_limit_mb):
        done = run_job(execute, job.config, folder_key, sub_key, context)
    return done.return_value


def end_with_parent_process() -> None:
    """Ask Linux to kill this process when its parent dies, also while native code computes."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is None:
        return
    end_with_parent_process()
    sentinel: Any = parent.sentinel

    def watch() -> None:
        connection.wait([sentinel])
        os._exit(1)

    if connection.wait([sentinel], 0):
        os._exit(1)
    threading.Thread(target=watch, daemon=True).start()


@contextlib.contextmanager
def _output_in(log: Path) -> Iterator[None]:
    """Send what the process prints, native code included, to a file; an empty one is removed."""
    saved = os.dup(1), os.dup(2)
    with log.open("wb") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
        faulthandler.enable(2)
        try:
            yield
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            for number, old in zip((1, 2), saved, strict=True):
                os.dup2(old, number)
                os.close(old)
    if log.is_file() and not log.stat().st_size:
        log.unlink()


@contextlib.contextmanager
def _memory_limit(megabytes: float | None) -> Iterator[None]:
    """Limit private writable memory; not the address space, of which CasADi maps much more than it uses."""
    if megabytes is None or sys.platform == "win32":
        yield
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (int(megabytes * 1e6), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))
