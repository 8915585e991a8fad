"""Sweeps on the workers of a Dask scheduler; the scheduler sends the run of a lost worker to another one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Self, cast

from hydra.core.config_search_path import ConfigSearchPath

from benchbench.errors import BadInput, Crash
from benchbench.run.execution import Ended
from benchbench.sweep import remote
from benchbench.sweep.pool import Task

SCHEDULER = "hydra.launcher.scheduler"
CONNECT_S = 10.0


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

    def __call__(
        self, tasks: Sequence[Task], search_path: ConfigSearchPath
    ) -> Iterator[tuple[Task, Ended | Exception]]:
        """Give the ends of all tasks as they come. Raises BadInput for a cluster that is not there."""
        from distributed import KilledWorker, as_completed

        with self._client() as client:
            futures = {
                client.submit(
                    remote.run, task, search_path, pure=False, key=f"benchbench-{task[1].labels['run_id']}"
                ): task
                for task in tasks
            }
            try:
                for future in cast("Any", as_completed)(futures, raise_errors=False):
                    task, error = futures[future], future.exception()
                    if error is None:
                        yield task, self._received(task, *future.result())
                    elif isinstance(error, KilledWorker):
                        yield (
                            task,
                            Crash("the workers of the cluster that had this run died, one after the other"),
                        )
                    else:
                        yield task, error if isinstance(error, Exception) else Crash(repr(error))
            finally:
                client.cancel(list(futures), force=True)

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
    def _received(task: Task, end: Ended | Exception, files: remote.Files) -> Ended | Exception:
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
