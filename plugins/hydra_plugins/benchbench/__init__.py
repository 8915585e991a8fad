"""Hydra's way to our plugins and into our sweeps; it takes both only from the namespace package `hydra_plugins`."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
from hydra.core.config_store import ConfigStore
from hydra.core.override_parser.types import Override
from hydra.core.plugins import Plugins
from hydra.core.utils import JobReturn, JobStatus, configure_log, setup_globals
from hydra.plugins.launcher import Launcher
from hydra.plugins.sweeper import Sweeper
from hydra.types import HydraContext, TaskFunction
from omegaconf import DictConfig, open_dict

from benchbench.run.plugin_choices import PluginSource  # noqa: F401

ConfigStore.instance().store(
    group="hydra/launcher",
    name="isolated",
    node={"_target_": "hydra_plugins.benchbench.IsolatedLauncher"},
    provider="benchbench",
)
ConfigStore.instance().store(
    group="hydra/launcher",
    name="dask",
    node={"_target_": "hydra_plugins.benchbench.DaskLauncher", "scheduler": None, "patience": 600.0},
    provider="benchbench",
)
ConfigStore.instance().store(
    group="hydra/sweeper",
    name="combinations",
    node={"_target_": "hydra_plugins.benchbench.ChoiceSweeper", "max_batch_size": None, "params": None},
    provider="benchbench",
)
ConfigStore.instance().store(
    group="hydra/sweeper",
    name="front",
    node={
        "_target_": "hydra_plugins.benchbench.FrontSweeper", "max_batch_size": None, "params": None,
        "field": "scenario.contacts.approach.slope", "rounds": 8, "target": 0.95,
    },
    provider="benchbench",
)  # fmt: skip
ConfigStore.instance().store(
    group="hydra/sweeper",
    name="optuna",
    node={
        "_target_": "hydra_plugins.benchbench.OptunaSweeper",
        "study_name": "tune", "storage": None, "n_trials": 20, "objectives": ["travel_time_s", "solve_cpu_s"],
        "sampler": "tpe", "seed": 0, "prune": False, "over": ["scenario", "seed"],
    },
    provider="benchbench",
)  # fmt: skip


class IsolatedLauncher(Launcher):
    """Composes every combination and hands them to the `sweep` of the task function."""

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Keep what Hydra gives."""
        self._context, self._config, self._task = hydra_context, config, task_function

    def engine(self) -> Any:
        """Return who carries out the runs: worker processes on this machine."""
        from benchbench.sweep.pool import run_all

        return run_all

    def launch(self, job_overrides: Sequence[Sequence[str]], initial_job_idx: int) -> list[JobReturn]:
        """Run one job for each list of overrides. Raises TypeError for a task function that cannot sweep."""
        from benchbench.sweep.combination import Combination

        sweep: Any = getattr(self._task, "sweep", None)
        if sweep is None:
            raise TypeError("hydra/launcher=isolated is for benchbench only; use hydra/launcher=basic")
        setup_globals()
        configure_log(self._config.hydra.hydra_logging, self._config.hydra.verbose)
        Path(str(self._config.hydra.sweep.dir)).mkdir(parents=True, exist_ok=True)
        here = os.getcwd()
        combinations = [
            Combination(number + 1, overrides, self._compose, here)
            for number, overrides in enumerate(job_overrides, initial_job_idx)
        ]
        codes = sweep(combinations, self._context.config_loader.get_search_path(), self.engine())
        return [
            JobReturn(overrides=list(overrides), status=JobStatus.COMPLETED, _return_value=code)
            for overrides, code in zip(job_overrides, codes, strict=True)
        ]

    def _compose(self, number: int, overrides: Sequence[str]) -> DictConfig:
        from benchbench.run.overrides import implied
        from benchbench.run.random_task import drawn

        loader = self._context.config_loader
        composed = loader.load_sweep_config(self._config, list(overrides))
        if more := implied(overrides, composed):
            composed = loader.load_sweep_config(self._config, [*overrides, *more])
        with open_dict(composed):
            composed.hydra.job.id = composed.hydra.job.num = number
        return drawn(composed)


class ChoiceSweeper(BasicSweeper):
    """All combinations of choices and values; before the first run it composes one, and each with a wrong choice.

    Hydra's own composes them all beforehand, which takes 0.1 s for each.
    """

    @staticmethod
    def split_arguments(overrides: list[Override], max_batch_size: int | None) -> list[list[list[str]]]:
        """List the combinations, no more than anybody waits for. Raises BadInput."""
        from benchbench.ground.errors import BadInput
        from benchbench.run.sweep_size import check_size

        check_size(overrides)
        if max_batch_size is not None and not max_batch_size > 0:
            problem = f"{max_batch_size!r} was given"
            raise BadInput("hydra.sweeper.max_batch_size", problem, "null, or a whole number of at least 1")
        listed: list[list[list[str]]] = BasicSweeper.split_arguments(overrides, max_batch_size)
        return listed

    def validate_batch_is_legal(self, batch: Sequence[Sequence[str]]) -> None:
        """Raise what Hydra does for a combination that cannot be composed."""
        super().validate_batch_is_legal([*batch[:1], *self._doubtful(batch)])

    def _doubtful(self, batch: Sequence[Sequence[str]]) -> Iterator[Sequence[str]]:
        """For each choice that is not there, the first combination that makes it."""
        context: Any = self.hydra_context
        loader = context.config_loader
        options = cache(lambda group: loader.get_group_options(group) or None)
        seen: set[str] = set()
        for overrides in batch:
            for text in overrides:
                if text not in seen:
                    seen.add(text)
                    key, _, value = text.lstrip("+").partition("=")
                    there = options(key.partition("@")[0])
                    if there is not None and value not in there:
                        yield overrides


class FrontSweeper(ChoiceSweeper):
    """All combinations, then rounds of those that fill the front of travel time against success in flight."""

    def __init__(self, field: str, rounds: int, target: float, **more: Any) -> None:
        """Take the field whose values are refined, in how many rounds at most, and the success rate to be proved."""
        super().__init__(**more)
        self._field, self._rounds, self._target = field, rounds, target

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Keep what Hydra gives. Raises BadInput."""
        from benchbench.ground.errors import BadInput

        if type(self._rounds) is not int or self._rounds < 1:
            problem = f"{self._rounds!r} was given"
            raise BadInput("hydra.sweeper.rounds", problem, "a whole number of at least 1")
        super().setup(hydra_context=hydra_context, task_function=task_function, config=config)
        self._swept: Any = task_function

    def is_done(self) -> bool:
        """Whether neither a combination nor a round is left."""
        if super().is_done():
            self.overrides = [*(self.overrides or []), *self._next(len(self.overrides or []))]
        return super().is_done()

    def _next(self, rounds: int) -> list[list[list[str]]]:
        """The round that follows so many: what is worth a flight; at last the best plan in worlds that it was not chosen by."""
        from benchbench.analysis.front import paired
        from benchbench.analysis.refining import finer, unseen
        from benchbench.sweep.rows import candidates

        found, tried = paired(candidates(self._swept.swept)), {one.overrides for one in self._swept.swept}
        between = [list(one) for one in finer(found, self._field, self._target) if one not in tried]
        between = between if rounds < self._rounds else []
        again = [list(one) for one in unseen(found, self._target) if one not in tried]
        if between:
            print(f"round {rounds + 1}: plans between those that were flown, and gentler ones", flush=True)
        elif again:
            print(
                f"round {rounds + 1}: the fastest that proves it, in worlds that it was not chosen by",
                flush=True,
            )
        return [batch for batch in (between or again,) if batch]


class DaskLauncher(IsolatedLauncher):
    """Sends every combination to the workers of a Dask scheduler, which isolate it as a local sweep does."""

    def __init__(self, scheduler: str | None = None, patience: float = 600.0) -> None:
        """Take the address of the scheduler and for how many seconds to wait for its first worker."""
        self._scheduler, self._patience = scheduler, patience

    def engine(self) -> Any:
        """Return who carries out the runs: the cluster. Raises BadInput."""
        from benchbench.sweep.cluster import Cluster

        return Cluster.of(self._scheduler, self._patience)


class OptunaSweeper(Sweeper):
    """Tunes swept fields with Optuna; swept fields named in `over` are the problems that every trial plans."""

    def __init__(self, over: Sequence[str], storage: str | None, **task: Any) -> None:
        """Take what hydra.sweeper says, see `benchbench.sweep.tuning.task`."""
        self._over, self._storage, self._asked = tuple(over), storage, task

    def setup(self, *, hydra_context: HydraContext, task_function: TaskFunction, config: DictConfig) -> None:
        """Keep what Hydra gives."""
        self._config, self._task = config, task_function
        self._launcher = Plugins.instance().instantiate_launcher(
            hydra_context=hydra_context, task_function=task_function, config=config
        )

    def sweep(self, arguments: list[str]) -> None:
        """Run the study. Raises BadInput."""
        try:
            import optuna  # noqa: F401
        except ImportError:
            from benchbench.ground.errors import BadInput

            raise BadInput(
                "hydra/sweeper", "optuna is not installed", "pip install 'benchbench[tune]'"
            ) from None
        from benchbench.sweep.tuning import run

        folder = Path(str(self._config.output), "tune", str(self._asked["study_name"])).absolute()
        storage = self._storage or f"sqlite:///{folder / 'study.db'}"
        code = run.run(arguments, self._over, self._asked | {"storage": storage}, folder, self._plan)
        self._task.codes[:] = [code]  # type: ignore[attr-defined]

    def _plan(self, folder: Path, runs: Sequence[Sequence[str]], first: int) -> None:
        ours = ("rerun=all", f"hydra.sweep.dir='{folder}'")
        self._launcher.launch([[*run, *ours] for run in runs], first)
