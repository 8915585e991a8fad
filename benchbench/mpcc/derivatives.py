"""Derivatives of one block function, taken once, cached on disk and compiled when a compiler is there.

A block does not know the number of intervals, the bounds or the guesses, so one cache entry serves every
run that uses the same physics. The cache key is the serialised function itself.
"""

from __future__ import annotations

import hashlib
import logging
import math
import os
import platform
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any, Literal

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Index
from benchbench.mpcc import compiler
from benchbench.mpcc.cache import cache_root, private

log = logging.getLogger(__name__)
Compile = Literal["auto", "optimised", "never"]
"""Where there is a compiler, blocks are compiled so that gcc is soon done, or so that they are fast; or they are interpreted."""
FUNCTIONS, PATTERN, LIBRARY, FAST = "functions.casadi", "pattern.npz", "block.so", "fast.so"
LIBRARIES: dict[Compile, tuple[str, tuple[str, ...]]] = {
    "auto": (LIBRARY, compiler.FLAGS), "optimised": (FAST, compiler.OPTIMISED),
}  # fmt: skip
"""File and flags of the compiled functions."""
KINDS = ("value", "first", "second")
PLACES = ("rows", "columns", "hessian_rows", "hessian_columns")
MANY, SMALL, LARGE = 25, 500, 10_000
"""A block is compiled from SMALL operations on if it has MANY instances, else from LARGE on."""


@dataclass(frozen=True)
class Derivatives:
    """Value, Jacobian and Hessian of a block function, each as a dense column of its nonzeros.

    value(z, p, sigma) -> out; jacobian(z, p, sigma) -> nonzeros of d out / dz at (`rows`, `columns`);
    hessian(z, p, sigma, lam) -> nonzeros of the upper triangle of d2 (lam . out) / dz2 at
    (`hessian_rows`, `hessian_columns`). compiled: they are, or it would not pay.
    """

    value: ca.Function
    jacobian: ca.Function
    hessian: ca.Function
    rows: Index
    columns: Index
    hessian_rows: Index
    hessian_columns: Index
    compiled: bool


def derivatives(
    functions: Sequence[ca.Function],
    compile: Compile = "auto",
    instances: Sequence[int] | None = None,
    seconds: float = math.inf,
) -> list[Derivatives]:
    """Return the derivatives of each function, from the cache where possible.

    instances: how often each function is applied; None: often enough to compile it. seconds: CPU time for compilers; a
    function that takes longer stays interpreted, in this process for good. Processes that meet at an
    empty cache wait for each other, so that each function is differentiated and compiled once.
    """
    root = cache_root()
    folders = [_folder(f, root) for f in functions]
    often = [True] * len(functions) if instances is None else [n >= MANY for n in instances]
    wanted = [(folder, compile, instances is None, n) for folder, n in zip(folders, often, strict=True)]
    if any(_LOADED.get(key, (None,))[0] != _stamp(key[0]) for key in wanted):
        found = _from_disk(functions, folders, compile, instances, seconds)
        stamps = map(_stamp, folders)
        _LOADED.update(zip(wanted, zip(stamps, found, strict=True), strict=True))
    return [_LOADED[key][1] for key in wanted]


Stamp = tuple[tuple[int, int] | None, ...]
_LOADED: dict[tuple[Path, Compile, bool, bool], tuple[Stamp, Derivatives]] = {}
"""What this process has loaded: a strategy of several solves builds nearly the same problem many times."""


def _stamp(folder: Path) -> Stamp:
    """Time and size of the files of an entry: what was loaded is good as long as nobody touches them."""
    found: list[tuple[int, int] | None] = []
    for name in (FUNCTIONS, PATTERN, LIBRARY, FAST):
        try:
            status = os.stat(folder / name)
            found.append((status.st_mtime_ns, status.st_size))
        except OSError:
            found.append(None)
    return tuple(found)


def _from_disk(
    functions: Sequence[ca.Function],
    folders: Sequence[Path],
    compile: Compile,
    instances: Sequence[int] | None,
    seconds: float,
) -> list[Derivatives]:
    by_folder = dict(zip(folders, functions, strict=True))
    with _lacking(by_folder, FUNCTIONS, PATTERN) as missing:
        for folder in missing:
            _differentiate(by_folder[folder], folder)
    found = [_Pattern.load(folder) for folder in folders]
    often = [MANY] * len(functions) if instances is None else instances
    worth = [p.worth_compiling(n) or instances is None for p, n in zip(found, often, strict=True)]
    if compile in LIBRARIES and compiler.found():
        name, flags = LIBRARIES[compile]
        with _lacking([p for p, w in zip(folders, worth, strict=True) if w], name) as missing:
            sources = {folder: _functions(folder) for folder in missing}
            for folder, made in compiler.build(sources, name, seconds, flags):
                _publish(made, folder)
    return [_load(*each, compile) for each in zip(folders, functions, found, worth, strict=True)]


def library(function: ca.Function) -> Path | None:
    """Return the shared library with the compiled derivatives of a block function, or None."""
    path = _folder(function, cache_root()) / LIBRARY
    return path if _intact(path) else None


@contextmanager
def _lacking(folders: Iterable[Path], *names: str) -> Iterator[list[Path]]:
    """Lock the entries that lack a sound file of these names; yields those that still do when it is our turn."""

    def lacks(folder: Path) -> bool:
        return not all(_intact(folder / name) for name in names)

    missing = sorted(filter(lacks, set(folders)))
    with ExitStack() as stack:
        if missing:
            from filelock import FileLock  # slow to import and seldom needed

            for folder in missing:  # sorted, so that no two processes wait for each other
                stack.enter_context(FileLock(folder / "lock"))
        yield list(filter(lacks, missing))


@dataclass(frozen=True)
class _Pattern:
    """Where the nonzeros of Jacobian and Hessian are, and how many operations value and derivatives take."""

    rows: Index
    columns: Index
    hessian_rows: Index
    hessian_columns: Index
    operations: int

    @classmethod
    def load(cls, folder: Path) -> _Pattern:
        with np.load(folder / PATTERN) as file:
            places = [file[name] for name in PLACES]
            return cls(places[0], places[1], places[2], places[3], int(file["operations"]))

    def worth_compiling(self, instances: int) -> bool:
        """Tell whether it pays: gcc takes at least 0.06 s a block, which a few interpreted operations never cost."""
        return self.operations >= (SMALL if instances >= MANY else LARGE)


def _differentiate(function: ca.Function, folder: Path) -> None:
    """Fill an entry: the functions, then the pattern, whose presence says that both are there."""
    name = function.name()
    z, p, sigma = function.sx_in()
    out = function(z, p, sigma)
    if function.n_instructions() >= SMALL:
        out = ca.cse(out)  # derivatives of what is shared are then shared, too
    jacobian = ca.jacobian(out, z)
    lam = ca.SX.sym("lam", out.shape[0])
    hessian = ca.triu(ca.hessian(ca.dot(lam, out), z)[0])
    jacobian, hessian = ca.cse(jacobian), ca.cse(hessian)
    made = (
        ca.Function(f"{name}_value", [z, p, sigma], [ca.densify(out)]),
        ca.Function(f"{name}_first", [z, p, sigma], [_nonzeros(jacobian)], {"allow_free": False}),
        ca.Function(f"{name}_second", [z, p, sigma, lam], [_nonzeros(hessian)]),
    )
    places = [np.array(i, dtype=np.int64) for e in (jacobian, hessian) for i in e.sparsity().get_triplet()]
    count = sum(f.n_instructions() for f in made)
    with tempfile.TemporaryDirectory(dir=folder) as scratch:
        serializer = ca.FileSerializer(str(Path(scratch, FUNCTIONS)))
        for each in made:
            serializer.pack(each)
        del serializer  # closes the file
        _publish(Path(scratch, FUNCTIONS), folder)
        with Path(scratch, PATTERN).open("wb") as file:
            numbers: dict[str, Any] = dict(zip(PLACES, places, strict=True))
            np.savez(file, operations=count, **numbers)
        _publish(Path(scratch, PATTERN), folder)


def _functions(folder: Path) -> list[ca.Function]:
    """Value, first and second derivatives; raises RuntimeError when the file is damaged."""
    reader = ca.FileDeserializer(str(folder / FUNCTIONS))
    return [reader.unpack() for _ in range(3)]


def _nonzeros(matrix: ca.SX) -> ca.SX:
    return ca.sparsity_cast(matrix, ca.Sparsity.dense(matrix.nnz(), 1))


def _load(
    folder: Path, function: ca.Function, pattern: _Pattern, worth: bool, compile: Compile
) -> Derivatives:
    wanted = compile in LIBRARIES and worth
    made = _compiled(folder / LIBRARIES[compile][0], function.name()) if wanted else None
    value, first, second = made or _functions(folder)
    return Derivatives(
        value=value, jacobian=first, hessian=second, rows=pattern.rows, columns=pattern.columns,
        hessian_rows=pattern.hessian_rows, hessian_columns=pattern.hessian_columns,
        compiled=compile != "never" and (made is not None or not worth),
    )  # fmt: skip


def _compiled(library: Path, name: str) -> list[ca.Function] | None:
    if not _intact(library):
        return None
    try:
        return [ca.external(f"{name}_{what}", str(library)) for what in KINDS]
    except RuntimeError as error:  # for example a file system that forbids to execute
        log.warning("a compiled block cannot be loaded and stays interpreted: %s", error)
        return None


def _folder(function: ca.Function, root: Path) -> Path:
    """Folder of one function; the name depends on everything its content does."""
    folder = root / hashlib.sha256((_maker() + function.serialize()).encode()).hexdigest()[:32]
    folder.mkdir(exist_ok=True)
    return folder


@cache
def _maker() -> str:
    """What makes the entries: this module, CasADi, the machine, the compiler's flags."""
    here = Path(__file__).read_text()
    return "|".join(
        [here, metadata.version("casadi"), platform.machine(), *compiler.FLAGS, *compiler.OPTIMISED]
    )


def _publish(file: Path, folder: Path) -> None:
    """Move a finished file into place, then its checksum, so that readers never take half of it."""
    seal = file.with_name(f"{file.name}.sha256")
    seal.write_text(hashlib.sha256(file.read_bytes()).hexdigest())
    for part in (file, seal):
        part.chmod(0o600)
        os.replace(part, folder / part.name)


def _intact(file: Path) -> bool:
    """Tell whether the file is what we published; a truncated library would kill the process (SIGBUS)."""
    try:
        seal = file.with_name(f"{file.name}.sha256").read_bytes()
        return private(file) and seal == hashlib.sha256(file.read_bytes()).hexdigest().encode()
    except OSError:
        return False
