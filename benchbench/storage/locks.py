"""Which runs and run folders are at work just now: sweeps share the work, and no two runs write into one folder."""

from __future__ import annotations

import hashlib
import os
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import final

from benchbench.ground.errors import BadInput

LOCKS = ".claims"
"""An empty file in the folder of results; each run, and its folder, has one of its bytes locked while it is at work."""


def name_of(folder: Path) -> str:
    """The name by which a run's folder is locked."""
    return hashlib.sha256(str(folder).encode("utf-8", "surrogateescape")).hexdigest()[:16]


@contextmanager
def alone_in(folder: Path, root: Path) -> Iterator[None]:
    """Have a run's folder for oneself; raises BadInput while another process has it."""
    locks = Locks(root)
    try:
        if not locks.take(name_of(folder)):
            problem = f"another run is at work in '{folder}'"
            raise BadInput("hydra.run.dir", problem, "a folder of its own for each run")
        yield
    finally:
        locks.close()


@final
class Locks:
    """Locks on the bytes of a file; the system takes them back when this process ends, however it does."""

    def __init__(self, root: Path) -> None:
        """Take the folder of results; the file is made with the first lock."""
        self._path, self._file, self._held = root / LOCKS, -1, Counter[str]()

    def take(self, name: str) -> bool:
        """Lock a run by its configuration hash, once more if it is locked here; False if another process has it.

        Where the file system knows no locks, each process has its own locks only.
        """
        if not self._held[name] and not self._lock(name):
            return False
        self._held[name] += 1
        return True

    def release(self, name: str) -> None:
        """Give one lock back."""
        if self._held[name] == 1:
            _locked(self._file, name, False)
        if self._held[name]:
            self._held[name] -= 1

    def close(self) -> None:
        """Give all locks of this process back."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
        self._held.clear()

    def _lock(self, name: str) -> bool:
        try:
            if self._file < 0:
                self._path.parent.mkdir(parents=True, exist_ok=True)
                self._file = os.open(self._path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        except OSError:
            return True
        return _locked(self._file, name, True)


def _locked(file: int, name: str, wanted: bool) -> bool:
    """Lock or unlock the byte whose place is a hash; False if somebody else has it locked."""
    try:
        import fcntl
    except ImportError:  # not on Windows, where nobody is kept out
        return True
    operation = fcntl.LOCK_EX | fcntl.LOCK_NB if wanted else fcntl.LOCK_UN
    try:
        fcntl.lockf(file, operation, 1, int(name, 16) >> 4)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:
        return True
    return True
