"""One flight as an MCAP recording: plan, truth, what was sensed and commanded, CPU times, contact; from the plan's start on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from benchbench.flight.campaign import Flown
from benchbench.flight.loop import EVERY, Log
from benchbench.flight.reference import Reference, tip
from benchbench.ground.arrays import Index
from benchbench.ocp.airframe import airframe_of
from benchbench.ocp.model import Model
from benchbench.ocp.plan import Plan
from benchbench.ocp.scenario import Scenario
from benchbench.storage.multirotor import MultirotorTrajectory, continuous, plan_of
from benchbench.storage.recording import METRES, XYZ, Series, write_series

STATE = ("x", "y", "z", "qw", "qx", "qy", "qz", "arm", "vx", "vy", "vz", "wx", "wy", "wz", "arm_rate")
UNITS = ("m",) * 3 + ("1",) * 4 + ("rad",) + ("m/s",) * 3 + ("rad/s",) * 4
MOTORS = ("motor_1", "motor_2", "motor_3", "motor_4")


def write_flight(
    path: Path, reference: Reference, one: Flown, scenario: Scenario, model: Model, metadata: Mapping[str, str]
) -> None:  # fmt: skip
    """Write a flight every 20 ms; viewers draw the vehicle as it flew. Raises BadInput("output", ...)."""
    kept = np.flatnonzero(one.log.time >= 0).astype(np.int64)[::EVERY]
    told = {
        "flight": str(one.number),
        "success": str(one.verdict.success),
        "reasons": "; ".join(one.verdict.reasons),
    }
    if len(kept) > 1:
        flown = _flown(one.log, kept, model)
        write_series(
            path, flown, [*_series(reference, one.log, kept, model)], scenario, model, {**metadata, **told}
        )


def _flown(log: Log, kept: Index, model: Model) -> Plan:
    """The truth as a plan, which is what viewers are given to draw; its time begins at 0."""
    state = log.state[kept]
    flight = MultirotorTrajectory(
        time=log.time[kept] - log.time[kept[0]], position=state[:, :3], quaternion=continuous(state[:, 3:7]),
        velocity=state[:, 8:11], body_rates=state[:, 11:14], thrusts=log.motors[kept],
        arm=np.stack([state[:, 7], state[:, 14], np.zeros(len(kept))], axis=-1),
    )  # fmt: skip
    return plan_of(flight, model, "linear")


def _series(reference: Reference, log: Log, kept: Index, model: Model) -> Iterator[Series]:
    frame = airframe_of(model)
    arm, time = (frame.arm_offset, frame.arm_length), log.time[kept]
    planned = reference.state[kept + 1]
    yield Series("/plan/state", time, STATE, UNITS, planned)
    yield Series("/plan/end_effector", time, XYZ, METRES, tip(planned, *arm)[0])
    yield Series("/truth/state", time, STATE, UNITS, log.state[kept])
    yield Series("/truth/end_effector", time, XYZ, METRES, tip(log.state[kept], *arm)[0])
    yield Series("/truth/ball", time, XYZ, METRES, log.ball[kept, :3])
    contact = np.stack([log.attached[kept], [bool(log.touched[row]) for row in kept]], axis=-1).astype(float)
    yield Series("/truth/contact", time, ("attached", "touched"), ("1", "1"), contact)
    yield Series("/motors", time, MOTORS, ("N",) * 4, log.motors[kept])
    begun = log.commanded >= 0
    sensed, cost = log.sensed[begun], log.controller_cpu[: len(begun)][begun]
    yield Series("/sensed/state", log.commanded[begun], STATE, UNITS, sensed)
    rates = np.hstack([log.rates, log.thrust[:, None]])[begun]
    yield Series(
        "/command", log.commanded[begun], ("wx", "wy", "wz", "thrust"), ("rad/s",) * 3 + ("N",), rates
    )
    yield Series("/controller", log.commanded[begun], ("cpu",), ("s",), cost[:, None])
