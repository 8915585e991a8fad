"""The limit of a process's memory, and whether an error came of it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from benchbench.errors import OutOfMemory
from benchbench.run.failure import said

WORDS = ("bad_alloc", "MemoryError", "out of memory", "Cannot allocate memory", "Unable to allocate")
"""What programs and libraries say when an allocation failed."""
NEAR = 0.9
"""Share of the limit from which on an error of any type is put down to it: libraries say it in many ways."""
LEAST_MB = 10.0
"""Memory that a run must have beside what the program takes by itself."""


def limit(megabytes: float | None) -> None:
    """Limit private writable memory; not the address space, of which CasADi maps much more than it uses.

    Raises OutOfMemory where not even the program fits into it.
    """
    if megabytes is None or sys.platform == "win32":
        return
    import resource

    used = _megabytes("VmData") or 0.0
    if used + LEAST_MB > megabytes:
        takes = f"the program takes {used:.0f} MB before the run begins"
        raise OutOfMemory(f"{takes}, and memory_limit_mb is {megabytes:g}")
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (int(megabytes * 1e6), hard))


def lift() -> None:
    """End the limit, so that what ran into it can be stored."""
    if sys.platform != "win32":
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (hard, hard))


def caused(error: BaseException) -> bool:
    """Whether an error came of a failed allocation: it or one behind it says so, or this process is at its limit.

    To be asked while the error's frames still hold what the run has taken.
    """
    texts = [f"{type(cause).__name__} {said(cause)}" for cause in _chain(error)]
    return any(word in text for word in WORDS for text in texts) or _near()


def _near() -> bool:
    if sys.platform == "win32":
        return False
    import resource

    soft, _ = resource.getrlimit(resource.RLIMIT_DATA)
    used = _megabytes("VmData")
    return soft != resource.RLIM_INFINITY and used is not None and used * 1e6 > NEAR * soft


def _chain(error: BaseException | None) -> Iterator[BaseException]:
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        yield error
        seen.add(id(error))
        error = error.__cause__ or error.__context__


def _megabytes(name: str) -> float | None:
    """A number of /proc/self/status; None where there is none."""
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
    except OSError:
        return None
    (kibibytes,) = [line.split()[1] for line in lines if line.startswith(f"{name}:")]
    return float(kibibytes) * 1024e-6
