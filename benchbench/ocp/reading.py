"""Files as users and strangers write them: no larger than is sane, and as plain values."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml  # type: ignore[import-untyped]

from benchbench.ground.errors import BadInput

MOST = 100_000
"""Values in YAML; a few aliases in a short file can stand for billions."""
DEEPEST = 50
"""Levels of nesting."""


def content(path: Path, field: str, most: int, allowed: str) -> bytes:
    """Return what is in a file, at most so many bytes.

    Raises BadInput for one that cannot be read, is larger, or is no file: a device or a pipe may never end.
    """
    try:
        if not path.is_file():
            why = "it is no file" if path.exists() else "there is no such file"
            raise BadInput(field, f"cannot read '{path}': {why}", allowed)
        with path.open("rb") as file:
            data = file.read(most + 1)
    except OSError as error:
        raise BadInput(field, f"cannot read '{path}': {error.strerror or error}", allowed) from None
    except ValueError:  # a name with a null character
        raise BadInput(field, f"cannot read {str(path)!r}: it is no name of a file", allowed) from None
    if len(data) > most:
        raise BadInput(field, f"'{path}' is larger than {most / 1e6:g} MB", allowed)
    return data


def plain_yaml(text: str | bytes) -> Any:
    """Return YAML as plain values without shared parts.

    Raises ValueError for what is no YAML, has too many values, is too deep or refers to itself.
    """
    try:
        values = yaml.load(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except Exception as error:  # noqa: BLE001  # a scalar with a wrong tag fails in many ways
        said = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"is no YAML: {said[:160]}") from None
    return _plain(values, [MOST], 0)


def _plain(value: Any, left: list[int], depth: int) -> Any:
    left[0] -= 1
    if left[0] < 0 or depth > DEEPEST:
        raise ValueError("has too many values, is too deep, or refers to itself")
    if isinstance(value, dict):
        return {key: _plain(inner, left, depth + 1) for key, inner in value.items()}
    if isinstance(value, list):
        return [_plain(inner, left, depth + 1) for inner in value]
    return value
