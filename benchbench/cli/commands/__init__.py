"""The commands beside planning: `benchbench NAME ...` runs `run(arguments)` of the module NAME in this folder.

Help and completion ask a module for `parser()` and the first line of its docstring, so that a module imports what it
works with only when it works.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from benchbench.cli import interrupt

if TYPE_CHECKING:
    from benchbench.cli.arguments import Parser
    from benchbench.sweep.sweep import Swept


RUNS = ("regress",)
"""Commands that carry out runs themselves; others leave that to the main command, if they are short for one."""
REMEMBERS = "plugins"
"""The command whose module has `at_once(arguments)`, too."""


@dataclass(frozen=True)
class Sweep:
    """The sweep that a command is short for, as arguments of the main command, and what it says about it at the end."""

    arguments: list[str]
    finish: Callable[[Sequence[Swept]], None]


def names() -> list[str]:
    """Return the commands there are."""
    return sorted(module.name for module in pkgutil.iter_modules(__path__))


def summaries() -> dict[str, str]:
    """Return how each command is called, and what it does, as the first lines of their files say; nothing is imported."""
    first = [Path(__path__[0], f"{name}.py").read_text().partition("\n")[0].strip('"') for name in names()]
    return {usage.strip("`"): text.rstrip(".") for usage, _, text in (line.partition(": ") for line in first)}


def parser(name: str) -> Parser:
    """Return the arguments that a command takes."""
    takes: Parser = importlib.import_module(f"{__name__}.{name}").parser()
    return takes


def at_once(name: str, arguments: Sequence[str]) -> int | None:
    """Let a command answer that remembers, and return the exit code; None where it has to work."""
    if name != REMEMBERS:
        return None
    told: int | None = importlib.import_module(f"{__name__}.{name}").at_once(arguments)
    return told


def run(name: str, arguments: Sequence[str]) -> int | list[str] | Sweep:
    """Run a command and return the exit code, or the arguments of the main command, or the sweep, that it is short for.

    Raises BadInput for arguments it does not take.
    """
    interrupt.running(name in RUNS)
    done: int | list[str] | Sweep = importlib.import_module(f"{__name__}.{name}").run(arguments)
    interrupt.running(True)
    return done
