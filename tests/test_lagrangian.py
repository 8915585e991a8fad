"""A model that gives accelerations and no Lagrangian: refused by variational dynamics, planned for by the others."""

from __future__ import annotations

from dataclasses import replace

import pytest
from flights import Bare

from benchbench.ground.errors import IncompatibleCase
from benchbench.planning.case import Case
from benchbench.run import config, pipeline


def case(dynamics: str) -> tuple[Case, Case]:
    """The same small case with the whole model and with the bare one."""
    whole = config.compose(
        "+scenario=static",
        f"dynamics={dynamics}",
        "scenario.intervals=15",
        "strategy=phases",
        "strategy.margin=0",
        "compile=never",
    )
    return whole, replace(whole, model=Bare(whole.model))


@pytest.mark.parametrize("dynamics", ["verlet", "midpoint"])
def test_variational_dynamics_refuse_it_and_name_the_alternatives(dynamics: str) -> None:
    with pytest.raises(IncompatibleCase, match=f"'{dynamics}' needs a Lagrangian.*collocation.*rk4"):
        pipeline.run(case(dynamics)[1])


@pytest.mark.slow
def test_the_others_find_the_same_plan() -> None:
    times = [pipeline.run(one).record["travel_time_s"] for one in case("collocation")]
    assert times[0] == pytest.approx(times[1], abs=1e-4)
