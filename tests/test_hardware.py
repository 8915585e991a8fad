"""The paper's hardware experiments: Table II as printed, Table I where that says nothing, contact in seconds."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from benchbench.ocp.motion import sample
from benchbench.planning.validate import validate
from benchbench.run import config

PRINTED = {
    "quadrotor_inertia": (0.0158, 0.0154, 0.0195),
    "arm_inertia": (0.0001, 0.0016, 0.00016),
    "arm_offset": 0.107,
    "speed": (0.3, 0.3, 0.15),
    "angular_rate": (0.2, 0.2, 0.1),
    "arm_rate": math.pi / 5,
}
"""Table II."""
SCENARIOS = {"hardware_static": 13, "hardware_circle": 3, "hardware_circle_23": 23}
"""kappa_init, Sec. V."""


def numbers(vehicle: str) -> dict[str, Any]:
    return dict(config.composed("+scenario=static", f"vehicle={vehicle}")[0].vehicle)


def test_the_vehicle_is_table_two_and_else_table_one() -> None:
    one, two = numbers("table1"), numbers("table2")
    for name, printed in PRINTED.items():
        assert two[name] == pytest.approx(printed), name
    assert {k for k in one if one[k] != two[k]} == {*PRINTED, "name"}


@pytest.mark.parametrize("name", SCENARIOS)
def test_contact_is_asked_in_seconds_that_do_not_depend_on_the_grid(name: str) -> None:
    case = config.compose(f"+scenario={name}")
    validate(case)
    assert case.scenario.kappa_init == SCENARIOS[name]
    assert case.scenario.contact_seconds == pytest.approx((SCENARIOS[name] - 1) * 0.05)
    assert (
        config.compose(f"+scenario={name}", "scenario.intervals=400").scenario.contact_seconds
        == case.scenario.contact_seconds
    )
    assert case.names["vehicle"] == "table2" and case.scenario.contacts["heading"].limit == 0.01


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_target_can_be_reached_and_followed(name: str) -> None:
    """Below the arm's tip at the start, slower than the vehicle, and turning slower than it yaws."""
    case = config.compose(f"+scenario={name}")
    times = np.linspace(0, 20, 201)
    place, velocity = sample(case.scenario.target, times)
    assert np.all(place[:, 2] < 0.65 - 0.107 - 0.182)
    assert np.linalg.norm(velocity, axis=1).max() < 0.3
    if name != "hardware_static":
        turned = np.unwrap(np.arctan2(velocity[:, 1], velocity[:, 0]))
        assert np.abs(np.gradient(turned, times)).max() < 0.1
