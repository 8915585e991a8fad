"""What the process of a run does: it begins as a copy of its keeper, carries out one run, answers and ends."""

from __future__ import annotations

import contextlib
import faulthandler
import json
import os
import pickle
import signal
import sys
import traceback
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

from hydra import version
from hydra._internal.callbacks import Callbacks
from hydra._internal.config_loader_impl import ConfigLoaderImpl
from hydra._internal.hydra import Hydra
from hydra.core.config_search_path import ConfigSearchPath
from hydra.core.global_hydra import GlobalHydra
from hydra.core.plugins import Plugins
from hydra.core.utils import run_job
from hydra.types import HydraContext
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from benchbench.ground.errors import BadInput
from benchbench.run import memory
from benchbench.run.execution import (
    BAD_INPUT,
    CERTIFIED,
    NOT_CERTIFIED,
    Complaint,
    Ended,
    Place,
    execute,
    failure,
)
from benchbench.run.settings import Settings
from benchbench.storage.schema import make_record
from benchbench.sweep import processes
from benchbench.sweep.job import Job

WRITERS = ("benchbench.storage.recording", "benchbench.storage.table")
PICTURE = "benchbench.report.picture"
"""Modules that a run needs once it has a plan."""
INTERPOLATIONS = ("${a}", "${a}/x/${f:%Y-%m-%d}/${f:%H-%M-%S-%f}", "${f:a.b}", "${f:X,y}", "${a.b}", "${.c}")
"""One of each form that configurations have."""
SAID_NOTHING = 70
"""Exit code of a run's process whose own machinery failed; its log has the traceback."""

_exit = os._exit  # whatever a plugin makes of it


def begin(search_path: ConfigSearchPath, picture: bool) -> None:
    """Import what every run needs and make Hydra's search path known; `picture`: whether runs will draw."""
    for module in (*WRITERS, PICTURE)[
        : None if picture else -1
    ]:  # not at the top: the parent, and whoever refuses bad input, does without
        import_module(module)
    for text in INTERPOLATIONS:  # the parser learns its grammar by use: 70 ms of CPU less in every run
        with contextlib.suppress(OmegaConfBaseException):
            OmegaConf.to_container(OmegaConf.create({"a": 1, "b": text}), resolve=True)
    version.setbase("1.3")
    Plugins.instance()  # finds the kinds of places that configuration comes from
    GlobalHydra.instance().clear()
    GlobalHydra.instance().initialize(Hydra("benchbench", ConfigLoaderImpl(config_search_path=search_path)))


def carry_out(content: bytes, output: int, answer: int) -> NoReturn:
    """Be the process of a run: it prints to `output`, writes its answer to `answer` and ends."""
    me, code = os.getpid(), SAID_NOTHING
    try:
        _settle(output)
        known = set(sys.modules)
        job, settings = pickle.loads(content)
        processes.stand_in(job.config.hydra.runtime.cwd)
        end = work(job, settings)
        if os.getpid() == me:  # and not a copy that a plugin has made
            _write(answer, encoded(end, sorted(set(sys.modules) - known)))
            code = 0
    except BaseException:  # noqa: BLE001  # it must not become a second keeper
        traceback.print_exc()
    finally:
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(BaseException):  # closed, or a plugin's own
                stream.flush()
        _exit(code)


def work(job: Job, settings: Settings) -> Ended:
    """Carry out one run in this process, within its limit of memory."""
    context = HydraContext(GlobalHydra.instance().config_loader(), Callbacks())
    where = str(job.config.hydra.runtime.output_dir)
    memory.limit(settings.memory_limit_mb)
    folder_key, sub_key = ("hydra.sweep.dir", "hydra.sweep.subdir") if job.swept else ("hydra.run.dir", None)

    def guarded(cfg: DictConfig) -> Ended:
        try:
            memory.limit(settings.memory_limit_mb)
            return execute(cfg)
        except KeyboardInterrupt as error:  # a plugin's: Ctrl-C does not come here
            return failure(error, cfg, Place.of(cfg))

    try:
        Path(where).mkdir(parents=True, exist_ok=True)
        return run_job(guarded, job.config, folder_key, sub_key, context).return_value
    except OSError as error:  # Hydra's own files, beside the run's
        why = BadInput(
            "output",
            f"cannot write into {where}: {error.strerror}",
            "a folder you may write to, with free space",
        )
        return failure(why, job.case, None)


def encoded(end: Ended, modules: list[str]) -> bytes:
    """Write an end, and the names of the modules that it took, as JSON."""
    complaints = [(c.kind, c.text, c.trace) for c in end.complaints]
    paths = {name: str(path) for name, path in end.paths.items()}
    told = {"code": end.code, "record": end.record, "paths": paths, "complaints": complaints}
    return json.dumps({**told, "modules": modules}).encode()


def decoded(answer: bytes) -> Ended | None:
    """Read an end; None for what is none, as a plugin may have written."""
    try:
        told: Any = json.loads(answer)
        complaints = tuple(Complaint(*map(str, complaint)) for complaint in told["complaints"])
        paths = {str(name): Path(path) for name, path in told["paths"].items()}
        record = None if told["record"] is None else make_record(**told["record"])
        code = (CERTIFIED, NOT_CERTIFIED, BAD_INPUT).index(told["code"])
        return Ended(code, record, paths, complaints)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def _settle(output: int) -> None:
    """Lead a group of its own without a terminal, die with the keeper, print where the keeper reads."""
    os.setsid()
    processes.die_with_parent()
    signal.set_wakeup_fd(-1)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
    nothing = os.open(os.devnull, os.O_RDONLY)
    for source, place in ((nothing, 0), (output, 1), (output, 2)):
        os.dup2(source, place)
    os.close(nothing)
    os.close(output)
    faulthandler.enable(2)


def _write(descriptor: int, data: bytes) -> None:
    while data:
        data = data[os.write(descriptor, data) :]
