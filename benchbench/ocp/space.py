"""Where configurations live: in a vector space, unless a model says otherwise (unit quaternions)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import final

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array, Flags


class Space(ABC):
    """Configurations q (n_q,), velocities v (n_v,) and what leads from one to the other; symbols are CasADi SX columns."""

    @property
    @abstractmethod
    def flat(self) -> bool:
        """Whether it is a vector space, so that configurations add up and dq/dt is v."""

    @abstractmethod
    def kinematics(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Return dq/dt, shape (n_q,), linear in v."""

    @abstractmethod
    def difference(self, q0: ca.SX, q1: ca.SX) -> ca.SX:
        """Return the constant v (n_v,) that leads from q0 to q1 in unit time.

        Odd, difference(q0, q1) = -difference(q1, q0), and exact to second order are enough.
        """

    @abstractmethod
    def constraint(self, q: ca.SX) -> ca.SX:
        """Return what is zero (m,) where configurations live, such as |quaternion|^2 - 1."""

    @abstractmethod
    def normalised(self, q: ca.SX) -> ca.SX:
        """Return q moved back to where configurations live."""

    @abstractmethod
    def origin(self) -> Array:
        """Return the configuration (n_q,) in which a scenario's unnamed coordinates are."""

    @abstractmethod
    def headed(self, q: Array, heading: float) -> Array:
        """Return q (n_q,) turned to a heading in rad, to guess handovers."""

    @abstractmethod
    def fixed_at_rest(self) -> Flags:
        """Which coordinates (n_q,) a place to rest at fixes."""


@final
@dataclass(frozen=True)
class Flat(Space):
    """A vector space; `names` are those of the coordinates."""

    names: tuple[str, ...]

    @property
    def flat(self) -> bool:
        """It is."""
        return True

    def kinematics(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """Return v."""
        return v

    def difference(self, q0: ca.SX, q1: ca.SX) -> ca.SX:
        """Return q1 - q0."""
        return q1 - q0

    def constraint(self, q: ca.SX) -> ca.SX:
        """Nothing."""
        return ca.SX(0, 1)

    def normalised(self, q: ca.SX) -> ca.SX:
        """As it is."""
        return q

    def origin(self) -> Array:
        """All zero."""
        return np.zeros(len(self.names))

    def headed(self, q: Array, heading: float) -> Array:
        """Set the yaw angle, where there is one."""
        turned = q.copy()
        if "yaw" in self.names:
            turned[self.names.index("yaw")] = heading
        return turned

    def fixed_at_rest(self) -> Flags:
        """All."""
        return np.ones(len(self.names), bool)
