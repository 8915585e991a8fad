"""What the suites of flights share: a vehicle, a rig, a task to fly, and a body that does exactly what it is told."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from benchbench.flight.controller import PERIOD, Known
from benchbench.flight.mismatch import Drawn, Mismatch
from benchbench.flight.reference import Reference, matrices
from benchbench.flight.rig import Rig
from benchbench.flight.sensed import Command, Sensed
from benchbench.flight.statics import hover
from benchbench.flight.training import training_reference
from benchbench.flight.world import STEP
from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe, FlownModel
from benchbench.run import config

RIG = Rig(motor_force=(0.0, 8.0), servo_torque=(-2.0, 2.0), ball_mass=0.075, pull=2.5)
RADIUS, REACH = 0.03, 0.022


@cache
def vehicle() -> FlownModel:
    """Return the paper's vehicle."""
    model = config.compose("+scenario=static", "compile=never").model
    assert isinstance(model, FlownModel)
    return model


def same(**ranges: tuple[float, float]) -> Drawn:
    """No mismatch but what is named; inertias as they are printed."""
    return Mismatch(rigid=False, **ranges).draw(0)


def staying(state: Array, target: Array, seconds: float) -> Reference:
    """Stay in a state (15,) above a target at rest (3,)."""
    frame, n = vehicle().airframe, round(seconds / STEP) + 1
    return Reference(
        step=STEP, time=STEP * np.arange(n, dtype=float), state=np.tile(state, (n, 1)),
        inputs=np.tile(hover(frame, float(state[7])), (n, 1)), acceleration=np.zeros((n, 3)),
        target=np.tile(np.append(target, np.zeros(3)), (n, 1)), ball_radius=RADIUS, reach=REACH,
        window=(seconds / 2, seconds), travel_time=seconds,
    )  # fmt: skip


def hanging(clearance: float = 1.0) -> tuple[Array, Array]:
    """A level vehicle with its arm straight down, and the top of a ball so far below the tip."""
    frame, state = vehicle().airframe, np.zeros(15)
    state[[2, 3, 7]] = 1.5, 1.0, np.pi / 2
    return state, np.array([0.0, 0.0, 1.5 - frame.arm_offset - frame.arm_length - clearance])


@cache
def wandering(seconds: float = 3.4) -> Reference:
    """A smooth way about a place, with the arm swinging."""
    start = staying(*hanging(), 1.0)
    return training_reference(start, vehicle().airframe, seconds, seed=1)


def known(reference: Reference) -> Known:
    """What a controller knows of the task."""
    return Known(reference, vehicle().airframe, RIG)


class Obedient:
    """A body whose rates, thrust and arm are those of the command, pushed by an acceleration (3,) m/s^2 besides.

    Only its motion follows from physics: dp/dt = v, dv/dt = R e_3 F / m - g e_3 + what the arm does on the reference + push.
    """

    def __init__(self, reference: Reference, push: Array | None = None) -> None:
        """Begin in the reference's first state."""
        frame: Airframe = vehicle().airframe
        self.mass, self.gravity = frame.total_mass, np.array([0.0, 0.0, frame.gravity])
        self.reference, self.time = reference, float(reference.time[0])
        self.state, self.push = reference.state[0].copy(), np.zeros(3) if push is None else push
        up = matrices(reference.state[:, 3:7])[:, :, 2]
        thrust = reference.inputs[:, :4].sum(axis=1, keepdims=True) / self.mass
        self.coupling = reference.acceleration - up * thrust + self.gravity

    def sensed(self) -> Sensed:
        """What is, without noise or delay."""
        return Sensed(self.time, self.state.copy(), False)

    def obey(self, command: Command) -> None:
        """Move on by the controller's period."""
        for _ in range(round(PERIOD / STEP)):
            s, since = self.state, self.time - command.time + STEP / 2
            rates = np.array(command.rates) + since * np.array(command.spin)
            up = matrices(s[None, 3:7])[0, :, 2]
            a = up * command.thrust / self.mass - self.gravity + self.push
            a = a + self.coupling[self.reference.row(self.time)]
            s[:3] += STEP * s[8:11] + STEP**2 / 2 * a
            s[8:11] += STEP * a
            s[3:7] = _turned(s[3:7], STEP * rates)
            s[11:14] = rates
            s[7], s[14] = command.arm[0] + since * command.arm[1], command.arm[1]
            self.time += STEP


def shifted(reference: Reference, by: Array) -> Reference:
    """The same way elsewhere; by: (3,) m."""
    state = reference.state.copy()
    state[:, :3] += by
    return replace(reference, state=state)


def _turned(q: Array, by: Array) -> Array:
    w, x, y, z = q
    a, b, c = by / 2
    turned = q + np.array(
        [-x * a - y * b - z * c, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a]
    )
    return np.asarray(turned / np.linalg.norm(turned))
