"""What is limited in a race, over time: limits may grow along the flight."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from benchbench.certificate.replay import Replay
from benchbench.ground.arrays import Array
from benchbench.ocp.model import Model, input_bounds, output_bounds, output_box, velocity_bounds
from benchbench.ocp.plan import Plan, bezier
from benchbench.ocp.race import Race
from benchbench.report.panel import Band, Curve, Panel

ALIKE = 2.0
"""Rates share a panel where their largest limits differ by no more than this factor."""
INPUTS = {"N": "Motor forces", "N m": "Servo torque"}


def race_panels(race: Race, plan: Plan, model: Model, replay: Replay | None) -> list[Panel]:
    """Speed, inputs by unit, limited angular rates by size, height."""
    flown = plan if replay is None else replay
    speed, height = (
        Curve(name, (plan.time, of(plan)), (flown.time, of(flown)), low, np.inf)
        for name, of, low in (
            ("speed", _speed, -np.inf),
            ("z", _height, float(race.limits(model).lower[2])),
        )
    )
    return [
        Panel("Speed", "m/s", (speed,)),
        *_inputs(plan, race, model),
        *_rates(plan, race, model, flown),
        Panel("Height", "m", (height,)),
    ]


def _speed(state: Plan | Replay) -> Array:
    return np.asarray(np.linalg.norm(state.velocity[:, :3], axis=1))


def _height(state: Plan | Replay) -> Array:
    return state.configuration[:, 2]


def _inputs(plan: Plan, race: Race, model: Model) -> Iterator[Panel]:
    share = np.linspace(0.0, 1.0, 2 if plan.interpolation != "bezier" else 9)
    time = (plan.time[:-1, None] + np.diff(plan.time)[:, None] * share).ravel()
    values = bezier(plan.input_pieces[:, None], share).reshape(len(time), -1)
    limits = input_bounds(model, np.repeat(race.flown(model, len(plan.time))[:-1], len(share)))
    for unit in dict.fromkeys(plan.input_units):
        names = {
            i: n for i, (n, u) in enumerate(zip(plan.input_names, plan.input_units, strict=True)) if u == unit
        }
        curves = [_limited(name, None, (time, values), limits, i) for i, name in names.items()]
        yield Panel(INPUTS.get(unit, "Inputs"), unit, tuple(curves))


def _rates(plan: Plan, race: Race, model: Model, flown: Plan | Replay) -> Iterator[Panel]:
    """Angular rates of the state and those that are outputs of the model, such as body rates beside Euler angles."""
    names = (*model.velocity.names, *output_box(model).names)
    units = (*model.velocity.units, *output_box(model).units)
    planned, dense = (
        (one.time, np.hstack([one.velocity, model.plant().output(one.configuration, one.velocity)]))
        for one in (plan, flown)
    )
    metres = np.interp(flown.time, plan.time, race.flown(model, len(plan.time)))
    pairs = zip(velocity_bounds(model, metres), output_bounds(model, metres), strict=True)
    limits = tuple(np.hstack(pair) for pair in pairs)
    largest = np.max(limits[1], axis=0)
    turning = [i for i, unit in enumerate(units) if unit == "rad/s" and np.isfinite(largest[i])]
    for group in _alike(turning, largest):
        curves = [_limited(names[i], planned, dense, limits, i) for i in group]
        title = "Angular rates" if len(group) > 1 else f"Angular rate of {names[group[0]]}"
        yield Panel(title, "rad/s", tuple(curves))


def _alike(columns: Sequence[int], largest: Array) -> list[list[int]]:
    groups: list[list[int]] = []
    for i in columns:
        fits = (g for g in groups if 1 / ALIKE <= largest[i] / largest[g[0]] <= ALIKE)
        found = next(fits, None)
        if found is None:
            groups.append([i])
        else:
            found.append(i)
    return groups


def _limited(
    name: str, dots: tuple[Array, Array] | None, line: tuple[Array, Array], limits: Sequence[Array], i: int
) -> Curve:
    """A column with its limits, of which those that change are drawn as they run."""
    time, values = line
    low, high = (limit[:, i] for limit in limits)
    still = np.ptp(low) == 0 and np.ptp(high) == 0
    return Curve(
        name,
        None if dots is None else (dots[0], dots[1][:, i]),
        (time, values[:, i]),
        float(low.min()),
        float(high.max()),
        None if still else Band(time, low, high),
    )
