"""The commands beside planning: `benchbench NAME ...` runs `run(arguments)` of the module NAME in this folder."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Sequence


def names() -> list[str]:
    """Return the commands there are."""
    return sorted(module.name for module in pkgutil.iter_modules(__path__))


def run(name: str, arguments: Sequence[str]) -> int | list[str]:
    """Run a command and return the exit code, or the arguments of the main command that it is short for.

    Raises BadInput for arguments it does not take.
    """
    done: int | list[str] = importlib.import_module(f"{__name__}.{name}").run(arguments)
    return done
