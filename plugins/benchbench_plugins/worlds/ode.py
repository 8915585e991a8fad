"""A second world, of ordinary differential equations alone: what MuJoCo's is compared with."""

from __future__ import annotations

from collections.abc import Callable
from typing import final

import numpy as np
from pydantic import validate_call

from benchbench.flight.mismatch import Drawn
from benchbench.flight.reference import Reference, tip
from benchbench.flight.rig import Rig
from benchbench.flight.statics import mixer
from benchbench.flight.world import STEP, Actuators, Truth, World
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe
from benchbench.ocp.scenario import NonNegative
from benchbench_plugins.worlds.devices import Devices
from benchbench_plugins.worlds.kane import stepper
from benchbench_plugins.worlds.surroundings import Surroundings

TOUCHING = 0.0025
"""m of clearance at which the magnet has the ball."""
LOWEST = 0.02
"""m above the ground at which the tip touches it."""


@final
class Ode(World):
    """Kane's equations by RK4. The ball lies on its stand until the magnet, which pulls the tip only, has it; it is not lost again.

    So a flight cannot drop the ball or hit the stand here: an oracle of the motion, not of the handover.
    """

    @validate_call
    def __init__(self, servo_stiffness: NonNegative = 6.0, servo_damping: NonNegative = 0.3) -> None:
        """Gains of the servo, N m/rad and N m s/rad."""
        self.servo = (servo_stiffness, servo_damping)

    def prepare(
        self, reference: Reference, airframe: Airframe, rig: Rig, mismatch: Drawn
    ) -> Callable[[Actuators], Truth]:
        """Build the equations of this flight."""
        devices = Devices(rig, mismatch, reference.inputs[0, :4], self.servo)
        return _Running(reference, airframe, rig, mismatch, devices).step


class _Running:
    """One world that is being moved on."""

    def __init__(
        self, reference: Reference, airframe: Airframe, rig: Rig, mismatch: Drawn, devices: Devices
    ) -> None:
        self.reference, self.frame, self.rig, self.devices = reference, airframe, rig, devices
        self.advance, self.mix = stepper(airframe, mismatch, STEP), mixer(airframe)
        self.surroundings = Surroundings(mismatch, reference.window[0])
        late = round(mismatch.target_late / reference.step)
        rows = np.clip(np.arange(len(reference.time)) - late, 0, None)
        self.stand = reference.target[rows] - [0, 0, reference.ball_radius, 0, 0, 0]
        self.ball_mass = rig.ball_mass * (1 + mismatch.ball_mass)
        self.state, self.count, self.attached = reference.state[0].copy(), 0, False

    def step(self, actuators: Actuators) -> Truth:
        """Move on by STEP."""
        s, time = self.state, float(self.reference.time[0]) + self.count * STEP
        motors = self.devices.motors(actuators.motors)
        torque = self.devices.torque(actuators.arm, float(s[7]), float(s[14]))
        push = self.surroundings.force(time, s[8:14], float(s[2]), float(motors.sum()))
        mass = self.ball_mass if self.attached else 0.0
        inputs = np.append(self.mix @ motors, torque)
        self.state = self.advance(s, inputs, push, self._pull(), mass).full().ravel()
        self.count += 1
        place, way = self._tip()
        gap = float(np.linalg.norm(place - self._lying()[:3])) - self.reference.ball_radius
        self.attached = self.attached or gap < TOUCHING
        ball = self._lying()
        if self.attached:
            ball = np.concatenate([place - [0, 0, self.reference.ball_radius], way])
        return Truth(time + STEP, self.state, ball, self.attached, "ground" if place[2] < LOWEST else "")

    def _tip(self) -> tuple[Array, Array]:
        place, way = tip(self.state[None], self.frame.arm_offset, self.frame.arm_length)
        return place[0], way[0]

    def _lying(self) -> Array:
        """Where the stand holds the ball, (6,)."""
        return np.asarray(self.stand[min(self.count, len(self.stand) - 1)])

    def _pull(self) -> Array:
        """Force N on the tip within the magnet's reach."""
        way = self._lying()[:3] - self._tip()[0]
        far = float(np.linalg.norm(way))
        if self.attached or far - self.reference.ball_radius > self.reference.reach:
            return np.zeros(3)
        return np.asarray(self.rig.pull * way / max(far, 1e-9))
