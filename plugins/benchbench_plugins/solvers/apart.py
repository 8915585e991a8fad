"""A solve in a child process, for a library that nothing stops from inside: it ends when its CPU time is over."""

from __future__ import annotations

import math
import os
import pickle
import signal
import warnings
from collections.abc import Callable
from typing import NoReturn

from benchbench.nlp.solver import Outcome, Point

Solve = Callable[[Point], Outcome]


def solve_apart(solve: Solve, start: Point, seconds: float) -> Outcome:
    """Return what a solve says, or that it took more than so many seconds of CPU, or died; raises what it raises.

    Where no child can be made (Windows) it is carried out here, without limit.
    """
    if not hasattr(os, "fork"):
        return solve(start)
    heard, said = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", DeprecationWarning
        )  # of forks beside threads: the child only computes
        child = os.fork()
    if child == 0:
        os.close(heard)
        _be_the_child(solve, start, seconds, said)
    os.close(said)
    try:
        with os.fdopen(heard, "rb") as answer:
            told = answer.read()
    except BaseException:
        os.kill(child, signal.SIGKILL)
        raise
    finally:
        _, status = os.waitpid(child, 0)
    if told:
        return _opened(told)
    ended = signal.Signals(os.WTERMSIG(status)) if os.WIFSIGNALED(status) else None
    if ended is signal.SIGPROF:
        return Outcome("time_limit", start, math.nan, 0, 0, seconds, f"ended after {seconds:.3g} s of CPU")
    return Outcome("failed", start, math.nan, 0, 0, 0.0, f"died of {ended.name if ended else 'an error'}")


def _opened(told: bytes) -> Outcome:
    outcome = pickle.loads(told)  # our own child wrote it
    if isinstance(outcome, Exception):
        raise outcome
    assert isinstance(outcome, Outcome)
    return outcome


def _be_the_child(solve: Solve, start: Point, seconds: float, said: int) -> NoReturn:
    try:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # the parent hears it, too, and says so
        signal.signal(signal.SIGPROF, signal.SIG_DFL)  # ends the process
        signal.setitimer(signal.ITIMER_PROF, seconds)
        try:
            told: Outcome | Exception = solve(start)
        except Exception as error:  # noqa: BLE001  # it is raised again by the parent
            told = error
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        with os.fdopen(said, "wb") as answer:
            answer.write(pickle.dumps(told))
    finally:
        os._exit(0)  # whatever happened, it must not become a second program
