"""Interface of a contact condition: what must hold in contact, whenever that is."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

import casadi as ca

from benchbench.ground.arrays import Array
from benchbench.ocp.model import Model, Plant, space
from benchbench.ocp.node import Node

Kept = Literal["in contact", "until contact", "always"]
"""When a condition holds: in contact only, at every node until the contact is over, or at every node."""


@dataclass(frozen=True)
class Target:
    """Symbolic state of the target at a node: position (3,) m and velocity (3,) m/s."""

    position: ca.SX
    velocity: ca.SX


@dataclass(frozen=True)
class Condition:
    """h (m,) <= 0, scaled as h = (gap / limit)^2 - 1; `limit` (m,) in `unit`, or None for another form, such as gap / limit - 1."""

    h: ca.SX
    unit: str
    limit: tuple[float, ...] | None = None

    def tightened(self, margin: float) -> Condition:
        """The same condition for the limit (1 - margin) * limit; h of another form is kept by `margin` of its scale."""
        if margin == 0.0:
            return self
        if self.limit is None:
            return Condition(self.h + margin, self.unit)
        h = (self.h + 1) / (1 - margin) ** 2 - 1
        return Condition(h, self.unit, tuple(limit * (1 - margin) for limit in self.limit))


class Contact(ABC):
    """One physical condition of a contact, written against any dynamics.

    Said twice on purpose: `condition` in symbols for planners, `gap` in numbers for the certificate.
    """

    noun: ClassVar[str]
    """What its gap is called in a sentence, such as "distance"."""
    aside: ClassVar[str]
    """What follows a gap in a summary: "apart" in "19 mm apart"."""
    limit: float
    """Largest physical gap allowed in contact, in `unit`."""
    unit: ClassVar[str]
    kept: ClassVar[Kept] = "in contact"
    """When it must hold; all but "in contact" are path conditions."""

    @property
    @abstractmethod
    def reach(self) -> float | None:
        """How far in m the end effector may be from the target where the condition holds; None: it does not say.

        Bounds on the travel time, which are proofs, rest on it.
        """

    @abstractmethod
    def condition(self, model: Model, node: Node, target: Target) -> Condition:
        """Return the scaled condition at a node."""

    @abstractmethod
    def gap(self, plant: Plant, q: Array, v: Array, target_position: Array, target_velocity: Array) -> Array:
        """Return the physical gap (n,) in `unit` for q, v (n, n_q) and target states (n, 3)."""


class Standing(Contact):
    """A condition on something that stands in the room, such as an obstacle, and is drawn there."""

    @abstractmethod
    def outlines(self) -> Mapping[str, Array]:
        """Return lines (n, 3) m by what is written there; rows of NaN part them."""


class NoseContact(Contact):
    """A condition on where the nose points, which bounds on the travel time rest on."""

    @property
    @abstractmethod
    def heading_error(self) -> float:
        """Largest angle in rad between the nose and the ground velocity of a target that moves faster than `SLOW`."""


SLOW = 1e-5
"""Ground speed in m/s below which a direction of motion means nothing."""

Contacts = Mapping[str, Contact]


def still(contacts: Contacts) -> Contacts:
    """Return the conditions that ask something of a contact with a target that stands."""
    return {name: contact for name, contact in contacts.items() if not isinstance(contact, NoseContact)}


def tool_velocity(model: Model, node: Node) -> ca.SX:
    """Velocity of the end effector at a node, (3,) m/s, from the nodal velocity: dp_ee/dq dq/dt."""
    q = ca.SX.sym("q", node.configuration.shape[0])
    jacobian = ca.Function("tool_jacobian", [q], [ca.jacobian(model.tool(q), q)])
    return jacobian(node.configuration) @ space(model).kinematics(node.configuration, node.velocity)


THOUSANDTHS = ("m", "m/s", "rad", "rad/s")
"""Units in which people read a gap in thousandths."""


def in_words(contact: Contact, gap: float) -> str:
    """Return what a summary says of a gap in the contact's unit, such as "19.3 mm apart"."""
    if contact.unit in THOUSANDTHS:
        return f"{1e3 * gap:.3g} m{contact.unit} {contact.aside}"
    unit = "" if contact.unit == "1" else f" {contact.unit}"
    return f"{gap:.3g}{unit} {contact.aside}"
