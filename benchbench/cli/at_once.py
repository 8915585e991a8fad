"""Answers that need none of the program behind it: help, version, and what cannot be chosen, in a tenth of the time."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path

from benchbench import __version__
from benchbench.cli import commands
from benchbench.ground.errors import BadInput, BenchBenchError, unknown_choice
from benchbench.ground.families import FLOWN
from benchbench.run import plainly
from benchbench.run.choices import FAMILIES, choices, folder
from benchbench.run.telling import complain, usage

DONE, BAD_INPUT = 0, 2
ROBUST = "strategy=robust"
"""What one may call the search of `benchbench robust`, since a strategy that flies its plans is a search over runs."""
LONG = (
    "--help", "--hydra-help", "--version", "--cfg", "--resolve", "--package", "--run", "--multirun", "--shell-completion",
    "--config-path", "--config-name", "--config-dir", "--experimental-rerun", "--info", "--traceback",
)  # fmt: skip
"""All long options: Hydra's, and two of ours."""
ELSEWHERE = ("-m", "--multirun", "-cp", "--config-path", "-cn", "--config-name", "--experimental-rerun")
"""Options with which choices are not looked at here: several at a time, or from another configuration."""
COMMAND = re.compile(r"[a-z_]\w*")
"""A first argument that can only be a command: what Hydra takes has an equals sign, a tilde or a dash."""
CHOICE = re.compile(rf"(\+scenario|{'|'.join((*FAMILIES[1:], *FLOWN))}|peer)=(\w+)")


def answer(arguments: Sequence[str]) -> int | None:
    """Answer what can be answered at once and return the exit code; None for all else."""
    try:
        if arguments and arguments[0] in commands.names():
            return _command(arguments[0], arguments[1:])
        return _answer([a for a in arguments if a != "--traceback"])
    except BenchBenchError as error:
        complain("bad input", str(error))
        return BAD_INPUT


def meant(arguments: Sequence[str]) -> list[str]:
    """Return the arguments with the command that they are another word for in front."""
    if ROBUST not in arguments:
        return [*arguments]
    return ["robust", *(text for text in arguments if text != ROBUST)]


def _command(name: str, arguments: Sequence[str]) -> int | None:
    """Its help, or what it remembers."""
    if not {"-h", "--help"} & {*arguments}:
        return commands.at_once(name, arguments)
    print(commands.parser(name).explain())
    return DONE


def _answer(arguments: Sequence[str]) -> int | None:
    if arguments and COMMAND.fullmatch(arguments[0]):
        raise _no_command(arguments[0])
    for name in (a.partition("=")[0] for a in arguments if a.startswith("--")):
        if not any(option.startswith(name) for option in LONG):  # Hydra takes abbreviations
            raise BadInput(name, "there is no such option", "what --help shows")
    if "--version" in arguments:
        print(f"benchbench {__version__}")
        return DONE
    own = _own(arguments)
    asked = "--help" in arguments or "-h" in arguments
    if asked or not arguments:
        named = {family: choices(family, *own) for family in (*FAMILIES, *FLOWN)}
        print(usage(commands.summaries(), named))
        sys.stdout.flush()
    if asked:
        return DONE
    if not arguments:
        raise BadInput("scenario", "none was chosen", "+scenario=NAME with a NAME from the list above")
    _check(arguments, own)
    return None


def _no_command(word: str) -> BadInput:
    there = commands.names()
    near = [
        *get_close_matches(word, there, 1),
        *(f"+scenario={word}" for _ in range(word in choices("scenario"))),
    ]
    meant = f", perhaps '{near[0]}' is meant" if near else ""
    return BadInput(word, f"there is no such command{meant}", f"{', '.join(there)}; or +scenario=NAME")


def _check(arguments: Sequence[str], own: Sequence[Path]) -> None:
    """Raise BadInput for a choice that is not there, or a number out of range, where that is plain."""
    if any(a.partition("=")[0] in ELSEWHERE or "hydra." in a for a in arguments):
        return
    for found in filter(None, map(CHOICE.fullmatch, arguments)):
        family, name = found[1].lstrip("+"), found[2]
        if name not in (there := choices(family, *own)) and name != "null":
            raise unknown_choice(family, name, there)
    plainly.check(arguments, Path(folder()) / "scenario")


def _own(arguments: Sequence[str]) -> list[Path]:
    """The folder of --config-dir."""
    for i, text in enumerate(arguments):
        name, given, folder = text.partition("=")
        if name in ("--config-dir", "-cd"):
            return [Path(folder if given else (*arguments, "")[i + 1])]
    return []
