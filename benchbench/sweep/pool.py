"""The pool of worker processes, and what the death of one of them means for its run."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures import TimeoutError as Expired
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import context
from pathlib import Path

from hydra.core.config_search_path import ConfigSearchPath
from pebble import ProcessExpired, ProcessPool

from benchbench.errors import BenchBenchError, Crash, OutOfMemory, Timeout
from benchbench.run.execution import Ended, Place
from benchbench.run.settings import Settings
from benchbench.sweep import worker
from benchbench.sweep.job import Job

POOLS = 3
"""Pools in a row that may break before any run of theirs ends."""
POLL_S = 0.5
MEMORY_WORDS = ("bad_alloc", "MemoryError", "out of memory", "Cannot allocate memory")
"""What dying programs print when an allocation failed."""


class _Process(context.SpawnProcess):
    """A worker that is killed at once and with its children, whatever signals it ignores."""

    def terminate(self) -> None:
        """Kill the process group that the worker leads."""
        if sys.platform == "win32" or self.pid is None:
            return self.kill()
        try:
            os.killpg(self.pid, signal.SIGKILL)
        except ProcessLookupError:  # it does not lead a group yet
            self.kill()


class _Context(context.SpawnContext):
    """Fresh interpreters whose parent is this process: they inherit no threads and end with it."""

    Process = _Process


Task = tuple[Job, Place, Settings]


def run_all(
    tasks: Sequence[Task], workers: int, search_path: ConfigSearchPath
) -> Iterator[tuple[Task, Ended | Exception]]:
    """Run all tasks and give each with its end as soon as it is known: an error if its process died.

    A pool that lost a worker between two runs is made again with what is left.
    """
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    left, failures = dict(enumerate(tasks)), 0
    while left and failures < POOLS:
        before = len(left)
        for number, end in _one_pool(left, workers, search_path):
            yield left.pop(number), end
        failures = failures + 1 if len(left) == before else 0
    for task in left.values():
        yield task, Crash("the worker processes of the sweep do not start; the messages above may say why")


def _one_pool(
    tasks: Mapping[int, Task], workers: int, search_path: ConfigSearchPath
) -> Iterator[tuple[int, Ended | Exception]]:
    """Give the ends of tasks until all are done or the pool is broken."""
    drawing = any(settings.picture for _, _, settings in tasks.values())
    with _pool(min(workers, len(tasks)), search_path, drawing) as pool:
        waiting: dict[Future[Ended], tuple[int, Task]] = {}
        for number, (job, place, settings) in tasks.items():
            try:
                future = pool.schedule(worker.work, args=(job, settings), timeout=settings.hard_limit)
            except RuntimeError:  # the pool is broken already
                return
            waiting[future] = number, (job, place, settings)
        while waiting and pool.active:
            for done in wait(waiting, POLL_S, FIRST_COMPLETED).done:
                number, task = waiting.pop(done)
                end = _end(done, task)
                if not isinstance(end, BrokenProcessPool):
                    yield number, end


def _end(future: Future[Ended], task: Task) -> Ended | Exception:
    _, place, settings = task
    try:
        return future.result()
    except Expired:
        return Timeout(f"killed after its limit of {settings.hard_limit:g} s, see hard_limit")
    except ProcessExpired as death:
        return _cause(death, place.folder / worker.LOG, settings)
    except Exception as error:  # noqa: BLE001  # what the worker's own machinery raised
        return error


@contextmanager
def _pool(workers: int, search_path: ConfigSearchPath, drawing: bool) -> Iterator[ProcessPool]:
    about = (search_path, drawing)
    pool = ProcessPool(workers, initializer=worker.begin, initargs=about, context=_Context())
    try:
        yield pool
    finally:
        pool.stop()  # type: ignore[no-untyped-call]
        pool.join()


def _cause(death: ProcessExpired, log: Path, settings: Settings) -> BenchBenchError:
    """Name what a worker died of."""
    code = death.exitcode
    how = f"the process died of {_signal(-code)}" if code < 0 else f"the process ended with exit code {code}"
    said = log.read_text(errors="replace") if log.is_file() else ""
    if any(word in said for word in MEMORY_WORDS):
        limit = f"{settings.memory_limit_mb:g} MB" if settings.memory_limit_mb else "this machine"
        return OutOfMemory(f"{how} when it needed more memory than {limit} had to give")
    if code == -signal.SIGKILL:
        how += ", sent by somebody else; often the system, when its memory runs out"
    return Crash(f"{how}; see {log.name} in its folder" if said else how)


def _signal(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
