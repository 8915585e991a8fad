"""From a plan to its certificate: evidence once, then every question in turn. What a backend claims plays no part."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from benchbench.certificate import handover, race, transfer  # noqa: F401  # they register what they ask
from benchbench.certificate.certificate import Certificate, Measures
from benchbench.certificate.check import Check
from benchbench.certificate.checks.problem import original_problem
from benchbench.certificate.checks.replay import breakdown
from benchbench.certificate.checks.soundness import finite, increasing
from benchbench.certificate.checks.standing import standing_flown, standing_planned
from benchbench.certificate.evidence import Given
from benchbench.certificate.examination import examine
from benchbench.certificate.further import further
from benchbench.certificate.limits import Limits, ProblemLimits
from benchbench.certificate.terms import objective, spent
from benchbench.mpcc.residuals import Residuals
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
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
    sound = [*finite(plan), *increasing(plan)]
    solved = [] if residuals is None else [*original_problem(residuals, limits)]
    if not all(check.ok for check in sound):
        return Certificate((*sound, *solved), Measures(**_problem(residuals)), None)
    asked = examine(scenario, Given(plan, model, limits, residuals))
    found = [check for ask in (*asked.planned, standing_planned) for check in ask(asked.evidence)]
    found += (
        [check for ask in (*asked.flown, standing_flown, objective, further) for check in ask(asked.evidence)]
        if asked.evidence.flight.broken_at is None
        else [breakdown(asked.evidence)]
    )
    measures = replace(asked.measures, **_problem(residuals), costs=spent(asked.evidence) or None)
    return Certificate((*sound, *solved, *found), measures, asked.evidence.flight, asked.evidence.missed)


def certify_problem(residuals: Residuals, limits: ProblemLimits) -> Certificate:
    """Judge a solution of an MPCC that is no flight: its residuals are all there is to ask."""
    checks: tuple[Check, ...] = tuple(original_problem(residuals, limits))
    return Certificate(checks, Measures(**_problem(residuals)), None)


def _problem(residuals: Residuals | None) -> dict[str, Any]:
    names = ("max_violation", "max_complementarity", "max_product")
    return {} if residuals is None else {name: getattr(residuals, name) for name in names}
