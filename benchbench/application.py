"""One call of the program: Hydra composes each combination, we run it, store it and say what came out."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import sys
import tempfile
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import hydra
from hydra._internal.utils import get_args_parser
from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf

from benchbench import __version__, commands, config, pipeline, summary
from benchbench.errors import BadInput, BenchBenchError
from benchbench.failure import failed, reason
from benchbench.hydra_errors import EXPECTED, explained
from benchbench.overrides import carried
from benchbench.progress import LiveLine
from benchbench.storage.files import RECORD, write_record
from benchbench.storage.schema import Record

CERTIFIED, NOT_CERTIFIED, BAD_INPUT = 0, 1, 2


def start(arguments: Sequence[str]) -> int:
    """Do what the command line asks and return the exit code."""
    traced = "--traceback" in arguments
    sys.argv[1:] = [a for a in arguments if a != "--traceback"]
    try:
        return _do(sys.argv[1:], traced)
    except BrokenPipeError:
        raise
    except (*EXPECTED, OSError, ValueError) as error:  # Hydra says some of it with plain ValueErrors
        if traced:
            traceback.print_exception(error)
        told = (
            explained(error)
            if isinstance(error, EXPECTED) or not isinstance(error, OSError)
            else _file(error)
        )
        summary.complain("bad input", str(told))
        return BAD_INPUT


def _do(arguments: Sequence[str], traced: bool) -> int:
    if arguments and arguments[0] in commands.names():
        return commands.run(arguments[0], arguments[1:])
    options, unknown = get_args_parser().parse_known_args([a for a in arguments if a != "--version"])
    if unknown:
        raise BadInput(unknown[0], "there is no such option", "what --help shows")
    if "--version" in arguments:
        print(f"benchbench {__version__}")
        return CERTIFIED
    if options.help or not arguments:
        print(summary.usage({f: _choices(f, options.config_dir) for f in config.KINDS}))
    if options.help:
        return CERTIFIED
    if not arguments:
        raise BadInput("scenario", "none was chosen", "+scenario=NAME with a NAME from the list above")
    if options.multirun:
        new = dict(zip(options.overrides, carried(options.overrides), strict=True))
        sys.argv[1:] = [new.get(a, a) for a in arguments]
    os.environ["HYDRA_FULL_ERROR"] = "1"  # errors reach us, we say them in one message
    call = _Call(traced)
    hydra.main(version_base="1.3", config_path=config.folder(), config_name="config")(call.task)()
    if len(call.codes) > 1:
        summary.count(call.codes.count(CERTIFIED), len(call.codes))
    return max(call.codes, default=CERTIFIED)


def _choices(family: str, more: str | None) -> list[str]:
    """Names to choose from, with those in the folder given by --config-dir."""
    own = [path.stem for path in Path(more, family).glob("*.yaml")] if more else []
    return sorted({*config.choices(family), *own})


def _file(error: OSError) -> BadInput:
    path = Path(str(error.filename))
    if path.is_file() and not os.access(path, os.R_OK):
        return BadInput(str(path), f"cannot be read: {error.strerror}")
    return BadInput("output", f"cannot write '{path}': {error.strerror}", "a folder you may write to")


@dataclass(frozen=True)
class _Place:
    """Where a run stands: its folder, the root of all results, its choices and its columns of the record."""

    folder: Path
    root: Path
    chosen: dict[str, str]
    combination: str
    labels: dict[str, Any]
    began: float

    @classmethod
    def of(cls, cfg: DictConfig) -> _Place:
        """Read it from Hydra."""
        run = HydraConfig.get()
        folder, root = (
            Path(run.runtime.output_dir).resolve(),
            Path(run.runtime.cwd, str(cfg.get("output"))).resolve(),
        )
        combination = " ".join(run.overrides.task) if run.mode == RunMode.MULTIRUN else ""
        labels = {"run_id": _run_id(folder, root), "config_hash": config_hash(cfg)}
        return cls(folder, root, dict(run.runtime.choices), combination, labels, time.time())

    @property
    def stored(self) -> bool:
        """The record of this run, and not of an earlier one in the same folder, is there."""
        record = self.folder / RECORD
        return record.is_file() and record.stat().st_mtime >= self.began

    @property
    def sweep(self) -> bool:
        """One of several combinations."""
        return bool(self.combination)


@dataclass
class _Call:
    """The combinations of one call and how they ended, as exit codes."""

    traced: bool
    codes: list[int] = field(default_factory=list)

    def task(self, cfg: DictConfig) -> None:
        """Run one combination, whatever becomes of it; a bad one does not stop the others."""
        place = None
        try:
            place = _Place.of(cfg)
            done, paths = _run(cfg, place)
        except Exception as error:  # noqa: BLE001  # every way to end gets its message and its record
            self.codes.append(self._ended(error, cfg, place))
            return
        self.codes.append(CERTIFIED if done.certificate.certified else NOT_CERTIFIED)
        if place.sweep:
            summary.show_line(len(self.codes), done.record, place.combination)
        else:
            summary.show(done.record, paths)

    def _ended(self, error: Exception, cfg: DictConfig, place: _Place | None) -> int:
        """Say what ended a run; a row tells of it, unless it is a single run that never began."""
        expected = isinstance(error, EXPECTED)
        told = explained(error) if expected else error
        self._say(error, told, place)
        if place is None or place.stored:  # stored: only the recording or the picture is missing
            return BAD_INPUT if expected else NOT_CERTIFIED
        if place.sweep or not expected:
            try:
                _store(failed(told, place.chosen, place.labels | _sizes(cfg)), place)
            except BenchBenchError as refused:
                summary.complain("bad input", str(refused))
                return BAD_INPUT
        else:
            with contextlib.suppress(OSError):
                place.folder.rmdir()  # Hydra made it for nothing; only an empty one goes
        return BAD_INPUT if expected else NOT_CERTIFIED

    def _say(self, error: Exception, told: Exception, place: _Place | None) -> None:
        if self.traced:
            traceback.print_exception(error)
        kind, advice = "bad input", ""
        if not isinstance(told, BenchBenchError):
            kind = "the run stopped with an error"
            advice = "\n--traceback shows where; if no wrong input is named, please report it"
        where = f" (run {len(self.codes) + 1}: {place.combination})" if place and place.sweep else ""
        summary.complain(kind + where, reason(told) + advice)


def _run(cfg: DictConfig, place: _Place) -> tuple[pipeline.Run, dict[str, Path]]:
    case = config.build(cfg, place.chosen)
    _check_writable(place.root)
    with LiveLine() as line:
        done = pipeline.run(case, line, place.labels)
        line.stage("files", None)
        return done, pipeline.write(done, place.folder, place.root, OmegaConf.to_yaml(cfg, resolve=True))


def _store(record: Record, place: _Place) -> None:
    from benchbench.storage.table import append  # pandas takes half a second to import

    write_record(place.folder, record)
    append(record, place.root)


def _check_writable(root: Path) -> None:
    """Raise BadInput before anything is computed for nothing; Hydra has made the run's own folder already."""
    from benchbench.storage.table import folder

    try:
        folder(root).mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder(root)):
            pass
    except OSError as error:
        problem = f"cannot write into '{folder(root)}': {error.strerror}"
        raise BadInput("output", problem, "a folder you may write to") from None


def config_hash(cfg: DictConfig) -> str:
    """Hash of everything that decides the result of a run: the composed config without the output folder."""
    decisive = {str(k): v for k, v in OmegaConf.to_container(cfg, resolve=True).items() if k != "output"}  # type: ignore[union-attr]
    text = OmegaConf.to_yaml(OmegaConf.create(decisive), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _run_id(folder: Path, root: Path) -> str:
    """Name of a run from its folder, usable as a file name."""
    near = folder.relative_to(root) if folder.is_relative_to(root) else folder
    return re.sub(r"[^\w.+=-]+", "-", "_".join(near.parts[-4:])).lstrip("-.") or "run"


def _sizes(cfg: DictConfig) -> dict[str, int]:
    """What a row can say of a case that was never made."""
    found = {key: OmegaConf.select(cfg, f"scenario.{key}") for key in ("intervals", "kappa_init")}
    found["seed"] = cfg.get("seed")
    return {key: value for key, value in found.items() if type(value) is int}
