"""A study that goes on: it has to be the one that was begun, and trials that died with their process are over."""

from __future__ import annotations

import platform
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import optuna
from optuna.distributions import BaseDistribution, CategoricalDistribution, check_distribution_compatibility
from optuna.trial import Trial, TrialState

from benchbench.ground.errors import BadInput
from benchbench.run.settings import NOT_DECISIVE
from benchbench.storage.locks import Locks
from benchbench.sweep.tuning.space import SearchSpace

HOST, PROBLEMS, FIXED = "host", "problems", "fixed"
"""Attributes of trials and studies."""
ELSE = "the same, or another hydra.sweeper.study_name"


def check_same(study: optuna.Study, space: SearchSpace) -> None:
    """Raise BadInput where fields, choices, problems or fixed overrides are not those of the trials there are."""
    for trial in study.trials:
        _check_fields(study.study_name, trial.distributions, space.tuned)
    wanted = {
        PROBLEMS: sorted([*problem] for problem in space.problems),
        FIXED: sorted(text for text in space.fixed if _decides(text)),
    }
    for name, now in wanted.items():
        before: Any = study.user_attrs.get(name)
        if before is None:
            study.set_user_attr(name, now)
        elif before != now:
            texts = [text for one in before for text in ([one] if isinstance(one, str) else one)]
            problem = f"'{study.study_name}' was begun with other {name}: {', '.join(texts) or 'none'}"
            raise BadInput("hydra.sweeper.study_name", problem, ELSE)


@contextmanager
def at_work(trial: Trial, folder: Path) -> Iterator[None]:
    """Hold a trial: it fails where this process leaves it unfinished, and others can tell that it is not dead."""
    locks = Locks(folder)
    locks.take(_name(trial.number))
    trial.set_user_attr(HOST, platform.node())
    try:
        yield
    except BaseException:
        trial.study.tell(trial, state=TrialState.FAIL, skip_if_finished=True)
        raise
    finally:
        locks.close()


def bury(study: optuna.Study, folder: Path) -> int:
    """Fail the running trials whose process on this machine is dead; returns how many."""
    dead = 0
    for trial in study.get_trials(states=(TrialState.RUNNING,)):
        locks = Locks(folder)
        if trial.user_attrs.get(HOST) == platform.node() and locks.take(_name(trial.number)):
            study.tell(trial.number, state=TrialState.FAIL, skip_if_finished=True)
            dead += 1
        locks.close()
    return dead


def _check_fields(name: str, before: dict[str, BaseDistribution], now: dict[str, BaseDistribution]) -> None:
    if before and before.keys() != now.keys():
        problem = f"study '{name}' tunes {', '.join(before)}, and now {', '.join(now)} are asked for"
        raise BadInput("hydra.sweeper.study_name", problem, ELSE)
    for field, old in before.items():
        try:
            check_distribution_compatibility(old, now[field])
        except ValueError:
            problem = f"study '{name}' was begun with {_said(old)}, and now {_said(now[field])} are asked for"
            raise BadInput(field, problem, ELSE) from None


def _said(distribution: BaseDistribution) -> str:
    if isinstance(distribution, CategoricalDistribution):
        return f"the choices {', '.join(map(str, distribution.choices))}"
    low, high = getattr(distribution, "low", None), getattr(distribution, "high", None)
    return f"numbers from {low} to {high}{' by logarithm' if getattr(distribution, 'log', False) else ''}"


def _decides(text: str) -> bool:
    key = text.lstrip("+~").partition("=")[0]
    return key not in NOT_DECISIVE and not key.startswith("hydra")


def _name(number: int) -> str:
    return f"{number + 1:x}0"
