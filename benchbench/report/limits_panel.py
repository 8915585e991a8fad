"""Which quantities are plotted over time: everything that is limited, grouped by unit and size."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from benchbench.certificate.replay import Replay
from benchbench.ground.arrays import Array
from benchbench.ocp.model import Coordinates, Model
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan, bezier
from benchbench.ocp.scenario import Scenario
from benchbench.ocp.stop import Stop
from benchbench.report.contact_window import stop_windows
from benchbench.report.panel import Curve, Panel, Points

QUANTITIES = {
    "m": "Position",
    "rad": "Angle",
    "m/s": "Velocity",
    "rad/s": "Angular rate",
    "N": "Force",
    "N m": "Torque",
}


def contact_panels(plan: Plan, scenario: Scenario, model: Model, replay: Replay | None) -> list[Panel]:
    """One panel per contact condition: its physical gap to each stop's target, and its limit."""
    stops = scenario.itinerary.stops
    panels = []
    for name, contact in {name: c for stop in stops for name, c in stop.contacts.items()}.items():
        asked = [stop for stop in stops if name in stop.contacts]
        curves = tuple(_gap_curve(stop, name, plan, model, replay) for stop in asked)
        note = _worst_in_contact(plan, asked[0], curves[0].line)
        panels.append(Panel(contact.noun.capitalize(), contact.unit, curves, _seen(curves), note))
    return panels


def _seen(curves: Sequence[Curve]) -> bool:
    """Whether anything is seen on a logarithmic axis, which begins at a twentieth of the limit."""
    return any(np.nanmax(curve.line[1], initial=0.0) > curve.upper / 20 for curve in curves)


def _gap_curve(stop: Stop, name: str, plan: Plan, model: Model, replay: Replay | None) -> Curve:
    contact, plant = stop.contacts[name], model.plant()

    def gap(times: Array, q: Array, v: Array) -> Points:
        return times, contact.gap(plant, q, v, *sample(stop.target, times))

    dots = gap(plan.time, plan.configuration, plan.velocity)
    line = dots if replay is None else gap(replay.time, replay.configuration, replay.velocity)
    return Curve(stop.name if stop.prefix else name, dots, line, -np.inf, contact.limit)


def _worst_in_contact(plan: Plan, stop: Stop, gap: Points) -> str:
    times, values = gap
    windows = [(a, b) for i, a, b in stop_windows(plan) if plan.stop_names[i] == stop.name]
    inside = [values[(times >= plan.time[a]) & (times <= plan.time[b])] for a, b in windows]
    return f"in contact {np.max(np.concatenate(inside), initial=0.0):.3g}" if windows else "no contact"


def limit_panels(plan: Plan, scenario: Scenario, model: Model, replay: Replay | None) -> list[Panel]:
    """Panels of velocities, coordinates and inputs that have a limit."""
    flown_v = None if replay is None else (replay.time, replay.velocity)
    flown_q = None if replay is None else (replay.time, replay.configuration)
    rates = _state_curves(plan.time, plan.velocity, model.velocity, flown_v)
    states = _state_curves(plan.time, plan.configuration, scenario.limits(model), flown_q)
    inputs = _input_curves(plan, model.inputs)
    return [panel for curves in (rates, states, inputs) for panel in _panels(list(curves))]


def _state_curves(
    time: Array, values: Array, limits: Coordinates, dense: tuple[Array, Array] | None
) -> Iterator[tuple[str, Curve]]:
    for i, (name, unit) in enumerate(zip(limits.names, limits.units, strict=True)):
        dots = (time, values[:, i])
        line = dots if dense is None else (dense[0], dense[1][:, i])
        yield unit, Curve(name, dots, line, float(limits.lower[i]), float(limits.upper[i]))


def _input_curves(plan: Plan, limits: Coordinates) -> Iterator[tuple[str, Curve]]:
    share = np.linspace(0.0, 1.0, 2 if plan.interpolation != "bezier" else 9)
    time = (plan.time[:-1, None] + np.diff(plan.time)[:, None] * share).ravel()
    values = bezier(plan.input_pieces[:, None], share).reshape(len(time), -1)
    for i, (name, unit) in enumerate(zip(limits.names, limits.units, strict=True)):
        yield unit, Curve(name, None, (time, values[:, i]), float(limits.lower[i]), float(limits.upper[i]))


def _panels(curves: list[tuple[str, Curve]]) -> list[Panel]:
    """Group limited curves of one unit whose limits are of similar size."""
    groups: list[tuple[str, list[Curve]]] = []
    for unit, curve in curves:
        if not (np.isfinite(curve.lower) or np.isfinite(curve.upper)):
            continue
        fitting = (group for other, group in groups if other == unit and _similar(group[0], curve))
        found = next(fitting, None)
        if found is None:
            groups.append((unit, [curve]))
        else:
            found.append(curve)
    return [Panel(_title(unit, group), unit, tuple(group)) for unit, group in groups]


def _similar(a: Curve, b: Curve) -> bool:
    """Whether two ranges can share an axis: widths within a factor 2, middles within half a width."""
    width_a, width_b = a.upper - a.lower, b.upper - b.lower
    if not np.isfinite(width_a + width_b):
        return False
    apart = abs((a.upper + a.lower) - (b.upper + b.lower)) / 2
    return max(width_a, width_b) <= 2 * min(width_a, width_b) and apart <= min(width_a, width_b) / 2


def _title(unit: str, curves: list[Curve]) -> str:
    quantity = QUANTITIES.get(unit, "Value")
    return f"{quantity} of {curves[0].label}" if len(curves) == 1 else quantity
