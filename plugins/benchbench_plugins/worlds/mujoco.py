"""The world as MuJoCo moves it: rigid bodies, contacts, a magnet that acts at a distance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, final

import numpy as np
from numpy.typing import NDArray
from pydantic import validate_call

from benchbench.flight.extra import need
from benchbench.flight.filmed import Filmed, Scene
from benchbench.flight.inertia import rigid
from benchbench.flight.mismatch import Drawn
from benchbench.flight.reference import Reference
from benchbench.flight.rig import Rig
from benchbench.flight.world import STEP, Actuators, Truth, World
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe
from benchbench.ocp.scenario import NonNegative
from benchbench_plugins.worlds.devices import Devices
from benchbench_plugins.worlds.mjcf import TIP, Ball, mjcf
from benchbench_plugins.worlds.rendering import pictures
from benchbench_plugins.worlds.surroundings import Surroundings

TOUCHING = 5e-4
"""m, clearance at which the ball is held: contacts of MuJoCo give way by less."""
VEHICLE, STAND, BALL = 7, 10, 17
"""Velocities of vehicle, stand and ball end there; positions one, one and two later: quaternions have four numbers."""


@final
class Mujoco(World, Filmed):
    """MuJoCo: independent code, with contacts, friction and a carried mass.

    servo_stiffness, servo_damping   N m/rad and N m s/rad of the servo's own loop
    """

    @validate_call
    def __init__(self, servo_stiffness: NonNegative = 6.0, servo_damping: NonNegative = 0.3) -> None:
        """Keep the gains of the servo. Raises Unavailable without MuJoCo."""
        need("mujoco", "world=mujoco")
        self.servo = (servo_stiffness, servo_damping)

    def prepare(
        self, reference: Reference, airframe: Airframe, rig: Rig, mismatch: Drawn
    ) -> Callable[[Actuators], Truth]:
        """Compile the model, put in the masses of this flight, and place everything."""
        ball = Ball(reference.ball_radius, rig.ball_mass * (1 + mismatch.ball_mass), reference.reach)
        model, data = compiled(airframe, rig, ball, mismatch)
        place(data, reference.state[0], reference.target[0], ball.radius)
        devices = Devices(rig, mismatch, reference.inputs[0, :4], self.servo)
        return _Running(model, data, reference, mismatch, devices).step

    def pictures(self, scene: Scene) -> Iterator[NDArray[np.uint8]]:
        """Drawn by MuJoCo."""
        return pictures(scene)


def compiled(airframe: Airframe, rig: Rig, ball: Ball, mismatch: Drawn) -> tuple[Any, Any]:
    """Return MuJoCo's model and data with this flight's masses."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(mjcf(airframe, rig, ball, STEP))
    vehicle, arm = model.body("vehicle").id, model.body("arm").id
    real = rigid if mismatch.rigid else np.asarray
    model.body_mass[vehicle] = airframe.mass * (1 + mismatch.mass)
    model.body_mass[arm] = airframe.arm_mass
    model.body_inertia[vehicle] = real(airframe.inertia) * (1 + mismatch.mass)
    model.body_inertia[arm] = real(airframe.arm_inertia)
    model.body_ipos[vehicle, :2] = mismatch.centre_of_mass
    data = mujoco.MjData(model)
    mujoco.mj_setConst(model, data)
    return model, data


def place(data: Any, state: Array, target: Array, radius: float) -> None:
    """Put the vehicle into a state (15,), the stand and the ball where the target (6,) is."""
    centre = target[:3] - [0, 0, radius]
    data.qpos[:] = np.concatenate([state[:8], centre, centre, [1, 0, 0, 0]])
    data.qvel[:] = np.concatenate([state[8:], target[3:], target[3:], np.zeros(3)])


class _Running:
    """One world that is being moved on."""

    def __init__(
        self, model: Any, data: Any, reference: Reference, mismatch: Drawn, devices: Devices
    ) -> None:
        import mujoco

        self.advance, self.model, self.data = mujoco.mj_step, model, data
        self.names = {model.geom(name).id: name for name in ("ground", "magnet", "ball")}
        self.magnet, self.vehicle = model.geom("magnet").id, model.body("vehicle").id
        self.own = {i for i in range(model.ngeom) if model.geom_bodyid[i] in (self.vehicle, self.vehicle + 1)}
        self.centre, self.tip = data.xpos[model.body("ball").id], data.geom_xpos[self.magnet]
        self.count, self.start = 0, float(reference.time[0])
        late = round(mismatch.target_late / reference.step)
        rows = np.clip(np.arange(len(reference.time)) - late, 0, None)
        self.target = reference.target[rows] - [0, 0, reference.ball_radius, 0, 0, 0]
        self.held = reference.ball_radius + TIP + TOUCHING
        self.surroundings = Surroundings(mismatch, reference.window[0])
        self.devices = devices
        data.ctrl[5] = 1.0

    def step(self, actuators: Actuators) -> Truth:
        """Move on by STEP."""
        data, time = self.data, self.start + self.count * STEP
        row = min(self.count, len(self.target) - 1)
        data.qpos[8:11], data.qvel[VEHICLE:STAND] = self.target[row, :3], self.target[row, 3:]
        data.ctrl[:4] = self.devices.motors(actuators.motors)
        data.ctrl[4] = self.devices.torque(actuators.arm, float(data.qpos[7]), float(data.qvel[6]))
        data.xfrc_applied[self.vehicle, :3] = self.surroundings.force(
            time, data.qvel, float(data.qpos[2]), float(data.ctrl[:4].sum())
        )
        self.advance(self.model, data)
        self.count += 1
        state = np.concatenate([data.qpos[:8], data.qvel[:VEHICLE]])
        ball = np.concatenate([data.qpos[11:14], data.qvel[STAND : STAND + 3]])
        return Truth(time + STEP, state, ball, self._attached(), self._touched() if data.ncon else "")

    def _attached(self) -> bool:
        tip, centre = self.tip, self.centre
        distance = math.dist((tip[0], tip[1], tip[2]), (centre[0], centre[1], centre[2]))
        return distance < self.held

    def _touched(self) -> str:
        """Names of what the vehicle touches beside the ball at its magnet."""
        found = set()
        for one, other in self.data.contact.geom.tolist():
            if one in self.own or other in self.own:
                found.add(self.names.get(other if one in self.own else one, "stand"))
        return " ".join(sorted(found))
