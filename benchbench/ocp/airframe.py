"""The numbers of a quadrotor with a one-joint arm, as who flies it needs them: worlds, autopilots, controllers."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Model


@dataclass(frozen=True, eq=False)
class Airframe:
    """Two rigid bodies; the body frame stands in the quadrotor's centre of mass, x forward, z up.

    mass, arm_mass        kg
    inertia, arm_inertia  (3,) principal moments in the body and arm frame, kg m^2; as printed, so perhaps of no rigid body
    arm_length            m, from the joint to the end effector; the arm's centre of mass is in its middle
    arm_offset            m, the joint is so far below the origin; it turns about the body's y axis, straight down at pi/2
    rotors                (4, 3) m, where the rotors are
    drag                  (4,) m, torque about z per thrust of each rotor, with its sign
    gravity               m/s^2
    motor_force           (2,) N, smallest and largest thrust of a motor in the plan
    servo_torque          (2,) N m, of the servo in the plan
    speed                 (3,) m/s, largest speed per axis in the plan
    """

    mass: float
    arm_mass: float
    inertia: Array
    arm_inertia: Array
    arm_length: float
    arm_offset: float
    rotors: Array
    drag: Array
    gravity: float
    motor_force: tuple[float, float]
    servo_torque: tuple[float, float]
    speed: tuple[float, float, float]

    @property
    def total_mass(self) -> float:
        """Of both bodies, kg."""
        return self.mass + self.arm_mass


def airframe_of(model: Model) -> Airframe:
    """Return a model's airframe; raises TypeError where it has none, which is told before anything is flown."""
    if not isinstance(model, FlownModel):
        raise TypeError(f"{type(model).__name__} is no FlownModel")
    return model.airframe


class FlownModel(Model):
    """A model of a vehicle that a world can be made of; its inputs are four motor forces and the servo's torque."""

    @property
    @abstractmethod
    def airframe(self) -> Airframe:
        """The vehicle's numbers."""
