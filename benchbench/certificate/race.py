"""The rules for races: every gate in order on the dense replay, limits between nodes, ground, end."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchbench.arrays import Array, Index
from benchbench.certificate.certificate import Check, at_most, worst
from benchbench.certificate.checks import outputs
from benchbench.certificate.limits import Limits
from benchbench.certificate.replay import Replay
from benchbench.ocp.gates import Pass, manner, passes
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.race import Race
from benchbench.ocp.track import Gate

Checks = Iterator[Check]
UNIT_LENGTH = 1e-6
"""Largest error of the length of a planned quaternion."""


def as_passed(plan: Plan, race: Race, allowance: float) -> Race:
    """Return the race to judge: where the order is free, that with the order in which the plan passes the gates."""
    if race.order == "fixed":
        return race
    place = plan.configuration[:, :3]
    times = [passes(plan.time, place, (gate,), allowance)[0].time for gate in race.listed]
    return race.flown_in([int(i) + 1 for i in np.argsort(times, kind="stable")])


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
        ("output", outputs(model, plan), *model.output_limits(flown), model.outputs),
    ):
        if not of.names:
            continue
        excess, (k, i) = worst(np.maximum(np.maximum(low - values, values - high), 0.0))
        what = f"planned {kind} '{of.names[i]}'"
        yield at_most(
            f"planned_{kind}", what, excess, limits.node, of.units[i], f" in row {k}", "exceeds its limits by"
        )


def flown(plan: Plan, flight: Replay, race: Race, model: Model, limits: Limits) -> Checks:
    """Check gates, limits between nodes, ground and end on the replay."""
    yield from _gates(flight, race, model, limits)
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


def _gates(flight: Replay, race: Race, model: Model, limits: Limits) -> Checks:
    """Check that every gate is passed in order, and at the speed and with the heading it asks for."""
    position, allowed = flight.configuration[:, :3], limits.gate_position
    nose = model.plant().nose(flight.configuration)
    found = passes(flight.time, position, race.goals, allowed)
    for number, (gate, one) in enumerate(zip(race.goals, found, strict=True), 1):
        name = "the end" if number == len(race.goals) else f"gate {number}"
        yield Check(
            "gate",
            one.beyond,
            allowed,
            "m",
            one.inside,
            "" if one.inside else _missed(name, gate, one, allowed),
        )
        if not one.inside:
            continue
        how = manner(gate, one, flight.time, position, flight.velocity[:, :3], nose, allowed)
        where = f" on the replay at t={one.time:.3f} s"
        if gate.speed is not None:
            what = f"the speed at {name} is off its limits and"
            yield at_most("gate_speed", what, how.speed, limits.end_speed, "m/s", where)
        if gate.heading is not None:
            what = f"the heading at {name} is off its limits and"
            yield at_most("gate_heading", what, how.heading, limits.gate_heading, "rad", where)


def _missed(name: str, gate: Gate, one: Pass, allowed: float) -> str:
    """Say why a gate does not count."""
    if one.beyond <= allowed:
        return f"{name} is not passed after the gates before it"
    if np.isinf(one.beyond):
        return f"{name} is not crossed in its direction on the replay, after the gates before it"
    if gate.opening is not None:
        there = f"{name} is crossed {one.beyond:.4g} m beyond the edge of its opening"
        return f"{there} on the replay at t={one.time:.3f} s, allowed {allowed:g} m"
    far, most = one.beyond + gate.radius, gate.radius + allowed
    return f"{name} is passed at {far:.4g} m on the replay at t={one.time:.3f} s, allowed {most:g} m"


def worst_miss(flight: Replay, race: Race, limits: Limits) -> tuple[int, float]:
    """Number of gates passed in order, the end included, and the largest distance beyond one, m."""
    found = passes(flight.time, flight.configuration[:, :3], race.goals, limits.gate_position)
    return sum(one.inside for one in found), float(np.max([one.beyond for one in found]))


def _input_nodes(plan: Plan) -> Index:
    """Node whose limits hold for each row of a plan's inputs."""
    if plan.interpolation == "linear":
        return np.arange(len(plan.time))
    return np.arange(len(plan.inputs)) // (len(plan.inputs) // plan.intervals)


def rate_ratio(plan: Plan, flight: Replay, race: Race, model: Model) -> Array:
    """Rates and outputs on the replay over their limits there, (m, n_v + n_y); limits run linearly between nodes."""
    node = np.interp(flight.time, plan.time, np.arange(len(plan.time)))
    metres = np.interp(node, np.arange(len(plan.time)), race.flown(model, len(plan.time)))
    low, high = (
        np.hstack(pair)
        for pair in zip(model.velocity_limits(metres), model.output_limits(metres), strict=True)
    )
    half = np.maximum(high, -low)
    rates = np.hstack([flight.velocity, outputs(model, flight)])
    return np.where(np.isfinite(half), np.abs(rates) / half, 0.0)


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
    what = f"rate of '{(*plan.velocity_names, *model.outputs.names)[i]}'"
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
