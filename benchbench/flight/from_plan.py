"""From a certified plan to the reference that is flown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchbench.certificate.replay import Replay
from benchbench.flight.errand import Errand
from benchbench.flight.reference import Reference, matrices
from benchbench.flight.statics import hover
from benchbench.flight.world import STEP
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe, airframe_of
from benchbench.ocp.model import Model
from benchbench.ocp.motion import sample
from benchbench.ocp.plan import Plan
from benchbench.storage.multirotor import trajectory_of

LEAD, TAIL = 2.0, 1.5
"""s of hovering before the plan, in which an observer settles, and after it, in which the ball must stay."""


def reference_of(plan: Plan, replay: Replay, model: Model, errand: Errand) -> Reference:
    """Return the replay on the world's grid with accelerations of the certificate's plant; contact as the plan claims it.

    A replay that starts again from planned states has no jumps here: what it drifts until then is taken off evenly.
    """
    time: Array = STEP * np.arange(round(plan.travel_time / STEP) + 1, dtype=float)
    q, v = _continuous(plan, replay)
    q, v = (_interpolated(time, replay.time, rows) for rows in (q, v))
    u = plan.input_at(np.minimum(time, plan.travel_time))
    dense = replace(
        plan, time=time, configuration=q, velocity=v, inputs=u, interpolation="linear", progress=np.zeros(len(time))
    )  # fmt: skip
    flight = trajectory_of(dense)
    arm = np.zeros((len(time), 3)) if flight.arm is None else flight.arm
    state = np.hstack(
        [flight.position, flight.quaternion, arm[:, :1], flight.velocity, flight.body_rates, arm[:, 1:2]]
    )
    inputs, acceleration = np.hstack([flight.thrusts, arm[:, 2:]]), model.plant().acceleration(q, v, u)[:, :3]
    return _hovering(plan, state, inputs, acceleration, airframe_of(model), errand)


def _continuous(plan: Plan, replay: Replay) -> tuple[Array, Array]:
    """The replay with the drift before each restart spread over the time since the one before."""
    q, v = replay.configuration.copy(), replay.velocity.copy()
    begun = 0
    for node in replay.restarts:
        first, last = replay.nodes[begun], replay.nodes[node]
        rows = slice(first + (begun > 0), last + 1)
        share = (replay.time[rows] - replay.time[first]) / (replay.time[last] - replay.time[first])
        q[rows] -= share[:, None] * (q[last] - plan.configuration[node])
        v[rows] -= share[:, None] * (v[last] - plan.velocity[node])
        begun = node
    return q, v


def _interpolated(time: Array, at: Array, rows: Array) -> Array:
    return np.stack([np.interp(time, at, column) for column in rows.T], axis=-1)


def _hovering(
    plan: Plan, state: Array, inputs: Array, acceleration: Array, airframe: Airframe, errand: Errand
) -> Reference:
    """Put the time before and after the plan at its ends."""
    before, after = round(LEAD / STEP), round(TAIL / STEP)
    ends = (at_rest(state[0]), at_rest(state[-1]))
    held = [hover(airframe, float(end[7])) for end in ends]
    time: Array = STEP * np.arange(-before, len(state) + after, dtype=float)
    first, last = plan.contact() or (0, 0)
    position, velocity = sample(errand.target, time)
    return Reference(
        step=STEP, time=time,
        state=np.vstack([np.tile(ends[0], (before, 1)), state, np.tile(ends[1], (after, 1))]),
        inputs=np.vstack([np.tile(held[0], (before, 1)), inputs, np.tile(held[1], (after, 1))]),
        acceleration=np.pad(acceleration, ((before, after), (0, 0))),
        target=np.hstack([position, velocity]), ball_radius=errand.ball_radius, reach=errand.reach,
        window=(float(plan.time[first]), float(plan.time[last])), travel_time=plan.travel_time,
    )  # fmt: skip


def at_rest(state: Array) -> Array:
    """Return the same place and heading (15,), level and at rest."""
    nose = matrices(state[None, 3:7])[0, :, 0]
    half = np.arctan2(nose[1], nose[0]) / 2
    turn = np.array([np.cos(half), 0.0, 0.0, np.sin(half)])
    still = state.copy()
    still[3:7] = turn if turn @ state[3:7] >= 0 else -turn
    still[8:] = 0.0
    return still
