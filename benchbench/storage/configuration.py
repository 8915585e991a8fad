"""The configuration of a run, read back from its folder as data: nothing in it is resolved, loaded or called."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from benchbench.ocp.reading import plain_yaml

PLACES = ("config.yaml", ".hydra/config.yaml")
"""Where it lies: with a plan, and where Hydra puts it before the run begins."""
LARGEST = 1_000_000
"""Bytes of a file that is still read."""


def configuration(folder: Path | None) -> dict[str, Any] | None:
    """Return the composed configuration of the run in `folder` as plain values, None where there is none to be used.

    Text with an interpolation (`${...}`) stays the text that it is: it could name an environment variable.
    """
    for place in PLACES if folder is not None else ():
        try:
            values = read(Path(folder or "", place))
        except (OSError, ValueError):
            continue
        if isinstance(values, dict):
            return {str(key): value for key, value in values.items()}
    return None


def read(path: Path) -> Any:
    """Return a YAML file as plain values; raises OSError, or ValueError for what is no YAML, too large or refers to itself."""
    with path.open("rb") as file:
        text = file.read(LARGEST + 1)
    if len(text) > LARGEST:
        raise ValueError(f"'{path}' is larger than {LARGEST} bytes")
    try:
        return plain_yaml(text)
    except ValueError as error:
        raise ValueError(f"'{path}' {error}") from None
