"""Interface of a cost term: what is minimised beside the travel time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import casadi as ca

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Model, Plant


class Cost(ABC):
    """A price of every second, in seconds of travel time: t_N + integral of the rates of all terms is minimised.

    Said twice on purpose: `rate` in symbols for planners, `spent` in numbers for the certificate, which integrates it over
    the replay. Never negative: lower bounds on the travel time are bounds on the whole because of that.
    """

    noun: ClassVar[str]
    """What it is called in a sentence, such as "control effort"."""

    @abstractmethod
    def rate(self, model: Model, q: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        """Return the price of a second, a scalar without unit, for q (n_q,), v (n_v,), u (n_u,)."""

    @abstractmethod
    def spent(self, plant: Plant, q: Array, v: Array, u: Array) -> Array:
        """Return the same (n,) for q (n, n_q), v (n, n_v), u (n, n_u)."""
