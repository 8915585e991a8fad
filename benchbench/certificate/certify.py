"""From a plan to its certificate: what the backend claims plays no part."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchbench.certificate import checks, race, stops
from benchbench.certificate.audit import Audit, audit
from benchbench.certificate.certificate import Certificate, Check, Measures
from benchbench.certificate.limits import Limits, ProblemLimits
from benchbench.certificate.replay import Defects, Replay, defects, replay
from benchbench.mpcc.residuals import Residuals
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario


def certify(
    plan: Plan, scenario: Scenario, model: Model, limits: Limits, residuals: Residuals | None = None
) -> Certificate:
    """Judge a plan by its own numbers, the task and the vehicle's independent plant.

    residuals: of the original MPCC, where the plan came from one; without them that question is not asked.
    Raises ValueError when the plan is for another vehicle.
    """
    if plan.coordinate_names != model.configuration.names or plan.input_names != model.inputs.names:
        raise ValueError(f"the plan moves {plan.coordinate_names}, the model {model.configuration.names}")
    found = [*checks.soundness(plan)]
    sound = all(check.ok for check in found)
    if residuals is not None:
        found += checks.original_problem(residuals, limits)
    if not sound:
        return Certificate(tuple(found), Measures(**_problem(residuals)), None)
    plant = model.plant()
    missed = defects(plan, plant)
    if isinstance(scenario, Race):
        return _certify_race(plan, scenario, model, limits, residuals, missed, found)
    flight = replay(plan, plant, restart_seconds=limits.restart_seconds)
    itinerary = scenario.itinerary
    contacts = audit(plan, flight, itinerary, plant, limits)
    asked = stops.asked(contacts, itinerary)
    found += checks.planned(plan, scenario, model, limits)
    found += checks.consistency(plan, missed, limits)
    for contact in contacts:
        found += checks.contact_planned(plan, contact, contact in asked, limits)
    found += stops.made(plan, asked, itinerary)
    if flight.broken_at is None:
        found += checks.flown(plan, flight, scenario, model, limits)
        for contact in contacts:
            found += checks.contact_flown(flight, contact, limits)
    else:
        found.append(_breakdown(flight.broken_at))
    measures = _measures(plan, missed, flight, contacts, scenario, model)
    return Certificate(tuple(found), Measures(**_problem(residuals), **measures), flight)


def certify_problem(residuals: Residuals, limits: ProblemLimits) -> Certificate:
    """Judge a solution of an MPCC that is no flight: its residuals are all there is to ask."""
    return Certificate(
        tuple(checks.original_problem(residuals, limits)), Measures(**_problem(residuals)), None
    )


def _certify_race(
    plan: Plan, scenario: Race, model: Model, limits: Limits, residuals: Residuals | None, missed: Defects,
    found: list[Check],
) -> Certificate:  # fmt: skip
    """Go on with what races ask; the replay starts again at every gate."""
    scenario = race.as_passed(plan, scenario, limits.gate_position)
    restarts = race.gate_nodes(plan, scenario, limits)
    flight = replay(plan, model.plant(), restart_seconds=limits.restart_seconds, restart_nodes=restarts)
    found += race.planned(plan, scenario, model, limits)
    found += checks.consistency(plan, missed, limits)
    found += (
        race.flown(plan, flight, scenario, model, limits)
        if flight.broken_at is None
        else [_breakdown(flight.broken_at)]
    )
    drift = flight.configuration[flight.nodes] - plan.configuration
    passed, miss = race.worst_miss(flight, scenario, limits)
    numbers: dict[str, Any] = {
        "replay_defect_position_m": np.max(checks.distance(plan, missed.configuration)),
        "replay_defect_angle_rad": np.max(checks.angle(plan, missed.configuration)),
        "replay_drift_position_m": np.max(checks.distance(plan, drift)),
        "replay_end_error_m": checks.distance(plan, drift)[-1],
        "max_rate_ratio": np.max(race.rate_ratio(plan, flight, scenario, model)),
        "gate_worst_miss_m": miss,
    }
    numbers = {key: float(value) for key, value in numbers.items()}
    gates = len(scenario.goals) - 1
    numbers |= {"gates": gates, "gates_passed": min(passed, gates)}
    return Certificate(tuple(found), Measures(**_problem(residuals), **numbers), flight)


def _breakdown(at: float) -> Check:
    reason = f"the replay diverges or cannot be integrated any further at t={at:.3f} s"
    return Check("replay_complete", at, np.inf, "s", False, reason)


def _problem(residuals: Residuals | None) -> dict[str, Any]:
    if residuals is None:
        return {}
    return {
        "max_violation": residuals.max_violation,
        "max_complementarity": residuals.max_complementarity,
        "max_product": residuals.max_product,
    }


def _measures(
    plan: Plan, missed: Defects, flight: Replay, contacts: Sequence[Audit], scenario: Scenario, model: Model
) -> dict[str, Any]:
    drift = flight.configuration[flight.nodes] - plan.configuration
    end = flight.configuration[-1:] - scenario.end_point(model)
    numbers: dict[str, Any] = {
        "replay_defect_position_m": np.max(checks.distance(plan, missed.configuration)),
        "replay_defect_angle_rad": np.max(checks.angle(plan, missed.configuration)),
        "replay_drift_position_m": np.max(checks.distance(plan, drift)),
        "replay_end_error_m": checks.distance(plan, end)[0],
        "max_rate_ratio": np.max(
            checks.rate_ratio(checks.all_rates(flight, model), checks.joined(model.velocity, model.outputs))
        ),
    }
    numbers = {key: float(value) for key, value in numbers.items()}
    return numbers | stops.measures(plan, contacts, scenario.itinerary)
