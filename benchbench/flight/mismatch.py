"""By how much a world differs from the model of the plan: declared ranges, from which each flight's seed draws."""

from __future__ import annotations

from typing import Annotated, Any, final

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from benchbench.ground.arrays import Array
from benchbench.ocp.task_family import AtLeastZero, Between, Draws, increasing

NONE = (0.0, 0.0)
Above = Annotated[float, Field(gt=-1, allow_inf_nan=False)]
NoLess = Annotated[float, Field(ge=-1, allow_inf_nan=False)]
Masses = Annotated[tuple[Above, Above], AfterValidator(increasing)]
"""Shares of a mass: some of it stays."""
Forces = Annotated[tuple[NoLess, NoLess], AfterValidator(increasing)]
"""Shares of a force: -1 is none of it, and less would pull."""


@final
class Mismatch(BaseModel):
    """Ranges [smallest, largest], each drawn uniformly and apart from all others; 0 is no difference.

    What is called a share is of the nominal value: 0.05 is 5 % more.

    mass, ball_mass     share, of quadrotor and ball
    thrust              share, of all motors together (a battery that sags); motor: of each, drawn four times; first_motor:
                        of the first one besides
    motor_lag           s, time constant of the motors
    centre_of_mass      m, of the quadrotor, along x and along y
    drag                N s/m, linear in the speed through the air
    wind                N, along x and along y, steady
    gust                N, along x and along y, for `gust_seconds` from `gust_before` the contact on
    ground_effect       share of thrust gained near the ground: k (0.12 m / (4 z))^2, k is drawn
    servo_bias          rad, the arm's sensor tells so much too little
    target_late         s, the target is where it should have been so long ago
    target_noise, target_heading_noise    standard deviations of what a predictor sees of the target, m and rad
    delay               s, age of what the controller is told
    position_noise, velocity_noise, attitude_noise, rate_noise, arm_noise    standard deviations, m, m/s, rad, rad/s, rad
    blind               s without any news of the state, from `blind_before` the contact on
    rigid               whether inertias that no rigid body can have are replaced by the nearest that one can
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    mass: Masses = NONE
    ball_mass: Masses = NONE
    thrust: Forces = NONE
    motor: Forces = NONE
    first_motor: Forces = NONE
    motor_lag: AtLeastZero = NONE
    centre_of_mass: Between = NONE
    drag: AtLeastZero = NONE
    wind: Between = NONE
    gust: Between = NONE
    gust_seconds: AtLeastZero = (0.5, 0.5)
    gust_before: AtLeastZero = (0.5, 0.5)
    ground_effect: AtLeastZero = NONE
    servo_bias: Between = NONE
    target_late: AtLeastZero = NONE
    target_noise: AtLeastZero = NONE
    target_heading_noise: AtLeastZero = NONE
    delay: AtLeastZero = NONE
    position_noise: AtLeastZero = NONE
    velocity_noise: AtLeastZero = NONE
    attitude_noise: AtLeastZero = NONE
    rate_noise: AtLeastZero = NONE
    arm_noise: AtLeastZero = NONE
    blind: AtLeastZero = NONE
    blind_before: AtLeastZero = (0.5, 0.5)
    rigid: bool = True

    def draw(self, seed: int) -> Drawn:
        """Return the difference of one flight; the same seed gives the same for every plan and every controller."""
        draws = Draws("mismatch", seed)
        ranges = {name: range_ for name, range_ in self if isinstance(range_, tuple)}
        numbers: dict[str, Any] = {
            name: np.array([draws.number(f"{name}_{i}", ranges[name]) for i in range(count)])
            for name, count in SEVERAL.items()
        }
        single: dict[str, Any] = {
            name: draws.number(name, ranges[name]) for name in ranges if name not in SEVERAL
        }
        return Drawn(seed=seed, rigid=self.rigid, **numbers, **single)


SEVERAL = {"motor": 4, "centre_of_mass": 2, "wind": 2, "gust": 2}
"""What is drawn more than once."""


class Drawn(BaseModel):
    """The numbers of one flight, as `Mismatch` names them; motor (4,), centre_of_mass, wind and gust (2,)."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)

    seed: int
    mass: float
    ball_mass: float
    thrust: float
    motor: Array
    first_motor: float
    motor_lag: float
    centre_of_mass: Array
    drag: float
    wind: Array
    gust: Array
    gust_seconds: float
    gust_before: float
    ground_effect: float
    servo_bias: float
    target_late: float
    target_noise: float
    target_heading_noise: float
    delay: float
    position_noise: float
    velocity_noise: float
    attitude_noise: float
    rate_noise: float
    arm_noise: float
    blind: float
    blind_before: float
    rigid: bool
