"""What a study is asked, checked: objectives, sampler, number of trials, where it is kept."""

from __future__ import annotations

import random
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from benchbench.errors import BadInput
from benchbench.storage.schema import COLUMNS

if TYPE_CHECKING:
    import optuna
    from optuna.storages import JournalStorage

SAMPLERS = ("tpe", "nsga2", "random")
JOURNAL = "journal:"
TRIES = 8
"""How often to try to open a database that answers with an error."""


@dataclass(frozen=True)
class Task:
    """Settings of a study.

    objectives  numeric columns of the record, each summed over the problems and minimised
    storage     a database URL as SQLAlchemy takes it, or journal:FILE
    prune       stop a trial between problems when it is surely worse than the best (one objective only)
    """

    study_name: str
    storage: str
    n_trials: int
    objectives: tuple[str, ...]
    sampler: str
    seed: int | None
    prune: bool

    @classmethod
    def of(
        cls, study_name: str, storage: str, n_trials: int, objectives: Sequence[str], sampler: str, seed: int | None,
        prune: bool,
    ) -> Task:  # fmt: skip
        """Check them; raises BadInput."""
        numbers = [column.name for column in COLUMNS if column.type in ("int", "float")]
        for name in objectives:
            if name not in numbers:
                raise BadInput(
                    "hydra.sweeper.objectives", f"'{name}' is no number of a record", ", ".join(numbers)
                )
        if not objectives:
            raise BadInput("hydra.sweeper.objectives", "none was given", "[travel_time_s, solve_cpu_s]")
        if sampler not in SAMPLERS:
            raise BadInput("hydra.sweeper.sampler", f"{sampler!r} was given", ", ".join(SAMPLERS))
        if not isinstance(n_trials, int) or isinstance(n_trials, bool) or n_trials < 1:
            raise BadInput(
                "hydra.sweeper.n_trials", f"{n_trials!r} was given", "a whole number of at least 1"
            )
        if prune and len(objectives) > 1:
            raise BadInput(
                "hydra.sweeper.prune", "there are several objectives", "one objective, or prune=false"
            )
        return cls(study_name, storage, n_trials, tuple(objectives), sampler, seed, bool(prune))

    def open(self) -> optuna.Study:
        """Create the study or go on with it. Raises BadInput for a storage that does not answer or does not fit."""
        import optuna
        from optuna.storages import JournalStorage
        from optuna.storages.journal import JournalFileBackend

        optuna.logging.set_verbosity(optuna.logging.WARNING)
        try:
            storage: str | JournalStorage = self.storage
            if self.storage.startswith(JOURNAL):
                path = Path(self.storage.removeprefix(JOURNAL))
                path.parent.mkdir(parents=True, exist_ok=True)
                storage = JournalStorage(JournalFileBackend(str(path)))
            elif self.storage.startswith("sqlite:///"):
                Path(self.storage.removeprefix("sqlite:///")).parent.mkdir(parents=True, exist_ok=True)
            study = self._create(storage)
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
                    pruner=optuna.pruners.WilcoxonPruner(p_threshold=0.1) if self.prune else optuna.pruners.NopPruner(),
                )  # fmt: skip
            except (IntegrityError, OperationalError):
                if not left:
                    raise
                time.sleep(random.uniform(0.2, 1.0))
        raise AssertionError("unreachable")
