"""What the vehicle of a plan is flown with, and what it picks up: motors, magnet and ball, with their reasons in conf/rig."""

from __future__ import annotations

from typing import Self, final

from pydantic import BaseModel, ConfigDict, model_validator

from benchbench.ocp.scenario import Positive
from benchbench.ocp.task_family import Between


@final
class Rig(BaseModel):
    """SI units.

    motor_force   N, what a motor can do; wider than what the planner may use, or nothing is left to the controller
    servo_torque  N m, what the servo can do
    ball_mass     kg; the scenario says how large the ball is
    pull          N, of the permanent magnet within its reach, which the scenario says, too
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    motor_force: Between
    servo_torque: Between
    ball_mass: Positive
    pull: Positive

    @model_validator(mode="after")
    def _holds(self) -> Self:
        if self.pull < 1.5 * 9.81 * self.ball_mass:
            raise ValueError("the magnet must pull with one and a half times the ball's weight to carry it")
        return self
