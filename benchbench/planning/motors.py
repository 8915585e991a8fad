"""In which order a plan from elsewhere numbers the motors: put into ours, and recognised where it is another one.

Where a vehicle's own motors stand is measured on its plant; docs/foreign_plans.md has a picture.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import is_dataclass, replace
from itertools import permutations
from typing import Any

import numpy as np

from benchbench.certificate.limits import Limits
from benchbench.certificate.replay import defects
from benchbench.ground.arrays import Array
from benchbench.ground.errors import BadInput
from benchbench.ocp.model import Model, Plant, space
from benchbench.ocp.plan import Plan

Order = tuple[int, ...]
"""For each of our motors the number that the plan gives it."""
OURS: Order = (1, 2, 3, 4)
PLACES = {
    "cpc": ("front left", "front right", "back right", "back left"),
    "agilicious": ("front right", "back left", "back right", "front left"),
    "px4": ("front right", "back left", "front left", "back right"),
}
"""Where motors 1 to 4 of a convention stand; TOGT-Planner has that of Agilicious where its vehicle has armLength and beta."""
MOTORS = ("motor_1", "motor_2", "motor_3", "motor_4")
STEPS = 3
"""Intervals at the beginning that are flown to tell orders apart."""
CLEARLY = 0.2
"""Share of the error of the plan as it is that another order must stay below to be named."""


def order_of(given: str | Order, model: Model) -> Order:
    """Return an order that is given by the name of a convention or its numbers; raises BadInput("strategy.motors", ...)."""
    if given == "ours":
        return OURS
    allowed = f"ours, {', '.join(PLACES)}, or each of the numbers 1 to 4 once, such as [4,1,3,2]"
    if isinstance(given, str):
        if given not in PLACES:
            raise BadInput("strategy.motors", f"'{given}' was given", allowed)
        return conventions(model)[given]
    if sorted(given) != list(OURS):
        raise BadInput("strategy.motors", f"{list(given)} was given", allowed)
    return tuple(given)


def conventions(model: Model) -> dict[str, Order]:
    """Orders by the name of their convention; none for a vehicle whose motors are no square of four."""
    ours = places(model)
    if set(ours) != set(PLACES["cpc"]):
        return {}
    return {name: tuple(theirs.index(place) + 1 for place in ours) for name, theirs in PLACES.items()}


def places(model: Model) -> tuple[str, ...]:
    """Where motors 1 to 4 of a vehicle stand, told by how a level one turns where each of them pushes."""
    if any(name not in model.inputs.names for name in MOTORS):
        return ()
    names, plant = model.velocity.names, model.plant()
    q, still, hover = space(model).origin(), np.zeros(len(names)), model.hover()
    found = []
    for name in MOTORS:
        more = hover.copy()
        more[model.inputs.index(name)] += 0.1
        turn = dict(
            zip(names, plant.acceleration(q, still, more) - plant.acceleration(q, still, hover), strict=True)
        )
        roll, pitch = (
            turn[w] if w in turn else turn.get(angle, 0.0) for w, angle in (("wx", "roll"), ("wy", "pitch"))
        )
        found.append(f"{'front' if pitch < 0 else 'back'} {'left' if roll > 0 else 'right'}")
    return tuple(found)


def reordered(plan: Plan, order: Order) -> Plan:
    """Return the plan with our motors' thrusts where ours stand."""
    if order == OURS or any(name not in plan.input_names for name in MOTORS):
        return plan
    inputs, at = plan.inputs.copy(), [plan.input_names.index(name) for name in MOTORS]
    inputs[:, at] = plan.inputs[:, [at[number - 1] for number in order]]
    return replace(plan, inputs=inputs)


def hint(plan: Plan, model: Model, limits: Limits, order: Order) -> str:
    """Say which order of motors, and which lever, the first intervals of a plan fit; "" where they fit as they are.

    plan: in our order, read as `order` says.
    """
    if any(name not in plan.input_names for name in MOTORS) or plan.intervals < 1:
        return ""
    first, plant = _beginning(plan), model.plant()
    now = _error(first, plant)
    if not np.isfinite(now) or now <= limits.defect_rate:
        return ""
    errors = {other: _error(reordered(first, other), plant) for other in permutations(OURS)}
    known = conventions(model)
    read = {other: tuple(order[number - 1] for number in other) for other in errors}
    best = min(errors, key=lambda other: (round(errors[other] / now, 2), read[other] not in known.values()))
    said = [_named(read[best], known)] if best != OURS else []
    error, turned = errors[best], reordered(first, best)
    if (lever := _lever(turned, model)) is not None:
        fitting = _error(turned, replace(model, lever=lever).plant())  # type: ignore[type-var]
        if fitting < error / 2:
            error, said = fitting, [*said, f"vehicle.lever={lever:.4g}"]
    if not said or error > CLEARLY * now:
        return ""
    return (
        f"the first intervals turn as these thrusts would with {' and '.join(said)}: say so if that is meant"
    )


def _named(order: Order, known: Mapping[str, Order]) -> str:
    name = next((name for name, one in known.items() if one == order), "")
    return f"--motors {','.join(map(str, order))}" + (f" (as {name})" if name else "")


def _beginning(plan: Plan) -> Plan:
    """The first intervals as a plan."""
    count = min(STEPS, plan.intervals)
    rows = {"hold": count, "linear": count + 1}.get(
        plan.interpolation, count * (len(plan.inputs) // plan.intervals)
    )
    return replace(
        plan, time=plan.time[: count + 1], configuration=plan.configuration[: count + 1], velocity=plan.velocity[: count + 1],
        inputs=plan.inputs[:rows], progress=plan.progress[: count + 1],
    )  # fmt: skip


def _turning(plan: Plan) -> list[int]:
    return [i for i, unit in enumerate(plan.velocity_units) if unit == "rad/s"]


def _error(plan: Plan, plant: Plant) -> float:
    """Largest error of the body's rates at the end of an interval, rad/s; infinite where it cannot be flown."""
    missed = defects(plan, plant).velocity[:, _turning(plan)]
    return float(np.max(np.abs(missed))) if missed.size and np.all(np.isfinite(missed)) else np.inf


def _lever(plan: Plan, model: Any) -> float | None:
    """The lever with which roll and pitch rates change as much as planned; None where nothing can be said."""
    if not is_dataclass(model) or not hasattr(model, "lever"):
        return None
    columns, plant = _turning(plan)[:2], model.plant()  # type: ignore[union-attr]
    planned: Array = np.diff(plan.velocity[:, columns], axis=0)
    flown: Array = np.add(planned, defects(plan, plant).velocity[:, columns])
    power = float(np.sum(flown**2))
    lever = float(model.lever * np.sum(flown * planned) / power) if np.isfinite(power) and power > 0 else 0.0
    return lever if lever > 0 else None
