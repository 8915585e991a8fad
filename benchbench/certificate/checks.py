"""The rules of the certificate, group by group; each group yields its checks."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchbench.arrays import Array
from benchbench.certificate.audit import Audit, event_contacts, path_contacts
from benchbench.certificate.certificate import Check, at_least, at_most, worst
from benchbench.certificate.limits import Limits, ProblemLimits
from benchbench.certificate.replay import Defects, Replay
from benchbench.mpcc.residuals import Residuals
from benchbench.ocp.model import Coordinates, Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.scenario import Scenario

Checks = Iterator[Check]
SPOKEN = {"position": "distance", "velocity": "relative speed", "heading": "heading error"}
ROUNDING = 1e-6
"""Granted when durations and progress indices are added up, s and 1."""

EXCEEDS = "exceeds its limits by"
TIMES = "times its limit"


def original_problem(found: Residuals, limits: ProblemLimits) -> Checks:
    """Check the residuals of the MPCC that is said to be solved."""
    what = f"violation of the original problem (worst in '{found.worst_constraint}')"
    yield at_most("residual", what, found.max_violation, limits.residual, "1")
    if limits.complementarity is not None:
        what = "violation of the complementarity pairs"
        yield at_most("complementarity", what, found.max_complementarity, limits.complementarity, "1")
    what = "violation of the signs of the complementarity pairs"
    yield at_most("complementarity_sign", what, found.max_negativity, limits.residual, "1")
    if limits.product is not None:
        what = "product of a complementarity pair"
        yield at_most("complementarity_product", what, found.max_product, limits.product, "1")


def soundness(plan: Plan) -> Checks:
    """Check for finite numbers and increasing time; without them nothing else can be asked."""
    for name in ("time", "configuration", "velocity", "inputs", "progress"):
        bad = ~np.isfinite(getattr(plan, name))
        row = int(np.argmax(bad.reshape(len(bad), -1).any(axis=1)))
        reason = f"the plan's {name} is not a number in row {row}" if bad.any() else ""
        yield Check(f"finite_{name}", float(bad.sum()), 0.0, "1", not bad.any(), reason)
    shortest = float(np.min(np.diff(plan.time)))
    increasing = shortest > 0 and plan.time[0] == 0
    reason = f"time must start at 0 and increase, but its smallest step is {shortest:.6g} s"
    yield Check("time", shortest, 0.0, "s", increasing, "" if increasing else reason)


def planned(plan: Plan, scenario: Scenario, model: Model, limits: Limits) -> Checks:
    """Check ends and limits at the nodes, to numeric accuracy."""
    names, units = plan.coordinate_names, plan.coordinate_units
    moving, rates = plan.velocity_names, plan.velocity_units
    still = np.zeros(len(moving))
    ends = (
        ("start", 0, scenario.start_point(model), scenario.start_rates(model)),
        ("end", -1, scenario.end_point(model), still),
    )
    for where, k, point, rate in ends:
        gap, (i,) = worst(np.abs(plan.configuration[k] - point))
        what = f"distance of planned '{names[i]}' from the {where}"
        yield at_most(f"planned_{where}", what, gap, limits.node, units[i])
        speed, (i,) = worst(np.abs(plan.velocity[k] - rate))
        what = f"planned rate of '{moving[i]}' at the {where}" + (
            " beside the given one" if rate.any() else ""
        )
        yield at_most(f"planned_{where}_rest", what, speed, limits.node, rates[i])
    boxes = (
        ("configuration", plan.configuration, scenario.limits(model)),
        ("velocity", plan.velocity, model.velocity),
        ("input", plan.inputs, model.inputs),
        ("output", outputs(model, plan), model.outputs),
    )
    for kind, values, box in boxes:
        if not box.names:
            continue
        excess, (k, i) = worst(outside(values, box))
        what = f"planned {kind} '{box.names[i]}'"
        yield at_most(f"planned_{kind}", what, excess, limits.node, box.units[i], f" at node {k}", EXCEEDS)


def consistency(plan: Plan, missed: Defects, limits: Limits) -> Checks:
    """Check that each interval, flown from its planned state, arrives where the plan says."""
    for kind, values, limit, unit in (
        ("position", distance(plan, missed.configuration), limits.defect_position, "m"),
        ("angle", angle(plan, missed.configuration), limits.defect_angle, "rad"),
    ):
        value, (k,) = worst(values)
        where = f" in interval {k} (t={plan.time[k]:.3f} s)"
        yield at_most(f"defect_{kind}", f"{kind} defect of one interval", value, limit, unit, where)


def flown(plan: Plan, flight: Replay, scenario: Scenario, model: Model, limits: Limits) -> Checks:
    """Check limits between the nodes and the end, on the open-loop replay."""
    box = joined(scenario.limits(model), model.outputs)
    excess = outside(np.hstack([flight.configuration, outputs(model, flight)]), box)
    kinds = (("position", "m", limits.overshoot_position), ("angle", "rad", limits.overshoot_angle))
    for kind, unit, limit in kinds:
        mine = [i for i, u in enumerate(box.units) if u == unit]
        if mine:
            value, (k, i) = worst(excess[:, mine])
            what = f"'{box.names[mine[i]]}'"
            yield at_most(f"replay_{kind}", what, value, limit, unit, _at(flight, k), EXCEEDS)
    rates, box = all_rates(flight, model), joined(model.velocity, model.outputs)
    value, (k, i) = worst(rate_ratio(rates, box))
    what = f"rate of '{box.names[i]}'"
    yield at_most("replay_rate", what, value, limits.rate_ratio, TIMES, _at(flight, k))
    missed = flight.configuration[-1:] - scenario.end_point(model)
    what = "distance from the end on the replay"
    yield at_most("replay_end", what, float(distance(plan, missed)[0]), limits.end_position, "m")
    what = "angle from the end on the replay"
    yield at_most("replay_end_angle", what, float(angle(plan, missed)[0]), limits.end_angle, "rad")
    value, (i,) = worst(rate_ratio(rates[-1], box))
    what = f"rate of '{box.names[i]}' at the end of the replay"
    yield at_most("replay_end_rest", what, value, limits.end_velocity_ratio, TIMES)


def contact_planned(plan: Plan, found: Audit, asked: bool, limits: Limits) -> Checks:
    """Check that every node that claims contact is in contact, and enough of them in a row where that is `asked`."""
    stop = found.stop
    for name, contact in event_contacts(stop):
        if found.claims.any():
            k = found.worst_planned(name)
            gap, limit = float(found.planned[name][k]), contact.limit + limits.node
            reason = (
                f"node {k} claims contact{stop.label} with epsilon {found.progress[k]:.3g} but its "
                f"{spoken(name)} is {gap:.6g} {contact.unit}, allowed {contact.limit:.6g} {contact.unit}"
            )
            ok = gap <= limit
            yield Check(f"contact_node_{name}", gap, limit, contact.unit, ok, "" if ok else reason)
    for name, contact in path_contacts(stop):
        gap, (k,) = worst(found.planned[name])
        limit = contact.limit + limits.node
        yield at_most(f"path_{name}", spoken(name) + stop.label, gap, limit, contact.unit, f" at node {k}")
    if not asked or not any(True for _ in event_contacts(stop)):
        return
    required, what = stop.kappa_init, f"the longest contact{stop.label} that holds every condition"
    yield at_least("contact_steps", what, found.steps, required, "nodes")
    first, last = found.window or (0, -1)
    hidden = limits.contact_claim * len(plan.time) + ROUNDING
    total = float(np.sum(found.progress[first : last + 1]))
    made = f"the progress made in that contact{stop.label}"
    yield at_least("contact_progress", made, total, required, "1", hidden)
    if stop.contact_seconds is not None:
        seconds = float(plan.time[last] - plan.time[first]) if found.window else 0.0
        yield at_least("contact_seconds", what, seconds, stop.contact_seconds, "s", ROUNDING)


def contact_flown(flight: Replay, found: Audit, limits: Limits) -> Checks:
    """Check the conditions on the replay: all through the window, or all the time."""
    stop = found.stop
    for name, contact in event_contacts(stop):
        if found.window is not None:
            k = found.worst_replayed(name)
            gap = float(found.replayed[name][k])
            what, limit = f"{spoken(name)} in contact{stop.label}", _allowed(name, contact.limit, limits)
            yield at_most(f"contact_{name}", what, gap, limit, contact.unit, _at(flight, k))
    for name, contact in path_contacts(stop):
        gap, (k,) = worst(found.replayed[name])
        limit, what = _allowed(name, contact.limit, limits), spoken(name) + stop.label
        yield at_most(f"replay_path_{name}", what, gap, limit, contact.unit, _at(flight, k))


def outputs(model: Model, flight: Plan | Replay) -> Array:
    """Return the plant's further limited quantities along a plan or a replay, (n, n_y)."""
    with np.errstate(invalid="ignore"):
        return model.plant().output(flight.configuration, flight.velocity)


def joined(first: Coordinates, second: Coordinates) -> Coordinates:
    """Return both, one after the other."""
    lower, upper = (np.append(getattr(first, k), getattr(second, k)) for k in ("lower", "upper"))
    return Coordinates((*first.names, *second.names), (*first.units, *second.units), lower, upper)


def all_rates(flight: Replay, model: Model) -> Array:
    """Return velocities and those outputs that are rates, 0 for the others, (m, n_v + n_y)."""
    rate = np.array([unit.endswith("/s") for unit in model.outputs.units], bool)
    return np.hstack([flight.velocity, np.where(rate, outputs(model, flight), 0.0)])


def outside(values: Array, box: Coordinates) -> Array:
    """Return how far values (..., n) are beyond their limits, 0 inside."""
    return np.asarray(np.maximum(np.maximum(box.lower - values, values - box.upper), 0.0))


def rate_ratio(v: Array, box: Coordinates) -> Array:
    """Return |v| over its limit, from the middle of the limits; 0 for a velocity without limits."""
    half = (box.upper - box.lower) / 2
    limited = np.isfinite(half)
    with np.errstate(invalid="ignore"):
        middle = np.where(limited, (box.upper + box.lower) / 2, 0.0)
    return np.where(limited | np.isnan(v), np.abs(v - middle) / half, 0.0)


def distance(plan: Plan, difference: Array) -> Array:
    """Return the Euclidean length of the coordinates in m, (n,), from differences (n, n_q)."""
    return np.asarray(np.linalg.norm(difference[:, [u == "m" for u in plan.coordinate_units]], axis=1))


def angle(plan: Plan, difference: Array) -> Array:
    """Return the largest of the coordinates in rad, (n,), from differences (n, n_q).

    Four coordinates without a unit are a quaternion, whose small differences are half an angle.
    """
    turned = np.abs(difference[:, [u == "rad" for u in plan.coordinate_units]])
    quaternion = difference[:, [u == "1" for u in plan.coordinate_units]]
    half = np.linalg.norm(quaternion, axis=1)
    return np.asarray(np.maximum(np.max(turned, axis=1, initial=0.0), 2 * half))


def spoken(name: str) -> str:
    """Return what a contact's gap is called in a sentence."""
    return SPOKEN.get(name, name)


def _allowed(name: str, limit: float, limits: Limits) -> float:
    return limit + max(limits.contact_allowance.get(name, 0.0), limits.node)


def _at(flight: Replay, k: int) -> str:
    return f" on the replay at t={flight.time[k]:.3f} s"
