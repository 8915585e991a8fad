"""The pool of workers, and what the death of a run or of its keeper means."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections import Counter, deque
from multiprocessing import connection, resource_tracker
from typing import final

from hydra.core.config_search_path import ConfigSearchPath

from benchbench.ground.errors import BadInput, BenchBenchError, Crash, OutOfMemory, Timeout
from benchbench.run import memory
from benchbench.run.execution import Ended
from benchbench.run.settings import Settings
from benchbench.sweep import processes, worker
from benchbench.sweep.keeper import Exit
from benchbench.sweep.keeper_handle import KeeperHandle
from benchbench.sweep.task import LOG, Ends, Task, Tasks

STARTS = 3
"""Keepers in a row that may die before they are ready."""
LIVES = 2
"""Keepers that a run may take with it: the first death may have been somebody else's doing."""
POLL_S = 0.5
ENVIRONMENT = {"OMP_NUM_THREADS": "1", "JE_ARROW_MALLOC_CONF": "background_thread:false"}
"""Set for keepers, unless the user has: no library shall start threads in a process that forks."""


def run_all(tasks: Tasks, search_path: ConfigSearchPath) -> Ends:
    """Run all tasks and give each with its end as soon as it is known: an error if its process died.

    A task is asked for when a worker can soon take it, so they may be made one by one. Raises BadInput.
    """
    if sys.platform == "win32":
        raise BadInput(
            "-m", "sweeps and limits fork processes, which this system cannot do", "Linux, as in WSL"
        )
    for name, value in ENVIRONMENT.items():
        os.environ.setdefault(name, value)
    resource_tracker.ensure_running()  # a child of ours that must not be taken for an orphan
    processes.adopt_orphans()
    pool = _Pool(tasks, search_path)
    try:
        yield from pool.ends()
    finally:
        pool.close()


@final
class _Pool:
    """Hands at work, and tasks that wait for one."""

    def __init__(self, tasks: Tasks, search_path: ConfigSearchPath) -> None:
        self._tasks, self._search_path = tasks, search_path
        self._others = processes.descendants([os.getpid()])
        self._hands: list[KeeperHandle] = []
        self._waiting: deque[Task] = deque()
        self._deaths: Counter[int] = Counter()  # of keepers, by the number of the run that they had
        self._failed_starts, self._exhausted = 0, False

    def ends(self) -> Ends:
        """Give the ends of all tasks."""
        while True:
            fetched = self._fetch()
            self._hand_out()
            if self._exhausted and not self._waiting and not any(hand.task for hand in self._hands):
                return
            speaking = connection.wait([hand.channel for hand in self._hands], 0.0 if fetched else POLL_S)
            for hand in [hand for hand in self._hands if hand.channel in speaking or hand.overdue]:
                yield from self._hear(hand)
            if self._failed_starts == STARTS:
                yield from self._give_up()

    def close(self) -> None:
        """Kill what is left, and what was left behind."""
        for hand in list(self._hands):
            self._remove(hand)

    @property
    def _idle(self) -> list[KeeperHandle]:
        return [hand for hand in self._hands if hand.task is None]

    def _fetch(self) -> bool:
        """Take one more task, if one could be handed out soon; returns whether there was one."""
        if self._exhausted or len(self._waiting) > len(self._idle):
            return False
        try:
            task = next(self._tasks)
        except StopIteration:
            self._exhausted = True
            return False
        if task:
            self._waiting.append(task)
        return task is not None

    def _hand_out(self) -> None:
        for hand in self._idle:
            if hand.ready and self._waiting:
                hand.take(self._waiting.popleft())
        wanted = max((settings.workers for _, _, settings in self._waiting), default=0)
        if len(self._waiting) > len(self._idle) and len(self._hands) < wanted:
            drawing = any(settings.draws(sweep=True) for _, _, settings in self._waiting)
            self._hands.append(KeeperHandle(self._search_path, drawing))

    def _hear(self, hand: KeeperHandle) -> Ends:
        task, said = hand.task, None if hand.overdue else hand.hear()
        if isinstance(said, Exit) and task:
            hand.task = None
            yield task, _end(said, task[2])
        elif said is None:
            late, ready = hand.overdue, hand.ready
            self._remove(hand)
            self._failed_starts = 0 if ready else self._failed_starts + 1
            if task:
                yield from self._bereaved(task, late)

    def _remove(self, hand: KeeperHandle) -> None:
        """Kill it, what is below it, and what a dead one has left to us."""
        self._hands.remove(hand)
        hand.close()
        processes.end_all_below({*self._others, *(hand.pid for hand in self._hands)})

    def _bereaved(self, task: Task, late: bool) -> Ends:
        """Give the end of a task whose keeper is dead, or let it begin again."""
        job, _, settings = task
        self._deaths[job.number] += 1
        if late:
            yield task, _too_long(settings)
        elif self._deaths[job.number] == LIVES:
            yield (
                task,
                Crash(
                    f"whoever ran it was killed {LIVES} times; a plugin may have killed its parent process"
                ),
            )
        else:
            self._waiting.appendleft(task)

    def _give_up(self) -> Ends:
        why = "the worker processes of the sweep do not start; the messages above may say why"
        for task in self._waiting:
            yield task, Crash(why)
        self._waiting.clear()
        for more in self._tasks:
            if more:
                yield more, Crash(why)
            else:
                time.sleep(POLL_S)
        self._exhausted = True


def _end(told: Exit, settings: Settings) -> Ended | BenchBenchError:
    if told.limit == "time":
        return _too_long(settings)
    if told.limit == "program":
        limit = f"memory_limit_mb is {settings.memory_limit_mb:g}"
        return OutOfMemory(f"the program takes {told.said} before the run begins, and {limit}")
    if told.limit == "memory":
        return OutOfMemory(f"killed when it held more than its limit of {settings.memory_limit_mb:g} MB")
    return worker.decoded(told.answer) or _cause(told, settings)


def _too_long(settings: Settings) -> Timeout:
    return Timeout(f"killed after its limit of {settings.hard_limit:g} s, see hard_limit")


def _cause(told: Exit, settings: Settings) -> BenchBenchError:
    """Name what a run died of."""
    code = told.code
    how = f"the process died of {_signal(-code)}" if code < 0 else f"the process ended with exit code {code}"
    if any(word in told.said for word in memory.WORDS):
        limit = f"{settings.memory_limit_mb:g} MB" if settings.memory_limit_mb else "this machine"
        return OutOfMemory(f"{how} when it needed more memory than {limit} had to give")
    if code == -signal.SIGKILL:
        how += ", sent by somebody else; often the system, when its memory runs out"
    if code == worker.SAID_NOTHING:
        how = "the process could not tell its result; a plugin may have damaged it"
    if code == 0:
        how += " before it had told its result; a plugin may end it, as os._exit does"
    return Crash(f"{how}; see {LOG} in its folder" if told.said else how)


def _signal(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
