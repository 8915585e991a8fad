"""What a run reads beside its configuration, by content: the files that the configuration names, and the source of the program."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from benchbench.ground import registry
from benchbench.storage.files import PLAN

SOURCES = (".py", ".yaml")
"""Suffixes of what decides how the program works."""
LONGEST = 1024
"""Characters of a text that may be a path."""


def contents(tree: Any) -> Iterator[str]:
    """Hash of each file that a configuration names, in its order; of the plan where it names the folder of a run."""
    if isinstance(tree, dict):
        for value in tree.values():
            yield from contents(value)
    elif isinstance(tree, list):
        for value in tree:
            yield from contents(value)
    elif isinstance(tree, str | Path) and (file := _file(str(tree))) is not None:
        with file.open("rb") as opened:
            yield hashlib.file_digest(opened, "sha256").hexdigest()


@cache
def source_hash() -> str:
    """Hash of the source of BenchBench and of all installed plugins: a run of other code is another run."""
    digest = hashlib.sha256()
    for place in sorted(_packages()):
        for file in sorted(
            path for path in (place, *place.rglob("*")) if path.suffix in SOURCES and path.is_file()
        ):
            digest.update(str(file.relative_to(place)).encode())
            digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def _file(text: str) -> Path | None:
    """The file that a text names, None for a text that names none."""
    if not 0 < len(text) <= LONGEST or "\n" in text or "\0" in text:
        return None
    try:
        path = Path(text)
        return path if path.is_file() else path / PLAN if (path / PLAN).is_file() else None
    except OSError:  # a name that no file system takes
        return None


def _packages() -> set[Path]:
    """Folders of the packages of the core, of its configuration and of all plugins, or files of those that are none."""
    names = {"benchbench"} | {target.partition(".")[0].partition(":")[0] for target in registry.targets()}
    specs = [spec for spec in map(find_spec, names) if spec is not None]
    found = {
        Path(place)
        for spec in specs
        for place in spec.submodule_search_locations or [spec.origin or ""]
        if place
    }
    beside = {folder.parent / "conf" for folder in found if folder.name == "benchbench"}
    return found | {folder for folder in beside if folder.is_dir()}
