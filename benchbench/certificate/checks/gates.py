"""Is every gate passed in order, as it asks, and does the replay keep to the plan from gate to gate?"""

from __future__ import annotations

import numpy as np

from benchbench.certificate import advice
from benchbench.certificate.check import Check, Checks, at_most
from benchbench.certificate.passing import GateEvidence
from benchbench.ocp.gates import Pass, manner
from benchbench.ocp.track import Gate


def gates(evidence: GateEvidence) -> Checks:
    """Check that every gate is passed in order, and at the speed and with the heading it asks for."""
    flight, limits, goals = evidence.flight, evidence.limits, evidence.scenario.goals
    position, allowed = flight.configuration[:, :3], limits.gate_position
    nose = evidence.plant.nose(flight.configuration)
    for number, (gate, one) in enumerate(zip(goals, evidence.passes, strict=True), 1):
        name = "the end" if number == len(goals) else f"gate {number}"
        reason = "" if one.inside else _missed(name, gate, one, allowed)
        yield Check("gate", one.beyond, allowed, "m", one.inside, reason, advice.GATE)
        if not one.inside:
            continue
        how = manner(gate, one, flight.time, position, flight.velocity[:, :3], nose, allowed)
        where = f" on the replay at t={one.time:.3f} s"
        if gate.speed is not None:
            what = f"the speed at {name} is off its limits and"
            yield at_most("gate_speed", what, how.speed, limits.end_speed, "m/s", where, advice=advice.GATE)
        if gate.heading is not None:
            what = f"the heading at {name} is off its limits and"
            yield at_most(
                "gate_heading", what, how.heading, limits.gate_heading, "rad", where, advice=advice.GATE
            )


def segments(evidence: GateEvidence) -> Checks:
    """Check how far the replay is from the plan at each gate, where it starts again, and at the end."""
    plan, flight, limit = evidence.plan, evidence.flight, evidence.limits.segment_position
    for k in (*flight.restarts, plan.intervals):
        missed = float(np.linalg.norm(evidence.drift[k, :3]))
        what, where = "error of the replay since the gate before", f" at node {k} (t={plan.time[k]:.3f} s)"
        yield at_most("segment", what, missed, limit, "m", where, advice=advice.FINER)


def race_end(evidence: GateEvidence) -> Checks:
    """Check place and velocity at the end of the replay."""
    race, limits = evidence.scenario, evidence.limits
    place, moving = evidence.flight.configuration[-1, :3], evidence.flight.velocity[-1, :3]
    end, still = race.goals[-1], race.end_velocity == "rest"
    far = float(np.linalg.norm(place - np.array(end.position)))
    allowed = limits.end_position if still else end.radius + limits.gate_position
    yield at_most("replay_end", "distance from the end on the replay", far, allowed, "m", advice=advice.FINER)
    if race.end_velocity == "free":
        return
    wanted = np.zeros(3) if isinstance(race.end_velocity, str) else np.array(race.end_velocity)
    off, what = float(np.linalg.norm(moving - wanted)), "velocity at the end on the replay is off and"
    yield at_most("replay_end_velocity", what, off, limits.end_speed, "m/s", advice=advice.FINER)


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
