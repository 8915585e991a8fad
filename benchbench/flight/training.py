"""Training flights: a smooth wandering near the task, from which residual models learn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchbench.flight.reference import Reference, matrices
from benchbench.flight.statics import arm_moment, mixer
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe
from benchbench.ocp.task_family import Draws

WAVES = 4
"""Sines of which each motion is made."""
SPEED = 0.7
"""Share of the speed limits that the wandering reaches at most."""
LEANING = 3
"""Rounds in which attitude and motion of the common centre of mass agree."""
GROWING, SOONEST = 0.2, 1.0
"""Share of the time, and s at least, over which it grows. Within a second, body rates had to change by 15 to 50 rad/s^2, motors were at
their limits, and accelerations of up to 3.8 m/s^2 that no model of the vehicle can expect were learned from.
"""
HIGHER = 0.5
"""m above the reference's start, so that it stays clear of the ground."""
SPARE = 50
"""Samples more than are flown: differences at the last ones are one-sided."""
AWAY = 10.0
"""m, so far the ball is put aside."""


def training_reference(reference: Reference, airframe: Airframe, seconds: float, seed: int) -> Reference:
    """Return a wandering of so many seconds about the middle of a reference, level heading, arm within what it uses.

    Positions and arm are sums of sines of random periods from 2 to 6 s that begin at rest; the ball is far away.
    """
    step, lead = reference.step, reference.lead
    time: Array = step * np.arange(-round(lead / step), round(seconds / step) + 1 + SPARE, dtype=float)
    draws = Draws("training", seed)
    start = reference.state[0].copy()
    speed = SPEED * np.array(airframe.speed) * [1.0, 1.0, 0.5]
    waves = [_wave(draws, axis, time, float(speed[i])) for i, axis in enumerate(("x", "y", "z"))]
    arms = reference.state[:, 7]
    spread = float(max(arms.max() - arms.min(), 0.2)) / 2
    swing = _wave(draws, "arm", time, spread * 2)
    state = np.tile(start, (len(time), 1))
    acceleration = np.zeros((len(time), 3))
    for i, (way, rate, push) in enumerate(waves):
        state[:, i] += way
        state[:, 8 + i] = rate
        acceleration[:, i] = push
    state[:, 2] += HIGHER
    state[:, 7] += swing[0]
    state[:, 14] = swing[1]
    pushed = acceleration
    for _ in range(LEANING):
        state[:, 3:7], state[:, 11:14] = _leaning(pushed, airframe.gravity, step)
        pushed = acceleration + _apart(state, airframe, step)
    inputs = _inputs(state, pushed, airframe)
    target = np.tile([AWAY, AWAY, 0.4, 0.0, 0.0, 0.0], (len(time), 1))
    return replace(
        reference, time=time[:-SPARE], state=state[:-SPARE], inputs=inputs[:-SPARE],
        acceleration=acceleration[:-SPARE], target=target[:-SPARE],
        window=(seconds + 1.0, seconds + 1.0), travel_time=seconds,
    )  # fmt: skip


def _wave(draws: Draws, name: str, time: Array, most: float) -> tuple[Array, Array, Array]:
    """Value, rate and change of the rate of a sum of sines that is at rest until 0 and grows over a fifth of the time."""
    begun = np.clip(time, 0.0, None)
    ramp = max(GROWING * float(time[-1]), SOONEST)
    value = np.zeros(len(time))
    for k in range(WAVES):
        period, phase = (
            draws.number(f"{name}_period_{k}", (2.0, 6.0)),
            draws.number(f"{name}_phase_{k}", (0.0, 6.28)),
        )
        amplitude = most / WAVES * period / (2 * np.pi)
        value += amplitude * (np.sin(2 * np.pi * begun / period + phase) - np.sin(phase))
    value *= 1 - np.exp(
        -((begun / ramp) ** 5)
    )  # the arm's pull follows the fourth derivative, so that one has no jump
    step = float(time[1] - time[0])
    rate = np.gradient(value, step)
    return value, rate, np.gradient(rate, step)


def _apart(state: Array, airframe: Airframe, step: float) -> Array:
    """Acceleration (n, 3) of the common centre of mass relative to the body's origin."""
    arm, half = state[:, 7], airframe.arm_length / 2
    centre = np.stack(
        [half * np.cos(arm), np.zeros(len(arm)), -airframe.arm_offset - half * np.sin(arm)], axis=-1
    )
    way = np.einsum("nij,nj->ni", matrices(state[:, 3:7]), centre) * airframe.arm_mass / airframe.total_mass
    return np.asarray(np.gradient(np.gradient(way, step, axis=0), step, axis=0))


def _leaning(acceleration: Array, gravity: float, step: float) -> tuple[Array, Array]:
    """Quaternions (n, 4), and body rates (n, 3), whose z axis is along the thrust, nose to x."""
    up = acceleration + np.array([0.0, 0.0, gravity])
    up = up / np.linalg.norm(up, axis=1, keepdims=True)
    half = np.stack(
        [1 + up[:, 2], -up[:, 1], up[:, 0], np.zeros(len(up))], axis=-1
    )  # from z to up, the short way
    q = half / np.linalg.norm(half, axis=1, keepdims=True)
    change = np.gradient(q, step, axis=0)
    w, x, y, z = q.T
    conjugate = np.array([[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]])
    return q, 2 * np.einsum("ijn,nj->ni", conjugate, change)


def _inputs(state: Array, acceleration: Array, airframe: Airframe) -> Array:
    """Motor forces and servo torque that hold, and push along the thrust; moments of motion are left to the loops."""
    thrust = airframe.total_mass * np.linalg.norm(
        acceleration + np.array([0.0, 0.0, airframe.gravity]), axis=1
    )
    held = np.array([arm_moment(airframe, float(arm)) for arm in state[:, 7]])
    none = np.zeros(len(state))
    motors = np.linalg.solve(mixer(airframe), np.stack([thrust, none, held[:, 1], none])).T
    return np.hstack([motors, held[:, :1]])
