"""One call of the program: Hydra composes each combination, we run it, store it and say what came out."""

from __future__ import annotations

import os
import sys
import traceback
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from hydra._internal.utils import get_args_parser
from hydra.core.config_search_path import ConfigSearchPath
from omegaconf import DictConfig

from benchbench.cli import at_once, commands, interrupt, sweep_summary
from benchbench.cli.composing import compose_and_run
from benchbench.ground.errors import BadInput, Unavailable
from benchbench.run import config, summary
from benchbench.run.execution import BAD_INPUT, CERTIFIED, Ended, Place, execute, failure
from benchbench.run.flying import flying
from benchbench.run.hydra_errors import EXPECTED, explained
from benchbench.run.overrides import carried
from benchbench.run.random_task import drawn
from benchbench.run.sweep_line import count
from benchbench.run.telling import complain
from benchbench.sweep.combination import Combination
from benchbench.sweep.pool import run_all
from benchbench.sweep.single import isolated, limited
from benchbench.sweep.sweep import Swept, sweep
from benchbench.sweep.task import Engine

NOTHING = ("", "''", '""', "null")
"""Values of an override that say nothing."""


def start(arguments: Sequence[str]) -> int:
    """Do what the command line asks and return the exit code."""
    arguments = at_once.meant(arguments)
    if (answered := at_once.answer(arguments)) is not None:
        return answered
    traced = "--traceback" in arguments
    sys.argv[1:] = [a for a in arguments if a != "--traceback"]
    try:
        return _do(sys.argv[1:], traced)
    except BrokenPipeError:
        raise
    except (*EXPECTED, OSError, ValueError) as error:  # Hydra says some of it with plain ValueErrors
        if interrupt.heard():
            raise KeyboardInterrupt from None
        if traced:
            traceback.print_exception(error)
        told = (
            explained(error)
            if isinstance(error, EXPECTED) or not isinstance(error, OSError)
            else _file(error)
        )
        complain("unavailable" if isinstance(error, Unavailable) else "bad input", str(told))
        return BAD_INPUT


def _do(arguments: Sequence[str], traced: bool) -> int:
    finish = None
    if arguments and arguments[0] in commands.names():
        done = commands.run(arguments[0], arguments[1:])
        if isinstance(done, int):
            return done
        if isinstance(done, commands.Sweep):
            arguments, finish = done.arguments, done.finish
        else:
            arguments = done
        sys.argv[1:] = arguments
    options, unknown = get_args_parser().parse_known_args(arguments)
    if unknown:
        raise BadInput(unknown[0], "there is no such option", "what --help shows")
    options.overrides = _complete(options, arguments)
    _check_output(options.overrides)
    os.environ["HYDRA_FULL_ERROR"] = "1"  # errors reach us, we say them in one message
    call = _Invocation(traced)
    compose_and_run(options, call)
    if finish and call.swept:
        finish(call.swept)
    elif len(call.codes) > 1:
        if call.swept:
            sweep_summary.conclude(call.swept)
        count(call.codes.count(CERTIFIED), len(call.codes))
    return max(call.codes, default=CERTIFIED)


def _complete(options: Namespace, arguments: Sequence[str]) -> list[str]:
    """Overrides with what they imply; Hydra, where it reads the command line by itself, finds them there too."""
    given: list[str] = options.overrides
    if options.multirun:
        new = carried([*given, *flying(given, config.chosen_in_files(given, options.config_dir))])
        by_name = dict(zip(given, new, strict=False))
        sys.argv[1:] = [*(by_name.get(a, a) for a in arguments), *new[len(given) :]]
        return [*new]
    meant = config.meant(given, options.config_dir)
    if meant == given:
        return given
    behind = len(sys.argv) - sys.argv[::-1].index(given[-1])  # options may follow the overrides
    sys.argv[behind:behind] = meant[len(given) :]
    return meant


def _check_output(overrides: Sequence[str]) -> None:
    """Raise BadInput for what names no folder of results, before Hydra makes one of that name."""
    for text in overrides:
        key, _, value = text.lstrip("+").partition("=")
        if key == "output" and (value.strip() in NOTHING or value.strip()[0] in "[{"):
            raise BadInput("output", f"'{value}' was given", "the path of a folder")


def _file(error: OSError) -> BadInput:
    if error.filename is None:  # a file that is open already, as on a full disk
        return BadInput("output", f"cannot write: {error.strerror or error}", "a folder with free space")
    path = Path(str(error.filename))
    if path.is_file() and not os.access(path, os.R_OK):
        return BadInput(str(path), f"cannot be read: {error.strerror}")
    return BadInput("output", f"cannot write '{path}': {error.strerror}", "a folder you may write to")


def _ended(composed: DictConfig) -> Ended:
    """How the one configuration there is ended; of a family of tasks, the task that is drawn from it."""
    try:
        cfg = drawn(composed)
    except EXPECTED as error:
        return failure(error, composed, Place.of(composed))
    return isolated(cfg) if limited(cfg) else execute(cfg)


@dataclass
class _Invocation:
    """The runs of one call and how they ended, as exit codes; Hydra calls it for a single run."""

    traced: bool
    codes: list[int] = field(default_factory=list)
    swept: list[Swept] = field(default_factory=list)

    def __call__(self, cfg: DictConfig) -> None:
        """Run the one configuration there is."""
        ended = _ended(cfg)
        self.codes.append(ended.code)
        for complaint in ended.complaints:
            complain(complaint.kind, complaint.text, complaint.trace if self.traced else "")
        if ended.record is not None and not ended.complaints:
            summary.show(ended.record, ended.paths)

    def sweep(
        self, combinations: Sequence[Combination], search_path: ConfigSearchPath, engine: Engine = run_all
    ) -> list[int]:
        """Run all combinations, each in a process of its own; called by our Hydra launchers."""
        swept = sweep(combinations, search_path, self.traced, engine, self.swept)
        codes = [one.code for one in swept]
        self.swept += swept
        self.codes += codes
        return codes
