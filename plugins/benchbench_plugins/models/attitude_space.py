"""Where a flying body with joints lives: q = [position, attitude, joints], v = [world velocity, rates, joint rates]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import casadi as ca
import numpy as np

from benchbench.ground.arrays import Array, Flags
from benchbench.ocp.space import Space
from benchbench_plugins.models.attitude import Attitude


@final
@dataclass(frozen=True)
class AttitudeSpace(Space):
    """Position and joints add up, the attitude does as its coordinates do.

    joints: how many; heading_free: a place to rest at leaves the heading open.
    """

    attitude: Attitude
    joints: int
    heading_free: bool

    @property
    def flat(self) -> bool:
        """Whether the attitude's coordinates add up."""
        return self.attitude.flat

    def kinematics(self, q: ca.SX, v: ca.SX) -> ca.SX:
        """World velocity, the attitude's derivative, joint rates."""
        return ca.vertcat(v[:3], self.attitude.kinematics(self._turn(q), v[3:6]), v[6:])

    def difference(self, q0: ca.SX, q1: ca.SX) -> ca.SX:
        """Of positions and joints, and the attitude's."""
        turn = self.attitude.difference(self._turn(q0), self._turn(q1))
        return ca.vertcat(q1[:3] - q0[:3], turn, q1[self._end :] - q0[self._end :])

    def constraint(self, q: ca.SX) -> ca.SX:
        """The attitude's."""
        return self.attitude.constraint(self._turn(q))

    def normalised(self, q: ca.SX) -> ca.SX:
        """With the attitude nearest to q's."""
        return ca.vertcat(q[:3], self.attitude.normalised(self._turn(q)), q[self._end :])

    def origin(self) -> Array:
        """Upright, nose along x, joints at 0."""
        return np.array([0.0, 0.0, 0.0, *self.attitude.origin, *[0.0] * self.joints])

    def headed(self, q: Array, heading: float) -> Array:
        """Level, nose at a heading."""
        return np.concatenate([q[:3], self.attitude.headed(heading), q[self._end :]])

    def fixed_at_rest(self) -> Flags:
        """Place and joints; of the attitude what does not follow from the rest, with or without its heading."""
        turn = self.attitude.level if self.heading_free else self.attitude.independent
        return np.array([True] * 3 + list(turn) + [True] * self.joints)

    @property
    def _end(self) -> int:
        return 3 + len(self.attitude.names)

    def _turn(self, q: ca.SX) -> ca.SX:
        return q[3 : self._end]
