"""The evidence of a flight: what has limits, at the nodes and on the replay, with those that are no coordinates."""

from __future__ import annotations

import math

import numpy as np
import pytest
from flights import TABLE_I
from test_certificate import LIMITS
from test_race_certificate import RISE, TURN, climb, race, vehicle

from benchbench.certificate.evidence import Given
from benchbench.certificate.measured import measured
from benchbench.ocp.plan import Plan
from benchbench_plugins.models.aerial_manipulator import AerialManipulator


def test_what_has_limits_on_a_climb_that_turns() -> None:
    """Its body rates are outputs; the room is that of the scenario, which says something of z."""
    model, plan = vehicle(attitude="euler"), climb("euler")
    given = Given(
        plan, model, LIMITS.model_copy(update={"restart_seconds": 1.0, "restart_beyond": 3.9}), None
    )
    task = race(workspace={"z": (0.5, 16.0)})
    found = measured(task, given)
    assert (
        found.scenario is task
        and found.plan is plan
        and found.limits is given.limits
        and found.residuals is None
    )
    assert found.flight.restarts == (5, 10, 15)
    np.testing.assert_allclose(np.hstack([found.missed.configuration, found.missed.velocity]), 0, atol=1e-8)
    names = {kind: of.names for kind, of in found.planned.items()}
    assert names == {
        "configuration": model.configuration.names, "velocity": model.velocity.names, "input": model.inputs.names,
        "output": ("wx", "wy", "wz"),
    }  # fmt: skip
    planned = found.planned
    for kind, values in (
        ("configuration", plan.configuration),
        ("velocity", plan.velocity),
        ("input", plan.inputs),
    ):
        np.testing.assert_array_equal(planned[kind].values, values)
    np.testing.assert_allclose(planned["output"].values, np.outer(TURN * plan.time, [0, 0, 1]), atol=1e-12)
    assert planned["configuration"].upper[2] == 16.0 and planned["input"].upper.tolist() == [6.8794] * 4
    assert planned["output"].upper.tolist() == [15.0, 15.0, 0.3]
    t = found.flight.time
    assert found.room.names == (*model.configuration.names, "wx", "wy", "wz")
    np.testing.assert_allclose(found.room.values[:, 2], 1 + RISE * t**2 / 2, atol=1e-8)
    np.testing.assert_allclose(found.room.excess[:, 2], np.maximum(RISE * t**2 / 2 - 15.0, 0), atol=1e-8)
    np.testing.assert_allclose(found.room.values[:, -1], TURN * t, atol=1e-8)
    assert found.rates.names == (*model.velocity.names, "wx", "wy", "wz")
    np.testing.assert_allclose(found.rates.values[:, 2], RISE * t, atol=1e-8)
    np.testing.assert_allclose(found.rates.ratio[:, -1], TURN * t / 0.3, atol=1e-7)


def test_outputs_that_are_angles_are_no_rates() -> None:
    """An arm vehicle in quaternions, banked by 0.1 rad: roll has room, but is nothing that is used as a rate."""
    model, bank = AerialManipulator("arm", attitude="quaternion", **TABLE_I), 0.1  # type: ignore[arg-type]
    q = np.tile([0, 0, 0.5, math.cos(bank / 2), math.sin(bank / 2), 0, 0, math.pi / 2], (3, 1))
    plan = Plan.of(
        model, time=np.array([0.0, 0.01, 0.02]), configuration=q, velocity=np.zeros((3, 7)),
        inputs=np.tile(model.hover(), (2, 1)), progress=np.zeros(3), interpolation="hold",
    )  # fmt: skip
    found = measured(race(), Given(plan, model, LIMITS, None))
    assert found.flight.restarts == ()  # it does not last longer than flights that are flown as one
    assert found.planned["output"].values[:, 0] == pytest.approx([bank] * 3)
    roll = found.room.names.index("roll")
    assert found.room.values[:, roll] == pytest.approx(bank, abs=0.01) and found.room.units[roll] == "rad"
    assert found.rates.names[-5:] == ("roll", "pitch", "roll_rate", "pitch_rate", "yaw_rate")
    assert not found.rates.values[:, -5:-3].any() and np.abs(found.rates.values[1:, -3:]).max() > 0
