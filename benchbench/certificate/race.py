"""The rules for races: every gate in order on the dense replay, limits between nodes, ground, end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchbench.certificate.certificate import Check, at_most, worst
from benchbench.certificate.limits import Limits
from benchbench.certificate.replay import Replay
from benchbench.model import Model
from benchbench.plan import Array, Plan
from benchbench.race.scenario import Race
from benchbench.race.track import Gate

Checks = Iterator[Check]
UNIT_LENGTH = 1e-6
"""Largest error of the length of a planned quaternion."""


@dataclass(frozen=True)
class Pass:
    """How one gate was passed: nearest `distance` (m) to its centre at `time` (s), in order or not at all.

    `inside`: within radius and allowance, after the gate before.
    """

    time: float
    distance: float
    inside: bool


def passes(time: Array, position: Array, gates: tuple[Gate, ...], allowance: float) -> tuple[Pass, ...]:
    """Follow a path (m,) s, (m, 3) m, straight between its points, through the gates in order.

    A gate counts from the moment the one before was entered. Of each gate the nearest point of the first stay inside is
    told; of one that is never entered, and of all after it, the nearest point from there on.
    """
    found: list[Pass] = []
    first, share = 0, 0.0
    for gate in gates:
        distance, at = _nearest(position[first:], gate, share)
        inside = distance <= gate.radius + allowance
        if not inside.any() or (found and not found[-1].inside):
            k = int(np.nanargmin(distance)) if np.isfinite(distance).any() else 0
            found.append(Pass(_time(time, first + k, at[k]), float(distance[k]), False))
            continue
        entered = int(np.argmax(inside))
        left = entered + int(np.argmin(np.append(inside[entered:], False)))
        k = entered + int(np.argmin(distance[entered:left]))
        found.append(Pass(_time(time, first + k, at[k]), float(distance[k]), True))
        first, share = (
            first + entered,
            _entry(position[first + entered :], gate, allowance, share if entered == 0 else 0),
        )
    return tuple(found)


def gate_nodes(plan: Plan, race: Race, limits: Limits) -> tuple[int, ...]:
    """Nodes nearest to the gates' planned passes, the end left out: where the replay starts again."""
    found = passes(plan.time, plan.configuration[:, :3], race.goals, limits.gate_position)
    nodes = {int(np.argmin(np.abs(plan.time - one.time))) for one in found[:-1] if one.inside}
    return tuple(sorted(k for k in nodes if 0 < k < plan.intervals))


def planned(plan: Plan, race: Race, model: Model, limits: Limits) -> Checks:
    """Check start, end and limits at the nodes, to numeric accuracy."""
    names, units = plan.coordinate_names, plan.coordinate_units
    gap, (i,) = worst(np.abs(plan.configuration[0] - race.start_point(model)))
    yield at_most(
        "planned_start", f"distance of planned '{names[i]}' from the start", gap, limits.node, units[i]
    )
    speed, (i,) = worst(np.abs(plan.velocity[0] - race.start_rates(model)))
    what = f"planned rate of '{plan.velocity_names[i]}' at the start"
    yield at_most("planned_start_rest", what, speed, limits.node, plan.velocity_units[i])
    if "qw" in names:
        length = np.linalg.norm(
            plan.configuration[:, [names.index(k) for k in ("qw", "qx", "qy", "qz")]], axis=1
        )
        error, (k,) = worst(np.abs(length - 1))
        yield at_most(
            "planned_quaternion", "error of a quaternion's length", error, UNIT_LENGTH, "1", f" at node {k}"
        )
    nodes = len(plan.time)
    flown = race.flown(model, nodes)
    rows = _input_nodes(plan)
    box = race.limits(model)
    for kind, values, low, high, of in (
        ("configuration", plan.configuration, box.lower, box.upper, model.configuration),
        ("velocity", plan.velocity, *model.velocity_limits(flown), model.velocity),
        ("input", plan.inputs, *model.input_limits(flown[rows]), model.inputs),
    ):
        excess, (k, i) = worst(np.maximum(np.maximum(low - values, values - high), 0.0))
        what = f"planned {kind} '{of.names[i]}'"
        yield at_most(
            f"planned_{kind}", what, excess, limits.node, of.units[i], f" in row {k}", "exceeds its limits by"
        )


def flown(plan: Plan, flight: Replay, race: Race, model: Model, limits: Limits) -> Checks:
    """Check gates, limits between nodes, ground and end on the replay."""
    found = passes(flight.time, flight.configuration[:, :3], race.goals, limits.gate_position)
    for number, (gate, one) in enumerate(zip(race.goals, found, strict=True), 1):
        name = "the end" if number == len(race.goals) else f"gate {number}"
        allowed = gate.radius + limits.gate_position
        if one.inside:
            yield Check("gate", one.distance, allowed, "m", True)
            continue
        reason = f"{name} is passed at {one.distance:.4g} m on the replay at t={one.time:.3f} s, allowed {allowed:g} m"
        if one.distance <= allowed:
            reason = f"{name} is not passed after the gates before it"
        yield Check("gate", one.distance, allowed, "m", False, reason)
    for k in (*flight.restarts, plan.intervals):
        missed = float(np.linalg.norm(flight.configuration[flight.nodes[k], :3] - plan.configuration[k, :3]))
        where = f" at node {k} (t={plan.time[k]:.3f} s)"
        yield at_most(
            "segment",
            "error of the replay since the gate before",
            missed,
            limits.segment_position,
            "m",
            where,
        )
    yield from _between_nodes(plan, flight, race, model, limits)
    yield from _end(flight, race, model, limits)


def worst_miss(flight: Replay, race: Race, limits: Limits) -> tuple[int, float]:
    """Number of gates passed in order, the end included, and the largest distance beyond a radius, m."""
    found = passes(flight.time, flight.configuration[:, :3], race.goals, limits.gate_position)
    miss = [one.distance - gate.radius for one, gate in zip(found, race.goals, strict=True)]
    return sum(one.inside for one in found), float(np.max(miss))


def _input_nodes(plan: Plan) -> NDArray[np.int64]:
    """Node whose limits hold for each row of a plan's inputs."""
    if plan.interpolation == "linear":
        return np.arange(len(plan.time))
    return np.arange(len(plan.inputs)) // (len(plan.inputs) // plan.intervals)


def rate_ratio(plan: Plan, flight: Replay, race: Race, model: Model) -> Array:
    """Rates on the replay over their limits there, (m, n_v); limits run linearly between the nodes."""
    node = np.interp(flight.time, plan.time, np.arange(len(plan.time)))
    metres = np.interp(node, np.arange(len(plan.time)), race.flown(model, len(plan.time)))
    low, high = model.velocity_limits(metres)
    half = np.maximum(high, -low)
    return np.where(np.isfinite(half), np.abs(flight.velocity) / half, 0.0)


def _between_nodes(plan: Plan, flight: Replay, race: Race, model: Model, limits: Limits) -> Checks:
    box = race.limits(model)
    excess = np.maximum(np.maximum(box.lower - flight.configuration, flight.configuration - box.upper), 0.0)
    value, (k, i) = worst(excess[:, :3])
    where = f" on the replay at t={flight.time[k]:.3f} s"
    what = f"'{plan.coordinate_names[i]}'"
    yield at_most(
        "replay_position", what, value, limits.overshoot_position, "m", where, "exceeds its limits by"
    )
    value, (k, i) = worst(rate_ratio(plan, flight, race, model))
    where = f" on the replay at t={flight.time[k]:.3f} s"
    what = f"rate of '{plan.velocity_names[i]}'"
    yield at_most("replay_rate", what, value, limits.rate_ratio, "times its limit", where)


def _end(flight: Replay, race: Race, model: Model, limits: Limits) -> Checks:
    place, moving = flight.configuration[-1, :3], flight.velocity[-1, :3]
    end = race.goals[-1]
    far = float(np.linalg.norm(place - np.array(end.position)))
    allowed = limits.end_position if race.end_velocity == "rest" else end.radius + limits.gate_position
    yield at_most("replay_end", "distance from the end on the replay", far, allowed, "m")
    if race.end_velocity == "free":
        return
    wanted = np.zeros(3) if isinstance(race.end_velocity, str) else np.array(race.end_velocity)
    off = float(np.linalg.norm(moving - wanted))
    yield at_most(
        "replay_end_velocity", "velocity at the end on the replay is off and", off, limits.end_speed, "m/s"
    )


def _nearest(position: Array, gate: Gate, after: float) -> tuple[Array, Array]:
    """Nearest distance of each straight piece of a path to a gate's centre, and where on the piece (share)."""
    start, way = position[:-1], np.diff(position, axis=0)
    to = np.array(gate.position) - start
    length = np.sum(way**2, axis=1)
    share = np.clip(np.sum(to * way, axis=1) / np.maximum(length, 1e-300), 0.0, 1.0)
    share[:1] = np.maximum(share[:1], after)
    return np.linalg.norm(to - share[:, None] * way, axis=1), share


def _entry(position: Array, gate: Gate, allowance: float, after: float) -> float:
    """Share of the first piece at which the path enters the gate."""
    start, way = position[0] - np.array(gate.position), position[1] - position[0]
    a, b, c = way @ way, start @ way, start @ start - (gate.radius + allowance) ** 2
    root = (-b - np.sqrt(max(b * b - a * c, 0.0))) / a if a > 0 else 0.0
    return float(np.clip(root, after, 1.0))


def _time(time: Array, piece: int, share: float) -> float:
    return float(time[piece] + share * (time[piece + 1] - time[piece]))
