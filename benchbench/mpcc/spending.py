"""CPU time and counts of parts that lie deep inside others: noted where they arise, collected where they are summed."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_PARTS: ContextVar[dict[str, float] | None] = ContextVar("parts", default=None)


@contextmanager
def spending(part: str) -> Iterator[None]:
    """Note the CPU time of the body under a name, if somebody collects."""
    before = cpu_s()
    try:
        yield
    finally:
        note(part, cpu_s() - before)


def note(part: str, amount: float) -> None:
    """Add an amount under a name, if somebody collects."""
    parts = _PARTS.get()
    if parts is not None:
        parts[part] = parts.get(part, 0.0) + amount


@contextmanager
def collecting() -> Iterator[dict[str, float]]:
    """Give a mapping that holds, after the body, what was noted inside it by name."""
    parts: dict[str, float] = {}
    token = _PARTS.set(parts)
    try:
        yield parts
    finally:
        _PARTS.reset(token)


def cpu_s() -> float:
    """CPU seconds of this process and of its children that have ended (compilers)."""
    spent = time.process_time()
    try:
        import resource
    except ImportError:  # not on Windows
        return spent
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent + children.ru_utime + children.ru_stime
