"""Serialised functions read on trial, in a child process: a damaged stream can make CasADi loop, or take all memory, or die."""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from pathlib import Path

import casadi as ca

SECONDS, MEMORY = 10, 4_000_000_000
"""CPU time, beside a second for each megabyte of text, and bytes beyond what is held that reading may take."""
NUMBERS = 50_000_000
"""Most numbers that a function takes or gives."""
SIZE, REFUSED = 3, 4
"""Exit codes of the child."""


def unreadable(texts: Sequence[str]) -> str:
    """Return what is wrong with serialised functions, "" where CasADi can read them; nothing is known where no child can be made."""
    if not hasattr(os, "fork"):
        return ""
    child = os.fork()
    if child == 0:
        _be_the_child(texts)
    _, status = os.waitpid(child, 0)
    if os.WIFEXITED(status):
        told = {0: "", SIZE: f"has more than {NUMBERS} numbers", REFUSED: "is none that CasADi reads"}
        return told.get(os.WEXITSTATUS(status), "is none that CasADi reads")
    name = signal.Signals(os.WTERMSIG(status)).name
    return (
        f"is damaged: reading it ends with {name}"
        if name != "SIGXCPU"
        else "is damaged: reading it does not end"
    )


def _be_the_child(texts: Sequence[str]) -> None:
    code = REFUSED
    try:
        import resource  # not on Windows, where there is no fork either

        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, 1)
        os.dup2(nothing, 2)
        held = _held()
        limits = [
            (resource.RLIMIT_CORE, 0),
            (resource.RLIMIT_CPU, SECONDS + sum(map(len, texts)) // 1_000_000),
        ]
        limits += [(resource.RLIMIT_AS, held + MEMORY)] if held else []
        for which, limit in limits:
            hard = resource.getrlimit(which)[1]
            resource.setrlimit(which, (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard))
        code = 0 if all(_small(ca.Function.deserialize(text)) for text in texts) else SIZE
    except BaseException:  # noqa: BLE001  # it must not become a second program
        code = REFUSED
    finally:
        os._exit(code)


def _small(function: ca.Function) -> bool:
    sizes = [function.numel_in(i) for i in range(function.n_in())]
    sizes += [function.numel_out(i) for i in range(function.n_out())]
    return all(0 <= size <= NUMBERS for size in sizes)


def _held() -> int:
    """Bytes of address space of this process, 0 where nobody tells."""
    try:
        return int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return 0
