"""Flights made without any planner, as good plans to start from; and the vehicle of the paper's Table I.

`bounce` is solved by hand; `crossing` is flown by a plant under inputs found by Newton's method on its own
end state, and may be flown by a wrong plant to plant a modelling error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.mechanics import acceleration
from benchbench.ocp.model import ExplicitModel, Model, Plant
from benchbench.ocp.motion import Motion
from benchbench.ocp.plan import Interpolation, Plan
from benchbench_plugins.models.aerial_manipulator import AerialManipulator

MOTOR = 1.659 * 9.8066 / 4
TABLE_I = {
    "quadrotor_mass": 1.659, "arm_mass": 0.36, "arm_length": 0.182, "arm_offset": 0.05, "frame": 0.33,
    "quadrotor_inertia": (0.0348, 0.0459, 0.0977), "arm_inertia": (0.0, 0.0019, 0.0),
    "torque_coefficient": 0.013, "motor_force": (0.5 * MOTOR, 1.5 * MOTOR), "servo_torque": (-2.0, 2.0),
    "tilt": math.pi / 4, "arm_angle": (math.pi / 3, 2 * math.pi / 3), "speed": (1.3, 1.3, 1.15),
    "angular_rate": (8.0, 8.0, 2.0), "arm_rate": math.pi / 2,
}  # fmt: skip
HEIGHT = 0.65
REST = np.array([0.0, 0.0, HEIGHT, 0.0, 0.0, 0.0, math.pi / 2])
SHIFT = np.array([0.12, 0.01, 0.0, 0.0, 0.0, 0.03, 0.0])


def table_one(**changes: object) -> AerialManipulator:
    return AerialManipulator("table_one", **(TABLE_I | changes))


class Bare(ExplicitModel):
    """Another model behind its accelerations only."""

    name = "bare"
    configuration = velocity = inputs = None  # type: ignore[assignment]

    def __init__(self, whole: Model) -> None:
        self.whole = whole
        self.configuration, self.velocity, self.inputs = whole.configuration, whole.velocity, whole.inputs

    def acceleration(self, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        return acceleration(self.whole, q, v, u)

    def tool(self, q: ca.SX) -> ca.SX:
        return self.whole.tool(q)

    def nose(self, q: ca.SX) -> ca.SX:
        return self.whole.nose(q)

    def hover(self) -> Array:
        return self.whole.hover()

    def plant(self) -> Plant:
        return self.whole.plant()


@dataclass(frozen=True)
class Polynomial(Motion):
    """p(t) = sum c_i (t - t_0)^i with coefficients (order + 1, 3)."""

    start: float
    coefficients: Array

    @property
    def parameters(self) -> Array:
        return np.append(self.coefficients.ravel(), self.start)

    def position(self, time: ca.SX, parameters: ca.SX) -> ca.SX:
        s = time - parameters[-1]
        return sum(parameters[3 * i : 3 * i + 3] * s**i for i in range(len(self.coefficients)))


def along_tool(plan: Plan, plant: Plant, first: int, last: int) -> Polynomial:
    """Cubic target that has the end effector's position and velocity at two nodes."""
    nodes = [first, last]
    (p0, p1), (v0, v1) = plant.tool(plan.configuration[nodes], plan.velocity[nodes])
    h = plan.time[last] - plan.time[first]
    rise = (p1 - p0) / h
    square, cube = (3 * rise - 2 * v0 - v1) / h, (v0 + v1 - 2 * rise) / h**2
    return Polynomial(float(plan.time[first]), np.stack([p0, v0, square, cube]))


def plan_of(model: Model, time: Array, q: Array, v: Array, u: Array, how: Interpolation = "hold") -> Plan:
    box = model.configuration
    idle = np.zeros(len(time))
    return Plan(time, q, v, u, idle, how, box.names, box.units, model.inputs.names, model.inputs.units)


def bounce(model: Model, thrust: float = 1.2, h: float = 0.2) -> Plan:
    """Up and down in three held inputs; the top, thrust * h^2, lies in the middle of the second interval."""
    time = np.array([0.0, h, 3 * h, 4 * h])
    lift = thrust * np.array([1.0, -1.0, 1.0])
    q, v = np.tile(REST, (4, 1)), np.zeros((4, 7))
    q[1:3, 2] += thrust * h**2 / 2
    v[1:3, 2] = thrust * h * np.array([1.0, -1.0])
    return plan_of(model, time, q, v, _lift(model, lift))


def surge(model: Model, thrust: float = 2.0, h: float = 0.2) -> Plan:
    """Up and down in two linear inputs; at rest at all nodes, speed thrust * h / 2 halfway between."""
    time = np.array([0.0, 2 * h, 4 * h])
    lift = thrust * np.array([1.0, -1.0, 1.0])
    q = np.tile(REST, (3, 1))
    q[1, 2] += 2 / 3 * thrust * h**2
    return plan_of(model, time, q, np.zeros((3, 7)), _lift(model, lift), "linear")


Acceleration = Callable[[Array, Array, Array], Array]


def crossing(model: Model, flown_by: Acceleration | None = None) -> Plan:
    """From rest to rest: SHIFT ahead, aside and turned.

    Hover plus the least combination of five sines per input that reaches the end, by Newton's method with
    finite differences. `flown_by` replaces the plant's acceleration, to plant an error.
    """
    acceleration, intervals, h = flown_by or model.plant().acceleration, 20, 0.08
    end = np.concatenate([REST + SHIFT, np.zeros(7)])
    waves = np.sin(np.pi * (np.arange(intervals)[:, None] + 0.5) * np.arange(1, 6) / intervals)
    weights, nudges = np.zeros((5, 5)), 1e-6 * np.eye(26)[:, 1:].reshape(26, 5, 5)
    for _ in range(12):
        inputs = model.hover() + waves @ (weights + np.roll(nudges, -1, axis=0))
        states = _fly(acceleration, inputs, h)
        path, missed = states[:, -1], end - states[-1, -1]
        if np.max(np.abs(missed)) < 1e-8:
            break
        slope = (states[-1, :-1] - path[-1]).T / 1e-6
        weights = weights + np.linalg.lstsq(slope, missed, rcond=None)[0].reshape(5, 5)
    return plan_of(model, h * np.arange(intervals + 1), path[:, :7], path[:, 7:], inputs[-1])


def _fly(acceleration: Acceleration, inputs: Array, h: float, substeps: int = 10) -> Array:
    """States (N + 1, batch, 14) under held inputs (batch, N, n_u), from REST, by Runge-Kutta 4."""
    states = [np.tile(np.concatenate([REST, np.zeros(7)]), (len(inputs), 1))]
    step = h / substeps
    for u in np.moveaxis(inputs, 1, 0):
        y = states[-1]
        for _ in range(substeps):
            a = _slope(acceleration, y, u)
            b = _slope(acceleration, y + step / 2 * a, u)
            c = _slope(acceleration, y + step / 2 * b, u)
            d = _slope(acceleration, y + step * c, u)
            y = y + step / 6 * (a + 2 * b + 2 * c + d)
        states.append(y)
    return np.array(states)


def _slope(acceleration: Acceleration, y: Array, u: Array) -> Array:
    return np.concatenate([y[:, 7:], acceleration(y[:, :7], y[:, 7:], u)], axis=1)


def _lift(model: Model, extra: Array) -> Array:
    """Inputs that accelerate the vehicle upwards by `extra` (n,) m/s^2."""
    hover = model.hover()
    return hover + extra[:, None] / 9.8066 * hover
