"""Derivatives of one block function, taken once, cached on disk and compiled when a compiler is there.

A block does not know the number of intervals, the bounds or the guesses, so one cache entry serves every
run that uses the same physics. The cache key is the serialised function itself.
"""

from __future__ import annotations

import atexit
import hashlib
import logging
import os
import platform
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Literal

import casadi as ca
import numpy as np
from platformdirs import user_cache_path

from benchbench.mpcc import Index

log = logging.getLogger(__name__)
Compile = Literal["auto", "never"]
FLAGS = ("-O0", "-fPIC", "-shared")


@dataclass(frozen=True)
class Derivatives:
    """Value, Jacobian and Hessian of a block function, each as a dense column of its nonzeros.

    value(z, p, sigma) -> out; jacobian(z, p, sigma) -> nonzeros of d out / dz at (`rows`, `columns`);
    hessian(z, p, sigma, lam) -> nonzeros of the upper triangle of d2 (lam . out) / dz2 at
    (`hessian_rows`, `hessian_columns`).
    """

    value: ca.Function
    jacobian: ca.Function
    hessian: ca.Function
    rows: Index
    columns: Index
    hessian_rows: Index
    hessian_columns: Index
    compiled: bool


def derivatives(functions: Sequence[ca.Function], compile: Compile = "auto") -> list[Derivatives]:
    """Return the derivatives of each function, from the cache where possible."""
    root = cache_root()
    folders = [_folder(f, root) for f in functions]
    missing = {p: f for p, f in zip(folders, functions, strict=True) if not _intact(p / "functions.casadi")}
    for folder, function in missing.items():
        with tempfile.TemporaryDirectory(dir=folder) as scratch:
            _differentiate(function).save(Path(scratch) / "functions.casadi")
            _publish(Path(scratch) / "functions.casadi", folder)
    if compile == "auto" and shutil.which("gcc"):
        _compile_all([p for p in dict.fromkeys(folders) if not _intact(p / "block.so")])
    return [_load(folder, compile) for folder in folders]


def library(function: ca.Function) -> Path | None:
    """Return the shared library with the compiled derivatives of a block function, or None."""
    path = _folder(function, cache_root()) / "block.so"
    return path if _intact(path) else None


def cache_root() -> Path:
    """Folder of the cache: $BENCHBENCH_CACHE, else the user's cache folder, else one for this process only."""
    wanted = os.environ.get("BENCHBENCH_CACHE")
    root = Path(wanted) if wanted else user_cache_path("benchbench") / "blocks"
    try:
        root.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=root):
            pass
    except OSError as error:
        return _temporary_root(root, error.strerror or str(error))
    return root


@cache
def _temporary_root(refused: Path, reason: str) -> Path:
    """A private folder: a fixed name in a shared folder would let others plant libraries that we load."""
    log.warning(
        "cache folder %s is not writable (%s): every run compiles again; set BENCHBENCH_CACHE to a folder that is",
        refused, reason,
    )  # fmt: skip
    root = Path(tempfile.mkdtemp(prefix="benchbench-"))
    atexit.register(shutil.rmtree, root, ignore_errors=True)
    return root


class _Bundle:
    """Several CasADi functions in one file."""

    def __init__(self, functions: Sequence[ca.Function]) -> None:
        self.functions = functions

    def save(self, path: Path) -> None:
        serializer = ca.FileSerializer(str(path))
        for function in self.functions:
            serializer.pack(function)
        del serializer

    @staticmethod
    def load(path: Path, count: int) -> list[ca.Function]:
        reader = ca.FileDeserializer(str(path))
        return [reader.unpack() for _ in range(count)]


def _differentiate(function: ca.Function) -> _Bundle:
    name = function.name()
    z, p, sigma = function.sx_in()
    out = function(z, p, sigma)
    jacobian = ca.jacobian(out, z)
    lam = ca.SX.sym("lam", out.shape[0])
    hessian = ca.triu(ca.hessian(ca.dot(lam, out), z)[0])
    out, jacobian, hessian = (ca.cse(e) for e in (out, jacobian, hessian))
    value = ca.Function(f"{name}_value", [z, p, sigma], [ca.densify(out)])
    flat = ca.Function(f"{name}_first", [z, p, sigma], [_nonzeros(jacobian)], {"allow_free": False})
    curve = ca.Function(f"{name}_second", [z, p, sigma, lam], [_nonzeros(hessian)])
    pattern = ca.Function(
        f"{name}_pattern", [], [ca.DM(jacobian.sparsity(), 1), ca.DM(hessian.sparsity(), 1)]
    )
    return _Bundle([value, flat, curve, pattern])


def _nonzeros(matrix: ca.SX) -> ca.SX:
    return ca.sparsity_cast(matrix, ca.Sparsity.dense(matrix.nnz(), 1))


def _load(folder: Path, compile: Compile) -> Derivatives:
    value, first, second, pattern = _Bundle.load(folder / "functions.casadi", 4)
    compiled = compile != "never" and _intact(folder / "block.so")
    if compiled:
        try:
            value, first, second = (
                ca.external(f.name(), str(folder / "block.so")) for f in (value, first, second)
            )
        except RuntimeError as error:  # for example a file system that forbids to execute
            log.warning("a compiled block cannot be loaded and stays interpreted: %s", error)
            compiled = False
    places = [
        np.array(i, dtype=np.int64) for matrix in pattern.call([]) for i in matrix.sparsity().get_triplet()
    ]
    return Derivatives(value, first, second, places[0], places[1], places[2], places[3], compiled)


def _folder(function: ca.Function, root: Path) -> Path:
    """Folder of one function; the name depends on everything its content does, this module included."""
    here = Path(__file__).read_bytes()
    what = "|".join([function.serialize(), metadata.version("casadi"), platform.machine(), *FLAGS])
    folder = root / hashlib.sha256(here + what.encode()).hexdigest()[:32]
    folder.mkdir(exist_ok=True)
    return folder


def _publish(file: Path, folder: Path) -> None:
    """Move a finished file into place, then its checksum, so that readers never take half of it."""
    seal = file.with_name(f"{file.name}.sha256")
    seal.write_text(hashlib.sha256(file.read_bytes()).hexdigest())
    for part in (file, seal):
        os.replace(part, folder / part.name)


def _intact(file: Path) -> bool:
    """Tell whether the file is what was published; a truncated library would kill the process (SIGBUS)."""
    try:
        seal = file.with_name(f"{file.name}.sha256").read_bytes()
        return seal == hashlib.sha256(file.read_bytes()).hexdigest().encode()
    except OSError:
        return False


def _compile_all(folders: Sequence[Path]) -> None:
    jobs = []
    for folder in folders:
        scratch = Path(tempfile.mkdtemp(dir=folder))
        source = ca.CodeGenerator("block.c")
        for function in _Bundle.load(folder / "functions.casadi", 3):
            source.add(function)
        source.generate(str(scratch) + os.sep)
        command = ["gcc", *FLAGS, str(scratch / "block.c"), "-o", str(scratch / "block.so"), "-lm"]
        jobs.append((folder, scratch, subprocess.Popen(command, stderr=subprocess.PIPE)))
    for folder, scratch, job in jobs:
        _, stderr = job.communicate()
        if job.returncode == 0:
            _publish(scratch / "block.so", folder)
        else:
            log.warning(
                "gcc failed, the block stays interpreted: %s", stderr.decode(errors="replace").strip()[-200:]
            )
        shutil.rmtree(scratch)
