"""A keeper as its pool sees it: a process to be asked, heard and closed."""

from __future__ import annotations

import pickle
import signal
import time
from multiprocessing import get_context
from pathlib import Path
from typing import Any, final

from hydra.core.config_search_path import ConfigSearchPath

from benchbench.sweep import processes
from benchbench.sweep.keeper import READY, Exit, Request
from benchbench.sweep.start import start
from benchbench.sweep.task import LOG, Task

GRACE_S = 10.0
"""What a keeper has, beyond a run's limit, to kill it and to say so."""


@final
class KeeperHandle:
    """A fresh interpreter, which inherits no threads, with the task that it carries out."""

    def __init__(self, search_path: ConfigSearchPath, picture: bool) -> None:
        """Start the keeper; it says READY once it has imported what runs need, that of pictures if there are."""
        spawning = get_context("spawn")
        self.channel, theirs = spawning.Pipe()
        self._process = spawning.Process(target=start, args=(theirs, pickle.dumps((search_path, picture))))
        masked = signal.pthread_sigmask(
            signal.SIG_BLOCK, [signal.SIGINT]
        )  # Ctrl-C is ours, also while it starts
        try:
            self._process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, masked)
            theirs.close()
        self.task: Task | None = None
        self.ready, self._limit = False, 0.0

    @property
    def pid(self) -> int:
        """The keeper's."""
        return self._process.pid or 0

    def take(self, task: Task) -> None:
        """Give it a task."""
        job, _, settings = self.task = task
        self._limit = time.monotonic() + settings.hard_limit + GRACE_S
        folder = Path(
            str(job.config.hydra.runtime.output_dir)
        )  # on a cluster another one than the place says
        content = pickle.dumps((job, settings))
        request = Request(content, folder / LOG, settings.hard_limit, settings.memory_limit_mb)
        try:
            self.channel.send(request)
        except OSError:  # it is dead, as its pool will hear
            return

    def hear(self) -> Exit | None:
        """Return what it says of its task, None for its death; being ready is noted."""
        try:
            said: Any = self.channel.recv()
        except (EOFError, OSError):
            said = None
        if said == READY:
            self.ready = True
        return said

    @property
    def overdue(self) -> bool:
        """Whether it should have said by now that its task ended: something keeps it from that."""
        return self.task is not None and time.monotonic() > self._limit

    def close(self) -> None:
        """Kill it and all below it."""
        processes.kill([self.pid])
        self._process.join()
        self._process.close()
        self.channel.close()
