"""A problem of NOSBENCH, or of anyone who writes the same JSON."""

from __future__ import annotations

import gzip
import io
import json
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, final

import casadi as ca
import numpy as np
from pydantic.dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.mpcc.problem import Mpcc
from benchbench.mpcc.ready import ReadyMade, whole
from benchbench.ocp.reading import content
from benchbench.ocp.sizes import JSON_BYTES
from benchbench_plugins.collections.probing import unreadable
from benchbench_plugins.collections.serialized import foreign

FUNCTIONS = {"f": "augmented_objective_fun", "g": "g_fun", "G": "G_fun", "H": "H_fun"}
FORM = "a JSON file as in NOSBENCH, also gzipped"
NUMBERS = ("w0", "lbw", "ubw", "lbg", "ubg", "p0")


@final
@dataclass(frozen=True)
class MpccFile(ReadyMade):
    """A discretised nonsmooth optimal-control problem (Nurkanovic, Pozharskiy & Diehl 2024, doi:10.1007/s10013-024-00704-z).

    path: a .json or .json.gz with serialised CasADi functions of (w, p) and lists of numbers, where a scalar may
    stand for a list of one; its name without suffixes is the name of the problem.
    trust: read functions, too, that load a library or start a compiler when they are read: they can do anything.
    """

    path: Path
    trust: bool = False

    @property
    def name(self) -> str:
        """Name of the file without suffixes."""
        return self.path.name.removesuffix(".gz").removesuffix(".json")

    def mpcc(self) -> Mpcc:
        """Read the file; raises BadInput("scenario.path", ...) for one that is none of these."""
        told = self._read()
        if missing := [key for key in (*FUNCTIONS.values(), *NUMBERS) if key not in told]:
            raise self._wrong(f"has no '{missing[0]}'")
        try:
            w0, lbw, ubw, lbg, ubg, p0 = (_numbers(key, told[key]) for key in NUMBERS)
            texts = {name: self._checked(told[key], key) for name, key in FUNCTIONS.items()}
            if not self.trust and (problem := unreadable([*texts.values()])):
                raise ValueError(f"one of its functions {problem}")
            functions = {name: ca.Function.deserialize(text) for name, text in texts.items()}
            return whole(functions, p0, w0, (lbw, ubw), (lbg, ubg))
        except (
            ValueError,
            TypeError,
            RuntimeError,
            MemoryError,
            OverflowError,
        ) as error:  # CasADi's are RuntimeErrors
            raise self._wrong(f"is no MPCC: {_said(error)}") from None

    def _checked(self, text: Any, key: str) -> str:
        if not isinstance(text, str):
            raise ValueError(f"{key} is no serialised CasADi function")
        if not self.trust and (problem := foreign(text)):
            allowed = "expressions only (SX or MX); scenario.trust=true where you know who made the file"
            raise BadInput("scenario.path", f"'{self.path}': '{key}' {problem}", allowed)
        return text

    def _read(self) -> Mapping[str, Any]:
        data = content(self.path, "scenario.path", JSON_BYTES, FORM)
        try:
            if data[:2] == b"\x1f\x8b":
                with gzip.open(io.BytesIO(data)) as packed:
                    data = packed.read(JSON_BYTES + 1)
            if len(data) > JSON_BYTES:
                raise self._wrong(f"is larger than {JSON_BYTES / 1e6:g} MB, unpacked")
            told = json.loads(data)
        except (OSError, ValueError, EOFError, RecursionError, zlib.error) as error:
            raise self._wrong(f"is no JSON: {error}") from None
        if not isinstance(told, dict):
            raise self._wrong("is no JSON object")
        return told

    def _wrong(self, problem: str) -> BadInput:
        return BadInput("scenario.path", f"'{self.path}' {problem}", FORM)


def _numbers(key: str, value: Any) -> Array:
    try:
        return np.atleast_1d(np.asarray(value, float)).ravel()
    except (ValueError, TypeError, OverflowError):
        raise ValueError(f"{key} must be a list of numbers") from None


def _said(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[-1] if lines else type(error).__name__
