"""Sweeps on the workers of a Dask scheduler; the scheduler sends the run of a lost worker to another one."""

from __future__ import annotations

import time
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any, Final, Self, cast

from hydra.core.config_search_path import ConfigSearchPath

from benchbench.ground.errors import BadInput, Crash
from benchbench.run.execution import Ended
from benchbench.sweep import remote
from benchbench.sweep.task import Ends, Task, Tasks

SCHEDULER = "hydra.launcher.scheduler"
CONNECT_S = 10.0
AHEAD = 2
"""Tasks that each thread of the cluster has at hand: the one it carries out, and the next."""
POLL_S = 0.5
DONE: Final = "done"


@dataclass(frozen=True)
class Cluster:
    """The engine of `sweep` on a cluster.

    The files of a run come back with its end and are written here, so that no file system need be shared.
    """

    scheduler: str
    patience: float

    @classmethod
    def of(cls, scheduler: object, patience: object) -> Self:
        """Check what the user gave; raises BadInput."""
        if not isinstance(scheduler, str) or not scheduler:
            problem = "none was given" if scheduler is None else f"{scheduler!r} was given"
            raise BadInput(
                SCHEDULER, problem, "the address that `dask scheduler` prints, as in tcp://host:8786"
            )
        if isinstance(patience, bool) or not isinstance(patience, int | float) or not patience > 0:
            raise BadInput("hydra.launcher.patience", f"{patience!r} was given", "seconds greater than 0")
        try:
            import distributed  # noqa: F401
        except ImportError:
            raise BadInput(
                "hydra/launcher", "dask is not installed", "pip install 'benchbench[dask]'"
            ) from None
        return cls(scheduler, float(patience))

    def __call__(self, tasks: Tasks, search_path: ConfigSearchPath) -> Ends:
        """Give the ends of all tasks as they come. Raises BadInput for a cluster that is not there."""
        with self._client() as client:
            futures: dict[Any, Task] = {}
            left = True
            try:
                while left or futures:
                    room = AHEAD * max(1, sum(client.nthreads().values())) - len(futures)
                    while left and room > 0:
                        task = next(tasks, DONE)
                        left = task is not DONE
                        if not isinstance(task, tuple):
                            break
                        futures[self._submit(client, task, search_path)] = task
                        room -= 1
                    for future in _ended(futures):
                        task = futures.pop(future)
                        yield task, self._end(task, future)
            finally:
                client.cancel(list(futures), force=True)

    @staticmethod
    def _submit(client: Any, task: Task, search_path: ConfigSearchPath) -> Any:
        key = f"benchbench-{task[1].labels['run_id']}"
        return client.submit(remote.run, task, search_path, pure=False, key=key)

    def _end(self, task: Task, future: Any) -> Ended | BaseException:
        from distributed import KilledWorker

        error = future.exception()
        if error is None:
            return self._received(task, *future.result())
        if isinstance(error, KilledWorker):
            return Crash("the workers of the cluster that had this run died, one after the other")
        return error if isinstance(error, Exception) else Crash(repr(error))

    def _client(self) -> Any:
        from distributed import Client

        try:
            client: Any = cast("Any", Client)(self.scheduler, timeout=CONNECT_S)
        except (OSError, TimeoutError, ValueError) as error:
            problem = f"nothing answers at '{self.scheduler}': {error}"
            raise BadInput(SCHEDULER, problem, "the address that `dask scheduler` prints") from None
        try:
            client.wait_for_workers(1, timeout=self.patience)
        except TimeoutError:
            client.close()
            problem = f"no worker joined '{self.scheduler}' within {self.patience:g} s"
            raise BadInput(
                SCHEDULER, problem, f"start one: dask worker {self.scheduler} --nthreads 1"
            ) from None
        return client

    @staticmethod
    def _received(task: Task, end: Ended | BaseException, files: remote.Files) -> Ended | BaseException:
        """Write what is not here yet: on a shared file system the worker has written it."""
        from benchbench.storage.files import write_bytes
        from benchbench.storage.table import append

        _, place, _ = task
        if not place.stored:
            for name, content in files.items():
                path = place.folder / name
                path.parent.mkdir(parents=True, exist_ok=True)
                write_bytes(path, content)
        if isinstance(end, Ended) and end.record is not None:
            append(end.record, place.root)
        return end


def _ended(futures: Collection[Any]) -> list[Any]:
    """Those of the futures that have ended, after a while or as soon as there is one."""
    from distributed import wait

    if not futures:
        time.sleep(POLL_S)
        return []
    try:
        return list(cast("Any", wait)(list(futures), timeout=POLL_S, return_when="FIRST_COMPLETED").done)
    except TimeoutError:
        return []
