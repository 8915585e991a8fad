"""What every autopilot must do: turn the body as it is told, give the thrust, keep the motors' limits, give up yaw first."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchbench.conformance.checks.flying import RIG, hanging, known, staying, vehicle
from benchbench.conformance.checks.require import require
from benchbench.flight.autopilot import Autopilot
from benchbench.flight.inertia import rigid
from benchbench.flight.sensed import Command, Triple
from benchbench.flight.statics import mixer
from benchbench.flight.world import STEP
from benchbench.ground.arrays import Array

WEIGHT = 1.0
"""Share of the vehicle's weight that is asked as thrust."""


def check_hovers(autopilot: Autopilot) -> None:
    """At rest, told to stay so, it gives the thrust and no torque."""
    found = mixer(vehicle().airframe) @ _begun(autopilot)(_command(), 0.0, (0.0, 0.0, 0.0))
    require(
        abs(found[0] - _weight()) < 1e-6 * _weight(), f"{_weight():.4g} N are asked, {found[0]:.4g} N given"
    )
    require(float(np.abs(found[1:]).max()) < 1e-6, f"torques {found[1:]} N m where none is needed")


def check_turns(autopilot: Autopilot) -> None:
    """A free body of the vehicle's inertia, arm locked, reaches a rate about each axis within 0.4 s, and keeps it."""
    for axis in range(3):
        wanted = np.zeros(3)
        wanted[axis] = 0.6
        rates = _turned(autopilot, _command(_triple(wanted)))
        late = rates[round(0.4 / STEP) :, axis]
        require(float(np.abs(late - 0.6).max()) < 0.15, f"0.6 rad/s about axis {axis} become {late[-1]:.3g}")
        others = np.delete(rates, axis, axis=1)
        require(
            float(np.abs(others).max()) < 0.2,
            f"turning about axis {axis} turns others by {np.abs(others).max():.3g}",
        )


def check_limits(autopilot: Autopilot) -> None:
    """Whatever is asked, motor forces are numbers within the rig's limits."""
    step = _begun(autopilot)
    for thrust in (-10.0, 0.0, 20.0, 200.0):
        for rate in (-50.0, 0.0, 50.0):
            forces = step(_command((rate, -rate, rate), thrust=thrust), 0.0, (0.0, 0.0, 0.0))
            low, high = RIG.motor_force
            inside = bool(np.all(forces >= low - 1e-9) and np.all(forces <= high + 1e-9))
            require(inside, f"{forces} N for {thrust:g} N and {rate:g} rad/s")


def check_yaw_last(autopilot: Autopilot) -> None:
    """Where both cannot be had, roll is given and yaw is not."""
    mix = mixer(vehicle().airframe)
    alone = mix @ _begun(autopilot)(_command((2.0, 0.0, 0.0)), 0.0, (0.0, 0.0, 0.0))
    both = mix @ _begun(autopilot)(_command((2.0, 0.0, 60.0)), 0.0, (0.0, 0.0, 0.0))
    require(
        abs(both[1] - alone[1]) < 0.02 * abs(alone[1]),
        f"roll torque falls from {alone[1]:.3g} to {both[1]:.3g} N m",
    )


def check_preload(autopilot: Autopilot) -> None:
    """With the arm held forward it begins with the torque that holds it, not with none."""
    state, target = hanging()
    state[7] = np.pi / 3
    reference = staying(state, target, 1.0)
    frame = vehicle().airframe
    needed = mixer(frame) @ reference.inputs[0, :4]
    command = Command(
        0.0, float(needed[0]), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), _triple(needed[1:]), (np.pi / 3, 0.0, 0.0)
    )
    found = mixer(frame) @ autopilot.prepare(known(reference))(command, 0.0, (0.0, 0.0, 0.0))
    require(
        abs(found[2] - needed[2]) < 1e-6, f"it begins with {found[2]:.3g} N m, {needed[2]:.3g} hold the arm"
    )


CHECKS = (check_hovers, check_turns, check_limits, check_yaw_last, check_preload)


def _weight() -> float:
    frame = vehicle().airframe
    return WEIGHT * frame.total_mass * frame.gravity


def _begun(autopilot: Autopilot) -> Callable[[Command, float, Triple], Array]:
    return autopilot.prepare(known(staying(*hanging(), 1.0)))


def _command(rates: Triple = (0.0, 0.0, 0.0), thrust: float | None = None) -> Command:
    none = (0.0, 0.0, 0.0)
    return Command(0.0, _weight() if thrust is None else thrust, rates, none, none, (np.pi / 2, 0.0, 0.0))


def _turned(autopilot: Autopilot, command: Command) -> Array:
    """Rates (n, 3) rad/s of a rigid body about its own axes, for 0.8 s."""
    frame, step = vehicle().airframe, _begun(autopilot)
    x, y, z = rigid(frame.arm_inertia)
    down = (frame.arm_offset + frame.arm_length / 2) ** 2 * frame.arm_mass
    inertia = rigid(frame.inertia) + np.array([z + down, y + down, x])
    mix, omega, found = mixer(frame), np.zeros(3), []
    for k in range(round(0.8 / STEP)):
        torque = (mix @ step(command, k * STEP, _triple(omega)))[1:]
        omega = omega + STEP * (torque - np.cross(omega, inertia * omega)) / inertia
        found.append(omega)
    return np.array(found)


def _triple(numbers: Array) -> Triple:
    x, y, z = (float(number) for number in numbers)
    return x, y, z
