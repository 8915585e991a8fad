"""Processes and what came from them: who dies with whom, and how a whole tree is ended."""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import sys
import time
from collections import defaultdict
from collections.abc import Collection
from pathlib import Path

_PR_SET_PDEATHSIG, _PR_SET_CHILD_SUBREAPER = 1, 36
PATIENCE_S = 5.0
"""How long killed processes may take to go; those of another user, or stuck in the kernel, are not waited for."""


def die_with_parent(signal_number: int = signal.SIGKILL) -> None:
    """Ask Linux to send this process a signal when its parent dies, also while native code computes; 0 for none."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal_number)


def adopt_orphans() -> None:
    """Ask Linux to make this process the parent of every descendant whose own parent dies."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def descendants(roots: Collection[int]) -> set[int]:
    """Processes below the given ones; none where there is no /proc."""
    children = defaultdict(set)
    for entry in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):  # it has ended
            _, parent = entry.read_text(errors="replace").rpartition(")")[2].split()[:2]
            children[int(parent)].add(int(entry.parent.name))
    found: set[int] = set()
    left = list(roots)
    while left:
        new = children[left.pop()] - found
        found |= new
        left += new
    return found


def kill(roots: Collection[int]) -> None:
    """Kill processes and all below them. They are frozen first: none can start another one meanwhile."""
    frozen: set[int] = set()
    while new := {*roots, *descendants(roots)} - frozen:
        for process in new:
            _send(process, signal.SIGSTOP)
        frozen |= new
    for process in frozen:
        _send(process, signal.SIGKILL)


def end_all_below(keep: Collection[int] = ()) -> None:
    """Kill and reap every descendant, but for the children to keep and what is below those.

    After `adopt_orphans` that includes what a dead child has left behind.
    """
    limit = time.monotonic() + PATIENCE_S
    while not _childless() and time.monotonic() < limit:
        below = descendants([os.getpid()]) - {*keep, *descendants(keep)}
        if not below:
            return
        kill(below)
        for process in below:
            with contextlib.suppress(ChildProcessError):  # a child of a child
                os.waitpid(process, os.WNOHANG)
        time.sleep(0.002)


def stand_in(folder: str | Path) -> None:
    """Be in the folder where a sweep was started; if a plugin has removed it, it is made again."""
    os.makedirs(folder, exist_ok=True)
    os.chdir(folder)


def _childless() -> bool:
    try:
        os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return True
    return False


def _send(process: int, number: int) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.kill(process, number)
