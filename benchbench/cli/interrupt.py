"""Ctrl-C: one line and exit code 130, at once, also while native code computes."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from types import FrameType
from typing import NoReturn

_heard, _runs = False, True
CODE = 130
MESSAGE, STORED = "benchbench: interrupted", "; finished runs are stored, the running one is not"


def take_over() -> None:
    """Hear Ctrl-C ourselves; where it is ignored (a shell's background job) it stays ignored."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupted)


def _interrupted(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, except below CasADi: it takes that for a failed evaluation and goes on."""
    global _heard  # libraries turn the exception into others, or drop it
    _heard = True
    while frame is not None:
        if str(frame.f_globals.get("__name__")).startswith("casadi"):
            leave()
        frame = frame.f_back
    raise KeyboardInterrupt


def heard() -> bool:
    """Whether Ctrl-C was pressed: an error that follows is told as that."""
    return _heard


def running(runs: bool) -> None:
    """Say whether runs are carried out from here on; until somebody says so they may be."""
    global _runs
    _runs = runs


def message() -> str:
    """Return what is said in the end."""
    return MESSAGE + STORED * _runs


def leave() -> NoReturn:
    """Say so and end the process at once; files are replaced as a whole, so none is left half written.

    Not by SystemExit: below native code it would not arrive, and Python would rather report the signal.
    """
    for stream in (sys.__stdout__, sys.__stderr__):  # solvers' output may be redirected just now
        if stream is not None and not stream.closed:
            stream.flush()
    clear = "\r\x1b[2K\x1b[?25h" if os.isatty(2) else ""  # the live line away, the cursor back
    with contextlib.suppress(OSError):
        os.write(2, f"{clear}{message()}\n".encode())
    os._exit(CODE)
