"""Numbers of an aerial manipulator, shared by the symbolic model and the independent plant."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from benchbench.ocp.scenario import Positive, Range

Inertia = tuple[Annotated[float, Field(ge=0)], Annotated[float, Field(ge=0)], Annotated[float, Field(ge=0)]]


class Parameters(BaseModel):
    """SI units; every value of a vehicle YAML with its source stands there.

    quadrotor_mass, arm_mass         kg
    quadrotor_inertia, arm_inertia   principal moments in the body and arm frame, kg m^2
    arm_length, arm_offset           m; the arm hangs `arm_offset` below the quadrotor's centre of mass
    frame                            motor-to-motor diagonal, m
    torque_coefficient               rotor drag torque per thrust c_tau, m
    gravity                          m/s^2
    motor_force, servo_torque        input limits [N, N], [N m, N m]
    tilt, arm_angle                  limits of roll and pitch, and of alpha, rad
    speed, angular_rate, arm_rate    largest |v| per axis m/s, Euler angle rates rad/s, |d alpha/dt| rad/s
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    quadrotor_mass: Positive
    arm_mass: Positive
    quadrotor_inertia: Inertia
    arm_inertia: Inertia
    arm_length: Positive
    arm_offset: Annotated[float, Field(ge=0)]
    frame: Positive
    torque_coefficient: Positive
    gravity: Positive = 9.8066
    motor_force: Range
    servo_torque: Range
    tilt: Positive
    arm_angle: Range
    speed: tuple[Positive, Positive, Positive]
    angular_rate: tuple[Positive, Positive, Positive]
    arm_rate: Positive
