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
def panels(scenario: Scenario, plan: Plan, model: Model, replay: Replay | None) -> list[Panel]:
    """Conditions of contacts, then everything that has a limit, unless the kind of scenario says otherwise."""
    return [
        *contact_panels(plan, scenario, model, replay),
        *limit_panels(plan, scenario, model, replay),
    ]


panels.register(Race, race_panels)
