"""Block functions as shared libraries: gcc, for no longer than it may."""

from __future__ import annotations

import logging
import math
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path

import casadi as ca

log = logging.getLogger(__name__)
FLAGS = ("-O0", "-fPIC", "-shared")
"""-O1 takes a third off an evaluation, but gcc takes 2.6 s for a block of verlet in place of 0.6."""
OPTIMISED = ("-O1", *FLAGS[1:])
"""For what is solved hundreds of times. The numbers are the same bit by bit: nothing here lets gcc reorder sums or fuse products."""
LEAST = 1
"""CPU seconds that every compilation is granted."""
LIMITED = 'ulimit -t "$0" 2>/dev/null; exec gcc "$@"'
"""The limit is one of the operating system and holds for what gcc starts, so that nothing is left running."""


def found() -> bool:
    """Tell whether there is a compiler."""
    return shutil.which("gcc") is not None


def start(
    source: Path, made: Path, seconds: float, links: Iterable[Path] = (), flags: Iterable[str] = FLAGS
) -> subprocess.Popen[str]:
    """Start gcc on a C file; it ends with an error after so many CPU seconds, `LEAST` at least."""
    words = [*flags, str(source), "-o", str(made), *map(str, links), "-lm"]
    limited = math.isfinite(seconds) and shutil.which("sh")
    command = ["sh", "-c", LIMITED, str(max(LEAST, math.ceil(seconds)))] if limited else ["gcc"]
    return subprocess.Popen([*command, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def succeeds(job: subprocess.Popen[str], what: str) -> bool:
    """Wait for gcc; what it says when it fails is logged."""
    _, stderr = job.communicate()
    if job.returncode:
        log.warning("gcc failed, or its time was up: %s: %s", what, stderr.strip()[-200:])
    return job.returncode == 0


def build(
    sources: Mapping[Path, list[ca.Function]], name: str, seconds: float, flags: Iterable[str] = FLAGS
) -> Iterable[tuple[Path, Path]]:
    """Compile the functions of each folder into one library; yields folder and library where gcc succeeds.

    seconds: of CPU for all of them together. A library lies in a folder of its own that is gone when the next is asked for.
    """
    jobs = []
    for folder, functions in sources.items():
        scratch = Path(tempfile.mkdtemp(dir=folder))
        source = ca.CodeGenerator("block.c")
        for function in functions:
            source.add(function)
        source.generate(str(scratch) + os.sep)
        made = scratch / name
        jobs.append((folder, made, start(scratch / "block.c", made, seconds / len(sources), flags=flags)))
    for folder, made, job in jobs:
        if succeeds(job, "the block stays interpreted"):
            yield folder, made
        shutil.rmtree(made.parent)
