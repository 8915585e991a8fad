"""Interface of a contact condition: what must hold in contact, whenever that is."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from benchbench.arrays import Array
from benchbench.ocp.model import Model, Plant
from benchbench.ocp.node import Node


@dataclass(frozen=True)
class Target:
    """Symbolic state of the target at a node: position (3,) m and velocity (3,) m/s."""

    position: ca.SX
    velocity: ca.SX


@dataclass(frozen=True)
class Condition:
    """h (m,) <= 0, scaled as h = (gap / limit)^2 - 1; `limit` (m,) in `unit`, or None for another form."""

    h: ca.SX
    unit: str
    limit: tuple[float, ...] | None = None

    def tightened(self, margin: float) -> Condition:
        """The same condition for the limit (1 - margin) * limit; needs h of that form."""
        if self.limit is None or margin == 0.0:
            return self
        h = (self.h + 1) / (1 - margin) ** 2 - 1
        return Condition(h, self.unit, tuple(limit * (1 - margin) for limit in self.limit))


class Contact(ABC):
    """One physical condition of a contact, written against any dynamics.

    Said twice on purpose: `condition` in symbols for planners, `gap` in numbers for the certificate.
    """

    limit: float
    """Largest physical gap allowed in contact, in `unit`."""
    unit: str
    always: bool = False
    """A path condition, kept at every node and not only in contact."""

    @abstractmethod
    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        """Return the scaled condition at a node."""

    @abstractmethod
    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        """Return the physical gap (n,) in `unit` for q, v (n, n_q) and target states (n, 3)."""


Contacts = Mapping[str, Contact]
