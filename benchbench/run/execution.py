"""One run of a composed configuration, whatever becomes of it: its files, its row and what to say about it."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import shutil
import tempfile
import time
import traceback
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hydra.core.hydra_config import HydraConfig
from hydra.types import RunMode
from hydra.utils import instantiate
from omegaconf import DictConfig, OmegaConf

from benchbench.ground.errors import (
    BadInput,
    BenchBenchError,
    Crash,
    NoPlan,
    OutOfMemory,
    Pruned,
    Timeout,
    Unavailable,
)
from benchbench.run import config, flying, memory, pipeline, settings
from benchbench.run.failure import cut, failed, reason
from benchbench.run.hydra_errors import EXPECTED, explained
from benchbench.run.progress import LiveLine
from benchbench.storage.best_known import BEST_KNOWN, REFERENCES, known
from benchbench.storage.contents import contents
from benchbench.storage.files import RECORD, run_name, vacate, write_record
from benchbench.storage.locks import alone_in
from benchbench.storage.schema import Record

CERTIFIED, NOT_CERTIFIED, BAD_INPUT = 0, 1, 2
KILLED = (Timeout, Crash, OutOfMemory)
NO_INPUT = (*KILLED, NoPlan)
"""Errors that are about neither the input nor our own code."""
LONGEST_TRACE = 20_000
"""Characters of a traceback that are kept."""
HYDRA = ".hydra"
"""Folder in which Hydra notes what it was told, before a run begins."""
FULL = (errno.ENOSPC, errno.EDQUOT)
"""Numbers of the system's errors for a disk, or a user's share of it, that is full."""


@dataclass(frozen=True)
class Place:
    """Where a run stands: its folder, the root of all results, its choices and its columns of the record."""

    folder: Path
    root: Path
    chosen: dict[str, str]
    combination: str
    labels: dict[str, Any]
    began: float

    @classmethod
    def of(cls, cfg: DictConfig) -> Place:
        """Read it from Hydra."""
        run = HydraConfig.get()
        folder, root = (
            Path(run.runtime.output_dir).resolve(),
            Path(run.runtime.cwd, str(cfg.get("output"))).resolve(),
        )
        combination = " ".join(run.overrides.task) if run.mode == RunMode.MULTIRUN else ""
        labels = {"run_id": run_name(folder, root), "config_hash": config_hash(cfg)}
        return cls(folder, root, dict(run.runtime.choices), combination, labels, time.time())

    @property
    def references(self) -> tuple[Path, Path]:
        """Where best known values of one's own are kept: in the folder of results, or beside it."""
        beside = Path(HydraConfig.get().runtime.cwd, REFERENCES)
        return self.root / BEST_KNOWN, beside / BEST_KNOWN

    @property
    def stored(self) -> bool:
        """The record of this run, and not of an earlier one in the same folder, is there."""
        record = self.folder / RECORD
        try:
            return record.stat().st_mtime >= self.began and self._told.get("run_id") == self.labels["run_id"]
        except OSError:
            return False

    @property
    def _told(self) -> dict[str, Any]:
        """The record in the folder, whoever's; empty where there is none to be read."""
        try:
            told = json.loads((self.folder / RECORD).read_bytes())
        except (OSError, ValueError, RecursionError):
            return {}
        return told if isinstance(told, dict) else {}

    @property
    def taken(self) -> bool:
        """The folder has the record of another configuration, which would be lost."""
        return self._told.get("config_hash") not in (None, self.labels["config_hash"])

    @property
    def sweep(self) -> bool:
        """One of several combinations."""
        return bool(self.combination)


@dataclass(frozen=True)
class Complaint:
    """What to tell the user about an error; `trace` is the traceback as text."""

    kind: str
    text: str
    trace: str = ""


@dataclass(frozen=True)
class Ended:
    """How a run ended: the program's exit code for it, its record if there is one, files, complaints."""

    code: int
    record: Record | None = None
    paths: dict[str, Path] = field(default_factory=dict)
    complaints: tuple[Complaint, ...] = ()


def execute(cfg: DictConfig) -> Ended:
    """Run one composed configuration where Hydra says; raises nothing but KeyboardInterrupt."""
    place = None
    try:
        place = Place.of(cfg)
        done, paths = _run(cfg, place)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # noqa: BLE001  # every way to end gets its message and its record
        return failure(error, cfg, place)
    return Ended(CERTIFIED if done.certificate.certified else NOT_CERTIFIED, done.record, paths)


def failure(error: BaseException, cfg: DictConfig, place: Place | None, **columns: Any) -> Ended:
    """Store and explain what ended a run; a row tells of it, unless it is a single run that never began.

    columns: what the record should say beside what is known of any failed run.
    """
    if not isinstance(error, EXPECTED) and memory.caused(error):
        short = OutOfMemory(f"the run needed more memory than it may have, and ended with {reason(error)}")
        traceback.clear_frames(error.__traceback__)  # what it has hoarded goes: its record needs room
        memory.lift()
        error = short.with_traceback(error.__traceback__)
    if isinstance(error, OSError) and error.errno in FULL:
        error = BadInput("output", f"cannot write: {error.strerror}", "a folder with free space")
    expected = isinstance(error, EXPECTED)
    told = explained(error) if expected else error
    said = () if isinstance(error, Pruned) else (_complaint(error, told),)
    code = BAD_INPUT if expected and not isinstance(error, (*NO_INPUT, Pruned)) else NOT_CERTIFIED
    if place is None:
        return Ended(code, None, {}, said)
    if place.stored:  # only the recording or the picture is missing, or the row
        _give_row(place)
        return Ended(code, None, {}, said)
    if place.sweep or not expected or isinstance(error, NO_INPUT):
        record = failed(told, place.chosen, place.labels | _sizes(cfg) | columns)
        try:
            store(record, place)
        except BenchBenchError as refused:
            also = () if isinstance(told, BadInput) and told.field == "output" else said
            return Ended(BAD_INPUT, None, {}, (*also, Complaint("bad input", str(refused))))
        return Ended(code, record, {}, said)
    _leave(place)
    return Ended(code, None, {}, said)


def store(record: Record, place: Place) -> None:
    """Write a record into the run's folder and its row into the table; raises BadInput("output", ...)."""
    from benchbench.storage.table import append  # pandas takes half a second to import

    vacate(place.folder)
    write_record(place.folder, record)
    append(record, place.root)


def _leave(place: Place) -> None:
    """Remove the folders that were made for a run that never began, unless something else is in them."""
    with contextlib.suppress(OSError):
        if [path.name for path in place.folder.iterdir()] == [HYDRA]:
            shutil.rmtree(place.folder / HYDRA)
        for folder in (place.folder, *place.folder.parents):
            if not folder.is_relative_to(place.root):
                break
            folder.rmdir()


def _give_row(place: Place) -> None:
    """Give the stored record of a run its row, in case the run died between the two."""
    from benchbench.storage.table import append, load_record

    with contextlib.suppress(BenchBenchError, OSError, ValueError, TypeError):
        append(load_record(place.folder / RECORD), place.root)


def config_hash(cfg: DictConfig) -> str:
    """Hash of everything that decides the result of a run.

    That is the composed configuration without `settings.NOT_DECISIVE`, and the content of the files that it names; what flights
    are about plays no part where there are none.
    """
    resolved = OmegaConf.to_container(cfg, resolve=True)
    decisive = {str(k): v for k, v in resolved.items() if k not in settings.NOT_DECISIVE}  # type: ignore[union-attr]
    decisive = flying.decisive(decisive)
    text = OmegaConf.to_yaml(OmegaConf.create(decisive), sort_keys=True)
    return hashlib.sha256("".join([text, *contents(decisive)]).encode()).hexdigest()[:16]


def written(cfg: DictConfig) -> str:
    """Return the configuration as YAML, as it stands beside a plan; a study's part stays out of the files."""
    own = OmegaConf.masked_copy(cfg, [str(key) for key in cfg if key != "on_step"])
    return OmegaConf.to_yaml(own, resolve=True)


def _complaint(error: BaseException, told: BaseException) -> Complaint:
    trace = cut("".join(traceback.format_exception(error)), LONGEST_TRACE)
    if isinstance(told, OutOfMemory):
        return Complaint("out of memory", reason(told), trace)
    if isinstance(told, KILLED):
        return Complaint("the process of the run died", reason(told))
    if isinstance(told, NoPlan):
        return Complaint("there is no plan", reason(told))
    if isinstance(told, Unavailable):
        return Complaint("unavailable", reason(told), trace)
    if isinstance(told, BenchBenchError):
        return Complaint("bad input", reason(told), trace)
    advice = "\n--traceback shows where; if no wrong input is named, please report it"
    return Complaint("the run stopped with an error", reason(told) + advice, trace)


def _run(cfg: DictConfig, place: Place) -> tuple[pipeline.Run, dict[str, Path]]:
    case, asked = config.build(cfg, place.chosen), flying.campaign(cfg, place.chosen)
    how = settings.Settings.of(cfg)
    _check_writable(place.root)
    best = known(*place.references)
    told = instantiate(cfg.on_step) if cfg.get("on_step") else None
    alone = contextlib.nullcontext() if place.sweep else alone_in(place.folder, place.root)
    with alone, LiveLine(told) as line:
        done = pipeline.run(case, line, place.labels, how.repeats, best, asked)
        line.stage("files", None)
        return done, pipeline.write(done, place.folder, place.root, written(cfg), how.draws(place.sweep))


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


def _sizes(cfg: DictConfig) -> dict[str, int]:
    """What a row can say of a case that was never made."""
    found = {key: OmegaConf.select(cfg, f"scenario.{key}") for key in ("intervals", "kappa_init")}
    found["seed"] = cfg.get("seed")
    return {key: value for key, value in found.items() if type(value) is int}
