"""What can be typed next, when the shell asks with the environment of argcomplete: the script of `benchbench completion`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from argcomplete.completers import FilesCompleter
from argcomplete.finders import CompletionFinder
from argcomplete.lexers import split_line

from benchbench.cli import commands
from benchbench.cli.arguments import Parser
from benchbench.ground.families import FLOWN
from benchbench.run.choices import FAMILIES, choices

ASKED = "_ARGCOMPLETE"
"""Environment variable by which the shell asks."""


def complete(**more: Any) -> None:
    """Say what can be typed next, and leave; `more` goes to argcomplete."""
    line = os.environ["COMP_LINE"][: int(os.environ["COMP_POINT"])]
    _, _, _, before, _ = split_line(line)
    known = len(before) > 1 and before[1] in commands.names()
    if known:
        os.environ[ASKED] = "2"  # the command's name belongs to what is called
    takes = _command(before[1]) if known else _main()
    CompletionFinder(takes, always_complete_options=False)(takes, **more)


def _command(name: str) -> Parser:
    takes = commands.parser(name)
    if takes.overrides:
        takes.add_argument("overrides", nargs="*")
    for action in takes._actions:
        if action.dest in ("overrides", "choice"):
            action.completer = _overrides  # type: ignore[attr-defined]
        elif name == "suite" and action.dest == "name":
            action.completer = _suites  # type: ignore[attr-defined]
    return takes


def _main() -> Parser:
    takes = Parser("", "", "")
    takes.add_argument("-m", "--multirun", "--version", "--traceback", action="store_true")
    takes.add_argument("--config-dir", nargs=1).completer = FilesCompleter()  # type: ignore[attr-defined]
    takes.add_argument("--cfg", choices=("job", "hydra", "all"))
    takes.add_argument("overrides", nargs="*").completer = _words  # type: ignore[attr-defined]
    return takes


def _words(prefix: str, parsed_args: Any, **_: Any) -> list[str]:
    """A command, where nothing was typed before it, or an override."""
    first = [] if parsed_args.overrides else commands.names()
    return [*first, *_overrides(prefix, parsed_args)]


def _overrides(prefix: str, parsed_args: Any, **_: Any) -> list[str]:
    """The families of choices, or the names in one."""
    own = [Path(folder) for folder in getattr(parsed_args, "config_dir", None) or ()]
    told, chosen = prefix.partition("=")[:2]
    family = told.lstrip("+")
    if chosen and family in (*FAMILIES, *FLOWN):
        return [f"{told}={name}" for name in choices(family, *own)]
    return [f"{'+' if family == 'scenario' else ''}{family}=" for family in (*FAMILIES, *FLOWN)]


def _suites(**_: Any) -> list[str]:
    return choices("suite")
