"""Where a run took place: versions, machine and state of the source, for every row."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path

from benchbench.storage.contents import source_hash

CHECKOUT = Path(__file__).resolve().parents[2]
"""Folder that holds the package `benchbench`: the root of the repository if this is a checkout."""

GIT_SECONDS = 2.0

Provenance = dict[str, str | int | bool | None]


def collect() -> Provenance:
    """Return the provenance columns of the record by name; call it when the run starts.

    `solver_version` is missing: only the solver's plugin knows it. What cannot be found out is None.
    """
    commit, dirty = git_state(CHECKOUT)
    return {
        "benchbench_version": version("benchbench"),
        "python_version": platform.python_version(),
        "casadi_version": version("casadi"),
        "numpy_version": version("numpy"),
        "platform": platform.platform(),
        "cpu": cpu_model(),
        "cpu_count": usable_cpus(),
        "threads": threads(os.environ.get("OMP_NUM_THREADS")),
        "git_commit": commit,
        "git_dirty": dirty,
        "source_hash": source_hash(),
        "started_at": datetime.now(UTC).isoformat(timespec="milliseconds"),
    }


def version(package: str) -> str | None:
    """Return the version of an installed distribution, None if it is not installed."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def cpu_model() -> str:
    """Return the model name of the processor, or at least the machine type."""
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
    except OSError:  # not Linux
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(filter(None, names), "") or platform.processor() or platform.machine()


def usable_cpus() -> int | None:
    """Return how many logical processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count()


def threads(setting: str | None) -> int | None:
    """Return the number in OMP_NUM_THREADS (the outermost of a nested "4,2"), None if there is none."""
    outermost = (setting or "").split(",")[0].strip()
    return int(outermost) if outermost.isdecimal() else None


def git_state(folder: Path) -> tuple[str | None, bool | None]:
    """Return commit and "has uncommitted changes" of the checkout whose root is `folder`.

    Both are None if `folder` is not the root of a repository (an installed package may lie inside some
    other project's repository), if there is no commit yet, or git is missing, refuses or takes too long.
    """
    root, _, commit = (_git(folder, "rev-parse", "--show-toplevel", "HEAD") or "").rpartition("\n")
    if not root or Path(root).resolve() != folder.resolve():
        return None, None
    changes = _git(folder, "status", "--porcelain")
    return commit, None if changes is None else bool(changes)


def _git(folder: Path, *arguments: str) -> str | None:
    command = ["git", "-C", str(folder), "--no-optional-locks", *arguments]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=GIT_SECONDS, check=True)
    except (OSError, subprocess.SubprocessError, UnicodeDecodeError):
        return None
    return done.stdout.strip()


def peak_memory_mb() -> float | None:
    """Return the largest resident memory of this process so far in MB (10^6 bytes), None where unknown."""
    try:
        import resource
    except ImportError:  # not on Windows
        return None
    kibibytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return kibibytes * (1e-6 if sys.platform == "darwin" else 1024e-6)
