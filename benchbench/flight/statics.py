"""What holds a vehicle at rest: its mixer, and the inputs of hovering with the arm at some angle."""

from __future__ import annotations

import numpy as np

from benchbench.ground.arrays import Array
from benchbench.ocp.airframe import Airframe


def mixer(airframe: Airframe) -> Array:
    """Matrix (4, 4) from motor forces N to thrust N and body torques N m."""
    x, y = airframe.rotors[:, 0], airframe.rotors[:, 1]
    return np.stack([np.ones(4), y, -x, airframe.drag])


def arm_moment(airframe: Airframe, arm: float, payload: float = 0.0) -> tuple[float, float]:
    """Torques N m about the joint and about the body's y axis that hold the arm, level, with a mass in kg at its tip.

    The weight of arm and payload pulls at x = length / 2 cos(arm) and x = length cos(arm); both torques carry it.
    """
    lever = airframe.arm_length * np.cos(arm) * (airframe.arm_mass / 2 + payload)
    torque = -float(airframe.gravity * lever)
    return torque, torque


def hover(airframe: Airframe, arm: float, payload: float = 0.0) -> Array:
    """Inputs (5,) of hovering level: motor forces N, servo torque N m."""
    servo, pitch = arm_moment(airframe, arm, payload)
    thrust = (airframe.total_mass + payload) * airframe.gravity
    return np.append(np.linalg.solve(mixer(airframe), [thrust, 0.0, pitch, 0.0]), servo)
