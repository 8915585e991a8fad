"""Refuses a case that cannot work before anything is built, naming the field and what is allowed."""

from __future__ import annotations

import numpy as np

from benchbench.case import Case
from benchbench.certificate.bound import arm_reach, lower_bound
from benchbench.errors import BadInput
from benchbench.motion import sample
from benchbench.plan import Array


def validate(case: Case) -> None:
    """Raise BadInput for the first thing that cannot be."""
    scenario, model = case.scenario, case.model
    if scenario.kappa_init >= scenario.intervals:
        raise BadInput(
            "scenario.kappa_init",
            f"{scenario.kappa_init} nodes in contact do not fit into {scenario.intervals} intervals",
            f"1 to {scenario.intervals - 1}",
        )
    seconds = scenario.contact_seconds
    if seconds is not None and seconds >= scenario.travel_time[1]:
        raise BadInput(
            "scenario.contact_seconds",
            f"{seconds} s is longer than the flight",
            f"below {scenario.travel_time[1]}",
        )
    _pose("start", scenario.start_point(model), case)
    _pose("end", scenario.end_point(model), case)
    _reachable(case)


def _pose(which: str, q: Array, case: Case) -> None:
    limits = case.scenario.limits(case.model)
    for name, unit, value, low, high in zip(
        limits.names, limits.units, q, limits.lower, limits.upper, strict=True
    ):
        if not low <= value <= high:
            raise BadInput(
                f"scenario.{which}.{name}",
                f"{value:g} {unit} is outside its limits",
                f"{low:g} to {high:g} {unit}",
            )


def _reachable(case: Case) -> None:
    scenario, model = case.scenario, case.model
    plant = model.plant()
    latest = scenario.travel_time[1]
    target, _ = sample(scenario.target, np.linspace(0.0, latest, 301))
    if not np.all(np.isfinite(target)):
        raise BadInput(
            "scenario.target", "gives positions that are not finite numbers", "finite positions in m"
        )
    limits = scenario.limits(model)
    reach = arm_reach(model, plant) + max(
        (c.limit for c in scenario.contacts.values() if c.unit == "m"), default=0.0
    )
    for axis in ("x", "y", "z"):
        i = limits.index(axis)
        low, high = limits.lower[i] - reach, limits.upper[i] + reach
        column = target[:, "xyz".index(axis)]
        if not np.any((column >= low) & (column <= high)):
            raise BadInput(
                "scenario.target",
                f"is out of reach: its {axis} runs from {column.min():g} to {column.max():g} m",
                f"{axis} between {low:g} and {high:g} m at some time",
            )
    bound = lower_bound(scenario, model, plant)
    if not bound <= latest:
        raise BadInput(
            "scenario.travel_time", f"{latest:g} s are too short: target and end are {bound:.3g} s away at full speed",
            f"an upper limit of at least {bound:.3g} s",
        )  # fmt: skip
