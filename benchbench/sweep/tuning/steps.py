"""Pruning between solves: a run tells its trial what it has cost so far, and ends when that is too much."""

from __future__ import annotations

from typing import final

import optuna
from optuna.pruners import BasePruner
from optuna.trial import FrozenTrial

from benchbench.ground.errors import Pruned
from benchbench.nlp.ledger import Milestone
from benchbench.sweep.tuning.outcome import good
from benchbench.sweep.tuning.storage import opened

REPORTED = ("travel_time_s", "solve_cpu_s", "iterations")
"""Objectives that are known between two solves."""
STEPS_PER_PROBLEM = 1000
"""Step numbers of a trial that each of its problems has."""


@final
class Bound(BasePruner):
    """Prunes a trial whose last report is above the objective of the best good one.

    Reports are sums over the problems so far, so for costs that only grow no better trial is lost. Optuna's
    MedianPruner judges a trial by its smallest report, which is always the first of a sum.
    """

    def prune(self, study: optuna.Study, trial: FrozenTrial) -> bool:
        """Return whether to give it up."""
        best = min((t.values[0] for t in good(study)), default=None)
        last = trial.last_step
        return best is not None and last is not None and trial.intermediate_values[last] > best


@final
class TrialReport:
    """Reports the solves of a run to its trial of a study.

    trial      number of the trial
    objective  one of REPORTED
    problem    how many problems of the trial are done; `before` is the objective summed over them
    """

    def __init__(
        self, storage: str, study_name: str, trial: int, objective: str, problem: int, before: float
    ) -> None:
        """Keep them; the storage is opened at the first report."""
        self._where, self._number, self._objective = (storage, study_name), trial, objective
        self._step, self._before = problem * STEPS_PER_PROBLEM, before
        self._trial: optuna.Trial | None = None

    def __call__(self, step: Milestone) -> None:
        """Report one step. Raises Pruned."""
        value: float | None = getattr(step, self._objective)
        if step.guess or value is None:
            return
        trial = self._opened()
        trial.report(self._before + value, self._step)
        self._step += 1
        if trial.should_prune():
            told = f"{self._objective} was {self._before + value:.6g} at sigma = {step.sigma:g}"
            raise Pruned(f"trial {self._number} was given up: {told}, more than the best trial needs in all")

    def _opened(self) -> optuna.Trial:
        if self._trial is None:
            storage, name = self._where
            study = optuna.load_study(study_name=name, storage=opened(storage), pruner=Bound())
            (found,) = (t for t in study.get_trials(deepcopy=False) if t.number == self._number)
            self._trial = optuna.Trial(study, found._trial_id)
        return self._trial
