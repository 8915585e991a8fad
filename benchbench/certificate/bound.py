"""Lower bounds on the travel time: that of a kind of scenario, and that from speed limits and reach alone, without any dynamics.

They hold for plans that keep these limits exactly. The certificate forgives a little (`rate_ratio`, `end_position`); the
bounds of `window_bound`, which prune windows, grant that too.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import singledispatch
from typing import Any

import numpy as np

from benchbench.certificate.handover_bound import handover_bound, level_bound
from benchbench.certificate.race_bound import race_bound
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.race import Race
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.to_rest import ToRest


@singledispatch
def lower_bound(scenario: Scenario, model: Model, plant: Plant) -> float:
    """Return a time in s that no plan within its limits can beat; of a kind that proves no more the least time allowed."""
    return scenario.travel_time[0]


lower_bound.register(Race, race_bound)


@lower_bound.register
def _(scenario: ToRest, model: Model, plant: Plant) -> float:
    """Return the least of all sequences; `inf` when no allowed travel time reaches every stop asked for."""
    return handover_bound(scenario, model, plant).seconds


@singledispatch
def bounded(scenario: Scenario, model: Model, plant: Plant) -> Mapping[str, Any]:
    """Return the columns of the record that say what bounds the travel time from below."""
    return {"lower_bound_s": lower_bound(scenario, model, plant)}


@bounded.register
def _(scenario: ToRest, model: Model, plant: Plant) -> Mapping[str, Any]:
    """Also the demand that the bound comes from, and what holds for flights that stay level."""
    proved = handover_bound(scenario, model, plant)
    level = level_bound(scenario, model, plant, proved)
    return {
        "lower_bound_s": proved.seconds,
        "limited_by": proved.demand,
        "level_bound_s": level.seconds if level and np.isfinite(level.seconds) else None,
    }
