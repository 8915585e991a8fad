"""One flight: world, sensors, controller and autopilot in a loop until the reference ends or something breaks."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchbench.flight.controller import PERIOD
from benchbench.flight.course import Course
from benchbench.flight.sensed import Command, Sensed, Triple
from benchbench.flight.sensors import Sensors
from benchbench.flight.world import STEP, Actuators, Truth
from benchbench.ground.arrays import Array

EVERY = round(PERIOD / STEP)
"""Steps of the world for one of the controller."""
LONGEST = 200
"""Characters of an error that are kept."""
LOST = 1.0
"""m from the reference, beyond which a flight is given up."""


@dataclass(frozen=True)
class Log:
    """What happened, a row for each of n steps of the world; m commands.

    time, state, ball, attached, touched   as in `Truth`, each with a row for every step
    motors        (n, 4) N, as asked of the motors
    commanded     (m,) s, when commands were given; controller_cpu (m,) s of CPU each took
    rates         (m, 3) rad/s and thrust (m,) N of the commands
    sensed        (m, 15) as `Truth.state`, what the controller was told for each
    cpu           s, of the whole flight
    broken        what ended the flight early: "" for nothing, "lost", or the controller's error in words
    """

    time: Array
    state: Array
    ball: Array
    attached: NDArray[np.bool_]
    touched: tuple[str, ...]
    motors: Array
    commanded: Array
    rates: Array
    thrust: Array
    sensed: Array
    controller_cpu: Array
    cpu: float
    broken: str


def fly(
    course: Course,
    world: Callable[[Actuators], Truth],
    autopilot: Callable[[Command, float, Triple], Array],
    sensors: Sensors,
) -> Log:
    """Fly a course from its reference's first sample to its last.

    A controller that raises, or commands what is no number, ends the flight; the log says so.
    """
    began = time.process_time()
    truths, motors, commands, told, costs = [], [], [], [], []
    begin = course.reference
    truth = Truth(float(begin.time[0]), begin.state[0].copy(), np.zeros(6), False, "")
    sensors.hear(truth)
    broken, command, count = "", None, 0
    while count < len(course.reference.time) - 1:
        if count % EVERY == 0:
            sensed = sensors.sensed()
            command, broken, cost = _commanded(course, sensed, truth.time)
            costs.append(cost)
            if command is None:
                break
            commands.append(command)
            told.append(sensed.state)
        assert command is not None
        forces = autopilot(command, truth.time, sensors.gyro())
        angle, rate, torque = command.arm
        truth = world(Actuators(forces, (angle + rate * (truth.time - command.time), rate, torque)))
        sensors.hear(truth)
        truths.append(truth)
        motors.append(forces)
        if count % EVERY == 0 and not _near(truth, course.reference.state[count + 1]):
            broken = "lost"
            break
        count += 1
    cpu = time.process_time() - began
    return _log(truths, motors, commands, told, costs, cpu, broken)


def _commanded(course: Course, sensed: Sensed, now: float) -> tuple[Command | None, str, float]:
    """The command, or why there is none, and the CPU s that it took."""
    who, before = "course", time.thread_time()
    try:
        control = course.control(now)
        who, before = "controller", time.thread_time()
        command = control(sensed, now)
    except Exception as error:  # noqa: BLE001  # a controller may be anybody's
        return (
            None,
            f"the {who} raised {type(error).__name__}: {error}"[:LONGEST],
            time.thread_time() - before,
        )
    cost = time.thread_time() - before
    numbers = [command.thrust, *command.rates, *command.spin, *command.torque, *command.arm]
    if not np.isfinite(numbers).all():
        return None, "the controller commanded what is no number", cost
    return command, "", cost


def unflown(why: str) -> Log:
    """Return the log of a flight that never began; why in words."""
    return _log([], [], [], [], [], 0.0, why[:LONGEST])


def _near(truth: Truth, wanted: Array) -> bool:
    return bool(np.abs(truth.state[:3] - wanted[:3]).max() < LOST)  # false for NaN


def _log(
    truths: list[Truth], motors: list[Array], commands: list[Command], told: list[Array], costs: list[float], cpu: float, broken: str
) -> Log:  # fmt: skip
    return Log(
        time=np.array([t.time for t in truths]), state=np.array([t.state for t in truths]).reshape(-1, 15),
        ball=np.array([t.ball for t in truths]).reshape(-1, 6),
        attached=np.array([t.attached for t in truths], bool), touched=tuple(t.touched for t in truths),
        motors=np.array(motors).reshape(-1, 4), commanded=np.array([c.time for c in commands]),
        rates=np.array([c.rates for c in commands]).reshape(-1, 3), thrust=np.array([c.thrust for c in commands]), sensed=np.array(told).reshape(-1, 15),
        controller_cpu=np.array(costs), cpu=cpu, broken=broken,
    )  # fmt: skip
