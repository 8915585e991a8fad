"""Lines that took long to find out, remembered until what they depend on changes: what is installed here, and where."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import sys
from collections.abc import Iterable, Iterator
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

from benchbench.ground import registry
from benchbench.mpcc.cache import cache_root, private
from benchbench.run.choices import folder

LOADER = ("/etc/ld.so.cache", "/etc/ld.so.conf")
"""They change when a library is installed into the system."""
SAID = ("PATH", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "PYTHONPATH")
LICENCES = ("LICENSE", "LICENCE", "LIC_")
"""Parts of the names of variables by which solvers are told of their licence."""


def recall(what: str) -> list[str] | None:
    """Return the lines that were kept under a name in this environment; None where there are none that can be trusted."""
    path = _place(what)
    with suppress(OSError, ValueError):
        if private(path):
            lines = json.loads(path.read_text())
            return [str(line) for line in lines] if isinstance(lines, list) else None
    return None


def keep(what: str, lines: Iterable[str]) -> None:
    """Keep lines under a name for this environment, in place of those of another; a full disk is no reason to complain."""
    path = _place(what)
    with suppress(OSError):
        for old in path.parent.glob(f"{what}-*.json"):
            old.unlink()
        temporary = path.with_suffix(f".{os.getpid()}.tmp")
        temporary.write_text(json.dumps(list(lines)))
        temporary.chmod(0o600)
        temporary.replace(path)


def _place(what: str) -> Path:
    told = "\n".join(_environment())
    return cache_root() / f"{what}-{hashlib.sha256(told.encode()).hexdigest()[:24]}.json"


def _environment() -> Iterator[str]:
    """All that decides what can be chosen and works here: Python, distributions, sources, configuration, libraries, licences."""
    yield f"{sys.version} {sys.prefix} {platform.platform()}"
    for name, value in sorted(os.environ.items()):
        if name in SAID or name.startswith("BENCHBENCH_") or any(part in name.upper() for part in LICENCES):
            yield f"{name}={value}"
    for place in map(Path, filter(None, sys.path)):
        yield from _listed(place, "*-info")
    libraries = os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    for place in map(Path, (*LOADER, *filter(None, libraries))):
        yield _state(place)
    for place in sorted({Path(folder()), *_sources()}):
        yield from _listed(place, "**/*.yaml")
        yield from _listed(place, "**/*.py")


def _sources() -> Iterator[Path]:
    """Folders of the packages that register something with us, and our own."""
    yield Path(__file__).parents[1]
    for name in {target.partition(":")[0].partition(".")[0] for target in registry.targets()}:
        with suppress(ImportError, ValueError):
            spec = find_spec(name)
            yield from map(Path, (spec and spec.submodule_search_locations) or ())


def _listed(place: Path, pattern: str) -> Iterator[str]:
    return (_state(path) for path in sorted(place.glob(pattern)))


def _state(path: Path) -> str:
    try:
        found = path.stat()
    except OSError:
        return f"{path} is not there"
    return f"{path} {found.st_mtime_ns} {found.st_size}"
