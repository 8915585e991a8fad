"""The keeper of a worker: it has imported everything, forks a process for every run, watches it and clears up.

It has one thread, never runs code of a plugin and never reads what a run could have forged as anything but text, so
every run begins in the same clean state, whatever the one before has done to itself.
"""

from __future__ import annotations

import contextlib
import gc
import json
import os
import re
import select
import signal
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Literal

from hydra.core.config_search_path import ConfigSearchPath

from benchbench.run import memory
from benchbench.sweep import processes, worker
from benchbench.sweep.log import Log

READY = "ready"
"""What a keeper says first."""
LARGEST_ANSWER = 1_000_000
"""Bytes of a run's answer; ours have some thousand."""
KEPT = re.compile(r"(benchbench|benchbench_plugins)\..+|scipy\.[a-z]+")
"""Modules that are kept, once a run has needed them, for the following ones: ours, and scipy's rooms, half a second each."""


Limit = Literal["time", "memory", "program"]
LEAST_MB = 10.0
"""Memory that a run must have beside what the program takes by itself."""
WATCH_S = 0.25
"""How often the memory of a run is looked at."""


@dataclass(frozen=True)
class Request:
    """A run to carry out; `content` is for the run's process only, and what it answers likewise."""

    content: bytes
    log: Path
    seconds: float
    megabytes: float | None


@dataclass(frozen=True)
class Exit:
    """How the process of a run ended: its exit code (negative: a signal), and the limit that it was killed at, if any.

    limit: "program" is that of memory, where the keeper takes as much before it forks; answer: what the run said at its
    end, if it came to that; said: the last of what it printed.
    """

    code: int
    limit: Limit | None
    answer: bytes
    said: str


def keep(channel: Connection, search_path: ConfigSearchPath, picture: bool) -> None:
    """Carry out requests until the other end of the channel is closed, as by the parent's death."""
    worker.begin(search_path, picture)
    processes.adopt_orphans()
    processes.die_with_parent(0)
    woken, wake = os.pipe()
    os.set_blocking(woken, False)
    os.set_blocking(wake, False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    gc.collect()
    gc.freeze()  # else every collection of a run would copy the pages of all that is imported
    with contextlib.suppress(EOFError, OSError):
        channel.send(READY)
        while True:
            told = _carry_out(channel.recv(), channel, woken)
            channel.send(told)
            _keep_modules(told.answer)
    processes.end_all_below()


def _carry_out(request: Request, channel: Connection, woken: int) -> Exit:
    """Fork, watch and clear up. Raises EOFError when the parent is gone."""
    takes = memory.held("self") or 0.0
    if request.megabytes is not None and takes + LEAST_MB > request.megabytes:
        return Exit(0, "program", b"", f"{takes:.0f} MB")
    answer = _paper()
    output, said = os.pipe()
    process = os.fork()
    if process == 0:
        channel.close()
        worker.carry_out(request.content, said, answer)
    os.close(said)
    try:
        with Log(request.log) as log:
            code, limit = _watch(process, request, output, log, channel, woken)
            processes.end_all_below()
            while log.take(output):
                pass
        answered = os.pread(answer, LARGEST_ANSWER + 1, 0)
    finally:
        os.close(output)
        os.close(answer)
    return Exit(code, limit, answered, log.tail)


def _watch(
    process: int, request: Request, output: int, log: Log, channel: Connection, woken: int
) -> tuple[int, Limit | None]:
    """Return the exit code of a process, and the limit at which it was killed."""
    os.set_blocking(output, False)
    watched = select.poll()
    for descriptor in (output, woken, channel.fileno()):
        watched.register(descriptor, select.POLLIN)
    until, broken = time.monotonic() + request.seconds, None
    while True:
        left = until - time.monotonic()
        nap = left if request.megabytes is None else min(left, WATCH_S)
        for descriptor, _ in watched.poll(max(0.0, nap) * 1e3 if broken is None else None):
            if descriptor == output and log.take(output) is None:
                watched.unregister(output)  # the run has closed it
            elif descriptor == woken:
                os.read(woken, 4096)
            elif descriptor == channel.fileno():
                raise EOFError  # it never speaks during a run
        ended, status = os.waitpid(process, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status), broken
        if broken is None and (broken := _broken(process, request, until)):
            processes.kill([process])


def _broken(process: int, request: Request, until: float) -> Limit | None:
    if time.monotonic() >= until:
        return "time"
    if request.megabytes is not None and (memory.held(process) or 0.0) > request.megabytes:
        return "memory"
    return None


def _paper() -> int:
    """A file without a name, which no full disk refuses where the system has such."""
    if sys.platform == "linux":
        return os.memfd_create("answer")
    with tempfile.TemporaryFile() as file:
        return os.dup(file.fileno())


def _keep_modules(answer: bytes) -> None:
    """Import what a run had to, so that the following ones begin with it; never of a plugin's."""
    try:
        names = [str(name) for name in json.loads(answer)["modules"]]
    except (ValueError, TypeError, KeyError, RecursionError):
        return
    for name in names:
        if KEPT.fullmatch(name):
            with contextlib.suppress(ImportError):
                import_module(name)
