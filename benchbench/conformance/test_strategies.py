"""Every installed strategy against `checks.strategies`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pytest

from benchbench.conformance.candidates import Configured, candidates
from benchbench.conformance.checks.strategies import CHECKS, Tried
from benchbench.ground.errors import BadInput, Unavailable
from benchbench.planning.case import Case
from benchbench.run import config

STRATEGIES = pytest.mark.parametrize("candidate", candidates("strategies"), ids=lambda c: c.name)
SMALL = {"coarsest": 8, "finest": 16, "finer": 2, "starts": 2}
"""Settings that say how often a strategy solves; the checks need no more than these."""


@pytest.fixture(scope="module")
def case() -> Case:
    """A target at rest on a coarse grid, from the plain guess."""
    return config.compose(
        "+scenario=static", "solver=ipopt", "guess=line", "scenario.intervals=20", "compile=never",
        "iteration_limit=500", "time_limit=600",
    )  # fmt: skip


@pytest.fixture(scope="module")
def tried() -> dict[str, Tried]:
    """What has been solved so far, by the name of the strategy."""
    return {}


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@STRATEGIES
def test_strategy(
    candidate: Configured, check: Callable[[Tried], None], case: Case, tried: dict[str, Tried]
) -> None:
    """One check of one strategy; one that refuses this case (made for races, reads a file) is skipped."""
    if candidate.name not in tried:
        tried[candidate.name] = Tried(candidate.build(**_few(candidate.settings)), case)
    try:
        check(tried[candidate.name])
    except (BadInput, Unavailable) as reason:
        pytest.skip(str(reason))


def _few(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings that are to be small, also those of a strategy within the strategy."""
    inner = {name: {**value, **_few(value)} for name, value in settings.items() if isinstance(value, dict)}
    return inner | {name: few for name, few in SMALL.items() if name in settings}
