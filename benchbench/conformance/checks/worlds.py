"""What every world must do: move as the vehicle's equations say, carry the ball on its stand, hold it by a magnet of its reach."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchbench.conformance.checks.flying import RADIUS, REACH, RIG, hanging, same, staying, vehicle
from benchbench.conformance.checks.require import require
from benchbench.flight.mismatch import Drawn
from benchbench.flight.reference import Reference
from benchbench.flight.world import STEP, Actuators, Truth, World
from benchbench.ground.arrays import Array

STATES = 12
CLOSE = 0.03
"""Share by which the mean acceleration over a step may differ from that at its beginning."""


def check_motion(world: World) -> None:
    """From random states under random inputs, without mismatch, the first step accelerates as our Newton-Euler plant does.

    In angles: the quaternion of the state is made of roll, pitch, yaw; body rates from the plant's own velocities.
    """
    from scipy.spatial.transform import Rotation

    model, draw = vehicle(), np.random.default_rng(5)
    plant = model.plant()
    for _ in range(STATES):
        q = draw.uniform([-1, -1, 1.2, -0.4, -0.4, -1, 1.0], [1, 1, 2.0, 0.4, 0.4, 1, 2.1])
        rates, u = draw.uniform(-1, 1, 3), draw.uniform([2, 2, 2, 2, -0.3], [6, 6, 6, 6, 0.3])
        speed, swing = draw.uniform(-1, 1, 3), float(draw.uniform(-1, 1))
        turn = Rotation.from_euler("ZYX", q[[5, 4, 3]])
        state = np.concatenate([q[:3], turn.as_quat(scalar_first=True), q[6:], speed, rates, [swing]])
        v = np.concatenate([speed, _euler_rates(q, rates), [swing]])
        a = plant.acceleration(q, v, u)
        step = _begun(world, staying(state, np.array([9.0, 9.0, 0.4]), 0.1))
        truth = step(Actuators(u[:4], (float(q[6]), swing, float(u[4]))))
        found = (truth.state[8:] - state[8:]) / STEP
        for name, ours, theirs in (("velocity", a[:3], found[:3]), ("arm's rate", a[6:], found[6:])):
            off = float(np.linalg.norm(theirs - ours)) / (1.0 + float(np.linalg.norm(a)))
            require(off < CLOSE, f"the {name} changes by {theirs} m/s^2 or rad/s^2, ours by {ours}")


def check_hover(world: World) -> None:
    """Under the inputs that hold it, the vehicle stays where it is for a fifth of a second."""
    state, target = hanging()
    reference = staying(state, target, 0.3)
    truth = _flown(world, reference, 100)
    gap = float(np.max(np.abs(truth.state[:3] - state[:3])))
    require(gap < 1e-3, f"it drifts by {gap:.3g} m")
    require(not truth.touched, f"it touches {truth.touched}")
    require(abs(truth.time - 100 * STEP) < 1e-9, f"the time after 100 steps is {truth.time}")


def check_magnet(world: World) -> None:
    """A ball within the reach is lifted by the still vehicle, one beyond it is not."""
    for share, lifted in ((0.7, True), (1.2, False)):
        state, target = hanging(share * REACH)
        truth = _flown(world, staying(state, target, 0.3), 120)
        said = "is not lifted" if lifted else "is lifted"
        require(truth.attached is lifted, f"a ball at {share:g} of the magnet's reach {said}")


def check_stand(world: World) -> None:
    """The ball rides on its stand along a moving target."""
    state, _ = hanging()
    reference = staying(state, np.array([1.0, 0.0, 0.4]), 1.0)
    reference.target[:, 1], reference.target[:, 4] = 0.12 * reference.time, 0.12
    truth = _flown(world, reference, 400)
    top = truth.ball[:3] + np.array([0, 0, RADIUS])
    gap = float(np.linalg.norm(top - reference.target[reference.row(truth.time), :3]))
    require(gap < 3e-3, f"the ball is {gap:.3g} m from where its stand carries it")


def check_mismatch(world: World) -> None:
    """More mass accelerates less, wind pushes along, lagging motors give less at first, and the limits are the rig's."""
    state, target = hanging()
    reference = staying(state, target, 0.3)
    plain = _flown(world, reference, 50, scale=1.3).state
    for name, change, index, sign in (
        ("mass", {"mass": (0.2, 0.2)}, 10, -1), ("motor_lag", {"motor_lag": (0.1, 0.1)}, 10, -1),
        ("thrust", {"thrust": (0.1, 0.1)}, 10, 1), ("wind", {"wind": (0.5, 0.5)}, 8, 1),
    ):  # fmt: skip
        moved = _flown(world, reference, 50, same(**change), 1.3).state
        require(
            sign * (moved[index] - plain[index]) > 5e-3, f"{name} does not change the motion as it should"
        )
    most = (4 * RIG.motor_force[1] / vehicle().airframe.total_mass - vehicle().airframe.gravity) * 50 * STEP
    climb = float(_flown(world, reference, 50, scale=10.0).state[10])
    require(
        climb < 1.02 * most,
        f"motors that are told ten times the weight climb to {climb:.3g} m/s, their limits give {most:.3g}",
    )


def check_again(world: World) -> None:
    """Two worlds of the same draw do the same, also when they are moved in turn."""
    reference = staying(*hanging(), 0.3)
    one, other = _begun(world, reference), _begun(world, reference)
    actuators = Actuators(reference.inputs[0, :4] * 1.1, (1.4, 0.0, 0.0))
    for _ in range(30):
        here, there = one(actuators), other(actuators)
    require(np.array_equal(here.state, there.state), "two worlds of the same draw differ")


CHECKS = (check_motion, check_hover, check_magnet, check_stand, check_mismatch, check_again)


def _begun(world: World, reference: Reference, mismatch: Drawn | None = None) -> Callable[[Actuators], Truth]:
    return world.prepare(reference, vehicle().airframe, RIG, mismatch or same())


def _flown(
    world: World, reference: Reference, steps: int, mismatch: Drawn | None = None, scale: float = 1.0
) -> Truth:
    """Under the reference's first inputs, the motors' scaled."""
    step = _begun(world, reference, mismatch)
    arm = float(reference.state[0, 7])
    for _ in range(steps):
        truth = step(Actuators(scale * reference.inputs[0, :4], (arm, 0.0, float(reference.inputs[0, 4]))))
    return truth


def _euler_rates(q: Array, omega: Array) -> Array:
    (f, t), (x, y, z) = q[3:5], omega
    turn = (np.sin(f) * y + np.cos(f) * z) / np.cos(t)
    return np.array([x + np.sin(t) * turn, np.cos(f) * y - np.sin(f) * z, turn])
