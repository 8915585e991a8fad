"""The commands beside planning: `benchbench NAME ...` runs `run(arguments)` of the module NAME in this folder."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from benchbench.sweep.sweep import Swept


@dataclass(frozen=True)
class Sweep:
    """The sweep that a command is short for, as arguments of the main command, and what it says about it at the end."""

    arguments: list[str]
    finish: Callable[[Sequence[Swept]], None]


def names() -> list[str]:
    """Return the commands there are."""
    return sorted(module.name for module in pkgutil.iter_modules(__path__))


def run(name: str, arguments: Sequence[str]) -> int | list[str] | Sweep:
    """Run a command and return the exit code, or the arguments of the main command, or the sweep, that it is short for.

    Raises BadInput for arguments it does not take.
    """
    done: int | list[str] | Sweep = importlib.import_module(f"{__name__}.{name}").run(arguments)
    return done
