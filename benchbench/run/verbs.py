"""What `import benchbench as bb` does from Python, by the words of the command line: plan, certify, load, runs."""

from __future__ import annotations

import warnings
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from omegaconf import DictConfig

from benchbench.flight.campaign import Campaign
from benchbench.ground.errors import BadInput
from benchbench.ocp.plan import Interpolation, Plan
from benchbench.planning.case import Case, ReadyCase
from benchbench.planning.given import Given
from benchbench.run import config, pipeline
from benchbench.run.execution import config_hash, written
from benchbench.run.flying import campaign
from benchbench.run.overrides import quoted
from benchbench.run.progress import LiveLine
from benchbench.run.settings import Settings
from benchbench.run.sources import Live, Stored
from benchbench.run.view import RunView
from benchbench.storage.best_known import BEST_KNOWN, REFERENCES, known
from benchbench.storage.files import PLAN, RECORD

if TYPE_CHECKING:
    import pandas as pd

OWN_PROCESS = ("hard_limit", "memory_limit_mb")
"""Limits that only the program can keep, which gives such a run a process of its own."""


def plan(*overrides: str) -> RunView:
    """Plan and certify what the same overrides do on the command line; nothing is written.

    bb.plan("+scenario=circle", "solver=ipopt"). Own YAML: "hydra.searchpath=[file:///absolute/folder]".
    Raises what the program shows: BadInput, IncompatibleCase, Unavailable, NoPlan.
    """
    cfg, chosen = config.composed(*overrides)
    return _run(config.build(cfg, chosen), cfg, campaign(cfg, chosen))


def certify(
    plan: pd.DataFrame | Plan | Path | str,
    *overrides: str,
    name: str = "foreign",
    interpolation: Interpolation = "hold",
) -> RunView:
    """Judge a plan that anybody made as `benchbench certify` does; nothing is written.

    bb.certify(frame, "+scenario=race", "scenario.gates=3")

    plan           a frame like that of `run.plan.to_frame()`, a plan, or the path of a CSV file (docs/foreign_plans.md),
                   a plan.mcap or a run's folder
    name           who made it, the solver of the record
    interpolation  of the inputs in a CSV file with the columns of docs/export.md, "hold" or "linear"; the others
                   say it themselves

    Raises BadInput for a plan that cannot be read, or not be one of this vehicle, and for what `plan` refuses.
    """
    asked = [*overrides, "strategy=foreign", f"strategy.planner={quoted(name)}"]
    if isinstance(plan, (str, Path)):
        file = _existing(Path(plan))
        asked += [f"strategy.file={quoted(str(file))}", f"strategy.interpolation={interpolation}"]
    cfg, chosen = config.composed(*asked)
    case = config.build(cfg, chosen)
    if isinstance(plan, (str, Path)):
        return _run(case, cfg, campaign(cfg, chosen))
    if not isinstance(case, Case):
        raise BadInput("scenario", f"'{case.names['scenario']}' is no flight", "a flight")
    return _run(replace(case, strategy=Given(_plan(plan, case), name)), cfg, campaign(cfg, chosen))


def load(folder: Path | str) -> RunView:
    """Return a stored run: a folder with a record.json, or such a file itself, of any version.

    Its other parts are read when they are asked for; what is not there, or cannot be used here, is told then.
    Raises BadInput where there is no record.
    """
    from benchbench.storage.table import load_record

    path = Path(folder)
    path = path / RECORD if path.is_dir() else path
    if not path.is_file():
        raise BadInput(str(folder), f"has no {RECORD}", "the folder of a run")
    try:
        record = load_record(path)
    except (OSError, ValueError, TypeError) as error:
        raise BadInput(
            str(path), f"is no record that can be read: {error}", f"the {RECORD} of a run"
        ) from None
    stored = Stored(path.parent.absolute(), record)
    return RunView(record, stored.text, stored)


def runs(*folders: Path | str) -> pd.DataFrame:
    """Return the table of all runs below some folders ("results" without any), a run per row, the oldest first.

    Columns are those of docs/table.md with pandas' nullable integers and booleans, and `folder`, which `load` takes;
    it is empty where only the row is left. A file that cannot be used is left out with a warning.
    Raises BadInput for a folder that does not exist.
    """
    from benchbench.storage.collect import collect
    from benchbench.storage.table import frame

    found = collect([Path(folder) for folder in folders or ("results",)])
    for path, problem in found.problems.items():
        warnings.warn(f"left out {path}: {problem}", stacklevel=2)
    places: list[Any] = [None if folder is None else str(folder) for folder in found.folders]
    return frame(found.rows).assign(folder=places)


def _run(case: Case | ReadyCase, cfg: DictConfig, flights: Campaign | None) -> RunView:
    for name in OWN_PROCESS:
        if cfg.get(name) is not None:
            raise BadInput(
                name, "can only be kept in a process of its own", "null, time_limit, or the program"
            )
    best = known(*(Path(place, BEST_KNOWN) for place in (str(cfg.output), REFERENCES)))
    labels = {"run_id": f"python_{datetime.now():%Y-%m-%d_%H-%M-%S-%f}", "config_hash": config_hash(cfg)}
    text, how = written(cfg), Settings.of(cfg)
    with LiveLine() as line:
        done = pipeline.run(case, line, labels, how.repeats, best, flights)
    return RunView(done.record, text, Live(done, text, how.draws(sweep=False)))


def _plan(given: pd.DataFrame | Plan, case: Case) -> Plan:
    import pandas as pd

    from benchbench.storage.frame import plan_of_frame
    from benchbench.storage.plan_file import of_model

    if isinstance(given, pd.DataFrame):
        return plan_of_frame(given, case.model)
    if isinstance(given, Plan):
        return of_model(given, case.model)
    raise BadInput(
        "plan", f"a {type(given).__name__} was given", "a DataFrame, a Plan, or the path of a file"
    )


def _existing(path: Path) -> Path:
    path = path / PLAN if path.is_dir() else path
    if not path.is_file():
        raise BadInput(str(path), "there is no such file", f"a CSV file with a plan, or a run's {PLAN}")
    return path.resolve()
