"""What a study is asked, checked: objectives, sampler, number of trials, where it is kept."""

from __future__ import annotations

import random
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from benchbench.ground.errors import BadInput
from benchbench.storage.schema import COLUMNS

if TYPE_CHECKING:
    import optuna
    from optuna.storages import JournalStorage

SAMPLERS = ("tpe", "nsga2", "random")
PRUNE = ("problems", "steps")
TRIALS = 1_000_000
TRIES = 8
"""How often to try to open a database that answers with an error."""


MORE = "-"
"""Before an objective of which more is better."""
MORE_IS_BETTER = ("flights_succeeded", "flights_low_exact", "flights_low", "flights_high", "real_time_factor", "gates_passed")  # fmt: skip
"""Columns that nobody wants to be small."""


def column_of(objective: str) -> str:
    """Return the column of the record that an objective is about."""
    return objective.removeprefix(MORE)


@dataclass(frozen=True)
class StudySettings:
    """Settings of a study.

    objectives  numeric columns of the record, each summed over the problems and minimised; with a minus in front maximised
    storage     a database URL as SQLAlchemy takes it, or journal:FILE
    prune       "problems": stop a trial between problems when it is surely worse than the best, or has a plan that
                is not certified while another trial has none; "steps": stop a run between its solves when the
                trial has cost more than the best; "": never. One objective only
    """

    study_name: str
    storage: str
    n_trials: int
    objectives: tuple[str, ...]
    sampler: str
    seed: int | None
    prune: str

    @classmethod
    def of(
        cls, study_name: str, storage: str, n_trials: int, objectives: Sequence[str], sampler: str, seed: int | None,
        prune: bool | str | None,
    ) -> StudySettings:  # fmt: skip
        """Check them; raises BadInput."""
        numbers = [column.name for column in COLUMNS if column.type in ("int", "float")]
        for name in objectives:
            if column_of(name) not in numbers:
                raise BadInput(
                    "hydra.sweeper.objectives", f"'{name}' is no number of a record", ", ".join(numbers)
                )
            if name in MORE_IS_BETTER:
                problem = f"'{name}' is better the larger it is, and objectives are minimised"
                raise BadInput("hydra.sweeper.objectives", problem, f"{MORE}{name}")
        if not objectives:
            raise BadInput("hydra.sweeper.objectives", "none was given", "[travel_time_s, solve_cpu_s]")
        if sampler not in SAMPLERS:
            raise BadInput("hydra.sweeper.sampler", f"{sampler!r} was given", ", ".join(SAMPLERS))
        if not isinstance(n_trials, int) or isinstance(n_trials, bool) or not 1 <= n_trials <= TRIALS:
            wanted = f"a whole number from 1 to {TRIALS}"
            raise BadInput("hydra.sweeper.n_trials", f"{n_trials!r} was given", wanted)
        if seed is not None and (
            isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**32
        ):
            raise BadInput(
                "hydra.sweeper.seed", f"{seed!r} was given", "null, or a whole number from 0 to 2^32 - 1"
            )
        kind = PRUNE[0] if prune is True else prune or ""
        _check_prune(kind, objectives)
        return cls(study_name, storage, n_trials, tuple(objectives), sampler, seed, kind)

    def open(self) -> optuna.Study:
        """Create the study or go on with it. Raises BadInput for a storage that does not answer or does not fit."""
        import optuna

        from benchbench.sweep.tuning.storage import opened

        optuna.logging.set_verbosity(optuna.logging.WARNING)
        try:
            study = self._create(opened(self.storage))
        except Exception as error:  # noqa: BLE001  # each storage has its own
            problem = (
                f"'{self.storage}' cannot be used: {str(error).splitlines()[0] if str(error) else error!r}"
            )
            raise BadInput(
                "hydra.sweeper.storage", problem, "sqlite:///FILE, journal:FILE or a database URL"
            ) from None
        told = study.user_attrs.get("objectives")
        if told is None:
            study.set_user_attr("objectives", list(self.objectives))
        elif tuple(told) != self.objectives:
            problem = f"study '{self.study_name}' minimises {', '.join(told)}"
            raise BadInput(
                "hydra.sweeper.objectives", problem, "the same, or another hydra.sweeper.study_name"
            )
        return study

    def _create(self, storage: str | JournalStorage) -> optuna.Study:
        """Create or load; processes that start together may meet while the first one makes the tables."""
        import optuna
        from sqlalchemy.exc import IntegrityError, OperationalError

        samplers = {
            "tpe": optuna.samplers.TPESampler, "nsga2": optuna.samplers.NSGAIISampler,
            "random": optuna.samplers.RandomSampler,
        }  # fmt: skip
        for left in reversed(range(TRIES)):
            try:
                return optuna.create_study(
                    study_name=self.study_name, storage=storage, load_if_exists=True,
                    sampler=samplers[self.sampler](seed=self.seed), directions=["minimize"] * len(self.objectives),
                    pruner=self._pruner(),
                )  # fmt: skip
            except (IntegrityError, OperationalError):
                if not left:
                    raise
                time.sleep(random.uniform(0.2, 1.0))
        raise AssertionError("unreachable")

    def _pruner(self) -> optuna.pruners.BasePruner:
        """Judges between problems; between solves the run itself asks, see benchbench.sweep.tuning.steps."""
        import optuna

        if self.prune == "problems":
            return optuna.pruners.WilcoxonPruner(p_threshold=0.1)
        return optuna.pruners.NopPruner()


def _check_prune(kind: str, objectives: Sequence[str]) -> None:
    if kind not in ("", *PRUNE):
        raise BadInput("hydra.sweeper.prune", f"{kind!r} was given", "false, " + ", ".join(PRUNE))
    if kind and len(objectives) > 1:
        raise BadInput("hydra.sweeper.prune", "there are several objectives", "one objective, or prune=false")
    if kind == "steps":
        from benchbench.sweep.tuning.steps import REPORTED

        if objectives[0] not in REPORTED:
            problem = f"{objectives[0]} is not known between two solves"
            raise BadInput(
                "hydra.sweeper.prune", problem, f"objectives of {', '.join(REPORTED)}, or prune=problems"
            )
