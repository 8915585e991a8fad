"""The commands beside planning: `benchbench NAME ...` runs `run(arguments)` of the module NAME in this folder."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Sequence


def names() -> list[str]:
    """Return the commands there are."""
    return sorted(module.name for module in pkgutil.iter_modules(__path__))


def run(name: str, arguments: Sequence[str]) -> int:
    """Run a command and return the exit code; raises BadInput for arguments it does not take."""
    return int(importlib.import_module(f"{__name__}.{name}").run(arguments))
