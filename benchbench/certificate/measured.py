"""The evidence about a plan whose limits are the same all along the flight."""

from __future__ import annotations

import numpy as np

from benchbench.certificate.evidence import Evidence, Given
from benchbench.certificate.limited import Limited
from benchbench.certificate.replay import fly
from benchbench.ocp.model import output_box
from benchbench.ocp.scenario import Scenario


def measured(scenario: Scenario, given: Given) -> Evidence:
    """Fly the plan and put what has limits beside them; a kind of scenario adds what it has of its own."""
    plan, model = given.plan, given.model
    plant = model.plant()
    missed, flight = fly(plan, plant, restart_seconds=given.limits.restarts(plan.travel_time))
    room, outputs = scenario.limits(model), output_box(model)
    with np.errstate(invalid="ignore"):
        planned, dense = (plant.output(one.configuration, one.velocity) for one in (plan, flight))
    rate = np.array([unit.endswith("/s") for unit in outputs.units], bool)
    return Evidence(
        **vars(given), scenario=scenario, plant=plant, missed=missed, flight=flight,
        planned={
            "configuration": Limited.of(room, plan.configuration),
            "velocity": Limited.of(model.velocity, plan.velocity),
            "input": Limited.of(model.inputs, plan.inputs),
            "output": Limited.of(outputs, planned),
        },
        room=Limited.of(room, flight.configuration).beside(Limited.of(outputs, dense)),
        rates=Limited.of(model.velocity, flight.velocity).beside(Limited.of(outputs, np.where(rate, dense, 0.0))),
    )  # fmt: skip
