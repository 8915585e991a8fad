"""What a report plots of a plan over time, by kind of scenario."""

from __future__ import annotations

from functools import singledispatch

from benchbench.certificate.replay import Replay
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.report.limits_panel import contact_panels, limit_panels
from benchbench.report.panel import Panel
from benchbench.report.race_panels import race_panels


@singledispatch
def conditions(scenario: Scenario, plan: Plan, model: Model, replay: Replay | None) -> list[Panel]:
    """What the kind of scenario asks for beside limits: the gaps of contacts, unless it says otherwise."""
    return contact_panels(plan, scenario, model, replay)


@singledispatch
def panels(scenario: Scenario, plan: Plan, model: Model, replay: Replay | None) -> list[Panel]:
    """Conditions, then everything that has a limit, unless the kind of scenario says otherwise."""
    return [*conditions(scenario, plan, model, replay), *limit_panels(plan, scenario, model, replay)]


panels.register(Race, race_panels)
