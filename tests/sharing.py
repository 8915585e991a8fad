"""Runs that several tests look at: made once per session, also where pytest-xdist has several workers."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

from filelock import FileLock

Once = Callable[[str, Callable[[Path], object]], Path]


def made_once(base: Path, name: str, make: Callable[[Path], object]) -> Path:
    """Folder `name`, filled by whoever comes first, of any worker; it is read only: copy what you change."""
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    folder, whole = shared / name, shared / f"{name}.made"
    with FileLock(f"{folder}.lock"):
        if not whole.exists():
            shutil.rmtree(folder, ignore_errors=True)  # of an attempt that failed
            folder.mkdir()
            make(folder)
            whole.touch()
    return folder
