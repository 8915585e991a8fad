"""Where compiled blocks are kept: a folder that nobody else can write to, since what lies there is loaded and run."""

from __future__ import annotations

import atexit
import logging
import os
import shutil
import stat
import tempfile
from functools import cache
from pathlib import Path

from platformdirs import user_cache_path

log = logging.getLogger(__name__)
OTHERS = stat.S_IWGRP | stat.S_IWOTH


def cache_root() -> Path:
    """Folder of the cache: $BENCHBENCH_CACHE, else the user's cache folder, else one for this process only."""
    wanted = os.environ.get("BENCHBENCH_CACHE")
    root = Path(wanted) if wanted else user_cache_path("benchbench") / "blocks"
    try:
        root.mkdir(parents=True, exist_ok=True, mode=0o700)
        with tempfile.TemporaryFile(dir=root):
            pass
    except OSError as error:
        return _temporary_root(root, f"is not writable ({error.strerror or error})")
    if not private(root):
        return _temporary_root(root, "belongs to, or can be written by, somebody else")
    return root


def private(path: Path) -> bool:
    """Whether a file or folder belongs to this user and nobody else may write to it; raises OSError where there is none.

    A link has to be the user's as well as what it leads to.
    """
    if not hasattr(os, "getuid"):
        return True
    found, owner = path.stat(), os.getuid()
    return found.st_uid == owner == path.lstat().st_uid and not found.st_mode & OTHERS


@cache
def _temporary_root(refused: Path, reason: str) -> Path:
    """A private folder: a fixed name in a shared folder would let others plant libraries that we load."""
    log.warning(
        "cache folder %s %s: every run compiles again; set BENCHBENCH_CACHE to a folder of your own (chmod 700)",
        refused, reason,
    )  # fmt: skip
    root = Path(tempfile.mkdtemp(prefix="benchbench-"))
    atexit.register(shutil.rmtree, root, ignore_errors=True)
    return root
