"""The configurations of many runs, flat: what two of them have in common is parsed once.

A sweep writes the same text again and again with another number in it, and YAML takes 3 ms for each.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, final

import yaml  # type: ignore[import-untyped]

from benchbench.ocp.reading import DEEPEST
from benchbench.storage.configuration import LARGEST, PLACES, configuration

Settings = Mapping[str, Any]
"""One configuration, flat: "relaxation.schedule" -> value."""
SPECIAL = re.compile(r"[&*!|>%\t]|<<|^(?:---|\.\.\.)", re.MULTILINE)
"""What may make a part of the text say something else than it says alone."""
PART = re.compile(r"^(?=[^\s#-])", re.MULTILINE)
"""Where an entry of a mapping begins."""
NEST = re.compile(r"([A-Za-z_]\w*):\n((?:  .*\n)+)")
"""An entry that is a mapping or list itself, indented."""


def flatten(tree: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Turn a nested configuration into dotted names; lists stay values."""
    flat: dict[str, Any] = {}
    for key, value in tree.items():
        name = sys.intern(f"{prefix}{key}")
        flat |= flatten(value, f"{name}.") if isinstance(value, Mapping) and value else {name: value}
    return flat


@final
class SettingsReader:
    """Reads configurations; keeps what each part of a text says."""

    def __init__(self) -> None:
        """Know nothing yet."""
        self._parts: dict[str, dict[Any, Any]] = {}

    def read(self, folder: Path | None) -> dict[str, Any] | None:
        """Return the settings of the run in `folder`, as `configuration` gives them, None where there are none to be used."""
        text = None if folder is None else _text(folder)
        try:
            tree = self._mapping(text, 0) if text else None
        except (ValueError, yaml.YAMLError, RecursionError):
            tree = None
        if tree is None:
            tree = configuration(folder)
        return None if tree is None else flatten(tree)

    def _mapping(self, text: str, depth: int) -> dict[Any, Any]:
        """A mapping whose entries begin in the first column; raises ValueError or YAMLError for what is none."""
        first, *parts = PART.split(text)
        if first or not parts or depth > DEEPEST:
            raise ValueError
        whole: dict[Any, Any] = {}
        for part in parts:
            whole |= self._part(part, depth)
        return whole

    def _part(self, text: str, depth: int) -> dict[Any, Any]:
        known = self._parts.get(text)
        if known is None:
            known = self._parts[text] = self._parsed(text, depth)
        return known

    def _parsed(self, text: str, depth: int) -> dict[Any, Any]:
        nest = NEST.fullmatch(text)
        if nest and PART.match(nest[2][2:]):
            (key,) = self._part(f"{nest[1]}:\n", depth)
            return {key: self._mapping(re.sub("^  ", "", nest[2], flags=re.MULTILINE), depth + 1)}
        found = yaml.load(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader))
        if not isinstance(found, dict) or len(found) != 1:
            raise ValueError
        return found


def _text(folder: Path) -> str | None:
    """The text of a configuration that can be read in parts."""
    for place in PLACES:
        try:
            with open(folder / place, "rb") as file:
                text = file.read(LARGEST).decode()
        except (OSError, UnicodeError):
            continue
        return None if SPECIAL.search(text) or not text.endswith("\n") else text
    return None
