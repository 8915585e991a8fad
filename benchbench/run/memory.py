"""The limit of a process's memory, and whether an error came of it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from benchbench.run.failure import said

WORDS = ("bad_alloc", "MemoryError", "out of memory", "Cannot allocate memory", "Unable to allocate")
"""What programs and libraries say when an allocation failed."""
NEAR = 0.9
"""Share of the limit from which on an error of any type is put down to it: libraries say it in many ways."""
HEADROOM_MB = 300.0
"""Beyond the limit allocations fail. Up to here they do not, since some libraries then try for ever (OpenBLAS, for the 128 MB
of its buffer): whoever watches the run kills it as soon as it is seen above its limit."""


def limit(megabytes: float | None) -> None:
    """Limit private writable memory; not the address space, of which CasADi maps much more than it uses."""
    if megabytes is None or sys.platform == "win32":
        return
    import resource

    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (int((megabytes + HEADROOM_MB) * 1e6), hard))


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
    used = held("self")
    return soft != resource.RLIM_INFINITY and used is not None and used > NEAR * (soft * 1e-6 - HEADROOM_MB)


def _chain(error: BaseException | None) -> Iterator[BaseException]:
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        yield error
        seen.add(id(error))
        error = error.__cause__ or error.__context__


def held(process: int | str) -> float | None:
    """Private writable memory of a process in MB (10^6 bytes), also what it has not written to; None where unknown."""
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
    except OSError:
        return None
    kibibytes = [float(line.split()[1]) for line in lines if line.startswith("VmData:")]
    return kibibytes[0] * 1024e-6 if kibibytes else None
