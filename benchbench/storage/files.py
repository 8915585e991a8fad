"""Writing files so that a killed run or a full disk never leaves half a file behind."""

from __future__ import annotations

import hashlib
import json
import os
import re
import secrets
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.reading import content
from benchbench.ocp.sizes import JSON_BYTES

RECORD, PLAN, SOLUTION, PICTURE, CONFIG, FLIGHTS, FLIGHTS_PICTURE, FLIGHT = (
    "record.json",
    "plan.mcap",
    "solution.json",
    "plan.png",
    "config.yaml",
    "flights.csv",
    "flights.png",
    "flight.mcap",
)
TEMPORARY_SUFFIX = ".tmp"
DEPTH, LONGEST = 4, 150
"""Folders below that of the results, and characters, that name a run."""
_ODD = re.compile(r"[^\w.+=-]+")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary file name next to `path`; on success it takes the place of `path` at once.

    The folder is created. A failure leaves an existing `path` untouched and removes the temporary file.
    Raises BadInput("output", ...) naming the folder when the file system refuses.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.{secrets.token_hex(4)}{TEMPORARY_SUFFIX}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        raise _cannot_write(path.parent, error) from error
    finally:
        _remove(temporary)


def write_bytes(path: Path, data: bytes) -> None:
    """Write a whole file atomically and flush it to the disk; raises BadInput("output", ...)."""
    with replacing(path) as temporary, temporary.open("xb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def write_record(folder: Path, record: Mapping[str, Any]) -> Path:
    """Write `record.json` into a run's folder and return its path.

    Raises ValueError for NaN or infinity (make_record removes them), BadInput("output", ...) when the
    file system refuses.
    """
    text = json.dumps(record, indent=2, allow_nan=False, ensure_ascii=False)
    path = folder / RECORD
    write_bytes(path, (text + "\n").encode())
    return path


def write_solution(folder: Path, values: Mapping[str, Array]) -> Path:
    """Write the unknowns of an MPCC by name as `solution.json`, each a list of its rows, and return its path."""
    path = folder / SOLUTION
    write_bytes(path, (json.dumps({name: rows.tolist() for name, rows in values.items()}) + "\n").encode())
    return path


def read_solution(folder: Path) -> dict[str, Array]:
    """Read what `write_solution` wrote, as arrays of two dimensions. Raises ValueError for what is no such file."""
    try:
        told = json.loads(content(folder / SOLUTION, SOLUTION, JSON_BYTES, "unknowns by name"))
        return {str(name): np.array(rows, dtype=float, ndmin=2) for name, rows in told.items()}
    except (BadInput, ValueError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        said = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"its {SOLUTION} cannot be read: {said[:160]}") from None


def vacate(folder: Path) -> None:
    """Remove what an earlier run left in a run's folder, so that no old file stands beside a new record.

    The record goes first: without it the others belong to no run. A file or link where the folder should be goes, too. What
    cannot be removed is told by who writes it anew.
    """
    if folder.is_symlink() or folder.is_file():
        _remove(folder)
    for name in (RECORD, PLAN, SOLUTION, PICTURE, CONFIG, FLIGHTS, FLIGHTS_PICTURE, FLIGHT):
        _remove(folder / name)


def run_name(folder: Path, root: Path) -> str:
    """Name of a run, its `run_id`, from its folder: usable as a file name, and no other folder's.

    Where the parts of the path alone may be those of another folder, too, a hash of the whole path stands behind them.
    """
    inside = folder.is_relative_to(root)
    parts = folder.relative_to(root).parts if inside else folder.parts
    name = "_".join(parts[-DEPTH:])
    plain = inside and len(parts) <= DEPTH and not (len(parts) > 1 and any("_" in part for part in parts))
    text = _ODD.sub("-", name).lstrip("-.")[-LONGEST:]
    if plain and text == name:
        return text
    whole = hashlib.sha256("/".join(parts).encode("utf-8", "surrogateescape")).hexdigest()[:8]
    return f"{text}-{whole}".lstrip("-.")


def _cannot_write(folder: Path, error: OSError) -> BadInput:
    reason = error.strerror or str(error)
    return BadInput(
        "output", f"cannot write into {folder}: {reason}", "a folder you may write to, with free space"
    )


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError:
        return  # a leftover temporary file is ignored by every reader; any other is told by who writes it anew
