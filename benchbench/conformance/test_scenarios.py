"""One scenario of every kind against `checks.scenarios`."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import hydra
import pytest

from benchbench.conformance.checks.scenarios import CHECKS
from benchbench.ocp.kinds import kind_of, kinds
from benchbench.ocp.scenario import Scenario
from benchbench.planning.case import Case
from benchbench.run import config


@cache
def flights() -> dict[type[Scenario], str]:
    """The first scenario of every kind that can be chosen."""
    with hydra.initialize_config_dir(config.folder(), version_base="1.3"):
        chosen = {name: hydra.compose("config", [f"+scenario={name}"]) for name in config.choices("scenario")}
    found = {n: kind_of(cfg.scenario) for n, cfg in chosen.items() if "_target_" not in cfg.scenario}
    return {kind: name for name, kind in reversed(found.items())}


@pytest.fixture(scope="module", params=sorted(kinds()))
def case(request: pytest.FixtureRequest) -> Case:
    """The first scenario of a kind, with the vehicle that it asks for."""
    return config.compose(f"+scenario={flights()[kinds()[request.param]]}", "compile=never")


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_scenario(check: Callable[[Case], None], case: Case) -> None:
    """One check of one scenario."""
    check(case)


def test_every_kind_has_a_scenario() -> None:
    """A kind that nothing chooses would never be tested."""
    assert set(kinds().values()) <= set(flights())
