"""What a race is asked: start, limits along the flight, dynamics, every gate in order, ground, end."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchbench.certificate.certificate import Measures
from benchbench.certificate.checks.gates import gates, race_end, segments
from benchbench.certificate.checks.intervals import (
    defect_angle,
    defect_position,
    defect_rate,
    defect_velocity,
)
from benchbench.certificate.checks.nodes import planned_limits, planned_quaternion, planned_start
from benchbench.certificate.checks.replay import replay_position, replay_rate
from benchbench.certificate.difference import distance
from benchbench.certificate.evidence import Given
from benchbench.certificate.examination import Examination, examine
from benchbench.certificate.limited import Limited
from benchbench.certificate.numbers import flown
from benchbench.certificate.passing import GateEvidence, as_passed, gate_nodes
from benchbench.certificate.replay import fly
from benchbench.ground.arrays import Index
from benchbench.ocp.gates import passes
from benchbench.ocp.model import input_bounds, output_bounds, output_box, velocity_bounds
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race

PLANNED = (
    planned_start,
    planned_quaternion,
    planned_limits,
    defect_position,
    defect_angle,
    defect_velocity,
    defect_rate,
)
FLOWN = (gates, segments, replay_position, replay_rate, race_end)


@examine.register
def _race(scenario: Race, given: Given) -> Examination[GateEvidence]:
    evidence = _evidence(scenario, given)
    return Examination(evidence, PLANNED, FLOWN, Measures(**flown(evidence), **_numbers(evidence)))


def _evidence(scenario: Race, given: Given) -> GateEvidence:
    """The replay starts again at every gate; limits run linearly from node to node."""
    plan, model, limits = given.plan, given.model, given.limits
    race, plant, nodes = as_passed(plan, scenario, limits.gate_position), model.plant(), len(plan.time)
    restarts = gate_nodes(plan, race, limits)
    missed, flight = fly(plan, plant, restart_seconds=limits.restart_seconds, restart_nodes=restarts)
    metres, room, outputs = race.flown(model, nodes), race.limits(model), output_box(model)
    along = np.interp(np.interp(flight.time, plan.time, np.arange(nodes)), np.arange(nodes), metres)
    with np.errstate(invalid="ignore"):
        planned, dense = (plant.output(one.configuration, one.velocity) for one in (plan, flight))
    return GateEvidence(
        **vars(given), scenario=race, plant=plant, missed=missed, flight=flight,
        planned={
            "configuration": Limited.of(room, plan.configuration),
            "velocity": Limited.of(model.velocity, plan.velocity, velocity_bounds(model, metres)),
            "input": Limited.of(model.inputs, plan.inputs, input_bounds(model, metres[_input_nodes(plan)])),
            "output": Limited.of(outputs, planned, output_bounds(model, metres)),
        },
        room=Limited.of(room, flight.configuration),
        rates=Limited.of(model.velocity, flight.velocity, velocity_bounds(model, along)).beside(
            Limited.of(outputs, dense, output_bounds(model, along))
        ),
        passes=passes(flight.time, flight.configuration[:, :3], race.goals, limits.gate_position),
    )  # fmt: skip


def _input_nodes(plan: Plan) -> Index:
    """Node whose limits hold for each row of a plan's inputs."""
    if plan.interpolation == "linear":
        return np.arange(len(plan.time))
    return np.arange(len(plan.inputs)) // (len(plan.inputs) // plan.intervals)


def _numbers(evidence: GateEvidence) -> dict[str, Any]:
    """Numbers of the record: gates passed, the end included, the largest distance beyond one, the end."""
    count = len(evidence.scenario.goals) - 1
    return {
        "replay_end_error_m": float(distance(evidence.plan, evidence.drift)[-1]),
        "gate_worst_miss_m": float(np.max([one.beyond for one in evidence.passes])),
        "gates": count,
        "gates_passed": min(sum(one.inside for one in evidence.passes), count),
    }
