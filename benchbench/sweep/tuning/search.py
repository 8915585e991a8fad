"""The trials: ask Optuna, plan every problem in isolated workers, judge by certified plans only."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import optuna
from optuna.trial import FrozenTrial, Trial, TrialState

from benchbench.storage.status import Status
from benchbench.sweep.tuning.begun import at_work
from benchbench.sweep.tuning.outcome import good
from benchbench.sweep.tuning.space import SearchSpace
from benchbench.sweep.tuning.task import MORE, StudySettings, column_of

WORST = 1e9
"""Objective of a plan that is not certified; its constraint keeps the trial from being called good."""

CarryOut = Callable[[int, Sequence[Sequence[str]]], Sequence[Mapping[str, Any] | None]]
"""Carries out runs, each given by its overrides, for the trial of that number; gives their records."""


def search(
    task: StudySettings, study: optuna.Study, space: SearchSpace, plan: CarryOut, told: Callable[[str], None], folder: Path,
) -> None:  # fmt: skip
    """Do `task.n_trials` trials; folder: where it is noted which are at work."""
    for _ in range(task.n_trials):
        trial = study.ask(space.tuned)
        with at_work(trial, folder):
            _try(task, study, space, plan, told, trial)


def _try(
    task: StudySettings, study: optuna.Study, space: SearchSpace, plan: CarryOut, told: Callable[[str], None], trial: Trial,
) -> None:  # fmt: skip
    chosen = tuple(f"{field}={value}" for field, value in trial.params.items())
    runs = [(*space.fixed, *problem, *chosen) for problem in space.problems]
    batches = [[run] for run in runs] if task.prune else [runs]
    done: list[Mapping[str, Any] | None] = []
    for batch in batches:
        reporting = [_reporting(task, trial.number, done)] if task.prune == "steps" else []
        done += plan(trial.number, [[*run, *reporting] for run in batch])
        if _given_up(done):
            break
        if task.prune == "problems":
            trial.report(cost(done[-1], task.objectives[0]), len(done) - 1)
            if len(done) < len(runs) and (
                trial.should_prune() or (_bad(done, task.objectives) and good(study))
            ):
                break
    bad = _bad(done, task.objectives)
    _tell(task, study, trial, done, bad, len(runs))
    told(_line(study.trials[trial.number], task.objectives, len(done), bad, chosen))


def _tell(
    task: StudySettings,
    study: optuna.Study,
    trial: Trial,
    done: Sequence[Mapping[str, Any] | None],
    bad: int,
    runs: int,
) -> None:
    trial.set_constraint("uncertified", bad)
    trial.set_user_attr("uncertified", bad)
    if len(done) < runs or _given_up(done):
        study.tell(trial, state=TrialState.PRUNED)
        return
    study.tell(trial, [sum(cost(record, name) for record in done) for name in task.objectives])


def _reporting(task: StudySettings, trial: int, done: Sequence[Mapping[str, Any] | None]) -> str:
    """The override that makes a run report its solves to the trial, see benchbench.sweep.tuning.steps."""
    name = task.objectives[0]
    before = float(sum(cost(record, name) for record in done))
    texts = {"storage": task.storage, "study_name": task.study_name, "objective": name}
    told = [f"{key}:{_quoted(text)}" for key, text in texts.items()]
    told += [f"trial:{trial}", f"problem:{len(done)}", f"before:{before!r}"]
    return f"on_step={{_target_:benchbench.sweep.tuning.steps.TrialReport,{','.join(told)}}}"


def _quoted(text: str) -> str:
    """A text in the quotes of Hydra's overrides."""
    return "'" + text.replace("'", "\\'") + "'"


def _bad(done: Sequence[Mapping[str, Any] | None], names: Sequence[str]) -> int:
    """Plans that are not certified, or of which an objective is no number."""
    return sum(
        not (record and record["certified"] and all(record[column_of(name)] is not None for name in names))
        for record in done
    )


def _given_up(done: Sequence[Mapping[str, Any] | None]) -> bool:
    return any(record is not None and record["status"] == Status.PRUNED for record in done)


def cost(record: Mapping[str, Any] | None, name: str) -> float:
    """What an objective is of a run, to be minimised; `WORST` of one without a certified plan."""
    value = record[column_of(name)] if record and record["certified"] else None
    return WORST if value is None else -float(value) if name.startswith(MORE) else float(value)


def _line(trial: FrozenTrial, names: Sequence[str], done: int, bad: int, chosen: Sequence[str]) -> str:
    if trial.state == TrialState.PRUNED:
        verdict = f"pruned in problem {done}"
    elif bad:
        verdict = f"{bad} of {done} plans not certified"
    else:
        values = zip(names, trial.values, strict=True)
        verdict = ", ".join(f"{name} {value:.4f}" for name, value in values)
    return f"trial {trial.number}: {verdict}: {' '.join(chosen)}"
